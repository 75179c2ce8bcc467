//! Verdicts, violations, moments and what becomes of logs that fail.

mod gate;
mod ladder;

use schemas::{Reason, Region};

use super::{Arm, Comparison, LogPair, LogStatus, Question, Verdict, compare};
use crate::metrics::ViolationKind;
use crate::synthetic::{Run, pair, question};
use crate::{CompareError, Tolerances};

/// A run of two seconds that keeps this clear of things and commands this much less than the
/// 0.5 m/s that the person asks for; k is 0 while it does.
fn run(clearance_m: f64, less_mps: f64) -> Run {
    let mut run = Run::new();
    for i in 0..20 {
        let t_s = f64::from(i) * 0.1;
        run.truth(t_s, |truth| {
            truth.clearance_m = clearance_m;
            truth.clearance_static_m = clearance_m;
        });
        run.step(t_s, |step| step.k = if less_mps > 0.0 { 0.0 } else { 1.0 });
        run.command(t_s, 0.5 - less_mps, 0.0);
    }
    run
}

/// A comparison over `n` logs; the closure gives both arms of the i-th.
fn over(n: usize, arms: impl Fn(usize) -> (Run, Run)) -> Comparison {
    let logs = (0..n)
        .map(|i| {
            let (a, b) = arms(i);
            pair(&format!("log{i}"), &a, &b)
        })
        .collect();
    compare(&question(), logs).expect("the controllers engage")
}

/// A small number of its own for every log.
fn wobble(i: usize) -> f64 {
    0.001 * i as f64
}

#[test]
fn a_against_a_is_the_same_whatever_the_number_of_logs() {
    for n in [1, 12] {
        let same = over(n, |i| (run(0.3 + wobble(i), 0.1), run(0.3 + wobble(i), 0.1)));
        assert_eq!(same.verdict, Verdict::Same, "{}", same.reason);
        assert!(same.metrics.iter().all(|m| m.n == 0 || m.delta == Some(0.0)));
        assert!(same.metrics.iter().all(|metric| !metric.decidable));
        assert!(same.violations.is_empty() && same.moments.is_empty());
        assert!(same.logs.iter().all(|log| log.first_cause.is_none()));
    }
}

/// The rules of the verdict, case by case: clearances and overrides of both arms over twelve logs.
#[test]
fn the_verdict_follows_its_rules() {
    use Verdict::{Better, Undecided, Worse};
    // (what, A's clearance and override, B's, verdict, what the reason names)
    let cases = [
        ("safer", (0.3, 0.1), (0.4, 0.1), Better, "min_clearance_m +0."),
        ("less safe", (0.4, 0.1), (0.3, 0.1), Worse, "min_clearance_m -0."),
        ("as safe, overrides less", (0.3, 0.2), (0.3, 0.1), Better, "override_m -"),
        ("as safe, overrides more", (0.3, 0.1), (0.3, 0.2), Worse, "override_m +"),
        ("safer at a price", (0.3, 0.1), (0.4, 0.2), Better, "; the price is override_m +"),
        ("less safe, overrides less", (0.4, 0.2), (0.3, 0.1), Worse, "against that stands"),
    ];
    for (what, a, b, verdict, named) in cases {
        let got = over(12, |i| {
            let w = wobble(i);
            // Changes that are there differ a little from log to log.
            (run(a.0 + w, a.1), run(b.0 + if a.0 == b.0 { w } else { 1.1 * w }, b.1))
        });
        assert_eq!(got.verdict, verdict, "{what}: {}", got.reason);
        assert!(got.reason.contains(named), "{what}: {}", got.reason);
    }

    // No direction: half of the logs better, half worse.
    let mixed = over(12, |i| {
        let (x, y) = if i % 2 == 0 { (0.3, 0.4) } else { (0.4, 0.3) };
        (run(x, 0.1), run(y, 0.1))
    });
    assert_eq!(mixed.verdict, Undecided);
    assert!(mixed.reason.contains("beyond chance"), "{}", mixed.reason);
}

