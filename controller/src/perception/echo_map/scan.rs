//! The virtual scan: what a range finder at one place would see of the remembered points.

use super::ray::{Bump, LEAST_RADIUS_SHARE, Lane, Ray};
use super::sightings::{DIRECTIONS, NOWHERE, Sightings, direction};

/// The opposite direction is this many steps away, on either side.
const OPPOSITE: usize = DIRECTIONS / 2;

/// Sines and distances are compared with this slack, so that rounding never hides a point.
const SLACK: f64 = 1.0 - 1e-9;

/// No sighting.
const NONE: u16 = u16::MAX;

/// The nearest point per direction about one place, for rays of one radius.
#[derive(Clone, Debug)]
pub(super) struct Scan {
    radius_m: f64,
    about_m: [f64; 2],
    /// Per direction how far away the nearest one counts, metres, +∞ where there is none; and which of the
    /// sightings it is. The last place is that of what is nowhere.
    nearest_m: [f64; DIRECTIONS + 1],
    nearest: [u16; DIRECTIONS + 1],
    /// The points there are, in the order of their directions, metres, world frame and about the scan's
    /// place; and how many come before each direction.
    seen: [[f64; 2]; DIRECTIONS],
    bumps: [Bump; DIRECTIONS],
    count: usize,
    before: [u8; DIRECTIONS + 1],
    /// How many steps off a ray's direction even the nearest point of all is out of its way.
    window: usize,
    /// For so many steps between a ray and a point, the least sine of the angle between them.
    least_sines: [f64; OPPOSITE + 1],
}

impl Scan {
    /// An empty scan for rays of discs of `radius_m`.
    pub(super) fn new(radius_m: f64) -> Scan {
        Scan {
            radius_m,
            about_m: [0.0; 2],
            nearest_m: [f64::INFINITY; DIRECTIONS + 1],
            nearest: [NONE; DIRECTIONS + 1],
            seen: [[0.0; 2]; DIRECTIONS],
            bumps: [Bump { offset_m: [0.0; 2], radius_m2: 0.0 }; DIRECTIONS],
            count: 0,
            before: [0; DIRECTIONS + 1],
            window: 0,
            least_sines: std::array::from_fn(least_sine),
        }
    }

    /// Starts again, about the place of some sightings, each of which counts as so many metres away. Now
    /// rays may be asked.
    pub(super) fn take(&mut self, sightings: &Sightings, drawn_m: &[f64]) {
        self.nearest_m.fill(f64::INFINITY);
        self.nearest.fill(NONE);
        for (index, (direction, drawn_m)) in (0..).zip(sightings.directions().iter().zip(drawn_m)) {
            self.see(index, usize::from(*direction), *drawn_m);
        }
        self.finish(sightings);
    }

    /// Takes the sighting `index`, which counts as `drawn_m` away, metres.
    fn see(&mut self, index: u16, direction: usize, drawn_m: f64) {
        // Chosen, not branched to: nobody can tell beforehand which is nearer.
        let nearest_m = self.nearest_m[direction];
        let nearer = drawn_m < nearest_m;
        self.nearest_m[direction] = if nearer { drawn_m } else { nearest_m };
        self.nearest[direction] = if nearer { index } else { self.nearest[direction] };
    }

    /// Puts what was seen in order.
    fn finish(&mut self, sightings: &Sightings) {
        self.about_m = sightings.about_m();
        let mut occupied = [0; DIRECTIONS];
        let mut count = 0;
        for (direction, index) in self.nearest[..NOWHERE].iter().enumerate() {
            self.before[direction] = count as u8;
            // Where there is none the next one takes the place.
            occupied[count] = direction as u8;
            count += usize::from(*index != NONE);
        }
        self.before[DIRECTIONS] = count as u8;
        self.count = count;
        let mut least_m = f64::INFINITY;
        let seen = self.seen.iter_mut().zip(&mut self.bumps);
        for (direction, (seen, bump)) in occupied[..count].iter().zip(seen) {
            let drawn_m = self.nearest_m[usize::from(*direction)];
            let index = usize::from(self.nearest[usize::from(*direction)]);
            *seen = sightings.at_m(index, drawn_m);
            *bump = Bump::about(*seen, self.about_m, self.radius_m);
            least_m = if drawn_m < least_m { drawn_m } else { least_m };
        }
        // A point at distance ρ, an angle α off a ray, is met only if ρ sin α is less than the radius.
        let met =
            |sine: &&f64| **sine <= LEAST_RADIUS_SHARE || least_m * **sine * SLACK < self.radius_m;
        self.window = self.least_sines.iter().take_while(met).count();
    }

    /// The nearest points, metres, world frame, in the order of their directions.
    pub(super) fn points_m(&self) -> &[[f64; 2]] {
        &self.seen[..self.count]
    }

    /// Free travel of the scan's disc from `from_m` along the unit vector `along`, see
    /// [`Ray::free_m`].
    pub(super) fn free_m(&self, from_m: [f64; 2], along: [f64; 2]) -> f64 {
        if from_m != self.about_m {
            return Ray { from_m, along, radius_m: self.radius_m }.free_m(self.points_m());
        }
        self.about(along)
            .map(|some| Ray::free_among_m(along, some.iter().copied()))
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    }

    /// Free travel of a lane that is no wider than the scan's disc, see [`Lane::free_m`].
    pub(super) fn travel_m(&self, lane: &Lane) -> f64 {
        if lane.from_m != self.about_m {
            return lane.free_m(self.points_m());
        }
        self.about(lane.along)
            .map(|some| lane.free_among_m(some.iter().map(|bump| bump.offset_m)))
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    }

    /// What a disc of the scan's radius may meet on its way from the scan's place along the unit vector
    /// `along`, in two parts.
    fn about(&self, along: [f64; 2]) -> [&[Bump]; 2] {
        let ahead = direction(along[0], along[1]);
        if ahead == NOWHERE || self.window >= OPPOSITE {
            return [&self.bumps[..self.count], &[]];
        }
        let within = |from: usize, to: usize| {
            &self.bumps[usize::from(self.before[from])..usize::from(self.before[to])]
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::beam::unit;
    use super::super::doubt::FiringDoubt;
    use super::super::points::Points;
    use super::*;

    fn scan_of(points_m: &[[f64; 2]], about_m: [f64; 2], radius_m: f64) -> Scan {
        let mut sightings = Sightings::new();
        let doubt = FiringDoubt::NONE;
        sightings.take(&Points::at(points_m), about_m, |_| doubt);
        let mut scan = Scan::new(radius_m);
        scan.take(&sightings, sightings.drawn_m());
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
            direction(x, y)
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

    /// Of two points in one direction the nearer one counts, whatever came before.
    #[test]
    fn the_nearest_point_counts() {
        let scan = scan_of(&[[2.0, 0.001], [1.0, 0.001], [3.0, 0.001]], [0.0; 2], 0.354);
        assert_eq!(scan.points_m(), &[[1.0, 0.001]]);
    }

    /// What is no number is nowhere, and does not count.
    #[test]
    fn no_number_is_no_point() {
        let scan = scan_of(&[[f64::NAN, 0.0], [0.0, 1.0], [f64::INFINITY, 0.0]], [0.0; 2], 0.354);
        assert_eq!(scan.points_m(), &[[0.0, 1.0]]);
    }
}
