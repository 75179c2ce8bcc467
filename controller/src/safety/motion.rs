//! The motion that a plant makes of commands, as the safety layer foresees it.
//!
//! In: where and how fast the robot is, and what it is told. Out: where and how fast it is a while
//! later. It is the plant of (1) or (2) within its limits: velocities reached at once or at no more
//! than the accelerations, accelerations until a speed is at its limit.

use schemas::{Plant, Pose};

/// Longest stretch over which changing speeds are taken as their means, seconds. At 2 m/s², 6 rad/s²
/// and full speed the error of position, |aω − vα| Δt³/12, is under 4e-6 m then.
const LONGEST_STEP_S: f64 = 0.02;

/// What the plant is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// Reach these velocities, [m/s, rad/s].
    Velocities([f64; 2]),
    /// Hold these accelerations, [m/s², rad/s²].
    Accelerations([f64; 2]),
}

/// A robot on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// Where it is.
    pub pose: Pose,
    /// How fast, [m/s, rad/s].
    pub speeds: [f64; 2],
}

/// How one speed changes: at a constant rate until it reaches its end, where it stays.
#[derive(Clone, Copy, Debug)]
struct Ramp {
    rate: f64,
    end: f64,
}

impl Ramp {
    fn towards(value: f64, end: f64, steepest: f64) -> Ramp {
        let rate = if end > value {
            steepest
        } else if end < value {
            -steepest
        } else {
            0.0
        };
        Ramp { rate, end }
    }

    fn held(value: f64, rate: f64, limit: f64) -> Ramp {
        let end = if rate > 0.0 { limit } else { -limit };
        if (end - value) * rate > 0.0 { Ramp { rate, end } } else { Ramp { rate: 0.0, end: value } }
    }

    /// The value after a while, and its mean until then.
    fn after(self, value: f64, elapsed_s: f64) -> (f64, f64) {
        if self.rate == 0.0 {
            return (value, value);
        }
        let lasts_s = (self.end - value) / self.rate;
        if elapsed_s >= lasts_s {
            let short = 0.5 * (self.end - value) * lasts_s;
            (self.end, self.end - short / elapsed_s)
        } else {
            let gained = self.rate * elapsed_s;
            (value + gained, value + 0.5 * gained)
        }
    }
}

impl Drive {
    /// The speeds at the moment when a plant at `speeds` takes this up.
    pub fn taken_up(self, plant: &Plant, speeds: [f64; 2]) -> [f64; 2] {
        match self {
            Drive::Velocities(target) if !plant.limits_acceleration => target,
            _ => speeds,
        }
    }

    fn ramps(self, plant: &Plant, [v_mps, omega_radps]: [f64; 2]) -> [Ramp; 2] {
        match self {
            Drive::Velocities([v, omega]) => [
                Ramp::towards(v_mps, v, plant.accel_max_mps2),
                Ramp::towards(omega_radps, omega, plant.alpha_max_radps2),
            ],
            Drive::Accelerations([forward, turn]) => [
                Ramp::held(v_mps, forward, plant.v_max_mps),
                Ramp::held(omega_radps, turn, plant.omega_max_radps),
            ],
        }
    }
}

impl Moving {
    /// The speeds after `elapsed_s` of `drive`, which has been taken up already.
    pub fn speeds_after(&self, plant: &Plant, drive: Drive, elapsed_s: f64) -> [f64; 2] {
        let [forward, turn] = drive.ramps(plant, self.speeds);
        let [v, omega] = self.speeds;
        [forward.after(v, elapsed_s).0, turn.after(omega, elapsed_s).0]
    }

    /// Moves on by `elapsed_s` of `drive`, which has been taken up already: exactly at constant
    /// speeds, to less than a tenth of a millimetre at changing ones.
    pub fn advance(&mut self, plant: &Plant, drive: Drive, elapsed_s: f64) {
        let mut left_s = elapsed_s;
        while left_s > 0.0 {
            let [forward, turn] = drive.ramps(plant, self.speeds);
            let steady = forward.rate == 0.0 && turn.rate == 0.0;
            let step_s = if steady { left_s } else { left_s.min(LONGEST_STEP_S) };
            let [v, omega] = self.speeds;
            let (v_after, v_mean) = forward.after(v, step_s);
            let (omega_after, omega_mean) = turn.after(omega, step_s);
            self.pose = arc(&self.pose, [v_mean, omega_mean], step_s);
            self.speeds = [v_after, omega_after];
            left_s -= step_s;
        }
    }
}

/// `pose` after driving (v, ω) for `seconds`: the chord of the circle through both poses.
pub fn arc(pose: &Pose, [v_mps, omega_radps]: [f64; 2], seconds: f64) -> Pose {
    let turn_rad = omega_radps * seconds;
    let half_rad = 0.5 * turn_rad;
    let sinc = if half_rad == 0.0 { 1.0 } else { libm::sin(half_rad) / half_rad };
    let chord_m = v_mps * seconds * sinc;
    let (sin, cos) = libm::sincos(pose.theta_rad + half_rad);
    Pose {
        x_m: pose.x_m + chord_m * cos,
        y_m: pose.y_m + chord_m * sin,
        theta_rad: pose.theta_rad + turn_rad,
    }
}
