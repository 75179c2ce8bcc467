//! What `check` finds, what it names, and how a golden result changes.

use schemas::Step;

use super::{Golden, check};
use crate::diff::Diff;
use crate::synthetic::{Run, pair};

fn run(change: impl Fn(&mut Step)) -> Run {
    let mut run = Run::new();
    for i in 0..5 {
        let t_s = f64::from(i) * 0.1;
        run.truth(t_s, |_| {});
        run.step(t_s, |step| {
            step.k = 0.0;
            step.lyapunov = 1.0;
            if i >= 2 {
                change(step);
            }
        });
        run.command(t_s, 0.3, 0.0);
    }
    run
}

fn golden(hash: &str, run: &Run) -> Golden {
    Golden::of("tandem-kinematic", "open", hash, &run.measured())
}

fn diff(a: &Run, b: &Run) -> Diff {
    pair("log", a, b).levels.remove(0).diff.expect("compared").expect("has steps")
}

#[test]
fn an_unchanged_result_has_no_problem() {
    let run = run(|_| {});
    let golden = golden("aa", &run);
    assert_eq!(check("case1", &golden, &golden, Some(&diff(&run, &run))), []);
    assert_eq!(check("case1", &golden, &golden, None), []);
}

#[test]
fn a_mismatch_names_field_time_and_amount() {
    let (was, is) = (run(|_| {}), run(|step| step.lyapunov = 1.05));
    let problems = check("case1", &golden("aa", &was), &golden("bb", &is), Some(&diff(&was, &is)));
    assert_eq!(problems.len(), 1);
    let what = &problems[0].what;
    for named in ["lyapunov", "0.200 s", "1 in A and 1.050 in B", "by 0.050", "3 of 10 messages"] {
        assert!(what.contains(named), "{named} in {what}");
    }
    assert_eq!(problems[0].at, "case1");
    assert!(problems[0].remedy.contains("tandem approve case1 --reason"));
}

#[test]
fn metrics_and_steps_that_change_are_named() {
    let (was, mut is) = (run(|_| {}), run(|_| {}));
    is.step(0.5, |step| step.v_h_mps = 0.7).command(0.5, 0.3, 0.0);
    let problems = check("case1", &golden("aa", &was), &golden("bb", &is), Some(&diff(&was, &is)));
    let all: Vec<&str> = problems.iter().map(|problem| problem.what.as_str()).collect();
    assert!(all[0].contains("steps_only_in_b") || all[0].contains("B has a step"), "{all:?}");
    assert!(all.iter().any(|what| what.starts_with("6 steps instead of 5")), "{all:?}");
    // 5 · 0.1 s · 0.2 m/s, then 0.4 m/s more for 0.1 s.
    assert!(all.iter().any(|what| what.contains("override_m 0.140 instead of 0.100")), "{all:?}");
}

#[test]
fn a_hash_that_differs_is_a_problem_even_where_no_field_does() {
    let run = run(|_| {});
    let (was, is) = (golden("aa", &run), golden("bb", &run));
    for diff in [None, Some(diff(&run, &run))] {
        let problems = check("case1", &was, &is, diff.as_ref());
        assert_eq!(problems.len(), 1);
        assert!(problems[0].what.contains("bb instead of aa"), "{}", problems[0].what);
    }
}

#[test]
fn another_controller_mode_or_no_step_is_its_own_problem() {
    let run = run(|_| {});
    let was = golden("aa", &run);
    for is in [
        Golden { controller: "paper-kinematic".to_owned(), ..was.clone() },
        Golden { mode: "closed".to_owned(), ..was.clone() },
        Golden { steps: 0, ..was.clone() },
    ] {
        assert_eq!(check("case1", &was, &is, Some(&diff(&run, &run))).len(), 1);
    }
}

#[test]
fn an_approval_keeps_its_reason_and_the_older_ones() {
    let first = golden("aa", &run(|_| {})).approved(None, "first recording").expect("has a reason");
    let changed = golden("bb", &run(|step| step.lyapunov = 2.0));
    assert!(!changed.same_result(&first));
    let second = changed.approved(Some(&first), " γ3 raised ").expect("has a reason");
    let reasons: Vec<_> =
        second.approvals.iter().map(|a| (a.reason.as_str(), a.output_hash.as_str())).collect();
    assert_eq!(reasons, [("first recording", "aa"), ("γ3 raised", "bb")]);
    assert!(second.clone().approved(None, "  ").is_err());

    let text = second.to_toml().expect("has a TOML form");
    assert_eq!(Golden::from_toml(&text).expect("reads its own TOML"), second);
}

/// The file is data under review: what was not approved does not count.
#[test]
fn a_golden_file_without_its_approval_is_refused() {
    let bare = golden("aa", &run(|_| {}));
    assert!(Golden::from_toml(&bare.to_toml().expect("has a TOML form")).is_err());
    let mut edited = bare.approved(None, "first recording").expect("has a reason");
    edited.output_hash = "cc".to_owned();
    let error = Golden::from_toml(&edited.to_toml().expect("has a TOML form"));
    assert!(error.expect_err("never approved").to_string().contains("never approved"));
    for text in ["", "not toml", "controller = 1"] {
        assert!(Golden::from_toml(text).is_err(), "{text}");
    }
}
