//! The target that the joystick implies: nothing fitted, nothing assumed about goals.
//!
//! What a person asks for points somewhere: to the end of the joystick's arc some time ahead. A
//! robot that is elsewhere gets there on another arc.

use schemas::{Pose, wrap};

use super::anchored::Model;
use crate::recording::State;

/// How far ahead the joystick's arc is followed, seconds.
const AHEAD_S: f64 = 2.5;

/// How much faster than recorded a person drives to catch up.
const HURRY: f64 = 1.3;

/// Below this length an arc points nowhere, metres.
const SHORTEST_M: f64 = 1e-3;

/// Steers for the end of the recorded joystick's arc.
pub(crate) struct Target;

impl Model for Target {
    fn ask(&mut self, _: usize, now: &State, then: &State, asked: [f64; 2]) -> [f64; 2] {
        let [v_mps, omega_radps] = asked;
        let length_m = v_mps.abs() * AHEAD_S;
        if length_m.is_nan() || length_m < SHORTEST_M {
            return asked;
        }
        let way = way(&then.pose, v_mps, omega_radps);
        let Some(new) = arc_to(&now.pose, way, v_mps < 0.0) else { return asked };
        let recorded_rad = 0.5 * omega_radps * AHEAD_S;
        let turned_off_rad = (new.bearing_rad.abs() - recorded_rad.abs()).max(0.0);
        let facing = libm::cos(turned_off_rad).max(0.0);
        let speed_mps = (new.length_m / AHEAD_S).min(HURRY * v_mps.abs()) * facing;
        let turn_radps = 2.0 * wrap(new.bearing_rad - recorded_rad) / AHEAD_S;
        [if v_mps < 0.0 { -speed_mps } else { speed_mps }, omega_radps + turn_radps]
    }
}

/// The end of the arc that starts at `pose` with these speeds, metres.
fn way(pose: &Pose, v_mps: f64, omega_radps: f64) -> [f64; 2] {
    let half_rad = 0.5 * omega_radps * AHEAD_S;
    let sinc = if half_rad.abs() < 1e-6 { 1.0 } else { libm::sin(half_rad) / half_rad };
    let chord_m = v_mps * AHEAD_S * sinc;
    let (sin, cos) = libm::sincos(pose.theta_rad + half_rad);
    [pose.x_m + chord_m * cos, pose.y_m + chord_m * sin]
}

struct Arc {
    /// Of the chord, from where the robot points; from its tail when backing up.
    bearing_rad: f64,
    length_m: f64,
}

/// The arc from a pose to a point, forwards or backwards.
fn arc_to(pose: &Pose, at_m: [f64; 2], backwards: bool) -> Option<Arc> {
    let way_m = [at_m[0] - pose.x_m, at_m[1] - pose.y_m];
    let chord_m = libm::hypot(way_m[0], way_m[1]);
    if chord_m.is_nan() || chord_m < SHORTEST_M {
        return None;
    }
    let ahead_rad = libm::atan2(way_m[1], way_m[0]) - pose.theta_rad;
    let bearing_rad = wrap(if backwards { ahead_rad + core::f64::consts::PI } else { ahead_rad });
    let sin = libm::sin(bearing_rad);
    let ratio = if bearing_rad.abs() < 1e-6 { 1.0 } else { bearing_rad / sin };
    // Facing away the circle through the point is as large as one likes.
    let length_m = chord_m * ratio.min(3.0);
    Some(Arc { bearing_rad, length_m })
}
