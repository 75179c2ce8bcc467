//! Whether the law does what its theorem promises: `lyapunov_increases`, `lyapunov_worst`.
//!
//! Lemma 1 of the paper: while the feedback drives, with d > 0, the frame fixed and faces at rest,
//! L does not rise. A pair of consecutive steps is covered where k = 0 in both, nothing but the law
//! shaped the input, branch, frame, source and velocity of the target are the same, and no distance
//! changed by more than the robot can travel (a ray that jumps past a corner). Worlds with moving
//! discs are not covered.

use super::accumulate::Accumulate;
use super::sample::{Decision, LawState, Setting};
use schemas::LawBranch;

/// L rises where it rises by more than this. Our choice: a thousand times what its eight or so
/// logarithms and products round by at L of about 1000.
const RISES_ABOVE: f64 = 1e-6;

/// Frames nearer to each other than this are the same, radians.
const SAME_FRAME_RAD: f64 = 1e-9;

/// `lyapunov_increases` = number of covered steps with L₊ − L > 1e-6;
/// `lyapunov_worst` = the largest L₊ − L over covered steps, at least 0.
#[derive(Clone, Debug)]
pub(super) struct Lyapunov {
    worst_only: bool,
    covered_world: bool,
    v_max_mps: f64,
    before: Option<(f64, LawState)>,
    covered: u64,
    increases: u32,
    worst: f64,
}

impl Lyapunov {
    pub(super) fn increases(setting: &Setting) -> Self {
        Lyapunov {
            worst_only: false,
            covered_world: !setting.world.moves(),
            v_max_mps: setting.limits.v_max_mps(),
            before: None,
            covered: 0,
            increases: 0,
            worst: 0.0,
        }
    }

    pub(super) fn worst(setting: &Setting) -> Self {
        Lyapunov { worst_only: true, ..Lyapunov::increases(setting) }
    }

    /// Whether the theorem covers the way from one step to the next.
    fn covers(&self, before: &LawState, after: &LawState, apart_s: f64) -> bool {
        // Rays meet faces at an angle: at 60° a way of 1 m changes a distance by 2 m.
        let farthest_m = 2.0 * self.v_max_mps * apart_s;
        let mut distances = before.distances_m.iter().zip(&after.distances_m);
        apart_s > 0.0
            && before.branch == after.branch
            && before.reference == after.reference
            && before.target_velocity_mps == after.target_velocity_mps
            && libm::fabs(before.psi_rad - after.psi_rad) <= SAME_FRAME_RAD
            && distances.all(|(a, b)| libm::fabs(a - b) <= farthest_m)
    }
}

impl Accumulate for Lyapunov {
    fn decision(&mut self, decision: &Decision) {
        let law = decision.law;
        let drives = decision.k == 0.0
            && !law.altered
            && matches!(law.branch, LawBranch::Left | LawBranch::Right)
            && law.lyapunov.is_finite();
        let before = self.before.take();
        if !drives || !self.covered_world {
            return;
        }
        self.before = Some((decision.t_s, law));
        if let Some((t_s, before)) = before
            && self.covers(&before, &law, decision.t_s - t_s)
        {
            self.covered += 1;
            let rise = law.lyapunov - before.lyapunov;
            self.worst = self.worst.max(rise);
            if rise > RISES_ABOVE {
                self.increases += 1;
            }
        }
    }

    fn value(&self) -> Option<f64> {
        let value = if self.worst_only { self.worst } else { f64::from(self.increases) };
        (self.covered > 0).then_some(value)
    }

    fn total(&self) -> Option<f64> {
        if self.worst_only { None } else { self.value() }
    }
}
