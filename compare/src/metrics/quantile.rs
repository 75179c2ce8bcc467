//! Quantiles of a long run in bounded memory.

use std::collections::BTreeMap;

/// Relative width of a bin: quantiles are right to 1 %.
const GAMMA: f64 = 1.02;

/// Sizes outside of this range count as its ends.
const RANGE: [f64; 2] = [1e-9, 1e9];

/// Weighted quantiles of sizes ≥ 0, to 1 %: bins whose edges are powers of a number (Masson, Rim and
/// Lee, "`DDSketch`", PVLDB 12, 2019). At most some two thousand bins.
#[derive(Clone, Debug)]
pub(super) struct Sketch {
    bins: BTreeMap<i32, f64>,
    zero: f64,
    total: f64,
    log_gamma: f64,
}

impl Default for Sketch {
    fn default() -> Self {
        let log_gamma = libm::log(GAMMA);
        Sketch { bins: BTreeMap::new(), zero: 0.0, total: 0.0, log_gamma }
    }
}

impl Sketch {
    /// Adds a size with a weight; what is not a number is passed over.
    pub(super) fn add(&mut self, size: f64, weight: f64) {
        if size.is_nan() || weight.is_nan() || weight <= 0.0 {
            return;
        }
        self.total += weight;
        if size < RANGE[0] {
            self.zero += weight;
        } else {
            let power = libm::log(size.min(RANGE[1])) / self.log_gamma;
            *self.bins.entry(libm::ceil(power) as i32).or_default() += weight;
        }
    }

    /// The least size that at least the share `p` of the weight does not exceed.
    pub(super) fn quantile(&self, p: f64) -> Option<f64> {
        if self.total <= 0.0 {
            return None;
        }
        let wanted = p * self.total * (1.0 - 1e-12);
        let mut below = self.zero;
        if below >= wanted {
            return Some(0.0);
        }
        let mut size = 0.0;
        for (power, weight) in &self.bins {
            below += weight;
            // The middle of the bin, such that it is right to the same share at both edges.
            size = 2.0 * libm::pow(GAMMA, f64::from(*power)) / (GAMMA + 1.0);
            if below >= wanted {
                break;
            }
        }
        Some(size)
    }
}

/// The quantile of a few values by nearest rank: the least value that at least the share `p` of them
/// does not exceed (Hyndman and Fan, "Sample quantiles in statistical packages", 1996, type 1).
pub(super) fn nearest_rank(values: &[f64], p: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = libm::ceil(p * sorted.len() as f64 * (1.0 - 1e-12)) as usize;
    sorted.get(rank.max(1) - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sketch_is_right_to_one_per_cent() {
        let mut sketch = Sketch::default();
        (1..=1000).for_each(|i| sketch.add(f64::from(i) * 0.01, 1.0));
        for (p, want) in [(0.5, 5.0), (0.95, 9.5), (1.0, 10.0), (0.001, 0.01)] {
            let got = sketch.quantile(p).expect("not empty");
            assert!((got / want - 1.0).abs() < 0.0102, "{got} instead of {want}");
        }
    }

    #[test]
    fn weights_zeros_and_what_is_not_a_number() {
        let mut sketch = Sketch::default();
        assert_eq!(sketch.quantile(0.5), None);
        sketch.add(f64::NAN, 1.0);
        sketch.add(1.0, 0.0);
        assert_eq!(sketch.quantile(0.5), None);
        sketch.add(0.0, 3.0);
        sketch.add(2.0, 1.0);
        assert_eq!(sketch.quantile(0.75), Some(0.0));
        let high = sketch.quantile(0.76).expect("not empty");
        assert!((high / 2.0 - 1.0).abs() < 0.0102);
        sketch.add(f64::INFINITY, 100.0);
        assert!(sketch.quantile(0.9).is_some_and(f64::is_finite));
    }

    #[test]
    fn what_weighs_nothing_or_less_does_not_count() {
        for weight in [0.0, -5.0, f64::NAN] {
            let mut sketch = Sketch::default();
            sketch.add(5.0, 1.0);
            sketch.add(7.0, weight);
            let all = sketch.quantile(1.0).expect("not empty");
            assert!((all / 5.0 - 1.0).abs() < 0.0102, "{weight}: {all}");
        }
    }

    #[test]
    fn below_a_billionth_is_nothing() {
        let of = |size: f64| {
            let mut sketch = Sketch::default();
            sketch.add(size, 1.0);
            sketch.quantile(0.5)
        };
        assert_eq!(of(0.9e-9), Some(0.0));
        assert!(of(1e-9).is_some_and(|size| (size / 1e-9 - 1.0).abs() < 0.0102));
    }

    #[test]
    fn nearest_ranks_are_values() {
        assert_eq!(nearest_rank(&[], 0.5), None);
        let values = [4.0, 1.0, 3.0, 2.0];
        for (p, want) in [(0.5, 2.0), (0.51, 3.0), (0.95, 4.0), (0.0, 1.0), (1.0, 4.0)] {
            assert_eq!(nearest_rank(&values, p), Some(want), "{p}");
        }
    }
}
