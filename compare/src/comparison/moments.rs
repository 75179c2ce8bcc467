//! Where a change comes from: the stretches of a log in which an additive metric grows in one arm
//! and not in the other.
//!
//! Both arms' metrics are split into equal bins of time; neighbouring bins whose difference has
//! the same sign make a stretch. All stretches of a log together add up to the metric's change.

use std::cmp::Ordering;

use super::result::{Arm, Moment};
use crate::metrics::{CATALOGUE, Critical, Group, Measured, Metric, Switch};
use crate::report::{number, seconds, told_apart, with_unit};

/// Most stretches that are listed for one metric of one log.
const MOST_PER_METRIC: usize = 3;

/// A stretch is worth listing from this share of all that changes either way.
const LEAST_SHARE: f64 = 0.1;

/// Stretches of one sign with no more than this of silence between them are one, seconds.
const BRIDGED_S: f64 = 1.0;

/// Differences below this share of all differences are rounding.
const ROUNDING: f64 = 1e-9;

/// A stretch of bins.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    first: usize,
    last: usize,
    delta: f64,
}

/// The moments of one log, the largest share first within each metric.
pub(super) fn moments(log: &str, a: &Measured, b: &Measured) -> Vec<Moment> {
    let bin_s = a.profile.bin_s().max(b.profile.bin_s());
    let mut all = Vec::new();
    for (i, metric) in CATALOGUE.iter().enumerate() {
        let deltas =
            difference(&a.profile.contributions(i, bin_s), &b.profile.contributions(i, bin_s));
        let mut stretches = stretches(&deltas, bin_s);
        let total: f64 = stretches.iter().map(|stretch| libm::fabs(stretch.delta)).sum();
        stretches.retain(|stretch| libm::fabs(stretch.delta) >= LEAST_SHARE * total);
        stretches.sort_by(|x, y| libm::fabs(y.delta).total_cmp(&libm::fabs(x.delta)));
        for stretch in stretches.into_iter().take(MOST_PER_METRIC) {
            let (from_s, until_s) =
                (stretch.first as f64 * bin_s, (stretch.last + 1) as f64 * bin_s);
            let (t_s, why) = why(metric, a, b, from_s, until_s);
            all.push(Moment {
                log: log.to_owned(),
                t_s,
                until_s,
                metric: metric.name.to_owned(),
                delta: stretch.delta,
                share: libm::fabs(stretch.delta) / total,
                why,
            });
        }
    }
    all
}

/// B − A, bin by bin.
fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    let at = |bins: &[f64], i: usize| bins.get(i).copied().unwrap_or(0.0);
    let mut deltas: Vec<f64> = (0..a.len().max(b.len())).map(|i| at(b, i) - at(a, i)).collect();
    // Equal growth on top of different sums differs by rounding; that is no change.
    let noise = ROUNDING * deltas.iter().map(|delta| libm::fabs(*delta)).sum::<f64>();
    deltas.iter_mut().filter(|delta| libm::fabs(**delta) <= noise).for_each(|delta| *delta = 0.0);
    deltas
}

/// Maximal runs of bins of one sign, short silences bridged.
fn stretches(deltas: &[f64], bin_s: f64) -> Vec<Stretch> {
    let bridged = (BRIDGED_S / bin_s) as usize;
    let mut found: Vec<Stretch> = Vec::new();
    for (i, delta) in deltas.iter().copied().enumerate() {
        if delta == 0.0 {
            continue;
        }
        match found.last_mut() {
            Some(last) if (last.delta > 0.0) == (delta > 0.0) && i - last.last <= bridged + 1 => {
                last.last = i;
                last.delta += delta;
            }
            _ => found.push(Stretch { first: i, last: i, delta }),
        }
    }
    found
}

/// What happened in a stretch, and the time to jump to.
fn why(metric: &Metric, a: &Measured, b: &Measured, from_s: f64, until_s: f64) -> (f64, String) {
    let (t_s, drivers) = who_drove(a, b, from_s, until_s);
    if metric.group != Group::Safety {
        return (t_s, drivers);
    }
    let nearest = |run: &Measured| {
        let within = run.track.points.iter().filter(|p| p.t_s >= from_s && p.t_s < until_s);
        within.map(|point| point.clearance_m).fold(f64::NAN, f64::min)
    };
    let nearest = |run| with_unit(&number(Some(nearest(run))), "m");
    (from_s, format!("clearance down to {} in A, {} in B; {drivers}", nearest(a), nearest(b)))
}

