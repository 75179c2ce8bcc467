//! Predictions against truth.

use compare::CATALOGUE;

/// A change of every metric of the catalogue; `None` where one side has no value.
pub(crate) type Change = Vec<Option<f64>>;

/// What one level said of one session.
pub(crate) struct Predicted {
    pub(crate) name: &'static str,
    pub(crate) change: Change,
    /// How far B's predicted robot is from the true one before and after the horizon, metres.
    pub(crate) apart_m: [Option<f64>; 2],
    /// Greatest distance of B's robot from the recorded state.
    pub(crate) furthest: f64,
}

/// One session under one pair of controllers.
pub(crate) struct Record {
    pub(crate) person: &'static str,
    pub(crate) truth: Change,
    pub(crate) levels: Vec<Predicted>,
}

/// What B changes.
pub(crate) fn change(a: &[Option<f64>], b: &[Option<f64>]) -> Change {
    a.iter().zip(b).map(|(a, b)| a.zip(*b).map(|(a, b)| b - a)).collect()
}

/// Levels whose mean is the estimate.
const ESTIMATES: [&str; 2] = ["intent", "fitted"];

impl Record {
    /// The mean over the levels that deserve it.
    fn estimate(&self) -> Change {
        let deserving: Vec<&Predicted> =
            self.levels.iter().filter(|level| ESTIMATES.contains(&level.name)).collect();
        (0..CATALOGUE.len())
            .map(|metric| {
                let said: Option<Vec<f64>> =
                    deserving.iter().map(|level| level.change[metric]).collect();
                said.map(|said| mean(&said))
            })
            .collect()
    }

    /// What a row of a table says of the session.
    fn said(&self, row: &str) -> Option<Change> {
        match row {
            "estimate" => Some(self.estimate()),
            "no change" => Some(self.truth.iter().map(|truth| truth.map(|_| 0.0)).collect()),
            level => Some(self.levels.iter().find(|said| said.name == level)?.change.clone()),
        }
    }

    /// Least and greatest prediction of a metric over all levels.
    fn interval(&self, metric: usize) -> Option<(f64, f64)> {
        let said: Option<Vec<f64>> = self.levels.iter().map(|level| level.change[metric]).collect();
        let said = said?;
        let low = said.iter().copied().fold(f64::INFINITY, f64::min);
        Some((low, said.iter().copied().fold(f64::NEG_INFINITY, f64::max)))
    }
}

/// Truths with what a row says of them.
pub(crate) type Pairs = Vec<(Change, Change)>;

/// Every session's truth with what a row says of it.
pub(crate) fn pairs(records: &[&Record], row: &str) -> Pairs {
    records.iter().filter_map(|record| Some((record.truth.clone(), record.said(row)?))).collect()
}

/// How far a level's robot is from the true one before (0) or after (1) its horizon: the mean over
/// sessions, metres.
pub(crate) fn apart_m(records: &[&Record], row: &str, which: usize) -> Option<f64> {
    let levels = records.iter().flat_map(|record| &record.levels);
    let apart: Vec<f64> =
        levels.filter(|level| level.name == row).filter_map(|level| level.apart_m[which]).collect();
    (!apart.is_empty()).then(|| mean(&apart))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean and its standard error.
fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    if n < 2.0 {
        return (0.0, f64::INFINITY);
    }
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    (mean, (squares / (n - 1.0) / n).sqrt())
}

/// Whether a mean is beyond two standard errors, and on which side; 0 where it is not.
fn side(values: &[f64]) -> f64 {
    let (mean, error) = mean_and_error(values);
    if mean != 0.0 && mean.abs() > 2.0 * error { mean.signum() } else { 0.0 }
}

/// Sum of the errors of the change ÷ sum of the true changes, metric by metric; `None` for a metric
/// that never changes.
pub(crate) fn error_ratios(pairs: &Pairs) -> Vec<Option<f64>> {
    (0..CATALOGUE.len())
        .map(|metric| {
            let (mut error, mut size) = (0.0, 0.0);
            for (truth, said) in pairs {
                if let (Some(truth), Some(said)) = (truth[metric], said[metric]) {
                    error += (said - truth).abs();
                    size += truth.abs();
                }
            }
            (size > 1e-9).then(|| error / size)
        })
        .collect()
}

/// Their mean over metrics.
pub(crate) fn error_ratio(pairs: &Pairs) -> f64 {
    mean(&error_ratios(pairs).into_iter().flatten().collect::<Vec<_>>())
}

/// Error of the mean change over sessions ÷ mean true change, averaged over the metrics whose true
/// mean is beyond chance.
pub(crate) fn mean_ratio(fleets: &[&[Record]], row: &str) -> f64 {
    let mut ratios = Vec::new();
    for fleet in fleets {
        let pairs = pairs(&fleet.iter().collect::<Vec<_>>(), row);
        for metric in 0..CATALOGUE.len() {
            let (truths, said): (Vec<f64>, Vec<f64>) =
                pairs.iter().filter_map(|(truth, said)| truth[metric].zip(said[metric])).unzip();
            if side(&truths) != 0.0 {
                ratios.push((mean(&said) - mean(&truths)).abs() / mean(&truths).abs());
            }
        }
    }
    mean(&ratios)
}

