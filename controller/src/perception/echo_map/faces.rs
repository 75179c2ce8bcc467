//! Which way the nearest face looks: a Hough transform of the remembered points.
//!
//! Every point votes for each line through it: direction of the line's normal by 5°, distance of the
//! line from the robot by 5 cm. A face is where many points agree; near faces count more than far
//! ones. An arc's wrong points vote too, but they agree on nothing.

use schemas::{Span, Time};

use super::beam::unit;
use super::points::Points;

/// Directions of a normal around the circle: 5° each (prototype).
const DIRECTIONS: usize = 72;

/// Half of them: the opposite direction has the opposite sign.
const HALF: usize = DIRECTIONS / 2;

/// Distances of a face: 5 cm each, up to 2.5 m (prototype).
const CELL_M: f64 = 0.05;
const CELLS: usize = 50;

/// Votes are counted in whole numbers, which is fast and has no order: points in this many units per
/// metre, normals in this many per 1. Products and their sums stay below 2²⁴, so that 32-bit floats, of
/// which a processor multiplies several at once, hold them exactly.
const UNITS_PER_M: f64 = 1024.0;
const UNITS_PER_1: f64 = 1024.0;
const UNITS_PER_CELL: u32 = (CELL_M * UNITS_PER_M * UNITS_PER_1) as u32;

/// Adding this to a float from 0 to 2²² rounds it to a whole number and leaves that in its lowest bits.
const ROUNDING: f32 = 12_582_912.0;

/// A cell has 52,428 units, so quotients are 1.9e-5 apart: taking off half of 1, but for half of that, and
/// rounding gives the whole part.
const TO_WHOLE: f32 = 0.5 - 0.9e-5;

/// Points older than this, or heard from farther away than this, metres, have no vote
/// (prototype).
const LIFE: Span = Span(3_000_000_000);
const REACH_M: f64 = 2.5;

/// Points farther than this from the robot, along either axis, metres, have no vote either: what was
/// heard from 2.5 m away and has since been left behind at the fastest speed for 3 s is nearer.
const FARTHEST_M: f64 = 10.0;

/// How many points must agree, within 10 cm. Fewer let an arc's wrong points pass for a face; more lose
/// faces that have been looked at only briefly.
const LEAST_SUPPORT: i16 = 10;

/// A face at distance d weighs 1/(0.5 m + d): at 2 m a fifth of what it weighs underfoot.
const NEAR_M: f64 = 0.5;

/// … also in whole numbers, of this many per 1/m, and with this support at most, so that a weight fits
/// into 16 bits.
const WEIGHT_UNITS: f64 = 29.0;
const MOST_SUPPORT: i16 = 500;

/// How many neighbouring directions on either side share in the refined angle.
const SPREAD: usize = 2;

/// A row of votes: the cells of a direction, those of the opposite one before them, outwards, and at either end
/// a place for what is farther away.
const ROW: usize = 2 * (CELLS + 1);

/// Where the cells of a row's own direction begin.
const AHEAD: usize = CELLS + 1;

/// Pairs of neighbouring cells, of which there are as many as cells, are weighed eight at once: these are as
/// many, and six more that weigh nothing.
const PAIRS: usize = CELLS.next_multiple_of(8);

/// How many points vote at once.
const AT_ONCE: usize = 16;

/// The transform's constant tables.
#[derive(Clone, Debug)]
pub(super) struct Faces {
    normals_x: [f32; HALF],
    normals_y: [f32; HALF],
    /// Where the votes of a direction start, those behind left out.
    rows: [u32; HALF],
    /// By pair of cells: in the order of a direction's cells, and of an opposite one's; then 0.
    weights: [i16; PAIRS],
    opposite_weights: [i16; PAIRS],
}

/// The votes of all directions, row by row; as many places as a mask of bits can tell.
#[derive(Clone, Debug)]
struct Votes([i16; Votes::PLACES]);

impl Votes {
    const PLACES: usize = (HALF * ROW).next_power_of_two();

