//! Every metric against a case computed by hand.
//!
//! Steps and motions come every 0.1 s unless a test says otherwise; limits are 0.7 m/s, 2 rad/s.

mod authority;
mod borders;
mod edges;
mod ride;
mod safety;
mod task;
mod warrant;

use super::authority::Rate;
use super::catalogue::Feed;
use super::{Basis, Better, CATALOGUE, Group, Meter, metric};
use crate::CompareError;
use crate::synthetic::{Run, scenario};

/// Equal up to the rounding of a few sums.
#[track_caller]
fn close(got: Option<f64>, want: f64) {
    let got = got.expect("defined");
    assert!((got - want).abs() < 1e-9, "{got} instead of {want}");
}

#[test]
fn names_are_unique_and_carry_their_unit() {
    for (i, row) in CATALOGUE.iter().enumerate() {
        assert!(CATALOGUE[..i].iter().all(|other| other.name != row.name), "{}", row.name);
        assert_eq!(metric(row.name).map(|found| found.formula), Some(row.formula));
        let suffix = match row.unit {
            "m" => "_m",
            "s" => "_s",
            "m/s" => "_mps",
            "m/s²" => "_mps2",
            "m/s³" => "_mps3",
            "rad" => "_rad",
            "rad/s³" => "_radps3",
            "1/min" => "_per_min",
            "µs" => "_us",
            "" => "",
            other => panic!("{}: no suffix for {other}", row.name),
        };
        assert!(row.name.ends_with(suffix), "{}", row.name);
    }
    assert!(metric("no_such_metric").is_none());
}

/// Where a number comes from is told with it: the topic that feeds it, and the paper where there is one.
#[test]
fn sources_name_the_topic_of_the_feed() {
    for row in CATALOGUE {
        let topic = match row.feed {
            Feed::Motion => "/truth, or the estimate in /step",
            Feed::Decision => "/step",
            Feed::Request => "/joystick",
            Feed::Timing => "/timing",
        };
        assert!(row.source.contains(topic), "{}: {}", row.name, row.source);
    }
    let source = |name| metric(name).map_or("", |row| row.source);
    assert!(source("sparc").contains("Balasubramanian"));
    assert_eq!(source("override_m"), "/step and /command");
}

#[test]
fn without_truth_the_estimate_is_measured_in_the_scenarios_world() {
    // At (0.4, 1) the left side of the body is 0.15 m from the wall x = 0.
    let mut run = Run::new();
    run.step(0.0, |step| step.pose.x_m = 0.4).step(0.1, |_| {});
    assert_eq!(run.measured().metrics.basis, Basis::Estimate);
    close(run.metric("min_clearance_m"), 0.15);
    // Without a world nothing can be said of clearances.
    let mut scenario = scenario();
    scenario.world = schemas::World::default();
    let mut run = Run::of(scenario);
    run.step(0.0, |_| {});
    for name in ["min_clearance_m", "collisions", "near_miss_s", "invariance_breaches"] {
        assert_eq!(run.metric(name), None, "{name}");
    }
}

#[test]
fn truth_that_comes_late_replaces_the_estimate() {
    // The estimate collides at once and then nearly; the truth, which begins later, never does.
    let mut run = Run::new();
    run.step(0.0, |step| step.pose.x_m = -1.0);
    run.step(0.02, |step| step.pose.x_m = 0.3).step(0.05, |_| {});
    run.truth(0.1, |_| {}).step(0.1, |_| {});
    let measured = run.measured();
    assert_eq!(measured.metrics.basis, Basis::Truth);
    assert_eq!(measured.metrics.get("collisions"), Some(0.0));
    assert!(measured.violations.is_empty());
    assert_eq!(measured.metrics.get("min_clearance_m"), Some(1.0));
    let near_miss = CATALOGUE.iter().position(|row| row.name == "near_miss_s");
    let grown = measured.profile.contributions(near_miss.expect("in the catalogue"), 0.25);
    assert!(grown.iter().all(|x| *x == 0.0), "{grown:?}");
}

/// In text they are called as in JSON. Only what a clock says may differ from run to run.
#[test]
fn groups_and_directions_have_one_name_each() {
    for group in Group::ALL {
        assert_eq!(serde_json::json!(group), group.name());
        assert_eq!(group.is_repeatable(), group != Group::Cost);
    }
    for better in [Better::Lower, Better::Higher] {
        assert_eq!(serde_json::json!(better), better.name());
    }
}

/// A count of nothing in no time is no rate.
#[test]
fn a_rate_wants_time() {
    assert_eq!(Rate::default().per_min(), None);
    assert_eq!(Rate { count: 3, watched_s: 90.0 }.per_min(), Some(2.0));
}

/// What is printed of a meter is how much it has seen, and of a metric its name.
#[test]
fn a_meter_and_a_metric_are_printed_in_short() {
    let mut meter = Meter::new(&Run::new().header);
    Run::clearances(&[1.0, 0.9]).events.iter().for_each(|event| meter.observe(event));
    assert_eq!(format!("{meter:?}"), "Meter { events: 3, .. }");
    assert_eq!(format!("{:?}", metric("sparc")), "Some(Metric { name: \"sparc\", .. })");
}

#[test]
fn a_run_without_a_step_is_an_error_and_not_a_row_of_zeros() {
    let mut run = Run::new();
    run.truth(0.0, |_| {});
    let mut meter = Meter::new(&run.header);
    run.events.iter().for_each(|event| meter.observe(event));
    assert!(matches!(meter.finish(), Err(CompareError::NoSteps { events: 1 })));
}

