//! Free travel of a footprint along its own axis.

use super::{HalfPlane, Obstacle, World, dot, minus, smaller};
use crate::{Disc, Footprint};

/// Below this cosine between the way and a face's normal the two count as parallel.
const PARALLEL: f64 = 1e-12;

impl World {
    /// Signed distance, metres, that a footprint about `from_m` which points along the world angle
    /// `angle_rad` may travel straight on before it touches something, `t_s` seconds after the start of
    /// the session; +∞ if nothing is met. Section 5 of the controller's specification.
    ///
    /// Negative where it overlaps what it would drive on into: minus the way back, in the same
    /// direction, to where it came in. What it only overlaps with while leaving it does not count in
    /// the room, but does in obstacles and discs, as with [`World::ray_m`]; and a footprint without
    /// extent travels as a ray, bit for bit. NaN if point or angle is not finite.
    pub fn travel_m(
        &self,
        footprint: &Footprint,
        from_m: [f64; 2],
        angle_rad: f64,
        t_s: f64,
    ) -> f64 {
        if !(from_m[0].is_finite() && from_m[1].is_finite() && angle_rad.is_finite()) {
            return f64::NAN;
        }
        if *footprint == Footprint::POINT {
            return self.ray_m(from_m, angle_rad, 0.0, t_s);
        }
        let (sin, cos) = libm::sincos(angle_rad);
        let way = Way {
            from_m,
            along: [cos, sin],
            aside: [-sin, cos],
            half_m: [0.5 * footprint.length_m, 0.5 * footprint.width_m],
        };
        let mut nearest_m = f64::INFINITY;
        for wall in &self.room {
            if let Some(distance_m) = way.to_wall(wall) {
                nearest_m = smaller(nearest_m, distance_m);
            }
        }
        for obstacle in &self.obstacles {
            nearest_m = smaller(nearest_m, way.to_obstacle(obstacle));
        }
        for disc in self.discs_at(t_s) {
            nearest_m = smaller(nearest_m, way.to_disc(&disc));
        }
        nearest_m
    }
}

/// A rectangle on its way along its own axis.
struct Way {
    from_m: [f64; 2],
    /// Unit vector of travel.
    along: [f64; 2],
    /// Unit vector to the left.
    aside: [f64; 2],
    /// Half length and half width, metres.
    half_m: [f64; 2],
}

impl Way {
    /// How far the rectangle reaches from its middle along a vector, times the vector's length.
    fn reach(&self, direction: [f64; 2]) -> f64 {
        let [half_length_m, half_width_m] = self.half_m;
        half_length_m * libm::fabs(dot(direction, self.along))
            + half_width_m * libm::fabs(dot(direction, self.aside))
    }

    fn to_wall(&self, wall: &HalfPlane) -> Option<f64> {
        let rate = dot(wall.normal, self.along);
        let free_m = wall.distance_m(self.from_m) - self.reach(wall.normal);
        (rate > PARALLEL).then(|| free_m / rate)
    }

    /// The middle meets the obstacle grown by the rectangle: a convex polygon, bounded by the
    /// obstacle's faces moved out by the rectangle's reach, and by the rectangle's faces moved out by
    /// the obstacle's.
    fn to_obstacle(&self, obstacle: &Obstacle) -> f64 {
        let [half_length_m, half_width_m] = self.half_m;
        let mut ahead_m = [f64::INFINITY, f64::NEG_INFINITY];
        let mut left_m = [f64::INFINITY, f64::NEG_INFINITY];
        let mut chord = Chord::WHOLE;
        for edge in obstacle.edges() {
            let offset_m = minus(edge.from_m, self.from_m);
            widen(&mut ahead_m, dot(offset_m, self.along));
            widen(&mut left_m, dot(offset_m, self.aside));
            // Left as long as the edge: numerator and denominator scale alike.
            let outward = edge.outward();
            let parallel = PARALLEL * libm::sqrt(edge.length_squared());
            let room = dot(outward, offset_m) + self.reach(outward);
            chord.cut(room, dot(outward, self.along), parallel);
        }
        chord.cut(ahead_m[1] + half_length_m, 1.0, PARALLEL);
        chord.cut(half_length_m - ahead_m[0], -1.0, PARALLEL);
        let beside = left_m[0] >= half_width_m || left_m[1] <= -half_width_m;
        if beside { f64::INFINITY } else { chord.entry_m() }
    }

