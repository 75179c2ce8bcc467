//! From the request to k: D, the sets, the switch, and why.

use schemas::{Reason, Region, Step};

use super::feedback::View;
use super::memory::Memory;
use crate::safety::{Cone, project};
use crate::sharing::{Sets, classify_printed, classify_total, danger};
use crate::travel::{DMode, Travel};

/// What the sets are to be asked about, and with which parameters.
pub(super) struct Question {
    /// The person's input, within the limits, [m/s, rad/s].
    pub(super) u_h: [f64; 2],
    pub(super) mode: DMode,
    pub(super) b1_m: f64,
    pub(super) b2_m: f64,
    /// Whether `D_eff` takes the place of D.
    pub(super) margin: bool,
    /// The safety layer, where there is one.
    pub(super) cone: Option<Cone>,
}

impl View<'_> {
    /// Classifies the state, moves the switch, and says why.
    ///
    /// Under a safety layer the person gets control only if that layer would leave their input as
    /// it is; else the state counts as dangerous. So k = 1 means that the input applied is theirs,
    /// bit for bit, by construction, also where the cone of the safety layer sees what D does not.
    pub(super) fn share(
        &self,
        question: &Question,
        memory: &mut Memory,
        step: &mut Step,
    ) -> Reason {
        let View { params, senses, pose, target } = self;
        let Question { u_h, b1_m, b2_m, .. } = *question;
        let [v_mps, omega_radps] = u_h;
        // As printed, the set does not look behind, and its D is the one ahead.
        let printed = params.sets == Sets::Printed;
        let travel = Travel {
            pose: **pose,
            v_mps: if printed { 0.0 } else { v_mps },
            omega_radps,
            intent_m: target.intent_m,
            sweep_s: params.sweep_s,
        };
        let d_m = travel.distance_m(question.mode, |angle_rad| senses.law_ray_m(pose, angle_rad));
        let d_effective_m = if question.margin {
            d_m - params.guard_m - libm::fabs(v_mps) * params.control_period_s
        } else {
            d_m
        };
        step.distance_human_m = d_m;
        step.distance_effective_m = d_effective_m;

        let mut region = if printed {
            classify_printed(d_effective_m, v_mps, b1_m, b2_m)
        } else {
            classify_total(d_m, d_effective_m, v_mps, b1_m, b2_m)
        };
        let next = memory.switch.next(region);
        let altered = next.human
            && question.cone.is_some_and(|cone| {
                let ray_m = |angle_rad: f64| senses.safety_ray_m(pose, angle_rad);
                project(&cone, u_h, pose.theta_rad, ray_m) != u_h
            });
        let reason = if altered {
            region = Region::Danger;
            Reason::WouldBeProjected
        } else {
            match region {
                _ if next.human => Reason::Human,
                Region::Danger if d_m.is_nan() => Reason::DistanceUnknown,
                Region::Danger if d_m <= 0.0 => Reason::Contact,
                Region::Hysteresis if next.seen_safe => Reason::Hysteresis,
                Region::Hysteresis => Reason::NotYetSafe,
                _ => Reason::Danger,
            }
        };
        memory.switch = memory.switch.next(region);
        let v_shown_mps = if printed { v_mps.max(0.0) } else { v_mps };
        step.danger = danger(region, d_effective_m, v_shown_mps, b1_m, b2_m, params.danger_band_m);
        step.region = region;
        reason
    }
}
