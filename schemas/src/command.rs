//! What goes to the actuators.

use crate::{Time, Twist};

/// One command: velocities always, with accelerations beside them where the law commands those.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// When it was given.
    pub stamp: Time,
    /// Commanded velocities; for a dynamic law, those reached at the end of the control period.
    pub twist: Twist,
    /// `Some([m/s², rad/s²])` when the plant is to follow accelerations until the next command
    /// (dynamic law, mass = inertia = 1, paper assumption 3).
    pub accel: Option<[f64; 2]>,
}
