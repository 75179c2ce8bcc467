//! The extended Kalman filter over encoders and gyro.
//!
//! State, with the wheels as the robot's own odometer:
//!
//! | | | |
//! |---|---|---|
//! | x, y, θ | pose in the odometry frame | m, m, rad |
//! | v | forward speed, by the wheels | m/s |
//! | ω | turn rate of the body | rad/s |
//! | b | what the gyro shows beyond ω | rad/s |
//! | κ | what the wheels turn more than the body, as a share: slip in turning, a track measured wrongly | |
//! | ℓ, φ | what the wheels' counters should show, as travel and turn, beyond their newest reading | m, rad |
//!
//! Motion over a stretch of Δt, along an arc, with the forward acceleration a where it is known:
//!
//! ```text
//! v̄ = v + ½ a Δt      Δs = v̄ Δt      Δθ = ω Δt
//! x += Δs sinc(Δθ/2) cos(θ + Δθ/2)   y likewise   θ += Δθ   v += a Δt   ℓ += Δs   φ += (1 + κ) Δθ
//! ```
//!
//! Speeds jump at the start of a stretch and then hold, for such is a robot that takes velocity
//! commands. So what a sensor says about the speed at the end of a stretch corrects the pose for all
//! of it, through the covariance.
//!
//! ℓ and φ are carried on, not differenced: a counter cut into ticks is wrong by a fraction of a tick
//! however far it has run, and the filter is to know that.
//!
//! The covariance is updated in Joseph's form, P ← (I − K h)P(I − K h)ᵀ + K R Kᵀ, on one triangle and
//! mirrored: symmetric by construction. Products of matrices are spelt out along their few non-zero
//! elements, in one fixed order.

use nalgebra::{SMatrix, SVector};
use schemas::Pose;

use crate::digest::Digest;

/// Indices into the state.
pub(super) const X: usize = 0;
pub(super) const Y: usize = 1;
pub(super) const THETA: usize = 2;
pub(super) const V: usize = 3;
pub(super) const OMEGA: usize = 4;
pub(super) const BIAS: usize = 5;
pub(super) const TURN_GAIN: usize = 6;
pub(super) const TRAVEL: usize = 7;
pub(super) const TURN: usize = 8;

const STATES: usize = 9;

/// Zero-rate offset of a gyro before it is known, rad/s: five times that of the simulated one.
pub(super) const BIAS_SIGMA_RADPS: f64 = 0.05;

/// How fast that offset wanders, rad/s per √s: 0.001 rad/s in 100 s.
const BIAS_WANDER: f64 = 1e-4;

/// Slip in turning before it is known, as a share.
const TURN_GAIN_SIGMA: f64 = 0.05;

/// The same of slip that changes with the floor, per √s.
const TURN_GAIN_WANDER: f64 = 1e-3;

/// A jump of the turn rate, rad/s, from one sample to the next: a plant of 2 rad/s that takes
/// velocity commands may go from one limit to the other, and the gate lets through 3.3 of these.
const JUMP_RADPS: f64 = 1.5;

/// A jump of the speed, m/s, where no accelerometer tells of it; likewise for ±0.7 m/s.
const JUMP_MPS: f64 = 0.5;

/// The stretch that such a jump is expected in, seconds: one IMU sample. In less, less happens.
const JUMP_STRETCH_S: f64 = 0.01;

/// Standard deviation of the forward acceleration, m/s²: six times the noise of the simulated
/// accelerometer, which leaves room for 1.5° of tilt that the attitude does not know of.
const ACCEL_SIGMA_MPS2: f64 = 0.3;

/// The part of an acceleration, as a share, that the wheels need not show: slip.
const ACCEL_SHARE: f64 = 0.05;

/// Random error of a wheel's travel per √m, metres: 1 % of each of the increments that a wheel at
/// 0.7 m/s makes in 20 ms.
const TRAVEL_NOISE: f64 = 0.0012;

/// Standard deviation of what a counter of whole millimetres leaves out, metres: 1/√12.
const TICK_SIGMA_M: f64 = 0.000_289;

/// Variances beyond this are lost knowledge; the filter then starts its covariance afresh.
const LARGEST_VARIANCE: f64 = 1e12;

type State = SVector<f64, STATES>;
type Covariance = SMatrix<f64, STATES, STATES>;

