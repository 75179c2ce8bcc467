//! The constant error of a gyro, learnt while the robot stands still.

/// How many samples the running mean reaches back over. At 100 Hz two seconds: a bias drifts over
/// minutes, and the mean of 200 samples of the default gyro (sigma 0.005 rad/s) is good to 0.0004 rad/s.
const MEMORY: f64 = 200.0;

/// Rates above this, rad/s, are motion, not bias: five times the bias that the simulated gyro has
/// by default, and the order of the worst zero-rate offset in the data sheets of such gyros.
pub(super) const LARGEST_BIAS_RADPS: f64 = 0.05;

/// Running mean of the turn rate that the gyro reports at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct GyroBias {
    mean_radps: f64,
    samples: f64,
}

impl GyroBias {
    /// The bias, rad/s; 0 while none has been learnt.
    pub(super) fn radps(&self) -> f64 {
        self.mean_radps
    }

    /// Takes the rate reported by a robot whose wheels stand still. False if it is too fast to be
    /// bias: then something turns the robot, and nothing is learnt.
    pub(super) fn learn(&mut self, rate_radps: f64) -> bool {
        let at_rest = rate_radps.abs() <= LARGEST_BIAS_RADPS;
        if at_rest {
            self.samples = (self.samples + 1.0).min(MEMORY);
            self.mean_radps += (rate_radps - self.mean_radps) / self.samples;
        }
        at_rest
    }

    pub(super) fn fold_state(&self, fold: &mut impl FnMut(u64)) {
        fold(self.mean_radps.to_bits());
        fold(self.samples.to_bits());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of a constant is that constant, from the first sample on.
    #[test]
    fn a_constant_rate_is_the_bias() {
        let mut bias = GyroBias::default();
        for _ in 0..1000 {
            assert!(bias.learn(0.0125));
            assert_eq!(bias.radps(), 0.0125);
        }
    }

    /// Motion and NaN teach nothing.
    #[test]
    fn motion_is_not_bias() {
        let mut bias = GyroBias::default();
        for rate in [0.06, -0.06, 2.0, f64::NAN, f64::INFINITY] {
            assert!(!bias.learn(rate));
        }
        assert_eq!(bias, GyroBias::default());
    }

    /// A bias that steps from a to b is followed: after n further samples of the full memory N the
    /// mean is b + (a − b)(1 − 1/N)^n, which for n = 5N is within 1 % of the step.
    #[test]
    fn an_old_bias_is_forgotten() {
        let mut bias = GyroBias::default();
        for _ in 0..200 {
            bias.learn(0.02);
        }
        for _ in 0..1000 {
            bias.learn(-0.01);
        }
        assert!((bias.radps() + 0.01).abs() < 0.03 * 0.01);
    }
}
