//! The one stepping loop of live, open-loop and closed-loop sessions.
//!
//! A [`Session`] pulls events from a [`Source`], shows samples to the [`Runner`], steps it when the
//! source says so, gives the command back to the source, and hands everything on in log order. It
//! is pulled rather than pushed, so that two sessions can be walked side by side.

use schemas::{Command, Event, Pulled, Source, Stamped};

use crate::Runner;

/// A source and the controller that reacts to it.
pub struct Session<S> {
    source: S,
    runner: Runner,
    /// The command of the step just handed out; it follows its step in the log.
    command: Option<Stamped<Command>>,
}

impl<S: Source> Session<S> {
    /// A session that has not begun.
    pub fn new(source: S, runner: Runner) -> Session<S> {
        Session { source, runner, command: None }
    }

    /// The next event in log order, or `None` at the end of the source.
    ///
    /// # Errors
    /// Whatever the source reports; what was handed out before stays valid.
    pub fn next_event(&mut self) -> Result<Option<Stamped<Event>>, S::Error> {
        if let Some(Stamped { at, value }) = self.command.take() {
            return Ok(Some(Stamped { at, value: Event::Command(value) }));
        }
        let Some(pulled) = self.source.pull()? else { return Ok(None) };
        Ok(Some(match pulled {
            Pulled::Event(mut event) => {
                if let Event::Sample(sample) = &mut event.value {
                    // The controller sees what the log will hold, so that a replay shows it the same.
                    sample.make_canonical();
                    self.runner.observe(sample);
                }
                event
            }
            Pulled::StepDue { at, now } => {
                let outcome = self.runner.step(now);
                self.source.actuate(&outcome.command);
                self.command = Some(Stamped { at: at.after_ns(1), value: outcome.command });
                Stamped { at, value: Event::Step(Box::new(outcome.step)) }
            }
        }))
    }

    /// The controller, as the last event left it.
    pub fn runner(&self) -> &Runner {
        &self.runner
    }

    /// The source, for what are not events.
    pub fn source_mut(&mut self) -> &mut S {
        &mut self.source
    }
}
