//! Signed distance between a footprint and the world.

use super::{HalfPlane, Obstacle, World, dot, minus, polygon, smaller};
use crate::{Disc, Footprint, Pose};

/// Bounds on distances are compared with this slack, metres, far above rounding: nothing is left out that
/// might be the nearest.
const HAIR_M: f64 = 1e-6;

impl World {
    /// Signed distance, metres, from a footprint to everything, `t_s` seconds after the start of
    /// the session; negative in contact, +∞ in an empty world, NaN at a pose that is not finite.
    ///
    /// Apart it is the exact distance; overlapping it is minus the penetration depth: the shortest
    /// shift along a separating axis that undoes the contact.
    pub fn clearance_m(&self, footprint: &Footprint, pose: &Pose, t_s: f64) -> f64 {
        let body = Body::new(footprint, pose);
        self.to_discs_m(&body, self.to_static_m(&body), t_s)
    }

    /// The same to what does not move: negative outside the static admissible set.
    pub fn clearance_static_m(&self, footprint: &Footprint, pose: &Pose) -> f64 {
        self.to_static_m(&Body::new(footprint, pose))
    }

    /// [`World::clearance_m`] and [`World::clearance_static_m`] together, at the price of one.
    pub fn clearances_m(&self, footprint: &Footprint, pose: &Pose, t_s: f64) -> (f64, f64) {
        let body = Body::new(footprint, pose);
        let static_m = self.to_static_m(&body);
        (self.to_discs_m(&body, static_m, t_s), static_m)
    }

    fn to_static_m(&self, body: &Body) -> f64 {
        if !body.is_finite() {
            return f64::NAN;
        }
        let mut least_m = f64::INFINITY;
        for wall in &self.room {
            least_m = smaller(least_m, body.to_wall_m(wall));
        }
        for obstacle in &self.obstacles {
            // What is farther than the nearest thing so far, told without its outline, is left out.
            if body.at_least_m(obstacle) <= least_m + HAIR_M {
                least_m = smaller(least_m, body.to_obstacle_m(obstacle));
            }
        }
        least_m
    }

    fn to_discs_m(&self, body: &Body, static_m: f64, t_s: f64) -> f64 {
        let mut least_m = static_m;
        for disc in self.discs_at(t_s) {
            least_m = smaller(least_m, body.to_disc_m(&disc));
        }
        least_m
    }
}

/// A footprint put down at a pose: what its signed distances to single things are asked of.
///
/// Every distance is exact apart, and minus the penetration depth in contact, as in
/// [`World::clearance_m`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    centre_m: [f64; 2],
    forward: [f64; 2],
    left: [f64; 2],
    half_length_m: f64,
    half_width_m: f64,
    corners_m: [[f64; 2]; 4],
}

impl Body {
    /// `footprint` at `pose`.
    pub fn new(footprint: &Footprint, pose: &Pose) -> Body {
        let (sin, cos) = libm::sincos(pose.theta_rad);
        let half_length_m = 0.5 * footprint.length_m;
        let half_width_m = 0.5 * footprint.width_m;
        let corner = |ahead_m: f64, aside_m: f64| {
            [pose.x_m + ahead_m * cos - aside_m * sin, pose.y_m + ahead_m * sin + aside_m * cos]
        };
        Body {
            centre_m: pose.position_m(),
            forward: [cos, sin],
            left: [-sin, cos],
            half_length_m,
            half_width_m,
            corners_m: [
                corner(half_length_m, half_width_m),
                corner(-half_length_m, half_width_m),
                corner(-half_length_m, -half_width_m),
                corner(half_length_m, -half_width_m),
            ],
        }
    }

    /// Unit vector along its heading.
    pub fn forward(&self) -> [f64; 2] {
        self.forward
    }

    fn is_finite(&self) -> bool {
        self.corners_m.iter().all(|corner_m| corner_m[0].is_finite() && corner_m[1].is_finite())
    }

    fn is_point(&self) -> bool {
        self.half_length_m <= 0.0 && self.half_width_m <= 0.0
    }

