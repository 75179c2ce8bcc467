//! The tracker: follows the task's target, or places of their own without a task, with a sluggish
//! hand, a dead zone, lapses of attention, and growing impatience.
//!
//! What they ask for grows with the root of the error, the stick follows with a time constant, and
//! in a lapse it stays where it is. Pushed against something they back off.

use schemas::{Scenario, Task};

use super::mood::{Patience, Wishes};
use super::{Human, HumanView, Request, wrap};
use crate::noise::{Purpose, Stream};

/// Bearings that are as good as straight on, radians.
const DEAD_ZONE_RAD: f64 = 0.1;

/// Turn rate asked for at one radian beyond the dead zone, rad/s.
const TURN_RADPS: f64 = 1.2;

/// Time constant of the hand, seconds.
const HAND_S: f64 = 0.25;

/// How far ahead of the target's motion they look, seconds.
const LOOK_AHEAD_S: f64 = 1.2;

/// A lapse: how long, and how often on average, seconds.
const LAPSE_S: f64 = 0.8;
const BETWEEN_LAPSES_S: f64 = 5.0;

/// How long they stay behind the target before they push harder, seconds.
const IMPATIENT_S: f64 = 3.0;

const ARRIVED_M: f64 = 0.35;

pub(super) struct Tracker {
    task: Option<Task>,
    wishes: Wishes,
    patience: Patience,
    stream: Stream,
    asked: [f64; 2],
    behind_s: f64,
    lapse_until_s: f64,
    last_s: f64,
}

impl Tracker {
    pub(super) fn new(scenario: &Scenario) -> Tracker {
        Tracker {
            task: scenario.task,
            wishes: Wishes::new(scenario),
            patience: Patience::default(),
            stream: Stream::new(scenario.person.joystick_seed, Purpose::Whim),
            asked: [0.0; 2],
            behind_s: 0.0,
            lapse_until_s: 0.0,
            last_s: 0.0,
        }
    }

    /// What they would like to ask for.
    fn wanted(&mut self, view: &HumanView, dt_s: f64) -> [f64; 2] {
        let at_m = match &self.task {
            Some(task) => task.target(view.t_s + LOOK_AHEAD_S).0,
            None => self.wishes.at_m(),
        };
        let way_m = [at_m[0] - view.pose.x_m, at_m[1] - view.pose.y_m];
        let distance_m = libm::hypot(way_m[0], way_m[1]);
        if distance_m < ARRIVED_M {
            if self.task.is_none() {
                self.wishes.change();
            }
            self.behind_s = 0.0;
            return [0.0; 2];
        }
        self.behind_s += dt_s;
        let error_rad = wrap(libm::atan2(way_m[1], way_m[0]) - view.pose.theta_rad);
        let beyond_rad = (error_rad.abs() - DEAD_ZONE_RAD).max(0.0);
        let turn_radps = TURN_RADPS * libm::sqrt(beyond_rad);
        let hurry = if self.behind_s > IMPATIENT_S { 1.4 } else { 1.0 };
        let facing = (1.0 - beyond_rad / 1.3).clamp(0.0, 1.0);
        let v_mps = (0.45 * hurry * (distance_m + 0.2)).min(0.5 * hurry) * facing;
        [v_mps, if error_rad < 0.0 { -turn_radps } else { turn_radps }]
    }
}

impl Human for Tracker {
    fn joystick(&mut self, view: &HumanView) -> Option<Request> {
        let dt_s = view.t_s - self.last_s;
        self.last_s = view.t_s;
        let dice = self.stream.reading(view.index);
        if let Some((back, _)) = self.patience.lost(view, self.asked[0], dt_s, dice) {
            self.asked = [0.0; 2];
            return Some(Request { v_mps: back[0], omega_radps: back[1], dead_man: true });
        }
        let wanted = self.wanted(view, dt_s);
        if dice.happens(0, dt_s / BETWEEN_LAPSES_S) {
            self.lapse_until_s = view.t_s + LAPSE_S;
        }
        if view.t_s >= self.lapse_until_s {
            for (asked, wanted) in self.asked.iter_mut().zip(wanted) {
                *asked += dt_s / HAND_S * (wanted - *asked);
            }
        }
        Some(Request { v_mps: self.asked[0], omega_radps: self.asked[1], dead_man: true })
    }
}
