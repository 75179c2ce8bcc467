//! Every metric against a case computed by hand.
//!
//! Steps and motions come every 0.1 s unless a test says otherwise; limits are 0.7 m/s, 2 rad/s.

mod borders;
mod edges;
mod ride;
mod warrant;

use schemas::{Disc, Pose};

use super::{Basis, CATALOGUE, Meter, ViolationKind, metric};
use crate::CompareError;
use crate::synthetic::{Run, block, scenario, task};

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

#[test]
fn min_clearance_is_the_least_over_the_run() {
    close(Run::clearances(&[0.5, 0.2, 0.3]).metric("min_clearance_m"), 0.2);
    close(Run::clearances(&[0.5, -0.1, f64::NAN]).metric("min_clearance_m"), -0.1);
    // Nothing to keep clear of, or nothing known.
    assert_eq!(Run::clearances(&[f64::INFINITY]).metric("min_clearance_m"), None);
    assert_eq!(Run::clearances(&[f64::NAN]).metric("min_clearance_m"), None);
}

#[test]
fn near_miss_is_the_time_below_a_tenth_of_a_metre_and_clear() {
    // Each sample stands 0.1 s, the last one no time: 0.05 counts, 0.1 and 0 do not.
    close(Run::clearances(&[0.05, 0.1, 0.0, -0.1, 0.09, 0.05]).metric("near_miss_s"), 0.2);
    close(Run::clearances(&[1.0, 1.0]).metric("near_miss_s"), 0.0);
    assert_eq!(Run::clearances(&[f64::NAN, f64::NAN]).metric("near_miss_s"), None);
}

#[test]
fn a_hole_in_the_record_is_not_filled() {
    // 0.05 m at 0 s, next known at 10 s: at most 0.5 s of it is a near miss.
    let mut run = Run::new();
    run.truth(0.0, |truth| truth.clearance_m = 0.05).truth(10.0, |_| {}).step(10.0, |_| {});
    close(run.metric("near_miss_s"), 0.5);
}

#[test]
fn collisions_are_maximal_intervals_of_contact() {
    // Contact at 0.1..0.2 and at 0.5; touching (d = 0) is contact; NaN neither ends nor starts one.
    let run = Run::clearances(&[0.1, 0.0, -0.1, f64::NAN, 0.2, -0.05, 0.3]);
    close(run.metric("collisions"), 2.0);
    let run = Run::clearances(&[-0.1, f64::NAN, -0.1]);
    close(run.metric("collisions"), 1.0);
    close(Run::clearances(&[0.1]).metric("collisions"), 0.0);
    assert_eq!(Run::clearances(&[f64::NAN]).metric("collisions"), None);
}

#[test]
fn contact_speed_is_that_of_the_fastest_first_touch() {
    let mut run = Run::new();
    // Touches backwards at 0.3 m/s, gets faster while in contact, then touches again at 0.1 m/s.
    for (i, (clearance_m, v_mps)) in
        [(0.1, -0.4), (0.0, -0.3), (-0.1, -0.6), (0.1, 0.0), (-0.1, 0.1)].into_iter().enumerate()
    {
        run.truth(i as f64 * 0.1, |truth| {
            truth.clearance_m = clearance_m;
            truth.v_mps = v_mps;
        });
    }
    run.step(0.0, |_| {});
    close(run.metric("contact_speed_mps"), 0.3);
    assert_eq!(Run::clearances(&[1.0]).metric("contact_speed_mps"), None);
}

#[test]
fn every_leaving_of_the_static_admissible_set_is_counted_and_listed() {
    // Outside at 0.1..0.2, back on the edge at 0.3, outside again at 0.4 until the end.
    let run = Run::clearances(&[0.1, -0.01, -0.03, 0.0, -0.02, -0.02]);
    close(run.metric("invariance_breaches"), 2.0);
    let violations = run.measured().violations;
    assert_eq!(violations.len(), 2);
    let [first, second] = [violations[0], violations[1]];
    assert_eq!(first.kind, ViolationKind::LeftAdmissibleSet);
    close(Some(first.t_s), 0.1);
    close(Some(first.until_s), 0.2);
    close(Some(first.depth_m), 0.03);
    close(Some(first.speed_mps), 0.5);
    close(Some(second.t_s), 0.4);
    close(Some(second.until_s), 0.5);
    // Rounding is not leaving.
    assert!(Run::clearances(&[-1e-12]).measured().violations.is_empty());
    assert_eq!(Run::clearances(&[f64::NAN]).metric("invariance_breaches"), None);
}

