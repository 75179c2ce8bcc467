//! Forward invariance: `invariance_breaches`, `invariance_first_s`, `invariance_worst_m`,
//! `barrier_breaches`, and the list of violations behind them.
//!
//! A monitor that knows nothing of the controller: it sees where the body was and nothing else.

use schemas::{Disc, Footprint, Pose};
use serde::{Deserialize, Serialize};

use super::accumulate::Accumulate;
use super::contact::Edge;
use super::sample::Motion;

/// The static admissible set is left when the clearance falls below minus this, metres: above the
/// rounding of coordinates of some metres (1e-15), below anything that can be measured. The set is
/// closed, so that touching its edge is not leaving it.
pub(super) const LEFT_BELOW_M: f64 = 1e-9;

/// A contact with a disc is the robot's doing when it moves towards the disc's centre by more than
/// this, m/s (specification §9, S5: from discs only passive safety is possible).
const ACTIVE_ABOVE_MPS: f64 = 1e-3;

/// What was violated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ViolationKind {
    /// The body left the static admissible set: it overlaps a wall or an obstacle.
    LeftAdmissibleSet,
    /// The body touched a moving disc while the robot moved towards it.
    CollisionDiscActive,
    /// A moving disc touched the body, which did not move towards it.
    CollisionDiscPassive,
}

impl ViolationKind {
    /// The name in machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            ViolationKind::LeftAdmissibleSet => "left_admissible_set",
            ViolationKind::CollisionDiscActive => "collision_disc_active",
            ViolationKind::CollisionDiscPassive => "collision_disc_passive",
        }
    }

    /// In words, for a table.
    pub fn words(self) -> &'static str {
        match self {
            ViolationKind::LeftAdmissibleSet => "left the admissible set",
            ViolationKind::CollisionDiscActive => "moved towards a moving disc that touched it",
            ViolationKind::CollisionDiscPassive => "was run into by a moving disc",
        }
    }

    /// Whether the controller has to answer for it. A disc can run over a robot at rest.
    pub fn counts_against_the_controller(self) -> bool {
        self != ViolationKind::CollisionDiscPassive
    }
}

/// One stretch of a run in which something was violated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Violation {
    /// Its first sample, seconds from the start of the run.
    pub t_s: f64,
    /// Its last sample, seconds.
    pub until_s: f64,
    /// What was violated.
    pub kind: ViolationKind,
    /// How deep the overlap became, metres.
    pub depth_m: f64,
    /// |v| at the first sample, m/s; of an active contact, at the first at which it was.
    pub speed_mps: f64,
}

/// Follows a run and lists its violations.
#[derive(Clone, Debug)]
pub(super) struct Monitor {
    footprint: Footprint,
    outside: Option<Violation>,
    touching: Option<Violation>,
    done: Vec<Violation>,
}

impl Monitor {
    pub(super) fn new(footprint: Footprint) -> Self {
        Monitor { footprint, outside: None, touching: None, done: Vec::new() }
    }

    pub(super) fn motion(&mut self, motion: &Motion) {
        if !motion.clearance_static_m.is_nan() {
            let depth_m = -motion.clearance_static_m;
            let kind = left(motion.clearance_static_m).then_some(ViolationKind::LeftAdmissibleSet);
            follow(&mut self.outside, &mut self.done, motion, kind, depth_m);
        }
        if !motion.clearance_m.is_nan() {
            let (kind, depth_m) = self.disc_contact(motion);
            follow(&mut self.touching, &mut self.done, motion, kind, depth_m);
        }
    }

    /// The violations so far, by time; open ones end at their last sample.
    pub(super) fn violations(&self) -> Vec<Violation> {
        let mut all = self.done.clone();
        all.extend(self.outside);
        all.extend(self.touching);
        all.sort_by(|a, b| a.t_s.total_cmp(&b.t_s).then(a.kind.cmp(&b.kind)));
        all
    }

    /// Whether a disc touches the body, whose doing that is, and how deep.
    fn disc_contact(&self, motion: &Motion) -> (Option<ViolationKind>, f64) {
        let mut kind = None;
        let mut deepest_m = f64::NEG_INFINITY;
        // Without contact with anything there is none with a disc.
        if motion.clearance_m > 0.0 {
            return (kind, deepest_m);
        }
        let (sin, cos) = libm::sincos(motion.pose.theta_rad);
        for disc in &motion.discs {
            let clearance_m = disc_clearance_m(&self.footprint, &motion.pose, disc);
            if clearance_m.is_nan() || clearance_m > 0.0 {
                continue;
            }
            deepest_m = deepest_m.max(-clearance_m);
            let (dx, dy) = (disc.centre_m[0] - motion.pose.x_m, disc.centre_m[1] - motion.pose.y_m);
            let distance = libm::hypot(dx, dy);
            let towards_mps = motion.twist.v_mps * (cos * dx + sin * dy) / distance;
            let active = towards_mps > ACTIVE_ABOVE_MPS;
            // One active contact makes the stretch active.
            if active || kind.is_none() {
                kind = Some(if active {
                    ViolationKind::CollisionDiscActive
                } else {
                    ViolationKind::CollisionDiscPassive
                });
            }
        }
        (kind, deepest_m)
    }
}

