//! The folder beside a report in which both arms of some logs stand side by side, for a viewer.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use ::compare::Comparison;
use anyhow::{Context as _, Result, bail};

use crate::{interrupt, logs, side_by_side};

/// Its name, from where the report is.
const NAME: &str = "ab";

/// That folder.
pub(super) struct SideBySide(PathBuf);

impl SideBySide {
    /// The folder beside a report. It may hold none of the logs that are compared: what is there goes
    /// once the comparison is made.
    pub(super) fn into(report: &Path, force: bool, logs: &[PathBuf]) -> Result<SideBySide> {
        let folder = report.join(NAME);
        logs::guard(&folder, force)?;
        let own = fs::canonicalize(&folder).ok();
        for log in logs {
            let place = fs::canonicalize(log).ok();
            if own.is_some() && place.as_deref().and_then(Path::parent) == own.as_deref() {
                let (log, folder) = (log.display(), folder.display());
                bail!("{log} is an input, and {folder} is written anew; name another --report");
            }
        }
        Ok(SideBySide(folder))
    }

    /// Takes away what an earlier comparison left there: it would pass for this one's.
    pub(super) fn clear(&self) -> Result<()> {
        if !self.0.is_dir() {
            return Ok(());
        }
        let name = || self.0.display().to_string();
        for entry in fs::read_dir(&self.0).with_context(name)? {
            let path = entry.with_context(name)?.path();
            if path.extension().is_some_and(|extension| extension == "mcap") {
                fs::remove_file(&path).with_context(|| path.display().to_string())?;
            }
        }
        Ok(())
    }

    /// Writes the logs with most to see, at most `most`, and notes in the comparison where they are. The
    /// first that cannot be written is the last; the ones before it stay.
    pub(super) fn write(
        &self,
        comparison: &mut Comparison,
        most: usize,
        write: impl Fn(usize, &Path) -> Result<()>,
    ) -> Result<()> {
        let mut names = BTreeSet::new();
        let mut logs = comparison.logs_to_see().into_iter().take(most);
        let one = |log: usize| {
            interrupt::check()?;
            fs::create_dir_all(&self.0).with_context(|| self.0.display().to_string())?;
            let name = file_name(&comparison.logs[log].log, log, &mut names);
            let path = self.0.join(&name);
            write(log, &path).with_context(|| comparison.logs[log].log.clone())?;
            comparison.logs[log].side_by_side = Some(format!("{NAME}/{name}"));
            comparison.report.push(path.display().to_string());
            Ok(())
        };
        let written = logs.try_for_each(one);
        if comparison.logs.iter().any(|log| log.side_by_side.is_some()) {
            let layout = self.0.join("layout.json");
            side_by_side::write_layout(&layout)?;
            comparison.report.push(layout.display().to_string());
        }
        written
    }
}

/// A name that is safe in a file system and in a link, and no other log's.
fn file_name(log: &str, number: usize, taken: &mut BTreeSet<String>) -> String {
    let stem =
        Path::new(log).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    let stem: String = stem.chars().map(plain).collect();
    let name = format!("{stem}.mcap");
    if taken.insert(name.clone()) {
        return name;
    }
    let mut numbered = number + 1;
    loop {
        let name = format!("{stem}-{numbered}.mcap");
        if taken.insert(name.clone()) {
            return name;
        }
        numbered += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_safe_and_differ() {
        let mut taken = BTreeSet::new();
        assert_eq!(file_name("logs/a b\"<1>.mcap", 0, &mut taken), "a_b__1_.mcap");
        assert_eq!(file_name("x/session.mcap", 1, &mut taken), "session.mcap");
        assert_eq!(file_name("y/session.mcap", 2, &mut taken), "session-3.mcap");
        assert_eq!(file_name("session-3.mcap", 2, &mut taken), "session-3-3.mcap");
        assert_eq!(file_name("z/session.mcap", 2, &mut taken), "session-4.mcap");
    }
}
