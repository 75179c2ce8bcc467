//! What a gate file may say, and what becomes of a comparison under it.

use super::{run, wobble};
use crate::comparison::{Comparison, Gate, GateFile, compare};
use crate::synthetic::{pair, question};

fn gated(toml: &str, n: usize, arms: impl Fn(usize) -> (f64, f64)) -> Comparison {
    let logs = (0..n)
        .map(|i| {
            let (a, b) = arms(i);
            pair(&format!("log{i}"), &run(a, 0.1), &run(b, 0.1))
        })
        .collect();
    let gate = GateFile::from_toml(toml).expect("a sound gate");
    let question = crate::Question { gate: Some(gate), ..question() };
    compare(&question, logs).expect("the controllers engage")
}

fn of(comparison: &Comparison, name: &str) -> (Gate, String) {
    let metric = comparison.metric(name).expect("in the catalogue");
    (metric.gate, metric.gate_reason.clone())
}

fn outcome(comparison: &Comparison) -> Gate {
    comparison.gate.as_ref().expect("there is a gate").outcome
}

const CLEARANCE: &str = "[metrics.min_clearance_m]\nmargin = 0.05\n";

#[test]
fn within_the_margin_passes_beyond_it_fails_across_it_is_undecided() {
    // B's clearance is 0.02, 0.10 or about 0.05 m less, a little different from log to log.
    let with = |less: f64| gated(CLEARANCE, 12, |i| (0.5, 0.5 - less + 0.5 * wobble(i)));
    assert_eq!(outcome(&with(0.02)), Gate::Pass);
    assert_eq!(of(&with(0.02), "min_clearance_m"), (Gate::Pass, String::new()));
    let worse = with(0.10);
    assert_eq!(outcome(&worse), Gate::Fail);
    let (gate, reason) = of(&worse, "min_clearance_m");
    assert_eq!(gate, Gate::Fail);
    assert!(reason.contains("margin 0.050"), "{reason}");
    assert_eq!(outcome(&with(0.0525)), Gate::Undecided);
    // Better than A is no worse.
    assert_eq!(outcome(&with(-0.3)), Gate::Pass);
    // What no gate was set for stays so.
    assert_eq!(of(&worse, "human_share"), (Gate::None, String::new()));
}

#[test]
fn too_few_logs_decide_nothing() {
    assert_eq!(outcome(&gated(CLEARANCE, 7, |_| (0.5, 0.2))), Gate::Undecided);
    assert_eq!(outcome(&gated(CLEARANCE, 7, |_| (0.5, 0.5))), Gate::Undecided);
    assert_eq!(outcome(&gated(CLEARANCE, 8, |_| (0.5, 0.5))), Gate::Pass);
    let strict = "[metrics.min_clearance_m]\nmargin = 0.05\nrequired_n = 30\n";
    let few = gated(strict, 12, |_| (0.5, 0.5));
    assert_eq!(outcome(&few), Gate::Undecided);
    assert!(of(&few, "min_clearance_m").1.contains("12 logs or clusters, 30 required"));
    // Beyond the margin in all of four logs, which chance brings about in 2 of 2⁴ cases.
    let lenient = "[metrics.min_clearance_m]\nmargin = 0.05\nrequired_n = 2\n";
    let chance = gated(lenient, 4, |i| (0.5, 0.2 + 0.1 * wobble(i)));
    let (gate, reason) = of(&chance, "min_clearance_m");
    assert_eq!(gate, Gate::Undecided);
    assert!(reason.contains("to rule out chance (p 0.125 corrected, 0.05 at most)"), "{reason}");
}

#[test]
fn hard_limits_hold_whatever_the_margin_says() {
    let each = "[metrics.min_clearance_m]\nmargin = 1.0\nlog_limit = 0.2\n";
    let with_one = |low: f64| gated(each, 12, |i| (0.5, if i == 3 { low } else { 0.5 }));
    assert_eq!(outcome(&with_one(0.21)), Gate::Pass);
    let broken = with_one(0.19);
    assert_eq!(outcome(&broken), Gate::Fail);
    assert!(of(&broken, "min_clearance_m").1.contains("in log3, at least 0.200"));
    let mean = "[metrics.min_clearance_m]\nmean_limit = 0.4\n";
    assert_eq!(outcome(&gated(mean, 2, |_| (0.9, 0.41))), Gate::Pass);
    assert_eq!(outcome(&gated(mean, 2, |_| (0.9, 0.39))), Gate::Fail);
    // The other direction: collisions are the better the fewer.
    let none = "[violations]\nnew = 9\n[metrics.collisions]\nlog_limit = 0\n";
    assert_eq!(outcome(&gated(none, 8, |_| (0.5, 0.5))), Gate::Pass);
    assert_eq!(outcome(&gated(none, 8, |i| (0.5, if i == 0 { -0.1 } else { 0.5 }))), Gate::Fail);
}

