//! The constant error of a gyro, learnt while the robot stands still.

use crate::digest::Digest;

/// How many samples the running mean reaches back over. At 100 Hz two seconds: a bias drifts over
/// minutes, and the mean of 200 samples of the default gyro (sigma 0.005 rad/s) is good to 0.0004 rad/s.
const MEMORY: f64 = 200.0;

/// Rates above this, rad/s, are motion, not bias: five times the bias that the simulated gyro has
/// by default, and the order of the worst zero-rate offset in the data sheets of such gyros.
const LARGEST_BIAS_RADPS: f64 = 0.05;

/// Running mean of the turn rate that the gyro reports at rest.
///
/// Whether the wheels stand still is known only afterwards, so what the gyro says is kept aside until
/// the encoders have told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct GyroBias {
    mean_radps: f64,
    samples: f64,
    aside: Aside,
}

/// Gyro samples since the last encoder sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Aside {
    sum_radps: f64,
    samples: f64,
    /// Whether one of them was too fast to be bias.
    fast: bool,
}

impl GyroBias {
    /// The bias, rad/s; 0 while none has been learnt.
    pub(super) fn radps(&self) -> f64 {
        self.mean_radps
    }

    /// Takes the rate that the gyro reports.
    pub(super) fn hear(&mut self, rate_radps: f64) {
        self.aside.sum_radps += rate_radps;
        self.aside.samples += 1.0;
        self.aside.fast |= rate_radps.abs() > LARGEST_BIAS_RADPS;
    }

    /// The wheels have turned: what was heard since the last encoder sample is motion.
    pub(super) fn moved(&mut self) {
        self.aside = Aside::default();
    }

    /// The wheels have stood still: what was heard is bias. False, and nothing is learnt, if it was too
    /// fast for that; then something else turned the robot.
    pub(super) fn stood(&mut self) -> bool {
        let Aside { sum_radps, samples, fast } = std::mem::take(&mut self.aside);
        if samples > 0.0 && !fast {
            self.samples = (self.samples + samples).min(MEMORY.max(samples));
            self.mean_radps += (sum_radps - samples * self.mean_radps) / self.samples;
        }
        !fast
    }

    pub(super) fn fold(&self, digest: &mut Digest) {
        let Aside { sum_radps, samples, fast } = self.aside;
        digest.numbers(&[self.mean_radps, self.samples, sum_radps, samples]);
        digest.word(u64::from(fast));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stand(bias: &mut GyroBias, rates_radps: [f64; 2]) -> bool {
        for rate_radps in rates_radps {
            bias.hear(rate_radps);
        }
        bias.stood()
    }

    /// The mean of a constant is that constant, from the first sample on.
    #[test]
    fn a_constant_rate_is_the_bias() {
        let mut bias = GyroBias::default();
        for _ in 0..500 {
            assert!(stand(&mut bias, [0.0125; 2]));
            assert!((bias.radps() - 0.0125).abs() < 1e-15);
        }
    }

    /// Motion teaches nothing, however slow, nor does a turn with standing wheels.
    #[test]
    fn motion_is_not_bias() {
        let mut bias = GyroBias::default();
        for rate in [0.01, 0.04, -2.0] {
            bias.hear(rate);
            bias.moved();
        }
        assert!(!stand(&mut bias, [0.01, 0.06]));
        assert!(!stand(&mut bias, [-2.0, 0.0]));
        assert_eq!(bias.radps(), 0.0);
        assert!(bias.stood(), "nothing heard is no motion");
        assert_eq!(bias, GyroBias::default());
    }

    /// A bias that steps from a to b is followed: after n pairs of samples with the full memory of N the
    /// mean is b + (a − b)(1 − 2/N)^n, which for n = 5N/2 is within 1 % of the step.
    #[test]
    fn an_old_bias_is_forgotten() {
        let mut bias = GyroBias::default();
        for _ in 0..100 {
            stand(&mut bias, [0.02; 2]);
        }
        for _ in 0..500 {
            stand(&mut bias, [-0.01; 2]);
        }
        assert!((bias.radps() + 0.01).abs() < 0.01 * 0.03);
    }
}
