//! Open loop: the log drives the controller, and nothing moves differently.

use std::io::Read;

use controller::{Runner, Session, Setup, Spec};
use schemas::log::{LogError, LogReader};
use schemas::{Command, Event, Pulled, Source, Stamped, Step};

use crate::outcome::{Outcome, Tally};
use crate::recorded::sensors_of;
use crate::{Covered, ReplayError};

/// A log as a source: its samples as they were, and a step wherever it recorded one.
struct LogSource<R> {
    log: LogReader<R>,
    /// What the recorded controller said since the last look: judged, never fed back.
    recorded: Vec<Stamped<Event>>,
}

impl<R: Read> Source for LogSource<R> {
    type Error = LogError;

    fn pull(&mut self) -> Result<Option<Pulled>, LogError> {
        while let Some(event) = self.log.next_event()? {
            let at = event.at;
            match &event.value {
                Event::Step(step) => {
                    let now = step.stamp;
                    self.recorded.push(event);
                    return Ok(Some(Pulled::StepDue { at, now }));
                }
                Event::Command(_) => self.recorded.push(event),
                _ => return Ok(Some(Pulled::Event(event))),
            }
        }
        Ok(None)
    }

    fn actuate(&mut self, _: &Command) {}
}

pub(crate) struct OpenLoop<R> {
    session: Session<LogSource<R>>,
    tally: Tally,
    /// The recorded counterpart of the step handed out last.
    recorded_step: Option<Box<Step>>,
    ended: bool,
}

impl<R: Read> OpenLoop<R> {
    pub(crate) fn new(log: LogReader<R>, spec: &Spec) -> Result<OpenLoop<R>, ReplayError> {
        let header = log.header().clone();
        let start = header.run.start;
        let setup = Setup {
            spec: spec.clone(),
            sensors: sensors_of(&header)?,
            scenario: header.scenario,
            start,
        };
        let runner = Runner::new(&setup)?;
        let (recorded, wanted) = (header.run.control_period_ns, runner.control_period());
        if recorded != wanted.0 {
            return Err(ReplayError::ControlPeriod {
                recorded_s: schemas::Span(recorded).seconds(),
                wanted_s: wanted.seconds(),
            });
        }
        Ok(OpenLoop {
            session: Session::new(LogSource { log, recorded: Vec::new() }, runner),
            tally: Tally::new(Covered::Outputs, start),
            recorded_step: None,
            ended: false,
        })
    }

    pub(crate) fn next_event(&mut self) -> Option<Stamped<Event>> {
        if self.ended {
            return None;
        }
        let next = self.session.next_event();
        for event in self.session.source_mut().recorded.drain(..) {
            self.tally.recorded(&event);
            if let Event::Step(step) = event.value {
                self.recorded_step = Some(step);
            }
        }
        match next {
            Ok(Some(event)) => {
                self.tally.replayed(&event);
                if let (Event::Step(step), Some(recorded)) = (&event.value, &self.recorded_step) {
                    self.tally.compare_steps(step, recorded);
                }
                Some(event)
            }
            Ok(None) => {
                self.ended = true;
                None
            }
            Err(error) => {
                self.tally.damage = Some(error);
                self.ended = true;
                None
            }
        }
    }

    pub(crate) fn runner(&self) -> &Runner {
        self.session.runner()
    }

    pub(crate) fn finish(self) -> Result<Outcome, ReplayError> {
        self.tally.finish()
    }
}
