//! Attitude from gyro, accelerometer and magnetometer.
//!
//! S. Madgwick, *An efficient orientation filter for inertial and inertial/magnetic sensor arrays*,
//! 2010. Equations in round brackets are of that report. The quaternion q = (q1, q2, q3, q4) takes
//! vectors from the body (x forward, y left, z up) into the earth frame (x towards magnetic north,
//! z up): q ⊗ v ⊗ q*. It follows the gyro and is drawn, at a rate β and whatever the
//! size of the error, down the gradient of how badly gravity and field would fit (33), (44):
//!
//! ```text
//! q' = ½ q ⊗ (0, ω) − β ∇f/|∇f|        ∇f = Jᵀ f
//! ```
//!
//! | what is plausible | what is used |
//! |---|---|
//! | accelerometer and magnetometer | the nine-axis form, f = (f_g, f_b) |
//! | the accelerometer alone | the six-axis form, f = f_g: roll and pitch hold, yaw drifts with the gyro |
//! | neither | the gyro |
//! | not even the gyro | nothing: the attitude holds |

use core::ops::RangeInclusive;

use schemas::ImuSample;

use crate::digest::Digest;

/// β of the nine-axis form, rad/s of quaternion rate: what the report found best for its sensors
/// (section 5). β = √¾ · (gyro error in rad/s) by (50): 0.041 makes up for 0.047 rad/s.
const GAIN_NINE_AXES: f64 = 0.041;

/// β of the six-axis form, likewise.
const GAIN_SIX_AXES: f64 = 0.033;

/// Standard gravity, m/s².
const GRAVITY_MPS2: f64 = 9.81;

/// Specific force farther from gravity than this, m/s², has something else in it than gravity: three
/// standard deviations of the simulated accelerometer. An acceleration a at right angles to gravity
/// gives a²/2g, so this catches more than 1.7 m/s²; what is less tilts the attitude slowly, at 2β.
const GRAVITY_MARGIN_MPS2: f64 = 0.15;

/// The earth's field is 22 to 67 microtesla strong (World Magnetic Model 2020), and this leaves
/// a tenth for the sensor. Beyond it there is iron or current about.
const FIELD_UT: RangeInclusive<f64> = 20.0..=74.0;

/// The longest stretch, seconds, over which one turn rate is taken to hold.
const LONGEST_STRETCH_S: f64 = 0.2;

/// A Madgwick filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Madgwick {
    q: [f64; 4],
    heard: bool,
}

impl Madgwick {
    /// Level, with the heading `yaw_rad` (world frame).
    pub fn new(yaw_rad: f64) -> Madgwick {
        let (sin, cos) = libm::sincos(0.5 * yaw_rad);
        let q = if sin.is_finite() { [cos, 0.0, 0.0, sin] } else { [1.0, 0.0, 0.0, 0.0] };
        Madgwick { q, heard: false }
    }

    /// Goes on by `elapsed_s` seconds to the instant of `sample`. `gyro_radps` is its turn rate less
    /// whatever is known of the gyro's bias. A rate that is not finite changes nothing.
    pub fn update(&mut self, sample: &ImuSample, gyro_radps: [f64; 3], elapsed_s: f64) {
        if !gyro_radps.iter().all(|rate| rate.is_finite()) || elapsed_s.is_nan() || elapsed_s < 0.0
        {
            return;
        }
        self.heard = true;
        let stretch_s = elapsed_s.min(LONGEST_STRETCH_S);
        let [q1, q2, q3, q4] = self.q;
        let [wx, wy, wz] = gyro_radps;
        // ½ q ⊗ (0, ω) (12).
        let mut rate = [
            0.5 * (-q2 * wx - q3 * wy - q4 * wz),
            0.5 * (q1 * wx + q3 * wz - q4 * wy),
            0.5 * (q1 * wy - q2 * wz + q4 * wx),
            0.5 * (q1 * wz + q2 * wy - q3 * wx),
        ];
        if let Some((gradient, gain)) = self.gradient(sample) {
            let length = norm(&gradient);
            // At the bottom there is no way down.
            if length > 1e-12 {
                for (rate, slope) in rate.iter_mut().zip(gradient) {
                    *rate -= gain * slope / length;
                }
            }
        }
        let mut q = self.q;
        for (component, rate) in q.iter_mut().zip(rate) {
            *component += rate * stretch_s;
        }
        let length = norm(&q);
        if length > 0.0 && length.is_finite() {
            self.q = q.map(|component| component / length);
        }
    }

