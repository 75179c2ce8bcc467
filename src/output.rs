//! Where results, progress and diagnostics go: results to standard output, the rest to standard
//! error, bars to terminals only.

use std::fs;
use std::io::{self, IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context as _, Result};
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
    let written = out
        .write_all(text.trim_end().as_bytes())
        .and_then(|()| out.write_all(b"\n"))
        .and_then(|()| out.flush());
    match written {
        // A reader that went away (`| head`) changes nothing about the result.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => Ok(other?),
    }
}

/// Where a file stands until it is whole: beside its place.
pub fn unfinished(path: &Path) -> PathBuf {
    let mut unfinished = path.as_os_str().to_owned();
    unfinished.push(".unfinished");
    unfinished.into()
}

/// Writes a file whole or not at all: until it is whole it stands beside its place, and what was there before
/// stays.
pub fn file(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    let cannot = || format!("cannot write {}", path.display());
    if path.exists() && !path.is_file() {
        // A pipe or a terminal takes what is written to it, and is not to be replaced.
        return fs::write(path, content).with_context(cannot);
    }
    let unfinished = unfinished(path);
    let written = fs::write(&unfinished, content).and_then(|()| fs::rename(&unfinished, path));
    if written.is_err() {
        // What cannot be removed does no harm under that name.
        let _ = fs::remove_file(&unfinished);
    }
    written.with_context(cannot)
}

/// Prints an error as the one line that it is to be.
pub fn error(error: &anyhow::Error) {
    note(&format!("error: {}", one_line(&format!("{error:#}"))));
}

/// A line on standard error. That nobody can read it is no reason to fail.
pub fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// A message in one line: excerpts of a file, as the TOML reader adds them, are left out.
pub fn one_line(text: &str) -> String {
    let excerpt = |line: &str| {
        line.trim_start_matches(|c: char| c.is_ascii_digit() || c == ' ').starts_with('|')
    };
    let lines = text.lines().filter(|line| !excerpt(line)).map(str::trim);
    lines.filter(|line| !line.is_empty()).collect::<Vec<_>>().join(": ")
}

/// Says something about the run on standard error, unless told to be quiet.
pub fn say(common: &Common, text: &str) {
    if !common.quiet {
        note(text);
    }
}

/// The same, with `-v` only.
pub fn detail(common: &Common, text: impl FnOnce() -> String) {
    if common.verbose {
        note(&text());
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

#[cfg(test)]
mod tests {
    use std::fs;

    use super::{file, one_line};

    /// A file is replaced whole; where it cannot be, nothing is left of the attempt.
    #[test]
    fn files_are_written_whole_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("report.svg");
        for text in ["the first, a longer one", "the second"] {
            file(&path, text).expect("writable");
            assert_eq!(fs::read_to_string(&path).expect("written"), text);
        }
        let missing = folder.path().join("nowhere").join("report.svg");
        assert!(file(&missing, "x").is_err());
        assert!(file(folder.path(), "x").is_err());
        let left: Vec<_> = fs::read_dir(folder.path()).expect("there").collect();
        assert_eq!(left.len(), 1, "{left:?}");
    }

    #[test]
    fn errors_are_one_line() {
        let toml = "TOML parse error at line 2, column 1\n  |\n2 | duration = 3.0\n  | ^^^^^^^^\nunknown field `duration`\n";
        assert_eq!(
            one_line(toml),
            "TOML parse error at line 2, column 1: unknown field `duration`"
        );
        assert_eq!(one_line("just so"), "just so");
    }
}
