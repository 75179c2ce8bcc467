//! Which innovations are believed.

use crate::digest::Digest;

/// χ² with one degree of freedom stays below this in 99.9 % of all cases.
pub(super) const ONE_NUMBER: f64 = 10.828;

/// The same with two degrees of freedom: −2 ln 0.001.
pub(super) const TWO_NUMBERS: f64 = 13.816;

/// The gate of one kind of measurement, and what it has turned away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gate {
    limit: f64,
    /// Normalised innovation squared of the newest measurement, νᵀS⁻¹ν; NaN before any.
    pub(super) innovation: f64,
    /// How many were turned away since the start; stays at the largest number that fits.
    pub(super) rejected: i32,
    /// How many were turned away in a row.
    pub(super) in_a_row: u32,
}

impl Gate {
    pub(super) fn new(limit: f64) -> Gate {
        Gate { limit, innovation: f64::NAN, rejected: 0, in_a_row: 0 }
    }

    /// Whether a measurement with this normalised innovation squared is believed. NaN is not.
    pub(super) fn admits(&mut self, innovation: f64) -> bool {
        self.innovation = innovation;
        if innovation <= self.limit {
            self.in_a_row = 0;
            return true;
        }
        self.turn_away();
        false
    }

    /// Counts a measurement that is wrong on its face.
    pub(super) fn turn_away(&mut self) {
        self.rejected = self.rejected.saturating_add(1);
        self.in_a_row = self.in_a_row.saturating_add(1);
    }

    pub(super) fn fold(&self, digest: &mut Digest) {
        digest.number(self.innovation);
        digest.word(u64::from(self.rejected.unsigned_abs()));
        digest.word(u64::from(self.in_a_row));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// P(χ²₂ > x) = exp(−x/2); P(χ²₁ > x) = erfc(√(x/2)).
    #[test]
    fn one_true_measurement_in_a_thousand_is_turned_away() {
        assert!((libm::exp(-0.5 * TWO_NUMBERS) - 1e-3).abs() < 1e-6);
        assert!((libm::erfc(libm::sqrt(0.5 * ONE_NUMBER)) - 1e-3).abs() < 1e-6);
    }

    #[test]
    fn the_gate_counts_and_forgets_a_run_at_the_first_good_one() {
        let mut gate = Gate::new(ONE_NUMBER);
        assert!(gate.admits(10.8));
        for bad in [10.9, f64::NAN, f64::INFINITY] {
            assert!(!gate.admits(bad));
        }
        assert_eq!((gate.rejected, gate.in_a_row), (3, 3));
        assert!(gate.admits(0.0));
        assert_eq!((gate.rejected, gate.in_a_row), (3, 0));
    }
}