/// The filter.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ekf {
    x: State,
    p: Covariance,
    track_m: f64,
    /// A pose to go back to, should a number get lost.
    good: Pose,
}

/// A measurement of one number: two coefficients by the index of what they multiply, the innovation,
/// and the variance of its noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measurement {
    pub(super) of: [(usize, f64); 2],
    pub(super) innovation: f64,
    pub(super) variance: f64,
}

impl Measurement {
    /// A measurement of one element of the state.
    pub(super) fn direct(of: usize, innovation: f64, variance: f64) -> Measurement {
        Measurement { of: [(of, 1.0), (of, 0.0)], innovation, variance }
    }
}

impl Ekf {
    /// At rest at `start`, which is known exactly. Its frame is the odometry frame.
    pub(super) fn new(start: Pose, track_m: f64) -> Ekf {
        let mut x = State::zeros();
        (x[X], x[Y], x[THETA]) = (start.x_m, start.y_m, start.theta_rad);
        let mut ekf = Ekf { x, p: Covariance::zeros(), track_m, good: start };
        ekf.forget();
        ekf
    }

    /// Starts the covariance afresh: pose as it is, everything else unknown.
    fn forget(&mut self) {
        self.p = Covariance::zeros();
        for (of, sigma) in [
            (X, 1e-6),
            (Y, 1e-6),
            (THETA, 1e-6),
            (V, JUMP_MPS),
            (OMEGA, JUMP_RADPS),
            (BIAS, BIAS_SIGMA_RADPS),
            (TURN_GAIN, TURN_GAIN_SIGMA),
        ] {
            self.p[(of, of)] = sigma * sigma;
        }
        self.anchor();
    }

    /// The counters count from here: nothing is known of what they should show but that.
    pub(super) fn anchor(&mut self) {
        let tick = TICK_SIGMA_M * TICK_SIGMA_M;
        self.replace(TRAVEL, 0.0, 0.5 * tick);
        self.replace(TURN, 0.0, 2.0 * tick / (self.track_m * self.track_m));
    }

    /// Puts a number in place of what was known of one element of the state.
    pub(super) fn replace(&mut self, of: usize, value: f64, variance: f64) {
        self.x[of] = value;
        self.p.row_mut(of).fill(0.0);
        self.p.column_mut(of).fill(0.0);
        self.p[(of, of)] = variance;
    }

    /// Adds to one element what is known exactly.
    pub(super) fn shift(&mut self, of: usize, by: f64) {
        self.x[of] += by;
    }

    /// Adds to what is not known of one element.
    pub(super) fn doubt(&mut self, of: usize, sigma: f64) {
        self.p[(of, of)] += sigma * sigma;
    }

    /// The pose.
    pub(super) fn pose(&self) -> Pose {
        Pose { x_m: self.x[X], y_m: self.x[Y], theta_rad: self.x[THETA] }
    }

    /// One element of the state.
    pub(super) fn get(&self, of: usize) -> f64 {
        self.x[of]
    }

    /// Its variance.
    pub(super) fn variance(&self, of: usize) -> f64 {
        self.p[(of, of)]
    }

    /// The variance of what a counter leaves out, for travel and for turn.
    pub(super) fn counter_variances(&self) -> [f64; 2] {
        let tick = TICK_SIGMA_M * TICK_SIGMA_M;
        [0.5 * tick, 2.0 * tick / (self.track_m * self.track_m)]
    }

