//! The verdict, and the rules it follows.
//!
//! In this order; the first that applies decides:
//!
//! 1. **failed**: a log could not be run, or B left the static admissible set or moved towards a
//!    disc in contact on a log on which A did nothing of the kind. (A disc that runs over a robot which does
//!    not move towards it is listed and held against nobody.)
//! 2. **same**: in no log does anything differ that the controllers say or command, and no metric.
//! 3. **better**, **worse**: primary safety metrics changed beyond chance, all in one direction. If none
//!    did, the primary authority metrics decide likewise. What got worse in the other group is named. Where
//!    safety metrics contradict each other, those of what happened (contacts, breaches) speak before those of
//!    how near it came: who drives through a wall is not near it for long.
//! 4. **undecided**: otherwise; also when metrics of the deciding group contradict each other all the same.
//!
//! *Beyond chance* means that the 95 % interval excludes 0 *and* that the p-value of the paired
//! randomisation test, adjusted by Holm over the group's primary metrics, is at most 0.05. The second
//! condition keeps a handful of logs from deciding anything: with n logs p is 2/2ⁿ at least.

use super::result::{Comparison, LogStatus, MetricChange, Verdict};
use crate::metrics::{Group, metric};
use crate::report::{number, seconds, signed, with_unit};
use crate::statistics::{Interval, holm};

/// Largest chance of a false call within a group of metrics.
const ALPHA: f64 = 0.05;

/// The primary safety metrics of what happened; the others are of how near it came.
const HAPPENED: [&str; 3] = ["collisions", "contact_speed_mps", "invariance_breaches"];

/// The groups whose primary metrics decide, the first before the second.
const DECIDING: [Group; 2] = [Group::Safety, Group::Authority];

impl MetricChange {
    /// Whether the verdict may rest on it.
    pub fn decides(&self) -> bool {
        self.primary && DECIDING.contains(&self.group)
    }
}

/// Marks the metrics whose change is beyond chance.
pub(super) fn mark_decidable(metrics: &mut [MetricChange]) {
    for (group, primary) in Group::ALL.into_iter().flat_map(|group| [(group, true), (group, false)])
    {
        let mut members: Vec<&mut MetricChange> = metrics
            .iter_mut()
            .filter(|metric| metric.group == group && metric.primary == primary)
            .filter(|metric| metric.p.is_some() && group.is_repeatable())
            .collect();
        let p: Vec<f64> = members.iter().map(|metric| metric.p.unwrap_or(1.0)).collect();
        for (metric, adjusted) in members.iter_mut().zip(holm(&p)) {
            let excludes_zero = metric.ci.is_some_and(Interval::excludes_zero);
            let floor = metric.floor.unwrap_or(0.0);
            let beyond_floor = metric.delta.is_some_and(|delta| libm::fabs(delta) > floor);
            metric.decidable =
                excludes_zero && beyond_floor && adjusted <= ALPHA && levels_agree(metric);
        }
    }
}

/// Whether every level of the ladder, where there are several, finds a change of the same sign.
fn levels_agree(metric: &MetricChange) -> bool {
    let up = |ci: Option<Interval>| ci.is_some_and(|ci| ci.low > 0.0);
    let down = |ci: Option<Interval>| ci.is_some_and(|ci| ci.high < 0.0);
    metric.levels.iter().all(|level| up(level.ci))
        || metric.levels.iter().all(|level| down(level.ci))
}

/// The verdict and its reason. `all_same`: every log ran, and in none does anything differ that a
/// controller says or commands.
pub(super) fn verdict(comparison: &Comparison, all_same: bool) -> (Verdict, String) {
    if let Some(reason) = failure(comparison) {
        return (Verdict::Failed, reason);
    }
    let logs = count(comparison.logs.len(), "log");
    let unchanged = comparison
        .logs
        .iter()
        .flat_map(|log| {
            log.metrics.iter().chain(log.levels.iter().flat_map(|level| &level.metrics))
        })
        .filter(|(name, _)| metric(name).is_some_and(|metric| metric.group.is_repeatable()))
        .all(|(_, change)| change.a == change.b);
    if all_same && unchanged {
        return (Verdict::Same, format!("A and B do exactly the same in {logs}"));
    }
    for group in DECIDING {
        let (improved, declined) = changed(comparison, group);
        let (verdict, carried) = match (improved.is_empty(), declined.is_empty()) {
            (true, true) => continue,
            (false, true) => (Verdict::Better, improved),
            (true, false) => (Verdict::Worse, declined),
            (false, false) if happened(&improved) && !happened(&declined) => {
                (Verdict::Better, improved)
            }
            (false, false) if happened(&declined) && !happened(&improved) => {
                (Verdict::Worse, declined)
            }
            (false, false) => {
                let reason = format!(
                    "{} metrics contradict each other: B is better in {} and worse in {}",
                    group.name(),
                    list(&improved),
                    list(&declined)
                );
                return (Verdict::Undecided, reason);
            }
        };
        let mut reason = format!("B is {} in {} over {logs}", verdict.name(), list(&carried));
        reason.push_str(&price(comparison, verdict));
        return (verdict, reason);
    }
    (Verdict::Undecided, no_call(comparison, &logs))
}

