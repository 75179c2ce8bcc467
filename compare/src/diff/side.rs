//! One of two runs: what it says next, and what of it waits for the other.

use std::collections::VecDeque;

use schemas::{Event, Stamped, Time};

use super::reading::{Cell, command_cells, step_cells};

/// A message that waits for its counterpart.
pub(super) struct Waiting {
    pub(super) key: i128,
    pub(super) cells: Vec<Cell>,
}

/// How a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// Nothing came after.
    Whole,
    /// What came after cannot be read.
    Cut,
}

/// What a run says next.
#[derive(Clone, Debug)]
pub enum Next {
    /// Its next event.
    Event(Stamped<Event>),
    /// That it is over.
    End,
    /// That what follows cannot be read: what the other run has beyond this is not compared.
    Cut,
}

impl From<Option<Stamped<Event>>> for Next {
    fn from(event: Option<Stamped<Event>>) -> Next {
        event.map_or(Next::End, Next::Event)
    }
}

/// One run: its messages that have not been matched yet.
#[derive(Default)]
pub(super) struct Side {
    pub(super) start: Time,
    pub(super) queues: [VecDeque<Waiting>; 2],
    pub(super) end: Option<End>,
    /// Whether its law commands accelerations, from its first command.
    pub(super) accelerates: Option<bool>,
}

impl Side {
    pub(super) fn waiting(&self) -> usize {
        self.queues.iter().map(VecDeque::len).sum()
    }

    /// Takes in an event; the topic of one that is compared.
    pub(super) fn push(&mut self, event: &Stamped<Event>) -> Option<usize> {
        let (topic, stamp, cells) = match &event.value {
            Event::Step(step) => (STEP, step.stamp, step_cells(step)),
            Event::Command(command) => {
                self.accelerates.get_or_insert(command.accel.is_some());
                (COMMAND, command.stamp, command_cells(command))
            }
            _ => return None,
        };
        let key = i128::from(stamp.0) - i128::from(self.start.0);
        self.queues[topic].push_back(Waiting { key, cells });
        Some(topic)
    }
}

pub(super) const STEP: usize = 0;
pub(super) const COMMAND: usize = 1;
