//! The recorded joystick as a function of the distance travelled.

use simulator::{Human, HumanView, Request};

use crate::recording::{Look, Recording};

/// Asks for what was recorded where the robot had come as far as it has now. A stretch in which the
/// recorded robot stood still takes its recorded time. A robot that is held up where the recorded
/// one drove hears the same for ever: a person who never gives in.
pub(crate) struct Path {
    /// The recording, as far as it is being played; `None` before the first tick.
    playing: Option<Travel>,
    look: Look,
    /// Metres travelled by the simulated robot.
    driven_m: f64,
    last_m: Option<[f64; 2]>,
}

impl Path {
    pub(crate) fn new(recording: &Recording) -> Path {
        Path { playing: None, look: recording.look(), driven_m: 0.0, last_m: None }
    }

    /// Moves on as far as the robot has come.
    fn advance(&mut self) {
        let travel = match &mut self.playing {
            None => self.playing.insert(Travel::new(&mut self.look)),
            Some(travel) => {
                if travel.next_m.is_some_and(|next_m| next_m > self.driven_m) {
                    return;
                }
                travel.go_on(&mut self.look);
                travel
            }
        };
        // Catch up, but not over a rest.
        while travel
            .next_m
            .is_some_and(|next_m| next_m <= self.driven_m && next_m > travel.travelled_m)
        {
            travel.go_on(&mut self.look);
        }
    }
}

/// How far the recorded robot had come.
struct Travel {
    tick: usize,
    /// Metres travelled until that tick.
    travelled_m: f64,
    /// Metres travelled until the next; `None` at the last.
    next_m: Option<f64>,
    last_m: Option<[f64; 2]>,
}

impl Travel {
    /// At the first tick.
    fn new(look: &mut Look) -> Travel {
        let mut travel = Travel { tick: 0, travelled_m: 0.0, next_m: None, last_m: None };
        travel.travelled_m = travel.until(look, 0).unwrap_or(0.0);
        travel.next_m = travel.until(look, 1);
        travel
    }

    /// Metres travelled until a tick, the one after that which is known; `None` after the last.
    fn until(&mut self, look: &mut Look, tick: usize) -> Option<f64> {
        let state = look.at(tick)?.state;
        let way_m = state.map_or(0.0, |state| leg(&mut self.last_m, state.pose.position_m()));
        Some(self.travelled_m + way_m)
    }

    /// Moves on by a tick, if there is one.
    fn go_on(&mut self, look: &mut Look) {
        if let Some(next_m) = self.next_m {
            (self.tick, self.travelled_m) = (self.tick + 1, next_m);
            self.next_m = self.until(look, self.tick + 1);
        }
    }
}

/// The distance from the last place to this one, metres.
fn leg(last_m: &mut Option<[f64; 2]>, at_m: [f64; 2]) -> f64 {
    let before = last_m.replace(at_m).unwrap_or(at_m);
    libm::hypot(at_m[0] - before[0], at_m[1] - before[1])
}

impl Human for Path {
    fn joystick(&mut self, view: &HumanView) -> Option<Request> {
        // The recording's end is the person's end, wherever the robot has come to.
        if view.index >= self.look.len() as u64 {
            return None;
        }
        let way_m = leg(&mut self.last_m, view.pose.position_m());
        if way_m.is_finite() {
            self.driven_m += way_m;
        }
        self.advance();
        self.look.at(self.playing.as_ref()?.tick)?.request
    }
}
