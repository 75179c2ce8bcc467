//! The robot that moves: a unicycle that follows velocities (kinematic model, paper equation (1))
//! or accelerations (dynamic model, equation (2)), within its limits, after its delay, and with
//! slip.
//!
//! In: commands, each with the instant it was given. Out: the true pose and speeds at any later
//! instant, and what the wheels turned. Speeds are piecewise linear in time and integrated exactly;
//! the pose follows exact arcs where they are constant and RK4 where they are not (for a heading
//! that is known in closed form RK4 is Simpson's rule).

use std::collections::VecDeque;

use schemas::{Command, NS_PER_S, Plant as Limits, Pose, Start, Twist};

use crate::heading::sincos;

/// Longest step of the RK4 integration, seconds. At the limits of the robot one such step is wrong
/// by about 1e-12 m.
const LONGEST_STEP_S: f64 = 0.01;

/// What the wheels are told to do.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drive {
    /// Reach these velocities: at once, or as fast as the accelerations allow.
    Velocities(Twist),
    /// Hold these accelerations, m/s² and rad/s².
    Accelerations([f64; 2]),
}

/// The plant and its state.
#[derive(Clone, Debug)]
pub(crate) struct Plant {
    limits: Limits,
    /// Share of the wheels' motion that becomes the robot's.
    grip: f64,
    delay_ns: u64,
    now_ns: u64,
    pose: Pose,
    /// Speeds as the wheels turn; the robot's are `grip` times these.
    wheels: Twist,
    drive: Drive,
    /// Commands on their way: from when they take effect.
    pending: VecDeque<(u64, Drive)>,
    travelled_m: f64,
    turned_rad: f64,
}

impl Plant {
    pub(crate) fn new(limits: Limits, start: &Start) -> Plant {
        let grip = 1.0 - limits.slip;
        // The robot starts at the given speeds; wheels that slip turn faster.
        let wheels = if grip > 0.0 {
            Twist { v_mps: start.v_mps / grip, omega_radps: start.omega_radps / grip }
        } else {
            Twist::default()
        };
        Plant {
            limits,
            grip,
            delay_ns: schemas::Span::from_seconds(limits.actuator_delay_s).0,
            now_ns: 0,
            pose: start.pose,
            wheels,
            drive: Drive::Velocities(wheels),
            pending: VecDeque::new(),
            travelled_m: 0.0,
            turned_rad: 0.0,
        }
    }

    /// True pose in the world frame. The heading is not wrapped.
    pub(crate) fn pose(&self) -> Pose {
        self.pose
    }

    /// True speeds.
    pub(crate) fn twist(&self) -> Twist {
        Twist {
            v_mps: self.grip * self.wheels.v_mps,
            omega_radps: self.grip * self.wheels.omega_radps,
        }
    }

    /// Speeds as the wheels turn.
    pub(crate) fn wheel_twist(&self) -> Twist {
        self.wheels
    }

    /// What the wheels turned since the start: mean travel in metres, and the turn in radians that
    /// their difference stands for.
    pub(crate) fn wheel_travel(&self) -> (f64, f64) {
        (self.travelled_m, self.turned_rad)
    }

    /// Takes a command that was given now. It acts from the end of the delay until the next one
    /// does. A number in it that is not finite counts as zero.
    pub(crate) fn command(&mut self, command: &Command) {
        let finite = |number: f64| if number.is_finite() { number } else { 0.0 };
        let drive = match command.accel {
            None => Drive::Velocities(Twist {
                v_mps: clip(finite(command.twist.v_mps), self.limits.v_max_mps),
                omega_radps: clip(finite(command.twist.omega_radps), self.limits.omega_max_radps),
            }),
            Some([forward_mps2, turn_radps2]) => Drive::Accelerations([
                clip(finite(forward_mps2), self.limits.accel_max_mps2),
                clip(finite(turn_radps2), self.limits.alpha_max_radps2),
            ]),
        };
        if self.delay_ns == 0 {
            self.pending.clear();
        }
        self.pending.push_back((self.now_ns.saturating_add(self.delay_ns), drive));
    }

    /// Moves on to the instant `t_ns` after the start. Speeds that jump there have not yet jumped.
    pub(crate) fn advance_to(&mut self, t_ns: u64) {
        while let Some(&(from_ns, drive)) = self.pending.front() {
            if from_ns >= t_ns {
                break;
            }
            self.pending.pop_front();
            self.coast_to(from_ns);
            self.drive = drive;
            if let (Drive::Velocities(target), false) = (drive, self.limits.limits_acceleration) {
                self.wheels = target;
            }
        }
        self.coast_to(t_ns);
    }

    fn coast_to(&mut self, t_ns: u64) {
        if t_ns <= self.now_ns {
            return;
        }
        let mut left_s = (t_ns - self.now_ns) as f64 / NS_PER_S as f64;
        self.now_ns = t_ns;
        let (mut forward, mut turn) = self.ramps();
        // Each ramp ends at most once, so the speeds are linear on at most three stretches.
        while left_s > 0.0 {
            let mut stretch_s = left_s;
            for ramp in [&forward, &turn] {
                if ramp.rate != 0.0 && ramp.lasts_s < stretch_s {
                    stretch_s = ramp.lasts_s;
                }
            }
            self.move_for(stretch_s, forward.rate, turn.rate);
            forward.pass(stretch_s, &mut self.wheels.v_mps);
            turn.pass(stretch_s, &mut self.wheels.omega_radps);
            left_s -= stretch_s;
        }
    }