    /// The row that a direction shares with its opposite.
    fn row(&self, direction: usize) -> &[i16; ROW] {
        let (rows, _) = self.0.as_chunks();
        &rows[direction % HALF]
    }

    /// How many points lie within a cell and its next: a line on the edge of a cell is not split.
    fn support(&self, direction: usize, cell: usize) -> i16 {
        let row = self.row(direction);
        if direction < HALF {
            row[AHEAD + cell] + row[AHEAD + cell + 1]
        } else {
            row[AHEAD - 1 - cell] + row[AHEAD - 2 - cell]
        }
    }
}

impl Faces {
    pub(super) fn new() -> Faces {
        let normals: [[f32; 2]; HALF] = std::array::from_fn(|i| {
            unit(angle_rad(i as f64)).map(|x| libm::round(UNITS_PER_1 * x) as f32)
        });
        let weight = |cell: usize| {
            let distance_m = CELL_M * (cell + 1) as f64;
            libm::round(WEIGHT_UNITS / (NEAR_M + distance_m)) as i16
        };
        let paired = |weight: &dyn Fn(usize) -> i16| {
            std::array::from_fn(|pair| if pair < CELLS { weight(pair) } else { 0 })
        };
        Faces {
            normals_x: normals.map(|[x, _]| x),
            normals_y: normals.map(|[_, y]| y),
            rows: std::array::from_fn(|i| (i * ROW + AHEAD) as u32),
            weights: paired(&weight),
            opposite_weights: paired(&|pair| weight(CELLS - 1 - pair)),
        }
    }

    /// World angle from `from_m` square into the nearest face, radians, from −π to π; `None` where too
    /// few points agree.
    pub(super) fn nearest_rad(&self, points: &Points, from_m: [f64; 2], now: Time) -> Option<f64> {
        let mut votes = Votes([0; Votes::PLACES]);
        self.count(points, from_m, now, &mut votes);
        let (best, cell) = self.heaviest(&votes)?;
        Some(refined_rad(&votes, best, cell))
    }

    /// Lets the points vote.
    fn count(&self, points: &Points, from_m: [f64; 2], now: Time, votes: &mut Votes) {
        let mut have_votes = [false; Points::FIRINGS];
        for (has_votes, firing) in have_votes.iter_mut().zip(points.firings()) {
            *has_votes = (firing.range_m <= REACH_M) & (now.since(firing.fired) <= LIFE);
        }
        let [x_m, y_m] = points.places_m();
        // Who votes first, without branches: nobody can tell beforehand.
        let mut who = [0_u16; Points::CAPACITY];
        let mut count = 0;
        for (index, ((firing, kind), (x_m, y_m))) in
            (0..).zip(points.kinds().zip(x_m.iter().zip(y_m)))
        {
            let near =
                ((x_m - from_m[0]).abs() <= FARTHEST_M) & ((y_m - from_m[1]).abs() <= FARTHEST_M);
            who[count] = index;
            count += usize::from(kind.confirmed() & have_votes[firing] & near);
        }
        let mut places = [[0; HALF]; AT_ONCE];
        for who in who[..count].chunks(AT_ONCE) {
            let mut voters = [[0.0; 2]; AT_ONCE];
            for (voter, index) in voters.iter_mut().zip(who) {
                let index = usize::from(*index);
                let offset_m = [x_m[index] - from_m[0], y_m[index] - from_m[1]];
                *voter = offset_m.map(|metres| (UNITS_PER_M * metres) as i32 as f32);
            }
            self.vote(&voters[..who.len()], &mut places, votes);
        }
        for row in votes.0.as_chunks_mut::<ROW>().0 {
            [row[0], row[ROW - 1]] = [0; 2];
        }
    }

    /// Lets some points vote; `places` are where their votes go.
    fn vote(&self, voters: &[[f32; 2]], places: &mut [[u32; HALF]; AT_ONCE], votes: &mut Votes) {
        // All places first: many are reckoned at once.
        for (places, voter) in places.iter_mut().zip(voters) {
            self.find(*voter, places);
        }
        for place in places[..voters.len()].as_flattened() {
            votes.0[*place as usize % Votes::PLACES] += 1;
        }
    }

