//! How the ride feels: `accel_rms_mps2`, `accel_p95_mps2`, `jerk_rms_mps3`, `jerk_p95_mps3`,
//! `angular_jerk_rms_radps3`, `angular_jerk_p95_radps3`.
//!
//! Speeds are differentiated by the same filter in every run: a critically damped one of second
//! order with a time constant of 0.1 s, solved exactly between samples. A jump of the speed, as
//! the kinematic model allows it, then counts as what a body with that inertia would feel.

use schemas::Twist;

use super::accumulate::{Accumulate, Mean};
use super::quantile::Sketch;
use super::sample::Motion;

/// Time constant of the filter, seconds. Our choice: the paper's control period.
pub(super) const FILTER_S: f64 = 0.1;

/// A speed x through τ² y'' + 2τ y' + y = x: y' and y'' are the filtered first and second rates.
#[derive(Clone, Copy, Debug, Default)]
struct Differentiator {
    /// y − x and y'; `None` before the first sample.
    state: Option<(f64, f64)>,
    x: f64,
}

impl Differentiator {
    /// The input from here on.
    fn input(&mut self, x: f64) {
        let (off, rate) = self.state.unwrap_or((0.0, 0.0));
        let jump = if self.state.is_some() { x - self.x } else { 0.0 };
        self.state = Some((off - jump, rate));
        self.x = x;
    }

    /// y' and y'' that long after the last input.
    fn rates(&self, after_s: f64) -> (f64, f64) {
        let (off, rate) = self.after(after_s);
        (rate, -(off + 2.0 * FILTER_S * rate) / (FILTER_S * FILTER_S))
    }

    /// y − x and y' that long after the last input: both roots are −1/τ.
    fn after(&self, after_s: f64) -> (f64, f64) {
        let (off, rate) = self.state.unwrap_or((0.0, 0.0));
        let decay = libm::exp(-after_s / FILTER_S);
        let slope = rate + off / FILTER_S;
        ((off + slope * after_s) * decay, (rate - slope * after_s / FILTER_S) * decay)
    }

    fn pass(&mut self, span_s: f64) {
        self.state = Some(self.after(span_s));
    }
}

/// Which rate of which speed.
#[derive(Clone, Copy, Debug)]
enum Quantity {
    Accel,
    Jerk,
    AngularJerk,
}

/// RMS or 95th percentile over time of one filtered rate.
#[derive(Clone, Debug)]
pub(super) struct Comfort {
    quantity: Quantity,
    percentile: bool,
    filter: Differentiator,
    square: Mean,
    sizes: Sketch,
}

impl Comfort {
    fn new(quantity: Quantity, percentile: bool) -> Self {
        Comfort {
            quantity,
            percentile,
            filter: Differentiator::default(),
            square: Mean::default(),
            sizes: Sketch::default(),
        }
    }

    pub(super) fn accel_rms() -> Self {
        Comfort::new(Quantity::Accel, false)
    }

    pub(super) fn accel_p95() -> Self {
        Comfort::new(Quantity::Accel, true)
    }

    pub(super) fn jerk_rms() -> Self {
        Comfort::new(Quantity::Jerk, false)
    }

    pub(super) fn jerk_p95() -> Self {
        Comfort::new(Quantity::Jerk, true)
    }

    pub(super) fn angular_jerk_rms() -> Self {
        Comfort::new(Quantity::AngularJerk, false)
    }

    pub(super) fn angular_jerk_p95() -> Self {
        Comfort::new(Quantity::AngularJerk, true)
    }
}

impl Accumulate for Comfort {
    fn motion(&mut self, motion: &Motion) {
        let Twist { v_mps, omega_radps } = motion.twist;
        let speed =
            if matches!(self.quantity, Quantity::AngularJerk) { omega_radps } else { v_mps };
        if !speed.is_finite() {
            return;
        }
        self.filter.input(speed);
        let size = |after_s: f64| {
            let (first, second) = self.filter.rates(after_s);
            libm::fabs(if matches!(self.quantity, Quantity::Accel) { first } else { second })
        };
        let [start, middle, end] = [0.0, 0.5, 1.0].map(|share| size(share * motion.hold_s));
        // Simpson's rule for the square.
        self.square.add((start * start + 4.0 * middle * middle + end * end) / 6.0, motion.hold_s);
        self.sizes.add(middle, motion.hold_s);
        self.filter.pass(motion.hold_s);
    }

    fn value(&self) -> Option<f64> {
        if self.percentile {
            self.sizes.quantile(0.95)
        } else {
            self.square.value().map(libm::sqrt)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step of the speed by V: y' = V t/τ² exp(−t/τ), y'' = V (1 − t/τ)/τ² exp(−t/τ).
    #[test]
    fn a_step_gives_its_closed_form() {
        let mut filter = Differentiator::default();
        filter.input(0.2);
        assert_eq!(filter.rates(0.3), (0.0, 0.0));
        filter.pass(1.0);
        filter.input(0.7);
        let mut t_s = 0.0;
        for _ in 0..20 {
            filter.pass(0.02);
            t_s += 0.02;
            filter.input(0.7);
            let (first, second) = filter.rates(0.0);
            let decay = 0.5 / 0.01 * (-t_s / 0.1f64).exp();
            assert!((first - decay * t_s).abs() < 1e-9);
            assert!((second - decay * (1.0 - t_s / 0.1)).abs() < 1e-9);
        }
    }
}
