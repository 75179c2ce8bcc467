//! Recording and replay in one log, and the layout that shows both.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, anyhow, bail};
use schemas::log::{Stop, WriteAbError, WriterOptions, write_ab};
use schemas::view::LAYOUT_AB;
use schemas::{Event, Header, Stamped};

use crate::output;

/// Writes two runs, A and B, side by side into a file. Where they were `stopped` before their end, which is
/// asked last, the file says so and by what. Until they are whole they stand in another one beside it, so
/// that what a failing run leaves behind is never taken for a run.
pub fn write(
    path: &Path,
    headers: [&Header; 2],
    a: impl FnMut() -> Result<Option<Stamped<Event>>>,
    b: impl FnMut() -> Result<Option<Stamped<Event>>>,
    stopped: impl FnOnce() -> Option<Stop>,
) -> Result<()> {
    let cannot = || format!("cannot write {}", path.display());
    let unfinished = output::unfinished(path);
    let file = BufWriter::new(File::create(&unfinished).with_context(cannot)?);
    let written = match write_ab(file, headers, &WriterOptions::offline(), a, b, stopped) {
        Ok(_) => fs::rename(&unfinished, path).with_context(cannot),
        Err(WriteAbError::Run(error)) => Err(error),
        Err(WriteAbError::Log(error)) => Err(anyhow!(error)).with_context(cannot),
    };
    if written.is_err() {
        // What cannot be removed does no harm under that name.
        let _ = fs::remove_file(&unfinished);
    }
    written
}

/// Where the layout goes: beside the one file, or once into the folder.
pub fn layout_beside(output: &Path, several: bool) -> PathBuf {
    if several || output.is_dir() {
        output.join("layout.json")
    } else {
        output.with_extension("layout.json")
    }
}

/// Refuses to write over a layout that is another one.
pub fn guard_layout(path: &Path, force: bool) -> Result<()> {
    if !force && path.exists() && fs::read(path).ok().as_deref() != Some(LAYOUT_AB.as_bytes()) {
        bail!("{} exists; choose another name or pass --force to overwrite it", path.display());
    }
    Ok(())
}

/// Writes the layout.
pub fn write_layout(path: &Path) -> Result<()> {
    output::file(path, LAYOUT_AB)
}
