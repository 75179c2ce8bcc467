//! How near the robot came: `min_clearance_m`, `near_miss_s`.

use super::accumulate::Accumulate;
use super::sample::Motion;

/// Below this clearance a passage counts as a near miss, metres. Our choice: a fifth of the paper's
/// footprint of 0.5 m, about the noise of a sonar reading at 2 m together with a step of travel.
pub(super) const NEAR_MISS_M: f64 = 0.1;

/// `min_clearance_m` = min over the run of d, the signed clearance of the footprint.
#[derive(Clone, Debug)]
pub(super) struct MinClearance {
    least_m: f64,
}

impl MinClearance {
    pub(super) fn new() -> Self {
        MinClearance { least_m: f64::INFINITY }
    }
}

impl Accumulate for MinClearance {
    fn motion(&mut self, motion: &Motion) {
        // `min` drops NaN: an unknown clearance is not a small one.
        self.least_m = self.least_m.min(motion.clearance_m);
    }

    fn value(&self) -> Option<f64> {
        // Still infinite: nothing known, or nothing there to keep clear of.
        self.least_m.is_finite().then_some(self.least_m)
    }
}

/// `near_miss_s` = ∫ 1{0 < d < `NEAR_MISS_M`} dt.
#[derive(Clone, Debug, Default)]
pub(super) struct NearMiss {
    exposed_s: f64,
    known: bool,
}

impl Accumulate for NearMiss {
    fn motion(&mut self, motion: &Motion) {
        self.known |= !motion.clearance_m.is_nan();
        if motion.clearance_m > 0.0 && motion.clearance_m < NEAR_MISS_M {
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
