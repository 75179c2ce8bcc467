//! Contract: an explanation's numbers are those of the step; what is named as the cause of a number
//! gives that number again, bit for bit, at every step of every fixture.

use std::path::{Path, PathBuf};

use controller::wanted::capped_m;
use controller::{Law, Spec};
use replay::{Mode, Replay};
use schemas::{Event, Step};

use super::trace::Trace;
use super::{Instant, explain};
use crate::logs;

/// The recorded sessions of the repository.
fn fixtures() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let mut logs: Vec<PathBuf> = folder
        .read_dir()
        .expect("there are fixtures")
        .map(|entry| entry.expect("is readable").path().join("session.mcap"))
        .filter(|log| log.is_file())
        .collect();
    logs.sort();
    assert!(logs.len() >= 7, "{logs:?}");
    logs
}

fn same(a: f64, b: f64) -> bool {
    a == b || (a.is_nan() && b.is_nan())
}

/// Re-executes a session and hands every step with its trace to `check`; says how many there were.
fn each_step(log: &Path, mut check: impl FnMut(&Step, &Trace, &Spec)) -> usize {
    let header = logs::open(log).unwrap().header().clone();
    let spec = Spec::from_recorded(&header.run.controller, &header.params_toml).unwrap();
    let mut replay = Replay::new(|| logs::open_raw(log), &spec, Mode::Open).unwrap();
    let mut steps = 0;
    while let Some(event) = replay.next_event() {
        if let Event::Step(step) = event.value {
            let look = replay.runner().look().expect("has looked");
            let trace = Trace::new(&look, &step, &spec, &header.scenario);
            check(&step, &trace, &spec);
            steps += 1;
        }
    }
    steps
}

/// D is the ray that is named for it, and every distance of the law is its ray, capped.
#[test]
fn the_rays_that_are_named_give_the_distances() {
    for log in fixtures() {
        let steps = each_step(&log, |step, trace, spec| {
            let d_m = step.distance_human_m;
            let requested = same(trace.requested.free_m, d_m);
            let present = trace.present.is_some_and(|ray| same(ray.free_m, d_m));
            assert!(requested || present, "{} {}", log.display(), step.step_index);
            let law = [step.d1_m, step.d2l_m, step.d2r_m];
            for (ray, d_m) in trace.law.iter().zip(law) {
                let capped_m = capped_m(ray.free_m, spec.params.cap_m);
                assert!(same(capped_m, d_m), "{} {}", log.display(), step.step_index);
            }
            for ray in trace.law.iter().chain([&trace.requested]).chain(&trace.present) {
                if let Some(echo) = ray.echo {
                    assert_eq!(echo.free_m, ray.free_m);
                }
            }
        });
        assert!(steps > 50, "{}", log.display());
    }
}

/// What the safety layer is said to leave is what was applied; and whoever drives with k = 1 under
/// such a layer loses nothing to it.
#[test]
fn what_the_safety_layer_leaves_is_what_was_applied() {
    let mut layered = 0;
    for log in fixtures() {
        each_step(&log, |step, trace, spec| {
            let Some(chosen) = trace.chosen.filter(|_| spec.law != Law::Human) else { return };
            layered += 1;
            assert_eq!(chosen.u, step.u_s, "{} {}", log.display(), step.step_index);
            if step.k == 1.0 {
                assert_eq!(trace.human.map(|human| human.u), Some(step.u_h));
            }
        });
    }
    assert!(layered > 500, "{layered}");
}

/// At every fifth second of every fixture.
#[test]
fn the_numbers_are_those_of_the_step() {
    let mut compared = 0;
    for log in fixtures() {
        let mut reader = logs::open(&log).unwrap();
        let start = reader.header().run.start;
        while let Some(event) = reader.next_event().unwrap() {
            let Event::Step(step) = event.value else { continue };
            let t_s = step.stamp.seconds_since(start);
            if t_s % 5.0 != 3.0 {
                continue;
            }
            let told = explain(&log, Instant::Seconds(t_s)).unwrap();
            assert_eq!((told.t_s, told.step_index, told.k), (t_s, step.step_index, step.k));
            assert_eq!(told.reason, step.reason.name());
            assert_eq!(told.sets.region, step.region.name());
            assert!(same(told.sets.distance_m, step.distance_human_m));
            assert!(same(told.sets.effective_m, step.distance_effective_m));
            let (ahead, left, right) =
                (&told.distances.ahead, &told.distances.left, &told.distances.right);
            assert!(same(ahead.d_m, step.d1_m) && same(left.d_m, step.d2l_m));
            assert!(same(right.d_m, step.d2r_m) && ahead.wanted_m == Some(step.d_d1_m));
            let selected = if step.side > 0 { left } else { right };
            assert_eq!(selected.admissible_m, Some(step.d_r2_m));
            assert_eq!((told.request.u_h, told.request.u_s), (step.u_h, step.u_s));
            assert_eq!(told.request.v_h_mps, step.v_h_mps);
            assert_eq!(told.law.branch, step.law_branch.name());
            assert!(same(told.law.lyapunov, step.lyapunov));
            assert_eq!(told.safety.projected, step.projected);
            // Where the velocity asked about is the one that counts, its own numbers are the step's.
            let counts: Vec<_> = told.sets.asked.iter().filter(|asked| asked.counts).collect();
            assert!(!counts.is_empty() || told.untraced.is_some());
            for asked in counts {
                assert!(same(asked.distance_m.unwrap(), step.distance_human_m));
                assert!(same(asked.effective_m.unwrap(), step.distance_effective_m));
            }
            compared += 1;
        }
    }
    assert!(compared >= 15, "{compared}");
}
