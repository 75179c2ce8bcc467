//! `tandem map`: the world as a log's sonars heard it.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use clap::Args;
use replay::PlantEstimate;
use schemas::log::{LogError, WriterOptions};
use schemas::{Cell, Explored, Header, Scenario};
use serde::Serialize;

use crate::cli::Common;
use crate::status::Status;
use crate::{interrupt, logs, output};

/// Build a map from what a log's sonars heard, as a scenario
///
/// Echoes and the estimated pose alone go into it, not the world that a simulated log carries. The map
/// becomes a scenario file, with person, plant and sensors of the log, for `tandem record --scenario`
/// and `tandem replay --world`. Space that no sonar looked at is unknown, not free.
///
/// Beside it goes a log of the same name with the recorded session in the mapped world, to be looked at
/// in Foxglove: cells that are free and taken (/map), faces and walkers (/scene).
#[derive(Args)]
#[command(after_help = "\
Examples:
  tandem map session.mcap -o room.toml               # and room.mcap
  tandem replay session.mcap --mode closed --world room.toml
  tandem record --scenario room.toml --driver explorer -o again.mcap")]
pub struct Map {
    /// The log
    #[arg(value_name = "LOG")]
    log: PathBuf,
    /// The scenario to write
    #[arg(long, short, value_name = "SCENARIO.toml")]
    output: PathBuf,
}

/// What was mapped.
#[derive(Serialize)]
struct Mapped {
    log: String,
    output: String,
    view: String,
    /// Faces, and their length altogether.
    faces: usize,
    walls_m: f64,
    /// Walkers that were followed.
    walkers: usize,
    /// How much floor is free, square metres.
    free_m2: f64,
    /// Share of the wheels' travel taken as lost.
    slip: Option<f64>,
}

/// Maps a log.
pub fn of_log(log: &Path) -> Result<(replay::Map, PlantEstimate)> {
    let name = || log.display().to_string();
    let plant = PlantEstimate::of_log(logs::open_raw(log).with_context(name)?);
    let map = replay::Map::of_log(logs::open_raw(log).with_context(name)?, &plant);
    let map = map.with_context(name)?;
    // What is written, or driven in, has to be a world.
    map.scenario().check().with_context(name).context("the map is no sound world")?;
    Ok((map, plant))
}

impl Map {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let view = self.output.with_extension("mcap");
        let scenario_file = self.output.extension().is_some_and(|end| end == "toml");
        ensure!(scenario_file, "{}: a scenario is a .toml file", self.output.display());
        logs::guard_input(&self.output, &self.log)?;
        logs::guard(&self.output, common.force)?;
        let beside = || format!("beside {} goes a log to look at it by", self.output.display());
        logs::guard_input(&view, &self.log).with_context(beside)?;
        logs::guard(&view, common.force).with_context(beside)?;
        let (map, plant) = of_log(&self.log)?;
        let name = self.output.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into());
        let scenario = Scenario { name, ..map.scenario() };
        output::file(&self.output, scenario.to_toml())?;
        let damage = self.show(&view, &scenario)?;
        let mapped = Mapped {
            log: self.log.display().to_string(),
            output: self.output.display().to_string(),
            view: view.display().to_string(),
            faces: map.world().obstacles.len(),
            walls_m: map.walls_m(),
            walkers: map.world().paths.len(),
            free_m2: free_m2(map.explored()),
            slip: plant.slip.map(|slip| slip.value),
        };
        output::print(common, &mapped, text)?;
        Ok(damage.map_or(Status::Done, |damage| {
            output::note(&format!("error: {}: {damage}; mapped as far as that", mapped.log));
            Status::Differs
        }))
    }

    /// The recorded session in the mapped world, as far as the log can be read; what stands in the way
    /// of reading on is the answer.
    fn show(&self, view: &Path, scenario: &Scenario) -> Result<Option<LogError>> {
        let mut events = logs::open(&self.log)?;
        let header = Header { scenario: scenario.clone(), ..events.header().clone() };
        let name = || view.display().to_string();
        let options = WriterOptions::offline();
        let mut log = schemas::log::create(view, &header, &options).with_context(name)?;
        let damage = loop {
            interrupt::check()?;
            match events.next_event() {
                Ok(Some(event)) => log.write(&event).with_context(name)?,
                Ok(None) => break None,
                Err(error) => break Some(error),
            }
        };
        log.finish().with_context(name)?;
        Ok(damage)
    }
}

fn free_m2(explored: &Explored) -> f64 {
    let free = explored.cells().filter(|(_, cell)| *cell == Cell::Free).count();
    free as f64 * explored.cell_m * explored.cell_m
}

fn text(mapped: &Mapped) -> String {
    let mut text = format!("{}\n", mapped.log);
    // Writing to a String cannot fail.
    let _ = writeln!(text, "  faces        {}, {:.1} m of them", mapped.faces, mapped.walls_m);
    let _ = writeln!(text, "  walkers      {}", mapped.walkers);
    let _ = writeln!(text, "  free         {:.1} m²; the rest is unknown", mapped.free_m2);
    if let Some(slip) = mapped.slip {
        let _ = writeln!(text, "  slip         {:.1} % of the wheels' way", 100.0 * slip);
    }
    let _ = writeln!(text, "  written to   {}, to look at: {}", mapped.output, mapped.view);
    text
}
