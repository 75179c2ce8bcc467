//! Recorded logs through a controller again.
//!
//! - [`Mode::Open`]: recorded sensors and joystick in, at the recorded step times; only the
//!   controller's outputs are new. It answers what a controller would have *said*.
//! - [`Mode::Closed`]: the recorded person ([`Person`]) drives a simulated robot in the log's own
//!   world; sensors are simulated anew from the recorded seed. It answers what would have
//!   *happened*.
//!
//! In goes a [`LogReader`] and a controller's [`Spec`];
//! out come the events of the replayed session, one by one ([`Replay::next_event`]), and an
//! [`Outcome`] that says whether they are those of the recording, bit for bit. Replay re-executes:
//! nothing that the recorded controller said is ever copied into a result.

mod closed;
mod error;
#[cfg(test)]
mod exactness;
mod fault;
mod hash;
mod horizon;
mod human;
mod led;
mod map;
mod open;
mod outcome;
mod plant;
mod recorded;
mod recording;
#[cfg(test)]
mod session;
mod tee;
mod window;

pub use error::ReplayError;
pub use fault::{BadFault, FAULTS, Fault, Faults};
pub use hash::{Covered, OutputHash};
pub use horizon::Horizon;
pub use human::{Gains, Person, Reaction};
pub use map::Map;
pub use outcome::{Deviation, FirstDifference, Outcome};
pub use plant::{AxisDoubt, Estimate, PlantClaim, PlantDoubt, PlantEstimate, Untold};
pub use recorded::setup;
pub use recording::Recording;
pub use window::{WarmUp, Window};

use std::io::Read;
use std::sync::Arc;

use controller::{Mutation, Runner, Spec};
use schemas::log::LogReader;
use schemas::{Event, Stamped};

use tee::Events;

/// How a log is replayed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    /// Recorded sensors in, outputs compared.
    Open,
    /// Recorded person, simulated robot.
    Closed(Person),
}

impl Mode {
    /// The name in logs and machine-readable output: `open` or `closed`.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Open => "open",
            Mode::Closed(_) => "closed",
        }
    }
}

/// A replay under way: a session that is pulled event by event.
pub struct Replay<R>(Kind<R>);

enum Kind<R> {
    Open(Box<open::OpenLoop<R>>),
    Closed(Box<closed::ClosedLoop<R>>),
}

impl<R: Read + 'static> Replay<R> {
    /// Prepares a replay. `open` opens the log; it is called more than once, because a closed loop
    /// reads the person and the recording side by side.
    ///
    /// # Errors
    /// The log cannot be read, the controller cannot be built for its scenario, or the log lacks
    /// what the mode needs.
    pub fn new<F>(open: F, spec: &Spec, mode: Mode) -> Result<Replay<R>, ReplayError>
    where
        F: Fn() -> Result<LogReader<R>, schemas::log::LogError>,
    {
        Ok(Replay(match mode {
            Mode::Open => {
                Kind::Open(Box::new(open::OpenLoop::new(Events::Own(Box::new(open()?)), spec)?))
            }
            Mode::Closed(person) => {
                let recording = Arc::new(Recording::read(open()?)?);
                return Replay::beside(open()?, &recording, spec, person);
            }
        }))
    }

    /// Prepares a closed-loop replay of a log whose person has been read already.
    ///
    /// # Errors
    /// As [`Replay::new`].
    pub fn beside(
        log: LogReader<R>,
        recording: &Arc<Recording>,
        spec: &Spec,
        person: Person,
    ) -> Result<Replay<R>, ReplayError> {
        let replay = closed::ClosedLoop::beside(log, recording, spec, person)?;
        Ok(Replay(Kind::Closed(Box::new(replay))))
    }

    /// Prepares open-loop replays into several controllers over one reading of a log. They are to be
    /// walked side by side: what one has read waits for the others.
    ///
    /// # Errors
    /// By controller, as [`Replay::new`].
    pub fn side_by_side(log: LogReader<R>, specs: &[Spec]) -> Vec<Result<Replay<R>, ReplayError>> {
        let shares = Events::shared(log, specs.len());
        let prepare =
            |(share, spec)| Ok(Replay(Kind::Open(Box::new(open::OpenLoop::new(share, spec)?))));
        shares.into_iter().zip(specs).map(prepare).collect()
    }

    /// Prepares one arm of several closed-loop replays over one reading of a log. It is not compared
    /// with the recording.
    ///
    /// # Errors
    /// The controller cannot be built for the log's scenario, or its sensors cannot be simulated.
    pub fn of_recording(
        recording: &Arc<Recording>,
        spec: &Spec,
        person: Person,
    ) -> Result<Replay<R>, ReplayError> {
        let replay = closed::ClosedLoop::alone(recording, spec, person)?;
        Ok(Replay(Kind::Closed(Box::new(replay))))
    }

    /// The same with a controller that is wrong on purpose.
    ///
    /// # Errors
    /// As [`Replay::of_recording`].
    pub fn of_mutant(
        recording: &Arc<Recording>,
        spec: &Spec,
        person: Person,
        mutation: Mutation,
    ) -> Result<Replay<R>, ReplayError> {
        let replay = closed::ClosedLoop::of_mutant(recording, spec, person, mutation)?;
        Ok(Replay(Kind::Closed(Box::new(replay))))
    }

    /// Puts faults between the source and the controller. To be called before the first event.
    #[must_use]
    pub fn under(mut self, faults: Faults) -> Replay<R> {
        match &mut self.0 {
            Kind::Open(replay) => replay.under(faults),
            Kind::Closed(replay) => replay.under(faults),
        }
        self
    }

    /// Replays a part of the log only. `log` is another reader of it, whose commands lead a closed loop
    /// up to the beginning. To be called before the first event.
    #[must_use]
    pub fn within(mut self, window: Window, log: LogReader<R>) -> Replay<R> {
        match &mut self.0 {
            Kind::Open(replay) => replay.within(window),
            Kind::Closed(replay) => replay.within(window, log),
        }
        self
    }

    /// The next event of the replayed session in log order, or `None` at its end. Damage in the log
    /// ends the session early; [`Replay::finish`] reports it.
    pub fn next_event(&mut self) -> Option<Stamped<Event>> {
        match &mut self.0 {
            Kind::Open(replay) => replay.next_event(),
            Kind::Closed(replay) => replay.next_event(),
        }
    }

    /// Whether damage in the log ended the session early, once it has ended.
    pub fn is_cut_short(&self) -> bool {
        match &self.0 {
            Kind::Open(replay) => replay.is_cut_short(),
            Kind::Closed(replay) => replay.is_cut_short(),
        }
    }

    /// The controller, as the last event left it: what it saw can be asked of it.
    pub fn runner(&self) -> &Runner {
        match &self.0 {
            Kind::Open(replay) => replay.runner(),
            Kind::Closed(replay) => replay.runner(),
        }
    }

    /// Closed loop: when the replay parted from the recording, as far as it has come.
    pub fn horizon(&self) -> Option<Horizon> {
        match &self.0 {
            Kind::Open(_) => None,
            Kind::Closed(replay) => Some(replay.horizon()),
        }
    }

    /// What came of it.
    ///
    /// # Errors
    /// The replay processed no step: nothing was replayed, so nothing can be said.
    pub fn finish(self) -> Result<Outcome, ReplayError> {
        match self.0 {
            Kind::Open(replay) => replay.finish(),
            Kind::Closed(replay) => replay.finish(),
        }
    }
}
