//! A comparison put to the test: does it find nothing where there is nothing, and controllers that are
//! wrong on purpose where there are some?
//!
//! In go comparisons of a controller with itself, with mutants of itself, and with itself under another
//! name and other noise; out comes one [`SelfTest`], which a report prints beside its verdict.

use std::collections::BTreeMap;

use schemas::Node;
use serde::{Deserialize, Serialize};

use crate::comparison::{Comparison, Gate, Verdict};
use crate::report::number;

/// The least share of mutants that has to be caught.
const LEAST_CAUGHT: f64 = 0.95;

/// The largest share of false alarms.
const MOST_ALARMS: f64 = 0.05;

/// The field that tells of hidden state alone.
const HIDDEN_STATE: &str = "state_hash";

/// What came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SelfTest {
    /// Whether everything is as it has to be.
    pub passed: bool,
    /// The same in a sentence.
    pub reason: String,
    /// How many sessions each comparison is over.
    pub sessions: usize,
    /// A against A, and against A under another name with its parameters in another order: in how many
    /// sessions anything differs. It has to be none.
    pub differing: Unchanged,
    /// A against its mutants.
    pub mutants: Vec<Mutant>,
    /// How many of them are caught: they differ somewhere, and wherever they do the first cause names the
    /// stage that is wrong.
    pub caught: usize,
    /// The same as a share, which has to be 0.95 at least.
    pub caught_share: f64,
    /// What the gate makes of the mutants.
    pub power: Power,
    /// What the gate makes of A against itself with other noise.
    pub false_alarms: FalseAlarms,
}

/// Sessions in which something differs although nothing is different.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unchanged {
    /// A against A.
    pub itself: usize,
    /// A against A under another name, its parameters in another order.
    pub renamed: usize,
}

/// A controller that is wrong on purpose, against the one that is not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mutant {
    /// What is wrong with it.
    pub name: String,
    /// The stages of the data flow that this is in: one, or two for what acts in two places.
    pub nodes: Vec<String>,
    /// In how many sessions it could be run.
    pub sessions: usize,
    /// In how many of them any quantity differs.
    pub differing: usize,
    /// In how many the first cause names the stage.
    pub named: usize,
    /// What the first cause names instead, and in how many sessions.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub misnamed: BTreeMap<String, usize>,
    /// Whether it is caught.
    pub caught: bool,
    /// The first cause in the first session that differs.
    pub first_cause: Option<String>,
    /// The verdict over all sessions.
    pub verdict: Verdict,
    /// What the gate says.
    pub gate: Gate,
}

/// What the gate makes of mutants. Only what fails is stopped by chance-proof evidence; what is
/// undecided is not merged either.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Power {
    /// Mutants that fail.
    pub failed: usize,
    /// Mutants of which nothing is decided.
    pub undecided: usize,
    /// Mutants that pass: they change nothing that is gated by more than its margin.
    pub passed: usize,
    /// The share that fails.
    pub failed_share: f64,
    /// The share that does not pass.
    pub stopped_share: f64,
}

/// What the gate makes of comparisons in which nothing that matters is different.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FalseAlarms {
    /// How many comparisons.
    pub comparisons: usize,
    /// In how many of them the gate fails.
    pub alarms: usize,
    /// The same as a share, which has to be 0.05 at most.
    pub share: f64,
    /// In how many the gate cannot decide.
    pub undecided: usize,
    /// In how many the verdict is better or worse.
    pub called: usize,
    /// In how many the verdict is failed: B did harm that A did not.
    pub failed: usize,
}

