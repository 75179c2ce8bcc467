//! One result, shown: as text for a terminal, Markdown for a comment, JSON for a machine, `JUnit` XML
//! for a pipeline, CSV for a spreadsheet, and one offline HTML page.
//!
//! Text, Markdown and the page are filled from the same table of cells (`View`), and JSON carries
//! the numbers behind those cells, so that they cannot disagree.

mod csv;
mod diff_text;
mod honest;
mod html;
mod json;
mod junit;
mod map;
mod markdown;
mod metrics_text;
mod number;
mod plot;
mod samples;
mod self_test;
mod swaps;
mod table;
mod terminal;
mod view;

#[cfg(test)]
mod tests;

pub use csv::csv;
pub use diff_text::diff_text;
pub use html::html;
pub use json::json;
pub use junit::junit;
pub use markdown::markdown;
pub use metrics_text::{catalogue_text, metrics_text, summary_text};
pub(crate) use number::seconds;
pub use number::{number, signed, told_apart, with_unit};
pub use terminal::terminal;

/// What nobody is to overlook, marked alike in every report.
fn warned(text: &str) -> String {
    format!("! {text}")
}
