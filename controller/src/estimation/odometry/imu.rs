//! What the IMU tells.

use schemas::{ImuSample, Time};

use super::{FASTEST_TURN_RADPS, GYRO_SIGMA_RADPS, HOLD_S, Odometry};
use crate::estimation::ekf::{BIAS, Measurement, OMEGA, V};
use crate::estimation::health::GYRO_HOLD_S;

/// Accelerations beyond this, m/s², are nonsense: 16 g, the full scale of common accelerometers.
const STRONGEST_MPS2: f64 = 157.0;

/// Specific force weaker than this, m/s², is no accelerometer's on a floor: half of gravity.
const WEAKEST_MPS2: f64 = 4.9;

/// A stretch longer than this, seconds, is not what one accelerometer sample stands for: two IMU
/// periods.
const ACCEL_HOLD_S: f64 = 0.02;

/// Time constant, seconds, over which the accelerometer's constant part is averaged.
const TILT_S: f64 = 2.0;

/// What the accelerometer shows beyond the wheels' acceleration counts towards its constant part up to
/// this, m/s²: 10° of tilt. More is a jump, which wheels and accelerometer do not show at the same time.
const LARGEST_TILT_MPS2: f64 = 1.7;

/// After this many turn rates turned away in a row, 30 ms, the gyro is right and the filter wrong.
const GYRO_IN_A_ROW: u32 = 3;

impl Odometry {
    /// Turns the attitude on, by the gyro less its bias about z. The accelerometer is to show gravity
    /// alone: what the robot's own motion adds along an arc, v' ahead and v ω to the left, is taken off.
    pub(super) fn orient(&mut self, sample: &ImuSample) {
        let elapsed_s = self.gyro.map_or(0.0, |before| sample.stamp.seconds_since(before));
        let [x, y, z] = sample.gyro_radps;
        let [ahead, left, up] = sample.accel_mps2;
        let outward_mps2 = self.ekf.get(V) * self.ekf.get(OMEGA);
        let at_rest =
            ImuSample { accel_mps2: [ahead - self.felt_mps2, left - outward_mps2, up], ..*sample };
        self.attitude.update(&at_rest, [x, y, z - self.ekf.get(BIAS)], elapsed_s);
    }

    /// Whether the gyro comes back after a gap that the encoders may still tell about.
    pub(super) fn waits_for_the_wheels(&mut self, stamp: Time) -> bool {
        let Some(reached) = self.reached else { return false };
        if stamp.seconds_since(reached) <= GYRO_HOLD_S || self.wheels.newest().is_none() {
            self.gap_until = None;
            return false;
        }
        let back = *self.gap_until.get_or_insert(stamp);
        if stamp.seconds_since(back) <= GYRO_HOLD_S {
            return true;
        }
        self.gap_until = None;
        false
    }

    /// Gives up the speed where encoders have been silent for too long. It stays unknown, but the same
    /// from then on: when the counters are heard again, they tell how fast it was all along.
    pub(super) fn release(&mut self, stamp: Time) {
        let silent = self.wheels.stamp().is_some_and(|at| stamp.seconds_since(at) > HOLD_S);
        if silent && self.released.is_none() {
            self.released = self.reached;
            self.ekf.replace(V, 0.0, 1.0);
        }
    }

    /// The forward acceleration, m/s², where the accelerometer can be believed.
    pub(super) fn forward_mps2(&mut self, sample: &ImuSample) -> Option<f64> {
        let elapsed_s = sample.stamp.seconds_since(self.reached?);
        if self.distrust_until.is_some_and(|until| sample.stamp < until)
            || elapsed_s > ACCEL_HOLD_S
            || self.released.is_some()
        {
            return None;
        }
        let strongest = sample.accel_mps2.iter().fold(0.0, |most: f64, axis| most.max(axis.abs()));
        let known = sample.accel_mps2.iter().all(|axis| axis.is_finite());
        let plausible = known && (WEAKEST_MPS2..=STRONGEST_MPS2).contains(&strongest);
        let beyond_mps2 = sample.accel_mps2[0] - self.felt_mps2 - self.tilt_mps2;
        if plausible && self.at_odds.is_none() && beyond_mps2.abs() < LARGEST_TILT_MPS2 {
            self.tilt_mps2 += beyond_mps2 * elapsed_s / TILT_S;
        }
        plausible.then(|| sample.accel_mps2[0] - self.tilt_mps2)
    }

    /// Takes a turn rate in.
    pub(super) fn hear_rate(&mut self, rate_radps: f64, stamp: Time) {
        let expected_radps = self.ekf.get(OMEGA) + self.ekf.get(BIAS);
        let z = Measurement {
            of: [(OMEGA, 1.0), (BIAS, 1.0)],
            innovation: rate_radps - expected_radps,
            variance: GYRO_SIGMA_RADPS * GYRO_SIGMA_RADPS,
        };
        let normalised = z.innovation * z.innovation / self.ekf.innovation_variance(&z);
        if self.gyro_gate.admits(normalised) {
            self.ekf.update(&z);
            return;
        }
        self.health.gyro_rejected = Some(stamp);
        if self.gyro_gate.in_a_row >= GYRO_IN_A_ROW {
            self.gyro_gate.in_a_row = 0;
            self.ekf.doubt(OMEGA, FASTEST_TURN_RADPS);
            self.ekf.update(&z);
            self.health.recovery = Some(stamp);
        }
    }
}