#[test]
fn the_first_and_the_worst_leaving_are_told() {
    let run = Run::clearances(&[0.1, -0.01, -0.03, 0.0, -0.02]);
    close(run.metric("invariance_first_s"), 0.1);
    close(run.metric("invariance_worst_m"), 0.03);
    let never = Run::clearances(&[0.1, 0.0]);
    assert_eq!(never.metric("invariance_first_s"), None);
    close(never.metric("invariance_worst_m"), 0.0);
    assert_eq!(Run::clearances(&[f64::NAN]).metric("invariance_worst_m"), None);
}

#[test]
fn the_barrier_condition_allows_half_of_the_clearance_in_a_tenth_of_a_second() {
    // 0.4 → 0.2 is allowed, → 0.09 is not, → 0.04 neither (the same interval), → 0.03 is; then
    // outside, where the way back is not asked for; then 0.2 → 0.05 is another breach.
    let run = Run::clearances(&[0.4, 0.2, 0.09, 0.04, 0.03, -0.1, -0.2, 0.2, 0.05]);
    // 0.03 → −0.1 is a breach of its own.
    close(run.metric("barrier_breaches"), 3.0);
    // Twice as far apart: a quarter must be left.
    let mut slow = Run::new();
    for (t_s, h) in [(0.0, 0.4), (0.2, 0.1), (0.4, 0.024)] {
        slow.truth(t_s, |truth| truth.clearance_static_m = h);
    }
    slow.step(0.0, |_| {});
    close(slow.metric("barrier_breaches"), 1.0);
    assert_eq!(Run::clearances(&[0.4]).metric("barrier_breaches"), None);
}

/// A disc of 0.2 m radius touches the front edge of a body of 0.5 m at the origin when its centre
/// is 0.45 m ahead.
#[test]
fn contact_with_a_disc_is_active_only_when_the_robot_moves_towards_it() {
    let contact = |v_mps: f64, centre_m: [f64; 2]| {
        let mut run = Run::new();
        for (t_s, touching) in [(0.0, false), (0.1, true), (0.2, false)] {
            run.truth(t_s, |truth| {
                truth.pose = Pose::default();
                truth.v_mps = v_mps;
                truth.clearance_m = if touching { -0.05 } else { 0.1 };
                truth.clearance_static_m = 1.0;
                let centre_m = if touching { centre_m } else { [5.0, 5.0] };
                truth.discs = vec![Disc { centre_m, radius_m: 0.2 }];
            });
        }
        run.step(0.0, |_| {});
        let violations = run.measured().violations;
        assert_eq!(violations.len(), 1);
        assert_eq!((violations[0].t_s * 1e3).round(), 100.0);
        close(Some(violations[0].depth_m), 0.05);
        // The static set was not left.
        close(run.metric("invariance_breaches"), 0.0);
        close(run.metric("collisions"), 1.0);
        violations[0].kind
    };
    let ahead = [0.4, 0.0];
    assert_eq!(contact(0.3, ahead), ViolationKind::CollisionDiscActive);
    assert_eq!(contact(0.0, ahead), ViolationKind::CollisionDiscPassive);
    assert_eq!(contact(-0.3, ahead), ViolationKind::CollisionDiscPassive);
    // From the side the forward speed has no component towards the disc.
    assert_eq!(contact(0.3, [0.0, 0.4]), ViolationKind::CollisionDiscPassive);
    assert_eq!(contact(-0.3, [-0.4, 0.0]), ViolationKind::CollisionDiscActive);
}

#[test]
fn a_wall_and_a_disc_at_once_are_two_violations() {
    let mut run = Run::new();
    run.truth(0.0, |truth| {
        truth.pose = Pose::default();
        truth.clearance_m = -0.1;
        truth.clearance_static_m = -0.1;
        truth.discs = vec![Disc { centre_m: [0.4, 0.0], radius_m: 0.2 }];
    });
    run.step(0.0, |_| {});
    let kinds: Vec<_> = run.measured().violations.iter().map(|v| v.kind).collect();
    assert_eq!(kinds, [ViolationKind::LeftAdmissibleSet, ViolationKind::CollisionDiscActive]);
}

