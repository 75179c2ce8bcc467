//! Interventions: how often and how long. `interventions_per_min`, `intervention_p50_s`,
//! `intervention_p95_s`.

use super::accumulate::Accumulate;
use super::authority::{Rate, intervenes};
use super::quantile::nearest_rank;
use super::sample::{Decision, Limits};

/// Interventions less than this apart are one, seconds.
pub(super) const MERGED_WITHIN_S: f64 = 0.3;

/// Times that were added one by one compare with a limit up to their rounding, seconds.
const ROUNDING_S: f64 = 1e-9;

/// One intervention: from its first step to the end of its last one, seconds.
#[derive(Clone, Copy, Debug)]
struct Episode {
    from_s: f64,
    until_s: f64,
}

/// Splits a run into interventions, short pauses bridged.
#[derive(Clone, Copy, Debug)]
struct Episodes {
    limits: Limits,
    open: Option<Episode>,
}

impl Episodes {
    fn new(limits: Limits) -> Self {
        Episodes { limits, open: None }
    }

    /// Takes in a decision. Gives whether a new intervention begins with it, and the one before,
    /// which is then over; `None` where it is not known whether the controller intervenes.
    fn decision(&mut self, decision: &Decision) -> Option<(bool, Option<Episode>)> {
        let intervenes = intervenes(self.limits, decision)?;
        if !intervenes {
            return Some((false, None));
        }
        let until_s = decision.t_s + decision.hold_s;
        if let Some(open) = &mut self.open
            && decision.t_s - open.until_s < MERGED_WITHIN_S - ROUNDING_S
        {
            open.until_s = open.until_s.max(until_s);
            return Some((false, None));
        }
        let before = self.open.replace(Episode { from_s: decision.t_s, until_s });
        Some((true, before))
    }
}

/// `interventions_per_min` = rising edges of ‖S(`u_s` − `u_h`)‖ > ε, those within 0.3 s of the end
/// of the one before taken as the same.
#[derive(Clone, Debug)]
pub(super) struct Interventions {
    episodes: Episodes,
    rate: Rate,
}

impl Interventions {
    pub(super) fn new(limits: Limits) -> Self {
        Interventions { episodes: Episodes::new(limits), rate: Rate::default() }
    }
}

impl Accumulate for Interventions {
    fn decision(&mut self, decision: &Decision) {
        if let Some((begins, _)) = self.episodes.decision(decision) {
            self.rate.watched_s += decision.hold_s;
            self.rate.count += u32::from(begins);
        }
    }

    fn value(&self) -> Option<f64> {
        self.rate.per_min()
    }

    fn total(&self) -> Option<f64> {
        self.rate.count()
    }
}

/// `intervention_p50_s`, `intervention_p95_s` = quantiles of the interventions' durations by nearest
/// rank; undefined without an intervention.
#[derive(Clone, Debug)]
pub(super) struct Durations {
    p: f64,
    episodes: Episodes,
    /// At most one for every 0.3 s of the run.
    done_s: Vec<f64>,
}

impl Durations {
    pub(super) fn new(limits: Limits, p: f64) -> Self {
        Durations { p, episodes: Episodes::new(limits), done_s: Vec::new() }
    }
}

impl Accumulate for Durations {
    fn decision(&mut self, decision: &Decision) {
        if let Some((_, Some(over))) = self.episodes.decision(decision) {
            self.done_s.push(over.until_s - over.from_s);
        }
    }

    fn value(&self) -> Option<f64> {
        let mut all_s = self.done_s.clone();
        all_s.extend(self.episodes.open.map(|open| open.until_s - open.from_s));
        nearest_rank(&all_s, self.p)
    }
}
