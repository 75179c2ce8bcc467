//! The flowing person: steers as walkers do, by attraction of a goal and repulsion of what stands in
//! the way.
//!
//! Second-order dynamics of the heading after Fajen and Warren, "Behavioral dynamics of steering,
//! obstacle avoidance, and route selection" (2003), with their constants: the turn rate that is
//! asked for has inertia, so that the joystick is no function of the present state. Obstacles are
//! what nine looks ahead meet. Goals are their own and change; pushed against something they back
//! off and want something else.

use schemas::{Scenario, World};

use super::mood::{Patience, Wishes};
use super::{Human, HumanView, Request, wrap};
use crate::noise::{Purpose, Stream};

const DAMPING: f64 = 3.25;
const GOAL_STIFFNESS: f64 = 7.5;
const GOAL_DECAY_PER_M: f64 = 0.4;
const GOAL_FLOOR: f64 = 0.4;
const OBSTACLE_STIFFNESS: f64 = 198.0;
const OBSTACLE_DECAY_PER_RAD: f64 = 6.5;
const OBSTACLE_DECAY_PER_M: f64 = 0.8;

/// Looks to either side of straight on, and the angle between two, radians.
const LOOKS: i32 = 4;
const LOOK_RAD: f64 = 0.3;

/// How fast on a free way (m/s), and how quickly the speed asked for follows (s).
const CRUISE_MPS: f64 = 0.5;
const EASE_S: f64 = 0.6;

const ARRIVED_M: f64 = 0.4;

/// Mean time for which a goal holds, seconds.
const RESOLVE_S: f64 = 7.0;

pub(super) struct Flowing {
    world: World,
    wishes: Wishes,
    patience: Patience,
    stream: Stream,
    asked: [f64; 2],
    last_s: f64,
}

impl Flowing {
    pub(super) fn new(scenario: &Scenario) -> Flowing {
        Flowing {
            world: scenario.world.clone(),
            wishes: Wishes::new(scenario),
            patience: Patience::default(),
            stream: Stream::new(scenario.person.joystick_seed, Purpose::Whim),
            asked: [0.0; 2],
            last_s: 0.0,
        }
    }

    /// The angular acceleration of the heading, rad/s², and the free way ahead, metres.
    fn drawn(&self, view: &HumanView, way_m: [f64; 2], distance_m: f64) -> (f64, f64) {
        let pose = &view.pose;
        let error_rad = wrap(pose.theta_rad - libm::atan2(way_m[1], way_m[0]));
        let pull = libm::exp(-GOAL_DECAY_PER_M * distance_m) + GOAL_FLOOR;
        let mut accel = -DAMPING * self.asked[1] - GOAL_STIFFNESS * error_rad * pull;
        let mut ahead_m = f64::INFINITY;
        for look in -LOOKS..=LOOKS {
            let aside_rad = f64::from(look) * LOOK_RAD;
            let angle_rad = pose.theta_rad + aside_rad;
            let free_m = self.world.ray_m(pose.position_m(), angle_rad, 0.3, view.t_s);
            if free_m.is_nan() {
                continue;
            }
            if look == 0 {
                ahead_m = free_m;
            }
            let near = libm::exp(-OBSTACLE_DECAY_PER_M * (4.0 * free_m.max(0.0)));
            let off = libm::exp(-OBSTACLE_DECAY_PER_RAD * aside_rad.abs());
            // Straight on repels to neither side; the looks beside it decide.
            accel += OBSTACLE_STIFFNESS * -aside_rad * off * near;
        }
        (accel, ahead_m)
    }
}

impl Human for Flowing {
    fn joystick(&mut self, view: &HumanView) -> Option<Request> {
        let dt_s = view.t_s - self.last_s;
        self.last_s = view.t_s;
        let dice = self.stream.reading(view.index);
        if let Some((back, begins)) = self.patience.lost(view, self.asked[0], dt_s, dice) {
            if begins {
                self.wishes.change();
            }
            self.asked = [0.0; 2];
            return Some(Request { v_mps: back[0], omega_radps: back[1], dead_man: true });
        }
        let at_m = self.wishes.at_m();
        let way_m = [at_m[0] - view.pose.x_m, at_m[1] - view.pose.y_m];
        let distance_m = libm::hypot(way_m[0], way_m[1]);
        if distance_m < ARRIVED_M || dice.happens(0, dt_s / RESOLVE_S) {
            self.wishes.change();
        }
        let (accel, ahead_m) = self.drawn(view, way_m, distance_m);
        let cautious = (ahead_m / 1.5).clamp(0.2, 1.0);
        self.asked[0] += dt_s / EASE_S * (CRUISE_MPS * cautious - self.asked[0]);
        self.asked[1] = (self.asked[1] + accel * dt_s).clamp(-1.5, 1.5);
        Some(Request { v_mps: self.asked[0], omega_radps: self.asked[1], dead_man: true })
    }
}
