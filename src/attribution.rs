//! Which parameter makes the difference between two controllers of one law: each swapped from A to B
//! alone, and back, over all logs.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Result, ensure};
use compare::{CATALOGUE, Measured, Meter, ParameterChange, Swap, Values, swap_parameters};
use controller::Spec;
use replay::{Faults, Mode, Recording, Replay};
use toml::Table;

use crate::arm::{caught, driven, made};
use crate::cli::Common;
use crate::command::replay::PlantName;
use crate::controller_choice::ControllerChoice;
use crate::fleet::watch;
use crate::{fleet, interrupt, logs, output};

/// Sums below this share of what was added up are rounding.
const ROUNDING: f64 = 1e-12;

/// A log, and both controllers as they are on it.
struct Log {
    path: PathBuf,
    recording: Option<Arc<Recording>>,
    header: schemas::Header,
    a: Spec,
    b: Spec,
}

/// How to run the logs again.
pub struct How {
    /// The mode.
    pub mode: Mode,
    /// The plant that every run drives.
    pub plant: PlantName,
    /// What every run is put under.
    pub faults: Faults,
    /// After how long a controller that does not answer is given up.
    pub hang_after: Duration,
}

/// Refuses controllers that cannot be swapped parameter by parameter, before anything is run: of different
/// laws, on any log whose head can be read.
pub fn refuse_laws(
    (a, b): (&ControllerChoice, &ControllerChoice),
    paths: &[PathBuf],
) -> Result<()> {
    for path in paths {
        // A log that cannot be read is reported by the comparison itself.
        let Ok(log) = logs::open(path) else { continue };
        let (Ok(a), Ok(b)) = (a.for_log(log.header()), b.for_log(log.header())) else { continue };
        let (a, b) = (a.law, b.law);
        ensure!(
            a == b,
            "--attribute swaps parameters, and A and B have different laws ({}, {})",
            a.name(),
            b.name()
        );
    }
    Ok(())
}

/// What every parameter that differs does to every metric, as a mean over the logs that can be replayed.
pub fn attribute(
    common: &Common,
    (a, b): (&ControllerChoice, &ControllerChoice),
    paths: &[PathBuf],
    how: How,
) -> Result<Vec<Swap>> {
    let How { mode, plant, faults, hang_after } = how;
    let read = fleet::each(common, paths, "reading", |path| Log::read(path, (a, b), (mode, plant)));
    // A log that cannot be read is reported by the comparison itself.
    let logs: Vec<Arc<Log>> = read.into_iter().filter_map(Result::ok).map(Arc::new).collect();
    let mut keys = BTreeSet::new();
    for log in &logs {
        keys.extend(log.differing()?);
    }
    let parameters: Vec<ParameterChange> =
        keys.into_iter().map(|key| ParameterChange { key, a: None, b: None }).collect();
    if parameters.is_empty() {
        return Ok(Vec::new());
    }
    let faults = Arc::new(faults);
    let mut failed = BTreeSet::new();
    let swaps = swap_parameters(&parameters, |of_b| {
        let of_b: BTreeSet<String> = of_b.iter().map(|key| (*key).to_owned()).collect();
        let faults = Arc::clone(&faults);
        let work = move |log: &Arc<Log>| log.run(&of_b, mode, &faults);
        let runs = watch::each(common, logs.clone(), "swapping", hang_after, work);
        interrupt::check()?;
        // By log, so that a metric without a value in one run of a log is a difference of no pair.
        let mut values = Values::new();
        for (number, run) in runs.into_iter().enumerate() {
            let run = match run {
                Ok(run) => run,
                Err(error) => {
                    failed.insert(format!("{}: {error:#}", logs[number].path.display()));
                    continue;
                }
            };
            for metric in CATALOGUE.iter().filter(|metric| metric.group.is_repeatable()) {
                if let Some(value) = run.metrics.get(metric.name) {
                    values.insert(format!("{} {number}", metric.name), value);
                }
            }
        }
        anyhow::Ok(values)
    })?;
    for error in failed {
        output::note(&format!("error: left out of a swap: {}", output::one_line(&error)));
    }
    Ok(swaps
        .into_iter()
        .map(|swap| Swap { forth: means(&swap.forth), back: means(&swap.back), ..swap })
        .collect())
}

impl Log {
    fn read(
        path: &Path,
        (a, b): (&ControllerChoice, &ControllerChoice),
        (mode, plant): (Mode, PlantName),
    ) -> Result<Log> {
        let header = logs::open(path)?.header().clone();
        let recording = match mode {
            Mode::Open => None,
            Mode::Closed(_) => {
                let recording = Recording::read(logs::open_raw(path)?)?;
                Some(Arc::new(driven(path, recording, plant)?.0))
            }
        };
        let (a, b) = (a.for_log(&header)?, b.for_log(&header)?);
        Ok(Log { path: path.to_owned(), recording, header, a, b })
    }

    /// The keys of the parameters that differ.
    fn differing(&self) -> Result<Vec<String>> {
        let (a, b): (Table, Table) = (self.a.params_toml().parse()?, self.b.params_toml().parse()?);
        let keys = a.iter().filter(|(key, value)| b.get(*key) != Some(value));
        Ok(keys.map(|(key, _)| key.clone()).collect())
    }

    /// A with these parameters of B.
    fn run(&self, of_b: &BTreeSet<String>, mode: Mode, faults: &Faults) -> Result<Measured> {
        let b: Table = self.b.params_toml().parse()?;
        let taken: Table = b.into_iter().filter(|(key, _)| of_b.contains(key)).collect();
        let mut spec = self.a.clone();
        for (key, value) in &taken {
            spec.params.set(key, value)?;
        }
        made(&self.header, &spec)?;
        let replay: Replay<BufReader<File>> = match (mode, &self.recording) {
            (Mode::Closed(person), Some(recording)) => {
                Replay::of_recording(recording, &spec, person)?
            }
            _ => Replay::new(|| logs::open_raw(&self.path), &spec, mode)?,
        };
        let mut replay = replay.under(faults.clone());
        let mut meter = Meter::new(&self.header);
        while let Some(event) = caught(|| replay.next_event())? {
            interrupt::check()?;
            meter.observe(&event);
        }
        Ok(meter.finish()?.bare())
    }
}

/// The mean over logs of each metric.
fn means(by_log: &Values) -> Values {
    let mut by_metric: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for (key, value) in by_log {
        by_metric.entry(key.split(' ').next().unwrap_or(key)).or_default().push(*value);
    }
    let mean = |values: Vec<f64>| {
        let sum: f64 = values.iter().sum();
        let size: f64 = values.iter().map(|value| value.abs()).sum();
        // What cancels out leaves rounding, which is no change.
        if sum.abs() <= ROUNDING * size { 0.0 } else { sum / values.len() as f64 }
    };
    by_metric.into_iter().map(|(name, values)| (name.to_owned(), mean(values))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_over_the_logs_that_have_a_value() {
        let of = |pairs: &[(&str, f64)]| -> Values {
            pairs.iter().map(|(key, value)| ((*key).to_owned(), *value)).collect()
        };
        let got = means(&of(&[("x_m 0", 1.0), ("x_m 2", 4.0), ("y_s 1", 7.0)]));
        assert_eq!(got, of(&[("x_m", 2.5), ("y_s", 7.0)]));
        let got = means(&of(&[("x_m 0", 0.1), ("x_m 1", 0.2), ("x_m 2", -0.3)]));
        assert_eq!(got, of(&[("x_m", 0.0)]));
    }
}
