//! What differed first, and first along the data flow.
//!
//! A step's quantities cause one another in the order input → estimate → distances → reference →
//! law → sharing → command. Among the differences at the earliest time, the one at the earliest
//! stage is the cause of the others; whatever differs later may be a consequence. The target belongs
//! to the reference and yet comes before the distances, since these are measured in a frame that turns
//! with it.

use std::fmt::Write;

use schemas::Node;
use serde::{Deserialize, Serialize};

use super::field::{Row, unit_of_law};
use super::reading::Reading;
use crate::report::{number, told_apart, with_unit};

/// The earliest difference, and at that time the one at the earliest stage of the data flow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FirstCause {
    /// Seconds from the start of the run.
    pub t_s: f64,
    /// Stage of the data flow: `input`, `estimate`, … `command`.
    pub node: String,
    /// The field.
    pub field: String,
    /// Its unit; empty without one.
    pub unit: String,
    /// What the first run says.
    pub a: Reading,
    /// What the second run says.
    pub b: Reading,
    /// The same in a sentence.
    pub reason: String,
}

impl FirstCause {
    /// Tells it in the unit of a law that both runs have, one of velocities or of accelerations.
    pub fn take_law(&mut self, accelerates: bool) {
        let unit = unit_of_law(&self.unit, accelerates).to_owned();
        self.reason = self.reason.replace(&self.unit, &unit);
        self.unit = unit;
    }
}

/// A difference that may turn out to be the first.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    /// Nanoseconds from the start.
    pub(super) key: i128,
    pub(super) rank: (Node, bool),
    /// Position of the row, for two at the same stage.
    pub(super) order: usize,
    /// Whether it is one of the fingerprints of hidden state.
    pub(super) hidden_state: bool,
    pub(super) cause: FirstCause,
}

impl Candidate {
    fn rank(&self) -> (i128, (Node, bool), usize) {
        (self.key, self.rank, self.order)
    }
}

/// The first difference so far: among the quantities, and among the fingerprints of hidden state,
/// which count only where no quantity differs.
#[derive(Clone, Debug, Default)]
pub(super) struct First {
    quantity: Option<Candidate>,
    hidden: Option<Candidate>,
}

impl First {
    /// Whether a difference there would come before the first one so far.
    pub(super) fn is_beaten_by(&self, key: i128, row: &Row, order: usize) -> bool {
        let so_far = if row.hidden_state { &self.hidden } else { &self.quantity };
        so_far.as_ref().is_none_or(|first| (key, row.rank(), order) < first.rank())
    }

    pub(super) fn take(&mut self, candidate: Candidate) {
        let hidden = candidate.hidden_state;
        let so_far = if hidden { &mut self.hidden } else { &mut self.quantity };
        *so_far = Some(candidate);
    }

    /// The same, if it comes before the first one so far.
    pub(super) fn take_if_earlier(&mut self, candidate: Candidate) {
        let so_far = if candidate.hidden_state { &self.hidden } else { &self.quantity };
        if so_far.as_ref().is_none_or(|first| candidate.rank() < first.rank()) {
            self.take(candidate);
        }
    }

    pub(super) fn cause(self) -> Option<FirstCause> {
        self.quantity.or(self.hidden).map(|first| first.cause)
    }
}

/// One reading, where the other is no number.
fn shown(reading: &Reading, unit: &str) -> String {
    match reading {
        Reading::Number(x) if x.is_nan() => "NaN".to_owned(),
        Reading::Number(x) if x.is_finite() => with_unit(&number(Some(*x)), unit),
        other => other.to_string(),
    }
}

/// The sentence of a first cause.
pub(super) fn sentence(
    t_s: f64,
    row: &Row,
    (a, b): (&Reading, &Reading),
    said: Option<(&str, &str)>,
) -> String {
    let (a, b) = match (a, b) {
        (Reading::Number(a), Reading::Number(b)) if a.is_finite() && b.is_finite() => {
            let (a, b) = told_apart(*a, *b);
            (with_unit(&a, &row.unit), with_unit(&b, &row.unit))
        }
        _ => (shown(a, &row.unit), shown(b, &row.unit)),
    };
    let mut text = format!("at {t_s:.3} s {} is {a} in A and {b} in B", row.name);
    if row.hidden_state {
        text.push_str("; no quantity differs, only the controllers' hidden state");
    } else if row.is_target() {
        text.push_str("; nothing that the target follows from differs up to then");
    } else if row.node != Node::Input {
        text.push_str("; everything before the stage `");
        text.push_str(row.node.name());
        text.push_str("` agrees up to then");
    }
    if let Some((a, b)) = said {
        if a == b {
            // Writing to a String cannot fail, here and below.
            let _ = write!(text, "; both give the reason `{a}`");
        } else {
            let _ = write!(text, "; A gives the reason `{a}`, B `{b}`");
        }
    }
    text
}