    /// Roll, pitch and yaw, radians: the rotation about z by yaw, then about the new y by pitch, then
    /// about the new x by roll, takes the earth frame to the body. Pitch is positive nose down. NaN
    /// before anything was heard.
    pub fn angles_rad(&self) -> [f64; 3] {
        if !self.heard {
            return [f64::NAN; 3];
        }
        let [q1, q2, q3, q4] = self.q;
        let nose_down = (2.0 * (q1 * q3 - q2 * q4)).clamp(-1.0, 1.0);
        [
            libm::atan2(2.0 * (q1 * q2 + q3 * q4), 1.0 - 2.0 * (q2 * q2 + q3 * q3)),
            libm::asin(nose_down),
            libm::atan2(2.0 * (q2 * q3 + q1 * q4), 1.0 - 2.0 * (q3 * q3 + q4 * q4)),
        ]
    }

    /// The gradient Jᵀf (34) of what the sample lets one see, with the gain that goes with it; `None`
    /// where there is no gravity to be seen.
    fn gradient(&self, sample: &ImuSample) -> Option<([f64; 4], f64)> {
        let force_mps2 = norm(&sample.accel_mps2);
        let still = (force_mps2 - GRAVITY_MPS2).abs() <= GRAVITY_MARGIN_MPS2;
        if !still {
            return None;
        }
        let [q1, q2, q3, q4] = self.q;
        let [ax, ay, az] = sample.accel_mps2.map(|force| force / force_mps2);
        // (25) and (26).
        let f = [
            2.0 * (q2 * q4 - q1 * q3) - ax,
            2.0 * (q1 * q2 + q3 * q4) - ay,
            2.0 * (0.5 - q2 * q2 - q3 * q3) - az,
        ];
        let mut gradient = [
            -2.0 * q3 * f[0] + 2.0 * q2 * f[1],
            2.0 * q4 * f[0] + 2.0 * q1 * f[1] - 4.0 * q2 * f[2],
            -2.0 * q1 * f[0] + 2.0 * q4 * f[1] - 4.0 * q3 * f[2],
            2.0 * q2 * f[0] + 2.0 * q3 * f[1],
        ];
        let field_ut = norm(&sample.mag_ut);
        if !FIELD_UT.contains(&field_ut) {
            return Some((gradient, GAIN_SIX_AXES));
        }
        let m = sample.mag_ut.map(|field| field / field_ut);
        let [mx, my, mz] = m;
        // The field in the earth frame, turned so that it has no component to the west (45), (46):
        // iron about can then bend the yaw only.
        let [hx, hy, bz] = self.to_earth(m);
        let bx = libm::sqrt(hx * hx + hy * hy);
        // (29) and (30).
        let f = [
            2.0 * bx * (0.5 - q3 * q3 - q4 * q4) + 2.0 * bz * (q2 * q4 - q1 * q3) - mx,
            2.0 * bx * (q2 * q3 - q1 * q4) + 2.0 * bz * (q1 * q2 + q3 * q4) - my,
            2.0 * bx * (q1 * q3 + q2 * q4) + 2.0 * bz * (0.5 - q2 * q2 - q3 * q3) - mz,
        ];
        let rows = [
            [
                -2.0 * bz * q3,
                2.0 * bz * q4,
                -4.0 * bx * q3 - 2.0 * bz * q1,
                -4.0 * bx * q4 + 2.0 * bz * q2,
            ],
            [
                -2.0 * bx * q4 + 2.0 * bz * q2,
                2.0 * bx * q3 + 2.0 * bz * q1,
                2.0 * bx * q2 + 2.0 * bz * q4,
                -2.0 * bx * q1 + 2.0 * bz * q3,
            ],
            [
                2.0 * bx * q3,
                2.0 * bx * q4 - 4.0 * bz * q2,
                2.0 * bx * q1 - 4.0 * bz * q3,
                2.0 * bx * q2,
            ],
        ];
        for (row, f) in rows.iter().zip(f) {
            for (slope, part) in gradient.iter_mut().zip(row) {
                *slope += part * f;
            }
        }
        Some((gradient, GAIN_NINE_AXES))
    }

    /// q ⊗ v ⊗ q*.
    fn to_earth(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [q1, q2, q3, q4] = self.q;
        [
            x * (1.0 - 2.0 * (q3 * q3 + q4 * q4))
                + 2.0 * y * (q2 * q3 - q1 * q4)
                + 2.0 * z * (q2 * q4 + q1 * q3),
            2.0 * x * (q2 * q3 + q1 * q4)
                + y * (1.0 - 2.0 * (q2 * q2 + q4 * q4))
                + 2.0 * z * (q3 * q4 - q1 * q2),
            2.0 * x * (q2 * q4 - q1 * q3)
                + 2.0 * y * (q3 * q4 + q1 * q2)
                + z * (1.0 - 2.0 * (q2 * q2 + q3 * q3)),
        ]
    }

    pub(super) fn fold(&self, digest: &mut Digest) {
        digest.numbers(&self.q);
        digest.word(u64::from(self.heard));
    }
}

/// Euclidean length; NaN or infinite where a component is.
fn norm(vector: &[f64]) -> f64 {
    libm::sqrt(vector.iter().map(|component| component * component).sum())
}

#[cfg(test)]
mod tests;
