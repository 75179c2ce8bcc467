//! The safety layer: what may not be exceeded whatever the law or the person ask for.
//!
//! In: an input and what is free around the robot. Out: the same input, bit for bit, where it is
//! harmless; otherwise a lesser one (specification §9). It is not in the paper.

mod braking;
mod cone;
mod limits;
mod motion;
mod near;
mod sweep;

pub use braking::Braking;
pub use cone::Cone;
pub use limits::{Limits, clip, scale, scale_velocities};
pub use motion::{Drive, Moving, arc};
pub use near::{Keep, Near};
pub use sweep::Sweep;

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
        /// The footprint swept along the motion of the coming period and of braking after it.
        Rectangle = "rectangle",
        /// The same, and the turning circle stays clear of what it is clear of.
        Circle = "circle",
        /// The cone while nothing is within the turning circle, and then the swept footprint.
        Both = "both",
    }
}

/// The safety layer of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shield {
    /// S2: the input is a velocity.
    Velocity(Cone),
    /// S3: the input is an acceleration.
    Acceleration(Braking),
    /// S2 and S3 with the body swept.
    Swept(Sweep),
    /// S2, where nothing is within the turning circle, and then the body swept.
    VelocitySwept(Cone, Sweep),
    /// The same with S3.
    AccelerationSwept(Braking, Sweep),
}

impl Shield {
    /// `u`, bit for bit, where it is harmless at `heading_rad`; otherwise a lesser input. `ray_m`
    /// measures along world angles, NaN for the unknown, which counts as blocked; a swept body looks
    /// at `near` instead.
    pub fn project(
        &self,
        u: [f64; 2],
        heading_rad: f64,
        ray_m: impl Fn(f64) -> f64,
        near: &Near,
    ) -> [f64; 2] {
        match self {
            Shield::Velocity(cone) => cone.project(u, heading_rad, ray_m),
            Shield::Acceleration(braking) => braking.project(u, heading_rad, ray_m),
            Shield::Swept(sweep) => sweep.project(u, near),
            Shield::VelocitySwept(_, sweep) | Shield::AccelerationSwept(_, sweep)
                if near.crowded() =>
            {
                sweep.project(u, near)
            }
            Shield::VelocitySwept(cone, sweep) => {
                sweep.project(cone.project(u, heading_rad, ray_m), near)
            }
            Shield::AccelerationSwept(braking, sweep) => {
                sweep.project(braking.project(u, heading_rad, ray_m), near)
            }
        }
    }

    /// Whether rays certainly leave `u` as it is if none of them is shorter than `least_m` says: longer ones
    /// never take more away.
    pub fn passes_rays(
        &self,
        u: [f64; 2],
        heading_rad: f64,
        least_m: impl FnOnce() -> f64,
    ) -> bool {
        let passes = |left: &dyn Fn(f64) -> [f64; 2]| {
            let least_m = least_m();
            // What is no number has no direction, which counts as unknown.
            least_m > 0.0 && u.iter().all(|component| component.is_finite()) && left(least_m) == u
        };
        match self {
            // It asks none.
            Shield::Swept(_) => true,
            Shield::Velocity(cone) | Shield::VelocitySwept(cone, _) => {
                passes(&|least_m| cone.project(u, heading_rad, |_| least_m))
            }
            Shield::Acceleration(braking) | Shield::AccelerationSwept(braking, _) => {
                passes(&|least_m| braking.project(u, heading_rad, |_| least_m))
            }
        }
    }

    /// The same, but where the body is swept it turns no faster than `most_radps`.
    #[must_use]
    pub fn turning_at_most(mut self, most_radps: f64) -> Shield {
        match &mut self {
            Shield::Velocity(_) | Shield::Acceleration(_) => {}
            Shield::Swept(sweep)
            | Shield::VelocitySwept(_, sweep)
            | Shield::AccelerationSwept(_, sweep) => sweep.turn_most_radps = most_radps,
        }
        self
    }

    /// The part that sweeps the body, if any.
    pub fn sweep(&self) -> Option<&Sweep> {
        match self {
            Shield::Velocity(_) | Shield::Acceleration(_) => None,
            Shield::Swept(sweep)
            | Shield::VelocitySwept(_, sweep)
            | Shield::AccelerationSwept(_, sweep) => Some(sweep),
        }
    }

    /// Whether [`Shield::project`] leaves `u` as it is.
    pub fn allows(
        &self,
        u: [f64; 2],
        heading_rad: f64,
        ray_m: impl Fn(f64) -> f64,
        near: &Near,
    ) -> bool {
        match self {
            Shield::Swept(sweep) => sweep.allows(u, near),
            _ => self.project(u, heading_rad, ray_m, near) == u,
        }
    }
}