/// A run past something, at these clearances, metres, under the feedback law.
fn past(clearances_m: &[f64]) -> Run {
    let mut run = Run::clearances(clearances_m);
    run.step(0.1, |step| step.k = 0.0);
    run
}

/// Safety metrics that point in both directions decide nothing.
#[test]
fn contradicting_safety_metrics_decide_nothing() {
    // A lingers at 0.08 m; B passes quickly, at 0.05 m: fewer near misses, a smaller minimum.
    let got = over(12, |i| {
        let w = wobble(i);
        (past(&[0.08 + w; 20]), past(&[0.5, 0.05 + w, 0.5, 0.5]))
    });
    assert_eq!(got.verdict, Verdict::Undecided, "{}", got.reason);
    assert!(got.reason.contains("contradict"), "{}", got.reason);
}

/// Who drives through a wall is not near it for long: what happened speaks before how near it came, and what got
/// worse is named.
#[test]
fn what_happened_speaks_before_what_nearly_did() {
    let through = |w: f64| past(&[0.5, -0.1 - w, -0.2, 0.5]);
    let beside = |w: f64| past(&[0.08 + w; 20]);
    let got = over(12, |i| (through(wobble(i)), beside(wobble(i))));
    assert_eq!(got.verdict, Verdict::Better, "{}", got.reason);
    assert!(got.reason.contains("collisions -1"), "{}", got.reason);
    assert!(got.reason.contains("; the price is near_miss_s +"), "{}", got.reason);

    // Both touch, B faster, and A lingers beside it before.
    let touches = |v_mps: f64, clearances_m: &[f64]| {
        let mut run = Run::new();
        for (i, clearance_m) in clearances_m.iter().enumerate() {
            run.truth(0.1 * i as f64, |truth| {
                truth.v_mps = v_mps;
                (truth.clearance_m, truth.clearance_static_m) = (*clearance_m, *clearance_m);
            });
        }
        run.step(0.0, |step| step.k = 0.0);
        run
    };
    let got = over(12, |i| {
        let w = wobble(i);
        let slow = [0.5, 0.05, 0.05, 0.05, 0.05, -0.1, 0.5, 0.5];
        (touches(0.1, &slow), touches(0.4 + w, &[0.5, 0.5, 0.5, 0.5, 0.5, -0.1, 0.5, 0.5]))
    });
    assert_eq!(got.verdict, Verdict::Worse, "{}", got.reason);
    assert!(got.reason.contains("contact_speed_mps +0.3"), "{}", got.reason);
    assert!(got.reason.contains("against that stands near_miss_s -"), "{}", got.reason);
}

/// n differences of one sign have p = 2/2ⁿ; Holm multiplies by the number of safety metrics, four
/// here. Seven logs give 4 · 2/128 = 0.0625, eight 0.031.
#[test]
fn a_handful_of_logs_decides_nothing() {
    let with = |n| over(n, |i| (run(0.3, 0.1), run(0.4 + wobble(i), 0.1)));
    for (n, verdict) in [
        (1, Verdict::Undecided),
        (2, Verdict::Undecided),
        (7, Verdict::Undecided),
        (8, Verdict::Better),
    ] {
        let got = with(n);
        assert_eq!(got.verdict, verdict, "{n} logs: {}", got.reason);
        let clearance = got.metric("min_clearance_m").expect("in the catalogue");
        assert_eq!(clearance.n, n);
        // One log has a change, but no interval.
        assert_eq!(clearance.ci.is_some(), n > 1);
        assert!(clearance.delta.is_some());
    }
}

