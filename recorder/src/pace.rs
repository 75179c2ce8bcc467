//! Holding a simulated session to real time.

use std::thread;
use std::time::{Duration, Instant};

use schemas::Time;

/// Lets simulated time run no faster than the clock.
#[derive(Debug)]
pub struct Pace {
    started: Instant,
    start: Time,
}

impl Pace {
    /// From now on, `start` is the present.
    pub fn new(start: Time) -> Pace {
        Pace { started: Instant::now(), start }
    }

    /// Sleeps until the clock has reached `at`. Returns at once when it already has.
    pub fn wait_for(&self, at: Time) {
        let due = Duration::from_nanos(at.0.saturating_sub(self.start.0));
        thread::sleep(due.saturating_sub(self.started.elapsed()));
    }
}
