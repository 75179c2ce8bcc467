//! What a sonar's cone meets, in front of flat faces, corners and discs.
//!
//! Two answers: the exact nearest distance over the cone ([`Cone::nearest_m`]), for a sonar that
//! hears everything; and a fan of rays ([`Cone::fan`]), each with the face it meets and the angle
//! at which it does, for a sonar that hears only what sends its sound back.

use schemas::{Disc, World};

/// Half the nominal opening of a sonar's cone, degrees (specification §10): that of a sonar without
/// faults.
pub const SONAR_CONE_HALF_DEG: f64 = 10.0;

/// Rays across a cone, both edges and the axis among them: one every 2° of the nominal one.
pub(super) const FAN: usize = 11;

type Vector = [f64; 2];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Vector, b: Vector) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1]]
}

fn turned(a: Vector, by: Vector) -> Vector {
    [a[0] * by[0] - a[1] * by[1], a[0] * by[1] + a[1] * by[0]]
}

/// One face of an obstacle, prepared for many rays.
struct Face {
    from_m: Vector,
    /// Unit vector from its first corner to its second.
    along: Vector,
    /// Unit vector out of the obstacle.
    outward: Vector,
    length_m: f64,
}

/// The world's surfaces, prepared once, with the discs where they are now.
pub(super) struct Surfaces {
    walls: Vec<schemas::HalfPlane>,
    obstacles: Vec<Vec<Face>>,
    pub(super) discs: Vec<Disc>,
}

impl Surfaces {
    pub(super) fn new(world: &World) -> Surfaces {
        let faces = |corners_m: &[Vector]| -> Vec<Face> {
            (0..corners_m.len())
                .filter_map(|i| {
                    let from_m = corners_m[i];
                    let side_m = minus(corners_m[(i + 1) % corners_m.len()], from_m);
                    let length_m = libm::sqrt(dot(side_m, side_m));
                    let along = [side_m[0] / length_m, side_m[1] / length_m];
                    let outward = [along[1], -along[0]];
                    (length_m > 0.0).then_some(Face { from_m, along, outward, length_m })
                })
                .collect()
        };
        Surfaces {
            walls: world.room.clone(),
            obstacles: world.obstacles.iter().map(|it| faces(&it.corners_m)).collect(),
            discs: Vec::with_capacity(world.discs.len() + world.paths.len()),
        }
    }

    /// Convex corners of the obstacles, numbered through.
    pub(super) fn corners_m(&self) -> impl Iterator<Item = Vector> + '_ {
        self.obstacles.iter().flatten().map(|face| face.from_m)
    }

    /// Whether a point lies beyond a wall, in an obstacle or in a disc.
    pub(super) fn buries(&self, point_m: Vector) -> bool {
        self.walls.iter().any(|wall| wall.distance_m(point_m) <= 0.0)
            || self.obstacles.iter().any(|faces| {
                !faces.is_empty()
                    && faces
                        .iter()
                        .all(|face| dot(face.outward, minus(point_m, face.from_m)) <= 0.0)
            })
            || self.discs.iter().any(|disc| {
                let offset_m = minus(disc.centre_m, point_m);
                dot(offset_m, offset_m) <= disc.radius_m * disc.radius_m
            })
    }

    /// Distance from a point outside everything to the first surface along a unit vector, metres;
    /// +∞ where there is none.
    pub(super) fn first_hit_m(&self, from_m: Vector, along: Vector) -> f64 {
        let mut hits = [Hit::NONE; 1];
        self.meet(from_m, &[along], &mut hits);
        hits[0].distance_m
    }

    fn meet<const N: usize>(&self, from_m: Vector, rays: &[Vector; N], hits: &mut [Hit; N]) {
        for wall in &self.walls {
            let height_m = wall.distance_m(from_m);
            for (ray, hit) in rays.iter().zip(hits.iter_mut()) {
                let slope = dot(wall.normal, *ray);
                if slope > 0.0 {
                    hit.offer(height_m / slope, slope);
                }
            }
        }
        for face in self.obstacles.iter().flatten() {
            let offset_m = minus(from_m, face.from_m);
            let height_m = dot(face.outward, offset_m);
            if height_m < 0.0 {
                continue;
            }
            let along_m = dot(face.along, offset_m);
            for (ray, hit) in rays.iter().zip(hits.iter_mut()) {
                let slope = -dot(face.outward, *ray);
                if slope > 0.0 {
                    let distance_m = height_m / slope;
                    let place_m = along_m + distance_m * dot(face.along, *ray);
                    if 0.0 <= place_m && place_m <= face.length_m {
                        hit.offer(distance_m, slope);
                    }
                }
            }
        }
        for disc in &self.discs {
            let offset_m = minus(disc.centre_m, from_m);
            for (ray, hit) in rays.iter().zip(hits.iter_mut()) {
                if let Some((distance_m, cosine)) = entry(offset_m, disc.radius_m, *ray) {
                    hit.offer(distance_m, cosine);
                }
            }
        }
    }
}

