//! When a metric grew: the additive metrics of a run in bins of time.
//!
//! The number of bins is bounded. When a run outgrows them, neighbours are joined and each bin
//! becomes twice as long, so that memory does not follow the length of the run.

/// Length of a bin at first, seconds.
const FIRST_BIN_S: f64 = 0.25;

/// Most bins that are kept: ten minutes then take bins of one second.
const MOST_BINS: usize = 1024;

/// The additive metrics of one run, by time.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    bin_s: f64,
    columns: Vec<Column>,
    bins: Vec<Vec<f64>>,
}

/// One additive metric of a [`Profile`].
#[derive(Clone, Debug, PartialEq)]
struct Column {
    metric: usize,
    /// The metric's plain sum when it last grew.
    total: f64,
    /// What turns the plain sum into the metric.
    scale: f64,
}

impl Profile {
    pub(super) fn new() -> Profile {
        Profile { bin_s: FIRST_BIN_S, columns: Vec::new(), bins: Vec::new() }
    }

    /// Length of a bin, seconds.
    pub fn bin_s(&self) -> f64 {
        self.bin_s
    }

    /// Notes that the plain sum of metric number `metric` of the catalogue is `total` now.
    pub(super) fn note(&mut self, metric: usize, t_s: f64, total: f64) {
        let column = self.columns.iter().position(|column| column.metric == metric);
        let column = column.unwrap_or_else(|| {
            self.columns.push(Column { metric, total: 0.0, scale: 1.0 });
            for bin in &mut self.bins {
                bin.push(0.0);
            }
            self.columns.len() - 1
        });
        let growth = total - self.columns[column].total;
        if growth == 0.0 || !(t_s >= 0.0 && t_s.is_finite()) {
            return;
        }
        self.columns[column].total = total;
        while t_s / self.bin_s >= MOST_BINS as f64 {
            self.coarsen();
        }
        let bin = (t_s / self.bin_s) as usize;
        if self.bins.len() <= bin {
            self.bins.resize(bin + 1, vec![0.0; self.columns.len()]);
        }
        self.bins[bin][column] += growth;
    }

    /// Forgets one metric: its run starts again.
    pub(super) fn forget(&mut self, metric: usize) {
        if let Some(column) = self.columns.iter().position(|column| column.metric == metric) {
            self.columns[column].total = 0.0;
            for bin in &mut self.bins {
                bin[column] = 0.0;
            }
        }
    }

    /// Says what the metric came to in the end, so that its bins add up to that.
    pub(super) fn scale(&mut self, metric: usize, value: f64) {
        if let Some(column) = self.columns.iter_mut().find(|column| column.metric == metric)
            && column.total != 0.0
        {
            column.scale = value / column.total;
        }
    }

    /// Joins neighbouring bins.
    fn coarsen(&mut self) {
        self.bin_s *= 2.0;
        self.bins = self
            .bins
            .chunks(2)
            .map(|pair| {
                let mut joined = pair[0].clone();
                if let Some(second) = pair.get(1) {
                    joined.iter_mut().zip(second).for_each(|(sum, x)| *sum += x);
                }
                joined
            })
            .collect();
    }

    /// What each bin adds to the metric, in the metric's own unit; empty for a metric that did not
    /// grow or does not add up. `bin_s` must be this profile's or larger by a power of two.
    pub fn contributions(&self, metric: usize, bin_s: f64) -> Vec<f64> {
        let Some(column) = self.columns.iter().position(|column| column.metric == metric) else {
            return Vec::new();
        };
        let scale = self.columns[column].scale;
        let join = ((bin_s / self.bin_s) as usize).max(1);
        self.bins
            .chunks(join)
            .map(|bins| bins.iter().map(|bin| bin[column] * scale).sum())
            .collect()
    }
}
