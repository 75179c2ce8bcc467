//! `tandem metrics`: runs measured, or the metrics explained.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, anyhow};
use clap::Args;
use compare::{Better, CATALOGUE, Group, Measured, Meter, MetricSummary, report, summarize};
use schemas::log::LogError;
use serde::Serialize;

use crate::cli::{Common, Format};
use crate::status::Status;
use crate::{fleet, logs, output};

/// Up to this many runs are shown side by side unless told otherwise.
const SIDE_BY_SIDE: usize = 4;

/// Measure runs; without a run, list and explain the metrics.
///
/// A few runs are shown side by side; of many, each metric's mean, range and worst run. A log that is cut
/// off or damaged is measured as far as it goes, and said to be.
#[derive(Args)]
#[command(after_help = "Exit status: 1 when a damaged log could be measured in part only.")]
pub struct Metrics {
    /// The runs: recorded or replayed logs
    #[arg(value_name = "RUN", conflicts_with = "list")]
    runs: Vec<PathBuf>,
    /// A column for each run, however many there are
    #[arg(long)]
    each: bool,
    /// List and explain the metrics: name, unit, which way is better, formula, source
    #[arg(long)]
    list: bool,
}

#[derive(Serialize)]
struct Runs {
    runs: Vec<MeasuredRun>,
    summary: Vec<MetricSummary>,
}

#[derive(Serialize)]
struct MeasuredRun {
    run: String,
    metrics: BTreeMap<&'static str, Reading>,
    /// Whether the log could be read to its end.
    whole: bool,
    /// What was in the way.
    damage: Option<String>,
    error: Option<String>,
}

#[derive(Serialize)]
struct Reading {
    value: Option<f64>,
    unit: &'static str,
}

#[derive(Serialize)]
struct Row {
    name: &'static str,
    unit: &'static str,
    better: Better,
    group: Group,
    primary: bool,
    formula: &'static str,
    source: &'static str,
}

impl Metrics {
    pub fn run(&self, common: &Common) -> Result<Status> {
        if self.runs.is_empty() {
            let rows: Vec<Row> = CATALOGUE
                .iter()
                .map(|metric| Row {
                    name: metric.name,
                    unit: metric.unit,
                    better: metric.better,
                    group: metric.group,
                    primary: metric.primary,
                    formula: metric.formula,
                    source: metric.source,
                })
                .collect();
            output::print(common, &rows, |_| report::catalogue_text())?;
            return Ok(Status::Done);
        }
        let results = fleet::each(common, &self.runs, "measuring", |run| measure_part(run));
        let mut status = Status::Done;
        for (run, result) in self.runs.iter().zip(&results) {
            match result {
                Ok(Part { damage: None, .. }) => {}
                Ok(Part { damage: Some(damage), .. }) => {
                    status = status.worse(Status::Differs);
                    let run = run.display();
                    output::note(&format!("error: {run}: {damage}; measured as far as that"));
                }
                Err(error) => {
                    status = status.worse(Status::of_error(error));
                    output::error(error);
                }
            }
        }
        let rows: Vec<MeasuredRun> =
            self.runs.iter().zip(&results).map(|(run, result)| row(run, result)).collect();
        let named = |(run, result): (&PathBuf, Result<Part>)| {
            let Part { measured, damage } = result.ok()?;
            let part = if damage.is_some() { " (part)" } else { "" };
            Some((format!("{}{part}", run.display()), measured))
        };
        let measured: Vec<(String, Measured)> =
            self.runs.iter().zip(results).filter_map(named).collect();
        let runs = Runs { runs: rows, summary: summarize(&measured) };
        if measured.is_empty() && common.format == Format::Human {
            // The errors have told all that there is.
            return Ok(status);
        }
        output::print(common, &runs, |_| {
            if self.each || measured.len() <= SIDE_BY_SIDE {
                report::metrics_text(&measured)
            } else {
                report::summary_text(&measured)
            }
        })?;
        Ok(status)
    }
}

fn row(run: &Path, result: &Result<Part>) -> MeasuredRun {
    let run = run.display().to_string();
    match result {
        Err(error) => MeasuredRun {
            run,
            metrics: BTreeMap::new(),
            whole: false,
            damage: None,
            error: Some(format!("{error:#}")),
        },
        Ok(Part { measured, damage }) => MeasuredRun {
            run,
            metrics: CATALOGUE
                .iter()
                .map(|metric| {
                    let value = measured.metrics.get(metric.name);
                    (metric.name, Reading { value, unit: metric.unit })
                })
                .collect(),
            whole: damage.is_none(),
            damage: damage.as_ref().map(LogError::to_string),
            error: None,
        },
    }
}

/// A run as far as its log can be read.
struct Part {
    measured: Measured,
    /// What was in the way of reading on.
    damage: Option<LogError>,
}

/// Measures the run that a log holds, which has to be whole.
pub fn measure(run: &Path) -> Result<Measured> {
    let Part { measured, damage } = measure_part(run)?;
    match damage {
        None => Ok(measured),
        Some(damage) => Err(anyhow!(damage).context(run.display().to_string())),
    }
}

/// The same as far as the log can be read.
fn measure_part(run: &Path) -> Result<Part> {
    let name = || run.display().to_string();
    let mut log = logs::open(run)?;
    let mut meter = Meter::new(log.header());
    let damage = logs::each_event(&mut log, |event| meter.observe(event)).with_context(name)?;
    match (meter.finish(), damage) {
        (Ok(measured), damage) => Ok(Part { measured, damage }),
        // What is too little to be measured is so because of what cut it.
        (Err(_), Some(damage)) => Err(anyhow!(damage).context(name())),
        (Err(error), None) => Err(anyhow!(error).context(name())),
    }
}
