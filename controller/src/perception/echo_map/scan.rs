//! The virtual scan: what a range finder at one place would see of the remembered points.

/// How many directions. They are equal steps of the pseudo-angle below, which are 0.95° wide along
/// the axes and 1.9° between them: 1.5° on average, as the echo map's prototype had it.
const DIRECTIONS: usize = 240;

/// Discs about points are at least this share of their distance wide, in radius, so that the five
/// points of an arc (5° apart) leave no hole for a point robot: tan 2.5°, rounded up.
const LEAST_RADIUS_SHARE: f64 = 0.045;

/// No point in a direction yet.
const EMPTY: u8 = u8::MAX;

/// The nearest point per direction about one place.
#[derive(Clone, Debug)]
pub(super) struct Scan {
    /// Per direction, where its point stands in the lists.
    index: [u8; DIRECTIONS],
    distances_m: Vec<f64>,
    seen: Vec<[f64; 2]>,
}

/// Where a point appears from the scan's place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    direction: usize,
    distance_m: f64,
    /// Position, metres, drawn nearer.
    pub(super) at_m: [f64; 2],
}

impl Scan {
    pub(super) fn new() -> Scan {
        Scan {
            index: [EMPTY; DIRECTIONS],
            distances_m: Vec::with_capacity(DIRECTIONS),
            seen: Vec::with_capacity(DIRECTIONS),
        }
    }

    pub(super) fn clear(&mut self) {
        self.index = [EMPTY; DIRECTIONS];
        self.distances_m.clear();
        self.seen.clear();
    }

    pub(super) fn see(&mut self, sighting: &Sighting) {
        let Sighting { direction, distance_m, at_m } = *sighting;
        let place = usize::from(self.index[direction]);
        if place == usize::from(EMPTY) {
            self.index[direction] = self.seen.len() as u8;
            self.distances_m.push(distance_m);
            self.seen.push(at_m);
        } else if distance_m < self.distances_m[place] {
            self.distances_m[place] = distance_m;
            self.seen[place] = at_m;
        }
    }

    /// The nearest points, metres, world frame.
    pub(super) fn points_m(&self) -> &[[f64; 2]] {
        &self.seen
    }
}

/// Free travel, metres, of a disc of `radius_m` from `from_m` along the unit vector `along`: to the
/// first of the discs of that radius about the points, +∞ if none is met; negative inside one
/// (specification, section 6).
pub(super) fn ray_m(
    points_m: &[[f64; 2]],
    from_m: [f64; 2],
    along: [f64; 2],
    radius_m: f64,
) -> f64 {
    let mut free_m = f64::INFINITY;
    for at_m in points_m {
        let [dx, dy] = [at_m[0] - from_m[0], at_m[1] - from_m[1]];
        let aside_m = dx * along[1] - dy * along[0];
        let least_m2 = LEAST_RADIUS_SHARE * LEAST_RADIUS_SHARE * (dx * dx + dy * dy);
        let radius_m2 = (radius_m * radius_m).max(least_m2);
        let half_chord_m2 = radius_m2 - aside_m * aside_m;
        if half_chord_m2 <= 0.0 {
            continue;
        }
        let forward_m = dx * along[0] + dy * along[1];
        // Without a square root: even its whole radius does not bring this disc nearer.
        let beyond_m = forward_m - free_m;
        if beyond_m > 0.0 && beyond_m * beyond_m >= radius_m2 {
            continue;
        }
        let half_chord_m = half_chord_m2.sqrt();
        if forward_m + half_chord_m > 0.0 {
            free_m = free_m.min(forward_m - half_chord_m);
        }
    }
    free_m
}

/// Draws a point nearer to `about_m` by `by_m` and says where it then appears. `None` if it is no
/// number.
pub(super) fn sight(about_m: [f64; 2], point_m: [f64; 2], by_m: f64) -> Option<Sighting> {
    let [dx, dy] = [point_m[0] - about_m[0], point_m[1] - about_m[1]];
    let distance_m = (dx * dx + dy * dy).sqrt();
    let drawn_m = (distance_m - by_m).max(0.0);
    let share = if distance_m > 0.0 { drawn_m / distance_m } else { 0.0 };
    let direction = direction(dx, dy)?;
    Some(Sighting {
        direction,
        distance_m: drawn_m,
        at_m: [about_m[0] + share * dx, about_m[1] + share * dy],
    })
}

