//! `tandem demo`: the whole story in a minute.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use clap::Args;
use compare::Comparison;
use replay::Mode;
use schemas::log::LogReader;
use serde::Serialize;

use crate::cli::Common;
use crate::command::compare::{Compare, Compared};
use crate::command::record::{Record, SensorsName};
use crate::command::replay::{HumanName, ModeName, PlantName};
use crate::controller_choice::ControllerChoice;
use crate::faults::FaultArgs;
use crate::status::Status;
use crate::{fleet, interrupt, logs, output};

/// Where everything goes.
const FOLDER: &str = "tandem-demo";

/// Kinds of random rooms and people, and how many sessions of each.
const KINDS: [&str; 6] =
    ["rect:goal", "rect:joystick", "slant:goal", "slant:joystick", "disc:goal", "disc:joystick"];
const SESSIONS_OF_EACH_KIND: u32 = 4;

/// Who drove while the random sessions were recorded.
const RECORDED_WITH: [&str; 2] = ["human", "paper-kinematic"];

/// The whole story in a minute: record, replay, compare, and where to look.
///
/// Writes into `tandem-demo/`; `--force` makes an earlier demo there anew.
#[derive(Args)]
#[command(after_help = "Exit status: 1 when a replay is not the recording, bit for bit.")]
pub struct Demo {}

#[derive(Serialize)]
struct Story {
    folder: String,
    replays: Vec<ReplayedLine>,
    comparisons: Vec<ComparedLine>,
}

#[derive(Serialize)]
struct ReplayedLine {
    log: String,
    mode: &'static str,
    steps: u64,
    engaged_steps: u64,
    identical_to_recorded: bool,
    output_hash: String,
}

#[derive(Serialize)]
struct ComparedLine {
    recorded_with: &'static str,
    comparison: Comparison,
}

impl Demo {
    #[expect(clippy::unused_self, reason = "every command is run alike")]
    pub fn run(&self, common: &Common) -> Result<Status> {
        let folder = Path::new(FOLDER);
        prepare(folder, common.force)?;
        let quiet = Common { force: true, quiet: true, ..common.clone() };

        output::say(
            common,
            "1. Record: the paper's first experiment, and random rooms with other people.",
        );
        let lab = folder.join("case1-lab.mcap");
        record(&quiet, "case1-lab", "tandem-kinematic", None, &lab)?;
        let mut fleets = Vec::new();
        for recorded_with in RECORDED_WITH {
            let logs = record_fleet(common, &quiet, folder, recorded_with)?;
            fleets.push((recorded_with, logs));
        }

        output::say(
            common,
            "2. Replay: with the controller that recorded it, a log comes back bit for bit.",
        );
        let replays = [ModeName::Open, ModeName::Closed]
            .map(|mode| replay(&lab, mode.with(HumanName::Playback, replay::Gains::PRIOR)))
            .into_iter()
            .collect::<Result<Vec<_>>>()?;
        for line in &replays {
            let verdict = if line.identical_to_recorded { "identical" } else { "NOT IDENTICAL" };
            output::say(
                common,
                &format!(
                    "   {:6} loop: {} steps, {verdict}, hash {:.16}…",
                    line.mode, line.steps, line.output_hash
                ),
            );
        }

        output::say(
            common,
            "3. Compare: the law as printed against the corrected one, on the same people.",
        );
        let mut comparisons = Vec::new();
        for (recorded_with, logs) in fleets {
            let compare = Compare {
                a: "paper-kinematic".parse()?,
                b: Some("tandem-kinematic".parse()?),
                logs,
                mode: ModeName::Closed,
                human: HumanName::Playback,
                hang_after: std::time::Duration::from_secs(30),
                plant: PlantName::Recorded,
                faults: FaultArgs::default(),
                gate: None,
                report: Some(folder.join(format!("report-{recorded_with}"))),
                summary: None,
                ab: 1,
                attribute: false,
                self_test: false,
                alarms: 0,
            };
            let Compared { comparison, unwritten } = compare.compare(&quiet)?;
            if let Some(error) = unwritten.into_iter().next() {
                return Err(error);
            }
            comparisons.push(ComparedLine { recorded_with, comparison });
        }

        let identical = replays.iter().all(|line| line.identical_to_recorded);
        let story = Story { folder: FOLDER.to_owned(), replays, comparisons };
        output::print(common, &story, text)?;
        Ok(if identical { Status::Done } else { Status::Differs })
    }
}

