//! Where the remembered points appear from one place, and how much nearer each of them counts.

use super::doubt::FiringDoubt;
use super::firings::Firing;
use super::points::Points;

/// How many directions. They are equal steps of the pseudo-angle below, which are 0.95° wide along
/// the axes and 1.9° between them: 1.5° on average, as the echo map's prototype had it.
pub(super) const DIRECTIONS: usize = 240;

/// The direction of what is no number.
pub(super) const NOWHERE: usize = DIRECTIONS;

/// Nothing is drawn nearer to the place than this, metres: it keeps its direction, and a way towards it is
/// never free.
const NEAREST_M: f64 = 1e-3;

/// The points about one place, one number of each kind for each, in their order: the same is reckoned for
/// several at once.
#[derive(Clone, Debug)]
pub(super) struct Sightings {
    about_m: [f64; 2],
    /// Which way and how far away each is, metres.
    dx_m: Vec<f64>,
    dy_m: Vec<f64>,
    distance_m: Vec<f64>,
    direction: Vec<u8>,
    /// How much nearer each counts, metres: for the safety layer, −∞ where that passes it over …
    nearer_m: Vec<f64>,
    moves: Vec<bool>,
    /// … and for the law, −∞ where that does not see it.
    law_nearer_m: Vec<f64>,
    /// How far away each counts then, metres; +∞ where it is not seen.
    drawn_m: Vec<f64>,
    law_drawn_m: Vec<f64>,
    /// By firing, what its points' doubts are.
    doubts: Vec<Doubted>,
}

/// The numbers above of points of one firing.
#[derive(Clone, Copy, Debug)]
struct Doubted {
    /// Of those that do not stand, and of those that do.
    nearer_m: [f64; 2],
    moves: [bool; 2],
    /// Of the unconfirmed, and of the confirmed.
    law_nearer_m: [f64; 2],
}

impl Doubted {
    fn of(doubt: FiringDoubt) -> Doubted {
        let by_standing = [false, true].map(|stands| doubt.of(stands));
        Doubted {
            nearer_m: by_standing.map(|doubt| doubt.nearer_m()),
            moves: by_standing.map(|doubt| doubt.moves),
            law_nearer_m: [f64::NEG_INFINITY, doubt.stands_m],
        }
    }
}

impl Sightings {
    /// None yet.
    pub(super) fn new() -> Sightings {
        let room = || Vec::with_capacity(Points::CAPACITY);
        Sightings {
            about_m: [0.0; 2],
            dx_m: room(),
            dy_m: room(),
            distance_m: room(),
            direction: Vec::with_capacity(Points::CAPACITY),
            nearer_m: room(),
            moves: Vec::with_capacity(Points::CAPACITY),
            law_nearer_m: room(),
            drawn_m: room(),
            law_drawn_m: room(),
            doubts: Vec::with_capacity(Points::FIRINGS),
        }
    }

    /// Sights `points` from `about_m`; the law sees the confirmed ones alone, and does not reckon with what
    /// moves.
    pub(super) fn take(
        &mut self,
        points: &Points,
        about_m: [f64; 2],
        doubt: impl Fn(&Firing) -> FiringDoubt,
    ) {
        self.about_m = about_m;
        let count = points.as_slice().len();
        let doubted = |firing: &Firing| Doubted::of(doubt(firing));
        refill(&mut self.doubts, points.firings().iter().map(doubted));
        self.nearer_m.resize(count, 0.0);
        self.law_nearer_m.resize(count, 0.0);
        self.moves.resize(count, false);
        let columns = self.nearer_m.iter_mut().zip(&mut self.law_nearer_m).zip(&mut self.moves);
        for ((firing, kind), ((nearer_m, law_nearer_m), moves)) in points.kinds().zip(columns) {
            let doubted = &self.doubts[firing];
            let stands = usize::from(kind.stands());
            let nearer = doubted.nearer_m[stands];
            *nearer_m = if kind.counts() { nearer } else { f64::NEG_INFINITY };
            *moves = doubted.moves[stands];
            *law_nearer_m = doubted.law_nearer_m[usize::from(kind.confirmed())];
        }
        let [x_m, y_m] = points.places_m();
        refill(&mut self.dx_m, x_m.iter().map(|x_m| x_m - about_m[0]));
        refill(&mut self.dy_m, y_m.iter().map(|y_m| y_m - about_m[1]));
        let offsets_m = || self.dx_m.iter().zip(&self.dy_m);
        let distances_m = offsets_m().map(|(dx, dy)| (dx * dx + dy * dy).sqrt());
        refill(&mut self.distance_m, distances_m);
        refill(&mut self.direction, offsets_m().map(|(dx, dy)| direction(*dx, *dy) as u8));
        let drawn = |(distance_m, nearer_m): (&f64, &f64)| drawn_m(*distance_m, *nearer_m);
        refill(&mut self.drawn_m, self.distance_m.iter().zip(&self.nearer_m).map(drawn));
        refill(&mut self.law_drawn_m, self.distance_m.iter().zip(&self.law_nearer_m).map(drawn));
    }

