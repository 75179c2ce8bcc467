//! How far a disc travels before it touches a point.

use schemas::{Footprint, Pose};

use super::beam::unit;

/// Discs about points are at least this share of their distance wide, in radius, so that the five
/// points of an arc (5° apart) leave no hole for a point robot: tan 2.5°, rounded up.
pub(super) const LEAST_RADIUS_SHARE: f64 = 0.045;

/// The straight path of a disc.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    /// Where its centre starts, metres.
    pub(super) from_m: [f64; 2],
    /// Unit vector.
    pub(super) along: [f64; 2],
    /// Its radius, metres.
    pub(super) radius_m: f64,
}

impl Ray {
    /// Free travel, metres, to the first of the discs of its radius about the points, +∞ if none is
    /// met; negative inside one whose point it comes nearer to (specification, section 6). A wall is
    /// many points: from inside their discs the ways that lead away from all of them are free, as they
    /// are from beyond a face of a room.
    pub(super) fn free_m(&self, points_m: &[[f64; 2]]) -> f64 {
        let discs = points_m.iter().map(|at_m| Bump::about(*at_m, self.from_m, self.radius_m));
        Ray::free_among_m(self.along, discs)
    }

    /// The same along the unit vector `along`, for discs as they lie about where the ray starts.
    pub(super) fn free_among_m(along: [f64; 2], discs: impl Iterator<Item = Bump>) -> f64 {
        let mut free_m = f64::INFINITY;
        for Bump { offset_m: [dx, dy], radius_m2 } in discs {
            let aside_m = dx * along[1] - dy * along[0];
            let forward_m = dx * along[0] + dy * along[1];
            let half_chord_m2 = radius_m2 - aside_m * aside_m;
            // Most are missed, and many too far ahead to matter: told without a square root. What lies
            // behind is either left behind already or being left.
            let beyond_m = larger(forward_m - free_m, 0.0);
            if forward_m > 0.0 && half_chord_m2 > beyond_m * beyond_m {
                free_m = forward_m - half_chord_m2.sqrt();
            }
        }
        free_m
    }
}

/// The disc about a point, from where a ray starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bump {
    /// Where the point is, metres.
    pub(super) offset_m: [f64; 2],
    /// Squared radius of the disc, metres².
    pub(super) radius_m2: f64,
}

impl Bump {
    /// About a point at `at_m`, for a ray from `from_m` of a disc of `radius_m`.
    pub(super) fn about(at_m: [f64; 2], from_m: [f64; 2], radius_m: f64) -> Bump {
        let [dx, dy] = [at_m[0] - from_m[0], at_m[1] - from_m[1]];
        let least_m2 = LEAST_RADIUS_SHARE * LEAST_RADIUS_SHARE * (dx * dx + dy * dy);
        Bump { offset_m: [dx, dy], radius_m2: larger(radius_m * radius_m, least_m2) }
    }
}

/// A bound on the free travel of a disc of `radius_m`, metres, in whichever direction: with the nearest point
/// `nearest_m` away none is shorter.
pub(super) fn least_free_m(radius_m: f64, nearest_m: f64) -> f64 {
    // Slack for rounding.
    const HAIR_M: f64 = 1e-9;
    // Farther points have wider discs, but do not come nearer by that.
    let least_m = nearest_m * (1.0 - LEAST_RADIUS_SHARE);
    least_m.min(nearest_m - radius_m) - HAIR_M
}

/// The larger of two numbers; the second where the first is none.
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The straight path of a rectangle along its own axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lane {
    /// Where its middle starts, metres.
    pub(super) from_m: [f64; 2],
    /// Unit vector.
    pub(super) along: [f64; 2],
    /// Half its length and half its width, metres.
    pub(super) half_m: [f64; 2],
}

impl Lane {
    /// That of a footprint about `from` which points along a world angle.
    pub(super) fn of(footprint: &Footprint, from: &Pose, angle_rad: f64) -> Lane {
        Lane {
            from_m: from.position_m(),
            along: unit(angle_rad),
            half_m: [0.5 * footprint.length_m, 0.5 * footprint.width_m],
        }
    }

    /// Free travel, metres, until its front meets a point, +∞ if none is met; negative where it covers
    /// one that is not behind its middle.
    pub(super) fn free_m(&self, points_m: &[[f64; 2]]) -> f64 {
        let [x_m, y_m] = self.from_m;
        self.free_among_m(points_m.iter().map(|at_m| [at_m[0] - x_m, at_m[1] - y_m]))
    }

