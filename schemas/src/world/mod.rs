//! The world a robot moves in: a convex room, convex obstacles and moving discs.
//!
//! Four questions can be asked of it: how far along a ray ([`World::ray_m`]), how far a footprint may
//! travel ([`World::travel_m`]), how near to a footprint ([`World::clearance_m`]), and which way the
//! nearest face looks ([`World::nearest_face`]). None of them allocates. Distances are signed: negative
//! means beyond a face of the room or inside what stands in it.

mod check;
mod clearance;
mod discs;
mod face;
mod polygon;
mod ray;
mod travel;

pub use clearance::Body;
pub use face::NearestFace;

use serde::{Deserialize, Serialize};

/// A half-plane of allowed points p: `normal · p <= offset_m`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalfPlane {
    /// Unit vector out of the allowed side.
    pub normal: [f64; 2],
    /// Distance of the edge from the origin along the normal, metres.
    pub offset_m: f64,
}

impl HalfPlane {
    /// Distance, metres, from a point to the edge; negative beyond it.
    pub fn distance_m(&self, point_m: [f64; 2]) -> f64 {
        self.offset_m - dot(self.normal, point_m)
    }
}

/// A convex polygon of forbidden points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// Corners in metres, counter-clockwise, at least three.
    pub corners_m: Vec<[f64; 2]>,
}

/// A disc (a walking person) that moves on a straight line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MovingDisc {
    /// Radius, metres.
    pub radius_m: f64,
    /// Where its centre starts, metres.
    pub from_m: [f64; 2],
    /// Where it walks to, metres.
    pub to_m: [f64; 2],
    /// How fast, m/s.
    pub speed_mps: f64,
    /// When it sets off, seconds from the start of the session.
    #[serde(default)]
    pub start_s: f64,
    /// Whether it walks back and forth for ever, or stops at the end.
    #[serde(default)]
    pub to_and_fro: bool,
}

/// A disc that moves as somebody was seen to move. Before and after it is not there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WalkedPath {
    /// Radius, metres.
    pub radius_m: f64,
    /// Time in seconds from the start of the session, and place in metres: `[t_s, x_m, y_m]`, in the
    /// order of time. Between two of them the disc moves straight on.
    pub points: Vec<[f64; 3]>,
}

/// A room with things in it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct World {
    /// The room: the intersection of these half-planes; it may be open.
    #[serde(default)]
    pub room: Vec<HalfPlane>,
    /// What stands in it.
    #[serde(default)]
    pub obstacles: Vec<Obstacle>,
    /// What walks in it.
    #[serde(default)]
    pub discs: Vec<MovingDisc>,
    /// What was seen to walk in it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub paths: Vec<WalkedPath>,
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// The smaller of two distances. Unlike `f64::min` its result does not depend on the machine where
/// the two are zeros of different sign; a NaN on the right is dropped.
fn smaller(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}