/// Share of right signs among the changes that there truly are.
pub(crate) fn right_signs(pairs: &Pairs) -> f64 {
    let right: Vec<f64> = pairs
        .iter()
        .flat_map(|(truth, said)| truth.iter().zip(said))
        .filter_map(|(truth, said)| truth.zip(*said))
        .filter(|(truth, _)| *truth != 0.0)
        .map(|(truth, said)| f64::from(u8::from(truth * said > 0.0)))
        .collect();
    mean(&right)
}

/// Share of true changes between the least and the greatest prediction.
pub(crate) fn coverage(records: &[&Record]) -> f64 {
    let mut within = Vec::new();
    for record in records {
        for metric in 0..CATALOGUE.len() {
            if let Some((truth, (low, high))) = record.truth[metric].zip(record.interval(metric)) {
                let holds = low - 1e-9 <= truth && truth <= high + 1e-9;
                within.push(f64::from(u8::from(holds)));
            }
        }
    }
    mean(&within)
}

/// Sessions in which no level's robot ever left the recorded state, and how many of them changed
/// after all.
pub(crate) fn certified(records: &[&Record]) -> (usize, usize) {
    let still: Vec<&&Record> = records
        .iter()
        .filter(|record| record.levels.iter().all(|level| level.furthest == 0.0))
        .collect();
    let moved = |record: &&&Record| {
        // What is computed from the motion alone; steps of another law differ by name.
        let motions = ["min_clearance_m", "near_miss_s", "tracking_rms_m", "path_efficiency"];
        CATALOGUE.iter().zip(&record.truth).any(|(metric, change)| {
            motions.contains(&metric.name) && change.is_some_and(|c| c != 0.0)
        })
    };
    (still.len(), still.iter().filter(|record| moved(record)).count())
}

/// How well the spread between levels tells the sessions whose estimate is worse than the median:
/// the area under the receiver's curve, 0.5 for not at all.
pub(crate) fn spread_tells(records: &[&Record]) -> f64 {
    let sizes: Vec<f64> = (0..CATALOGUE.len())
        .map(|metric| {
            let sizes: Vec<f64> =
                records.iter().filter_map(|record| record.truth[metric]).map(f64::abs).collect();
            if sizes.is_empty() { 0.0 } else { mean(&sizes) }
        })
        .collect();
    let mut judged: Vec<(f64, f64)> = records
        .iter()
        .map(|record| {
            let estimate = record.estimate();
            let (mut error, mut spread) = (0.0, 0.0);
            for metric in 0..CATALOGUE.len() {
                if let (Some(truth), Some(said), Some((low, high))) =
                    (record.truth[metric], estimate[metric], record.interval(metric))
                    && sizes[metric] > 1e-9
                {
                    error += (said - truth).abs() / sizes[metric];
                    spread += (high - low) / sizes[metric];
                }
            }
            (error, spread)
        })
        .collect();
    judged.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (good, bad) = judged.split_at(judged.len() / 2);
    let wins: Vec<f64> = bad
        .iter()
        .flat_map(|(_, bad)| good.iter().map(move |(_, good)| (bad, good)))
        .map(|(bad, good)| {
            if bad > good {
                1.0
            } else if bad == good {
                0.5
            } else {
                0.0
            }
        })
        .collect();
    mean(&wins)
}

/// What the agreement rule makes of the metrics of a fleet.
#[derive(Default)]
pub(crate) struct Calls {
    pub(crate) real: u32,
    pub(crate) found: u32,
    pub(crate) wrong: u32,
    /// Metrics with a value in the fleet.
    pub(crate) cells: u32,
    pub(crate) called: u32,
}

impl Calls {
    /// The rule: every level's mean is beyond two standard errors, all on the same side.
    pub(crate) fn count(&mut self, records: &[&Record]) {
        let rows = ["playback", "path", "intent", "fitted"].map(|row| pairs(records, row));
        for metric in 0..CATALOGUE.len() {
            let truths: Vec<f64> =
                records.iter().filter_map(|record| record.truth[metric]).collect();
            if truths.len() < 10 {
                continue;
            }
            let truth = side(&truths);
            let sides = rows.each_ref().map(|pairs| {
                side(&pairs.iter().filter_map(|(_, said)| said[metric]).collect::<Vec<_>>())
            });
            let called = sides[0] != 0.0 && sides.iter().all(|side| *side == sides[0]);
            self.cells += 1;
            self.called += u32::from(called);
            if truth != 0.0 {
                self.real += 1;
                self.found += u32::from(called && sides[0] == truth);
                self.wrong += u32::from(called && sides[0] != truth);
            }
        }
    }
}
