//! Models of the recorded person, to bring them back in closed loop: a ladder.
//!
//! A person reacts to what the robot does, so the recorded joystick is strictly valid only on the
//! recorded path. Each level assumes something else about what they would have done off it:
//!
//! | level | what is kept | what it is for |
//! |---|---|---|
//! | `playback` | the joystick as a function of time | stress: a person who does not look |
//! | `path` | the joystick as a function of distance travelled | stress: one who never gives in |
//! | `intent` | where the joystick pointed | estimate: nothing fitted |
//! | `fitted` | goals, gains, and what they leave unexplained | estimate |
//!
//! On the recorded states every level gives the recorded joystick back bit for bit, so that with the
//! recording controller every level is the recording.

mod anchored;
mod bearing;
mod fitted;
mod follower;
mod gains;
mod goals;
mod path;
mod playback;
mod rank;
mod reaction;
mod surprise;
mod target;
mod ways;

use std::sync::Arc;

use simulator::Human;

use crate::Recording;
use anchored::Anchored;
pub use bearing::Gains;
pub(crate) use fitted::{Explanations, Fit, Fitted, state_distance};
use follower::Follower;
use path::Path;
use playback::Playback;
pub use reaction::Reaction;
use target::Target;

/// How the recorded person is brought back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Person {
    /// The joystick as a function of time.
    Playback,
    /// The joystick as a function of the distance travelled.
    Path,
    /// Where the joystick pointed.
    Intent,
    /// The law of a fitted person with the recorded residual; gains from a pool of logs.
    Fitted(Gains),
}

impl Person {
    /// Every level, from the one that assumes least about a reaction to the one that assumes most.
    pub fn ladder(gains: Gains) -> [Person; 4] {
        [Person::Playback, Person::Path, Person::Intent, Person::Fitted(gains)]
    }

    /// The name on the command line and in logs.
    pub fn name(self) -> &'static str {
        match self {
            Person::Playback => "playback",
            Person::Path => "path",
            Person::Intent => "intent",
            Person::Fitted(_) => "fitted",
        }
    }

    /// Whether the level is meant as an estimate of what the person would have done; the others show
    /// how much depends on it.
    pub fn is_estimate(self) -> bool {
        matches!(self, Person::Intent | Person::Fitted(_))
    }

    /// The gains that the level goes by, or the prior where it has none of its own.
    pub(crate) fn gains(self) -> Gains {
        match self {
            Person::Fitted(gains) => gains,
            _ => Gains::PRIOR,
        }
    }

    /// The person of a recording.
    pub(crate) fn of_recording(self, recording: &Arc<Recording>) -> Box<dyn Human> {
        let shared = || Arc::clone(recording);
        // Someone who did not look would have done the same anywhere.
        let blind = self.is_estimate() && Reaction::of(recording).is_blind();
        match if blind { Person::Playback } else { self } {
            Person::Playback => Box::new(Anchored::new(shared(), Playback)),
            Person::Path => Box::new(Path::new(recording)),
            Person::Intent => match recording.header().scenario.task {
                Some(task) => {
                    let habits = goals::habits(recording);
                    let follower = Follower::new(task, Gains::PRIOR, habits);
                    Box::new(Anchored::new(shared(), follower))
                }
                None => Box::new(Anchored::new(shared(), Target)),
            },
            Person::Fitted(gains) => {
                Box::new(Anchored::new(shared(), Fitted::new(Fit::new(recording, gains))))
            }
        }
    }
}

#[cfg(test)]
mod tests;