    /// Finds where a point's votes go: one per direction, or the opposite one.
    // Inlined into a loop over points it is reckoned for two of these at once, not for many directions.
    #[inline(never)]
    fn find(&self, [x, y]: [f32; 2], places: &mut [u32; HALF]) {
        for (i, place) in places.iter_mut().enumerate() {
            let distance = x * self.normals_x[i] + y * self.normals_y[i];
            *place = self.rows[i].wrapping_add(place_of(distance));
        }
    }

    /// The direction and the cell, together with its next, that carry most weight; `None` if even they
    /// have too little support.
    fn heaviest(&self, votes: &Votes) -> Option<(usize, usize)> {
        let (mut best, mut best_weight) = (0, 0);
        for opposite in [false, true] {
            for i in 0..HALF {
                let (begin, weights) = if opposite {
                    (i * ROW, &self.opposite_weights)
                } else {
                    (i * ROW + AHEAD, &self.weights)
                };
                let Some(cells) = votes.0[begin..].first_chunk() else { continue };
                let heaviest = heaviest_pair(cells, weights);
                if heaviest > best_weight {
                    best = if opposite { HALF + i } else { i };
                    best_weight = heaviest;
                }
            }
        }
        let is_best = |cell: &usize| {
            votes.support(best, *cell).min(MOST_SUPPORT) * self.weights[*cell] == best_weight
        };
        let cell = (0..CELLS).find(is_best)?;
        (votes.support(best, cell) >= LEAST_SUPPORT).then_some((best, cell))
    }
}

/// The place of a distance in units, which is a whole number, from where those ahead begin in a row.
fn place_of(distance: f32) -> u32 {
    const CELLS_PER_UNIT: f32 = 1.0 / UNITS_PER_CELL as f32;
    let cells = distance.abs() * CELLS_PER_UNIT;
    let within = if cells < CELLS as f32 { cells } else { CELLS as f32 };
    let cell = ((within - TO_WHOLE) + ROUNDING).to_bits() & 0xff;
    // Of the cells behind the first one lies before the first one ahead: −1 − cell.
    let behind = distance < 0.0;
    if behind { !cell } else { cell }
}

/// The most weight of two neighbouring cells, of one more than there are weights.
fn heaviest_pair(cells: &[i16; PAIRS + 1], weights: &[i16; PAIRS]) -> i16 {
    let pairs = cells.iter().zip(&cells[1..]).zip(weights);
    pairs.fold(0, |most, ((a, b), weight)| most.max((a + b).min(MOST_SUPPORT) * weight))
}

/// The centroid of the directions about the best one. The cube of the support tells a peak from the
/// broad foot that every Hough peak stands on.
fn refined_rad(votes: &Votes, best: usize, cell: usize) -> f64 {
    let most = f64::from(votes.support(best, cell));
    let cells = cell.saturating_sub(1)..=(cell + 1).min(CELLS - 1);
    let (mut moment, mut mass) = (0.0, 0.0);
    for step in 0..=2 * SPREAD {
        let off = step as f64 - SPREAD as f64;
        let direction = (best + DIRECTIONS + step - SPREAD) % DIRECTIONS;
        let like = cells.clone().map(|cell| votes.support(direction, cell)).max().unwrap_or(0);
        let share = (f64::from(like) / most).min(1.0);
        let cube = share * share * share;
        moment += cube * off;
        mass += cube;
    }
    let direction = best as f64 + moment / mass;
    let turned = if direction > HALF as f64 { direction - DIRECTIONS as f64 } else { direction };
    angle_rad(turned)
}

fn angle_rad(direction: f64) -> f64 {
    (360.0 / DIRECTIONS as f64 * direction).to_radians()
}

#[cfg(test)]
mod tests;
