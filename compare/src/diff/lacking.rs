//! Fields that one of two runs lacks.
//!
//! A run from before a field was recorded, or of a controller that has nothing of the kind, says nothing
//! about it, and that is no difference. A run that has the field in some steps and lacks it in others does
//! differ there from one that has it. Which of the two it is shows at the end of both runs only: until then
//! what would differ is kept here.

use std::collections::BTreeMap;

use super::cause::{Candidate, First};
use super::field::FieldDifference;

/// What differs if both runs turn out to have the field, by row.
#[derive(Debug, Default)]
pub(super) struct Lacking {
    rows: BTreeMap<usize, Row>,
    /// How many messages differ in these rows and in nothing else.
    messages: BTreeMap<Vec<usize>, u64>,
}

#[derive(Debug)]
struct Row {
    difference: FieldDifference,
    first: Candidate,
}

impl Lacking {
    /// Counts a message in which one run has the row and the other lacks it. `difference` and `first` make
    /// what is not there yet.
    pub(super) fn add(
        &mut self,
        row: usize,
        t_s: f64,
        difference: impl FnOnce() -> FieldDifference,
        first: impl FnOnce() -> Candidate,
    ) {
        let row = self
            .rows
            .entry(row)
            .or_insert_with(|| Row { difference: difference(), first: first() });
        row.difference.count_lacking(t_s);
    }

    /// Counts a message that differs in these rows and in nothing else.
    pub(super) fn message(&mut self, rows: Vec<usize>) {
        if !rows.is_empty() {
            *self.messages.entry(rows).or_default() += 1;
        }
    }

    /// The end of both runs. Of each row that both have, the difference goes to `found` and what may be the
    /// first cause to `first`; how many more messages differ is the answer.
    pub(super) fn settle(
        self,
        both_have: impl Fn(usize) -> bool,
        found: &mut [Option<FieldDifference>],
        first: &mut First,
    ) -> u64 {
        for (number, row) in self.rows {
            if !both_have(number) {
                continue;
            }
            first.take_if_earlier(row.first);
            match &mut found[number] {
                Some(found) => found.merge(&row.difference),
                none => *none = Some(row.difference),
            }
        }
        let differ = |rows: &[usize]| rows.iter().any(|row| both_have(*row));
        self.messages.iter().filter(|(rows, _)| differ(rows)).map(|(_, count)| count).sum()
    }
}
