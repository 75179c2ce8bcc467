//! The virtual scan: what a range finder at one place would see of the remembered points.

use super::ray::{LEAST_RADIUS_SHARE, Lane, Ray};

/// How many directions. They are equal steps of the pseudo-angle below, which are 0.95° wide along
/// the axes and 1.9° between them: 1.5° on average, as the echo map's prototype had it.
const DIRECTIONS: usize = 240;

/// The opposite direction is this many steps away, on either side.
const OPPOSITE: usize = DIRECTIONS / 2;

/// Sines and distances are compared with this slack, so that rounding never hides a point.
const SLACK: f64 = 1.0 - 1e-9;

/// The nearest point per direction about one place, for rays of one radius.
#[derive(Clone, Debug)]
pub(super) struct Scan {
    radius_m: f64,
    about_m: [f64; 2],
    /// Per direction; +∞ where there is none.
    nearest_m: [f64; DIRECTIONS],
    at_m: [[f64; 2]; DIRECTIONS],
    /// The points there are, in the order of their directions, how many, and how many come before each
    /// direction.
    seen: [[f64; 2]; DIRECTIONS],
    count: usize,
    before: [u8; DIRECTIONS + 1],
    /// How many steps off a ray's direction even the nearest point of all is out of its way.
    window: usize,
    /// For so many steps between a ray and a point, the least sine of the angle between them.
    least_sines: [f64; OPPOSITE + 1],
}

/// Where a point appears from the scan's place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    direction: usize,
    /// How far away it counts, metres.
    drawn_m: f64,
    /// How far away it is, and which way, metres.
    distance_m: f64,
    offset_m: [f64; 2],
}

impl Sighting {
    /// Position, metres, drawn nearer to the scan's place.
    pub(super) fn at_m(&self, about_m: [f64; 2]) -> [f64; 2] {
        let share = if self.distance_m > 0.0 { self.drawn_m / self.distance_m } else { 0.0 };
        let [dx, dy] = self.offset_m;
        [about_m[0] + share * dx, about_m[1] + share * dy]
    }

    /// The same point, drawn nearer by `by_m` instead.
    pub(super) fn drawn_by(&self, by_m: f64) -> Sighting {
        Sighting { drawn_m: (self.distance_m - by_m).max(0.0), ..*self }
    }
}

impl Scan {
    /// An empty scan for rays of discs of `radius_m`.
    pub(super) fn new(radius_m: f64) -> Scan {
        Scan {
            radius_m,
            about_m: [0.0; 2],
            nearest_m: [f64::INFINITY; DIRECTIONS],
            at_m: [[0.0; 2]; DIRECTIONS],
            seen: [[0.0; 2]; DIRECTIONS],
            count: 0,
            before: [0; DIRECTIONS + 1],
            window: 0,
            least_sines: std::array::from_fn(least_sine),
        }
    }

    /// Starts again, about another place.
    pub(super) fn clear(&mut self, about_m: [f64; 2]) {
        self.about_m = about_m;
        self.nearest_m = [f64::INFINITY; DIRECTIONS];
        self.count = 0;
    }

    pub(super) fn see(&mut self, sighting: &Sighting) {
        let Sighting { direction, drawn_m, .. } = *sighting;
        if drawn_m < self.nearest_m[direction] {
            self.nearest_m[direction] = drawn_m;
            self.at_m[direction] = sighting.at_m(self.about_m);
        }
    }

    /// Ends a round of [`Scan::see`]; now rays may be asked.
    pub(super) fn finish(&mut self) {
        let mut least_m = f64::INFINITY;
        let mut count = 0;
        for (direction, nearest_m) in self.nearest_m.iter().enumerate() {
            self.before[direction] = count as u8;
            // Where there is none the next one takes the place.
            self.seen[count] = self.at_m[direction];
            count += usize::from(*nearest_m < f64::INFINITY);
            least_m = if *nearest_m < least_m { *nearest_m } else { least_m };
        }
        self.before[DIRECTIONS] = count as u8;
        self.count = count;
        // A point at distance ρ, an angle α off a ray, is met only if ρ sin α is less than the radius.
        let met =
            |sine: &&f64| **sine <= LEAST_RADIUS_SHARE || least_m * **sine * SLACK < self.radius_m;
        self.window = self.least_sines.iter().take_while(met).count();
    }

