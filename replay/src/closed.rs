//! Closed loop: the recorded person drives a simulated robot in the log's own world.

use std::io::Read;
use std::sync::Arc;

use controller::{Runner, Session, Setup, Spec};
use schemas::log::LogReader;
use schemas::{Event, Span, Stamped, Time};
use simulator::{Simulation, SimulationSetup};

use crate::horizon::{Horizon, Watch};
use crate::human::Person;
use crate::outcome::{Outcome, Tally};
use crate::recorded::{Recorded, sensors_of};
use crate::{Covered, Recording, ReplayError};

/// Longer than any log: a replay ends where the recording ends.
const UNTIL_THE_RECORDING_ENDS: Span = Span(u64::MAX / 4);

pub(crate) struct ClosedLoop<R> {
    session: Session<Simulation>,
    beside: Beside<R>,
    tally: Tally,
    watch: Watch,
    ended: bool,
}

/// What a closed-loop replay is held against, and ended by.
enum Beside<R> {
    /// The recording itself, message by message.
    Log(Box<Recorded<R>>),
    /// Nothing but its end: one arm of several over one reading of the log.
    Until(Time),
}

impl<R: Read> ClosedLoop<R> {
    /// A replay that is compared with `log` message by message.
    pub(crate) fn beside(
        log: LogReader<R>,
        recording: &Arc<Recording>,
        spec: &Spec,
        person: Person,
    ) -> Result<ClosedLoop<R>, ReplayError> {
        ClosedLoop::new(Beside::Log(Box::new(Recorded::new(log))), recording, spec, person)
    }

    /// A replay that needs the log no more.
    pub(crate) fn alone(
        recording: &Arc<Recording>,
        spec: &Spec,
        person: Person,
    ) -> Result<ClosedLoop<R>, ReplayError> {
        ClosedLoop::new(Beside::Until(recording.end()), recording, spec, person)
    }

    fn new(
        beside: Beside<R>,
        recording: &Arc<Recording>,
        spec: &Spec,
        person: Person,
    ) -> Result<ClosedLoop<R>, ReplayError> {
        let header = recording.header();
        let (sensors, start) = (sensors_of(header)?, header.run.start);
        let scenario = header.scenario.clone();
        let setup = Setup { spec: spec.clone(), scenario, sensors, start };
        let runner = Runner::new(&setup)?;
        let simulation = Simulation::new(
            SimulationSetup {
                scenario: setup.scenario,
                sensors,
                seed: header.run.seed,
                start,
                control_period: runner.control_period(),
                duration: UNTIL_THE_RECORDING_ENDS,
            },
            person.of_recording(recording),
        )?;
        Ok(ClosedLoop {
            session: Session::new(simulation, runner),
            beside,
            tally: Tally::new(Covered::Everything, start),
            watch: Watch::new(Arc::clone(recording), person.gains()),
            ended: false,
        })
    }

    pub(crate) fn next_event(&mut self) -> Option<Stamped<Event>> {
        if self.ended {
            return None;
        }
        let Ok(next) = self.session.next_event();
        let event = next.filter(|event| match &mut self.beside {
            Beside::Log(log) => log.advance(event.at, |recorded| self.tally.recorded(recorded)),
            Beside::Until(end) => event.at <= *end,
        });
        let Some(event) = event else {
            self.ended = true;
            if let Beside::Log(log) = &mut self.beside {
                self.tally.damage = log.damage();
            }
            return None;
        };
        self.tally.replayed(&event);
        self.watch.observe(&event);
        if let (Event::Step(step), Beside::Log(log)) = (&event.value, &self.beside)
            && let Some(recorded) = &log.step
            && step.stamp == recorded.stamp
        {
            self.tally.compare_steps(step, recorded);
        }
        Some(event)
    }

    pub(crate) fn runner(&self) -> &Runner {
        self.session.runner()
    }

    /// When the run parted from the recording, so far.
    pub(crate) fn horizon(&self) -> Horizon {
        self.watch.horizon()
    }

    pub(crate) fn finish(self) -> Result<Outcome, ReplayError> {
        let alone = matches!(self.beside, Beside::Until(_));
        let mut outcome = self.tally.finish()?;
        outcome.horizon = Some(self.watch.horizon());
        outcome.furthest = Some(self.watch.furthest());
        outcome.identical_to_recorded &= !alone;
        Ok(outcome)
    }
}