/// Whether this static clearance lies outside the static admissible set.
fn left(clearance_static_m: f64) -> bool {
    clearance_static_m < -LEFT_BELOW_M
}

/// Opens, deepens or closes a stretch.
fn follow(
    open: &mut Option<Violation>,
    done: &mut Vec<Violation>,
    motion: &Motion,
    kind: Option<ViolationKind>,
    depth_m: f64,
) {
    match (kind, open.as_mut()) {
        (Some(kind), Some(violation)) => {
            violation.until_s = violation.until_s.max(motion.t_s);
            violation.depth_m = violation.depth_m.max(depth_m);
            if kind == ViolationKind::CollisionDiscActive && violation.kind != kind {
                violation.kind = kind;
                violation.speed_mps = libm::fabs(motion.twist.v_mps);
            }
        }
        (Some(kind), None) => {
            let speed_mps = libm::fabs(motion.twist.v_mps);
            *open =
                Some(Violation { t_s: motion.t_s, until_s: motion.t_s, kind, depth_m, speed_mps });
        }
        (None, _) => done.extend(open.take()),
    }
}

/// Signed distance from a rectangle about `pose` to a disc, metres.
fn disc_clearance_m(footprint: &Footprint, pose: &Pose, disc: &Disc) -> f64 {
    let (sin, cos) = libm::sincos(pose.theta_rad);
    let (dx, dy) = (disc.centre_m[0] - pose.x_m, disc.centre_m[1] - pose.y_m);
    // The centre in body coordinates, measured from the rectangle's sides.
    let beyond_x = libm::fabs(dx * cos + dy * sin) - 0.5 * footprint.length_m;
    let beyond_y = libm::fabs(dy * cos - dx * sin) - 0.5 * footprint.width_m;
    let outside = libm::hypot(beyond_x.max(0.0), beyond_y.max(0.0));
    outside + beyond_x.max(beyond_y).min(0.0) - disc.radius_m
}

/// `invariance_breaches` = number of maximal intervals outside the static admissible set.
#[derive(Clone, Debug, Default)]
pub(super) struct Breaches {
    outside: Edge,
    count: u32,
    known: bool,
}

impl Accumulate for Breaches {
    fn motion(&mut self, motion: &Motion) {
        let outside =
            (!motion.clearance_static_m.is_nan()).then(|| left(motion.clearance_static_m));
        self.known |= outside.is_some();
        if self.outside.rises(outside) {
            self.count += 1;
        }
    }

    fn value(&self) -> Option<f64> {
        self.known.then_some(f64::from(self.count))
    }
}

/// `invariance_first_s` = when the static admissible set was first left; undefined if never.
#[derive(Clone, Debug, Default)]
pub(super) struct FirstBreach {
    at_s: Option<f64>,
}

impl Accumulate for FirstBreach {
    fn motion(&mut self, motion: &Motion) {
        if self.at_s.is_none() && left(motion.clearance_static_m) {
            self.at_s = Some(motion.t_s);
        }
    }

    fn value(&self) -> Option<f64> {
        self.at_s
    }
}

/// `invariance_worst_m` = how deep the body overlapped a wall or an obstacle at most, 0 if never.
#[derive(Clone, Debug, Default)]
pub(super) struct WorstBreach {
    deepest_m: f64,
    known: bool,
}

impl Accumulate for WorstBreach {
    fn motion(&mut self, motion: &Motion) {
        self.known |= !motion.clearance_static_m.is_nan();
        if left(motion.clearance_static_m) {
            self.deepest_m = self.deepest_m.max(-motion.clearance_static_m);
        }
    }

    fn value(&self) -> Option<f64> {
        self.known.then_some(self.deepest_m)
    }
}

/// γ of the discrete barrier condition, for 0.1 s: at most half of the clearance may be used up in one
/// of the paper's control periods. Our choice.
const BARRIER_GAMMA: f64 = 0.5;
const BARRIER_PERIOD_S: f64 = 0.1;

/// `barrier_breaches` = number of maximal intervals with h(x₊) < (1 − γ)h(x), h the clearance from
/// what stands still and γ = 0.5 per 0.1 s, for another spacing of samples by the same rate
/// (Agrawal and Sreenath, "Discrete control barrier functions for safety-critical control of
/// discrete systems", RSS 2017).
#[derive(Clone, Debug, Default)]
pub(super) struct Barrier {
    before: Option<(f64, f64)>,
    breached: Edge,
    count: u32,
    known: bool,
}

impl Accumulate for Barrier {
    fn motion(&mut self, motion: &Motion) {
        let h = motion.clearance_static_m;
        if h.is_nan() {
            self.before = None;
            return;
        }
        if let Some((t_s, before)) = self.before.replace((motion.t_s, h)) {
            let periods = (motion.t_s - t_s) / BARRIER_PERIOD_S;
            if periods > 0.0 {
                self.known = true;
                let least = before * libm::pow(1.0 - BARRIER_GAMMA, periods);
                // Outside the condition asks for the way back; `invariance_breaches` counts that.
                let breached = before > 0.0 && h < least;
                self.count += u32::from(self.breached.rises(Some(breached)));
            }
        }
    }

    fn value(&self) -> Option<f64> {
        self.known.then_some(f64::from(self.count))
    }

    fn total(&self) -> Option<f64> {
        self.value()
    }
}