    /// The place that it is about, metres.
    pub(super) fn about_m(&self) -> [f64; 2] {
        self.about_m
    }

    /// The nearest points, metres, world frame, in the order of their directions.
    pub(super) fn points_m(&self) -> &[[f64; 2]] {
        &self.seen[..self.count]
    }

    /// Free travel of the scan's disc from `from_m` along the unit vector `along`, see
    /// [`Ray::free_m`].
    pub(super) fn free_m(&self, from_m: [f64; 2], along: [f64; 2]) -> f64 {
        let ray = Ray { from_m, along, radius_m: self.radius_m };
        let [first_m, second_m] = self.about(from_m, along);
        ray.free_m(first_m).min(ray.free_m(second_m))
    }

    /// Free travel of a lane that is no wider than the scan's disc, see [`Lane::free_m`].
    pub(super) fn travel_m(&self, lane: &Lane) -> f64 {
        let [first_m, second_m] = self.about(lane.from_m, lane.along);
        lane.free_m(first_m).min(lane.free_m(second_m))
    }

    /// The points that a disc of the scan's radius may meet on its way from `from_m` along the unit vector
    /// `along`, in two parts.
    fn about(&self, from_m: [f64; 2], along: [f64; 2]) -> [&[[f64; 2]]; 2] {
        let all = [self.points_m(), &[]];
        let (Some(ahead), true) = (direction(along[0], along[1]), from_m == self.about_m) else {
            return all;
        };
        if self.window >= OPPOSITE {
            return all;
        }
        let within = |from: usize, to: usize| {
            &self.seen[usize::from(self.before[from])..usize::from(self.before[to])]
        };
        // From `window` steps to the right to as many to the left, both included.
        let (first, end) = (ahead + DIRECTIONS - self.window, ahead + self.window + 1);
        if first < DIRECTIONS {
            [within(first, DIRECTIONS), within(0, end)]
        } else if end > DIRECTIONS {
            [within(first - DIRECTIONS, DIRECTIONS), within(0, end - DIRECTIONS)]
        } else {
            [within(first - DIRECTIONS, end), &[]]
        }
    }
}

/// The least sine of the angle between two vectors whose directions are `steps` apart; 1 from a right
/// angle on, beyond which only a point inside the disc is met.
///
/// Vectors in directions n apart differ by more than n − 1 steps of pseudo-angle. A difference of 2δ
/// is least in true angle when it lies evenly about an axis, where tan = δ/(1 − δ) on either side; and
/// sin 2x = 2 tan x/(1 + tan² x).
fn least_sine(steps: usize) -> f64 {
    let whole = steps.saturating_sub(1) as f64 / (DIRECTIONS / 4) as f64;
    if whole >= 1.0 {
        return 1.0;
    }
    let half = 0.5 * whole;
    let tangent = half / (1.0 - half);
    2.0 * tangent / (1.0 + tangent * tangent)
}

/// How many points are sighted at once.
pub(super) const AT_ONCE: usize = 16;

/// [`sight`] for several points.
pub(super) fn sight_all(
    about_m: [f64; 2],
    points_m: &[[f64; 2]; AT_ONCE],
    by_m: &[f64; AT_ONCE],
) -> [Option<Sighting>; AT_ONCE] {
    let offsets_m = points_m.map(|[x, y]| [x - about_m[0], y - about_m[1]]);
    let distances_m = offsets_m.map(|[dx, dy]| (dx * dx + dy * dy).sqrt());
    let steps = offsets_m.map(|[dx, dy]| steps(dx, dy));
    std::array::from_fn(|i| {
        let [dx, dy] = offsets_m[i];
        (dx.abs() + dy.abs()).is_finite().then(|| Sighting {
            direction: step_of(steps[i]),
            drawn_m: (distances_m[i] - by_m[i]).max(0.0),
            distance_m: distances_m[i],
            offset_m: offsets_m[i],
        })
    })
}

/// Draws a point nearer to `about_m` by `by_m` and says where it then appears. `None` if it is no
/// number.
pub(super) fn sight(about_m: [f64; 2], point_m: [f64; 2], by_m: f64) -> Option<Sighting> {
    let [dx, dy] = [point_m[0] - about_m[0], point_m[1] - about_m[1]];
    let distance_m = (dx * dx + dy * dy).sqrt();
    Some(Sighting {
        direction: direction(dx, dy)?,
        drawn_m: (distance_m - by_m).max(0.0),
        distance_m,
        offset_m: [dx, dy],
    })
}