impl Mutant {
    /// What `comparison`, of a controller with this mutant, says of it. The stages are those that may be
    /// named.
    pub fn of(name: &str, nodes: &[Node], comparison: &Comparison) -> Mutant {
        let mut mutant = Mutant {
            name: name.to_owned(),
            nodes: nodes.iter().map(|node| node.name().to_owned()).collect(),
            sessions: comparison.logs.len() - comparison.failed_logs(),
            differing: 0,
            named: 0,
            misnamed: BTreeMap::new(),
            caught: false,
            first_cause: None,
            verdict: comparison.verdict,
            gate: comparison.gate.as_ref().map_or(Gate::None, |gate| gate.outcome),
        };
        let causes = comparison.logs.iter().filter_map(|log| log.first_cause.as_ref());
        // Hidden state that no quantity ever shows is no difference that anyone could see.
        for cause in causes.filter(|cause| cause.field != HIDDEN_STATE) {
            mutant.differing += 1;
            if mutant.nodes.contains(&cause.node) {
                mutant.named += 1;
            } else {
                *mutant.misnamed.entry(cause.node.clone()).or_default() += 1;
            }
            mutant.first_cause.get_or_insert_with(|| cause.reason.clone());
        }
        mutant.caught = mutant.differing > 0 && mutant.named == mutant.differing;
        mutant
    }
}

impl FalseAlarms {
    /// Counts one more comparison.
    pub fn add(&mut self, comparison: &Comparison) {
        let gate = comparison.gate.as_ref().map_or(Gate::None, |gate| gate.outcome);
        self.comparisons += 1;
        self.alarms += usize::from(gate == Gate::Fail);
        self.undecided += usize::from(gate == Gate::Undecided);
        self.called += usize::from(matches!(comparison.verdict, Verdict::Better | Verdict::Worse));
        self.failed += usize::from(comparison.verdict == Verdict::Failed);
        self.share = share(self.alarms, self.comparisons);
    }
}

impl SelfTest {
    /// Judges.
    pub fn new(
        sessions: usize,
        differing: Unchanged,
        mutants: Vec<Mutant>,
        false_alarms: FalseAlarms,
    ) -> SelfTest {
        let caught = mutants.iter().filter(|mutant| mutant.caught).count();
        let of = |gate| mutants.iter().filter(|mutant| mutant.gate == gate).count();
        let (failed, undecided, passed) = (of(Gate::Fail), of(Gate::Undecided), of(Gate::Pass));
        let mut test = SelfTest {
            passed: false,
            reason: String::new(),
            sessions,
            differing,
            caught,
            caught_share: share(caught, mutants.len()),
            power: Power {
                failed,
                undecided,
                passed,
                failed_share: share(failed, mutants.len()),
                stopped_share: share(failed + undecided, mutants.len()),
            },
            mutants,
            false_alarms,
        };
        let wrong = test.wrong();
        test.passed = wrong.is_empty();
        test.reason = if test.passed {
            format!(
                "A against itself is the same, {} of {} mutants are caught, {} of {} comparisons with \
                 other noise raise a false alarm",
                caught,
                test.mutants.len(),
                false_alarms.alarms,
                false_alarms.comparisons
            )
        } else {
            wrong.join("; ")
        };
        test
    }

    /// What is not as it has to be.
    fn wrong(&self) -> Vec<String> {
        let mut wrong = Vec::new();
        for (what, sessions) in
            [("itself", self.differing.itself), ("A renamed", self.differing.renamed)]
        {
            if sessions > 0 {
                wrong.push(format!("A against {what} differs in {sessions} sessions"));
            }
        }
        if self.mutants.is_empty() || self.caught_share < LEAST_CAUGHT {
            wrong.push(format!(
                "{} of {} mutants are caught, at least {} required",
                self.caught,
                self.mutants.len(),
                number(Some(LEAST_CAUGHT))
            ));
        }
        let FalseAlarms { alarms, comparisons, share, .. } = self.false_alarms;
        if comparisons == 0 {
            wrong.push("no comparison with other noise was made".to_owned());
        } else if share > MOST_ALARMS {
            wrong.push(format!(
                "{alarms} of {comparisons} comparisons with other noise raise a false alarm, at most \
                 {} allowed",
                number(Some(MOST_ALARMS))
            ));
        }
        wrong
    }
}

