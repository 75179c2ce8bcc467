//! That votes go where they belong, and that what they say is the nearest face.

use proptest::prelude::*;
use schemas::SIMULATION_EPOCH;

use super::super::beam::ARC_POINTS;
use super::super::points::{PlacedEcho, Point};
use super::*;

fn heard(at_m: [f64; 2], range_m: f64, confirmed: bool) -> Point {
    let echo = PlacedEcho {
        sonar: 3,
        from_m: [0.0; 2],
        axis: [1.0, 0.0],
        arc_m: [at_m; ARC_POINTS],
        range_m,
        fired: SIMULATION_EPOCH,
        odometer_m: 0.0,
    };
    Point::new(&echo, at_m, confirmed)
}

/// Points every 10 cm along 2 m of a wall whose foot stands at `distance_m` in the direction
/// `normal_deg` from the origin.
fn wall(normal_deg: f64, distance_m: f64) -> Vec<Point> {
    let [cos, sin] = unit(normal_deg.to_radians());
    (-10..=10)
        .map(|i| 0.1 * f64::from(i))
        .map(|along_m| {
            let at_m = [distance_m * cos - along_m * sin, distance_m * sin + along_m * cos];
            heard(at_m, 1.0, true)
        })
        .collect()
}

fn kept(points: &[Point]) -> Points {
    let mut kept = Points::new();
    for point in points {
        kept.keep(*point);
    }
    kept
}

fn nearest_deg(points: &[Point]) -> Option<f64> {
    Faces::new().nearest_rad(&kept(points), [0.0; 2], SIMULATION_EPOCH).map(f64::to_degrees)
}

fn apart_deg(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(360.0);
    turn.min(360.0 - turn)
}

/// Every distance there can be, ahead and behind, falls into the cell that division gives.
#[test]
fn distances_fall_into_their_cells() {
    let farthest = 15_000_000;
    assert!(farthest < 1 << f32::MANTISSA_DIGITS);
    for distance in 0..farthest {
        let cell = (distance / UNITS_PER_CELL).min(CELLS as u32);
        assert_eq!(place_of(distance as f32), cell, "{distance}");
        let behind = if distance == 0 { 0 } else { -1 - cell.cast_signed() };
        assert_eq!(place_of(-(distance as f32)).cast_signed(), behind, "−{distance}");
    }
    let most = 2.0 * UNITS_PER_M * FARTHEST_M * UNITS_PER_1;
    assert!(most * std::f64::consts::FRAC_1_SQRT_2 < f64::from(farthest));
}

proptest! {
    /// The direction and the cell are those that looking at one pair of cells after the other finds.
    #[test]
    fn the_heaviest_is_found(
        counts in prop::collection::vec((0..HALF, 0..ROW - 2, 1..600_i16), 0..60),
    ) {
        let faces = Faces::new();
        let mut votes = Votes([0; Votes::PLACES]);
        for (direction, place, count) in counts {
            votes.0[direction * ROW + 1 + place] = count;
        }
        let (mut best, mut best_weight) = (None, 0);
        for direction in 0..DIRECTIONS {
            for cell in 0..CELLS {
                let support = votes.support(direction, cell);
                let weight = support.min(MOST_SUPPORT) * faces.weights[cell];
                if weight > best_weight {
                    (best, best_weight) = (Some((direction, cell)), weight);
                }
            }
        }
        let best = best.filter(|(direction, cell)| votes.support(*direction, *cell) >= LEAST_SUPPORT);
        prop_assert_eq!(faces.heaviest(&votes), best);
    }
}

/// Votes go to the direction, or to the opposite one where the distance along it is negative.
#[test]
fn votes_go_to_the_side_where_the_point_is() {
    let faces = Faces::new();
    for (x, y) in [(0, 0), (0, 1), (0, -1), (-1, 0), (700, -300), (-2_000, 1_500), (-900, 900)] {
        let mut votes = Votes([0; Votes::PLACES]);
        faces.vote(&[[x as f32, y as f32]], &mut [[0; HALF]; AT_ONCE], &mut votes);
        assert_eq!(votes.0.iter().map(|votes| *votes as usize).sum::<usize>(), HALF);
        for i in 0..HALF {
            let normal = [faces.normals_x[i] as i32, faces.normals_y[i] as i32];
            let distance = x * normal[0] + y * normal[1];
            let direction = if distance < 0 { HALF + i } else { i };
            let cell = (distance.unsigned_abs() / UNITS_PER_CELL) as usize;
            if cell < CELLS {
                assert_eq!(votes.support(direction, cell), 1, "{x} {y} {i}");
            }
        }
    }
}

/// Within half a cell of 5°, whichever way the wall stands; between −180° and 180°.
#[test]
fn a_wall_is_found_at_every_angle() {
    for normal_deg in -180..180 {
        let found = nearest_deg(&wall(f64::from(normal_deg), 0.8)).unwrap();
        assert!(apart_deg(found, f64::from(normal_deg)) <= 2.5, "{normal_deg} {found}");
        assert!((-180.0..=180.0).contains(&found));
    }
}

#[test]
fn the_nearer_of_two_like_walls_counts() {
    let mut points = wall(0.0, 1.5);
    points.extend(wall(90.0, 0.6));
    assert!(apart_deg(nearest_deg(&points).unwrap(), 90.0) <= 2.5);
    let mut points = wall(0.0, 0.5);
    points.extend(wall(90.0, 1.6));
    assert!(apart_deg(nearest_deg(&points).unwrap(), 0.0) <= 2.5);
}

/// Nine points agree on nothing yet; neither do points that are unconfirmed, old or far away.
#[test]
fn too_few_voters_say_nothing() {
    let all = wall(0.0, 1.0);
    assert!(nearest_deg(&all[..9]).is_none());
    assert!(nearest_deg(&all[..10]).is_some());
    assert!(nearest_deg(&[]).is_none());
    let unconfirmed: Vec<Point> = all.iter().map(|p| heard(p.at_m, 1.0, false)).collect();
    assert!(nearest_deg(&unconfirmed).is_none());
    let later = SIMULATION_EPOCH.after_ns(3_000_000_001);
    assert!(Faces::new().nearest_rad(&kept(&all), [0.0; 2], later).is_none());
    let far: Vec<Point> = all.iter().map(|p| heard(p.at_m, 2.6, true)).collect();
    assert!(nearest_deg(&far).is_none());
}