/// Makes the folder, or, where it may, clears what an earlier demo left there and nothing else.
fn prepare(folder: &Path, force: bool) -> Result<()> {
    if folder.exists() {
        ensure!(force, "{FOLDER} exists; pass --force to make the demo anew there");
        let mut left = vec![folder.join("case1-lab.mcap")];
        for recorded_with in RECORDED_WITH {
            left.push(folder.join(format!("recorded-with-{recorded_with}")));
            left.push(folder.join(format!("report-{recorded_with}")));
        }
        for path in left {
            if path.is_dir() {
                fs::remove_dir_all(&path).with_context(|| path.display().to_string())?;
            } else if path.exists() {
                fs::remove_file(&path).with_context(|| path.display().to_string())?;
            }
        }
    }
    logs::make_folder(folder)
}

fn record(
    common: &Common,
    scenario: &str,
    controller: &str,
    sensors: Option<SensorsName>,
    log: &Path,
) -> Result<()> {
    interrupt::check()?;
    Record {
        from: "sim".to_owned(),
        scenario: scenario.to_owned(),
        controller: controller.parse::<ControllerChoice>()?,
        driver: None,
        sensors,
        seed: 0,
        duration: None,
        operator: String::new(),
        note: "recorded by tandem demo".to_owned(),
        realtime: false,
        no_view: false,
        output: log.to_owned(),
    }
    .record(common)?;
    Ok(())
}

fn record_fleet(
    common: &Common,
    quiet: &Common,
    folder: &Path,
    controller: &str,
) -> Result<Vec<PathBuf>> {
    let folder = folder.join(format!("recorded-with-{controller}"));
    logs::make_folder(&folder)?;
    let mut scenarios = Vec::new();
    for kind in KINDS {
        for number in 1..=SESSIONS_OF_EACH_KIND {
            scenarios.push(format!("random:{kind}:{number}"));
        }
    }
    let label = format!("recording with {controller}");
    let results = fleet::each(common, &scenarios, &label, |scenario| {
        let log = folder.join(format!("{}.mcap", scenario.replace(':', "-")));
        // Exact rays: what differs is then the law, not the luck of an echo.
        record(quiet, scenario, controller, Some(SensorsName::Exact), &log)?;
        Ok(log)
    });
    results.into_iter().collect()
}

fn replay(log: &Path, mode: Mode) -> Result<ReplayedLine> {
    let header = LogReader::open(log)?.header().clone();
    let spec = ControllerChoice::Recorded.for_log(&header)?;
    let mut replay = replay::Replay::new(|| logs::open_raw(log), &spec, mode)?;
    while replay.next_event().is_some() {
        interrupt::check()?;
    }
    let outcome = replay.finish()?;
    Ok(ReplayedLine {
        log: log.display().to_string(),
        mode: mode.name(),
        steps: outcome.steps,
        engaged_steps: outcome.engaged_steps,
        identical_to_recorded: outcome.identical_to_recorded,
        output_hash: outcome.output_hash,
    })
}

fn text(story: &Story) -> String {
    let mut text = String::new();
    for line in &story.comparisons {
        let _ = writeln!(text, "\n── people recorded with `{}` ──\n", line.recorded_with);
        text += &compare::report::terminal(&line.comparison);
    }
    let folder = &story.folder;
    let _ = write!(
        text,
        "
Look at it:
  a page to read     {folder}/report-human/report.html
  a log to watch     {folder}/case1-lab.mcap (open in Foxglove; the layout is attached)

Try your own:
  tandem compare --a tandem-kinematic --b tandem-kinematic:gamma3=4 \\
      {folder}/recorded-with-human/*.mcap
"
    );
    text
}
