//! Contract: the figure shows what the run holds, stands alone, and is made of finite numbers only.

use schemas::{Pose, Reason};

use super::{Recording, figure};
use crate::CompareError;
use crate::synthetic::{Run, block, scenario, task};

fn recorded(run: &Run) -> Recording {
    let mut recording = Recording::new(&run.header);
    run.events.iter().for_each(|event| recording.observe(event));
    recording
}

/// Three seconds at 0.5 m/s; the law drives from 1 s to 2 s. Nearest to anything at 1.4 s.
fn run() -> Run {
    let mut scenario = scenario();
    scenario.task = Some(task());
    scenario.world.obstacles = vec![block(2.0, 0.4)];
    let mut run = Run::of(scenario);
    run.header.params_toml = "b1_task_m = 1.0\nb2_task_m = 1.3\n".to_owned();
    run.header.run.scenario = "three-seconds".to_owned();
    for i in 0..30 {
        let t_s = f64::from(i) * 0.1;
        let x_m = 1.0 + 0.5 * t_s;
        run.truth(t_s, |truth| {
            truth.pose.x_m = x_m;
            truth.clearance_m = 0.1 + (t_s - 1.4).abs();
        });
        run.step(t_s, |step| {
            step.distance_human_m = 0.8;
            step.distance_effective_m = 0.7;
            step.danger = 0.5;
            step.lyapunov = 0.01;
            if (10..20).contains(&i) {
                step.k = 0.0;
                step.reason = Reason::Danger;
            }
        });
        run.command(t_s, 0.5, 0.0);
    }
    run
}

#[test]
fn the_facts_are_those_of_the_run() {
    let (_, facts) = figure(recorded(&run())).unwrap();
    assert!((facts.duration_s - 3.0).abs() < 1e-9);
    assert_eq!(facts.feedback_s.len(), 1);
    let [from_s, until_s] = facts.feedback_s[0];
    assert!((from_s - 1.0).abs() < 1e-9 && (until_s - 2.0).abs() < 1e-9);
    assert!((facts.feedback_share - 1.0 / 3.0).abs() < 1e-9);
    assert!((facts.least_clearance_m.unwrap() - 0.1).abs() < 1e-9);
    assert!((facts.least_clearance_at_s.unwrap() - 1.4).abs() < 1e-9);
    assert!((facts.end_m[0] - 2.45).abs() < 1e-9 && facts.end_m[1] == 1.0);
}

/// Of a part of a session, from 1 s on, two seconds are there, and the law drives in one of them.
#[test]
fn the_facts_of_a_part_are_those_of_the_part() {
    let mut run = run();
    run.events.retain(|event| event.at >= crate::synthetic::at(1.0));
    let (_, facts) = figure(recorded(&run)).unwrap();
    assert!((facts.duration_s - 2.0).abs() < 1e-9);
    assert!((facts.feedback_share - 0.5).abs() < 1e-9);
}

#[test]
fn everything_is_drawn_and_nothing_else_is_needed() {
    let (text, _) = figure(recorded(&run())).unwrap();
    for drawn in [
        "three-seconds",
        "class=\"way\"",
        "class=\"law\"",
        "class=\"task\"",
        "class=\"thing\"",
        "class=\"body\"",
        "class=\"band\"",
        "danger shown to the person",
        "forward speed v",
        "turn rate",
        "Dc(b1): dangerous below",
        "Dc(b2): safe above",
        "Lyapunov function",
        "clearance of the footprint",
        "prefers-color-scheme: dark",
    ] {
        assert!(text.contains(drawn), "{drawn}");
    }
    // Distances of the law are not known in this run.
    assert!(!text.contains("distances of the law"));
    for outside in ["href", "url(", "@import", "<script", "<image"] {
        assert!(!text.contains(outside), "{outside}");
    }
    for unknown in ["NaN", "inf"] {
        assert!(!text.contains(unknown), "{unknown}");
    }
    assert_eq!(text, figure(recorded(&run())).unwrap().0, "the same run makes the same picture");
}

/// Dc(0.5 m/s, 1 m) = 0.5/1.5 = 1/3 m; Dc(0.5, 1.3) = 1.69·0.5/1.65 = 0.5121 m.
#[test]
fn the_thresholds_are_the_critical_distances() {
    let recording = recorded(&run()).finished().unwrap();
    let point = recording.points[5];
    assert!((point.critical1_m - 1.0 / 3.0).abs() < 1e-12);
    assert!((point.critical2_m - 0.845 / 1.65).abs() < 1e-12);
    assert_eq!((point.v_h_mps, point.v_s_mps), (0.5, 0.5));
}

#[test]
fn names_do_not_become_markup() {
    let mut run = run();
    run.header.run.scenario = "</text><script>alert(1)</script>\"".to_owned();
    let (text, _) = figure(recorded(&run)).unwrap();
    assert!(text.contains("&lt;script&gt;") && !text.contains("<script"));
}

#[test]
fn a_run_without_steps_is_refused() {
    let mut run = Run::new();
    run.truth(0.0, |_| {});
    assert!(matches!(figure(recorded(&run)), Err(CompareError::NoSteps { .. })));
}

#[test]
fn what_is_not_a_number_is_left_out() {
    let mut run = Run::new();
    for i in 0..3 {
        run.step(f64::from(i) * 0.1, |step| {
            step.pose = Pose { x_m: f64::NAN, y_m: f64::INFINITY, theta_rad: 0.0 };
            step.v_h_mps = f64::NEG_INFINITY;
            step.omega_h_radps = f64::NAN;
            step.k = f64::NAN;
            step.distance_effective_m = f64::INFINITY;
        });
    }
    let (text, facts) = figure(recorded(&run)).unwrap();
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    assert_eq!(facts.feedback_s.len(), 0);
}

/// An hour at 10 Hz makes no larger a picture than what can be seen of it.
#[test]
fn long_runs_are_thinned() {
    let mut run = Run::new();
    let mut recording = Recording::new(&run.header);
    for i in 0..36_000 {
        let t_s = f64::from(i) * 0.1;
        run.events.clear();
        run.step(t_s, |step| {
            step.pose.x_m = 2.0 + libm::sin(t_s);
            step.danger = 0.5 + 0.5 * libm::sin(7.0 * t_s);
            step.k = f64::from(i % 100 < 50);
        });
        run.command(t_s, 0.5 * libm::sin(t_s), libm::cos(t_s));
        run.events.iter().for_each(|event| recording.observe(event));
    }
    let (text, facts) = figure(recording).unwrap();
    assert!((facts.duration_s - 3600.0).abs() < 1e-6);
    assert!(text.len() < 600_000, "{}", text.len());
    assert_eq!(facts.feedback_s.len(), 360);
}
