//! Which point of its arc each echo came from: the one that most other arcs agree with.

use std::cell::LazyCell;

use super::grid::Raster;
use super::views::{Gathered, View};

/// Half the cone within which an echo may have come back, degrees.
const HALF_CONE_DEG: i32 = 13;

/// Half the core of a cone in which nothing nearer than the echo is expected, degrees.
const CORE_DEG: i32 = 6;

/// Edge of a cell of the ballot, metres.
const CELL_M: f64 = 0.05;

/// What looking past a place counts against an arc through it.
const PAST: f32 = 0.5;

/// Within this distance points confirm each other, metres.
const NEAR_M: f64 = 0.12;

/// So many other points confirm one.
const CONFIRMED_BY: u32 = 3;

/// So many are counted one by one. Where there are more, cells are counted: the time that each of an hour's
/// echoes from one place takes with each other grows with their square, and their number only decides which
/// of some certain walls comes first.
const ONE_BY_ONE: usize = 400;

/// Cells of that count within [`NEAR_M`].
const FINE: usize = 6;

/// Where an echo came from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    pub(super) view: View,
    /// From the sonar's axis, radians.
    pub(super) off_rad: f64,
    pub(super) at_m: [f64; 2],
    /// How many other echoes came from about there.
    pub(super) others: u32,
}

impl Hit {
    /// Whether others have heard it too.
    pub(super) fn is_confirmed(&self) -> bool {
        self.others >= CONFIRMED_BY
    }
}

fn angles(half_deg: i32) -> impl Iterator<Item = f64> {
    (-half_deg..=half_deg).map(|deg| f64::from(deg).to_radians())
}

/// How uncertain a range is, metres.
fn doubt_m(view: &View) -> f64 {
    0.02 + 0.01 * view.range_m
}

pub(super) fn choose(gathered: &Gathered) -> Vec<Hit> {
    let views = &gathered.views;
    let ends = views.iter().flat_map(|view| {
        [-1.0, 0.0, 1.0].map(|off| view.at(off * f64::from(HALF_CONE_DEG).to_radians()))
    });
    let mut through: Raster<f32> = Raster::about(ends, CELL_M);
    let mut past = through.clone();
    let mut touched = Vec::new();
    for view in views {
        for off_rad in angles(HALF_CONE_DEG) {
            let doubt_m = doubt_m(view);
            for range_m in [view.range_m - doubt_m, view.range_m, view.range_m + doubt_m] {
                touched.extend(through.index(view.along(off_rad, range_m)));
            }
        }
        count(&mut through, &mut touched);
        for off_rad in angles(CORE_DEG).step_by(2) {
            let end_m = view.range_m - 0.1 - 2.0 * doubt_m(view);
            let steps = (end_m / CELL_M).max(0.0) as u32;
            for step in 0..steps {
                touched.extend(past.index(view.along(off_rad, f64::from(step) * CELL_M)));
            }
        }
        count(&mut past, &mut touched);
    }
    let mut hits: Vec<Hit> = views.iter().map(|view| best(view, &through, &past)).collect();
    confirm(&mut hits);
    hits
}

/// One vote for each cell that a view touches, however often.
fn count(raster: &mut Raster<f32>, touched: &mut Vec<usize>) {
    touched.sort_unstable();
    touched.dedup();
    for cell in touched.drain(..) {
        raster.cells[cell] += 1.0;
    }
}

fn best(view: &View, through: &Raster<f32>, past: &Raster<f32>) -> Hit {
    let score = |off_rad: f64| {
        through
            .index(view.at(off_rad))
            .map_or(f32::MIN, |cell| through.cells[cell] - PAST * past.cells[cell])
    };
    let scores: Vec<f32> = angles(HALF_CONE_DEG).map(score).collect();
    let offs: Vec<f64> = angles(HALF_CONE_DEG).collect();
    let mut choice = (f32::MIN, f64::INFINITY, 0.0);
    for (i, off_rad) in offs.iter().enumerate() {
        let low = i.saturating_sub(1);
        let high = (i + 2).min(scores.len());
        let mean = scores[low..high].iter().sum::<f32>() / (high - low) as f32;
        // Of equals the one nearest the axis.
        if mean > choice.0 || (mean == choice.0 && off_rad.abs() < choice.1) {
            choice = (mean, off_rad.abs(), *off_rad);
        }
    }
    Hit { view: *view, off_rad: choice.2, at_m: view.at(choice.2), others: 0 }
}

/// Counts for each point the others about it.
fn confirm(hits: &mut [Hit]) {
    let mut places: Raster<Vec<u32>> = Raster::about(hits.iter().map(|hit| hit.at_m), NEAR_M);
    for (index, hit) in hits.iter().enumerate() {
        if let Some(cell) = places.index(hit.at_m) {
            places.cells[cell].push(index as u32);
        }
    }
    let fine = LazyCell::new(|| {
        let mut fine: Raster<u32> =
            Raster::about(hits.iter().map(|hit| hit.at_m), NEAR_M / FINE as f64);
        for hit in hits.iter() {
            if let Some(cell) = fine.index(hit.at_m) {
                fine.cells[cell] += 1;
            }
        }
        fine
    });
    let counts: Vec<u32> = hits
        .iter()
        .map(|hit| {
            let near = places.around(hit.at_m).flat_map(|cell| &places.cells[cell]);
            let near = near.filter(|other| {
                let [x, y] = hits[**other as usize].at_m;
                let [dx, dy] = [x - hit.at_m[0], y - hit.at_m[1]];
                dx * dx + dy * dy <= NEAR_M * NEAR_M
            });
            let counted = near.take(ONE_BY_ONE + 1).count() as u32;
            let all = if counted as usize > ONE_BY_ONE {
                counted.max(fine.within(hit.at_m, FINE).map(|cell| fine.cells[cell]).sum())
            } else {
                counted
            };
            // The point itself is among them, if it lies on the raster at all.
            all.saturating_sub(1)
        })
        .collect();
    for (hit, others) in hits.iter_mut().zip(counts) {
        hit.others = others;
    }
}

pub(super) fn distance_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(at_m: [f64; 2]) -> Hit {
        let view =
            View { t_s: 0.0, from_m: [0.0; 2], body_m: [0.0; 2], axis_rad: 0.0, range_m: 1.0 };
        Hit { view, off_rad: 0.0, at_m, others: 0 }
    }

    /// Others within 12 cm are counted, few or many; a place that is off the map has none.
    #[test]
    fn others_are_counted() {
        let mut few = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1], [0.3, 0.0], [1e9, 0.0]].map(hit);
        confirm(&mut few);
        assert_eq!(few.map(|hit| hit.others), [2, 1, 1, 0, 0]);
        let mut many = vec![hit([0.0; 2]); 3000];
        confirm(&mut many);
        assert!(many.iter().all(|hit| hit.others == 2999));
        // Of a wall of 10 points each centimetre those in 24 cm, which is 240, less itself; and of one ten
        // times as dense ten times as many, to within a cell at either end.
        for dense in [10, 100] {
            let mut wall: Vec<Hit> = (0..100 * dense)
                .map(|i| hit([f64::from(i) * 0.01 / f64::from(dense), 0.0]))
                .collect();
            confirm(&mut wall);
            let middle = f64::from(wall[wall.len() / 2].others);
            let expected = 24.0 * f64::from(dense);
            assert!((middle - expected).abs() <= 2.0 * f64::from(dense) + 2.0, "{middle}");
            // At its end it has half of them.
            let end = f64::from(wall[0].others);
            assert!((end - 0.5 * expected).abs() <= 2.0 * f64::from(dense) + 2.0, "{end}");
        }
    }
}
