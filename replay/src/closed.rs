//! Closed loop: the recorded person drives a simulated robot in the log's own world.

use std::io::Read;

use controller::{Runner, Session, Setup, Spec};
use schemas::log::LogReader;
use schemas::{Event, Span, Stamped};
use simulator::{Simulation, SimulationSetup};

use crate::human::Person;
use crate::outcome::{Outcome, Tally};
use crate::recorded::{Recorded, sensors_of};
use crate::{Covered, ReplayError};

/// Longer than any log: a replay ends where the recording ends.
const UNTIL_THE_RECORDING_ENDS: Span = Span(u64::MAX / 4);

pub(crate) struct ClosedLoop<R> {
    session: Session<Simulation>,
    recorded: Recorded<R>,
    tally: Tally,
    ended: bool,
}

impl<R: Read> ClosedLoop<R> {
    /// `log` is compared against; `person` is a second reader of the same log.
    pub(crate) fn new(
        log: LogReader<R>,
        person: LogReader<R>,
        spec: &Spec,
        model: Person,
    ) -> Result<ClosedLoop<R>, ReplayError>
    where
        R: 'static,
    {
        let header = log.header().clone();
        let (sensors, start) = (sensors_of(&header)?, header.run.start);
        let setup = Setup { spec: spec.clone(), scenario: header.scenario, sensors, start };
        let runner = Runner::new(&setup)?;
        let human = model.of_log(person)?;
        let simulation = Simulation::new(
            SimulationSetup {
                scenario: setup.scenario,
                sensors,
                seed: header.run.seed,
                start,
                control_period: runner.control_period(),
                duration: UNTIL_THE_RECORDING_ENDS,
            },
            human,
        )?;
        Ok(ClosedLoop {
            session: Session::new(simulation, runner),
            recorded: Recorded::new(log),
            tally: Tally::new(Covered::Everything, start),
            ended: false,
        })
    }

    pub(crate) fn next_event(&mut self) -> Option<Stamped<Event>> {
        if self.ended {
            return None;
        }
        let Ok(next) = self.session.next_event();
        let event = next.filter(|event| {
            self.recorded.advance(event.at, |recorded| self.tally.recorded(recorded))
        });
        let Some(event) = event else {
            self.ended = true;
            self.tally.damage = self.recorded.damage();
            return None;
        };
        self.tally.replayed(&event);
        if let (Event::Step(step), Some(recorded)) = (&event.value, &self.recorded.step)
            && step.stamp == recorded.stamp
        {
            self.tally.compare_steps(step, recorded);
        }
        Some(event)
    }

    pub(crate) fn runner(&self) -> &Runner {
        self.session.runner()
    }

    pub(crate) fn finish(self) -> Result<Outcome, ReplayError> {
        self.tally.finish()
    }
}
