//! Several models of the recorded person, clusters, the floor, what one log indicates.

use super::{over, run, wobble};
use crate::comparison::{Arm, Comparison, LevelPair, LogPair, Verdict, compare};
use crate::synthetic::{pair, question};

/// A log with these clearances (A, B) at each level; the first level is a stress level.
fn log(name: &str, levels: &[(&str, f64, f64)]) -> LogPair {
    let mut log = pair(name, &run(0.5, 0.1), &run(0.5, 0.1));
    log.levels = levels
        .iter()
        .map(|(human, a, b)| {
            let level = pair(name, &run(*a, 0.1), &run(*b, 0.1)).levels.remove(0);
            LevelPair { human: (*human).to_owned(), estimates: *human != "playback", ..level }
        })
        .collect();
    log
}

fn laddered(n: usize, levels: impl Fn(usize) -> Vec<(&'static str, f64, f64)>) -> Comparison {
    let logs = (0..n).map(|i| log(&format!("log{i}"), &levels(i))).collect();
    compare(&question(), logs).expect("the controllers engage")
}

#[test]
fn the_estimate_is_the_mean_of_the_levels_that_deserve_it() {
    let got =
        laddered(1, |_| vec![("playback", 0.1, 0.9), ("intent", 0.3, 0.4), ("fitted", 0.4, 0.7)]);
    let change = got.logs[0].metrics["min_clearance_m"];
    let close = |got: Option<f64>, want: f64| {
        assert!((got.expect("defined") - want).abs() < 1e-12, "{got:?} instead of {want}");
    };
    close(change.a, 0.35);
    close(change.b, 0.55);
    close(change.delta, 0.2);
    let metric = got.metric("min_clearance_m").expect("in the catalogue");
    let levels: Vec<(&str, bool)> =
        metric.levels.iter().map(|level| (level.human.as_str(), level.estimates)).collect();
    assert_eq!(levels, [("playback", false), ("intent", true), ("fitted", true)]);
    close(metric.levels[0].delta, 0.8);
    // One level alone says what it is, and nothing twice.
    let single = laddered(1, |_| vec![("playback", 0.1, 0.9)]);
    assert!(single.logs[0].levels.is_empty());
    close(single.logs[0].metrics["min_clearance_m"].delta, 0.8);
}

#[test]
fn an_effect_that_one_level_contradicts_is_none() {
    let with = |playback: f64| {
        laddered(12, |i| {
            let w = wobble(i);
            vec![("playback", 0.3, 0.3 + playback + w), ("fitted", 0.3, 0.4 + w)]
        })
    };
    assert_eq!(with(0.05).verdict, Verdict::Better, "{}", with(0.05).reason);
    assert_eq!(with(-0.05).verdict, Verdict::Undecided);
}

#[test]
fn a_violation_at_some_levels_is_possible_and_at_every_level_fails() {
    let with = |playback: f64, fitted: f64| {
        laddered(2, |_| vec![("playback", 0.3, playback), ("fitted", 0.3, fitted)])
    };
    let some = with(-0.1, 0.3);
    assert_ne!(some.verdict, Verdict::Failed, "{}", some.reason);
    assert_eq!(some.violations.len(), 2);
    for violation in &some.violations {
        assert_eq!((violation.arm, violation.human.as_str()), (Arm::B, "playback"));
        assert!(violation.possible && !violation.new);
    }
    let all = with(-0.1, -0.05);
    assert_eq!(all.verdict, Verdict::Failed);
    assert_eq!(all.violations.len(), 4);
    assert!(all.violations.iter().all(|violation| violation.new && !violation.possible));
}

#[test]
fn a_level_that_fails_fails_its_log() {
    let mut bad = log("bad", &[("playback", 0.3, 0.3), ("fitted", 0.3, 0.3)]);
    bad.levels[1].a = Err("no goals found".to_owned());
    let none = LogPair { levels: Vec::new(), ..log("none", &[]) };
    let got = compare(&question(), vec![bad, none]).expect("there are logs");
    assert_eq!(got.verdict, Verdict::Failed);
    assert_eq!(got.logs[0].error.as_deref(), Some("fitted: A: no goals found"));
    assert_eq!(got.failed_logs(), 2);
}

#[test]
fn sessions_of_one_operator_are_one_piece_of_evidence() {
    let with = |operators: usize| {
        let logs = (0..24)
            .map(|i| LogPair {
                operator: format!("operator {}", i % operators),
                ..pair(&format!("log{i}"), &run(0.3, 0.1), &run(0.4 + wobble(i), 0.1))
            })
            .collect();
        compare(&question(), logs).expect("engages")
    };
    let twelve = with(12);
    assert_eq!((twelve.clustered_by.as_str(), twelve.verdict), ("operator", Verdict::Better));
    let clearance = twelve.metric("min_clearance_m").expect("in the catalogue");
    assert_eq!((clearance.n, clearance.clusters), (24, 12));
    // However many sessions four people drive, four people decide nothing.
    assert_eq!(with(4).verdict, Verdict::Undecided);
    // One operator alone: nothing is known of others, and each log speaks for itself.
    assert_eq!(with(1).clustered_by, "log");
    assert_eq!(with(1).verdict, Verdict::Better);
}

#[test]
fn sessions_of_one_scenario_are_one_piece_of_evidence() {
    let logs = (0..24)
        .map(|i| {
            let mut log = pair(&format!("log{i}"), &run(0.3, 0.1), &run(0.4 + wobble(i), 0.1));
            if let Some(scenario) = &mut log.scenario {
                scenario.name = format!("case{}", i % 3);
            }
            log
        })
        .collect();
    let got = compare(&question(), logs).expect("engages");
    assert_eq!((got.clustered_by.as_str(), got.verdict), ("scenario", Verdict::Undecided));
    assert_eq!(got.logs[4].cluster, "case1");
}

/// No effect below the bias of the simulation counts, however sure it is.
#[test]
fn what_the_simulation_gets_wrong_itself_is_no_effect() {
    let with = |recorded_m: f64| {
        let logs = (0..12)
            .map(|i| LogPair {
                recorded: Some(run(recorded_m, 0.1).measured()),
                ..pair(&format!("log{i}"), &run(0.3, 0.1), &run(0.4 + wobble(i), 0.1))
            })
            .collect();
        compare(&question(), logs).expect("engages")
    };
    // The gap is 0.02 m, then 0.15 m; the effect is 0.1 m.
    let fine = with(0.32);
    assert_eq!(fine.verdict, Verdict::Better);
    let floor = fine.metric("min_clearance_m").and_then(|metric| metric.floor);
    assert!((floor.expect("measured") - 0.02).abs() < 1e-12);
    let coarse = with(0.15);
    assert_eq!(coarse.verdict, Verdict::Undecided);
    // A log indicates what exceeds three gaps.
    assert_eq!(fine.logs[0].indicative.better, ["min_clearance_m"]);
    assert!(coarse.logs[0].indicative.better.is_empty());
    // Where A did not record, there is no floor.
    let plain = over(12, |i| (run(0.3, 0.1), run(0.4 + wobble(i), 0.1)));
    assert_eq!(plain.metric("min_clearance_m").and_then(|metric| metric.floor), None);
}

#[test]
fn a_single_log_is_indicative_only() {
    let got = over(1, |_| (run(0.3, 0.1), run(0.2, 0.1)));
    assert_eq!(got.verdict, Verdict::Undecided);
    assert_eq!(got.logs[0].indicative.worse, ["min_clearance_m"]);
    assert!(got.logs[0].indicative.better.is_empty());
    // Levels that contradict each other indicate nothing.
    let torn = laddered(1, |_| vec![("intent", 0.3, 0.4), ("fitted", 0.3, 0.2)]);
    assert_eq!(torn.logs[0].indicative, crate::Indication::default());
}

#[test]
fn parameters_that_differ_are_told() {
    let mut question = question();
    question.provenance.a.params_toml = "gamma3 = 2.0\nr_m = 0.5\n".to_owned();
    question.provenance.b.params_toml = "gamma3 = 2.5\nr_m = 0.5\n".to_owned();
    let got = compare(&question, vec![pair("log", &run(0.3, 0.1), &run(0.3, 0.1))]);
    let parameters = got.expect("engages").provenance.parameters;
    assert_eq!(parameters.len(), 1);
    assert_eq!(parameters[0].key, "gamma3");
}