    fn ramps(&self) -> (Ramp, Ramp) {
        let limits = &self.limits;
        match self.drive {
            Drive::Velocities(target) => (
                Ramp::towards(self.wheels.v_mps, target.v_mps, limits.accel_max_mps2),
                Ramp::towards(self.wheels.omega_radps, target.omega_radps, limits.alpha_max_radps2),
            ),
            Drive::Accelerations([forward_mps2, turn_radps2]) => (
                Ramp::at(self.wheels.v_mps, forward_mps2, limits.v_max_mps),
                Ramp::at(self.wheels.omega_radps, turn_radps2, limits.omega_max_radps),
            ),
        }
    }

    /// Moves for a time with constant accelerations; updates pose and travel, not the speeds.
    fn move_for(&mut self, span_s: f64, forward_mps2: f64, turn_radps2: f64) {
        // Also where infinite accelerations make a ramp that takes no time.
        if span_s == 0.0 {
            return;
        }
        let (v, omega) = (self.wheels.v_mps, self.wheels.omega_radps);
        self.travelled_m += span_s * (v + 0.5 * forward_mps2 * span_s);
        self.turned_rad += span_s * (omega + 0.5 * turn_radps2 * span_s);
        self.pose = if forward_mps2 == 0.0 && turn_radps2 == 0.0 {
            arc(&self.pose, self.grip * v, self.grip * omega, span_s)
        } else {
            spiral(
                &self.pose,
                [self.grip * v, self.grip * omega],
                [self.grip * forward_mps2, self.grip * turn_radps2],
                span_s,
            )
        };
    }
}

/// How one speed changes: at a constant rate, to an end it reaches exactly.
#[derive(Clone, Copy, Debug)]
struct Ramp {
    rate: f64,
    lasts_s: f64,
    end: f64,
}

impl Ramp {
    fn towards(value: f64, target: f64, steepest: f64) -> Ramp {
        let rate = if target > value {
            steepest
        } else if target < value {
            -steepest
        } else {
            0.0
        };
        Ramp { rate, lasts_s: (target - value).abs() / steepest, end: target }
    }

    fn at(value: f64, rate: f64, limit: f64) -> Ramp {
        let end = if rate > 0.0 { limit } else { -limit };
        let room = (end - value) * rate;
        if room > 0.0 {
            Ramp { rate, lasts_s: (end - value) / rate, end }
        } else {
            Ramp { rate: 0.0, lasts_s: 0.0, end: value }
        }
    }

    fn pass(&mut self, span_s: f64, value: &mut f64) {
        if self.rate == 0.0 {
            return;
        }
        if span_s >= self.lasts_s {
            *value = self.end;
            *self = Ramp { rate: 0.0, lasts_s: 0.0, end: self.end };
        } else {
            *value += self.rate * span_s;
            self.lasts_s -= span_s;
        }
    }
}

fn clip(value: f64, limit: f64) -> f64 {
    if value > limit {
        limit
    } else if value < -limit {
        -limit
    } else {
        value
    }
}

/// sin x / x, by its series where the quotient would lose digits.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-3 {
        let square = x * x;
        1.0 - square / 6.0 + square * square / 120.0
    } else {
        libm::sin(x) / x
    }
}

/// The exact motion at constant speeds: the chord of the circle through both poses.
fn arc(pose: &Pose, v_mps: f64, omega_radps: f64, span_s: f64) -> Pose {
    let half_turn_rad = 0.5 * omega_radps * span_s;
    let chord_m = v_mps * span_s * sinc(half_turn_rad);
    let (sin, cos) = sincos(pose.theta_rad + half_turn_rad);
    Pose {
        x_m: pose.x_m + chord_m * cos,
        y_m: pose.y_m + chord_m * sin,
        theta_rad: pose.theta_rad + omega_radps * span_s,
    }
}

/// The motion at constant accelerations: exact in the heading, RK4 in the position.
fn spiral(pose: &Pose, speeds: [f64; 2], rates: [f64; 2], span_s: f64) -> Pose {
    let steps = libm::ceil(span_s / LONGEST_STEP_S);
    let step_s = span_s / steps;
    let heading = |t_s: f64| pose.theta_rad + t_s * (speeds[1] + 0.5 * rates[1] * t_s);
    let velocity = |t_s: f64| {
        let v_mps = speeds[0] + rates[0] * t_s;
        let (sin, cos) = sincos(heading(t_s));
        [v_mps * cos, v_mps * sin]
    };
    let mut position_m = pose.position_m();
    let mut before = velocity(0.0);
    let mut t_s = 0.0;
    for step in 1..=steps as u32 {
        let middle = velocity(t_s + 0.5 * step_s);
        t_s = f64::from(step) * step_s;
        let after = velocity(t_s);
        for axis in 0..2 {
            position_m[axis] += step_s / 6.0 * (before[axis] + 4.0 * middle[axis] + after[axis]);
        }
        before = after;
    }
    Pose { x_m: position_m[0], y_m: position_m[1], theta_rad: heading(span_s) }
}

#[cfg(test)]
mod tests;