    /// The middle meets the rectangle grown by the disc, which is round at its corners.
    fn to_disc(&self, disc: &Disc) -> f64 {
        let [half_length_m, half_width_m] = self.half_m;
        let offset_m = minus(disc.centre_m, self.from_m);
        let (ahead_m, left_m) = (dot(offset_m, self.along), dot(offset_m, self.aside));
        let over_m = libm::fabs(left_m) - half_width_m;
        let half_chord_m = if over_m <= 0.0 {
            disc.radius_m
        } else if over_m < disc.radius_m {
            libm::sqrt(disc.radius_m * disc.radius_m - over_m * over_m)
        } else {
            return f64::INFINITY;
        };
        let half_m = half_length_m + half_chord_m;
        if ahead_m + half_m > 0.0 { ahead_m - half_m } else { f64::INFINITY }
    }
}

/// The part of the way inside a convex set, as parameters along it.
struct Chord {
    in_m: f64,
    out_m: f64,
}

impl Chord {
    const WHOLE: Chord = Chord { in_m: f64::NEG_INFINITY, out_m: f64::INFINITY };

    /// Leaves what lies within a half-plane: `room` is left to its edge, of which `rate` is used up per
    /// metre.
    fn cut(&mut self, room: f64, rate: f64, parallel: f64) {
        if libm::fabs(rate) <= parallel {
            if room <= 0.0 {
                self.out_m = f64::NEG_INFINITY;
            }
        } else if rate < 0.0 {
            let crossing_m = room / rate;
            if crossing_m > self.in_m {
                self.in_m = crossing_m;
            }
        } else {
            self.out_m = smaller(self.out_m, room / rate);
        }
    }

    fn entry_m(&self) -> f64 {
        let met = self.in_m < self.out_m && self.out_m > 0.0 && self.in_m.is_finite();
        if met { self.in_m } else { f64::INFINITY }
    }
}