/// Who drove in a stretch, and the time at which that set the arms apart.
fn who_drove(a: &Measured, b: &Measured, from_s: f64, until_s: f64) -> (f64, String) {
    let mut switches: Vec<(Arm, &Switch)> = Vec::new();
    for (arm, run) in [(Arm::A, a), (Arm::B, b)] {
        let within = run.track.switches.iter().filter(|s| s.t_s >= from_s && s.t_s < until_s);
        switches.extend(within.map(|switch| (arm, switch)));
    }
    switches.sort_by(|x, y| x.1.t_s.total_cmp(&y.1.t_s).then(x.0.cmp(&y.0)));
    let opposite = |arm: Arm, switch: &Switch| {
        let other = if arm == Arm::A { b } else { a };
        other.track.driving_at(switch.t_s)
    };
    // The switch after which the arms differ; failing that, the first one at all.
    let parting = switches.iter().find(|(arm, switch)| {
        opposite(*arm, switch)
            .is_some_and(|other| (other.k, other.projected) != (switch.k, switch.projected))
    });
    if let Some(&(arm, switch)) = parting.or(switches.first())
        && let Some(other) = opposite(arm, switch)
    {
        let text = format!(
            "in {} {} at {} ({}); in {} {}",
            arm.letter(),
            became(switch),
            seconds(switch.t_s),
            circumstances(switch),
            if arm == Arm::A { "B" } else { "A" },
            stayed(other),
        );
        return (switch.t_s, text);
    }
    let text = match (a.track.driving_at(from_s), b.track.driving_at(from_s)) {
        (Some(a), Some(b)) if (a.k, a.projected) != (b.k, b.projected) => {
            format!("in A {}; in B {}", stayed(a), stayed(b))
        }
        (Some(a), Some(_)) if a.k == 0.0 => {
            "the feedback law drives in both, and asks for different motions".to_owned()
        }
        (Some(a), Some(_)) if a.projected => {
            "the safety layer alters the person's input in both, by different amounts".to_owned()
        }
        (Some(_), Some(_)) => {
            "the person drives in both, from different states or with different requests".to_owned()
        }
        _ => "who drove is not known in both".to_owned(),
    };
    (from_s, text)
}

/// What a switch changed to.
fn became(switch: &Switch) -> &'static str {
    match (switch.k == 0.0, switch.projected) {
        (true, _) => "the feedback law took over",
        (false, true) => "the safety layer began to alter the person's input",
        (false, false) => "the person took over",
    }
}

/// Who had been driving, and since when.
fn stayed(switch: &Switch) -> String {
    let who = match (switch.k == 0.0, switch.projected) {
        (true, _) => "the feedback law",
        (false, true) => "the person, altered by the safety layer,",
        (false, false) => "the person",
    };
    format!("{who} had driven since {}", seconds(switch.t_s))
}

/// Why a switch happened, as far as the step says.
fn circumstances(switch: &Switch) -> String {
    let mut parts = vec![switch.reason.name().replace('_', " ")];
    let (before, now) = (switch.distance_before_m, switch.distance_human_m);
    if !now.is_nan() {
        let metres = |x: f64| number(Some(x));
        let (was, is) = told_apart(before, now);
        let moved = match now.partial_cmp(&before) {
            Some(Ordering::Less) => format!("D fell from {was} to {is} m"),
            Some(Ordering::Greater) => format!("D rose from {was} to {is} m"),
            _ => format!("D = {is} m"),
        };
        parts.push(match switch.critical {
            None => moved,
            Some(Critical { distance_m, v_mps }) => {
                let side = if switch.k == 0.0 { "below" } else { "above" };
                let (dc, v) = (metres(distance_m), metres(v_mps));
                format!("{moved}, {side} Dc = {dc} m at {v} m/s")
            }
        });
    }
    if switch.v_h_mps.is_finite() && switch.critical.is_none_or(|c| c.v_mps != switch.v_h_mps) {
        parts.push(format!("requested {} m/s", number(Some(switch.v_h_mps))));
    }
    let echo = |words: &str, (sonar, range_m): (u8, f64)| {
        format!("{words} {} m at sonar {sonar}", number(Some(range_m)))
    };
    let ended_by = switch.ended_by.map(|ended_by| echo("what ends it is the echo", ended_by));
    parts.extend(ended_by.or(switch.nearest_echo.map(|nearest| echo("nearest echo", nearest))));
    parts.join(", ")
}
