//! The follower of the task's trajectory.

use schemas::Task;

use super::anchored::Model;
use super::bearing::{Gains, Goal, Habits, ask};
use crate::recording::{Recording, State};

/// Corrects the recorded joystick by what the bearing law asks for more, or less, to follow the
/// task's target from where the robot now is.
pub(crate) struct Follower {
    goal: Goal,
    gains: Gains,
    habits: Habits,
}

impl Follower {
    pub(crate) fn new(task: Task, gains: Gains, habits: Habits) -> Follower {
        Follower { goal: Goal::Follow(task), gains, habits }
    }
}

impl Model for Follower {
    fn ask(&mut self, tick: usize, now: &State, then: &State, asked: [f64; 2]) -> [f64; 2] {
        let t_s = Recording::tick_s(tick);
        let [new, old] =
            [now, then].map(|at| ask(&self.gains, &self.habits, &self.goal, &at.pose, t_s));
        [0, 1].map(|axis| asked[axis] + (new[axis] - old[axis]))
    }
}
