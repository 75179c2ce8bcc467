//! A small hash over numbers, so that two runs can be told apart at every step.
//!
//! FNV-1a over 64-bit words instead of bytes, with the high half folded into the low one after each
//! word: h ← (h ⊕ word) · 0x100000001b3; h ← h ⊕ (h >> 32). Four such hashes take turns, so that a
//! word waits for the one four before it and not for the last; at the end a fifth takes them in like
//! words. Not cryptographic. Each round is a bijection of its h, so two states that differ in one word
//! always differ in their hash.

use schemas::{Pose, Time};

/// FNV's prime for 64 bits.
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// FNV's offset basis for 64 bits.
const BASIS: u64 = 0xcbf2_9ce4_8422_2325;

/// How many hashes take turns: a round lasts about six cycles of a processor that can begin one or two in
/// each.
const LANES: usize = 4;

/// A hash in the making.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Digest {
    /// The one whose turn it is comes first.
    lanes: [u64; LANES],
}

impl Default for Digest {
    fn default() -> Digest {
        // Each begins with another number, so that it counts in which one a word is.
        Digest { lanes: std::array::from_fn(|lane| round(BASIS, lane as u64)) }
    }
}

/// FNV's round, on a word.
fn round(hash: u64, word: u64) -> u64 {
    let mixed = (hash ^ word).wrapping_mul(PRIME);
    mixed ^ (mixed >> 32)
}

impl Digest {
    /// Takes in a word.
    pub(crate) fn word(&mut self, word: u64) {
        let [first, second, third, fourth] = self.lanes;
        self.lanes = [second, third, fourth, round(first, word)];
    }

    /// Takes in a number by its bits; every NaN counts as the same.
    pub(crate) fn number(&mut self, number: f64) {
        self.word(if number.is_nan() { f64::NAN.to_bits() } else { number.to_bits() });
    }

    /// Takes in numbers.
    pub(crate) fn numbers(&mut self, numbers: &[f64]) {
        // Their sum is a number only if each of them is: as good as always.
        if numbers.iter().sum::<f64>().is_nan() {
            for number in numbers {
                self.number(*number);
            }
        } else {
            for number in numbers {
                self.word(number.to_bits());
            }
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
        self.lanes.into_iter().fold(BASIS, round)
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

    /// Whichever of a stream's words is another one, in whichever bit, and wherever two of them change
    /// places: all hashes differ.
    #[test]
    fn no_word_hides_another() {
        let words: [u64; 11] =
            std::array::from_fn(|i| 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(i as u64));
        let hash = |words: &[u64]| {
            let mut digest = Digest::default();
            for word in words {
                digest.word(*word);
            }
            digest.value()
        };
        let mut hashes = Vec::new();
        for end in 0..=words.len() {
            hashes.push(hash(&words[..end]));
        }
        for at in 0..words.len() {
            for bit in 0..u64::BITS {
                let mut other = words;
                other[at] ^= 1 << bit;
                hashes.push(hash(&other));
            }
            for with in 0..at {
                let mut other = words;
                other.swap(at, with);
                hashes.push(hash(&other));
            }
        }
        let count = hashes.len();
        hashes.sort_unstable();
        hashes.dedup();
        assert_eq!(hashes.len(), count);
    }

    #[test]
    fn every_nan_is_the_same() {
        assert_eq!(of(&[f64::NAN]), of(&[-f64::NAN]));
        assert_eq!(of(&[f64::NAN]), of(&[f64::from_bits(0x7ff8_0000_0000_0001)]));
    }

    /// One NaN among numbers, and infinities whose sum is none, count as they do alone.
    #[test]
    fn numbers_count_as_one_by_one() {
        let some = [1.0, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, f64::MAX, f64::MAX];
        for end in 0..=some.len() {
            for begin in 0..=end {
                let mut one_by_one = Digest::default();
                some[begin..end].iter().for_each(|number| one_by_one.number(*number));
                assert_eq!(of(&some[begin..end]), one_by_one.value(), "{begin} {end}");
            }
        }
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
