//! Open loop: the log drives the controller, and nothing moves differently.

use std::io::Read;
use std::sync::Arc;

use controller::{Runner, Session, Spec};
use schemas::log::LogError;
use schemas::{Command, Event, Pulled, Source, Stamped, Step, Time};

use crate::fault::{Faults, Faulty};
use crate::outcome::{Outcome, Tally};
use crate::recorded::setup;
use crate::tee::Events;
use crate::window::Between;
use crate::{Covered, ReplayError, WarmUp, Window};

/// A log as a source: its samples as they were, and a step wherever it recorded one.
struct LogSource<R> {
    log: Events<R>,
    /// What the recorded controller said since the last look: judged, never fed back.
    recorded: Vec<Stamped<Event>>,
}

impl<R: Read> Source for LogSource<R> {
    type Error = Arc<LogError>;

    fn pull(&mut self) -> Result<Option<Pulled>, Arc<LogError>> {
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
    session: Session<Faulty<LogSource<R>>>,
    tally: Tally,
    /// The recorded counterpart of the step handed out last.
    recorded_step: Option<Box<Step>>,
    between: Between,
    start: Time,
    ended: bool,
}

impl<R: Read> OpenLoop<R> {
    pub(crate) fn new(log: Events<R>, spec: &Spec) -> Result<OpenLoop<R>, ReplayError> {
        let header = log.header();
        let start = header.run.start;
        let runner = Runner::new(&setup(&header, spec)?)?;
        let (recorded, wanted) = (header.run.control_period_ns, runner.control_period());
        if recorded != wanted.0 {
            return Err(ReplayError::ControlPeriod {
                recorded_s: schemas::Span(recorded).seconds(),
                wanted_s: wanted.seconds(),
            });
        }
        Ok(OpenLoop {
            session: Session::new(
                Faulty::new(LogSource { log, recorded: Vec::new() }, start),
                runner,
            ),
            tally: Tally::new(Covered::Outputs, start),
            recorded_step: None,
            between: Between::new(Window::default(), start),
            start,
            ended: false,
        })
    }

    pub(crate) fn under(&mut self, faults: Faults) {
        self.session.source_mut().put(faults);
    }

    /// Replays a part only: what comes before is heard, and left unsaid.
    pub(crate) fn within(&mut self, window: Window) {
        self.between = Between::new(window, self.start);
    }

    pub(crate) fn next_event(&mut self) -> Option<Stamped<Event>> {
        loop {
            let event = self.advance()?;
            if event.at >= self.between.from {
                return Some(event);
            }
        }
    }

    /// The next event, be it on the way to the beginning or after it.
    fn advance(&mut self) -> Option<Stamped<Event>> {
        if self.ended {
            return None;
        }
        let next = self.session.next_event();
        let Between { from, to } = self.between;
        for event in self.session.source_mut().source_mut().recorded.drain(..) {
            if (from..=to).contains(&event.at) {
                self.tally.recorded(&event);
            }
            if let Event::Step(step) = event.value {
                self.recorded_step = Some(step);
            }
        }
        match next {
            Ok(Some(event)) if event.at > to => {
                self.ended = true;
                None
            }
            Ok(Some(event)) => {
                if event.at < from {
                    return Some(event);
                }
                self.tally.replayed(&event, self.recorded_step.as_deref());
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

    pub(crate) fn is_cut_short(&self) -> bool {
        self.tally.damage.is_some()
    }

    pub(crate) fn runner(&self) -> &Runner {
        self.session.runner()
    }

    pub(crate) fn finish(mut self) -> Result<Outcome, ReplayError> {
        let part = self.between.from > self.start;
        let unmet_faults = self.session.source_mut().unmet();
        let outcome = self.tally.finish()?;
        // The log itself led up to the beginning.
        Ok(Outcome { warm_up: part.then_some(WarmUp::Exact), unmet_faults, ..outcome })
    }
}
