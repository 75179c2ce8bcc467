//! D: the distance to the edge of the admissible set along the direction of travel, which the sets
//! (12) are about (specification §5).
//!
//! In: where the robot looks and what is asked of it, and a way to measure along a ray. Out: D,
//! NaN if any ray that counts is unknown.

use std::f64::consts::PI;

use schemas::Pose;

use crate::params::choice;
use crate::target::{UNDERFOOT_M, direction_rad};

choice! {
    /// Along which directions D is measured.
    DMode {
        /// Along the heading; opposite to it in reverse. Jumps when the heading sweeps past a
        /// corner.
        Heading = "heading",
        /// Towards where the person wants to be in a while; along travel when that is underfoot.
        Intent = "intent",
        /// The lesser of both: for driving with a task.
        Both = "both",
        /// The least along the headings that the requested turn sweeps: for a joystick.
        Sweep = "sweep",
    }
}

choice! {
    /// Whose free travel D is.
    DBody {
        /// That of the disc about the body, which is clear at every heading.
        Disc = "disc",
        /// That of the footprint, turned into the direction of travel.
        Footprint = "footprint",
    }
}

choice! {
    /// Whose free travel the law's distances d1 and d2 are.
    LawBody {
        /// That of the disc about the body.
        Disc = "disc",
        /// That of a lane as wide as the footprint, until something is as near ahead as the edge of that disc:
        /// the body keeps room to turn before a face, and passes beside what is not in its way.
        Lane = "lane",
    }
}

/// Rays of a sweep (specification §5).
const SWEEP_RAYS: u32 = 9;

/// The request whose way is to be measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel {
    /// Where the robot is.
    pub pose: Pose,
    /// Requested speed, m/s: its sign says which way.
    pub v_mps: f64,
    /// Requested turn rate, rad/s.
    pub omega_radps: f64,
    /// Where the person wants to be in a while, metres.
    pub intent_m: [f64; 2],
    /// How long the requested turn is swept, seconds.
    pub sweep_s: f64,
}

/// World angle of the direction in which a robot with heading `heading_rad` moves at `v_mps`;
/// forward at rest.
pub fn direction_of_travel_rad(heading_rad: f64, v_mps: f64) -> f64 {
    if v_mps < 0.0 { heading_rad + PI } else { heading_rad }
}

/// The lesser of two distances; NaN if either is unknown.
pub(crate) fn lesser(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.min(b) }
}

impl Travel {
    /// D, measured by `ray_m` along world angles.
    pub fn distance_m(&self, mode: DMode, ray_m: impl Fn(f64) -> f64) -> f64 {
        let along_rad = direction_of_travel_rad(self.pose.theta_rad, self.v_mps);
        let intent_rad = || {
            let [x, y] = self.intent_m;
            direction_rad([x - self.pose.x_m, y - self.pose.y_m], UNDERFOOT_M)
        };
        match mode {
            DMode::Heading => ray_m(along_rad),
            DMode::Intent => ray_m(intent_rad().unwrap_or(along_rad)),
            DMode::Both => {
                let along_m = ray_m(along_rad);
                intent_rad().map_or(along_m, |angle_rad| lesser(along_m, ray_m(angle_rad)))
            }
            DMode::Sweep => {
                let turn_rad = self.omega_radps * self.sweep_s;
                if turn_rad == 0.0 {
                    // All rays are one.
                    return ray_m(along_rad + turn_rad);
                }
                (0..SWEEP_RAYS)
                    .map(|i| along_rad + turn_rad * f64::from(i) / f64::from(SWEEP_RAYS - 1))
                    .map(ray_m)
                    .fold(f64::INFINITY, lesser)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::law::arctangent::wrap;

    fn travel(v_mps: f64, omega_radps: f64, intent_m: [f64; 2]) -> Travel {
        let pose = Pose { x_m: 0.0, y_m: 0.0, theta_rad: 0.0 };
        Travel { pose, v_mps, omega_radps, intent_m, sweep_s: 0.3 }
    }

    /// 1 m ahead, 2 m to the left, 3 m behind, 4 m to the right.
    fn around(angle_rad: f64) -> f64 {
        match libm::round(wrap(angle_rad) / FRAC_PI_2) as i64 {
            0 => 1.0,
            1 => 2.0,
            -1 => 4.0,
            _ => 3.0,
        }
    }

    #[test]
    fn the_heading_is_the_way_one_goes() {
        let along = |v: f64| travel(v, 0.0, [0.0; 2]).distance_m(DMode::Heading, around);
        assert_eq!([along(0.3), along(0.0), along(-0.3)], [1.0, 1.0, 3.0]);
    }

    #[test]
    fn intent_and_both_look_where_one_wants_to_be() {
        let to = |intent_m: [f64; 2], mode| travel(0.3, 0.0, intent_m).distance_m(mode, around);
        assert_eq!(to([0.0, 1.0], DMode::Intent), 2.0);
        assert_eq!(to([0.0, 1.0], DMode::Both), 1.0, "the lesser of both");
        let back = travel(-0.3, 0.0, [0.0, 1.0]).distance_m(DMode::Both, around);
        assert_eq!(back, 2.0);
        // Underfoot it is left out.
        assert_eq!(to([0.0, 9e-4], DMode::Intent), 1.0);
        assert_eq!(to([0.0, 9e-4], DMode::Both), 1.0);
    }

    /// Nine rays, evenly from the heading to where 0.3 s of the turn end, inclusive.
    #[test]
    fn the_sweep_covers_the_turn() {
        let turn = travel(0.3, 2.0, [0.0; 2]);
        let asked = std::cell::RefCell::new(Vec::new());
        let least = turn.distance_m(DMode::Sweep, |angle_rad| {
            asked.borrow_mut().push(angle_rad);
            5.0 - angle_rad
        });
        let asked = asked.into_inner();
        assert_eq!(asked.len(), 9);
        assert_eq!(asked[0], 0.0);
        assert!((asked[8] - 0.6).abs() < 1e-12 && (asked[1] - 0.075).abs() < 1e-12);
        assert!((least - 4.4).abs() < 1e-12);
    }

    /// Straight on all nine are one, and it is asked once.
    #[test]
    fn no_turn_is_swept_by_one_ray() {
        for (v_mps, omega_radps, along_rad) in [(0.3, 0.0, 0.0), (0.3, -0.0, 0.0), (-0.3, 0.0, PI)]
        {
            let asked = std::cell::RefCell::new(Vec::new());
            let d_m = travel(v_mps, omega_radps, [0.0; 2]).distance_m(DMode::Sweep, |angle_rad| {
                asked.borrow_mut().push(angle_rad);
                2.0
            });
            assert_eq!((d_m, asked.into_inner()), (2.0, vec![along_rad]));
        }
    }

    /// One unknown direction among those that count makes D unknown.
    #[test]
    fn the_unknown_is_not_passed_over() {
        let blind_left = |angle_rad: f64| if angle_rad > 0.5 { f64::NAN } else { 1.0 };
        let turn = travel(0.3, 2.0, [0.0, 1.0]);
        assert_eq!(turn.distance_m(DMode::Heading, blind_left), 1.0);
        for mode in [DMode::Intent, DMode::Both, DMode::Sweep] {
            assert!(turn.distance_m(mode, blind_left).is_nan(), "{mode:?}");
        }
    }
}
