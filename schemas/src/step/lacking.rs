//! Fields that one of two runs lacks.
//!
//! A run from before a field was recorded, or of a controller that has nothing of the kind, says nothing
//! about it, and that is no difference. A run that has the field in some messages and lacks it in others lost
//! it there, and does differ from one that has it. Which of the two it is shows at the end of both runs only:
//! until then what would differ is kept here.

use std::collections::BTreeMap;

/// Which of two runs has which fields, by number, and what is to be told of those that one of them lacks
/// where the other has them, should it turn out to be lost.
#[derive(Clone, Debug)]
pub struct Lacking<T> {
    /// By field, whether any message of either run had it.
    had: Vec<[bool; 2]>,
    kept: BTreeMap<usize, T>,
}

impl<T> Default for Lacking<T> {
    fn default() -> Lacking<T> {
        Lacking { had: Vec::new(), kept: BTreeMap::new() }
    }
}

impl<T> Lacking<T> {
    /// Takes in a message of a run, 0 or 1: which fields it has, in the order of their numbers.
    pub fn hear(&mut self, run: usize, has: impl IntoIterator<Item = bool>) {
        for (field, has) in has.into_iter().enumerate() {
            if self.had.len() <= field {
                self.had.push([false; 2]);
            }
            self.had[field][run] |= has;
        }
    }

    /// Whether both runs have the field in some message, as far as they were heard.
    pub fn both_have(&self, field: usize) -> bool {
        self.had.get(field) == Some(&[true; 2])
    }

    /// Where one run lacks what the other has: what is kept of that field, made the first time.
    pub fn keep(&mut self, field: usize, make: impl FnOnce() -> T) -> &mut T {
        self.kept.entry(field).or_insert_with(make)
    }

    /// The end of both runs: what was kept of the fields that were lost, in the order of their numbers.
    pub fn lost(&mut self) -> Vec<(usize, T)> {
        let kept = std::mem::take(&mut self.kept);
        kept.into_iter().filter(|(field, _)| self.both_have(*field)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Only what a run has elsewhere is lost where it has it not, whichever of the two runs it is, and
    /// whichever comes first.
    #[test]
    fn what_a_run_never_has_it_does_not_lose() {
        for run in [0, 1] {
            let mut lacking = Lacking::default();
            lacking.hear(1 - run, [true, true, true]);
            lacking.hear(run, [true, false, false]);
            lacking.keep(1, || "first");
            lacking.keep(2, || "never there");
            *lacking.keep(1, || "second") = "first, still";
            assert!(lacking.both_have(0) && !lacking.both_have(1));
            lacking.hear(run, [false, true, false]);
            assert_eq!(lacking.lost(), [(1, "first, still")]);
            assert_eq!(lacking.lost(), [], "told once");
        }
        assert!(!Lacking::<()>::default().both_have(0));
    }
}