/// Which direction a vector points in, by a pseudo-angle that needs no arctangent: y/(|x|+|y|) in the
/// first quadrant, and so on around. `None` if the vector is no number.
fn direction(x: f64, y: f64) -> Option<usize> {
    let whole = x.abs() + y.abs();
    if whole == 0.0 {
        return Some(0);
    }
    if !whole.is_finite() {
        return None;
    }
    let quarters = match (x >= 0.0, y >= 0.0) {
        (true, true) => y / whole,
        (false, true) => 1.0 - x / whole,
        (false, false) => 2.0 - y / whole,
        (true, false) => 3.0 + x / whole,
    };
    // A quotient may round up to the next quadrant's start, and the last to a whole turn.
    let step = (quarters * (DIRECTIONS / 4) as f64) as usize;
    Some(step.min(DIRECTIONS - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan_of(points_m: &[[f64; 2]]) -> Scan {
        let mut scan = Scan::new();
        for point_m in points_m {
            scan.see(&sight([0.0; 2], *point_m, 0.0).unwrap());
        }
        scan
    }

    fn ray_of(points_m: &[[f64; 2]], from_m: [f64; 2], along: [f64; 2], radius_m: f64) -> f64 {
        ray_m(scan_of(points_m).points_m(), from_m, along, radius_m)
    }

    /// Pythagoras: a disc of 0.5 m that moves along x past a point 0.3 m aside and 2 m ahead touches it
    /// 0.4 m before.
    #[test]
    fn a_disc_touches_a_point_where_pythagoras_says() {
        let point = [[2.0, 0.3]];
        assert!((ray_of(&point, [0.0; 2], [1.0, 0.0], 0.5) - 1.6).abs() < 1e-15);
        // From 0.7 m farther on, 0.7 m less.
        assert!((ray_of(&point, [0.7, 0.0], [1.0, 0.0], 0.5) - 0.9).abs() < 1e-15);
        // Away from it, or past it: nothing.
        assert_eq!(ray_of(&point, [0.0; 2], [-1.0, 0.0], 0.5), f64::INFINITY);
        assert_eq!(ray_of(&point, [0.0; 2], [1.0, 0.0], 0.25), f64::INFINITY);
        assert_eq!(ray_of(&point, [0.0; 2], [0.0, 1.0], 0.5), f64::INFINITY);
    }

    /// 0.3 m from a point with a disc of 0.5 m: 0.2 m back to the edge.
    #[test]
    fn inside_a_disc_the_way_is_negative() {
        assert!((ray_of(&[[0.3, 0.0]], [0.0; 2], [1.0, 0.0], 0.5) + 0.2).abs() < 1e-15);
    }

    /// A point robot does not slip between points 5° apart.
    #[test]
    fn a_point_robot_meets_the_arc_everywhere() {
        let arc: Vec<[f64; 2]> = (-2..=2)
            .map(|i| 3.0_f64 * f64::from(i) * 5.0_f64.to_radians() / 3.0)
            .map(|a| [3.0 * libm::cos(a), 3.0 * libm::sin(a)])
            .collect();
        for tenth_deg in -100..=100 {
            let a = (f64::from(tenth_deg) * 0.1).to_radians();
            let free_m = ray_of(&arc, [0.0; 2], [libm::cos(a), libm::sin(a)], 0.0);
            let met = (3.0 * (1.0 - 0.045) - 1e-12..=3.0).contains(&free_m);
            assert!(met, "{tenth_deg}: {free_m}");
        }
    }

    /// Every direction of the circle falls into one of the 240, in order, each 0.9° to 2° wide.
    #[test]
    fn directions_go_round_once() {
        let mut previous = 0;
        let mut counts = [0_u32; DIRECTIONS];
        for i in 0..36_000 {
            let a = (f64::from(i) * 0.01).to_radians();
            let d = direction(libm::cos(a), libm::sin(a)).unwrap();
            assert!(d == previous || d == previous + 1, "{i}: {previous} {d}");
            previous = d;
            counts[d] += 1;
        }
        assert!(counts.iter().all(|count| (90..=200).contains(count)), "{counts:?}");
        assert_eq!(direction(f64::NAN, 1.0), None);
        assert_eq!(direction(f64::INFINITY, 1.0), None);
    }

    /// Of two points in one direction the nearer one counts; drawing nearer stops at the place.
    #[test]
    fn the_nearest_point_counts() {
        let mut scan = scan_of(&[[2.0, 0.001], [1.0, 0.001], [3.0, 0.001]]);
        assert_eq!(scan.points_m(), &[[1.0, 0.001]]);
        scan.clear();
        scan.see(&sight([0.0; 2], [0.0, 0.5], 0.2).unwrap());
        assert_eq!(scan.points_m(), &[[0.0, 0.3]]);
        assert_eq!(sight([0.0; 2], [0.0, 0.5], 0.9).unwrap().distance_m, 0.0);
    }
}
