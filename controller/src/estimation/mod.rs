//! What the robot believes about its own motion.
//!
//! In: IMU and encoder samples, in the order in which they arrive, with whatever gaps, repeats and
//! nonsense a real stream has. Out: pose and speeds now ([`Estimate`]), and the pose at any recent
//! instant, which is what perception needs to put an echo where it was heard.
//!
//! [`Odometry`] takes the heading from the gyro and the travel from the wheels.

mod gyro_bias;
mod odometry;
mod trail;

pub use odometry::{Estimate, Odometry};
