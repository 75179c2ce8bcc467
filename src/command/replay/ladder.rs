//! The ladder's levels of one log side by side: what they agree on, and how far they spread.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use ::compare::{CATALOGUE, Track};
use replay::Reaction;
use serde::Serialize;

use super::result::Run;

/// What the levels make of one log.
#[derive(Serialize)]
pub(super) struct Ladder {
    log: String,
    /// Mean over time of the widest distance between two levels' robots, metres: how much the
    /// prediction hangs on who the person is taken to be.
    spread_m: f64,
    /// Whether the recorded person reacted: `reacts`, `strokes`, `scripted`.
    person: &'static str,
    /// What there is to be said of that.
    remark: Option<&'static str>,
    /// Every metric: by level, and the mean of the levels that estimate.
    metrics: BTreeMap<&'static str, OverLevels>,
}

/// One metric over the levels.
#[derive(Serialize)]
struct OverLevels {
    levels: BTreeMap<&'static str, Option<f64>>,
    /// Mean of `intent` and `fitted`.
    estimate: Option<f64>,
    /// Greatest less least level.
    spread: Option<f64>,
}

/// The levels that estimate; the others are stress levels.
const ESTIMATES: [&str; 2] = ["intent", "fitted"];

impl Ladder {
    /// The levels of one log; `None` where one of them failed.
    pub(super) fn of(runs: &[Run], reaction: Reaction) -> Option<Ladder> {
        let measured = runs
            .iter()
            .map(|run| Some((run.human?, run.measured.as_ref()?)))
            .collect::<Option<Vec<_>>>()?;
        let tracks: Vec<&Track> = measured.iter().map(|(_, measured)| &measured.track).collect();
        let metrics = CATALOGUE.iter().map(|metric| {
            let levels: BTreeMap<_, _> = measured
                .iter()
                .map(|(name, measured)| (*name, measured.metrics.get(metric.name)))
                .collect();
            let all: Option<Vec<f64>> = levels.values().copied().collect();
            let deserving: Option<Vec<f64>> =
                ESTIMATES.iter().map(|name| levels.get(name).copied().flatten()).collect();
            let levels = OverLevels {
                estimate: deserving.map(|values| values.iter().sum::<f64>() / values.len() as f64),
                spread: all.map(|values| {
                    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                    high - values.iter().copied().fold(f64::INFINITY, f64::min)
                }),
                levels,
            };
            (metric.name, levels)
        });
        Some(Ladder {
            log: runs.first()?.log.clone(),
            spread_m: spread_m(&tracks),
            person: reaction.name(),
            remark: reaction.remark(),
            metrics: metrics.collect(),
        })
    }

    /// Widest spread first: the logs to look at, or to record again.
    pub(super) fn rank(ladders: &mut [Ladder]) {
        ladders.sort_by(|a, b| b.spread_m.total_cmp(&a.spread_m));
    }

    /// All of them as text.
    pub(super) fn text(ladders: &[Ladder]) -> String {
        let mut text = String::new();
        if ladders.is_empty() {
            return text;
        }
        let _ = writeln!(
            text,
            "\nspread between the levels, widest first: how far apart their robots are, the two furthest, on \
             average\nover the time; so much of a prediction hangs on who the person is taken to be"
        );
        for ladder in ladders {
            let _ = writeln!(text, "  {:7.3} m  {}", ladder.spread_m, ladder.log);
            if let Some(remark) = ladder.remark {
                let _ = writeln!(text, "             {remark}");
            }
        }
        text
    }
}

/// Mean over time of the widest distance between two of the tracks.
fn spread_m(tracks: &[&Track]) -> f64 {
    let (mut sum_m, mut count) = (0.0, 0_u32);
    // Tracks of one log start alike and are thinned alike as long as they are equally long.
    let points = tracks.iter().map(|track| track.points.len()).min().unwrap_or(0);
    for i in 0..points {
        let mut widest_m = 0.0_f64;
        for (first, a) in tracks.iter().enumerate() {
            for b in &tracks[first + 1..] {
                let (a, b) = (&a.points[i], &b.points[i]);
                widest_m = widest_m.max((a.x_m - b.x_m).hypot(a.y_m - b.y_m));
            }
        }
        if widest_m.is_finite() {
            sum_m += widest_m;
            count += 1;
        }
    }
    sum_m / f64::from(count.max(1))
}
