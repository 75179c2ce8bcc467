//! How far a disc travels before it touches a point.

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
    /// met; negative inside one (specification, section 6).
    pub(super) fn free_m(&self, points_m: &[[f64; 2]]) -> f64 {
        let mut free_m = f64::INFINITY;
        for at_m in points_m {
            let [dx, dy] = [at_m[0] - self.from_m[0], at_m[1] - self.from_m[1]];
            let aside_m = dx * self.along[1] - dy * self.along[0];
            let forward_m = dx * self.along[0] + dy * self.along[1];
            let least_m2 = LEAST_RADIUS_SHARE * LEAST_RADIUS_SHARE * (dx * dx + dy * dy);
            let radius_m2 = (self.radius_m * self.radius_m).max(least_m2);
            let half_chord_m2 = radius_m2 - aside_m * aside_m;
            // Most discs are missed, or too far ahead to matter: told without a square root.
            let beyond_m = (forward_m - free_m).max(0.0);
            if half_chord_m2 > beyond_m * beyond_m {
                let half_chord_m = half_chord_m2.sqrt();
                if forward_m + half_chord_m > 0.0 {
                    free_m = forward_m - half_chord_m;
                }
            }
        }
        free_m
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

    /// 0.3 m from a point with a disc of 0.5 m: 0.2 m back to the edge.
    #[test]
    fn inside_a_disc_the_way_is_negative() {
        assert!((free_m(&[[0.3, 0.0]], [0.0; 2], [1.0, 0.0], 0.5) + 0.2).abs() < 1e-15);
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
