//! Contacts: `collisions`, `contact_speed_mps`.

use super::accumulate::Accumulate;
use super::sample::Motion;

/// Follows one yes-or-no signal and tells when it rises. Unknown samples change nothing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Edge {
    on: bool,
}

impl Edge {
    /// Whether the signal has just become true; `None` is unknown.
    pub(super) fn rises(&mut self, signal: Option<bool>) -> bool {
        let Some(signal) = signal else { return false };
        let rises = signal && !self.on;
        self.on = signal;
        rises
    }
}

/// Whether the body touches or overlaps something; `None` where the clearance is unknown.
fn in_contact(motion: &Motion) -> Option<bool> {
    (!motion.clearance_m.is_nan()).then_some(motion.clearance_m <= 0.0)
}

/// `collisions` = number of maximal intervals with d ≤ 0.
#[derive(Clone, Debug, Default)]
pub(super) struct Collisions {
    contact: Edge,
    count: u32,
    known: bool,
}

impl Accumulate for Collisions {
    fn motion(&mut self, motion: &Motion) {
        let contact = in_contact(motion);
        self.known |= contact.is_some();
        if self.contact.rises(contact) {
            self.count += 1;
        }
    }

    fn value(&self) -> Option<f64> {
        self.known.then_some(f64::from(self.count))
    }
}

/// `contact_speed_mps` = the greatest |v| at the first sample of a collision.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactSpeed {
    contact: Edge,
    fastest_mps: Option<f64>,
}

impl Accumulate for ContactSpeed {
    fn motion(&mut self, motion: &Motion) {
        if self.contact.rises(in_contact(motion)) {
            let speed = libm::fabs(motion.twist.v_mps);
            self.fastest_mps = Some(self.fastest_mps.map_or(speed, |fastest| fastest.max(speed)));
        }
    }

    fn value(&self) -> Option<f64> {
        // No collision, no speed of it: undefined, not 0.
        self.fastest_mps.filter(|speed| speed.is_finite())
    }
}
