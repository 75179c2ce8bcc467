//! `tandem metrics`: runs measured, or the metrics explained.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use clap::Args;
use compare::{Better, CATALOGUE, Group, Measured, Meter, MetricSummary, report, summarize};
use serde::Serialize;

use crate::cli::Common;
use crate::status::Status;
use crate::{fleet, interrupt, logs, output};

/// Up to this many runs are shown side by side unless told otherwise.
const SIDE_BY_SIDE: usize = 4;

/// Measure runs; without a run, list and explain the metrics.
///
/// A few runs are shown side by side; of many, each metric's mean, range and worst run.
#[derive(Args)]
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
        let results = fleet::each(common, &self.runs, "measuring", |run| measure(run));
        let mut status = Status::Done;
        for error in results.iter().filter_map(|result| result.as_ref().err()) {
            status = status.worse(Status::of_error(error));
            output::error(error);
        }
        let rows: Vec<MeasuredRun> =
            self.runs.iter().zip(&results).map(|(run, result)| row(run, result)).collect();
        let measured: Vec<(String, Measured)> = self
            .runs
            .iter()
            .zip(results)
            .filter_map(|(run, result)| Some((run.display().to_string(), result.ok()?)))
            .collect();
        let runs = Runs { runs: rows, summary: summarize(&measured) };
        output::print(common, &runs, |_| {
            if measured.is_empty() {
                String::new()
            } else if self.each || measured.len() <= SIDE_BY_SIDE {
                report::metrics_text(&measured)
            } else {
                report::summary_text(&measured)
            }
        })?;
        Ok(status)
    }
}

fn row(run: &Path, result: &Result<Measured>) -> MeasuredRun {
    let run = run.display().to_string();
    match result {
        Err(error) => {
            MeasuredRun { run, metrics: BTreeMap::new(), error: Some(format!("{error:#}")) }
        }
        Ok(measured) => MeasuredRun {
            run,
            metrics: CATALOGUE
                .iter()
                .map(|metric| {
                    let value = measured.metrics.get(metric.name);
                    (metric.name, Reading { value, unit: metric.unit })
                })
                .collect(),
            error: None,
        },
    }
}

/// Measures the run that a log holds.
pub fn measure(run: &Path) -> Result<Measured> {
    let name = || run.display().to_string();
    let mut log = logs::open(run)?;
    let mut meter = Meter::new(log.header());
    while let Some(event) = log.next_event().with_context(name)? {
        interrupt::check()?;
        meter.observe(&event);
    }
    meter.finish().with_context(name)
}
