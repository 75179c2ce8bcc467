//! Golden results: what a fixture once gave, and whether it still does.
//!
//! Beside a fixture stand two files. `golden.toml` is the summary kept here: who drove, how many
//! steps, the hash of everything compared, the metrics, and every approval with its reason.
//! `golden.mcap` holds the approved run's `/step` and `/command`, so that a mismatch can be traced
//! by a [`Diff`](crate::Diff) to its field, time and amount. Neither file changes but by an
//! approval.

mod check;
mod summary;

#[cfg(test)]
mod tests;

pub use check::{Problem, check};
pub use summary::{Approval, Golden};