#[test]
fn human_share_is_the_mean_of_k() {
    let human = [0.5, 0.0];
    let run = Run::decisions(&[(1.0, human), (0.0, human), (0.0, human), (1.0, human)]);
    close(run.metric("human_share"), 0.5);
    assert_eq!(run.measured().metrics.engaged_steps, 2);
    // A step of unknown k counts neither way.
    let run = Run::decisions(&[(1.0, human), (f64::NAN, human)]);
    close(run.metric("human_share"), 1.0);
    assert_eq!(Run::decisions(&[(f64::NAN, human)]).metric("human_share"), None);
}

#[test]
fn overrides_integrate_the_distance_between_command_and_request() {
    // The request is (0.5, 0). |v| apart .2 then .1 for 0.1 s each; |ω| apart 0 then 1.
    let run = Run::decisions(&[(0.0, [0.3, 0.0]), (0.0, [0.6, -1.0]), (1.0, [0.5, 0.0])]);
    close(run.metric("override_m"), 0.03);
    close(run.metric("override_rad"), 0.1);
    // ‖S(·)‖: .2/.7, hypot(.1/.7, 1/2), 0.
    let want = (0.2 / 0.7 + (1.0f64 / 49.0 + 0.25).sqrt()) / 3.0;
    close(run.metric("disagreement"), want);
}

#[test]
fn a_request_beyond_the_plants_limits_is_not_an_override() {
    let mut run = Run::new();
    run.step(0.0, |step| {
        step.v_h_mps = 2.0;
        step.omega_h_radps = -9.0;
    });
    run.command(0.0, 0.7, -2.0);
    close(run.metric("override_m"), 0.0);
    close(run.metric("override_rad"), 0.0);
    close(run.metric("interventions_per_min"), 0.0);
}

#[test]
fn what_nobody_asked_for_or_nobody_commanded_is_undefined() {
    let mut silent = Run::new();
    silent.step(0.0, |step| step.v_h_mps = f64::NAN).command(0.0, 0.0, 0.0);
    let mut uncommanded = Run::new();
    uncommanded.step(0.0, |_| {}).command(0.05, 0.5, 0.0);
    for run in [silent, uncommanded] {
        for name in ["override_m", "disagreement", "interventions_per_min"] {
            assert_eq!(run.metric(name), None, "{name}");
        }
        close(run.metric("human_share"), 1.0);
    }
}

#[test]
fn interventions_are_rising_edges_merged_over_short_pauses() {
    // ‖S(u_s − u_h)‖ is .1/.7 = 0.14 or 0. Pauses: 0.2 s (merged), then 0.3 s (a new one).
    let (on, off) = ((0.0, [0.4, 0.0]), (1.0, [0.5, 0.0]));
    let run = Run::decisions(&[off, on, off, off, on, off, off, off, on, off]);
    // Two in 1.0 s are 120 a minute.
    close(run.metric("interventions_per_min"), 120.0);
    // A deviation of .03/.7 = 0.043 is below the threshold of 0.05.
    close(Run::decisions(&[(0.0, [0.47, 0.0])]).metric("interventions_per_min"), 0.0);
    // Intervening from the first step on is one intervention.
    close(Run::decisions(&[on, on]).metric("interventions_per_min"), 300.0);
}

#[test]
fn durations_of_interventions_are_those_of_the_merged_ones() {
    let (on, off) = ((0.0, [0.4, 0.0]), (1.0, [0.5, 0.0]));
    // 0.1..0.5 (a pause of 0.2 s bridged), then 0.9..1.0, then 1.3..1.6.
    let run = Run::decisions(&[
        off, on, off, off, on, off, off, off, off, on, off, off, off, on, on, on, off,
    ]);
    close(run.metric("intervention_p50_s"), 0.3);
    close(run.metric("intervention_p95_s"), 0.4);
    assert_eq!(Run::decisions(&[off]).metric("intervention_p50_s"), None);
    // One that lasts to the end has the length that it reached.
    close(Run::decisions(&[off, on, on]).metric("intervention_p95_s"), 0.2);
}

#[test]
fn the_persons_own_input_is_no_intervention() {
    // A dynamic law takes time to reach the requested speed, whoever drives.
    let mut run = Run::new();
    for (i, u_s) in [[2.0, 0.0], [1.5, 0.0]].into_iter().enumerate() {
        let t_s = i as f64 * 0.1;
        run.step(t_s, |step| {
            step.u_h = [2.0, 0.0];
            step.u_s = u_s;
        });
        run.command(t_s, 0.1, 0.0);
    }
    // Only the second is altered: one intervention in 0.2 s.
    close(run.metric("interventions_per_min"), 300.0);
    close(run.metric("intervention_p50_s"), 0.1);
    // The speeds are apart in both.
    close(run.metric("override_m"), 0.08);
}