/// Where a ray from outside enters a disc: the distance, and the cosine of the angle of incidence.
fn entry(offset_m: Vector, radius_m: f64, ray: Vector) -> Option<(f64, f64)> {
    let off_m = cross(ray, offset_m);
    let middle_m = dot(ray, offset_m);
    let squared = radius_m * radius_m - off_m * off_m;
    if squared < 0.0 || middle_m < 0.0 {
        return None;
    }
    let half_m = libm::sqrt(squared);
    Some((middle_m - half_m, half_m / radius_m))
}

/// What one ray of the fan meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    /// How far away, metres; +∞ for nothing.
    pub(super) distance_m: f64,
    /// Cosine of the angle between the ray and the surface's normal.
    pub(super) cosine: f64,
}

impl Hit {
    const NONE: Hit = Hit { distance_m: f64::INFINITY, cosine: 0.0 };

    fn offer(&mut self, distance_m: f64, cosine: f64) {
        if distance_m < self.distance_m {
            *self = Hit { distance_m, cosine };
        }
    }
}

/// The directions of a cone about the x axis.
pub(super) struct Fan {
    rays: [Vector; FAN],
}

impl Fan {
    pub(super) fn new(half_deg: f64) -> Fan {
        let step_deg = 2.0 * half_deg / (FAN - 1) as f64;
        let ray = |i: usize| {
            let (sin, cos) = libm::sincos((i as f64 * step_deg - half_deg).to_radians());
            [cos, sin]
        };
        Fan { rays: core::array::from_fn(ray) }
    }

    /// The cone about a unit vector, with its tip at a point.
    pub(super) fn aim(&self, tip_m: Vector, axis: Vector) -> Cone {
        Cone { tip_m, rays: self.rays.map(|ray| turned(axis, ray)) }
    }
}

/// One sonar's field of hearing, in the world frame.
pub(super) struct Cone {
    tip_m: Vector,
    /// From its right edge to its left.
    rays: [Vector; FAN],
}

impl Cone {
    fn edges(&self) -> (Vector, Vector) {
        (self.rays[0], self.rays[FAN - 1])
    }

    /// Whether a displacement from the tip lies in the cone.
    pub(super) fn holds(&self, offset_m: Vector) -> bool {
        let (right, left) = self.edges();
        cross(right, offset_m) >= 0.0 && cross(offset_m, left) >= 0.0
    }

    /// What each ray of the fan meets first. The tip must lie outside everything.
    pub(super) fn fan(&self, surfaces: &Surfaces) -> [Hit; FAN] {
        let mut hits = [Hit::NONE; FAN];
        surfaces.meet(self.tip_m, &self.rays, &mut hits);
        hits
    }

    /// Distance from the tip to the nearest point of any surface within the cone, metres, at
    /// whatever angle it is met; +∞ in an empty cone. The tip must lie outside everything; then
    /// nothing can stand before the nearest point.
    pub(super) fn nearest_m(&self, surfaces: &Surfaces) -> f64 {
        let mut nearest_m = f64::INFINITY;
        let mut offer = |distance_m: f64| {
            if distance_m < nearest_m {
                nearest_m = distance_m;
            }
        };
        for wall in &surfaces.walls {
            let height_m = wall.distance_m(self.tip_m);
            let foot_m = [height_m * wall.normal[0], height_m * wall.normal[1]];
            let along = [-wall.normal[1], wall.normal[0]];
            offer(self.to_segment_m(foot_m, along, f64::NEG_INFINITY, f64::INFINITY));
        }
        for face in surfaces.obstacles.iter().flatten() {
            let offset_m = minus(face.from_m, self.tip_m);
            offer(self.to_segment_m(offset_m, face.along, 0.0, face.length_m));
        }
        let (right, left) = self.edges();
        for disc in &surfaces.discs {
            let offset_m = minus(disc.centre_m, self.tip_m);
            if self.holds(offset_m) {
                offer(libm::hypot(offset_m[0], offset_m[1]) - disc.radius_m);
            } else {
                for ray in [right, left] {
                    if let Some((distance_m, _)) = entry(offset_m, disc.radius_m, ray) {
                        offer(distance_m);
                    }
                }
            }
        }
        nearest_m
    }

