//! A confidence interval by resampling the logs.

use serde::{Deserialize, Serialize};

use super::generator::Generator;
use super::{mean, normal_cdf, normal_quantile};

/// How often the logs are resampled: the end points of a 95 % interval then rest on 250 values
/// each. (Efron and Tibshirani ask for at least 2000.)
const RESAMPLES: usize = 10_000;

/// Seed of the resampling; fixed, so that the same logs give the same interval.
const SEED: u64 = 0x7461_6e64_656d;

/// A confidence interval; in JSON a list of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl From<[f64; 2]> for Interval {
    fn from([low, high]: [f64; 2]) -> Self {
        Interval { low, high }
    }
}

impl From<Interval> for [f64; 2] {
    fn from(interval: Interval) -> Self {
        [interval.low, interval.high]
    }
}

impl Interval {
    /// Whether 0 lies strictly outside.
    pub fn excludes_zero(self) -> bool {
        self.low > 0.0 || self.high < 0.0
    }
}

/// The bias-corrected and accelerated bootstrap interval for the mean of paired differences, at
/// confidence `level` (0.95, say).
///
/// Efron, "Better bootstrap confidence intervals", JASA 82 (1987): with the resampled means
/// sorted, the ends are their quantiles at
/// Φ(z0 + (z0 + zα)/(1 − a (z0 + zα))), α = (1 ± level)/2, where z0 = Φ⁻¹(share of resampled means
/// below the observed one, ties half) corrects for bias and
/// a = Σ (m̄ − mᵢ)³ / (6 (Σ (m̄ − mᵢ)²)^{3/2}), from the means mᵢ without log i, for skew.
/// Quantiles interpolate linearly between neighbours.
///
/// `None` for fewer than two differences, for a difference that is not finite, or for a level
/// outside (0, 1). Equal differences give an interval of length 0: no log speaks against them.
pub fn bca(differences: &[f64], level: f64) -> Option<Interval> {
    let n = differences.len();
    if n < 2 || differences.iter().any(|d| !d.is_finite()) || !(level > 0.0 && level < 1.0) {
        return None;
    }
    let observed = mean(differences)?;
    if differences.iter().all(|d| *d == differences[0]) {
        return Some(Interval { low: observed, high: observed });
    }
    let mut generator = Generator::new(SEED);
    let mut means: Vec<f64> = (0..RESAMPLES)
        .map(|_| (0..n).map(|_| differences[generator.below(n)]).sum::<f64>() / n as f64)
        .collect();
    means.sort_by(f64::total_cmp);

    let below = means.iter().filter(|m| **m < observed).count();
    let at_most = means.iter().filter(|m| **m <= observed).count();
    let share = (below + at_most) as f64 / (2 * RESAMPLES) as f64;
    // Every resampled mean on one side says nothing about the bias.
    let z0 = if share > 0.0 && share < 1.0 { normal_quantile(share) } else { 0.0 };
    let a = acceleration(differences);
    let end = |alpha: f64| {
        let z = z0 + normal_quantile(alpha);
        // |a| ≤ 1/6 for a mean, so the pole lies beyond six standard deviations.
        quantile(&means, normal_cdf(z0 + z / (1.0 - a * z)))
    };
    let tail = 0.5 * (1.0 - level);
    Some(Interval { low: end(tail), high: end(1.0 - tail) })
}

/// The jackknife's a. For the mean, m̄ − mᵢ = (dᵢ − d̄)/(n − 1), and the factor cancels.
fn acceleration(differences: &[f64]) -> f64 {
    let centre = mean(differences).unwrap_or(0.0);
    let (mut squares, mut cubes) = (0.0, 0.0);
    for difference in differences {
        let off = difference - centre;
        squares += off * off;
        cubes += off * off * off;
    }
    if squares > 0.0 { cubes / (6.0 * squares * libm::sqrt(squares)) } else { 0.0 }
}

/// The quantile of sorted values, linear between neighbours.
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let last = sorted.len() - 1;
    let position = p.clamp(0.0, 1.0) * last as f64;
    let below = libm::floor(position) as usize;
    let above = (below + 1).min(last);
    let part = position - below as f64;
    sorted[below] + part * (sorted[above] - sorted[below])
}
