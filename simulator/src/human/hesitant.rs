//! The hesitant person: acts and waits, in a few positions of the stick, and makes mistakes.
//!
//! Intermittent control: a decision every quarter to six tenths of a second, held until the next;
//! the stick goes to one of a few positions. One decision in twelve is wrong: the wrong way, or a
//! stop for nothing. Goals are their own and change; pushed against something they back off.

use schemas::Scenario;

use super::mood::{Patience, Wishes};
use super::{Human, HumanView, Request, wrap};
use crate::noise::{Purpose, Stream};

/// Probability that a decision is a mistake.
const MISTAKE: f64 = 0.08;

/// Probability that a decision is for another goal.
const CHANGE_OF_MIND: f64 = 0.04;

/// Bearing errors, radians, up to which the stick goes to each turn, rad/s, and speed, m/s.
const POSITIONS: [(f64, f64, f64); 4] =
    [(0.15, 0.0, 0.55), (0.5, 0.35, 0.4), (1.2, 0.8, 0.2), (f64::INFINITY, 1.3, 0.0)];

/// Nearer than this they have arrived, metres.
const ARRIVED_M: f64 = 0.4;

pub(super) struct Hesitant {
    wishes: Wishes,
    patience: Patience,
    stream: Stream,
    decisions: u64,
    until_s: f64,
    holding: [f64; 2],
    last_s: f64,
}

impl Hesitant {
    pub(super) fn new(scenario: &Scenario) -> Hesitant {
        Hesitant {
            wishes: Wishes::new(scenario),
            patience: Patience::default(),
            stream: Stream::new(scenario.person.joystick_seed, Purpose::Whim),
            decisions: 0,
            until_s: 0.0,
            holding: [0.0; 2],
            last_s: 0.0,
        }
    }

    fn decide(&mut self, view: &HumanView) {
        let dice = self.stream.reading(self.decisions);
        self.decisions += 1;
        self.until_s = view.t_s + dice.between(0, 0.25, 0.6);
        let way_m = {
            let at_m = self.wishes.at_m();
            [at_m[0] - view.pose.x_m, at_m[1] - view.pose.y_m]
        };
        if libm::hypot(way_m[0], way_m[1]) < ARRIVED_M || dice.happens(1, CHANGE_OF_MIND) {
            self.wishes.change();
        }
        let error_rad = wrap(libm::atan2(way_m[1], way_m[0]) - view.pose.theta_rad);
        let [.., turned_round] = POSITIONS;
        let (_, turn_radps, v_mps) = POSITIONS
            .into_iter()
            .find(|(up_to_rad, ..)| error_rad.abs() <= *up_to_rad)
            .unwrap_or(turned_round);
        let mut omega_radps = if error_rad < 0.0 { -turn_radps } else { turn_radps };
        let mut v_mps = v_mps;
        if dice.happens(2, MISTAKE) {
            if dice.happens(3, 0.5) {
                omega_radps = -omega_radps;
            } else {
                v_mps = 0.0;
            }
        }
        self.holding = [v_mps, omega_radps];
    }
}

impl Human for Hesitant {
    fn joystick(&mut self, view: &HumanView) -> Option<Request> {
        let dt_s = view.t_s - self.last_s;
        self.last_s = view.t_s;
        let dice = self.stream.reading(self.decisions);
        if let Some((back, begins)) = self.patience.lost(view, self.holding[0], dt_s, dice) {
            if begins && dice.happens(92, 0.5) {
                self.wishes.change();
            }
            self.until_s = view.t_s;
            self.holding = [0.0; 2];
            return Some(Request { v_mps: back[0], omega_radps: back[1], dead_man: true });
        }
        if view.t_s >= self.until_s {
            self.decide(view);
        }
        let [v_mps, omega_radps] = self.holding;
        Some(Request { v_mps, omega_radps, dead_man: true })
    }
}
