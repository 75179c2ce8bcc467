//! Where the logs of replays go, and what stands in their heads.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};
use replay::Mode;
use schemas::{Header, RunInfo, Span};

use super::{HumanName, Replay};
use crate::cli::Common;
use crate::{logs, side_by_side};

impl Replay {
    /// Refuses a file for several results, and two logs of one name for one folder: one result would
    /// overwrite the other.
    pub(super) fn guard_outputs(&self, common: &Common, several: bool) -> Result<()> {
        let Some(output) = &self.output else { return Ok(()) };
        let is_log = output.extension().is_some_and(|extension| extension == "mcap");
        ensure!(
            !several || !is_log || output.is_dir(),
            "{}: several results go into a folder, each into a log of its own: name one, such as -o {}",
            output.display(),
            output.with_extension("").display()
        );
        if several || logs::names_folder(output) {
            logs::make_folder(output)?;
        }
        side_by_side::guard_layout(&side_by_side::layout_beside(output, several), common.force)?;
        let mut seen = BTreeMap::new();
        for log in &self.logs {
            // A log that cannot be read is written nowhere, and reported in its turn.
            let Ok(controller) =
                logs::open(log).and_then(|log| self.controller.for_log(log.header()))
            else {
                continue;
            };
            let path = logs::output_for(log, &controller.name, output, several);
            if let Some(other) = seen.insert(path.clone(), log) {
                let same = fs::canonicalize(other).ok() == fs::canonicalize(log).ok();
                ensure!(!same, "{} is named twice; name it once", log.display());
                bail!(
                    "{} and {} would both be written to {}; replay them into different folders",
                    other.display(),
                    log.display(),
                    path.display()
                );
            }
        }
        Ok(())
    }

    /// Where a replay goes; each level of the ladder into a file of its own.
    pub(super) fn output_for(
        &self,
        log: &Path,
        controller: &str,
        mode: Mode,
        output: &Path,
        several: bool,
    ) -> PathBuf {
        match human_name(mode) {
            Some(level) if self.how.human == HumanName::Ladder => {
                logs::output_for(log, &format!("{controller}.{level}"), output, several)
            }
            _ => logs::output_for(log, controller, output, several),
        }
    }
}

/// The level of the ladder; `None` in open loop.
pub(super) fn human_name(mode: Mode) -> Option<&'static str> {
    match mode {
        Mode::Open => None,
        Mode::Closed(person) => Some(person.name()),
    }
}

/// The head of a replayed log: the recording's, with the controller that was replayed.
pub fn replay_header(
    recorded: &Header,
    spec: &controller::Spec,
    mode: Mode,
    source_hash: String,
) -> Header {
    let run = RunInfo {
        mode: mode.name().to_owned(),
        driver: human_name(mode).map_or_else(|| recorded.run.driver.clone(), str::to_owned),
        source_hash,
        ..recorded.run.clone()
    };
    let period = Span::from_seconds(spec.params.control_period_s);
    logs::header(spec, recorded.scenario.clone(), recorded.run.start, period, run)
}
