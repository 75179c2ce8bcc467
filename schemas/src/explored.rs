//! How much of a world is known: free, taken, unknown.

use serde::{Deserialize, Serialize};

/// What is known about a place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cell {
    /// Nobody has looked.
    #[default]
    Unknown,
    /// Nothing stands there.
    Free,
    /// Something does.
    Taken,
}

impl Cell {
    /// The character in a scenario file: `?`, `.` or `#`.
    pub fn letter(self) -> char {
        match self {
            Cell::Unknown => '?',
            Cell::Free => '.',
            Cell::Taken => '#',
        }
    }

    fn of(letter: u8) -> Option<Cell> {
        match letter {
            b'?' => Some(Cell::Unknown),
            b'.' => Some(Cell::Free),
            b'#' => Some(Cell::Taken),
            _ => None,
        }
    }
}

/// A grid over a part of the world, as a picture that can be read: north up, a letter a cell
/// ([`Cell::letter`]). What lies outside of it is unknown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Explored {
    /// Lower left corner, metres.
    pub low_m: [f64; 2],
    /// Edge of a cell, metres.
    pub cell_m: f64,
    /// Rows of cells from the highest y to the lowest, each from the lowest x to the highest.
    pub rows: Vec<String>,
}

impl Explored {
    /// From cells row by row, from the lowest y up. A last row that is not whole is left out, and so
    /// are rows without end.
    pub fn new(low_m: [f64; 2], cell_m: f64, columns: usize, cells: &[Cell]) -> Explored {
        let rows = cells.chunks_exact(columns.max(1)).rev();
        Explored {
            low_m,
            cell_m,
            rows: rows.map(|row| row.iter().map(|cell| cell.letter()).collect()).collect(),
        }
    }

    /// What is known about a point.
    pub fn at(&self, point_m: [f64; 2]) -> Cell {
        let index = |axis: usize| {
            let cells = libm::floor((point_m[axis] - self.low_m[axis]) / self.cell_m);
            (0.0..1e9).contains(&cells).then_some(cells as usize)
        };
        let cell = || {
            let row = self.rows.len().checked_sub(1 + index(1)?)?;
            Cell::of(*self.rows.get(row)?.as_bytes().get(index(0)?)?)
        };
        cell().unwrap_or_default()
    }

    /// Every cell with its middle, from the lowest y up.
    pub fn cells(&self) -> impl Iterator<Item = ([f64; 2], Cell)> + '_ {
        self.rows.iter().rev().enumerate().flat_map(move |(row, letters)| {
            letters.bytes().enumerate().map(move |(column, letter)| {
                let middle = |count: usize, axis: usize| {
                    self.low_m[axis] + (count as f64 + 0.5) * self.cell_m
                };
                let cell = Cell::of(letter).unwrap_or_default();
                ([middle(column, 0), middle(row, 1)], cell)
            })
        })
    }

    pub(crate) fn check(&self) -> Result<(), String> {
        if !self.low_m.iter().all(|x| x.is_finite()) {
            return Err(format!("explored.low_m must hold finite numbers, not {:?}", self.low_m));
        }
        if !(self.cell_m > 0.0 && self.cell_m.is_finite()) {
            return Err(format!("explored.cell_m = {}: expected more than 0", self.cell_m));
        }
        let columns = self.rows.first().map_or(0, String::len);
        for (i, row) in self.rows.iter().enumerate() {
            if row.len() != columns {
                let found = row.len();
                return Err(format!("explored.rows[{i}] has {found} cells, not {columns}"));
            }
            if let Some(letter) = row.bytes().find(|letter| Cell::of(*letter).is_none()) {
                let letter = char::from(letter);
                return Err(format!("explored.rows[{i}] holds `{letter}`, not one of ? . #"));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn explored() -> Explored {
        use Cell::{Free, Taken, Unknown};
        let cells = [Free, Taken, Unknown, Unknown, Free, Taken];
        Explored::new([-1.0, 2.0], 0.5, 3, &cells)
    }

    /// Two rows of three cells of half a metre from (-1, 2): the upper row is the second one.
    #[test]
    fn a_place_is_what_its_cell_is() {
        let explored = explored();
        assert_eq!(explored.rows, ["?.#", ".#?"]);
        assert_eq!(explored.at([-0.9, 2.1]), Cell::Free);
        assert_eq!(explored.at([-0.4, 2.4]), Cell::Taken);
        assert_eq!(explored.at([0.4, 2.9]), Cell::Taken);
        assert_eq!(explored.at([-0.9, 2.6]), Cell::Unknown);
        for outside in [[-1.1, 2.1], [0.6, 2.1], [-0.9, 3.1], [-0.9, 1.9], [f64::NAN, 2.1]] {
            assert_eq!(explored.at(outside), Cell::Unknown, "{outside:?}");
        }
        for (middle_m, cell) in explored.cells() {
            assert_eq!(explored.at(middle_m), cell);
        }
        assert_eq!(explored.cells().count(), 6);
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        assert_eq!(explored().check(), Ok(()));
        let bad = |change: fn(&mut Explored)| {
            let mut explored = explored();
            change(&mut explored);
            explored.check().expect_err("refused")
        };
        assert!(bad(|e| e.rows[1].push('.')).contains("rows[1] has 4 cells, not 3"));
        assert!(bad(|e| e.rows[0] = "?x#".to_owned()).contains("`x`"));
        assert!(bad(|e| e.cell_m = 0.0).contains("cell_m"));
        assert!(bad(|e| e.low_m[0] = f64::NAN).contains("low_m"));
    }
}