    /// The place that they are about, metres.
    pub(super) fn about_m(&self) -> [f64; 2] {
        self.about_m
    }

    /// In which direction each appears.
    pub(super) fn directions(&self) -> &[u8] {
        &self.direction
    }

    /// How far away each counts for the safety layer, metres.
    pub(super) fn drawn_m(&self) -> &[f64] {
        &self.drawn_m
    }

    /// The same for the law; +∞ where that does not see it.
    pub(super) fn law_drawn_m(&self) -> &[f64] {
        &self.law_drawn_m
    }

    /// How far away the nearest counts for the safety layer, metres; +∞ without any.
    pub(super) fn least_m(&self) -> f64 {
        if self.direction.contains(&(NOWHERE as u8)) {
            let somewhere = |(direction, _): &(&u8, &f64)| usize::from(**direction) != NOWHERE;
            let seen = self.direction.iter().zip(&self.drawn_m).filter(somewhere);
            return seen.map(|(_, drawn_m)| *drawn_m).fold(f64::INFINITY, lesser);
        }
        // Several at once.
        let (some, rest) = self.drawn_m.as_chunks::<8>();
        let mut least_m = [f64::INFINITY; 8];
        for drawn_m in some {
            least_m = std::array::from_fn(|i| lesser(least_m[i], drawn_m[i]));
        }
        least_m.into_iter().chain(rest.iter().copied()).fold(f64::INFINITY, lesser)
    }

    /// How much nearer each counts for the safety layer, metres, and whether it may be on its way.
    pub(super) fn doubts(&self) -> impl Iterator<Item = (f64, bool)> {
        self.nearer_m.iter().copied().zip(self.moves.iter().copied())
    }

    /// Where one is, metres, world frame, once drawn to `drawn_m` from the place that they are about.
    pub(super) fn at_m(&self, index: usize, drawn_m: f64) -> [f64; 2] {
        let offset_m = [self.dx_m[index], self.dy_m[index]];
        drawn_to(self.about_m, offset_m, self.distance_m[index], drawn_m)
    }
}