    /// How far the body reaches from its centre along a unit vector, metres.
    fn reach_m(&self, direction: [f64; 2]) -> f64 {
        self.half_length_m * dot(self.forward, direction).abs()
            + self.half_width_m * dot(self.left, direction).abs()
    }

    /// Signed distance, metres, to the edge of a half-plane.
    pub fn to_wall_m(&self, wall: &HalfPlane) -> f64 {
        wall.distance_m(self.centre_m) - self.reach_m(wall.normal)
    }

    /// Signed distance, metres, to a convex polygon.
    pub fn to_obstacle_m(&self, obstacle: &Obstacle) -> f64 {
        if self.is_point() {
            return obstacle.distance_m(self.centre_m);
        }
        let widest_m = self.separation_m(obstacle);
        if widest_m <= 0.0 {
            return widest_m;
        }
        // Apart: two convex polygons are nearest at a corner of one of them.
        let mut least = f64::INFINITY;
        for edge in obstacle.edges() {
            for corner_m in self.corners_m {
                least = smaller(least, edge.distance_squared(corner_m));
            }
        }
        for edge in polygon::edges(&self.corners_m) {
            for &corner_m in &obstacle.corners_m {
                least = smaller(least, edge.distance_squared(corner_m));
            }
        }
        libm::sqrt(least)
    }

    /// What the distance to a convex polygon surely is, metres: the gap between the box about its
    /// corners and the square about the turning body.
    fn at_least_m(&self, obstacle: &Obstacle) -> f64 {
        let reach_m = self.half_length_m + self.half_width_m;
        let mut least_m = f64::NEG_INFINITY;
        for axis in 0..2 {
            let (mut low_m, mut high_m) = (f64::INFINITY, f64::NEG_INFINITY);
            for corner_m in &obstacle.corners_m {
                low_m = smaller(low_m, corner_m[axis]);
                high_m = if corner_m[axis] > high_m { corner_m[axis] } else { high_m };
            }
            for gap_m in [low_m - self.centre_m[axis], self.centre_m[axis] - high_m] {
                least_m = if gap_m > least_m { gap_m } else { least_m };
            }
        }
        least_m - reach_m
    }

    /// The widest gap along the axes of body and obstacle, metres; negative when they overlap.
    fn separation_m(&self, obstacle: &Obstacle) -> f64 {
        let mut widest_m = f64::NEG_INFINITY;
        for edge in obstacle.edges() {
            let Some(normal) = edge.normal() else { continue };
            let gap_m = dot(normal, minus(self.centre_m, edge.from_m)) - self.reach_m(normal);
            if gap_m > widest_m {
                widest_m = gap_m;
            }
        }
        for (axis, half_m) in [(self.forward, self.half_length_m), (self.left, self.half_width_m)] {
            let mut low_m = f64::INFINITY;
            let mut high_m = f64::NEG_INFINITY;
            for &corner_m in &obstacle.corners_m {
                let along_m = dot(axis, minus(corner_m, self.centre_m));
                low_m = smaller(low_m, along_m);
                if along_m > high_m {
                    high_m = along_m;
                }
            }
            for gap_m in [low_m - half_m, -half_m - high_m] {
                if gap_m > widest_m {
                    widest_m = gap_m;
                }
            }
        }
        widest_m
    }

