//! Where each sonar's cone is on the body.

use schemas::{SONARS, SonarMount};

/// Half the opening of a sonar's cone, degrees (specification, section 10: 20° cones).
pub(super) const HALF_CONE_DEG: f64 = 10.0;

/// How many points an echo becomes. Five over 20° stand 5° apart: 0.09 m at 1 m, 0.44 m at the end
/// of the reach, less than the body is wide.
pub(super) const ARC_POINTS: usize = 5;

/// One sonar's place and cone in the body frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    /// Face of the sonar, metres.
    pub(super) mount_m: [f64; 2],
    /// Bearing of the axis, radians.
    pub(super) bearing_rad: f64,
    /// Unit vectors over the cone, from −10° to +10° about the axis; the axis is the middle one.
    pub(super) arc: [[f64; 2]; ARC_POINTS],
}

impl Beam {
    /// The robot's sixteen, by id.
    pub(super) fn all() -> [Beam; SONARS.len()] {
        SONARS.map(|mount| Beam::of(&mount))
    }

    fn of(mount: &SonarMount) -> Beam {
        let step_deg = 2.0 * HALF_CONE_DEG / (ARC_POINTS - 1) as f64;
        Beam {
            mount_m: [mount.x_m, mount.y_m],
            bearing_rad: mount.bearing_deg.to_radians(),
            arc: std::array::from_fn(|i| {
                let off_axis_deg = step_deg * i as f64 - HALF_CONE_DEG;
                unit((mount.bearing_deg + off_axis_deg).to_radians())
            }),
        }
    }
}

/// The unit vector at an angle.
pub(super) fn unit(angle_rad: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle_rad);
    [cos, sin]
}

/// Turns vectors and moves points from the body frame into the world frame of a pose.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyToWorld {
    at_m: [f64; 2],
    e_forward: [f64; 2],
}

impl BodyToWorld {
    pub(super) fn new(pose: &schemas::Pose) -> BodyToWorld {
        BodyToWorld { at_m: pose.position_m(), e_forward: unit(pose.theta_rad) }
    }

    pub(super) fn vector(&self, [forward, left]: [f64; 2]) -> [f64; 2] {
        let [cos, sin] = self.e_forward;
        [forward * cos - left * sin, forward * sin + left * cos]
    }

    pub(super) fn point_m(&self, body_m: [f64; 2]) -> [f64; 2] {
        let [x_m, y_m] = self.vector(body_m);
        [self.at_m[0] + x_m, self.at_m[1] + y_m]
    }
}
