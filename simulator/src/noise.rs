//! Counter-based noise: every random number is a pure function of seed, stream, reading index and
//! draw, so that no reading's noise depends on how many were taken before it, in which order, or by
//! whom.
//!
//! The function is a chain of `SplitMix64` finalisers (Steele, Lea and Flood, "Fast splittable
//! pseudorandom number generators", 2014): seed and stream make a key, key and index a reading's
//! key, and that plus multiples of the golden ratio the draws.

use core::f64::consts::TAU;

/// 2^64 divided by the golden ratio, made odd.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// `SplitMix64`'s finaliser: a bijection whose output bits depend on all input bits.
fn mix(word: u64) -> u64 {
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

/// What a stream's noise is for. The numbers are part of what "the same seed" means: never reuse
/// or renumber one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A sonar's faults, by its id.
    Sonar(u8),
    /// The IMU.
    Imu,
    /// The encoders.
    Encoders,
    /// The tremor of the hand.
    Tremor,
    /// A free ride's strokes.
    FreeRide,
    /// The making of a random scenario.
    Scenario,
    /// The places that a person wants to be at.
    Wish,
    /// A person's decisions, mistakes and lapses.
    Whim,
    /// A fault put into a replay, by its number.
    Fault(u8),
}

impl Purpose {
    fn number(self) -> u64 {
        match self {
            Purpose::Sonar(id) => 0x100 + u64::from(id),
            Purpose::Imu => 0x200,
            Purpose::Encoders => 0x300,
            Purpose::Tremor => 0x400,
            Purpose::FreeRide => 0x500,
            Purpose::Scenario => 0x600,
            Purpose::Wish => 0x700,
            Purpose::Whim => 0x800,
            Purpose::Fault(number) => 0x900 + u64::from(number),
        }
    }
}

/// The noise of one sensor.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    key: u64,
}

impl Stream {
    /// The noise of a seed for a purpose.
    pub fn new(seed: u64, purpose: Purpose) -> Stream {
        Stream { key: mix(mix(seed.wrapping_add(GOLDEN)).wrapping_add(purpose.number())) }
    }

    /// The noise of reading number `index`.
    pub fn reading(self, index: u64) -> Reading {
        Reading { key: mix(self.key ^ mix(index.wrapping_add(GOLDEN))) }
    }
}

/// The noise of one reading: any number of independent draws, told apart by their number.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    key: u64,
}

impl Reading {
    /// Sixty-four random bits.
    pub fn bits(self, draw: u64) -> u64 {
        mix(self.key.wrapping_add(GOLDEN.wrapping_mul(draw.wrapping_add(1))))
    }

    /// Uniform in the open interval (0, 1), 53 bits fine.
    pub fn uniform(self, draw: u64) -> f64 {
        ((self.bits(draw) >> 11) as f64 + 0.5) * (1.0 / (1_u64 << 53) as f64)
    }

    /// Uniform between two numbers.
    pub fn between(self, draw: u64, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform(draw)
    }

    /// Whether something of this probability happens.
    pub fn happens(self, draw: u64, probability: f64) -> bool {
        self.uniform(draw) < probability
    }

    /// A whole number from 0 to `count - 1`; 0 for a count of 0.
    pub fn pick(self, draw: u64, count: u64) -> u64 {
        // The high half of the product: unbiased to 2^-64 × count.
        ((u128::from(self.bits(draw)) * u128::from(count)) >> 64) as u64
    }

