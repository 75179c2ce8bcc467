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

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of 1, 3 and 6 at 0.1, 0.3 and 0.9 s: 1 and 2 in the first two quarters of a second, 3 in the
    /// fourth. What happens at no time is told with what comes next.
    #[test]
    fn growth_goes_to_the_bin_of_its_time() {
        let mut profile = Profile::new();
        assert_eq!(profile.bin_s(), 0.25);
        for (t_s, total) in [(0.1, 1.0), (f64::NAN, 2.0), (-1.0, 2.0), (0.3, 3.0), (0.9, 6.0)] {
            profile.note(7, t_s, total);
        }
        assert_eq!(profile.contributions(7, 0.25), [1.0, 2.0, 0.0, 3.0]);
        assert_eq!(profile.contributions(7, 0.5), [3.0, 3.0]);
        assert_eq!(profile.contributions(7, 1.0), [6.0]);
        assert!(profile.contributions(8, 0.25).is_empty());
        // A metric that comes later has grown by nothing before.
        profile.note(8, 0.6, 0.5);
        assert_eq!(profile.contributions(8, 0.25), [0.0, 0.0, 0.5, 0.0]);
        assert_eq!(profile.contributions(7, 0.25), [1.0, 2.0, 0.0, 3.0]);
    }

    /// A sum of 6 that is a metric of 0.6, and one that starts again.
    #[test]
    fn bins_add_up_to_the_metric() {
        let mut profile = Profile::new();
        profile.note(7, 0.1, 2.0);
        profile.note(7, 0.3, 6.0);
        profile.note(8, 0.1, 5.0);
        profile.scale(7, 0.6);
        profile.scale(9, 1.0);
        let shares = profile.contributions(7, 0.25);
        assert!((shares[0] - 0.2).abs() < 1e-12 && (shares[1] - 0.4).abs() < 1e-12);
        assert_eq!(profile.contributions(8, 0.25), [5.0, 0.0]);
        profile.forget(7);
        assert_eq!(profile.contributions(7, 0.25), [0.0, 0.0]);
        assert_eq!(profile.contributions(8, 0.25), [5.0, 0.0]);
        profile.forget(9);
        profile.note(7, 0.3, 1.5);
        profile.scale(7, 3.0);
        assert_eq!(profile.contributions(7, 0.25), [0.0, 3.0]);
        // What came to nothing has no scale.
        profile.forget(8);
        profile.scale(8, 4.0);
        assert_eq!(profile.contributions(8, 0.25), [0.0, 0.0]);
    }

    /// 1024 bins of 0.25 s end at 256 s. What comes then doubles them, once or as often as it takes.
    #[test]
    fn a_long_run_has_longer_bins() {
        let mut profile = Profile::new();
        for quarter in 0..1024 {
            profile.note(7, 0.25 * f64::from(quarter), f64::from(quarter + 1));
        }
        assert_eq!((profile.bin_s(), profile.bins.len()), (0.25, 1024));
        profile.note(7, 256.0, 1025.0);
        assert_eq!((profile.bin_s(), profile.bins.len()), (0.5, 513));
        let mut expected = vec![2.0; 512];
        expected.push(1.0);
        assert_eq!(profile.contributions(7, 0.5), expected);
        profile.note(7, 2_000.0, 1030.0);
        assert_eq!((profile.bin_s(), profile.bins.len()), (2.0, 1001));
        let sums = profile.contributions(7, 2.0);
        assert_eq!((sums[0], sums[127], sums[128], sums[1000]), (8.0, 8.0, 1.0, 5.0));
        assert_eq!(sums.iter().sum::<f64>(), 1030.0);
    }
}
