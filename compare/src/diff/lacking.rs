//! What differs in rows that one of two runs lacks, should it turn out that it lost them
//! ([`schemas::Lacking`]).

use std::collections::BTreeMap;

use super::cause::{Candidate, First};
use super::field::FieldDifference;

/// What differs if both runs turn out to have the field, by row.
#[derive(Debug, Default)]
pub(super) struct Lacking {
    rows: schemas::Lacking<Row>,
    /// How many messages differ in these rows and in nothing else.
    messages: BTreeMap<Vec<usize>, u64>,
}

#[derive(Debug)]
struct Row {
    difference: FieldDifference,
    first: Candidate,
}

impl Lacking {
    /// Takes in which rows a message of a run has.
    pub(super) fn hear(&mut self, side: usize, has: impl IntoIterator<Item = bool>) {
        self.rows.hear(side, has);
    }

    /// Counts a message in which one run has the row and the other lacks it. `difference` and `first` make
    /// what is not there yet.
    pub(super) fn add(
        &mut self,
        row: usize,
        t_s: f64,
        difference: impl FnOnce() -> FieldDifference,
        first: impl FnOnce() -> Candidate,
    ) {
        let row = self.rows.keep(row, || Row { difference: difference(), first: first() });
        row.difference.count_lacking(t_s);
    }

    /// Counts a message that differs in these rows and in nothing else.
    pub(super) fn message(&mut self, rows: Vec<usize>) {
        if !rows.is_empty() {
            *self.messages.entry(rows).or_default() += 1;
        }
    }

    /// The end of both runs. Of each row that one of them lost, the difference goes to `found` and what may
    /// be the first cause to `first`; how many more messages differ is the answer.
    pub(super) fn settle(
        mut self,
        found: &mut [Option<FieldDifference>],
        first: &mut First,
    ) -> u64 {
        for (number, row) in self.rows.lost() {
            first.take_if_earlier(row.first);
            match &mut found[number] {
                Some(found) => found.merge(&row.difference),
                none => *none = Some(row.difference),
            }
        }
        let differ = |rows: &[usize]| rows.iter().any(|row| self.rows.both_have(*row));
        self.messages.iter().filter(|(rows, _)| differ(rows)).map(|(_, count)| count).sum()
    }
}
