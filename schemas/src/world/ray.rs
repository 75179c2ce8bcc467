//! Signed distance along a ray.

use super::{HalfPlane, Obstacle, World, cross, dot, minus, smaller};
use crate::Disc;

/// Below this cosine between a ray and a face's normal the two count as parallel.
const PARALLEL: f64 = 1e-12;

impl World {
    /// Signed distance, metres, from `from_m` along the world angle `angle_rad` to the edge of what
    /// is allowed, with everything grown by `inflation_m`, `t_s` seconds after the start of the
    /// session; +∞ if nothing is met. Section 6 of the controller's specification.
    ///
    /// Negative beyond a face of the room, and inside an obstacle or a disc, where it is minus the
    /// way back to the face by which the ray came in. Growing by a disc of radius `inflation_m` is
    /// exact: faces move out, corners become round. An inflation below zero counts as zero. NaN if
    /// point, angle or inflation is not finite.
    pub fn ray_m(&self, from_m: [f64; 2], angle_rad: f64, inflation_m: f64, t_s: f64) -> f64 {
        let finite = from_m[0].is_finite()
            && from_m[1].is_finite()
            && angle_rad.is_finite()
            && inflation_m.is_finite();
        if !finite {
            return f64::NAN;
        }
        let inflation_m = if inflation_m > 0.0 { inflation_m } else { 0.0 };
        let (sin, cos) = libm::sincos(angle_rad);
        let ray = Ray { from_m, along: [cos, sin] };
        let mut nearest_m = f64::INFINITY;
        for wall in &self.room {
            if let Some(distance_m) = ray.to_wall(wall, inflation_m) {
                nearest_m = smaller(nearest_m, distance_m);
            }
        }
        for obstacle in &self.obstacles {
            let chord = if inflation_m > 0.0 {
                ray.through_grown(obstacle, inflation_m)
            } else {
                ray.through(obstacle)
            };
            nearest_m = smaller(nearest_m, chord.entry_m());
        }
        for disc in self.discs_at(t_s) {
            let grown = Disc { radius_m: disc.radius_m + inflation_m, ..disc };
            nearest_m = smaller(nearest_m, ray.through_disc(&grown).entry_m());
        }
        nearest_m
    }
}

/// A ray, and with it the whole line that it lies on.
struct Ray {
    from_m: [f64; 2],
    /// Unit vector.
    along: [f64; 2],
}

/// The part of a line inside a convex set, as parameters along it; `in_m >= out_m` when empty.
#[derive(Clone, Copy)]
struct Chord {
    in_m: f64,
    out_m: f64,
}

impl Chord {
    const EMPTY: Chord = Chord { in_m: f64::INFINITY, out_m: f64::NEG_INFINITY };

    /// The entry parameter of a chord that does not lie behind the ray's start; else +∞.
    fn entry_m(self) -> f64 {
        if self.in_m < self.out_m && self.out_m > 0.0 { self.in_m } else { f64::INFINITY }
    }

    /// The least chord that holds this one and `other`: right for parts of one convex set.
    fn join(self, other: Chord) -> Chord {
        Chord {
            in_m: smaller(self.in_m, other.in_m),
            out_m: if other.out_m > self.out_m { other.out_m } else { self.out_m },
        }
    }
}

impl Ray {
    fn to_wall(&self, wall: &HalfPlane, inflation_m: f64) -> Option<f64> {
        let rate = dot(wall.normal, self.along);
        (rate > PARALLEL).then(|| (wall.distance_m(self.from_m) - inflation_m) / rate)
    }

    fn through(&self, obstacle: &Obstacle) -> Chord {
        let mut chord = Chord { in_m: f64::NEG_INFINITY, out_m: f64::INFINITY };
        for edge in obstacle.edges() {
            // Left as long as the edge: numerator and denominator scale alike.
            let outward = edge.outward();
            let inside = dot(outward, minus(edge.from_m, self.from_m));
            let rate = dot(outward, self.along);
            if rate * rate <= PARALLEL * PARALLEL * edge.length_squared() {
                if inside < 0.0 {
                    return Chord::EMPTY;
                }
            } else if rate < 0.0 {
                let crossing_m = inside / rate;
                if crossing_m > chord.in_m {
                    chord.in_m = crossing_m;
                }
            } else {
                chord.out_m = smaller(chord.out_m, inside / rate);
            }
        }
        // A polygon of fewer than three edges bounds nothing.
        if chord.in_m.is_finite() && chord.out_m.is_finite() { chord } else { Chord::EMPTY }
    }

