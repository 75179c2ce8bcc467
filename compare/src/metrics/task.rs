//! How well the task was done: `tracking_rms_m`, `heading_rms_rad`, `goal_reached`, `goal_time_s`,
//! `path_efficiency`.
//!
//! Without a task none of them has a meaning. The goal metrics also have none where the body cannot
//! stand at the task's end point: nobody can be late for a place that is not there.

use schemas::Task;

use super::accumulate::{Accumulate, Mean};
use super::sample::{Motion, Setting};

/// The goal is reached within this distance, metres. Our choice: under half a footprint.
pub(super) const GOAL_RADIUS_M: f64 = 0.2;

/// Below this path length its efficiency is the ratio of two noises, metres. Our choice.
pub(super) const SHORTEST_PATH_M: f64 = 0.05;

/// Distance from a point to the path of the task's target, metres.
fn cross_track_m(task: &Task, point_m: [f64; 2]) -> f64 {
    let [vx, vy] = task.velocity_mps;
    let (dx, dy) = (point_m[0] - task.from_m[0], point_m[1] - task.from_m[1]);
    let speed_squared = vx * vx + vy * vy;
    // When the target is nearest. One at rest is always where it starts: `min` drops that 0/0.
    let nearest_s = ((dx * vx + dy * vy) / speed_squared).min(task.until_s).max(0.0);
    libm::hypot(dx - vx * nearest_s, dy - vy * nearest_s)
}

/// `tracking_rms_m` = RMS over time of the distance to the path of the target.
#[derive(Clone, Debug)]
pub(super) struct Tracking {
    task: Option<Task>,
    square: Mean,
}

impl Tracking {
    pub(super) fn new(setting: &Setting) -> Self {
        Tracking { task: setting.task, square: Mean::default() }
    }
}

impl Accumulate for Tracking {
    fn motion(&mut self, motion: &Motion) {
        let Some(task) = &self.task else { return };
        let off_m = cross_track_m(task, motion.pose.position_m());
        if off_m.is_finite() {
            self.square.add(off_m * off_m, motion.hold_s);
        }
    }

    fn value(&self) -> Option<f64> {
        self.square.value().map(libm::sqrt)
    }
}

/// `heading_rms_rad` = RMS over time of the angle between the heading and the path of the target.
#[derive(Clone, Debug)]
pub(super) struct Heading {
    along_rad: Option<f64>,
    square: Mean,
}

impl Heading {
    pub(super) fn new(setting: &Setting) -> Self {
        // A target at rest has no direction.
        let velocity = setting.task.map(|task| task.velocity_mps).filter(|v| *v != [0.0; 2]);
        let along_rad = velocity.map(|[vx, vy]| libm::atan2(vy, vx));
        Heading { along_rad, square: Mean::default() }
    }
}

impl Accumulate for Heading {
    fn motion(&mut self, motion: &Motion) {
        let Some(along_rad) = self.along_rad else { return };
        let off_rad = libm::remainder(motion.pose.theta_rad - along_rad, core::f64::consts::TAU);
        if off_rad.is_finite() {
            self.square.add(off_rad * off_rad, motion.hold_s);
        }
    }

    fn value(&self) -> Option<f64> {
        self.square.value().map(libm::sqrt)
    }
}

/// When the goal was first reached.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    goal_m: Option<[f64; 2]>,
    seen: bool,
    at_s: Option<f64>,
}

impl Arrival {
    fn new(setting: &Setting) -> Self {
        Arrival { goal_m: setting.goal_m, seen: false, at_s: None }
    }

    fn motion(&mut self, motion: &Motion) {
        let Some(goal) = self.goal_m else { return };
        let off_m = libm::hypot(motion.pose.x_m - goal[0], motion.pose.y_m - goal[1]);
        self.seen |= off_m.is_finite();
        if off_m <= GOAL_RADIUS_M && self.at_s.is_none() {
            self.at_s = Some(motion.t_s);
        }
    }
}

/// `goal_reached` = 1 if the robot ever came within 0.2 m of the goal, else 0.
#[derive(Clone, Debug)]
pub(super) struct GoalReached(Arrival);

impl GoalReached {
    pub(super) fn new(setting: &Setting) -> Self {
        GoalReached(Arrival::new(setting))
    }
}

impl Accumulate for GoalReached {
    fn motion(&mut self, motion: &Motion) {
        self.0.motion(motion);
    }

    fn value(&self) -> Option<f64> {
        self.0.seen.then(|| f64::from(u8::from(self.0.at_s.is_some())))
    }
}

/// `goal_time_s` = first time within 0.2 m of the goal; undefined where that never happened.
#[derive(Clone, Debug)]
pub(super) struct GoalTime(Arrival);

impl GoalTime {
    pub(super) fn new(setting: &Setting) -> Self {
        GoalTime(Arrival::new(setting))
    }
}

impl Accumulate for GoalTime {
    fn motion(&mut self, motion: &Motion) {
        self.0.motion(motion);
    }

    fn value(&self) -> Option<f64> {
        self.0.at_s
    }
}

/// `path_efficiency` = (‖g − p(0)‖ − ‖g − p(T)‖) / ∫ |dp|, with g the task's end point: progress
/// towards the goal per metre driven, 1 for the straight way, negative for driving away.
#[derive(Clone, Debug)]
pub(super) struct PathEfficiency {
    goal_m: Option<[f64; 2]>,
    first_m: Option<[f64; 2]>,
    last_m: [f64; 2],
    driven: f64,
}

impl PathEfficiency {
    pub(super) fn new(setting: &Setting) -> Self {
        let goal_m = setting.task.map(|task| task.target(task.until_s).0);
        PathEfficiency {
            goal_m: goal_m.filter(|goal| goal.iter().all(|x| x.is_finite())),
            first_m: None,
            last_m: [0.0; 2],
            driven: 0.0,
        }
    }
}

impl Accumulate for PathEfficiency {
    fn motion(&mut self, motion: &Motion) {
        let here = motion.pose.position_m();
        if !here.iter().all(|x| x.is_finite()) {
            return;
        }
        if self.first_m.is_some() {
            self.driven += libm::hypot(here[0] - self.last_m[0], here[1] - self.last_m[1]);
        } else {
            self.first_m = Some(here);
        }
        self.last_m = here;
    }

    fn value(&self) -> Option<f64> {
        let (goal, first) = (self.goal_m?, self.first_m?);
        let off_m = |p: [f64; 2]| libm::hypot(goal[0] - p[0], goal[1] - p[1]);
        (self.driven >= SHORTEST_PATH_M).then(|| (off_m(first) - off_m(self.last_m)) / self.driven)
    }
}
