//! Two runs field by field: where they differ, by how much, since when, and what differed first.
//!
//! In go two streams of events; out comes a [`Diff`]. Compared are `/step` and `/command`, matched
//! by their time from the start of their run. Fields come from the step's own catalogue
//! ([`schemas::Step::FIELDS`]), so a field added to the schema is compared without a word here.
//!
//! Where one run says the same some steps later, the field's row says by how many.
//!
//! NaN equals NaN: both runs do not know. NaN against a number is a difference. A step or command
//! that only one run has is a difference, with a row of its own. A field that one run has in no step says
//! nothing; one that it has in some steps is compared in all.

mod cause;
mod differ;
mod field;
mod lacking;
mod lag;
mod reading;
mod side;
mod tolerance;

#[cfg(test)]
mod tests;

pub use cause::FirstCause;
pub use differ::{Compared, Diff, Differ, diff};
pub use field::{FieldDifference, unit_of_law};
pub use reading::Reading;
pub use side::Next;
pub use tolerance::{Base, Tolerance, Tolerances};
