//! A small hash over numbers, so that two runs can be told apart at every step.
//!
//! FNV-1a over 64-bit words instead of bytes, with the high half folded into the low one after each
//! word: h ← (h ⊕ word) · 0x100000001b3; h ← h ⊕ (h >> 32). Not cryptographic. Each round is a
//! bijection of h, so two states that differ in one word always differ in their hash.

use schemas::{Pose, Time};

/// A hash in the making.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Digest(u64);

impl Default for Digest {
    fn default() -> Digest {
        // FNV's offset basis.
        Digest(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// Takes in a word.
    pub(crate) fn word(&mut self, word: u64) {
        let mixed = (self.0 ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        self.0 = mixed ^ (mixed >> 32);
    }

    /// Takes in a number by its bits; every NaN counts as the same.
    pub(crate) fn number(&mut self, number: f64) {
        self.word(if number.is_nan() { f64::NAN.to_bits() } else { number.to_bits() });
    }

    /// Takes in numbers.
    pub(crate) fn numbers(&mut self, numbers: &[f64]) {
        for number in numbers {
            self.number(*number);
        }
    }

    /// Takes in a pose.
    pub(crate) fn pose(&mut self, pose: &Pose) {
        self.numbers(&[pose.x_m, pose.y_m, pose.theta_rad]);
    }

    /// Takes in an instant, as the time from `start`: a session hashes alike whenever it runs.
    pub(crate) fn time(&mut self, time: Time, start: Time) {
        self.word(time.0.wrapping_sub(start.0));
    }

    /// The hash of everything taken in so far.
    pub(crate) fn value(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(numbers: &[f64]) -> u64 {
        let mut digest = Digest::default();
        digest.numbers(numbers);
        digest.value()
    }

    #[test]
    fn what_differs_in_a_bit_or_in_order_differs() {
        assert_ne!(of(&[1.0]), of(&[1.0 + f64::EPSILON]));
        assert_ne!(of(&[1.0, 2.0]), of(&[2.0, 1.0]));
        assert_ne!(of(&[0.0]), of(&[-0.0]));
        assert_ne!(of(&[0.0]), of(&[0.0, 0.0]));
    }

    #[test]
    fn every_nan_is_the_same() {
        assert_eq!(of(&[f64::NAN]), of(&[-f64::NAN]));
        assert_eq!(of(&[f64::NAN]), of(&[f64::from_bits(0x7ff8_0000_0000_0001)]));
    }

    #[test]
    fn a_session_hashes_alike_whenever_it_runs() {
        let at = |start: u64| {
            let mut digest = Digest::default();
            digest.time(Time(start + 5), Time(start));
            digest.value()
        };
        assert_eq!(at(0), at(1_735_689_600_000_000_000));
    }
}