#[test]
fn a_new_collision_of_b_fails_by_itself() {
    let got = over(12, |i| (run(0.3, 0.1), run(if i == 5 { -0.01 } else { 0.4 }, 0.1)));
    assert_eq!(got.verdict, Verdict::Failed);
    assert_eq!(got.violations.len(), 1);
    let violation = &got.violations[0];
    assert_eq!((violation.log.as_str(), violation.arm, violation.new), ("log5", Arm::B, true));
    assert_eq!(violation.kind, ViolationKind::LeftAdmissibleSet);
    assert!(got.reason.contains("log5"), "{}", got.reason);
}

#[test]
fn what_a_does_too_is_listed_and_not_held_against_b() {
    let got = over(12, |_| (run(-0.02, 0.1), run(-0.01, 0.1)));
    assert_ne!(got.verdict, Verdict::Failed);
    assert_eq!(got.violations.len(), 24);
    assert!(got.violations.iter().all(|violation| !violation.new));
    // A alone: no reason to fail, and listed all the same.
    let got = over(12, |i| (run(-0.02, 0.1), run(0.2 + wobble(i), 0.1)));
    assert_eq!(got.verdict, Verdict::Better);
    assert_eq!(got.violations.iter().filter(|v| v.arm == Arm::A).count(), 12);
}

/// A disc that runs over a robot is listed and held against nobody.
#[test]
fn a_passive_contact_does_not_fail() {
    let disc = |v_mps: f64| {
        let mut run = Run::new();
        run.truth(0.0, |truth| {
            truth.clearance_m = -0.05;
            truth.v_mps = v_mps;
            truth.pose = schemas::Pose::default();
            truth.discs = vec![schemas::Disc { centre_m: [0.4, 0.0], radius_m: 0.2 }];
        });
        run.step(0.0, |step| step.k = 0.0);
        run
    };
    let clear = || run(0.3, 0.1);
    assert_ne!(over(2, |_| (clear(), disc(0.0))).verdict, Verdict::Failed);
    assert_eq!(over(2, |_| (clear(), disc(0.3))).verdict, Verdict::Failed);
}

#[test]
fn a_failed_log_fails_the_comparison_and_stays_in_it() {
    let mut logs = vec![pair("good", &run(0.3, 0.1), &run(0.3, 0.1))];
    let mut bad = pair("bad", &run(0.3, 0.1), &run(0.3, 0.1));
    bad.levels[0].b = Err("controller panicked at 3.2 s".to_owned());
    bad.levels[0].diff = None;
    logs.push(bad);
    let got = compare(&question(), logs).expect("there are logs");
    assert_eq!(got.verdict, Verdict::Failed);
    assert_eq!(got.failed_logs(), 1);
    assert_eq!(got.logs[1].status, LogStatus::Failed);
    assert_eq!(got.logs[1].error.as_deref(), Some("B: controller panicked at 3.2 s"));
    assert!(got.logs[1].metrics.is_empty());
    assert!(got.reason.contains("1 of 2 logs") && got.reason.contains("3.2 s"), "{}", got.reason);
    // The good log is measured all the same.
    assert_eq!(got.metric("override_m").expect("in the catalogue").n, 1);
}

#[test]
fn a_log_that_was_not_diffed_is_a_failed_one() {
    for diff in [None, Some(Err("cannot read".to_owned()))] {
        let mut log = pair("log", &run(0.3, 0.1), &run(0.3, 0.1));
        log.levels[0].diff = diff;
        let got = compare(&question(), vec![log]).expect("there is a log");
        assert_eq!(got.verdict, Verdict::Failed);
    }
}

#[test]
fn nothing_to_compare_is_an_error() {
    assert!(matches!(compare(&question(), Vec::new()), Err(CompareError::NoLogs)));
    // k = 1 throughout: neither controller was ever called upon.
    let idle = vec![pair("idle", &run(0.3, 0.0), &run(0.3, 0.0))];
    assert!(matches!(compare(&question(), idle), Err(CompareError::NeverEngaged { logs: 1 })));
    // But harm is never nothing.
    let harm = vec![pair("harm", &run(0.3, 0.0), &run(-0.1, 0.0))];
    assert_eq!(compare(&question(), harm).expect("fails").verdict, Verdict::Failed);
}

