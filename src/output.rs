//! Where results, progress and diagnostics go: results to standard output, the rest to standard
//! error, bars to terminals only.

use std::io::{self, IsTerminal as _, Write as _};
use std::time::Duration;

use anyhow::Result;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use crate::cli::{Common, Format};

/// Prints a result: as JSON, or as the text that `human` writes.
pub fn print<T: Serialize>(
    common: &Common,
    result: &T,
    human: impl FnOnce(&T) -> String,
) -> Result<()> {
    let text = match common.format {
        Format::Json => serde_json::to_string_pretty(result)?,
        Format::Human => human(result),
    };
    let mut out = io::stdout().lock();
    out.write_all(text.trim_end().as_bytes())?;
    out.write_all(b"\n")?;
    out.flush()?;
    Ok(())
}

/// Says something about the run on standard error, unless told to be quiet.
pub fn say(common: &Common, text: &str) {
    if !common.quiet {
        eprintln!("{text}");
    }
}

/// The same, with `-v` only.
pub fn detail(common: &Common, text: impl FnOnce() -> String) {
    if common.verbose {
        eprintln!("{}", text());
    }
}

/// A bar over `length` units on a terminal; nothing elsewhere.
pub fn bar(common: &Common, length: u64, label: &str, template: &str) -> ProgressBar {
    let shown = !common.quiet && io::stderr().is_terminal();
    let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(length), target);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message(label.to_owned());
    if shown {
        bar.enable_steady_tick(Duration::from_millis(200));
    }
    bar
}

/// Whether the error is that nobody reads our output any more.
pub fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<io::Error>())
        .any(|cause| cause.kind() == io::ErrorKind::BrokenPipe)
}