#[test]
fn every_change_of_k_is_a_switch() {
    let human = [0.5, 0.0];
    let run = Run::decisions(&[1.0, 0.0, 0.0, f64::NAN, 1.0, 1.0, 0.0].map(|k| (k, human)));
    // Three in the 0.6 s in which k is known.
    close(run.metric("switches_per_min"), 300.0);
    close(Run::decisions(&[(0.0, human)]).metric("switches_per_min"), 0.0);
}

#[test]
fn the_cosine_compares_directions() {
    // Same way; stopped; opposite; at an angle: (.35, 1) against (.5, 0) is, in shares of full
    // speed, (.5, .5) against (.714, 0): cos 45°. Nobody asks in the last step.
    let mut run = Run::decisions(&[
        (0.0, [0.1, 0.0]),
        (0.0, [0.0, 0.0]),
        (0.0, [-0.2, 0.0]),
        (0.0, [0.35, 1.0]),
    ]);
    run.step(0.4, |step| step.v_h_mps = 0.01).command(0.4, 0.5, 0.0);
    close(run.metric("cosine"), (1.0 + 0.0 - 1.0 + 0.5f64.sqrt()) / 4.0);
    let mut idle = Run::new();
    idle.step(0.0, |step| step.v_h_mps = 0.0).command(0.0, 0.5, 0.0);
    assert_eq!(idle.metric("cosine"), None);
}

#[test]
fn chatter_counts_switches_that_undo_the_one_before() {
    let human = [0.5, 0.0];
    let ks = |ks: &[f64]| {
        Run::decisions(&ks.iter().map(|k| (*k, human)).collect::<Vec<_>>())
            .metric("chatter_per_min")
    };
    // Switches at .1 and .2: the second undoes the first. 1 in 0.4 s are 150 a minute.
    close(ks(&[1.0, 0.0, 1.0, 1.0]), 150.0);
    // 0.5 s apart still counts, 0.6 s does not.
    close(ks(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0]), 75.0);
    close(ks(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]), 0.0);
}

/// (requested v, actual v, actual ω), every 0.1 s.
fn asked(steps: &[(f64, f64, f64)]) -> Run {
    let mut run = Run::new();
    for (i, (v_h, v, omega)) in steps.iter().copied().enumerate() {
        run.step(i as f64 * 0.1, |step| {
            step.v_h_mps = v_h;
            step.v_mps = v;
            step.omega_radps = omega;
        });
    }
    run
}

#[test]
fn deadlock_is_asking_for_motion_and_getting_none() {
    // Has not had the time to move; stuck; creeping at 0.014/.7 = 0.02 is still stuck; turning at
    // 0.1/2 = 0.05 moves; nobody asks (0.03/.7 = 0.043); asks anew; stuck; moves.
    let run = asked(&[
        (0.5, 0.0, 0.0),
        (0.5, 0.0, 0.0),
        (-0.5, 0.013_999, 0.0),
        (0.5, 0.0, 0.1),
        (0.03, 0.0, 0.0),
        (0.5, 0.0, 0.0),
        (0.5, 0.0, 0.0),
        (0.5, 0.5, 0.0),
    ]);
    close(run.metric("deadlock_s"), 0.3);
    assert_eq!(Run::new().step(0.0, |s| s.v_h_mps = f64::NAN).metric("deadlock_s"), None);
}

#[test]
fn a_robot_that_has_only_just_been_asked_is_not_stuck() {
    close(asked(&[(0.5, 0.0, 0.0)]).metric("deadlock_s"), 0.0);
    // Actuators that take 0.1 s answer one step later.
    let stuck = [(0.5, 0.0, 0.0); 4];
    close(asked(&stuck).metric("deadlock_s"), 0.3);
    let mut scenario = scenario();
    scenario.plant.actuator_delay_s = 0.1;
    let mut run = Run::of(scenario);
    run.events = asked(&stuck).events;
    close(run.metric("deadlock_s"), 0.2);
}

#[test]
fn deadlock_believes_the_truth_and_not_the_estimate() {
    let mut run = Run::new();
    run.truth(0.0, |truth| truth.v_mps = 0.0);
    run.step(0.0, |step| step.v_mps = 0.5).step(0.1, |step| step.v_mps = 0.5);
    close(run.metric("deadlock_s"), 0.1);
}

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