    /// Distance from the tip to the part of a segment within the cone; the segment is `start_m`
    /// (from the tip) plus `low_m..high_m` along a unit vector.
    fn to_segment_m(&self, start_m: Vector, along: Vector, low_m: f64, high_m: f64) -> f64 {
        let (mut low_m, mut high_m) = (low_m, high_m);
        let (right, left) = self.edges();
        // The cone is where both cross products are positive; along the segment each is linear.
        for (at_start, rate) in [
            (cross(right, start_m), cross(right, along)),
            (cross(start_m, left), cross(along, left)),
        ] {
            let crossing_m = -at_start / rate;
            if rate > 0.0 {
                if crossing_m > low_m {
                    low_m = crossing_m;
                }
            } else if rate < 0.0 {
                if crossing_m < high_m {
                    high_m = crossing_m;
                }
            } else if at_start < 0.0 {
                return f64::INFINITY;
            }
        }
        if low_m > high_m {
            return f64::INFINITY;
        }
        let foot_m = -dot(start_m, along);
        let place_m = if foot_m < low_m {
            low_m
        } else if foot_m > high_m {
            high_m
        } else {
            foot_m
        };
        libm::hypot(start_m[0] + place_m * along[0], start_m[1] + place_m * along[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use schemas::{HalfPlane, Obstacle};

    fn aim(angle_deg: f64) -> Cone {
        let (sin, cos) = libm::sincos(angle_deg.to_radians());
        Fan::new(SONAR_CONE_HALF_DEG).aim([0.0, 0.0], [cos, sin])
    }

    fn wall_ahead() -> Surfaces {
        Surfaces::new(&World {
            room: vec![HalfPlane { normal: [1.0, 0.0], offset_m: 2.0 }],
            ..World::default()
        })
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    /// A wall 2 m ahead, seen by a cone turned away by φ: square to it while φ ≤ 10°, then along
    /// the nearer edge of the cone, 2 / cos(φ - 10°); nothing when it looks away.
    #[test]
    fn nearest_over_the_cone() {
        let surfaces = wall_ahead();
        for angle_deg in [0.0_f64, 5.0, -9.9, 30.0, -45.0, 75.0] {
            let edge_deg = if angle_deg.abs() > 10.0 { angle_deg.abs() - 10.0 } else { 0.0 };
            let wanted_m = 2.0 / libm::cos(edge_deg.to_radians());
            assert!(close(aim(angle_deg).nearest_m(&surfaces), wanted_m), "{angle_deg}");
        }
        assert_eq!(aim(180.0).nearest_m(&surfaces), f64::INFINITY);
    }

    /// Ray i of the fan leaves at -10° + 2° i and meets the wall at that angle.
    #[test]
    fn fan_knows_distance_and_incidence() {
        for (i, hit) in aim(0.0).fan(&wall_ahead()).iter().enumerate() {
            let angle_rad = (2.0 * i as f64 - 10.0).to_radians();
            assert!(close(hit.cosine, libm::cos(angle_rad)));
            assert!(close(hit.distance_m, 2.0 / libm::cos(angle_rad)));
        }
    }

    /// A box whose corner pokes into the cone: the exact answer finds the point on the cone's
    /// edge, the fan the same edge; a disc beside the cone's edge is met at that edge.
    #[test]
    fn corner_and_disc_at_the_edge_of_the_cone() {
        let (sin, cos) = libm::sincos(10.0_f64.to_radians());
        let mut surfaces = Surfaces::new(&World {
            // Its lower left corner (1, 0.1) lies inside the cone, the left face is x = 1.
            obstacles: vec![Obstacle {
                corners_m: vec![[1.0, 0.1], [2.0, 0.1], [2.0, 2.0], [1.0, 2.0]],
            }],
            ..World::default()
        });
        assert!(close(aim(0.0).nearest_m(&surfaces), libm::hypot(1.0, 0.1)));
        assert!(close(aim(0.0).fan(&surfaces)[FAN - 1].distance_m, 1.0 / cos));
        assert_eq!(surfaces.corners_m().count(), 4);
        assert!(!surfaces.buries([0.9, 1.0]) && surfaces.buries([1.1, 1.0]));

        surfaces = Surfaces::new(&World::default());
        // Half a radius off the left edge of the cone, one metre along it.
        let off_m = 0.1;
        surfaces
            .discs
            .push(Disc { centre_m: [cos - off_m * sin, sin + off_m * cos], radius_m: 0.2 });
        let wanted_m = 1.0 - libm::sqrt(0.04 - 0.01);
        assert!(close(aim(0.0).nearest_m(&surfaces), wanted_m));
        assert!(close(aim(0.0).fan(&surfaces)[FAN - 1].distance_m, wanted_m));
        assert!(close(surfaces.first_hit_m([0.0, 0.0], [cos, sin]), wanted_m));
    }
}
