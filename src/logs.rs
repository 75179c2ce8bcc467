//! Logs by path: opening them with errors that name them, naming the ones we write, and never
//! writing over one unasked.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail, ensure};
use controller::Spec;
use schemas::log::{LogError, LogReader};
use schemas::{Event, FORMAT_VERSION, Header, RunInfo, Scenario, Span, Stamped, Time};

use crate::interrupt;

/// Opens a log for one pass.
pub fn open(path: &Path) -> Result<LogReader<BufReader<File>>> {
    open_raw(path).with_context(|| path.display().to_string())
}

/// The same without naming the file, for callers that do.
pub fn open_raw(path: &Path) -> Result<LogReader<BufReader<File>>, LogError> {
    LogReader::open(path)
}

/// Shows every event of a log to its end, or as far as it can be read: what then was in the way is the answer.
///
/// # Errors
/// What is wrong with the log is more than damage, or Ctrl-C was pressed.
pub fn each_event(
    log: &mut LogReader<BufReader<File>>,
    mut show: impl FnMut(&Stamped<Event>),
) -> Result<Option<LogError>> {
    loop {
        interrupt::check()?;
        match log.next_event() {
            Ok(Some(event)) => show(&event),
            Ok(None) => return Ok(None),
            Err(error) if error.is_damage() => return Ok(Some(error)),
            Err(error) => return Err(error.into()),
        }
    }
}

/// Refuses to write where something is, unless told to, and where no folder is: it may be mistyped.
pub fn guard(path: &Path, force: bool) -> Result<()> {
    if path.exists() && !force {
        bail!("{} exists; choose another name or pass --force to overwrite it", path.display());
    }
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        let (path, shown) = (path.display(), folder.display());
        ensure!(
            folder.is_dir(),
            "cannot write {path}: there is no folder {shown}; make it first, or name another place"
        );
    }
    Ok(())
}

/// Whether a path is written as that of a folder.
pub fn names_folder(path: &Path) -> bool {
    path.as_os_str().as_encoded_bytes().ends_with(std::path::MAIN_SEPARATOR_STR.as_bytes())
}

/// Makes a folder that was named as one, where there is none yet.
pub fn make_folder(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make folder {}", folder.display()))
}

/// Refuses to write a file that is being read, whatever `--force` says.
pub fn guard_input(output: &Path, input: &Path) -> Result<()> {
    let same = match (fs::canonicalize(output), fs::canonicalize(input)) {
        (Ok(output), Ok(input)) => output == input,
        // What does not exist yet is no input.
        _ => false,
    };
    if same {
        bail!("{} is the input; name another output", output.display());
    }
    Ok(())
}

/// Where the replay of `log` goes: into the file `output` for one log, into the folder `output` for
/// several, as `LOGNAME.CONTROLLER.mcap`.
pub fn output_for(log: &Path, controller: &str, output: &Path, several: bool) -> PathBuf {
    if !several && !output.is_dir() {
        return output.to_owned();
    }
    let stem = log.file_stem().map_or_else(|| "log".into(), |stem| stem.to_string_lossy());
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let controller: String = controller.chars().map(plain).collect();
    output.join(format!("{stem}.{controller}.mcap"))
}

/// BLAKE3 of a file, in hexadecimal.
pub fn hash_file(path: &Path) -> Result<String> {
    let mut hasher = blake3::Hasher::new();
    let file = File::open(path).with_context(|| path.display().to_string())?;
    hasher.update_reader(file).with_context(|| path.display().to_string())?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// The head of a log that this program writes: what made it and with which parameters.
pub fn header(spec: &Spec, scenario: Scenario, start: Time, period: Span, run: RunInfo) -> Header {
    let params_toml = spec.params_toml();
    Header {
        run: RunInfo {
            format_version: FORMAT_VERSION,
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: env!("TANDEM_COMMIT").to_owned(),
            dirty: env!("TANDEM_DIRTY") == "true",
            controller: spec.name.clone(),
            params_hash: blake3::hash(params_toml.as_bytes()).to_hex().to_string(),
            scenario: scenario.name.clone(),
            start,
            control_period_ns: period.0,
            ..run
        },
        params_toml,
        scenario,
    }
}