    /// Goes on by `elapsed_s` > 0 seconds, with the mean forward acceleration of that time, m/s²,
    /// where it is known. Returns how far it went and turned.
    pub(super) fn predict(&mut self, elapsed_s: f64, accel_mps2: Option<f64>) -> (f64, f64) {
        let accel = accel_mps2.unwrap_or(0.0);
        self.wander(elapsed_s, accel_mps2);

        let (theta, omega, kappa) = (self.x[THETA], self.x[OMEGA], self.x[TURN_GAIN]);
        let mean_mps = self.x[V] + 0.5 * accel * elapsed_s;
        let [along_x, along_y] = arc_s(theta, omega, elapsed_s);
        let (dx, dy) = (mean_mps * along_x, mean_mps * along_y);
        let (travel_m, turn_rad) = (mean_mps * elapsed_s, omega * elapsed_s);
        self.x[X] += dx;
        self.x[Y] += dy;
        self.x[THETA] += turn_rad;
        self.x[V] += accel * elapsed_s;
        self.x[TRAVEL] += travel_m;
        self.x[TURN] += (1.0 + kappa) * turn_rad;

        // F = I + these partial derivatives.
        let half_s = 0.5 * elapsed_s;
        let (turn_omega, turn_gain) = ((1.0 + kappa) * elapsed_s, turn_rad);
        let carry = |to: &mut [f64; STATES]| {
            // In an order in which what is read has not been written yet.
            to[X] += along_x * to[V] - dy * (to[THETA] + half_s * to[OMEGA]);
            to[Y] += along_y * to[V] + dx * (to[THETA] + half_s * to[OMEGA]);
            to[THETA] += elapsed_s * to[OMEGA];
            to[TRAVEL] += elapsed_s * to[V];
            to[TURN] += turn_omega * to[OMEGA] + turn_gain * to[TURN_GAIN];
        };
        // F P, column by column; then (F P) Fᵀ is F (F P)ᵀ, whose transpose is itself.
        self.p.data.0.iter_mut().for_each(carry);
        self.p.transpose_mut();
        self.p.data.0.iter_mut().for_each(carry);
        // Sums in another order round differently.
        self.p.fill_lower_triangle_with_upper_triangle();

        let direction = [along_x / elapsed_s, along_y / elapsed_s];
        self.roughen(travel_m, turn_rad, accel * elapsed_s * half_s, direction);
        (travel_m, turn_rad)
    }

    /// What speeds, bias and gain may do by themselves.
    fn wander(&mut self, elapsed_s: f64, accel_mps2: Option<f64>) {
        let share = (elapsed_s / JUMP_STRETCH_S).min(1.0);
        self.p[(V, V)] += match accel_mps2 {
            Some(accel) => {
                let (noise, slip) = (ACCEL_SIGMA_MPS2 * elapsed_s, ACCEL_SHARE * accel * elapsed_s);
                noise * noise + slip * slip
            }
            None => JUMP_MPS * JUMP_MPS * share,
        };
        self.p[(OMEGA, OMEGA)] += JUMP_RADPS * JUMP_RADPS * share;
        self.p[(BIAS, BIAS)] += BIAS_WANDER * BIAS_WANDER * elapsed_s;
        self.p[(TURN_GAIN, TURN_GAIN)] += TURN_GAIN_WANDER * TURN_GAIN_WANDER * elapsed_s;
    }

    /// Random errors of the wheels over `travel_m` and `turn_rad`, and not knowing when in the
    /// stretch the speed changed, which is worth `when_m`.
    fn roughen(&mut self, travel_m: f64, turn_rad: f64, when_m: f64, [cos, sin]: [f64; 2]) {
        let half_m = 0.5 * self.track_m * turn_rad;
        let rolled_m = (travel_m - half_m).abs() + (travel_m + half_m).abs();
        // Sum of the two wheels' variances.
        let wheels = TRAVEL_NOISE * TRAVEL_NOISE * rolled_m;
        let when = when_m * when_m;
        // The counters show what the wheels rolled, so travel by them is wrong in x and y; the turn
        // by them is not the body's, so it is wrong in φ.
        let along = 0.25 * wheels + when;
        self.p[(X, X)] += along * cos * cos;
        self.p[(X, Y)] += along * cos * sin;
        self.p[(Y, X)] += along * cos * sin;
        self.p[(Y, Y)] += along * sin * sin;
        self.p[(TRAVEL, TRAVEL)] += when;
        for (axis, share) in [(X, cos), (Y, sin)] {
            self.p[(axis, TRAVEL)] += when * share;
            self.p[(TRAVEL, axis)] += when * share;
        }
        self.p[(TURN, TURN)] += wheels / (self.track_m * self.track_m);
    }

    /// Variance of a measurement's innovation.
    pub(super) fn innovation_variance(&self, z: &Measurement) -> f64 {
        let spread = self.spread(z);
        z.of[0].1 * spread[z.of[0].0] + z.of[1].1 * spread[z.of[1].0] + z.variance
    }

