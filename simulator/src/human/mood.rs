//! What reactive people have in common: places they want to be, and noticing that nothing moves.

use schemas::{Footprint, Pose, Scenario, World};

use super::HumanView;
use crate::noise::{Purpose, Reading, Stream};

/// How much room a person leaves about a place they want to be, metres.
const ROOM_M: f64 = 0.45;

/// How far from the start people want to go, metres.
const REACH_M: f64 = 4.0;

/// How often a place is drawn anew because something stands there.
const DRAWS: u64 = 100;

/// The places that a person wants to be at, one after the other.
pub(super) struct Wishes {
    world: World,
    about_m: [f64; 2],
    stream: Stream,
    count: u64,
    at_m: [f64; 2],
}

impl Wishes {
    pub(super) fn new(scenario: &Scenario) -> Wishes {
        let mut wishes = Wishes {
            world: scenario.world.clone(),
            about_m: scenario.start.pose.position_m(),
            stream: Stream::new(scenario.person.joystick_seed, Purpose::Wish),
            count: 0,
            at_m: [0.0; 2],
        };
        wishes.change();
        wishes
    }

    /// The place wanted now, metres.
    pub(super) fn at_m(&self) -> [f64; 2] {
        self.at_m
    }

    /// Wants something else.
    pub(super) fn change(&mut self) {
        let draw = self.stream.reading(self.count);
        self.count += 1;
        let place = |i: u64| {
            [0, 1].map(|axis| {
                self.about_m[axis as usize] + draw.between(2 * i + axis, -REACH_M, REACH_M)
            })
        };
        let free = |at_m: &[f64; 2]| {
            let pose = Pose { x_m: at_m[0], y_m: at_m[1], theta_rad: 0.0 };
            self.world.clearance_static_m(&Footprint::POINT, &pose) > ROOM_M
        };
        self.at_m = (0..DRAWS).map(place).find(free).unwrap_or(self.about_m);
    }
}

/// Noticing that the stick is pushed and nothing moves, and backing off for a while.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Patience {
    pushed_s: f64,
    from_m: [f64; 2],
    until_s: f64,
    side: f64,
    tried: u64,
}

/// How long a person pushes in vain, seconds.
const PATIENCE_S: f64 = 1.0;

/// Less than this is not moving, metres.
const STUCK_M: f64 = 0.05;

/// Backing off: how fast (m/s), with how much turning (rad/s).
const BACK_OFF: [f64; 2] = [-0.3, 0.6];

impl Patience {
    /// What a person who has lost patience asks for, if they have; `asked_mps` is what they asked
    /// for last, `dt_s` how long ago. The second value says that backing off begins now.
    pub(super) fn lost(
        &mut self,
        view: &HumanView,
        asked_mps: f64,
        dt_s: f64,
        dice: Reading,
    ) -> Option<([f64; 2], bool)> {
        if view.t_s < self.until_s {
            return Some(([BACK_OFF[0], self.side * BACK_OFF[1]], false));
        }
        let at_m = view.pose.position_m();
        let moved_m = libm::hypot(at_m[0] - self.from_m[0], at_m[1] - self.from_m[1]);
        if asked_mps < 0.1 || moved_m > STUCK_M {
            self.pushed_s = 0.0;
            self.from_m = at_m;
            return None;
        }
        self.pushed_s += dt_s;
        if self.pushed_s < PATIENCE_S {
            return None;
        }
        self.pushed_s = 0.0;
        self.tried += 1;
        self.until_s = view.t_s + dice.between(90, 0.6, 1.4);
        self.side = if dice.happens(91, 0.5) { 1.0 } else { -1.0 };
        Some(([BACK_OFF[0], self.side * BACK_OFF[1]], true))
    }
}
