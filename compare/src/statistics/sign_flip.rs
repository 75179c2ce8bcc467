//! Would chance alone do that?

use super::generator::Generator;

/// Up to this many differences every pattern of signs is tried; beyond, a sample of them.
const EXACT_UP_TO: usize = 14;

/// Size of that sample.
const SAMPLES: usize = 20_000;

/// Seed of that sample.
const SEED: u64 = 0x666c_6970;

/// The two-sided p-value of the paired randomisation test for a mean difference of 0.
///
/// If it does not matter which controller drove, each log's difference is as likely to have the
/// other sign (Fisher, "The Design of Experiments", 1935, §21). The p-value is the share of the
/// 2ⁿ patterns of signs whose sum is at least as far from 0 as the observed one: exact for n ≤ 14,
/// from 20,000 sampled patterns beyond, the observed one counted in, so that it is never 0.
///
/// Unlike an interval from resampling it stays honest for few logs: n differences of one sign give
/// 2/2ⁿ at best. `None` of nothing, or where a difference is not finite.
pub fn sign_flip(differences: &[f64]) -> Option<f64> {
    if differences.is_empty() || differences.iter().any(|d| !d.is_finite()) {
        return None;
    }
    // A difference of 0 has no sign to flip.
    let moved: Vec<f64> = differences.iter().copied().filter(|d| *d != 0.0).collect();
    if moved.is_empty() {
        return Some(1.0);
    }
    // Sums of the same numbers in the same order: ties are met up to their rounding.
    let scale: f64 = moved.iter().map(|d| libm::fabs(*d)).sum();
    let observed = libm::fabs(moved.iter().sum::<f64>()) - 1e-12 * scale;
    let as_far = |flips: &mut dyn FnMut() -> bool| {
        let sum: f64 = moved.iter().map(|d| if flips() { -d } else { *d }).sum();
        libm::fabs(sum) >= observed
    };
    if moved.len() <= EXACT_UP_TO {
        let patterns = 1u32 << moved.len();
        let extreme = (0..patterns)
            .filter(|pattern| {
                let mut bits = *pattern;
                as_far(&mut || {
                    let flip = bits & 1 == 1;
                    bits >>= 1;
                    flip
                })
            })
            .count();
        return Some(extreme as f64 / f64::from(patterns));
    }
    let mut generator = Generator::new(SEED);
    let extreme = (0..SAMPLES).filter(|_| as_far(&mut || generator.next_u64() >> 63 == 1)).count();
    Some((extreme + 1) as f64 / (SAMPLES + 1) as f64)
}