/// Why the comparison failed, if it did.
fn failure(comparison: &Comparison) -> Option<String> {
    let total = comparison.logs.len();
    let mut failed = comparison.logs.iter().filter(|log| log.status == LogStatus::Failed);
    if let Some(first) = failed.next() {
        let reason = first.error.as_deref().unwrap_or("no reason given");
        let others = failed.count();
        let more = if others > 0 { format!(", and {others} more") } else { String::new() };
        return Some(format!(
            "{} of {total} logs could not be compared: {} ({reason}){more}",
            others + 1,
            first.log
        ));
    }
    let mut new = comparison.violations.iter().filter(|violation| violation.new);
    let first = new.next()?;
    let others = new.count();
    let more = if others > 0 {
        format!(" ({} more on these logs)", count(others, "violation"))
    } else {
        String::new()
    };
    Some(format!(
        "B {} at {} in {}, and A does not do so on this log{more}",
        first.kind.words(),
        seconds(first.t_s),
        first.log
    ))
}

/// The metrics of a group that changed beyond chance: for the better, for the worse.
fn changed(comparison: &Comparison, group: Group) -> (Vec<&MetricChange>, Vec<&MetricChange>) {
    comparison
        .metrics
        .iter()
        .filter(|metric| metric.group == group && metric.primary && metric.decidable)
        .partition(|metric| {
            metric.delta.is_some_and(|delta| metric.better.improvement(delta) > 0.0)
        })
}

/// Whether something happened, in one of these metrics, and not only nearly.
fn happened(metrics: &[&MetricChange]) -> bool {
    metrics.iter().any(|metric| HAPPENED.contains(&metric.name.as_str()))
}

/// What else says the opposite of the verdict.
fn price(comparison: &Comparison, verdict: Verdict) -> String {
    let mut against = Vec::new();
    for group in [Group::Safety, Group::Authority, Group::Task] {
        let (improved, declined) = changed(comparison, group);
        against.extend(if verdict == Verdict::Better { declined } else { improved });
    }
    match (against.is_empty(), verdict) {
        (true, _) => String::new(),
        (false, Verdict::Better) => format!("; the price is {}", list(&against)),
        (false, _) => format!("; against that stands {}", list(&against)),
    }
}

/// Why nothing could be decided.
fn no_call(comparison: &Comparison, logs: &str) -> String {
    let changes_somewhere = |metric: &&MetricChange| {
        let mut deltas =
            comparison.logs.iter().filter_map(|log| log.metrics.get(&metric.name)?.delta);
        metric.decides() && deltas.any(|delta| delta != 0.0)
    };
    let nearest = comparison
        .metrics
        .iter()
        .filter(changes_somewhere)
        .min_by(|x, y| x.p.unwrap_or(1.0).total_cmp(&y.p.unwrap_or(1.0)));
    match nearest {
        Some(metric) => format!(
            "no change over {logs} of a safety or authority metric that verdicts rest on is beyond \
             chance; the nearest is {} (p {})",
            describe(metric),
            number(metric.p)
        ),
        None => format!("the runs differ, but no safety or authority metric does over {logs}"),
    }
}

fn list(metrics: &[&MetricChange]) -> String {
    metrics.iter().map(|metric| describe(metric)).collect::<Vec<_>>().join(", ")
}

/// A metric and its change: `human_share -0.120 [-0.180, -0.060]`.
fn describe(metric: &MetricChange) -> String {
    let change = with_unit(&signed(metric.delta), &metric.unit);
    match metric.ci {
        Some(ci) => format!(
            "{} {change} [{}, {}]",
            metric.name,
            signed(Some(ci.low)),
            signed(Some(ci.high))
        ),
        None => format!("{} {change}", metric.name),
    }
}

/// `1 log`, `2 logs`.
pub(super) fn count(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}
