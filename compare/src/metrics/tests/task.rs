//! Following the task, and reaching its end.

use schemas::Pose;

use super::close;
use crate::synthetic::{Run, block, scenario, task};

/// Positions every 0.1 s, under the task from (1, 1) to (3, 1).
fn driven(positions_m: &[[f64; 2]]) -> Run {
    let mut scenario = scenario();
    scenario.task = Some(task());
    let mut run = Run::of(scenario);
    for (i, [x_m, y_m]) in positions_m.iter().copied().enumerate() {
        run.truth(i as f64 * 0.1, |truth| truth.pose = Pose { x_m, y_m, theta_rad: 0.0 });
    }
    run.step(0.0, |_| {});
    run
}

#[test]
fn tracking_is_the_rms_distance_to_the_targets_path() {
    // 0.3 m beside it, 0.4 m before its start: √((0.09 + 0.16)/2). The last sample stands no time.
    let run = driven(&[[2.0, 1.3], [0.6, 1.0], [3.0, 1.0]]);
    close(run.metric("tracking_rms_m"), 0.125f64.sqrt());
    // Beyond the end: 3-4-5 from (3, 1).
    close(driven(&[[3.3, 1.4], [3.0, 1.0]]).metric("tracking_rms_m"), 0.5);
}

#[test]
fn a_target_at_rest_is_tracked_as_a_point() {
    let mut scenario = scenario();
    scenario.task = Some(schemas::Task { velocity_mps: [0.0, 0.0], ..task() });
    let mut run = Run::of(scenario);
    run.truth(0.0, |_| {}).truth(0.1, |_| {}).step(0.0, |_| {});
    // From (2, 1) to (1, 1).
    close(run.metric("tracking_rms_m"), 1.0);
}

#[test]
fn the_goal_is_reached_within_a_fifth_of_a_metre() {
    let run = driven(&[[1.0, 1.0], [2.79, 1.0], [2.81, 1.0], [3.0, 1.0]]);
    close(run.metric("goal_time_s"), 0.2);
    close(run.metric("goal_reached"), 1.0);
    let never = driven(&[[1.0, 1.0], [2.0, 1.0]]);
    close(never.metric("goal_reached"), 0.0);
    assert_eq!(never.metric("goal_time_s"), None);
}

#[test]
fn a_goal_inside_an_obstacle_cannot_be_missed() {
    let mut scenario = scenario();
    scenario.task = Some(task());
    scenario.world.obstacles = vec![block(3.1, 1.0)];
    let mut run = Run::of(scenario);
    run.truth(0.0, |_| {}).step(0.0, |_| {});
    assert_eq!(run.metric("goal_reached"), None);
    assert_eq!(run.metric("goal_time_s"), None);
}

#[test]
fn path_efficiency_is_progress_per_metre_driven() {
    // From (1, 1) over (1, 2) to (2, 2): 2 m driven; 2 m from the goal before, √2 after.
    let run = driven(&[[1.0, 1.0], [1.0, 2.0], [2.0, 2.0]]);
    close(run.metric("path_efficiency"), (2.0 - 2.0f64.sqrt()) / 2.0);
    close(driven(&[[1.0, 1.0], [3.0, 1.0]]).metric("path_efficiency"), 1.0);
    close(driven(&[[2.0, 1.0], [1.0, 1.0]]).metric("path_efficiency"), -1.0);
    // Standing still is not inefficient.
    assert_eq!(driven(&[[1.0, 1.0], [1.01, 1.0]]).metric("path_efficiency"), None);
}

#[test]
fn without_a_task_the_task_metrics_are_undefined() {
    let run = Run::clearances(&[1.0, 1.0]);
    for name in ["tracking_rms_m", "goal_reached", "goal_time_s", "path_efficiency"] {
        assert_eq!(run.metric(name), None, "{name}");
    }
}
