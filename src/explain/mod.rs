//! Why the controller did what it did at one instant.
//!
//! In: a log and a time. The log says what happened ([`moment`]); the controller, stepped over it
//! again, says which rays and echoes that came from ([`trace`]). Out: an [`Explanation`] as data
//! ([`account`], made by [`build`]), which [`mod@text`] prints.

mod account;
mod build;
mod instant;
mod moment;
mod ray;
mod text;
mod thing;
pub mod trace;
mod words;

#[cfg(test)]
mod tests;

use std::path::Path;

use anyhow::Result;

pub use account::Explanation;
pub use instant::Instant;
pub use text::text;

/// Explains the step in force at `at`.
pub fn explain(log: &Path, at: Instant) -> Result<Explanation> {
    let moment = moment::find(log, at)?;
    let traced = trace::trace(log, &moment);
    Ok(build::explanation(log, at, &moment, &traced))
}
