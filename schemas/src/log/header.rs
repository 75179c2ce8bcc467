//! The head of a log: the metadata record `tandem.run` and the attachments.

use std::collections::BTreeMap;

use super::{Arm, LogError};
use crate::{FORMAT_VERSION, Header, RunInfo, Scenario, Time};

/// The first version of the log format.
const OLDEST_VERSION: u32 = 1;

/// Name of the metadata record.
pub(super) const RUN: &str = "tandem.run";
/// Name of the metadata record at the end of a log whose writing was stopped before the end of its run.
pub(super) const STOPPED: &str = "tandem.stopped";
/// Key in it that says what stopped it; the first marks had none.
pub(super) const STOPPED_BY: &str = "by";
/// Name of the attachment with every parameter of the controller that drove.
pub(super) const PARAMS: &str = "params.toml";
/// Name of the attachment with the scenario.
pub(super) const SCENARIO: &str = "scenario.toml";
/// Name of the attachment with the viewers' layout.
pub(super) const LAYOUT: &str = "layout.json";

/// Name of a run's metadata record. B's head is the log's own.
pub(super) fn run_name(arm: Option<Arm>) -> String {
    match arm {
        None | Some(Arm::B) => RUN.to_owned(),
        Some(Arm::A) => format!("{RUN}.A"),
    }
}

/// Name of a run's attachment.
pub(super) fn attachment_name(arm: Option<Arm>, name: &str) -> String {
    match arm {
        None | Some(Arm::B) => name.to_owned(),
        Some(Arm::A) => format!("A/{name}"),
    }
}

/// The metadata record's key-value pairs.
pub(super) fn to_map(run: &RunInfo) -> BTreeMap<String, String> {
    let pairs = [
        ("format_version", run.format_version.to_string()),
        ("program_version", run.program_version.clone()),
        ("commit", run.commit.clone()),
        ("dirty", run.dirty.to_string()),
        ("controller", run.controller.clone()),
        ("params_hash", run.params_hash.clone()),
        ("seed", run.seed.to_string()),
        ("scenario", run.scenario.clone()),
        ("sensors", run.sensors.clone()),
        ("driver", run.driver.clone()),
        ("mode", run.mode.clone()),
        ("operator", run.operator.clone()),
        ("note", run.note.clone()),
        ("start_ns", run.start.0.to_string()),
        ("control_period_ns", run.control_period_ns.to_string()),
        ("source_hash", run.source_hash.clone()),
    ];
    pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

/// Reads the metadata record back. Keys that a later version added are ignored.
pub(super) fn from_map(map: &BTreeMap<String, String>) -> Result<RunInfo, LogError> {
    // The version first: what a newer format means by the other keys is not known here.
    let format_version = number(map, "format_version")?;
    let format_version = u32::try_from(format_version).unwrap_or(u32::MAX);
    if format_version > FORMAT_VERSION {
        return Err(LogError::TooNew { found: format_version, known: FORMAT_VERSION });
    }
    if format_version < OLDEST_VERSION {
        return Err(LogError::Header(format!(
            "log format version {format_version} is older than {OLDEST_VERSION}, the first there was"
        )));
    }
    let text = |key: &str| map.get(key).cloned().unwrap_or_default();
    Ok(RunInfo {
        format_version,
        program_version: text("program_version"),
        commit: text("commit"),
        dirty: text("dirty") == "true",
        controller: text("controller"),
        params_hash: text("params_hash"),
        seed: number(map, "seed")?,
        scenario: text("scenario"),
        sensors: text("sensors"),
        driver: text("driver"),
        mode: text("mode"),
        operator: text("operator"),
        note: text("note"),
        start: Time(number(map, "start_ns")?),
        control_period_ns: number(map, "control_period_ns")?,
        source_hash: text("source_hash"),
    })
}

fn number(map: &BTreeMap<String, String>, key: &str) -> Result<u64, LogError> {
    let text =
        map.get(key).ok_or_else(|| LogError::Header(format!("`{RUN}` lacks the key `{key}`")))?;
    text.parse().map_err(|_| {
        LogError::Header(format!("`{key}` in `{RUN}` is {text:?}, not a whole number"))
    })
}

/// What has been found so far of a run's head.
#[derive(Debug, Default)]
pub(super) struct HeadParts {
    run: Option<RunInfo>,
    params_toml: Option<String>,
    scenario: Option<Scenario>,
}

impl HeadParts {
    /// Takes in a metadata record, if it is that of this run.
    pub(super) fn describe(
        &mut self,
        arm: Option<Arm>,
        name: &str,
        map: &BTreeMap<String, String>,
    ) -> Result<(), LogError> {
        if name == run_name(arm) {
            self.run = Some(from_map(map)?);
        }
        Ok(())
    }

    /// Takes in an attachment, if it is one that this run's head needs.
    pub(super) fn attach(
        &mut self,
        arm: Option<Arm>,
        name: &str,
        data: &[u8],
    ) -> Result<(), LogError> {
        let text = || {
            std::str::from_utf8(data)
                .map_err(|_| LogError::Header(format!("attachment `{name}` is not UTF-8 text")))
        };
        if name == attachment_name(arm, PARAMS) {
            self.params_toml = Some(text()?.to_owned());
        } else if name == attachment_name(arm, SCENARIO) {
            let scenario = Scenario::from_toml(text()?);
            self.scenario = Some(scenario.map_err(|error| {
                LogError::Header(format!("attachment `{name}`: {}", first_line(&error)))
            })?);
        }
        Ok(())
    }

    /// Whether there was anything of it.
    pub(super) fn is_there(&self) -> bool {
        self.run.is_some()
    }

    /// The whole head, or what is missing of it.
    pub(super) fn complete(self) -> Result<Header, LogError> {
        let missing = |what: &str| {
            LogError::NotASession(format!("there is no {what} before the first message"))
        };
        Ok(Header {
            run: self.run.ok_or_else(|| missing("metadata record `tandem.run`"))?,
            params_toml: self.params_toml.ok_or_else(|| missing("attachment `params.toml`"))?,
            scenario: self.scenario.ok_or_else(|| missing("attachment `scenario.toml`"))?,
        })
    }
}

/// TOML errors draw a picture over several lines; one says what is wrong.
fn first_line(error: &crate::ScenarioError) -> String {
    match error {
        crate::ScenarioError::Toml(error) => error.message().to_owned(),
        crate::ScenarioError::Value(what) => what.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::tests::session::header;

    #[test]
    fn the_keys_are_those_that_old_logs_have() {
        // Format version 1. Keys may be added; taking one away or renaming it makes old logs
        // unreadable and needs a new format version with an upgrade.
        let keys = [
            "commit",
            "control_period_ns",
            "controller",
            "dirty",
            "driver",
            "format_version",
            "mode",
            "note",
            "operator",
            "params_hash",
            "program_version",
            "scenario",
            "seed",
            "sensors",
            "source_hash",
            "start_ns",
        ];
        let run = header().run;
        assert_eq!(to_map(&run).keys().map(String::as_str).collect::<Vec<_>>(), keys);
        assert_eq!(from_map(&to_map(&run)).expect("its own"), run);
    }
}