/// Which direction a vector points in, by a pseudo-angle that needs no arctangent: y/(|x|+|y|) in the
/// first quadrant, 1 − x/(|x|+|y|) in the second, and so on around. `None` if the vector is no number.
fn direction(x: f64, y: f64) -> Option<usize> {
    (x.abs() + y.abs()).is_finite().then(|| step_of(steps(x, y)))
}

/// The direction as a number of steps with its fraction; NaN for no vector at all.
fn steps(x: f64, y: f64) -> f64 {
    // Chosen, not branched to: points lie in any quadrant, and several are reckoned at once.
    let (behind, right) = (x < 0.0, y < 0.0);
    let part = if behind == right { y } else { x } / (x.abs() + y.abs());
    let start = if behind {
        if right { 2.0 } else { 1.0 }
    } else if right {
        3.0
    } else {
        0.0
    };
    (start + if behind { -part } else { part }) * (DIRECTIONS / 4) as f64
}

/// The direction of so many steps; 0 for NaN.
fn step_of(steps: f64) -> usize {
    // A quotient may round up to the next quadrant's start, and the last to a whole turn.
    (steps as i32 as usize).min(DIRECTIONS - 1)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::beam::unit;
    use super::*;

    fn scan_of(points_m: &[[f64; 2]], about_m: [f64; 2], radius_m: f64) -> Scan {
        let mut scan = Scan::new(radius_m);
        scan.clear(about_m);
        for point_m in points_m {
            scan.see(&sight(about_m, *point_m, 0.0).unwrap());
        }
        scan.finish();
        scan
    }

    proptest! {
        /// From the scan's own place only the points about the ray are asked; that misses nothing.
        #[test]
        fn the_window_hides_nothing(
            points in prop::collection::vec(prop::array::uniform2(-3.0..3.0), 0..200),
            about_m in prop::array::uniform2(-1.0..1.0),
            clear_m in 0.0..1.5,
            angle_rad in -4.0..4.0,
            radius_m in prop_oneof![Just(0.0), Just(0.354), 0.0..1.0],
        ) {
            let away = |p: &[f64; 2]| libm::hypot(p[0] - about_m[0], p[1] - about_m[1]) >= clear_m;
            let points: Vec<[f64; 2]> = points.into_iter().filter(away).collect();
            let scan = scan_of(&points, about_m, radius_m);
            let ray = Ray { from_m: about_m, along: unit(angle_rad), radius_m };
            prop_assert_eq!(scan.free_m(about_m, ray.along), ray.free_m(scan.points_m()));
            // No wider than the disc, whatever its length.
            for half_m in [[0.0, radius_m], [0.3, 0.7 * radius_m]] {
                let lane = Lane { from_m: about_m, along: ray.along, half_m };
                prop_assert_eq!(scan.travel_m(&lane), lane.free_m(scan.points_m()));
            }
        }
    }

    /// No two vectors are nearer in angle than their directions let on.
    #[test]
    fn steps_bound_the_angle() {
        let direction_of = |i: u32| {
            let [x, y] = unit((f64::from(i) * 0.25).to_radians());
            direction(x, y).unwrap()
        };
        for i in 0..1440 {
            for j in 0..=360 {
                let (a, b) = (direction_of(i), direction_of(i + j));
                let steps = (b + DIRECTIONS - a) % DIRECTIONS;
                let sine = libm::sin((f64::from(j) * 0.25).to_radians());
                assert!(sine >= least_sine(steps) - 1e-12, "{i} {j} {steps}");
            }
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
        let mut scan = scan_of(&[[2.0, 0.001], [1.0, 0.001], [3.0, 0.001]], [0.0; 2], 0.354);
        assert_eq!(scan.points_m(), &[[1.0, 0.001]]);
        scan.clear([0.0; 2]);
        scan.see(&sight([0.0; 2], [0.0, 0.5], 0.2).unwrap());
        scan.finish();
        assert_eq!(scan.points_m(), &[[0.0, 0.3]]);
        assert_eq!(sight([0.0; 2], [0.0, 0.5], 0.9).unwrap().drawn_m, 0.0);
    }
}
