//! A simulation that is led by recorded commands up to an instant, and by the controller from there.

use core::convert::Infallible;
use std::io::Read;

use schemas::log::{LogReader, Topic};
use schemas::{Command, Event, Pulled, Source, Time};
use simulator::Simulation;

/// A simulation under recorded commands, for a while.
pub(crate) struct Led<R> {
    simulation: Simulation,
    /// The recording's commands, as long as they lead.
    leader: Option<LogReader<R>>,
    next: Option<Command>,
    until: Time,
    /// The instant of the step that is being taken.
    now: Time,
}

impl<R: Read> Led<R> {
    /// Without a leader the controller drives from the first step on.
    pub(crate) fn new(simulation: Simulation) -> Led<R> {
        Led { simulation, leader: None, next: None, until: Time(0), now: Time(0) }
    }

    /// Lets the commands of a log lead until an instant.
    pub(crate) fn follow(&mut self, log: LogReader<R>, until: Time) {
        self.leader = Some(log.only(&[Topic::Command]));
        self.until = until;
        self.read();
    }

    fn read(&mut self) {
        self.next = None;
        while let Some(log) = &mut self.leader {
            match log.next_event() {
                Ok(Some(event)) => {
                    if let Event::Command(command) = event.value {
                        self.next = Some(command).filter(|command| command.stamp < self.until);
                        return;
                    }
                }
                // Damage is for the reader beside to report.
                Ok(None) | Err(_) => self.leader = None,
            }
        }
    }
}

impl<R: Read> Source for Led<R> {
    type Error = Infallible;

    fn pull(&mut self) -> Result<Option<Pulled>, Infallible> {
        // A command follows everything else of its instant.
        while let Some(command) = self
            .next
            .take_if(|command| self.simulation.next_at().is_some_and(|next| command.stamp < next))
        {
            self.simulation.command_at(command.stamp, &command);
            self.read();
        }
        let pulled = self.simulation.pull()?;
        if let Some(Pulled::StepDue { now, .. }) = &pulled {
            self.now = *now;
        }
        Ok(pulled)
    }

    fn actuate(&mut self, command: &Command) {
        if self.now >= self.until {
            self.simulation.actuate(command);
        }
    }
}
