//! The safety layer: what may not be exceeded whatever the law or the person ask for.
//!
//! In: an input and what is free around the robot. Out: the same input, bit for bit, where it is
//! harmless; otherwise a lesser one (specification §9). It is not in the paper.

mod braking;
mod cone;
mod limits;

pub use braking::Braking;
pub use cone::Cone;
pub use limits::{Limits, clip, scale};

use crate::params::choice;

choice! {
    /// How the feedback input is brought within the plant's limits.
    Saturation {
        /// Both components alike, so that the curvature stays (S1).
        Scale = "scale",
        /// Each component on its own, as the plant would.
        Clip = "clip",
    }
}

choice! {
    /// Which safety layer has the last word.
    Projection {
        /// None.
        None = "none",
        /// Least free distance over a cone of headings about travel: S2 for the kinematic model, S3
        /// for the dynamic one.
        Cone = "cone",
    }
}

/// The safety layer of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shield {
    /// S2: the input is a velocity.
    Velocity(Cone),
    /// S3: the input is an acceleration.
    Acceleration(Braking),
}

impl Shield {
    /// `u`, bit for bit, where it is harmless at `heading_rad`; otherwise a lesser input. `ray_m`
    /// measures along world angles, NaN for the unknown, which counts as blocked.
    pub fn project(&self, u: [f64; 2], heading_rad: f64, ray_m: impl Fn(f64) -> f64) -> [f64; 2] {
        match self {
            Shield::Velocity(cone) => cone.project(u, heading_rad, ray_m),
            Shield::Acceleration(braking) => braking.project(u, heading_rad, ray_m),
        }
    }
}
