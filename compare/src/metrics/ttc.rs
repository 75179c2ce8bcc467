//! How soon the robot would touch something: `min_ttc_s`, `ttc_exposure_s`, `stop_margin_m`.

use super::accumulate::Accumulate;
use super::sample::{Motion, Setting};

/// τ*: an encounter nearer in time than this is a serious one, seconds (van der Horst, "A time-based
/// analysis of road user behaviour in normal and critical encounters", 1990, section 2).
pub(super) const SERIOUS_BELOW_S: f64 = 1.5;

/// One control period of the paper's experiments, seconds: what any controller with that period
/// needs before it can act. The same for both arms of a comparison, whatever their periods.
const REACTS_WITHIN_S: f64 = 0.1;

/// `min_ttc_s` = min over the run of the time to collision: the first τ ≤ 3 s at which the footprint
/// touches something when it goes on at its present (v, ω) and the discs go on as they do.
///
/// 3 s where nothing is met within 3 s: every run has a value, and a pair of runs a difference.
#[derive(Clone, Debug)]
pub(super) struct MinTtc {
    least_s: f64,
}

impl MinTtc {
    pub(super) fn new() -> Self {
        MinTtc { least_s: f64::INFINITY }
    }
}

impl Accumulate for MinTtc {
    fn motion(&mut self, motion: &Motion) {
        // `min` drops NaN.
        self.least_s = self.least_s.min(motion.ttc_s);
    }

    fn value(&self) -> Option<f64> {
        self.least_s.is_finite().then_some(self.least_s)
    }
}

/// `ttc_exposure_s` = ∫ 1{TTC < τ*} dt: time exposed time-to-collision (Minderhoud and Bovy,
/// "Extended time-to-collision measures for road traffic safety assessment", Accident Analysis and
/// Prevention 33, 2001).
#[derive(Clone, Debug, Default)]
pub(super) struct TtcExposure {
    exposed_s: f64,
    known: bool,
}

impl Accumulate for TtcExposure {
    fn motion(&mut self, motion: &Motion) {
        self.known |= !motion.ttc_s.is_nan();
        if motion.ttc_s < SERIOUS_BELOW_S {
            self.exposed_s += motion.hold_s;
        }
    }

    fn value(&self) -> Option<f64> {
        self.known.then_some(self.exposed_s)
    }

    fn total(&self) -> Option<f64> {
        self.value()
    }
}

/// `stop_margin_m` = min over the run of d − |v| `t_react` − v²/(2 `a_max`), with `t_react` the
/// actuator delay and 0.1 s: what would have been left after an emergency stop, metres.
#[derive(Clone, Debug)]
pub(super) struct StopMargin {
    reacts_s: f64,
    brake_mps2: f64,
    least_m: f64,
}

impl StopMargin {
    pub(super) fn new(setting: &Setting) -> Self {
        StopMargin {
            reacts_s: setting.plant.actuator_delay_s + REACTS_WITHIN_S,
            brake_mps2: setting.plant.accel_max_mps2,
            least_m: f64::INFINITY,
        }
    }
}

impl Accumulate for StopMargin {
    fn motion(&mut self, motion: &Motion) {
        let v_mps = motion.twist.v_mps;
        let stops_m = libm::fabs(v_mps) * self.reacts_s + v_mps * v_mps / (2.0 * self.brake_mps2);
        self.least_m = self.least_m.min(motion.clearance_m - stops_m);
    }

    fn value(&self) -> Option<f64> {
        self.least_m.is_finite().then_some(self.least_m)
    }
}

#[cfg(test)]
mod tests {
    use schemas::{Pose, Twist};

    use super::*;

    fn motion(ttc_s: f64) -> Motion {
        Motion {
            t_s: 0.0,
            hold_s: 0.25,
            pose: Pose::default(),
            twist: Twist::default(),
            clearance_m: f64::NAN,
            clearance_static_m: f64::NAN,
            discs: Vec::new(),
            ttc_s,
        }
    }

    /// τ* itself is not below τ*. What is known so far is told after each motion, for the profile.
    #[test]
    fn exposure_is_the_time_below_the_threshold() {
        let mut exposure = TtcExposure::default();
        assert_eq!((exposure.value(), exposure.total()), (None, None));
        let steps = [
            (f64::NAN, None),
            (3.0, Some(0.0)),
            (1.49, Some(0.25)),
            (1.5, Some(0.25)),
            (0.0, Some(0.5)),
        ];
        for (ttc_s, want_s) in steps {
            exposure.motion(&motion(ttc_s));
            assert_eq!((exposure.value(), exposure.total()), (want_s, want_s), "after {ttc_s} s");
        }
    }
}