    /// The same for points as they lie about its start, metres.
    pub(super) fn free_among_m(&self, offsets_m: impl Iterator<Item = [f64; 2]>) -> f64 {
        let [half_length_m, half_width_m] = self.half_m;
        offsets_m.fold(f64::INFINITY, |free_m, [dx, dy]| {
            let aside_m = (dx * self.along[1] - dy * self.along[0]).abs();
            let forward_m = dx * self.along[0] + dy * self.along[1];
            let wide_m = larger(half_width_m, LEAST_RADIUS_SHARE * forward_m);
            let met_m = forward_m - half_length_m;
            if forward_m > 0.0 && aside_m < wide_m && met_m < free_m { met_m } else { free_m }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn free_m(points_m: &[[f64; 2]], from_m: [f64; 2], along: [f64; 2], radius_m: f64) -> f64 {
        Ray { from_m, along, radius_m }.free_m(points_m)
    }

    /// Pythagoras: a disc of 0.5 m that moves along x past a point 0.3 m aside and 2 m ahead touches it
    /// 0.4 m before.
    #[test]
    fn a_disc_touches_a_point_where_pythagoras_says() {
        let point = [[2.0, 0.3]];
        assert!((free_m(&point, [0.0; 2], [1.0, 0.0], 0.5) - 1.6).abs() < 1e-15);
        // From 0.7 m farther on, 0.7 m less.
        assert!((free_m(&point, [0.7, 0.0], [1.0, 0.0], 0.5) - 0.9).abs() < 1e-15);
        // Away from it, or past it: nothing.
        assert_eq!(free_m(&point, [0.0; 2], [-1.0, 0.0], 0.5), f64::INFINITY);
        assert_eq!(free_m(&point, [0.0; 2], [1.0, 0.0], 0.25), f64::INFINITY);
        assert_eq!(free_m(&point, [0.0; 2], [0.0, 1.0], 0.5), f64::INFINITY);
    }

    /// 0.3 m from a point with a disc of 0.5 m: 0.2 m back to the edge. Turning the back on it, or the
    /// side, leads out.
    #[test]
    fn inside_a_disc_the_way_on_is_negative_and_the_way_out_is_free() {
        let point = [[0.3, 0.0]];
        assert!((free_m(&point, [0.0; 2], [1.0, 0.0], 0.5) + 0.2).abs() < 1e-15);
        assert_eq!(free_m(&point, [0.0; 2], [-1.0, 0.0], 0.5), f64::INFINITY);
        assert_eq!(free_m(&point, [0.0; 2], [0.0, 1.0], 0.5), f64::INFINITY);
        // One more on the other side: out of this one is into that.
        let both = [[0.3, 0.0], [-0.4, 0.0]];
        assert!((free_m(&both, [0.0; 2], [-1.0, 0.0], 0.5) + 0.1).abs() < 1e-15);
    }

    /// A square of 0.5 m meets with its front edge, 0.25 m ahead of its middle, what is less than 0.25 m
    /// aside; what is behind its middle it leaves.
    #[test]
    fn a_rectangle_meets_points_with_its_front() {
        let free_m = |point: [f64; 2]| {
            Lane { from_m: [0.5, 0.0], along: [1.0, 0.0], half_m: [0.25; 2] }.free_m(&[point])
        };
        assert!((free_m([2.0, 0.2]) - 1.25).abs() < 1e-15);
        assert_eq!(free_m([2.0, -0.26]), f64::INFINITY);
        assert!((free_m([0.6, 0.1]) + 0.15).abs() < 1e-15);
        assert_eq!(free_m([0.4, 0.1]), f64::INFINITY);
    }

    /// With a point 0.5 m away a disc of 0.354 m is free for 0.146 m at least, and a point robot, about which a
    /// disc of 4.5 % counts, for 0.4775 m; towards it, not for more.
    #[test]
    fn no_ray_is_shorter_than_the_least() {
        for (radius_m, free_m) in [(0.354, 0.146), (0.0, 0.4775)] {
            let least_m = least_free_m(radius_m, 0.5);
            assert!((least_m - free_m).abs() < 1e-8);
            for deg in 0..360 {
                let along = unit(f64::from(deg).to_radians());
                assert!(Ray { from_m: [0.0; 2], along, radius_m }.free_m(&[[0.5, 0.0]]) >= least_m);
            }
        }
        assert!(least_free_m(0.354, 0.2) < 0.0);
        assert_eq!(least_free_m(0.354, f64::INFINITY), f64::INFINITY);
    }

    /// A point robot does not slip between points 5° apart.
    #[test]
    fn a_point_robot_meets_the_arc_everywhere() {
        let arc: Vec<[f64; 2]> = (-2..=2)
            .map(|i| (5.0 * f64::from(i)).to_radians())
            .map(|a| [3.0 * libm::cos(a), 3.0 * libm::sin(a)])
            .collect();
        for tenth_deg in -100..=100 {
            let a = (f64::from(tenth_deg) * 0.1).to_radians();
            let free_m = free_m(&arc, [0.0; 2], [libm::cos(a), libm::sin(a)], 0.0);
            let met = (3.0 * (1.0 - 0.045) - 1e-12..=3.0).contains(&free_m);
            assert!(met, "{tenth_deg}: {free_m}");
        }
    }
}