    /// νᵀS⁻¹ν of two measurements of one element each.
    pub(super) fn together(&self, a: &Measurement, b: &Measurement) -> f64 {
        let (i, j) = (a.of[0].0, b.of[0].0);
        let saa = self.p[(i, i)] + a.variance;
        let sbb = self.p[(j, j)] + b.variance;
        let sab = self.p[(i, j)];
        let determinant = saa * sbb - sab * sab;
        let weighted = sbb * a.innovation * a.innovation - 2.0 * sab * a.innovation * b.innovation
            + saa * b.innovation * b.innovation;
        weighted / determinant
    }

    /// P hᵀ.
    fn spread(&self, z: &Measurement) -> [f64; STATES] {
        let [(i, a), (j, b)] = z.of;
        let (first, second) = (&self.p.data.0[i], &self.p.data.0[j]);
        let mut spread = [0.0; STATES];
        for row in 0..STATES {
            spread[row] = a * first[row] + b * second[row];
        }
        spread
    }

    /// Takes a measurement in. Its innovation is as of the present state.
    pub(super) fn update(&mut self, z: &Measurement) {
        let spread = self.spread(z);
        let [(i, a), (j, b)] = z.of;
        let seen = a * spread[i] + b * spread[j];
        let variance = seen + z.variance;
        if variance.is_nan() || variance <= 0.0 || !z.innovation.is_finite() {
            return;
        }
        let mut gain = [0.0; STATES];
        // K R less (I − K h) P hᵀ: nothing but rounding, which Joseph's form takes care of.
        let mut slack = [0.0; STATES];
        for row in 0..STATES {
            gain[row] = spread[row] / variance;
            slack[row] = gain[row] * z.variance - (spread[row] - gain[row] * seen);
            self.x[row] += gain[row] * z.innovation;
        }
        for (last, column) in self.p.data.0.iter_mut().enumerate() {
            let (k, g) = (gain[last], spread[last]);
            for (row, value) in column.iter_mut().take(last + 1).enumerate() {
                *value += slack[row] * k - gain[row] * g;
            }
        }
        self.p.fill_lower_triangle_with_upper_triangle();
    }

    /// The turn rate turned out to have changed by `by_radps` in the last `elapsed_s`; whether at the
    /// start, as the prediction has it, or evenly, nobody knows.
    pub(super) fn blur_turn(&mut self, by_radps: f64, elapsed_s: f64) {
        let when_rad = 0.5 * by_radps * elapsed_s;
        let gain = 1.0 + self.x[TURN_GAIN];
        let variance = when_rad * when_rad;
        self.p[(THETA, THETA)] += variance;
        self.p[(THETA, TURN)] += gain * variance;
        self.p[(TURN, THETA)] += gain * variance;
        self.p[(TURN, TURN)] += gain * gain * variance;
    }

    /// Sees to it that what the filter holds can be used: should a number have got lost, which no
    /// admitted sample makes happen, it goes on from the last good pose, at rest.
    pub(super) fn tidy(&mut self) {
        let pose = self.pose();
        let bad_variance = (0..STATES).any(|of| {
            let variance = self.p[(of, of)];
            !(0.0..=LARGEST_VARIANCE).contains(&variance)
        });
        if pose.is_finite() && self.x.iter().all(|number| number.is_finite()) {
            self.good = pose;
            if bad_variance {
                self.forget();
            }
        } else {
            *self = Ekf::new(self.good, self.track_m);
        }
    }

    pub(super) fn fold(&self, digest: &mut Digest) {
        digest.numbers(self.x.as_slice());
        // One triangle is all of it.
        for (last, column) in self.p.data.0.iter().enumerate() {
            digest.numbers(&column[..=last]);
        }
        digest.pose(&self.good);
    }
}

/// ∫₀ᵗ (cos(θ + ωτ), sin(θ + ωτ)) dτ, seconds: t·sinc(ωt/2) in the direction θ + ωt/2.
pub(super) fn arc_s(theta_rad: f64, omega_radps: f64, elapsed_s: f64) -> [f64; 2] {
    let half_rad = 0.5 * omega_radps * elapsed_s;
    let chord_s = elapsed_s * sinc(half_rad);
    let (sin, cos) = libm::sincos(theta_rad + half_rad);
    [chord_s * cos, chord_s * sin]
}

/// sin x / x. Below 1e-4 the first two terms of the series, whose rest x⁴/120 is under 1e-18.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { libm::sin(x) / x }
}

#[cfg(test)]
mod tests;