/// The lesser of two numbers; the first where the second is none.
fn lesser(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// Puts other numbers in the place of those there are.
fn refill<T>(column: &mut Vec<T>, with: impl Iterator<Item = T>) {
    column.clear();
    column.extend(with);
}

/// How far away a point counts that counts nearer than it is, metres.
fn drawn_m(distance_m: f64, nearer_m: f64) -> f64 {
    // Written so that one instruction each does: what is no number gives the other one.
    let least_m = if distance_m < NEAREST_M { distance_m } else { NEAREST_M };
    let left_m = distance_m - nearer_m;
    if left_m > least_m { left_m } else { least_m }
}

/// A point `offset_m` and `distance_m` from `about_m`, once drawn to `drawn_m` from there, metres.
fn drawn_to(about_m: [f64; 2], [dx, dy]: [f64; 2], distance_m: f64, drawn_m: f64) -> [f64; 2] {
    let share = if distance_m > 0.0 { drawn_m / distance_m } else { 0.0 };
    [about_m[0] + share * dx, about_m[1] + share * dy]
}

/// Draws one point nearer to `about_m` by `by_m`: where it appears then, metres, world frame. `None` if it
/// is no number.
pub(super) fn drawn_nearer_m(about_m: [f64; 2], point_m: [f64; 2], by_m: f64) -> Option<[f64; 2]> {
    let offset_m = [point_m[0] - about_m[0], point_m[1] - about_m[1]];
    let [dx, dy] = offset_m;
    let distance_m = (dx * dx + dy * dy).sqrt();
    let drawn_m = drawn_m(distance_m, by_m);
    (dx.abs() + dy.abs()).is_finite().then(|| drawn_to(about_m, offset_m, distance_m, drawn_m))
}

/// Which direction a vector points in, by a pseudo-angle that needs no arctangent: y/(|x|+|y|) in the
/// first quadrant, 1 − x/(|x|+|y|) in the second, and so on around. [`NOWHERE`] if the vector is no number.
pub(super) fn direction(x: f64, y: f64) -> usize {
    // Chosen, not branched to: points lie in any quadrant, and several are reckoned at once.
    let (behind, right) = (x < 0.0, y < 0.0);
    let sum = x.abs() + y.abs();
    let part = if behind == right { y } else { x } / sum;
    let start = if behind {
        if right { 2.0 } else { 1.0 }
    } else if right {
        3.0
    } else {
        0.0
    };
    let steps = (start + if behind { -part } else { part }) * (DIRECTIONS / 4) as f64;
    // A quotient may round up to the next quadrant's start, and the last to a whole turn; no vector at all
    // has none.
    let last = (DIRECTIONS - 1) as f64;
    let within = if steps < last { steps } else { last };
    let direction = if sum > 0.0 { within } else { 0.0 };
    whole(if sum < f64::INFINITY { direction } else { NOWHERE as f64 }) as usize
}

/// The whole part of a number from 0 to 2³¹: as a conversion gives it, but several at once.
fn whole(number: f64) -> u32 {
    // Adding this rounds to a whole number and leaves that in the lowest bits.
    const ROUNDING: f64 = 4_503_599_627_370_496.0;
    let rounded = number + ROUNDING;
    let up = rounded - ROUNDING > number;
    (rounded.to_bits() as u32).wrapping_sub(u32::from(up))
}

#[cfg(test)]
mod tests {
    use super::super::beam::unit;
    use super::*;

    /// Every direction of the circle falls into one of the 240, in order, each 0.9° to 2° wide.
    #[test]
    fn directions_go_round_once() {
        let mut previous = 0;
        let mut counts = [0_u32; DIRECTIONS];
        for i in 0..36_000 {
            let [x, y] = unit((f64::from(i) * 0.01).to_radians());
            let d = direction(x, y);
            assert!(d == previous || d == previous + 1, "{i}: {previous} {d}");
            previous = d;
            counts[d] += 1;
        }
        assert!(counts.iter().all(|count| (90..=200).contains(count)), "{counts:?}");
        assert_eq!(direction(0.0, 0.0), 0);
        for (x, y) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::INFINITY, 1.0), (f64::MAX, f64::MAX)]
        {
            assert_eq!(direction(x, y), NOWHERE);
        }
    }

    /// The nearest counts, drawn nearer by nothing here; what is no number is nowhere and does not.
    #[test]
    fn the_least_is_that_of_the_nearest() {
        let least_m = |points_m: &[[f64; 2]]| {
            let mut sightings = Sightings::new();
            sightings.take(&Points::at(points_m), [1.0, 0.0], |_| FiringDoubt::NONE);
            sightings.least_m()
        };
        assert_eq!(least_m(&[]), f64::INFINITY);
        let ring: Vec<[f64; 2]> = (0..21).map(|i| [1.0, 5.0 + f64::from(i)]).collect();
        for nearest in 0..ring.len() {
            let mut points_m = ring.clone();
            points_m[nearest] = [1.0, -0.75];
            assert_eq!(least_m(&points_m), 0.75, "{nearest}");
            points_m[(nearest + 7) % ring.len()] = [f64::NAN, 0.0];
            assert_eq!(least_m(&points_m), 0.75, "{nearest}");
            points_m[nearest] = [f64::INFINITY, 0.0];
            let left = points_m.iter().map(|[_, y_m]| *y_m).filter(|y_m| *y_m > 0.0);
            assert_eq!(least_m(&points_m), left.fold(f64::INFINITY, f64::min), "{nearest}");
        }
    }

    #[test]
    fn the_whole_part_is_that_of_a_conversion() {
        let numbers = (0..10_000).map(|i| 0.0317 * f64::from(i));
        let edges = (0..300).flat_map(|i| {
            let edge = f64::from(i);
            [edge, edge.next_up(), edge.next_down().max(0.0), edge + 0.5]
        });
        for number in numbers.chain(edges).chain([f64::from(i32::MAX) + 0.5]) {
            assert_eq!(whole(number), number as u32, "{number}");
        }
    }

    /// Drawing nearer stops before the place, or the point would lie in no direction any more.
    #[test]
    fn what_is_drawn_nearer_stays_in_its_direction() {
        assert_eq!(drawn_nearer_m([0.0; 2], [0.0, 0.5], 0.2), Some([0.0, 0.3]));
        assert_eq!(drawn_nearer_m([1.0, 2.0], [1.0, 2.5], 0.9), Some([1.0, 2.001]));
        assert_eq!(drawn_nearer_m([0.0; 2], [0.0, 5e-4], 0.2), Some([0.0, 5e-4]));
        assert_eq!(drawn_nearer_m([1.0, 2.0], [1.0, 2.0], 0.9), Some([1.0, 2.0]));
        assert_eq!(drawn_nearer_m([0.0; 2], [f64::NAN, 0.5], 0.2), None);
    }
}
