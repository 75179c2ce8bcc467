//! A fixture: a recorded session, the controller it is replayed with, and the golden result.
//!
//! A folder with `fixture.toml`, `session.mcap`, and, once approved, `golden.toml` and
//! `golden.mcap` (the replayed steps and commands, so that a later difference has a field and a
//! time).

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, anyhow, bail};
use compare::golden::Golden;
use compare::{Diff, Measured, Meter, Tolerances};
use replay::{Fault, Faults, Replay};
use schemas::log::WriterOptions;
use schemas::{Event, Header, Stamped};
use serde::Deserialize;

use crate::arm::{caught, made};
use crate::command::replay::{HumanName, ModeName, replay_header};
use crate::controller_choice::ControllerChoice;
use crate::{interrupt, logs};

/// A fixture on disk.
#[derive(Clone)]
pub struct Fixture {
    /// Its folder.
    pub folder: PathBuf,
    controller: ControllerChoice,
    mode: ModeName,
    faults: Faults,
}

/// `fixture.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Settings {
    /// What the fixture is for.
    #[serde(rename = "summary")]
    _summary: String,
    /// How its session was made.
    #[serde(rename = "made_by")]
    _made_by: String,
    controller: String,
    mode: String,
    /// What is put between sensors and controller, as `tandem replay --fault` takes it.
    #[serde(default)]
    faults: Vec<String>,
    #[serde(default)]
    fault_seed: u64,
}

/// What a fixture gives today.
pub struct Today {
    /// For `golden.toml`.
    pub golden: Golden,
    /// For `golden.mcap`.
    pub header: Header,
    /// Replayed steps and commands.
    pub events: Vec<Stamped<Event>>,
}

/// Every fixture below a folder, or the folder itself if it is one, by name.
pub fn find(folder: &Path) -> Result<Vec<Fixture>> {
    if folder.join("fixture.toml").is_file() {
        return Ok(vec![Fixture::read(folder)?]);
    }
    let entries = fs::read_dir(folder).with_context(|| {
        format!(
            "{}: fixtures are looked for there, as in a clone of the repository; name another folder of them",
            folder.display()
        )
    })?;
    let mut folders = Vec::new();
    for entry in entries {
        let path = entry.with_context(|| folder.display().to_string())?.path();
        if path.join("fixture.toml").is_file() {
            folders.push(path);
        }
    }
    folders.sort();
    if folders.is_empty() {
        bail!(
            "{}: no fixture there (a folder with session.mcap and fixture.toml in it); name a folder of them",
            folder.display()
        );
    }
    folders.iter().map(|folder| Fixture::read(folder)).collect()
}

impl Fixture {
    fn read(folder: &Path) -> Result<Fixture> {
        let file = folder.join("fixture.toml");
        let name = || file.display().to_string();
        let text = fs::read_to_string(&file).with_context(name)?;
        let settings: Settings = toml::from_str(&text).with_context(name)?;
        let mode = match settings.mode.as_str() {
            "open" => ModeName::Open,
            "closed" => ModeName::Closed,
            other => {
                return Err(anyhow!("mode = \"{other}\": expected open or closed"))
                    .with_context(name);
            }
        };
        let controller = settings.controller.parse().with_context(name)?;
        let faults = settings.faults.iter().map(|fault| fault.parse());
        let faults = faults
            .collect::<Result<Vec<Fault>, _>>()
            .and_then(|faults| Faults::new(faults, settings.fault_seed))
            .with_context(name)?;
        Ok(Fixture { folder: folder.to_owned(), controller, mode, faults })
    }

    /// Where its golden summary stands.
    pub fn golden_toml(&self) -> PathBuf {
        self.folder.join("golden.toml")
    }

    /// Where its golden run stands.
    pub fn golden_mcap(&self) -> PathBuf {
        self.folder.join("golden.mcap")
    }

    /// Replays the session with the controller that the fixture names and today's defaults.
    pub fn replay(&self) -> Result<Today> {
        let session = self.folder.join("session.mcap");
        let name = || session.display().to_string();
        let header = logs::open(&session)?.header().clone();
        let spec = self.controller.for_log(&header).with_context(name)?;
        let mode = self.mode.with(HumanName::Playback, replay::Gains::PRIOR);
        made(&header, &spec).with_context(name)?;
        let replay = Replay::new(|| logs::open_raw(&session), &spec, mode).with_context(name)?;
        let mut replay = replay.under(self.faults.clone());
        let mut meter = Meter::new(&header);
        let mut events = Vec::new();
        while let Some(event) = caught(|| replay.next_event()).with_context(name)? {
            interrupt::check()?;
            meter.observe(&event);
            if matches!(event.value, Event::Step(_) | Event::Command(_)) {
                events.push(event);
            }
        }
        let outcome = replay.finish().with_context(name)?;
        if let Some(damage) = outcome.damage {
            return Err(anyhow!(damage)).with_context(name);
        }
        let measured: Measured = meter.finish().with_context(name)?;
        let golden = Golden::of(&spec.name, mode.name(), &outcome.output_hash, &measured);
        let header = replay_header(&header, &spec, mode, logs::hash_file(&session)?);
        Ok(Today { golden, header, events })
    }

    /// The golden run (A) against today's (B).
    pub fn diff(&self, today: &Today) -> Result<Diff> {
        let path = self.golden_mcap();
        let mut golden = logs::open(&path)?;
        let start = golden.header().run.start;
        let mut events = today.events.iter().cloned();
        compare::diff::<anyhow::Error, _>(
            &Tolerances::exact(),
            (start, || golden.next_event().with_context(|| path.display().to_string())),
            (today.header.run.start, || Ok(events.next())),
        )
    }

    /// Makes today's result the golden one.
    pub fn write(&self, today: &Today, golden: &Golden) -> Result<()> {
        let path = self.golden_mcap();
        let name = || path.display().to_string();
        let options = WriterOptions { view: false, ..WriterOptions::offline() };
        let mut log = schemas::log::create(&path, &today.header, &options).with_context(name)?;
        for event in &today.events {
            log.write(event).with_context(name)?;
        }
        log.finish().with_context(name)?;
        let path = self.golden_toml();
        fs::write(&path, golden.to_toml()?).with_context(|| path.display().to_string())
    }
}
