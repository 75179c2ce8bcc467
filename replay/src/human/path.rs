//! The recorded joystick as a function of the distance travelled.

use std::sync::Arc;

use simulator::{Human, HumanView, Request};

use crate::recording::Recording;

/// Asks for what was recorded where the robot had come as far as it has now. A stretch in which the
/// recorded robot stood still takes its recorded time. A robot that is held up where the recorded
/// one drove hears the same for ever: a person who never gives in.
pub(crate) struct Path {
    recording: Arc<Recording>,
    /// Metres travelled until each tick of the recording.
    travelled_m: Vec<f64>,
    /// The tick that is being played; `None` before the first.
    playing: Option<usize>,
    /// Metres travelled by the simulated robot.
    driven_m: f64,
    last_m: Option<[f64; 2]>,
}

impl Path {
    pub(crate) fn new(recording: Arc<Recording>) -> Path {
        let mut last_m = None;
        let mut driven_m = 0.0;
        let travelled_m = recording
            .moments()
            .iter()
            .map(|moment| {
                if let Some(state) = moment.state {
                    driven_m += leg(&mut last_m, state.pose.position_m());
                }
                driven_m
            })
            .collect();
        Path { recording, travelled_m, playing: None, driven_m: 0.0, last_m: None }
    }

    /// Moves on as far as the robot has come.
    fn advance(&mut self) {
        let mut playing = match self.playing {
            None => 0,
            Some(playing) if playing + 1 < self.travelled_m.len() => {
                if self.travelled_m[playing + 1] > self.driven_m {
                    return;
                }
                playing + 1
            }
            Some(playing) => playing,
        };
        // Catch up, but not over a rest.
        while playing + 1 < self.travelled_m.len()
            && self.travelled_m[playing + 1] <= self.driven_m
            && self.travelled_m[playing + 1] > self.travelled_m[playing]
        {
            playing += 1;
        }
        self.playing = Some(playing);
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
        self.recording.moment(view.index)?;
        let way_m = leg(&mut self.last_m, view.pose.position_m());
        if way_m.is_finite() {
            self.driven_m += way_m;
        }
        self.advance();
        self.recording.moments().get(self.playing?)?.request
    }
}
