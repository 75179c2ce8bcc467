//! What the sensors and the person say: the inputs of a controller.

use crate::step::canonical;
use crate::{Pose, Time};

/// What one sonar heard after one firing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarEcho {
    /// Which sonar, 0–15, in the order of the robot's sonar table.
    pub id: u8,
    /// Distance from the sonar's face to what echoed, metres; meaningless when `echo` is false.
    pub range_m: f64,
    /// False when nothing came back within reach.
    pub echo: bool,
    /// When this sonar fired.
    pub fired: Time,
}

/// The readings that are new since the previous scan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SonarScan {
    /// Sample time.
    pub stamp: Time,
    /// Fresh readings only: sonars fire in turn, so a scan rarely holds all sixteen.
    pub echoes: Vec<SonarEcho>,
}

/// Specific force, turn rate and magnetic field in the body frame (x forward, y left, z up).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImuSample {
    /// Sample time.
    pub stamp: Time,
    /// Specific force, m/s²; at rest (0, 0, +9.81).
    pub accel_mps2: [f64; 3],
    /// Turn rate, rad/s.
    pub gyro_radps: [f64; 3],
    /// Magnetic field, microtesla.
    pub mag_ut: [f64; 3],
}

/// Travel and speed of the wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EncoderSample {
    /// Sample time.
    pub stamp: Time,
    /// Travel of the left wheels since the start of the session, metres.
    pub left_m: f64,
    /// Travel of the right wheels since the start of the session, metres.
    pub right_m: f64,
    /// Speed of the left wheels, m/s.
    pub left_mps: f64,
    /// Speed of the right wheels, m/s.
    pub right_mps: f64,
}

/// What the person asks for: requested velocities, whichever law is driving.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JoystickSample {
    /// Sample time.
    pub stamp: Time,
    /// Requested forward speed, m/s.
    pub v_mps: f64,
    /// Requested turn rate, rad/s.
    pub omega_radps: f64,
    /// Whether the dead-man button is held; a simulated person holds it.
    pub dead_man: bool,
}

/// The true pose and speeds, for the sensor suite of exact rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExactPose {
    /// Sample time.
    pub stamp: Time,
    /// True pose in the world frame.
    pub pose: Pose,
    /// True forward speed, m/s.
    pub v_mps: f64,
    /// True turn rate, rad/s.
    pub omega_radps: f64,
}

/// One message that a controller may read.
#[derive(Clone, Debug, PartialEq)]
pub enum Sample {
    /// `/sonar`
    Sonar(SonarScan),
    /// `/imu`
    Imu(ImuSample),
    /// `/encoders`
    Encoders(EncoderSample),
    /// `/joystick`
    Joystick(JoystickSample),
    /// `/exact`
    Exact(ExactPose),
}

impl Sample {
    /// The sample time carried in the payload. Ages are reckoned from it, not from the log time.
    pub fn stamp(&self) -> Time {
        match self {
            Sample::Sonar(s) => s.stamp,
            Sample::Imu(s) => s.stamp,
            Sample::Encoders(s) => s.stamp,
            Sample::Joystick(s) => s.stamp,
            Sample::Exact(s) => s.stamp,
        }
    }

    /// Makes the sample what a log will give back: one NaN for all, no negative zero.
    ///
    /// A controller must be shown this and not the original. A log does not keep the sign of a zero,
    /// but `atan2` goes by it: live and replayed runs would differ.
    pub fn make_canonical(&mut self) {
        fn all<const N: usize>(numbers: [&mut f64; N]) {
            for number in numbers {
                *number = canonical(*number);
            }
        }
        match self {
            Sample::Sonar(s) => s.echoes.iter_mut().for_each(|echo| all([&mut echo.range_m])),
            Sample::Imu(s) => {
                all(s.accel_mps2.each_mut());
                all(s.gyro_radps.each_mut());
                all(s.mag_ut.each_mut());
            }
            Sample::Encoders(s) => {
                all([&mut s.left_m, &mut s.right_m, &mut s.left_mps, &mut s.right_mps]);
            }
            Sample::Joystick(s) => all([&mut s.v_mps, &mut s.omega_radps]),
            Sample::Exact(s) => {
                all([&mut s.pose.x_m, &mut s.pose.y_m, &mut s.pose.theta_rad]);
                all([&mut s.v_mps, &mut s.omega_radps]);
            }
        }
    }
}
