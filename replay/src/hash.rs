//! One number for a whole session: equal exactly when every compared message is equal.

use schemas::log::{Compared, Encoder, Topic};
use schemas::{Event, Stamped, Time};

/// Which messages a hash covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Covered {
    /// What is compared in every replay: `/step` and `/command`.
    Outputs,
    /// The same, and what closed loop makes anew: sensors, `/joystick`, `/truth`.
    Everything,
}

impl Covered {
    /// Whether an event is covered. What a clock measured never is.
    pub fn covers(self, event: &Event) -> bool {
        match Topic::of(event).info().compared {
            Compared::Always => true,
            Compared::ClosedLoop => self == Covered::Everything,
            Compared::Never => false,
        }
    }
}

/// BLAKE3 over topic, time from the start and encoded bytes of each compared message, in order.
pub struct OutputHash {
    covered: Covered,
    start: Time,
    hasher: blake3::Hasher,
    encoder: Encoder,
}

impl OutputHash {
    /// The hash of nothing yet, for a session that starts at `start`.
    pub fn new(covered: Covered, start: Time) -> OutputHash {
        OutputHash { covered, start, hasher: blake3::Hasher::new(), encoder: Encoder::new() }
    }

    /// Adds an event, if it is one that is compared.
    pub fn update(&mut self, event: &Stamped<Event>) {
        if !self.covered.covers(&event.value) {
            return;
        }
        let (topic, bytes) = self.encoder.encode(&event.value);
        // Lengths keep neighbouring fields apart.
        self.hasher.update(&(topic.len() as u64).to_le_bytes());
        self.hasher.update(topic.as_bytes());
        self.hasher.update(&event.at.0.wrapping_sub(self.start.0).to_le_bytes());
        self.hasher.update(&(bytes.len() as u64).to_le_bytes());
        self.hasher.update(bytes);
    }

    /// The hash so far, in hexadecimal.
    pub fn hex(&self) -> String {
        self.hasher.finalize().to_hex().to_string()
    }
}