    /// Signed distance, metres, to a disc.
    pub fn to_disc_m(&self, disc: &Disc) -> f64 {
        let offset_m = minus(disc.centre_m, self.centre_m);
        let beyond_m = [
            dot(self.forward, offset_m).abs() - self.half_length_m,
            dot(self.left, offset_m).abs() - self.half_width_m,
        ];
        let outside_m = beyond_m.map(|gap_m| if gap_m > 0.0 { gap_m } else { 0.0 });
        let to_centre_m = if beyond_m[0] > 0.0 || beyond_m[1] > 0.0 {
            match outside_m {
                // Before a side, as most things are, it is one of them, as a root would say.
                [0.0, gap_m] | [gap_m, 0.0] => gap_m,
                [ahead_m, aside_m] => libm::hypot(ahead_m, aside_m),
            }
        } else if beyond_m[0] > beyond_m[1] {
            beyond_m[0]
        } else {
            beyond_m[1]
        };
        to_centre_m - disc.radius_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MovingDisc;
    use std::f64::consts::FRAC_PI_4;

    const SQUARE: Footprint = Footprint { length_m: 0.5, width_m: 0.5 };

    fn at(x_m: f64, y_m: f64, theta_rad: f64) -> Pose {
        Pose { x_m, y_m, theta_rad }
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    fn table() -> World {
        World {
            room: vec![HalfPlane { normal: [1.0, 0.0], offset_m: 4.0 }],
            obstacles: vec![Obstacle {
                corners_m: vec![[1.0, -1.0], [3.0, -1.0], [3.0, 1.0], [1.0, 1.0]],
            }],
            discs: Vec::new(),
            paths: Vec::new(),
        }
    }

    /// Hand-computed for a square body of half a metre beside the table [1, 3] × [-1, 1].
    #[test]
    fn square_beside_a_table() {
        let world = table();
        let clearance = |x, y, theta| world.clearance_static_m(&SQUARE, &at(x, y, theta));
        assert!(close(clearance(0.0, 0.0, 0.0), 0.75));
        // Turned by 45° a corner of the body, √2/4 from its centre, looks at the table.
        assert!(close(clearance(0.0, 0.0, FRAC_PI_4), 1.0 - 0.25 * libm::sqrt(2.0)));
        // Corner to corner: (0.75, 1.25) to (1, 1) after the half extents, by 3-4-5 scaled.
        assert!(close(clearance(0.45, 1.65, 0.0), 0.5));
        // Overlapping by 0.1 m.
        assert!(close(clearance(0.85, 0.0, 0.0), -0.1));
        // In the middle of the table the way out is 1 m to a face and 0.25 m for the body.
        assert!(close(clearance(2.0, 0.0, 0.0), -1.25));
        // The wall at x = 4, from both sides.
        assert!(close(clearance(3.65, 1.9, 0.0), 0.1));
        assert!(close(clearance(4.0, 5.0, 0.0), -0.25));
    }

    /// A point robot has the signed distance of its reference point, at every heading.
    #[test]
    fn point_robot() {
        let world = table();
        for theta_rad in [0.0, 0.3, 2.0] {
            let clearance =
                |x, y| world.clearance_static_m(&Footprint::POINT, &at(x, y, theta_rad));
            assert!(close(clearance(0.0, 0.0), 1.0));
            assert!(close(clearance(0.7, 1.4), 0.5));
            assert!(close(clearance(1.2, 0.0), -0.2));
        }
    }

    /// Discs count for the full clearance only, outside and inside the body.
    #[test]
    fn moving_disc() {
        let mut world = World::default();
        world.discs.push(MovingDisc {
            radius_m: 0.1,
            from_m: [1.0, 0.0],
            to_m: [0.0, 0.0],
            speed_mps: 0.1,
            start_s: 0.0,
            to_and_fro: false,
        });
        let home = at(0.0, 0.0, 0.0);
        assert!(close(world.clearance_m(&SQUARE, &home, 0.0), 0.65));
        assert!(close(world.clearance_m(&SQUARE, &home, 5.0), 0.15));
        assert!(close(world.clearance_m(&SQUARE, &home, 8.0), -0.15));
        assert!(close(world.clearance_m(&SQUARE, &home, 20.0), -0.35));
        assert_eq!(world.clearance_static_m(&SQUARE, &home), f64::INFINITY);
        assert_eq!(
            world.clearances_m(&SQUARE, &home, 5.0),
            (world.clearance_m(&SQUARE, &home, 5.0), f64::INFINITY)
        );
    }

    #[test]
    fn not_finite_is_nan() {
        let world = table();
        assert!(world.clearance_m(&SQUARE, &at(f64::NAN, 0.0, 0.0), 0.0).is_nan());
        assert!(world.clearance_m(&SQUARE, &at(0.0, 0.0, f64::INFINITY), 0.0).is_nan());
    }
}