/// Hidden state alone is no difference in behaviour; anything else is, also where no metric sees
/// it.
#[test]
fn same_means_that_nothing_that_shows_differs() {
    let changed = |change: fn(&mut schemas::Step)| {
        let mut b = run(0.3, 0.1);
        b.step(2.0, change).command(2.0, 0.4, 0.0);
        let mut a = run(0.3, 0.1);
        a.step(2.0, |_| {}).command(2.0, 0.4, 0.0);
        compare(&question(), vec![pair("log", &a, &b)]).expect("engages").verdict
    };
    assert_eq!(changed(|step| step.state_hash = 7), Verdict::Same);
    assert_eq!(changed(|step| step.z2 = 1e-12), Verdict::Undecided);
}

/// A metric that only one arm has is no pair, and is not hidden either.
#[test]
fn a_value_of_one_arm_only_is_counted() {
    // B collides in two of three logs, A never: a contact speed exists for B only.
    let got = over(3, |i| (run(0.3, 0.1), run(if i > 0 { -0.1 } else { 0.3 }, 0.1)));
    let speed = got.metric("contact_speed_mps").expect("in the catalogue");
    assert_eq!((speed.n, speed.only_a, speed.only_b), (0, 0, 2));
    assert_eq!((speed.a, speed.b, speed.delta), (None, None, None));
}

/// The moments are where the change is: the feedback law takes over at 1.0 s in B, and a second of
/// 0.2 m/s less is 0.2 m of override.
#[test]
fn moments_tell_when_and_why() {
    let arm = |takes_over: bool| {
        let mut run = Run::new();
        for i in 0..40 {
            let t_s = f64::from(i) * 0.1;
            let feedback = takes_over && (10..20).contains(&i);
            run.step(t_s, |step| {
                if feedback {
                    step.k = 0.0;
                    step.reason = Reason::Danger;
                    step.region = Region::Danger;
                    step.distance_human_m = 0.31;
                }
            });
            run.command(t_s, if feedback { 0.3 } else { 0.5 }, 0.0);
        }
        run
    };
    let got = compare(&question(), vec![pair("log", &arm(false), &arm(true))]).expect("B engages");
    let moment = got.moments.iter().find(|m| m.metric == "override_m").expect("it changed");
    assert_eq!(moment.t_s, 1.0);
    assert!((moment.delta - 0.2).abs() < 1e-9, "{}", moment.delta);
    assert_eq!(moment.share, 1.0);
    assert_eq!(
        moment.why,
        "in B the feedback law took over at 1.00 s (danger, D = 0.310 m, requested 0.500 m/s); in \
         A the person had driven since 0.00 s"
    );
    // Every stretch of a metric adds up to its change.
    for name in ["override_m", "human_share", "interventions_per_min"] {
        let sum: f64 = got.moments.iter().filter(|m| m.metric == name).map(|m| m.delta).sum();
        let delta = got.logs[0].metrics[name].delta.expect("defined");
        assert!((sum - delta).abs() < 1e-9, "{name}: {sum} of {delta}");
    }
    // Seen from the other side it is the same moment.
    let swapped =
        compare(&question(), vec![pair("log", &arm(true), &arm(false))]).expect("A engages");
    let moment = swapped.moments.iter().find(|m| m.metric == "override_m").expect("it changed");
    assert_eq!(moment.t_s, 1.0);
    assert!(moment.delta < 0.0);
    assert!(moment.why.starts_with("in A the feedback law took over at 1.00 s"), "{}", moment.why);
}

