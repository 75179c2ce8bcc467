//! Small pieces of Foxglove messages.

use foxglove::messages::{
    ArrowPrimitive, Color, CylinderPrimitive, LinePrimitive, Point3, Pose, Quaternion, Timestamp,
    TriangleListPrimitive, Vector3, line_primitive,
};

use crate::{NS_PER_S, Time};

/// Colours that people with any colour vision tell apart (palette of Okabe and Ito).
pub(super) mod colour {
    use super::Color;

    const fn rgb(r: u8, g: u8, b: u8, a: f64) -> Color {
        Color { r: r as f64 / 255.0, g: g as f64 / 255.0, b: b as f64 / 255.0, a }
    }

    /// The person drives.
    pub(crate) const HUMAN: Color = rgb(0, 114, 178, 1.0);
    /// The feedback law drives.
    pub(crate) const FEEDBACK: Color = rgb(213, 94, 0, 1.0);
    /// Nobody knows who drives.
    pub(crate) const UNKNOWN: Color = rgb(140, 140, 140, 1.0);
    /// Walls and obstacles.
    pub(crate) const SOLID: Color = rgb(90, 90, 90, 1.0);
    /// Moving discs.
    pub(crate) const PERSON: Color = rgb(204, 121, 167, 0.8);
    /// Target and displacement.
    pub(crate) const TARGET: Color = rgb(0, 158, 115, 1.0);
    /// Distances of the law.
    pub(crate) const DISTANCE: Color = rgb(230, 159, 0, 1.0);
    /// Sonar with an echo.
    pub(crate) const ECHO: Color = rgb(86, 180, 233, 1.0);
    /// Sonar without one.
    pub(crate) const SILENCE: Color = rgb(160, 160, 160, 1.0);

    /// The same colour, less of it.
    pub(crate) fn faded(colour: Color, share: f64) -> Color {
        Color { a: colour.a * share, ..colour }
    }
}

pub(super) fn timestamp(at: Time) -> Timestamp {
    let seconds = u32::try_from(at.0 / NS_PER_S).unwrap_or(u32::MAX);
    Timestamp::new(seconds, (at.0 % NS_PER_S) as u32)
}

pub(super) fn point([x, y]: [f64; 2], z: f64) -> Point3 {
    Point3 { x, y, z }
}

/// Turned about z by an angle in radians.
pub(super) fn rotation(yaw_rad: f64) -> Quaternion {
    let (z, w) = libm::sincos(0.5 * yaw_rad);
    Quaternion { x: 0.0, y: 0.0, z, w }
}

/// A pose in the plane, at a height in metres.
pub(super) fn pose(planar: &crate::Pose, z: f64) -> Pose {
    Pose {
        position: Some(Vector3 { x: planar.x_m, y: planar.y_m, z }),
        orientation: Some(rotation(planar.theta_rad)),
    }
}

/// The pose that changes nothing.
pub(super) fn identity() -> Pose {
    pose(&crate::Pose::default(), 0.0)
}

/// Lines of constant thickness in metres.
pub(super) fn lines(
    kind: line_primitive::Type,
    points: Vec<Point3>,
    thickness: f64,
    color: Color,
) -> LinePrimitive {
    LinePrimitive {
        r#type: kind as i32,
        pose: Some(identity()),
        thickness,
        points,
        color: Some(color),
        ..LinePrimitive::default()
    }
}

/// A convex polygon, filled.
pub(super) fn polygon(corners_m: &[[f64; 2]], z: f64, color: Color) -> TriangleListPrimitive {
    let fan = corners_m.windows(2).skip(1).flat_map(|pair| [corners_m[0], pair[0], pair[1]]);
    TriangleListPrimitive {
        pose: Some(identity()),
        points: fan.map(|corner| point(corner, z)).collect(),
        color: Some(color),
        ..TriangleListPrimitive::default()
    }
}

/// An upright cylinder that stands on the floor.
pub(super) fn cylinder(
    [x, y]: [f64; 2],
    radius_m: f64,
    height_m: f64,
    color: Color,
) -> CylinderPrimitive {
    let pose = crate::Pose { x_m: x, y_m: y, theta_rad: 0.0 };
    CylinderPrimitive {
        pose: Some(self::pose(&pose, 0.5 * height_m)),
        size: Some(Vector3 { x: 2.0 * radius_m, y: 2.0 * radius_m, z: height_m }),
        bottom_scale: 1.0,
        top_scale: 1.0,
        color: Some(color),
    }
}

/// An arrow that starts at a pose and points along its heading.
pub(super) fn arrow(from: &crate::Pose, z: f64, length_m: f64, color: Color) -> ArrowPrimitive {
    ArrowPrimitive {
        pose: Some(pose(from, z)),
        shaft_length: 0.7 * length_m,
        shaft_diameter: 0.04,
        head_length: 0.3 * length_m,
        head_diameter: 0.1,
        color: Some(color),
    }
}
