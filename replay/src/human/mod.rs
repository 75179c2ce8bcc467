//! Models of the recorded person, to bring them back in closed loop.

mod playback;

use std::io::Read;

use schemas::log::LogReader;
use simulator::Human;

use crate::ReplayError;
use playback::Playback;

/// How the recorded person is brought back. A person reacts to what the robot does, so a recorded
/// joystick is strictly valid only on the recorded path: playback is a stress level, not an
/// estimate of what the person would have done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Person {
    /// The joystick as a function of time.
    Playback,
}

impl Person {
    /// The name on the command line and in logs.
    pub fn name(self) -> &'static str {
        match self {
            Person::Playback => "playback",
        }
    }

    /// The person of a log.
    pub(crate) fn of_log<R: Read + 'static>(
        self,
        log: LogReader<R>,
    ) -> Result<Box<dyn Human>, ReplayError> {
        match self {
            Person::Playback => Ok(Box::new(Playback::new(log)?)),
        }
    }
}