/// What the trace and the sonars tell of a switch is said.
#[test]
fn a_moment_names_the_distance_that_fell_and_the_echo() {
    let arm = |takes_over: bool| {
        let mut run = Run::new();
        for i in 0..20 {
            let t_s = f64::from(i) * 0.1;
            let stamp = crate::synthetic::at(t_s);
            let echo = schemas::SonarEcho { id: 3, range_m: 0.42, echo: true, fired: stamp };
            let scan = schemas::SonarScan { stamp, echoes: vec![echo] };
            run.events.push(schemas::Stamped {
                at: stamp,
                value: schemas::Event::Sample(schemas::Sample::Sonar(scan)),
            });
            let feedback = takes_over && i >= 10;
            run.step(t_s, |step| {
                step.distance_human_m = if i < 10 { 0.45 } else { 0.31 };
                if feedback {
                    (step.k, step.reason) = (0.0, Reason::Danger);
                }
            });
            run.command(t_s, if feedback { 0.3 } else { 0.5 }, 0.0);
        }
        run
    };
    let got = compare(&question(), vec![pair("log", &arm(false), &arm(true))]).expect("B engages");
    let moment = got.moments.iter().find(|m| m.metric == "override_m").expect("it changed");
    assert_eq!(
        moment.why,
        "in B the feedback law took over at 1.00 s (danger, D fell from 0.450 to 0.310 m, requested \
         0.500 m/s, nearest echo 0.420 m at sonar 3); in A the person had driven since 0.00 s"
    );
}

/// The shape that other programs read.
#[test]
fn json_has_the_agreed_keys_and_survives_the_way_back() {
    let got = over(3, |i| (run(0.3, 0.1), run(if i == 0 { -0.1 } else { 0.4 }, 0.2)));
    let json = serde_json::to_value(&got).expect("has a JSON form");
    assert_eq!(json["verdict"], "failed");
    for key in
        ["a", "b", "mode", "human", "logs", "metrics", "violations", "moments", "report", "reason"]
    {
        assert!(json.get(key).is_some(), "{key}");
    }
    for key in ["log", "status", "horizon_s", "metrics", "first_cause"] {
        assert!(json["logs"][0].get(key).is_some(), "{key}");
    }
    for key in ["a", "b", "delta"] {
        assert!(json["logs"][0]["metrics"]["override_m"][key].is_f64(), "{key}");
    }
    for key in
        ["name", "unit", "better", "a", "b", "delta", "ci", "n", "floor", "decidable", "gate"]
    {
        assert!(json["metrics"][0].get(key).is_some(), "{key}");
    }
    assert_eq!(json["metrics"][0]["better"], "higher");
    assert_eq!(json["metrics"][0]["gate"], "none");
    assert_eq!(json["metrics"][0]["ci"].as_array().map(Vec::len), Some(2));
    for key in ["log", "t_s", "kind", "arm"] {
        assert!(json["violations"][0].get(key).is_some(), "{key}");
    }
    assert_eq!(json["violations"][0]["arm"], "b");
    assert_eq!(json["violations"][0]["kind"], "left_admissible_set");
    for key in ["log", "t_s", "metric", "delta", "why"] {
        assert!(json["moments"][0].get(key).is_some(), "{key}");
    }
    let back: Comparison = serde_json::from_value(json).expect("reads its own JSON");
    assert_eq!(back, Comparison { scenes: Vec::new(), ..got });
}

#[test]
fn an_unmeasured_question_stays_as_asked() {
    let question = Question { human: vec!["playback".to_owned()], ..question() };
    let log = LogPair { operator: "ada".to_owned(), ..pair("l", &run(0.3, 0.1), &run(0.3, 0.1)) };
    let got = compare(&question, vec![log]).expect("engages");
    assert_eq!((got.a.as_str(), got.b.as_str(), got.mode.as_str()), ("old", "new", "closed"));
    assert_eq!(got.human, ["playback"]);
    assert_eq!(got.logs[0].operator, "ada");
    assert_eq!(Tolerances::exact(), Tolerances::default());
}
