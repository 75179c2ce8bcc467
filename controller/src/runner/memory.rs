//! What the controller remembers from one step to the next, apart from its senses.

use crate::digest::Digest;
use crate::law::Side;
use crate::plan::Past;
use crate::sharing::{Switch, Wait};

/// The law's and the switch's memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Memory {
    /// ψ of the previous step, radians.
    pub(super) psi_rad: Option<f64>,
    /// Side and θ* of the previous step.
    pub(super) past: Past,
    /// The hysteresis switch.
    pub(super) switch: Switch,
    /// What has passed since k fell to 0.
    pub(super) wait: Wait,
    /// What the person asked for, [m/s, rad/s], and where the target was, metres, when it did.
    pub(super) fell: Option<([f64; 2], [f64; 2])>,
    /// Whether the feedback law drives the mirrored robot.
    pub(super) mirrored: bool,
}

impl Memory {
    pub(super) fn fold(&self, digest: &mut Digest) {
        for remembered in [self.psi_rad, self.past.theta_star_rad] {
            digest.word(u64::from(remembered.is_some()));
            digest.number(remembered.unwrap_or_default());
        }
        digest.word(match self.past.side {
            None => 0,
            Some(Side::Left) => 1,
            Some(Side::Right) => 2,
        });
        digest.word(u64::from(self.switch.human) << 1 | u64::from(self.switch.seen_safe));
        if let Some((request, target_m)) = &self.fell {
            self.wait.fold(digest);
            digest.numbers(request);
            digest.numbers(target_m);
        }
        if self.mirrored {
            digest.word(1);
        }
    }
}
