//! From the request to k: D, the sets, the switch, and why.

use schemas::{Plant, Reason, Region, SensorSuite, Step};

use super::feedback::View;
use super::memory::Memory;
use crate::mutation::Planted;
use crate::safety::Shield;
use crate::sharing::{Patience, Sets, another_request, classify_printed, classify_total, danger};
use crate::spec::Law;
use crate::travel::{DMode, Travel};

/// What the sets are to be asked about, and with which parameters.
pub(super) struct Question<'a> {
    /// The velocities that the person asks for, within the limits, [m/s, rad/s].
    pub(super) request: [f64; 2],
    /// The person's input: those, or the accelerations that they become.
    pub(super) u_h: [f64; 2],
    pub(super) mode: DMode,
    pub(super) b1_m: f64,
    pub(super) b2_m: f64,
    /// How long k = 1 is waited for, where it is.
    pub(super) patience: Option<Patience>,
    /// With which sensors D is measured.
    pub(super) sensors: SensorSuite,
    /// The safety layer, where there is one.
    pub(super) shield: Option<Shield>,
    /// The plant, in free driving, where each stroke of the joystick is a request of its own; with a task
    /// the person's aim is one and the same.
    pub(super) free_plant: Option<&'a Plant>,
}

impl Question<'_> {
    /// Whether the person asks for something else than when the feedback law took over.
    fn another_request(&self, fell: Option<([f64; 2], [f64; 2])>) -> bool {
        match (fell, self.free_plant) {
            (Some((before, _)), Some(plant)) => another_request(self.request, before, plant),
            _ => false,
        }
    }
}

/// What the sets say about one velocity.
#[derive(Clone, Copy)]
struct Verdict {
    d_m: f64,
    d_effective_m: f64,
    region: Region,
    danger: f64,
}

impl Verdict {
    /// The worse class counts; of equals the first.
    fn worse(self, other: Verdict) -> Verdict {
        let rank = |verdict: &Verdict| match verdict.region {
            Region::Safe => 0,
            Region::Hysteresis => 1,
            Region::Danger | Region::Unspecified => 2,
        };
        let worse = if rank(&other) > rank(&self) { other } else { self };
        Verdict { danger: self.danger.max(other.danger), ..worse }
    }
}

impl View<'_> {
    /// Classifies the state, moves the switch, and says why.
    ///
    /// Under a safety layer the person gets control only if that layer would leave their input as
    /// it is; else the state counts as dangerous. So k = 1 means that the input applied is theirs,
    /// bit for bit, by construction, also where the cone of the safety layer sees what D does not.
    pub(super) fn share(
        &self,
        question: &Question<'_>,
        memory: &mut Memory,
        planted: &Planted,
        step: &mut Step,
    ) -> Reason {
        let params = self.params;
        let mut verdict = self.verdict(question, question.request);
        // For the dynamic model the request is no input: ask about the present speed as well
        // (erratum 13). As printed, k is a function of the requested speed alone.
        if self.law == Law::Dynamic && params.sets == Sets::Total {
            verdict = verdict.worse(self.verdict(question, self.speeds));
        }
        let d_m = verdict.d_m;
        let mut region = planted.region(verdict.region);
        let next = memory.switch.next(region);
        let altered = next.human
            && question.shield.is_some_and(|shield| !self.harmless(question.u_h, &shield));
        let reason = if altered {
            region = Region::Danger;
            verdict.danger = 1.0;
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
        let before = memory.switch;
        memory.switch = before.next(region);
        let another = question.another_request(memory.fell);
        let patience = question.patience.as_ref();
        let waits = |patience| memory.wait.holds(before, memory.switch, another, patience);
        let reason = if patience.is_some_and(waits) {
            memory.switch.human = false;
            Reason::Hysteresis
        } else {
            reason
        };
        if memory.switch.human {
            memory.fell = None;
        } else if params.remembers_the_fall(patience) && (memory.fell.is_none() || another) {
            memory.fell = Some((question.request, self.target.position_m));
        }
        step.distance_human_m = d_m;
        step.distance_effective_m = verdict.d_effective_m;
        step.danger = verdict.danger;
        step.region = region;
        reason
    }

    /// The class of moving at (v, ω).
    fn verdict(&self, question: &Question<'_>, [v_mps, omega_radps]: [f64; 2]) -> Verdict {
        let View { params, senses, pose, target, .. } = self;
        let Question { b1_m, b2_m, .. } = *question;
        // As printed, the set does not look behind, and its D is the one ahead.
        let printed = params.sets == Sets::Printed;
        let travel = Travel {
            pose: **pose,
            v_mps: if printed { 0.0 } else { v_mps },
            omega_radps,
            intent_m: target.intent_m,
            sweep_s: params.sweep_s,
        };
        let d_m = travel
            .distance_m(question.mode, |angle_rad| senses.travel_m(params.d_body, pose, angle_rad));
        let d_effective_m = params.effective_m(d_m, v_mps, question.sensors);
        let region = if printed {
            classify_printed(d_effective_m, v_mps, b1_m, b2_m)
        } else {
            classify_total(d_m, d_effective_m, v_mps, b1_m, b2_m)
        };
        let v_mps = if printed { v_mps.max(0.0) } else { v_mps };
        let danger = danger(region, d_effective_m, v_mps, b1_m, b2_m, params.danger_band_m);
        Verdict { d_m, d_effective_m, region, danger }
    }
}
