//! What the robot believes about its own motion.
//!
//! In: IMU and encoder samples, in the order in which they arrive, with whatever gaps, repeats and
//! nonsense a real stream has. Out: pose and speeds now ([`Estimate`]), the pose at any recent
//! instant, which is what perception needs to put an echo where it was heard, and how far all that
//! is to be trusted ([`Report`]).
//!
//! [`Odometry`] takes the samples in; an extended Kalman filter over encoders and gyro makes the
//! pose of them, a Madgwick filter the attitude.

mod ekf;
mod gate;
mod health;
mod madgwick;
mod odometry;
mod trail;
mod wheels;

pub use madgwick::Madgwick;
pub use odometry::{Estimate, Odometry, Report};