    /// The chord through the Minkowski sum of a convex polygon and a disc. The sum's outline
    /// consists of the edges moved outwards and of arcs about the corners; both, and the whole
    /// discs about the corners, lie in the sum, and the sum is convex: so its chord is the least
    /// one that holds the ray's crossings with all of them.
    fn through_grown(&self, obstacle: &Obstacle, inflation_m: f64) -> Chord {
        let mut chord = Chord::EMPTY;
        for edge in obstacle.edges() {
            let corner = Disc { centre_m: edge.from_m, radius_m: inflation_m };
            chord = chord.join(self.through_disc(&corner));
            let Some(normal) = edge.normal() else { continue };
            let rate = dot(normal, self.along);
            if rate.abs() <= PARALLEL {
                // The ray crosses such an edge, if at all, inside the discs at its ends.
                continue;
            }
            let crossing_m = (dot(normal, minus(edge.from_m, self.from_m)) + inflation_m) / rate;
            let crossing = minus(
                [
                    self.from_m[0] + crossing_m * self.along[0],
                    self.from_m[1] + crossing_m * self.along[1],
                ],
                edge.from_m,
            );
            let along = dot(crossing, edge.along_m);
            if 0.0 <= along && along <= edge.length_squared() {
                chord = chord.join(Chord { in_m: crossing_m, out_m: crossing_m });
            }
        }
        chord
    }

    fn through_disc(&self, disc: &Disc) -> Chord {
        let to_centre_m = minus(disc.centre_m, self.from_m);
        let middle_m = dot(to_centre_m, self.along);
        let off_m = cross(self.along, to_centre_m);
        let squared = disc.radius_m * disc.radius_m - off_m * off_m;
        if squared > 0.0 {
            let half_m = libm::sqrt(squared);
            Chord { in_m: middle_m - half_m, out_m: middle_m + half_m }
        } else {
            Chord::EMPTY
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    fn boxed() -> World {
        World {
            room: Vec::new(),
            obstacles: vec![Obstacle {
                corners_m: vec![[1.0, -1.0], [3.0, -1.0], [3.0, 1.0], [1.0, 1.0]],
            }],
            discs: Vec::new(),
            paths: Vec::new(),
        }
    }

    fn close(a: f64, b: f64) -> bool {
        a == b || (a - b).abs() < 1e-12
    }

    /// Hand-computed rays against the square [1, 3] × [-1, 1], as it is and grown by 0.5 m.
    #[test]
    fn box_as_it_is_and_grown() {
        let world = boxed();
        let ray = |x, y, angle, inflation| world.ray_m([x, y], angle, inflation, 0.0);
        assert!(close(ray(0.0, 0.0, 0.0, 0.0), 1.0));
        assert!(close(ray(0.0, 0.0, 0.0, 0.5), 0.5));
        assert_eq!(ray(0.0, 0.0, PI, 0.5), f64::INFINITY);
        // Inside: minus the way back to the face of entry, however near the other faces are.
        assert!(close(ray(2.5, 0.0, 0.0, 0.0), -1.5));
        assert!(close(ray(2.5, 0.0, 0.0, 0.5), -2.0));
        // Above the box but within the growth: only the grown box is met.
        assert_eq!(ray(0.0, 1.25, 0.0, 0.0), f64::INFINITY);
        // The rounded corner about (1, 1): x = 1 - √(0.5² - 0.25²).
        assert!(close(ray(0.0, 1.25, 0.0, 0.5), 1.0 - libm::sqrt(0.1875)));
        // Just outside the growth.
        assert_eq!(ray(0.0, 1.5001, 0.0, 0.5), f64::INFINITY);
        // Diagonally at the corner (1, 1): straight at it, less the radius.
        assert!(close(ray(0.0, 2.0, -FRAC_PI_4, 0.5), libm::sqrt(2.0) - 0.5));
        // Along an edge and along a grown edge, the parallel cases.
        assert!(close(ray(0.0, 0.9, 0.0, 0.0), 1.0));
        assert!(close(ray(2.0, -3.0, FRAC_PI_2, 0.5), 1.5));
    }

    /// A disc is a disc; the room's faces come nearer by the inflation; what is beyond a face of
    /// the room is at a negative distance.
    #[test]
    fn room_and_disc() {
        let world = World {
            room: vec![HalfPlane { normal: [1.0, 0.0], offset_m: 4.0 }],
            obstacles: Vec::new(),
            discs: vec![crate::MovingDisc {
                radius_m: 0.5,
                from_m: [0.0, 3.0],
                to_m: [0.0, 1.0],
                speed_mps: 1.0,
                start_s: 0.0,
                to_and_fro: false,
            }],
            paths: Vec::new(),
        };
        assert!(close(world.ray_m([0.0, 0.0], 0.0, 0.25, 0.0), 3.75));
        assert!(close(world.ray_m([5.0, 0.0], 0.0, 0.0, 0.0), -1.0));
        assert!(close(world.ray_m([0.0, 0.0], FRAC_PI_2, 0.0, 0.0), 2.5));
        assert!(close(world.ray_m([0.0, 0.0], FRAC_PI_2, 0.25, 1.0), 1.25));
    }

    #[test]
    fn not_finite_is_nan() {
        let world = boxed();
        assert!(world.ray_m([f64::NAN, 0.0], 0.0, 0.0, 0.0).is_nan());
        assert!(world.ray_m([0.0, 0.0], f64::INFINITY, 0.0, 0.0).is_nan());
        assert!(world.ray_m([0.0, 0.0], 0.0, f64::NAN, 0.0).is_nan());
    }
}