#[test]
fn a_new_violation_fails_unless_it_is_allowed() {
    let hits = |i: usize| (0.5, if i == 0 { -0.01 } else { 0.5 });
    let wide = "[metrics.min_clearance_m]\nmargin = 1.0\n";
    let got = gated(wide, 12, hits);
    assert_eq!(outcome(&got), Gate::Fail);
    let reasons = &got.gate.as_ref().expect("there is one").reasons;
    assert!(reasons[0].contains("1 violations of B that A does not have"), "{reasons:?}");
    let allowed = format!("[violations]\nnew = 1\n{wide}");
    assert_eq!(outcome(&gated(&allowed, 12, hits)), Gate::Pass);
}

#[test]
fn a_failed_log_fails_the_gate() {
    let gate = GateFile::from_toml(CLEARANCE).expect("sound");
    let mut logs: Vec<_> =
        (0..12).map(|i| pair(&format!("log{i}"), &run(0.5, 0.1), &run(0.5, 0.1))).collect();
    logs[4].levels[0].b = Err("timed out".to_owned());
    let question = crate::Question { gate: Some(gate), ..question() };
    let got = compare(&question, logs).expect("there are logs");
    assert_eq!(outcome(&got), Gate::Fail);
}

/// No metric of B differs from A's but by chance: of 200 such comparisons over sixteen logs at most one
/// in twenty may fail, whatever their number of gated metrics.
#[test]
fn chance_alone_rarely_fails_the_gate() {
    use crate::statistics::Generator;
    let toml: String = ["min_clearance_m", "near_miss_s", "stop_margin_m", "barrier_breaches"]
        .map(|name| format!("[metrics.{name}]\nmargin = 0.0\n"))
        .concat();
    let gate = GateFile::from_toml(&toml).expect("sound");
    let mut generator = Generator::new(16);
    let mut fails = 0;
    for _ in 0..200 {
        let logs = (0..16)
            .map(|i| {
                let mut clearance = || {
                    let x = 0.02 + 0.2 * generator.unit();
                    let mut run = crate::synthetic::Run::clearances(&[x, x, x]);
                    run.step(0.1, |step| step.k = 0.0);
                    run
                };
                pair(&format!("log{i}"), &clearance(), &clearance())
            })
            .collect();
        let question = crate::Question { gate: Some(gate.clone()), ..question() };
        let got = compare(&question, logs).expect("engages");
        fails += u32::from(outcome(&got) == Gate::Fail);
    }
    // The four move together here, so that Holm is stricter than it need be.
    assert!(fails <= 10, "{fails} of 200");
}

#[test]
fn errors_name_key_value_and_range() {
    let cases = [
        ("", "nothing to gate by"),
        ("x = 1", "`x`: expected one of violations, metrics"),
        ("metrics = 3", "`metrics` = 3: expected a table"),
        ("[metrics.clearance]\nmargin = 1", "`metrics.clearance`: expected one of min_clearance_m"),
        ("[metrics.step_time_max_us]\nmargin = 1", "`metrics.step_time_max_us`: expected one of"),
        (
            "[metrics.collisions]\nmargin = -0.5",
            "`metrics.collisions.margin` = -0.5: expected a finite number, at least 0",
        ),
        (
            "[metrics.collisions]\nmargin = nan",
            "`metrics.collisions.margin` = nan: expected a finite number, at least 0",
        ),
        (
            "[metrics.collisions]\nmargin = \"a\"",
            "`metrics.collisions.margin` = \"a\": expected a finite number, at least 0",
        ),
        (
            "[metrics.collisions]\nmargins = 1",
            "`metrics.collisions.margins`: expected one of margin",
        ),
        (
            "[metrics.collisions]\nmargin = 1\nrequired_n = 1",
            "`metrics.collisions.required_n` = 1: expected a whole number, at least 2",
        ),
        ("[metrics.collisions]\nrequired_n = 9", "expected a margin, a mean_limit or a log_limit"),
        ("[violations]\nnew = -1", "`violations.new` = -1: expected a whole number, at least 0"),
        ("[violations]\nnew = 1.5", "`violations.new` = 1.5: expected a whole number, at least 0"),
        ("[violations]\nold = 1", "`violations.old`: expected one of new, possible"),
        ("[[", "TOML parse error"),
    ];
    for (toml, wanted) in cases {
        let error = GateFile::from_toml(toml).expect_err(toml).to_string();
        assert!(error.contains(wanted), "{toml:?}: {error}");
        assert!(error.starts_with("gate file: "));
    }
}
