//! The face that a point is nearest to: what the frame `wall` is laid along.

use super::{World, minus};

/// The face that a point is nearest to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestFace {
    /// Signed distance, metres; negative inside what is forbidden.
    pub distance_m: f64,
    /// World angle of the direction from the point straight into the face: along its normal, or
    /// towards the centre of a disc.
    pub direction_rad: f64,
}

impl World {
    /// The face nearest to a point, `t_s` seconds after the start of the session; `None` in an
    /// empty world and for a point that is not finite.
    ///
    /// Off the corner of an obstacle the distance is that to the corner, and the face is the one
    /// of the two that the point lies farther beyond.
    pub fn nearest_face(&self, from_m: [f64; 2], t_s: f64) -> Option<NearestFace> {
        if !(from_m[0].is_finite() && from_m[1].is_finite()) {
            return None;
        }
        let mut nearest: Option<(f64, [f64; 2])> = None;
        let mut offer = |distance_m: f64, into: [f64; 2]| {
            if nearest.is_none_or(|(least_m, _)| distance_m < least_m) {
                nearest = Some((distance_m, into));
            }
        };
        for wall in &self.room {
            offer(wall.distance_m(from_m), wall.normal);
        }
        for obstacle in &self.obstacles {
            if let Some((_, normal)) = obstacle.separation(from_m) {
                offer(obstacle.distance_m(from_m), [-normal[0], -normal[1]]);
            }
        }
        for disc in self.discs_at(t_s) {
            let to_centre_m = minus(disc.centre_m, from_m);
            offer(libm::hypot(to_centre_m[0], to_centre_m[1]) - disc.radius_m, to_centre_m);
        }
        nearest.map(|(distance_m, into)| NearestFace {
            distance_m,
            direction_rad: libm::atan2(into[1], into[0]),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{HalfPlane, MovingDisc, Obstacle};
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    fn room() -> World {
        World {
            room: vec![
                HalfPlane { normal: [1.0, 0.0], offset_m: 4.0 },
                HalfPlane { normal: [0.0, 1.0], offset_m: 4.0 },
            ],
            obstacles: vec![Obstacle {
                corners_m: vec![[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]],
            }],
            discs: vec![MovingDisc {
                radius_m: 0.5,
                from_m: [-4.0, -4.0],
                to_m: [-4.0, -4.0],
                speed_mps: 0.0,
                start_s: 0.0,
                to_and_fro: false,
            }],
            paths: Vec::new(),
        }
    }

    fn face(x_m: f64, y_m: f64) -> (f64, f64) {
        let face = room().nearest_face([x_m, y_m], 0.0).expect("the world is not empty");
        (face.distance_m, face.direction_rad)
    }

    /// Hand-computed: distances and directions into the wall, the box, and the disc, from outside,
    /// off a corner, and from inside.
    #[test]
    fn is_the_nearest_and_looks_into_it() {
        assert_eq!(face(3.8, 2.0), (4.0 - 3.8, 0.0));
        assert_eq!(face(2.0, 3.5), (0.5, FRAC_PI_2));
        assert_eq!(face(0.5, 0.5), (0.5, 0.0));
        assert_eq!(face(1.5, 1.25), (0.25, -FRAC_PI_2));
        // Inside the box, 0.1 from its left face: straight into it is towards +x.
        let (distance_m, direction_rad) = face(1.1, 0.5);
        assert!((distance_m + 0.1).abs() < 1e-12 && direction_rad == 0.0);
        // Off the corner (2, 1) by (0.3, 0.4): half a metre, and farther beyond the upper face.
        let (distance_m, direction_rad) = face(2.3, 1.4);
        assert!((distance_m - 0.5).abs() < 1e-12 && direction_rad == -FRAC_PI_2);
        let (distance_m, direction_rad) = face(-3.0, -3.0);
        assert!((distance_m - (libm::sqrt(2.0) - 0.5)).abs() < 1e-12);
        assert!((direction_rad - (FRAC_PI_4 - PI)).abs() < 1e-12);
    }

    #[test]
    fn is_none_without_a_world_or_a_point() {
        assert_eq!(World::default().nearest_face([0.0, 0.0], 0.0), None);
        assert_eq!(room().nearest_face([f64::NAN, 0.0], 0.0), None);
    }
}
