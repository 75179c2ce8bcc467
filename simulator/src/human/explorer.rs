//! The explorer: wants to be nowhere in particular. Drives on, weaving a little, until something is
//! ahead, then turns to the freer side; pushed against something they back off.
//!
//! No goal explains what they do: a person alien to every model that infers goals.

use std::collections::VecDeque;

use schemas::{Pose, Scenario, World};

use super::mood::Patience;
use super::{Human, HumanView, Request};
use crate::noise::{Purpose, Stream};

/// Reaction time, in ticks of the joystick: a quarter of a second.
const DELAY: usize = 12;

/// Free way ahead below which they begin to turn, and above which they stop, metres.
const TURN_M: f64 = 0.8;
const GO_M: f64 = 1.3;

/// How fast they turn away, rad/s.
const TURN_RADPS: f64 = 0.9;

/// Weaving: amplitude in rad/s and period in seconds.
const WEAVE_RADPS: f64 = 0.25;
const WEAVE_S: f64 = 5.0;

pub(super) struct Explorer {
    world: World,
    stream: Stream,
    patience: Patience,
    seen: VecDeque<Pose>,
    turning: f64,
    asked_mps: f64,
    last_s: f64,
}

impl Explorer {
    pub(super) fn new(scenario: &Scenario) -> Explorer {
        Explorer {
            world: scenario.world.clone(),
            stream: Stream::new(scenario.person.joystick_seed, Purpose::Whim),
            patience: Patience::default(),
            seen: VecDeque::with_capacity(DELAY + 1),
            turning: 0.0,
            asked_mps: 0.0,
            last_s: 0.0,
        }
    }

    fn free_m(&self, pose: &Pose, aside_rad: f64, t_s: f64) -> f64 {
        let free_m = self.world.ray_m(pose.position_m(), pose.theta_rad + aside_rad, 0.25, t_s);
        if free_m < 5.0 { free_m } else { 5.0 }
    }
}

impl Human for Explorer {
    fn joystick(&mut self, view: &HumanView) -> Option<Request> {
        let dt_s = view.t_s - self.last_s;
        self.last_s = view.t_s;
        let dice = self.stream.reading(view.index);
        if let Some((back, _)) = self.patience.lost(view, self.asked_mps, dt_s, dice) {
            self.asked_mps = 0.0;
            self.turning = 0.0;
            return Some(Request { v_mps: back[0], omega_radps: back[1], dead_man: true });
        }
        self.seen.push_back(view.pose);
        if self.seen.len() > DELAY {
            self.seen.pop_front();
        }
        let pose = self.seen.front().copied().unwrap_or(view.pose);
        let ahead_m = self.free_m(&pose, 0.0, view.t_s);
        if self.turning == 0.0 && ahead_m < TURN_M {
            let left_m = self.free_m(&pose, 0.8, view.t_s);
            let right_m = self.free_m(&pose, -0.8, view.t_s);
            self.turning = if left_m >= right_m { TURN_RADPS } else { -TURN_RADPS };
        } else if ahead_m > GO_M {
            self.turning = 0.0;
        }
        let temper = self.stream.reading(u64::MAX);
        let cruise_mps = temper.between(0, 0.3, 0.6);
        let phase = core::f64::consts::TAU * (view.t_s / WEAVE_S + temper.uniform(1));
        self.asked_mps = cruise_mps * ((ahead_m - 0.1) / GO_M).clamp(0.15, 1.0);
        let omega_radps =
            if self.turning == 0.0 { WEAVE_RADPS * libm::sin(phase) } else { self.turning };
        Some(Request { v_mps: self.asked_mps, omega_radps, dead_man: true })
    }
}
