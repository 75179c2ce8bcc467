//! Who drives, how often that changes, and who waits.

use super::close;
use crate::synthetic::{Run, scenario};

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