    /// Two independent normals of mean 0 and deviation 1, by Box and Muller; takes the draws
    /// `draw` and `draw + 1`.
    pub fn normals(self, draw: u64) -> [f64; 2] {
        let radius = libm::sqrt(-2.0 * libm::log(self.uniform(draw)));
        let (sin, cos) = libm::sincos(TAU * self.uniform(draw.wrapping_add(1)));
        [radius * cos, radius * sin]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: u64 = 100_000;

    fn mean(values: &[f64]) -> f64 {
        values.iter().sum::<f64>() / values.len() as f64
    }

    fn correlation(a: &[f64], b: &[f64]) -> f64 {
        let (mean_a, mean_b) = (mean(a), mean(b));
        let products: Vec<f64> =
            a.iter().zip(b).map(|(x, y)| (x - mean_a) * (y - mean_b)).collect();
        let square =
            |v: &[f64], m: f64| mean(&v.iter().map(|x| (x - m) * (x - m)).collect::<Vec<_>>());
        mean(&products) / libm::sqrt(square(a, mean_a) * square(b, mean_b))
    }

    /// Moments of the standard normal: 0, 1, 0, 3. The bounds are five standard errors at N.
    #[test]
    fn normals_have_the_moments_of_a_normal() {
        let stream = Stream::new(7, Purpose::Imu);
        let values: Vec<f64> = (0..N / 2).flat_map(|i| stream.reading(i).normals(4)).collect();
        let moment = |power: i32| {
            mean(&values.iter().map(|x| (0..power).fold(1.0, |p, _| p * x)).collect::<Vec<_>>())
        };
        let standard_error = |variance: f64| 5.0 * libm::sqrt(variance / N as f64);
        assert!(moment(1).abs() < standard_error(1.0));
        assert!((moment(2) - 1.0).abs() < standard_error(2.0));
        assert!(moment(3).abs() < standard_error(15.0));
        assert!((moment(4) - 3.0).abs() < standard_error(96.0));
    }

    /// Uniforms fill (0, 1) evenly: χ² over 100 bins within five deviations of its mean 99.
    #[test]
    fn uniforms_are_even() {
        let stream = Stream::new(0, Purpose::Sonar(3));
        let mut bins = [0_u32; 100];
        for index in 0..N {
            let u = stream.reading(index).uniform(0);
            assert!(0.0 < u && u < 1.0);
            bins[(u * 100.0) as usize] += 1;
        }
        let wanted = N as f64 / 100.0;
        let chi2: f64 =
            bins.iter().map(|&n| (f64::from(n) - wanted) * (f64::from(n) - wanted) / wanted).sum();
        assert!((chi2 - 99.0).abs() < 5.0 * libm::sqrt(198.0), "{chi2}");
    }

    /// Neighbours in every direction of the counter are uncorrelated.
    #[test]
    fn neighbours_are_uncorrelated() {
        let series = |seed, purpose, shift: u64, draw| -> Vec<f64> {
            let stream = Stream::new(seed, purpose);
            (0..N).map(|i| stream.reading(i + shift).uniform(draw)).collect()
        };
        let base = series(0, Purpose::Sonar(0), 0, 0);
        for other in [
            series(1, Purpose::Sonar(0), 0, 0),
            series(0, Purpose::Sonar(1), 0, 0),
            series(0, Purpose::Imu, 0, 0),
            series(0, Purpose::Sonar(0), 1, 0),
            series(0, Purpose::Sonar(0), 0, 1),
        ] {
            assert!(correlation(&base, &other).abs() < 5.0 / libm::sqrt(N as f64));
        }
    }

    /// A number depends on its place in the counter only, not on what was drawn before it.
    #[test]
    fn order_does_not_matter() {
        let forward: Vec<u64> =
            (0..50).map(|i| Stream::new(9, Purpose::Encoders).reading(i).bits(2)).collect();
        let mut backward: Vec<u64> =
            (0..50).rev().map(|i| Stream::new(9, Purpose::Encoders).reading(i).bits(2)).collect();
        backward.reverse();
        assert_eq!(forward, backward);
    }

    /// Pinned: the numbers of a seed may never change, or recorded seeds lose their meaning. The
    /// finaliser's values are those of the published algorithm from state 0.
    #[test]
    fn finaliser_is_splitmix64() {
        assert_eq!(mix(GOLDEN), 0xe220_a839_7b1d_cdaf);
        assert_eq!(mix(GOLDEN.wrapping_mul(2)), 0x6e78_9e6a_a1b9_65f4);
        assert_eq!(mix(GOLDEN.wrapping_mul(3)), 0x06c4_5d18_8009_454f);
    }

    #[test]
    fn picks_stay_in_range() {
        let stream = Stream::new(3, Purpose::Scenario);
        let mut seen = [false; 5];
        for index in 0..200 {
            seen[stream.reading(index).pick(0, 5) as usize] = true;
        }
        assert_eq!(seen, [true; 5]);
        assert_eq!(stream.reading(0).pick(0, 0), 0);
    }
}
