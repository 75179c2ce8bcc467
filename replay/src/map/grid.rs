//! What lines of sight and the body's own way say about each place: free, taken, unknown.

use schemas::{Cell, Explored};

use super::views::Gathered;
use super::votes::{Hit, distance_m};
use super::walls::Face;

/// Edge of a cell of the map, metres.
const CELL_M: f64 = 0.05;

/// Farther than this from the middle of all places nothing is kept, metres.
const FARTHEST_M: f64 = 30.0;

/// A line of sight says nothing about the last bit before its end, metres.
const BEFORE_M: f64 = 0.12;

/// To either side of a line of sight, radians.
const ASIDE_RAD: f64 = 0.05;

/// So many lines of sight make a place free.
const FREE_BY: u16 = 2;

/// Echoes and lines of sight so far apart in time tell that something came or went, seconds.
const APART_S: f32 = 0.5;

/// So many lines of sight through a place tell that what stood there is gone.
const GONE_BY: u16 = 4;

/// A grid over a rectangle that holds all of some points.
#[derive(Clone, Debug)]
pub(super) struct Raster<T> {
    pub(super) cells: Vec<T>,
    low_m: [f64; 2],
    cell_m: f64,
    columns: usize,
    rows: usize,
}

impl<T: Clone + Default> Raster<T> {
    /// About some points, with a cell of margin; those too far from the middle of all are left out.
    pub(super) fn about(points: impl Iterator<Item = [f64; 2]>, cell_m: f64) -> Raster<T> {
        let points: Vec<[f64; 2]> =
            points.filter(|point| point.iter().all(|x| x.is_finite())).collect();
        let middle_m = middle(&points);
        let (mut low_m, mut high_m) = (middle_m, middle_m);
        for point in points.iter().filter(|point| distance_m(middle_m, **point) <= FARTHEST_M) {
            for axis in 0..2 {
                low_m[axis] = if point[axis] < low_m[axis] { point[axis] } else { low_m[axis] };
                high_m[axis] = if point[axis] > high_m[axis] { point[axis] } else { high_m[axis] };
            }
        }
        let low_m = low_m.map(|low_m| (libm::floor(low_m / cell_m) - 2.0) * cell_m);
        let count = |axis: usize| libm::ceil((high_m[axis] - low_m[axis]) / cell_m) as usize + 2;
        let (columns, rows) = (count(0), count(1));
        Raster { cells: vec![T::default(); columns * rows], low_m, cell_m, columns, rows }
    }
}

/// The median along either axis, metres: one estimate that was far off, were it the first of all, moves it by
/// no more than any other point does.
fn middle(points: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let mut along_m: Vec<f64> = points.iter().map(|point| point[axis]).collect();
        let half = along_m.len() / 2;
        if along_m.is_empty() {
            0.0
        } else {
            *along_m.select_nth_unstable_by(half, f64::total_cmp).1
        }
    })
}

impl<T> Raster<T> {
    /// The cell that holds a point.
    pub(super) fn index(&self, at_m: [f64; 2]) -> Option<usize> {
        let along = |axis: usize, count: usize| {
            let cells = libm::floor((at_m[axis] - self.low_m[axis]) / self.cell_m);
            (0.0 <= cells && cells < count as f64).then_some(cells as usize)
        };
        Some(along(1, self.rows)? * self.columns + along(0, self.columns)?)
    }

    /// The cell that holds a point and those about it.
    pub(super) fn around(&self, at_m: [f64; 2]) -> impl Iterator<Item = usize> + '_ {
        let cell = self.index(at_m);
        cell.into_iter().flat_map(move |cell| {
            let (row, column) = (cell / self.columns, cell % self.columns);
            let rows = row.saturating_sub(1)..=(row + 1).min(self.rows - 1);
            rows.flat_map(move |row| {
                let columns = column.saturating_sub(1)..=(column + 1).min(self.columns - 1);
                columns.map(move |column| row * self.columns + column)
            })
        })
    }
}

impl<T> Raster<T> {
    /// The cells whose middles lie no farther than so many cells from the middle of the one that holds a
    /// point.
    pub(super) fn within(&self, at_m: [f64; 2], reach: usize) -> impl Iterator<Item = usize> + '_ {
        self.index(at_m).into_iter().flat_map(move |cell| {
            let (row, column) = (cell / self.columns, cell % self.columns);
            let about = move |at: usize, count: usize| {
                at.saturating_sub(reach)..(at + reach + 1).min(count)
            };
            about(row, self.rows).flat_map(move |i| {
                let inside = move |j: &usize| {
                    let (up, aside) = (i.abs_diff(row), j.abs_diff(column));
                    up * up + aside * aside <= reach * reach
                };
                about(column, self.columns).filter(inside).map(move |j| i * self.columns + j)
            })
        })
    }
}

