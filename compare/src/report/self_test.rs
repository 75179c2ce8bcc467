//! The cells of a self-test: what came of it, and mutant by mutant.

use serde::Serialize;

use super::number::number;
use super::table::Align;
use crate::self_test::{Mutant, SelfTest};

/// A self-test, printed.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SelfTestView {
    pub(super) mark: &'static str,
    pub(super) state: &'static str,
    pub(super) reason: String,
    /// Name, value.
    pub(super) facts: Vec<(&'static str, String)>,
    pub(super) mutants: Vec<MutantRow>,
}

/// One mutant.
#[derive(Clone, Debug, Serialize)]
pub(super) struct MutantRow {
    pub(super) name: String,
    pub(super) nodes: String,
    pub(super) differing: String,
    pub(super) named: String,
    pub(super) caught: &'static str,
    pub(super) verdict: &'static str,
    pub(super) gate: &'static str,
    pub(super) first_cause: String,
}

/// The head of a table of [`MutantRow::cells`].
pub(super) const MUTANT_HEAD: [&str; 7] =
    ["mutant", "stage", "differs in", "stage named in", "caught", "verdict", "gate"];

/// How the columns of that table stand.
pub(super) const MUTANT_ALIGNS: [Align; 7] = {
    use Align::{Left, Right};
    [Left, Left, Right, Right, Left, Left, Left]
};

impl MutantRow {
    /// The row for a table of text.
    pub(super) fn cells(&self) -> Vec<String> {
        let MutantRow { name, nodes, differing, named, caught, verdict, gate, .. } = self;
        [name, nodes, differing, named, *caught, *verdict, *gate].map(str::to_owned).to_vec()
    }
}

/// Prints one.
pub(super) fn self_test(test: &SelfTest) -> SelfTestView {
    let SelfTest { sessions, differing, power, false_alarms: alarms, .. } = test;
    let same = |differing: usize| format!("differs in {differing} of {sessions} sessions");
    let share = |x: f64| number(Some(x));
    SelfTestView {
        mark: if test.passed { "✓" } else { "✕" },
        state: if test.passed { "passed" } else { "failed" },
        reason: test.reason.clone(),
        facts: vec![
            ("A against itself", same(differing.itself)),
            ("renamed, parameters reordered", same(differing.renamed)),
            (
                "mutants caught",
                format!("{} of {}, {}", test.caught, test.mutants.len(), share(test.caught_share)),
            ),
            (
                "the gate on mutants",
                format!(
                    "{} fail ({}), {} undecided, {} pass",
                    power.failed,
                    share(power.failed_share),
                    power.undecided,
                    power.passed
                ),
            ),
            (
                "false alarms of the gate",
                format!(
                    "{} of {} comparisons with other noise, {}; {} undecided",
                    alarms.alarms,
                    alarms.comparisons,
                    share(alarms.share),
                    alarms.undecided
                ),
            ),
            (
                "false calls of the verdict",
                format!("{} better or worse, {} failed", alarms.called, alarms.failed),
            ),
        ],
        mutants: test.mutants.iter().map(mutant_row).collect(),
    }
}

fn mutant_row(mutant: &Mutant) -> MutantRow {
    let of = |n: usize, all: usize| format!("{n} of {all}");
    MutantRow {
        name: mutant.name.clone(),
        nodes: mutant.nodes.join(" or "),
        differing: of(mutant.differing, mutant.sessions),
        named: of(mutant.named, mutant.differing),
        caught: if mutant.caught { "yes" } else { "NO" },
        verdict: mutant.verdict.name(),
        gate: mutant.gate.name(),
        first_cause: mutant.first_cause.clone().unwrap_or_default(),
    }
}
