//! Whether one run says the same as the other some steps earlier or later.
//!
//! For each number the squares of A − B are summed for every shift of up to five steps either way. A
//! shift is reported where it takes away at least nine tenths of them.

use std::collections::VecDeque;

use super::field::{Row, apart};

/// Longest shift that is tried, steps.
const MOST: usize = 5;

/// Fewer comparisons than this prove nothing.
const LEAST_COMPARED: u32 = 10;

/// What is left of the squares at most.
const LEFT_OVER: f64 = 0.1;

/// One number of both runs, step by step.
#[derive(Clone, Debug, Default)]
pub(super) struct Lag {
    /// Whether it is a direction: the short way round counts.
    direction: bool,
    /// The last few pairs, the newest first.
    past: VecDeque<[f64; 2]>,
    /// Sums of squares for shifts −5 … 5; positive where B lags.
    squares: [f64; 2 * MOST + 1],
    compared: u32,
}

impl Lag {
    /// Of a row, before its first step.
    pub(super) fn of(row: &Row) -> Lag {
        Lag { direction: row.direction, ..Lag::default() }
    }

    /// Takes in what both say at the next step that both have.
    pub(super) fn pair(&mut self, a: f64, b: f64) {
        self.past.push_front([a, b]);
        self.past.truncate(MOST + 1);
        let whole = self.past.len() > MOST;
        // Every shift is judged by the same steps.
        if !whole || self.past.iter().flatten().any(|x| !x.is_finite()) {
            return;
        }
        self.compared += 1;
        for (shift, [a_before, b_before]) in self.past.iter().enumerate() {
            let squared = |x, y| {
                let off = apart(self.direction, x, y);
                off * off
            };
            self.squares[MOST + shift] += squared(b, *a_before);
            if shift > 0 {
                self.squares[MOST - shift] += squared(a, *b_before);
            }
        }
    }

    /// By how many steps B lags behind A, negative where it leads; `None` where no shift explains
    /// the difference.
    pub(super) fn steps(&self) -> Option<i32> {
        let unshifted = self.squares[MOST];
        if self.compared < LEAST_COMPARED || unshifted <= 0.0 {
            return None;
        }
        // The shortest of equal ones.
        let best =
            (1..=MOST).flat_map(|shift| [MOST + shift, MOST - shift]).reduce(|best, other| {
                if self.squares[other] < self.squares[best] { other } else { best }
            })?;
        let steps = i32::try_from(best).ok()? - i32::try_from(MOST).ok()?;
        (self.squares[best] <= LEFT_OVER * unshifted).then_some(steps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// B says what `of` makes of A's series at each step.
    fn lag(of: impl Fn(&dyn Fn(usize) -> f64, usize) -> f64) -> Option<i32> {
        let a = |i: usize| libm::sin(0.7 * i as f64);
        let mut lag = Lag::default();
        for i in 5..60 {
            lag.pair(a(i), of(&a, i));
        }
        lag.steps()
    }

    #[test]
    fn a_shift_is_found_either_way() {
        assert_eq!(lag(|a, i| a(i - 1)), Some(1));
        assert_eq!(lag(|a, i| a(i - 3)), Some(3));
        assert_eq!(lag(|a, i| a(i + 2)), Some(-2));
        // With a little on top, too.
        assert_eq!(lag(|a, i| a(i - 1) + 0.01), Some(1));
    }

    #[test]
    fn what_is_no_shift_is_not_called_one() {
        assert_eq!(lag(|a, i| a(i)), None);
        assert_eq!(lag(|a, i| 2.0 * a(i)), None);
        assert_eq!(lag(|_, i| f64::from(u8::from(i % 7 == 0))), None);
        assert_eq!(lag(|_, _| f64::NAN), None);
    }

    /// A direction that turns on past half a turn, two steps later in B.
    #[test]
    fn directions_are_shifted_the_short_way_round() {
        let direction = |i: f64| schemas::wrap(0.4 * i);
        let mut lag = Lag { direction: true, ..Lag::default() };
        // A turn more in A now and then is the same direction.
        let turns = |i: i32| if i % 3 == 0 { core::f64::consts::TAU } else { 0.0 };
        for i in 5..60 {
            lag.pair(direction(f64::from(i)) + turns(i), direction(f64::from(i - 2)));
        }
        assert_eq!(lag.steps(), Some(2));
    }

    #[test]
    fn a_few_steps_prove_nothing() {
        let mut lag = Lag::default();
        (0..14).for_each(|i| lag.pair(f64::from(i), f64::from(i - 1)));
        assert_eq!(lag.steps(), None);
        lag.pair(14.0, 13.0);
        assert_eq!(lag.steps(), Some(1));
    }
}
