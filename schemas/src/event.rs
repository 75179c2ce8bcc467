//! Everything that a session log holds, and where a session's events come from.

use crate::{Command, Gap, Sample, Stamped, Step, Time, Timing, Truth};

/// One typed message of a session.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// An input of the controller.
    Sample(Sample),
    /// One step of the controller. Boxed: it is much larger than the rest.
    Step(Box<Step>),
    /// What went to the actuators.
    Command(Command),
    /// What really happened (simulation only).
    Truth(Truth),
    /// A stretch without a stream that should have been there.
    Gap(Gap),
    /// Measured wall time of a step; never compared.
    Timing(Timing),
}

/// What a [`Source`] hands to the loop that steps a controller.
#[derive(Clone, Debug, PartialEq)]
pub enum Pulled {
    /// Something to log, and to show to the controller if it is a sample.
    Event(Stamped<Event>),
    /// The controller is to step now.
    StepDue {
        /// Log time of the step's record.
        at: Time,
        /// The instant the step stands for: the `stamp` of the resulting [`Step`].
        now: Time,
    },
}

/// Where the events of a session come from: a simulation, a robot, or a log.
///
/// Events arrive in the order in which they are to be logged, with strictly increasing log times.
pub trait Source {
    /// What can go wrong on the way.
    type Error;

    /// The next event, or `None` at the end of the session.
    ///
    /// # Errors
    /// When the source fails before its end; the session up to here stays valid.
    fn pull(&mut self) -> Result<Option<Pulled>, Self::Error>;

    /// Gives the robot its next command. A log ignores it: what happened has happened.
    fn actuate(&mut self, command: &Command);
}
