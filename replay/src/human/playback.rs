//! The recorded joystick as a function of time.

use super::anchored::Model;
use crate::recording::State;

/// Asks for what was recorded, wherever the robot is.
pub(crate) struct Playback;

impl Model for Playback {
    fn ask(&mut self, _: usize, _: &State, _: &State, asked: [f64; 2]) -> [f64; 2] {
        asked
    }
}