/// `part` of `all`; 0 of nothing.
fn share(part: usize, all: usize) -> f64 {
    if all == 0 { 0.0 } else { part as f64 / all as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{Run, pair, question};

    fn mutant(caught: bool, gate: Gate) -> Mutant {
        Mutant {
            name: "m".to_owned(),
            nodes: vec!["law".to_owned()],
            sessions: 2,
            differing: 2,
            named: if caught { 2 } else { 1 },
            misnamed: BTreeMap::new(),
            caught,
            first_cause: None,
            verdict: Verdict::Worse,
            gate,
        }
    }

    fn alarms(alarms: usize, comparisons: usize) -> FalseAlarms {
        FalseAlarms { comparisons, alarms, share: share(alarms, comparisons), ..Default::default() }
    }

    /// Of four sessions one differs in the law, one in the distances that the law follows from, one in
    /// hidden state alone, and one not at all.
    #[test]
    fn the_stage_that_is_named_is_counted() {
        let run = |change: fn(&mut schemas::Step)| {
            let mut run = Run::new();
            run.step(0.0, |step| step.k = 0.0).step(0.1, change);
            run
        };
        let changes: [fn(&mut schemas::Step); 4] = [
            |step| step.theta_star_rad = 0.5,
            |step| (step.d1_m, step.theta_star_rad) = (0.5, 0.5),
            |step| step.state_hash = 7,
            |_| {},
        ];
        let logs = changes
            .iter()
            .enumerate()
            .map(|(i, change)| pair(&format!("log {i}"), &run(|_| {}), &run(*change)));
        let comparison = crate::compare(&question(), logs.collect()).expect("engages");
        let of = |nodes: &[Node]| Mutant::of("m", nodes, &comparison);
        let mutant = of(&[Node::Law]);
        assert_eq!((mutant.sessions, mutant.differing, mutant.named), (4, 2, 1));
        assert_eq!(mutant.misnamed, BTreeMap::from([("distances".to_owned(), 1)]));
        assert!(!mutant.caught);
        assert!(of(&[Node::Law, Node::Distances]).caught);
    }

    /// 19 of 20 are 0.95; 10 of 200 are 0.05: just enough.
    #[test]
    fn the_limits_are_those_that_are_stated() {
        let mutants = |caught: usize, of: usize| -> Vec<Mutant> {
            (0..of).map(|i| mutant(i < caught, Gate::Fail)).collect()
        };
        let none = Unchanged::default();
        assert!(SelfTest::new(8, none, mutants(19, 20), alarms(10, 200)).passed);
        for (differing, caught, of, alarmed) in [
            (none, 18, 20, alarms(0, 200)),
            (none, 20, 20, alarms(11, 200)),
            (none, 20, 20, alarms(0, 0)),
            (none, 0, 0, alarms(0, 200)),
            (Unchanged { itself: 1, renamed: 0 }, 20, 20, alarms(0, 200)),
            (Unchanged { itself: 0, renamed: 1 }, 20, 20, alarms(0, 200)),
        ] {
            let test = SelfTest::new(8, differing, mutants(caught, of), alarmed);
            assert!(!test.passed, "{}", test.reason);
        }
    }

    /// Of four mutants two fail, one is undecided, one passes.
    #[test]
    fn power_is_the_share_that_the_gate_stops() {
        let gates = [Gate::Fail, Gate::Fail, Gate::Undecided, Gate::Pass];
        let mutants = gates.map(|gate| mutant(true, gate)).to_vec();
        let power = SelfTest::new(8, Unchanged::default(), mutants, alarms(0, 1)).power;
        assert_eq!((power.failed, power.undecided, power.passed), (2, 1, 1));
        assert_eq!((power.failed_share, power.stopped_share), (0.5, 0.75));
    }
}
