//! What really happened, known in simulation only.

use crate::{Pose, Time};

/// Where a moving disc (a person, say) is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Centre, metres.
    pub centre_m: [f64; 2],
    /// Radius, metres.
    pub radius_m: f64,
}

/// The state of the world and the robot. No controller ever reads it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// Sample time.
    pub stamp: Time,
    /// True pose in the world frame.
    pub pose: Pose,
    /// True forward speed, m/s.
    pub v_mps: f64,
    /// True turn rate, rad/s.
    pub omega_radps: f64,
    /// Signed distance from the footprint to the nearest thing, metres; negative in contact.
    pub clearance_m: f64,
    /// The same without the moving discs: negative outside the static admissible set.
    pub clearance_static_m: f64,
    /// The moving discs.
    pub discs: Vec<Disc>,
}
