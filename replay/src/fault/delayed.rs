//! Samples on their way, and what comes between them, in the order of arrival.

use schemas::{Event, Pulled, Sample, Stamped, Time};

/// What has been pulled from a source and not yet been handed on.
#[derive(Debug, Default)]
pub(super) struct Delayed {
    /// Held samples in the order of arrival; equal arrivals in the order of departure.
    held: Vec<(Time, Sample)>,
    /// The next of what is not late.
    next: Next,
    /// The least log time that is left.
    earliest: Time,
}

/// What is known of the source's next word.
#[derive(Debug, Default)]
enum Next {
    #[default]
    Unknown,
    Known(Pulled),
    End,
}

impl Delayed {
    pub(super) fn knows_next(&self) -> bool {
        !matches!(self.next, Next::Unknown)
    }

    pub(super) fn next(&mut self, next: Option<Pulled>) {
        self.next = next.map_or(Next::End, Next::Known);
    }

    /// Holds a sample until it arrives.
    pub(super) fn hold(&mut self, arrival: Time, sample: Sample) {
        let place = self.held.partition_point(|(at, _)| *at <= arrival);
        self.held.insert(place, (arrival, sample));
    }

    /// What comes first; log times go on increasing. What has not arrived by the end never does.
    pub(super) fn take(&mut self) -> Option<Pulled> {
        let Next::Known(next) = &self.next else { return None };
        let due = match next {
            Pulled::Event(event) => event.at,
            Pulled::StepDue { at, .. } => *at,
        };
        if self.held.first().is_some_and(|(arrival, _)| *arrival < due) {
            let (arrival, sample) = self.held.remove(0);
            let at = self.log_time(arrival, 1);
            return Some(Pulled::Event(Stamped { at, value: Event::Sample(sample) }));
        }
        let Next::Known(next) = std::mem::take(&mut self.next) else { return None };
        match next {
            Pulled::Event(event) => {
                let at = self.log_time(event.at, 1);
                Some(Pulled::Event(Stamped { at, value: event.value }))
            }
            Pulled::StepDue { at, now } => {
                // The command is logged right after its step.
                let at = self.log_time(at, 2);
                Some(Pulled::StepDue { at, now })
            }
        }
    }

    fn log_time(&mut self, wanted: Time, records: u64) -> Time {
        let at = if wanted < self.earliest { self.earliest } else { wanted };
        self.earliest = at.after_ns(records);
        at
    }
}
