//! The safety layer: what may not be exceeded whatever the law or the person ask for.
//!
//! In: an input and what is free around the robot. Out: the same input, bit for bit, where it is
//! harmless; otherwise a lesser one (specification §9). It is not in the paper.

mod cone;
mod limits;

pub use cone::{Cone, project};
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
        /// Least free distance over a cone of headings about travel (S2).
        Cone = "cone",
    }
}
