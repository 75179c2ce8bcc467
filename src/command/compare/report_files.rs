//! The files of a report. What cannot be written is told, and keeps neither the verdict nor the other files back.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use ::compare::{Comparison, report};
use anyhow::{Context as _, Error, Result};

use crate::{logs, output};

/// Their names.
const NAMES: [&str; 5] = ["report.html", "report.md", "report.json", "junit.xml", "metrics.csv"];

/// The files of a report that stand.
pub(super) struct ReportFiles {
    stand: Vec<PathBuf>,
    /// What the comparison said of its own report when they were written.
    told: Vec<String>,
    /// Why others do not stand.
    pub(super) unwritten: Vec<Error>,
}

impl ReportFiles {
    /// Where they go, checked before the work begins rather than after it.
    pub(super) fn guarded(folder: &Path, force: bool) -> Result<Vec<PathBuf>> {
        logs::make_folder(folder)?;
        let files: Vec<PathBuf> = NAMES.iter().map(|name| folder.join(name)).collect();
        for file in &files {
            logs::guard(file, force)?;
        }
        Ok(files)
    }

    /// Writes them, the small ones first, and notes in the comparison which of them stand.
    pub(super) fn write(comparison: &mut Comparison, paths: Vec<PathBuf>) -> ReportFiles {
        comparison.report = paths.iter().map(|path| path.display().to_string()).collect();
        let told = comparison.report.clone();
        let unwritten = write(comparison, &paths);
        let failed = |path: &PathBuf| unwritten.iter().any(|(unwritten, _)| unwritten == path);
        let stand: Vec<PathBuf> = paths.into_iter().filter(|path| !failed(path)).collect();
        comparison.report = stand.iter().map(|path| path.display().to_string()).collect();
        let unwritten = unwritten.into_iter().map(|(_, error)| error).collect();
        ReportFiles { stand, told, unwritten }
    }

    /// Writes them anew where the comparison says something else of its report by now, such as where both
    /// arms stand side by side. Those that cannot be stay as they were. What could not be written of all.
    pub(super) fn complete(self, comparison: &Comparison) -> Vec<Error> {
        let mut unwritten = self.unwritten;
        if comparison.report != self.told {
            let old = write(comparison, &self.stand).into_iter();
            let says = "it stands, but for which other files there are";
            unwritten.extend(
                old.map(|(path, error)| error.context(format!("{}: {says}", path.display()))),
            );
        }
        unwritten
    }
}

/// Writes these; what could not be written, and why.
fn write(comparison: &Comparison, paths: &[PathBuf]) -> Vec<(PathBuf, Error)> {
    let mut texts: Vec<(&PathBuf, Result<String>)> =
        paths.iter().map(|path| (path, text(comparison, path))).collect();
    // On a disk that is nearly full as many as there is room for.
    texts.sort_by_key(|(_, text)| text.as_ref().map_or(0, String::len));
    let written = texts
        .into_iter()
        .map(|(path, text)| (path, text.and_then(|text| output::file(path, text))));
    written.filter_map(|(path, written)| Some((path.clone(), written.err()?))).collect()
}

fn text(comparison: &Comparison, path: &Path) -> Result<String> {
    let text = match path.extension().and_then(|extension| extension.to_str()) {
        Some("html") => report::html(comparison).map_err(Error::from),
        Some("md") => Ok(report::markdown(comparison)),
        Some("xml") => Ok(report::junit(comparison)),
        Some("csv") => Ok(report::csv(comparison)),
        _ => report::json(comparison).map_err(Error::from),
    };
    text.with_context(|| path.display().to_string())
}

/// Appends the Markdown report to a file.
pub(super) fn append(comparison: &Comparison, path: &Path) -> Result<()> {
    let name = || format!("cannot append to {}", path.display());
    let mut file = OpenOptions::new().create(true).append(true).open(path).with_context(name)?;
    file.write_all(report::markdown(comparison).as_bytes()).with_context(name)
}