/// What speaks for a cell being free, and what against it.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    /// Lines of sight through it.
    free: u16,
    /// Echoes from it or beside it.
    hits: u16,
    /// Whether the body has been there.
    driven: bool,
    /// When the first and the last of those echoes came, seconds.
    first_s: f32,
    last_s: f32,
    /// Lines of sight before the first and after the last.
    free_then: u16,
}

/// All of that.
pub(super) struct Evidence {
    counts: Raster<Count>,
}

impl Evidence {
    pub(super) fn gather(gathered: &Gathered, hits: &[Hit]) -> Evidence {
        let body = gathered.way.iter().map(|(_, pose)| [pose.x_m, pose.y_m]);
        let counts = Raster::about(body.chain(hits.iter().map(|hit| hit.at_m)), CELL_M);
        let mut evidence = Evidence { counts };
        let mut touched = Vec::new();
        for hit in hits.iter().filter(|hit| hit.is_confirmed()) {
            let t_s = hit.view.t_s as f32;
            for cell in evidence.counts.around(hit.at_m).collect::<Vec<_>>() {
                let count = &mut evidence.counts.cells[cell];
                if count.hits == 0 {
                    count.first_s = t_s;
                }
                count.last_s = t_s;
                count.hits = count.hits.saturating_add(1);
            }
        }
        for hit in hits.iter().filter(|hit| hit.is_confirmed()) {
            let t_s = hit.view.t_s as f32;
            let end_m = hit.view.range_m - BEFORE_M;
            for aside_rad in [-ASIDE_RAD, 0.0, ASIDE_RAD] {
                let steps = (end_m / CELL_M * 2.0).max(0.0) as u32;
                for step in 0..=steps {
                    let way_m = f64::from(step) * 0.5 * CELL_M;
                    let at_m = hit.view.along(hit.off_rad + aside_rad, way_m);
                    touched.extend(evidence.counts.index(at_m));
                }
            }
            touched.sort_unstable();
            touched.dedup();
            for cell in touched.drain(..) {
                let count = &mut evidence.counts.cells[cell];
                count.free = count.free.saturating_add(1);
                if t_s < count.first_s - APART_S || t_s > count.last_s + APART_S {
                    count.free_then = count.free_then.saturating_add(1);
                }
            }
        }
        for (_, pose) in &gathered.way {
            // A cell less all round: the estimate is not that good.
            let [length, width] = gathered.half_size_m.map(|half_m| (half_m - CELL_M).max(0.0));
            let count = |half_m: f64| (half_m / (0.5 * CELL_M)) as i32;
            for i in -count(length)..=count(length) {
                for j in -count(width)..=count(width) {
                    let (x, y) = (f64::from(i) * 0.5 * CELL_M, f64::from(j) * 0.5 * CELL_M);
                    if let Some(cell) = evidence.counts.index(pose.transform(x, y)) {
                        evidence.counts.cells[cell].driven = true;
                    }
                }
            }
        }
        evidence
    }

    /// Whether what echoed at a place is not there at other times: more has been seen past it than
    /// came back from it.
    pub(super) fn is_passing(&self, at_m: [f64; 2]) -> bool {
        self.counts.index(at_m).is_some_and(|cell| {
            let count = &self.counts.cells[cell];
            count.driven || count.free > count.hits || count.free_then >= GONE_BY
        })
    }

    /// The map: taken along the faces, free where enough lines of sight went.
    pub(super) fn explored(&self, faces: &[Face]) -> Explored {
        let raster = &self.counts;
        let mut cells: Vec<Cell> = raster
            .cells
            .iter()
            .map(|count| {
                let seen = count.free >= FREE_BY && count.free > count.hits;
                if seen || count.driven { Cell::Free } else { Cell::Unknown }
            })
            .collect();
        for face in faces {
            for at_m in face.places(0.5 * CELL_M) {
                if let Some(cell) = raster.index(at_m) {
                    cells[cell] = Cell::Taken;
                }
            }
        }
        Explored::new(raster.low_m, CELL_M, raster.columns, &cells)
    }
}