fn widen([least, most]: &mut [f64; 2], value: f64) {
    if value < *least {
        *least = value;
    }
    if value > *most {
        *most = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MovingDisc, Pose};

    const SQUARE: Footprint = Footprint { length_m: 0.6, width_m: 0.4 };

    fn still(centre_m: [f64; 2], radius_m: f64) -> MovingDisc {
        MovingDisc {
            radius_m,
            from_m: centre_m,
            to_m: centre_m,
            speed_mps: 0.0,
            start_s: 0.0,
            to_and_fro: false,
        }
    }

    /// 0.3 m of the body ahead of its middle, 0.2 m to either side.
    #[test]
    fn the_front_edge_is_what_meets() {
        let wall = World {
            room: vec![HalfPlane { normal: [1.0, 0.0], offset_m: 2.0 }],
            ..World::default()
        };
        let along = |world: &World, angle_rad| world.travel_m(&SQUARE, [0.0; 2], angle_rad, 0.0);
        assert!((along(&wall, 0.0) - 1.7).abs() < 1e-15);
        assert_eq!(along(&wall, std::f64::consts::PI), f64::INFINITY);
        // At 45° the front left corner leads by (0.3 + 0.2)/√2 in x, and x grows by 1/√2 per metre.
        let slanted_m = along(&wall, -std::f64::consts::FRAC_PI_4);
        assert!((slanted_m - (2.0 * 2_f64.sqrt() - 0.5)).abs() < 1e-12, "{slanted_m}");

        let disc = |y_m: f64| World { discs: vec![still([1.0, y_m], 0.1)], ..World::default() };
        assert!((along(&disc(0.0), 0.0) - 0.6).abs() < 1e-15);
        assert!((along(&disc(0.2), 0.0) - 0.6).abs() < 1e-15);
        // 0.06 m beside the edge's end a disc of 0.1 m is met 0.08 m before its middle (3-4-5).
        assert!((along(&disc(-0.26), 0.0) - 0.62).abs() < 1e-12);
        assert_eq!(along(&disc(0.31), 0.0), f64::INFINITY);
        assert_eq!(along(&disc(0.0), std::f64::consts::PI), f64::INFINITY);
    }

    /// Past a box beside the way, and into one that reaches over it by 1 cm.
    #[test]
    fn a_box_beside_is_passed() {
        let at = |low_m: f64| World {
            obstacles: vec![Obstacle {
                corners_m: vec![[1.0, low_m], [2.0, low_m], [2.0, 3.0], [1.0, 3.0]],
            }],
            ..World::default()
        };
        let along = |low_m: f64| at(low_m).travel_m(&SQUARE, [0.0; 2], 0.0, 0.0);
        assert_eq!(along(0.2), f64::INFINITY);
        assert!((along(0.19) - 0.7).abs() < 1e-12);
        let inside_m = at(-1.0).travel_m(&SQUARE, [1.1, 0.0], 0.0, 0.0);
        assert!((inside_m + 0.4).abs() < 1e-12, "0.4 m back to where its front met the face");
    }

    #[test]
    fn what_is_no_number_has_no_distance() {
        let world = World::default();
        assert_eq!(world.travel_m(&SQUARE, [0.0; 2], 0.0, 0.0), f64::INFINITY);
        assert!(world.travel_m(&SQUARE, [f64::NAN, 0.0], 0.0, 0.0).is_nan());
        assert!(world.travel_m(&SQUARE, [0.0; 2], f64::INFINITY, 0.0).is_nan());
    }

    mod agreement {
        use proptest::prelude::*;

        use super::*;

        proptest! {
            /// Beside the clearance of the footprint, computed another way: it stays apart until the
            /// distance is covered, and is in contact there. Beside the rays: next to a point it makes
            /// next to no difference.
            #[test]
            fn the_footprint_is_clear_until_it_touches(
                x_m in -1.0..1.0, y_m in -1.0..1.0, theta_rad in -4.0..4.0,
                centre_m in prop::array::uniform2(-3.0..3.0_f64), radius_m in 0.1..1.0,
                wall_rad in -4.0..4.0, turned_rad in 0.0..7.0,
            ) {
                let (sin, cos) = libm::sincos(wall_rad);
                let corner = |third: f64| {
                    let (sin, cos) = libm::sincos(turned_rad + third * 2.094);
                    [centre_m[0] + radius_m * cos, centre_m[1] + radius_m * sin]
                };
                let world = World {
                    room: vec![HalfPlane { normal: [cos, sin], offset_m: 2.5 }],
                    obstacles: vec![Obstacle { corners_m: [0.0, 1.0, 2.0].map(corner).to_vec() }],
                    discs: vec![still([-centre_m[1], centre_m[0]], 0.3)],
                    paths: Vec::new(),
                };
                let from_m = [x_m, y_m];
                let pose_at = |s_m: f64| {
                    let (sin, cos) = libm::sincos(theta_rad);
                    Pose { x_m: x_m + s_m * cos, y_m: y_m + s_m * sin, theta_rad }
                };
                let clearance_m = |s_m: f64| world.clearance_m(&SQUARE, &pose_at(s_m), 0.0);
                let free_m = world.travel_m(&SQUARE, from_m, theta_rad, 0.0);
                if clearance_m(0.0) > 0.0 {
                    prop_assert!(free_m > 0.0, "{free_m}");
                    for share in 0..20 {
                        let s_m = f64::from(share) / 20.0 * free_m.min(6.0);
                        prop_assert!(clearance_m(s_m) > -1e-9, "{free_m} {s_m}");
                    }
                    if free_m < 6.0 {
                        prop_assert!(clearance_m(free_m).abs() < 1e-9, "{}", clearance_m(free_m));
                    }
                }
                let dot = Footprint { length_m: 1e-12, width_m: 1e-12 };
                let dot_m = world.travel_m(&dot, from_m, theta_rad, 0.0);
                let ray_m = world.ray_m(from_m, theta_rad, 0.0, 0.0);
                prop_assert!(dot_m == ray_m || (dot_m - ray_m).abs() < 1e-6, "{dot_m} {ray_m}");
            }
        }
    }
}
