//! `tandem metrics`: runs measured, or the metrics explained.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use clap::Args;
use compare::{Better, CATALOGUE, Measured, Meter, report};
use serde::Serialize;

use crate::cli::{Common, Format};
use crate::status::Status;
use crate::{fleet, interrupt, logs, output};

/// Measure runs; without a run, list and explain the metrics.
#[derive(Args)]
pub struct Metrics {
    /// The runs: recorded or replayed logs
    #[arg(value_name = "RUN")]
    runs: Vec<PathBuf>,
}

#[derive(Serialize)]
struct Runs {
    runs: Vec<MeasuredRun>,
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
        if common.format == Format::Human {
            let measured: Vec<(String, Measured)> = self
                .runs
                .iter()
                .zip(results)
                .filter_map(|(run, result)| Some((run.display().to_string(), result.ok()?)))
                .collect();
            output::print(common, &(), |()| report::metrics_text(&measured))?;
        } else {
            let runs =
                self.runs.iter().zip(results).map(|(run, result)| row(run, result)).collect();
            output::print(common, &Runs { runs }, |_| String::new())?;
        }
        Ok(status)
    }
}

fn row(run: &Path, result: Result<Measured>) -> MeasuredRun {
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