/// A meter's copy goes on alone: it is measured as far as it was fed, and what it came from as if it had
/// never been copied.
#[test]
fn a_copy_of_a_meter_goes_on_alone() {
    let mut run = Run::new();
    for i in 0..60 {
        let t_s = f64::from(i) * 0.1;
        run.truth(t_s, |truth| {
            truth.pose.x_m = 1.0 + 0.3 * t_s;
            truth.v_mps = 0.3 + 0.01 * f64::from(i % 7);
            truth.clearance_m = 0.4 - 0.1 * t_s;
        });
        run.step(t_s, |step| step.k = f64::from(i % 5).min(1.0)).command(t_s, 0.1, 0.0);
    }
    let mut meter = Meter::new(&run.header);
    let mut copy = None;
    let half = run.events.len() / 2;
    for (i, event) in run.events.iter().enumerate() {
        if i == half {
            copy = Some(meter.clone());
        }
        meter.observe(event);
    }
    let copy = copy.expect("made halfway").finish().unwrap();
    let mut part = run.clone();
    part.events.truncate(half);
    // As text, in which NaN is NaN.
    assert_eq!(format!("{copy:?}"), format!("{:?}", part.measured()));
    assert_eq!(format!("{:?}", meter.finish().unwrap()), format!("{:?}", run.measured()));
    assert_ne!(format!("{:?}", part.measured().metrics), format!("{:?}", run.measured().metrics));
}

/// Runs of the same motion under other inputs, walked side by side: each is measured as it is alone.
#[test]
fn beside_another_run_a_run_is_measured_as_it_is_alone() {
    let run = |asked: f64| {
        let mut run = Run::new();
        for i in 0..60 {
            let t_s = f64::from(i) * 0.1;
            run.truth(t_s, |truth| {
                truth.pose.x_m = 3.5 - 0.05 * t_s;
                truth.v_mps = 0.2;
            });
            let asked = if i % 3 == 0 { asked } else { 0.5 };
            run.step(t_s, |step| step.v_h_mps = asked).command(t_s, 0.1, 0.0);
        }
        run
    };
    let mut other_room = run(0.6);
    other_room.header.scenario.world.room[2].offset_m = 4.3;
    let runs = [run(0.5), run(0.6), other_room];
    let first = Meter::new(&runs[0].header);
    let mut meters: Vec<Meter> = runs.iter().skip(1).map(|run| first.beside(&run.header)).collect();
    meters.insert(0, first);
    for i in 0..runs[0].events.len() {
        for (meter, run) in meters.iter_mut().zip(&runs) {
            meter.observe(&run.events[i]);
        }
    }
    let measured: Vec<_> = meters.into_iter().map(|meter| meter.finish().unwrap()).collect();
    for (beside, run) in measured.iter().zip(&runs) {
        // As text, in which NaN is NaN.
        assert_eq!(format!("{beside:?}"), format!("{:?}", run.measured()));
    }
    assert_ne!(measured[1].metrics.get("necessary"), measured[2].metrics.get("necessary"));
}

#[test]
fn a_step_stands_no_longer_than_two_periods() {
    // 10 s of silence after the first step, which overrides by 0.2 m/s: 2 · 0.1 s of it count,
    // and 0.1 s of the last step.
    let mut run = Run::new();
    run.step(0.0, |_| {}).command(0.0, 0.3, 0.0);
    run.step(10.0, |_| {}).command(10.0, 0.5, 0.0);
    close(run.metric("override_m"), 0.04);
    close(Some(run.measured().metrics.duration_s), 0.3);
}

/// Where the period is not told a step stands until the next one, half a second at most; the last one for no time.
#[test]
fn without_a_period_a_step_stands_for_half_a_second() {
    for period_s in [0.0, f64::NAN] {
        let mut run = Run::new();
        for t_s in [0.0, 0.3, 10.0] {
            run.step(t_s, |step| step.control_period_s = period_s);
        }
        close(Some(run.measured().metrics.duration_s), 0.3 + 0.5);
    }
}

#[test]
fn time_that_goes_back_counts_as_none() {
    let mut run = Run::new();
    run.step(1.0, |_| {}).command(1.0, 0.3, 0.0);
    run.step(0.5, |_| {}).command(0.5, 0.5, 0.0);
    let metrics = run.measured().metrics;
    assert_eq!(metrics.steps_back_in_time, 1);
    close(metrics.get("override_m"), 0.0);
}

#[test]
fn contributions_add_up_to_the_metric() {
    let (on, off) = ((0.0, [0.4, 0.3]), (1.0, [0.5, 0.0]));
    let pattern: Vec<_> = (0..300).map(|i| if i % 7 < 3 { on } else { off }).collect();
    let measured = Run::decisions(&pattern).measured();
    for name in [
        "human_share",
        "override_m",
        "override_rad",
        "interventions_per_min",
        "switches_per_min",
        "unwarranted",
    ] {
        let i = CATALOGUE.iter().position(|row| row.name == name).expect("in the catalogue");
        for bin_s in [0.25, 1.0] {
            let sum: f64 = measured.profile.contributions(i, bin_s).iter().sum();
            close(Some(sum), measured.metrics.get(name).expect("defined"));
        }
    }
}
