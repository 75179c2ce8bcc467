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
#[derive(Clone)]
pub struct OutputHash {
    covered: Covered,
    start: Time,
    hasher: blake3::Hasher,
    encoder: Encoder,
    /// What waits to be hashed: much at once goes several times as fast.
    waiting: Vec<u8>,
}

/// How much waits, bytes: from this on a processor hashes sixteen pieces side by side.
const AT_ONCE: usize = 1 << 16;

impl OutputHash {
    /// The hash of nothing yet, for a session that starts at `start`.
    pub fn new(covered: Covered, start: Time) -> OutputHash {
        OutputHash {
            covered,
            start,
            hasher: blake3::Hasher::new(),
            encoder: Encoder::new(),
            waiting: Vec::with_capacity(AT_ONCE),
        }
    }

    /// Adds an event, if it is one that is compared.
    pub fn update(&mut self, event: &Stamped<Event>) {
        if !self.covered.covers(&event.value) {
            return;
        }
        let (topic, bytes) = self.encoder.encode(&event.value);
        let at_ns = event.at.0.wrapping_sub(self.start.0);
        // Lengths keep neighbouring fields apart.
        for part in [
            &(topic.len() as u64).to_le_bytes(),
            topic.as_bytes(),
            &at_ns.to_le_bytes(),
            &(bytes.len() as u64).to_le_bytes(),
            bytes,
        ] {
            if self.waiting.len() + part.len() > AT_ONCE {
                self.hasher.update(&self.waiting);
                self.waiting.clear();
            }
            if part.len() > AT_ONCE {
                self.hasher.update(part);
            } else {
                self.waiting.extend_from_slice(part);
            }
        }
    }

    /// The hash so far, in hexadecimal.
    pub fn hex(&self) -> String {
        self.hasher.clone().update(&self.waiting).finalize().to_hex().to_string()
    }
}
