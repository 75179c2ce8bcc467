//! Comfort, heading, the law's promise, the person's effort, the computer's.

use super::super::{Measured, Meter, Profile, Track};
use super::close;
use crate::synthetic::{Run, at, scenario, task};
use schemas::{
    Event, JoystickSample, LawBranch, MovingDisc, ReferenceSource, Sample, SonarEcho, SonarScan,
    Stamped, Step, Timing,
};

/// Truths every 0.02 s with these speeds.
fn speeds(twists: impl Iterator<Item = (f64, f64)>) -> Run {
    let mut run = Run::new();
    for (i, (v_mps, omega_radps)) in twists.enumerate() {
        run.truth(i as f64 * 0.02, |truth| {
            truth.v_mps = v_mps;
            truth.omega_radps = omega_radps;
        });
    }
    run.step(0.0, |_| {});
    run
}

#[track_caller]
fn near(got: Option<f64>, want: f64, share: f64) {
    let got = got.expect("defined");
    assert!((got / want - 1.0).abs() < share, "{got} instead of {want}");
}

/// A step by V after T: y' = V t/τ² exp(−t/τ), so ∫ y'² = V²/(4τ) and ∫ y''² = V²/(4τ³).
#[test]
fn a_step_of_the_speed_has_the_rms_of_its_closed_form() {
    let (v, tau, total_s) = (0.5, 0.1f64, 4.0);
    let step = |i: u32| if i < 50 { (0.0, 0.0) } else { (v, 2.0 * v) };
    let run = speeds((0..=200).map(step));
    near(run.metric("accel_rms_mps2"), (v * v / (4.0 * tau) / total_s).sqrt(), 1e-3);
    near(run.metric("jerk_rms_mps3"), (v * v / (4.0 * tau.powi(3)) / total_s).sqrt(), 1e-2);
    near(
        run.metric("angular_jerk_rms_radps3"),
        (4.0 * v * v / (4.0 * tau.powi(3)) / total_s).sqrt(),
        1e-2,
    );
}

/// After a second of a ramp the filter follows it: y' is its slope, y'' is 0.
#[test]
fn a_ramp_has_its_slope_and_no_jerk() {
    let run = speeds((0..=3000).map(|i| (0.01 * 0.02 * f64::from(i), 0.0)));
    near(run.metric("accel_p95_mps2"), 0.01, 0.011);
    let jerk = run.metric("jerk_p95_mps3").expect("defined");
    // What is left is the staircase of the samples: 0.0002 m/s a step over τ².
    assert!(jerk < 0.02, "{jerk}");
    for name in ["accel_rms_mps2", "jerk_rms_mps3", "angular_jerk_p95_radps3"] {
        close(speeds((0..100).map(|_| (0.4, 1.0))).metric(name), 0.0);
    }
}

/// The absolute slope is 0.1 m/s² in one part of twenty-five and 0.01 in the rest: the 95th
/// percentile is in the rest, and beyond it with three parts.
#[test]
fn percentiles_are_over_time() {
    let with_fast = |parts: u32| {
        let mut v = 0.0;
        speeds((0..=25 * 250).map(move |i| {
            v += 0.02 * if i / 250 % 25 < parts { 0.1 } else { 0.01 };
            (v, 0.0)
        }))
        .metric("accel_p95_mps2")
    };
    near(with_fast(1), 0.01, 0.05);
    near(with_fast(3), 0.1, 0.05);
}

#[test]
fn sparc_needs_five_seconds_of_motion() {
    assert_eq!(speeds((0..200).map(|_| (0.5, 0.0))).metric("sparc"), None);
    assert_eq!(speeds((0..2000).map(|_| (0.0, 1.0))).metric("sparc"), None);
    let steady = speeds((0..2000).map(|_| (0.5, 0.0))).metric("sparc").expect("defined");
    let jerky = speeds((0..2000).map(|i| (if i / 25 % 2 == 0 { 0.7 } else { 0.3 }, 0.0)));
    assert!(jerky.metric("sparc").expect("defined") < steady);
}

#[test]
fn heading_is_measured_against_the_path_of_the_target() {
    let mut scenario = scenario();
    scenario.task = Some(task());
    let mut run = Run::of(scenario.clone());
    // The path points along +x: off by 0.3, by −0.4 a whole turn on; the last stands no time.
    for (t_s, theta_rad) in [(0.0, 0.3), (0.1, core::f64::consts::TAU - 0.4), (0.2, 3.0)] {
        run.truth(t_s, |truth| truth.pose.theta_rad = theta_rad);
    }
    run.step(0.0, |_| {});
    close(run.metric("heading_rms_rad"), 0.125f64.sqrt());
    scenario.task = Some(schemas::Task { velocity_mps: [0.0, 0.0], ..task() });
    let mut resting = Run::of(scenario);
    resting.truth(0.0, |_| {}).truth(0.1, |_| {}).step(0.0, |_| {});
    assert_eq!(resting.metric("heading_rms_rad"), None);
}

/// A path along (3, 4)/5 for 2 m: what is 0.3 m beside it is that far off, on either side, whichever part it is
/// beside; what is beyond an end is as far off as that end.
#[test]
fn a_slanted_path_is_a_path_like_any_other() {
    let mut scenario = scenario();
    scenario.task =
        Some(schemas::Task { velocity_mps: [0.3, 0.4], until_s: 4.0, from_m: [1.0, 0.5] });
    let at_path = |along_m: f64, aside_m: f64| {
        [1.0 + 0.6 * along_m - 0.8 * aside_m, 0.5 + 0.8 * along_m + 0.6 * aside_m]
    };
    let stands = |place_m: [f64; 2], theta_rad: f64| {
        let mut run = Run::of(scenario.clone());
        for t_s in [0.0, 0.1] {
            run.truth(t_s, |truth| {
                truth.pose = schemas::Pose { x_m: place_m[0], y_m: place_m[1], theta_rad };
            });
        }
        run.step(0.0, |_| {});
        run
    };
    for (along_m, aside_m, off_m) in
        [(0.0, 0.3, 0.3), (0.7, -0.3, 0.3), (1.9, 0.3, 0.3), (-0.4, 0.3, 0.5), (2.4, -0.3, 0.5)]
    {
        let run = stands(at_path(along_m, aside_m), 0.0);
        close(run.metric("tracking_rms_m"), off_m);
    }
    let along_rad = 0.8f64.atan2(0.6);
    close(stands(at_path(1.0, 0.0), along_rad - 0.2).metric("heading_rms_rad"), 0.2);
    close(
        stands(at_path(1.0, 0.0), along_rad + 6.0).metric("heading_rms_rad"),
        core::f64::consts::TAU - 6.0,
    );
}

/// Steps at 0.1 s with the feedback law driving on the left branch.
fn law(lyapunov: &[f64], change: impl Fn(usize, &mut Step)) -> Run {
    let mut run = Run::new();
    for (i, value) in lyapunov.iter().enumerate() {
        run.step(i as f64 * 0.1, |step| {
            step.k = 0.0;
            step.law_branch = LawBranch::Left;
            step.reference_source = ReferenceSource::Task;
            step.lyapunov = *value;
            step.psi_rad = 0.3;
            (step.target_vx_mps, step.target_vy_mps) = (0.1, 0.0);
            (step.d1_m, step.d2l_m, step.d2r_m) = (1.0, 1.0, 1.0);
            change(i, step);
        });
    }
    run
}

/// What it is, and how it changes a step.
type Change = (&'static str, fn(&mut Step));

#[test]
fn rises_of_the_lyapunov_function_are_counted_where_the_theorem_holds() {
    let values = [3.0, 2.0, 2.5, 2.500_000_5, 2.0, 2.1];
    let run = law(&values, |_, _| {});
    // +0.5 and +0.1; +5e-7 is rounding.
    close(run.metric("lyapunov_increases"), 2.0);
    close(run.metric("lyapunov_worst"), 0.5);
    // Each of these takes the steps to and from the third out of what is covered: +0.1 is left.
    let changes: [Change; 8] = [
        ("person drives", |step| step.k = 1.0),
        ("altered", |step| step.projected = true),
        ("saturated", |step| step.saturated = true),
        ("other side", |step| step.law_branch = LawBranch::Right),
        ("other frame", |step| step.psi_rad = 0.31),
        ("other target", |step| step.target_vx_mps = 0.0),
        ("ray past a corner", |step| step.d2l_m = 0.5),
        ("unknown", |step| step.lyapunov = f64::NAN),
    ];
    for (what, change) in changes {
        let run = law(&values, |i, step| {
            if i == 2 {
                change(step);
            }
        });
        assert_eq!(run.metric("lyapunov_increases"), Some(1.0), "{what}");
    }
    assert_eq!(law(&[3.0], |_, _| {}).metric("lyapunov_increases"), None);
    // Falling throughout.
    close(law(&[3.0, 2.0], |_, _| {}).metric("lyapunov_worst"), 0.0);
}

/// Within 0.1 s at 0.7 m/s a distance changes by 0.14 m at most, early and late in a run; of one instant twice
/// nothing is said; and a rise of just 1e-6 is rounding.
#[test]
fn what_cannot_be_driven_in_a_step_is_a_jump() {
    for (jump_m, rises) in [(0.13, 1.0), (0.15, 0.0), (0.2, 0.0)] {
        let mut values = [3.0; 12];
        values[11] = 4.0;
        let run = law(&values, |i, step| {
            if i == 11 {
                step.d2l_m += jump_m;
            }
        });
        close(run.metric("lyapunov_increases"), rises);
    }
    let mut twice = law(&[1.0], |_, _| {});
    twice.events.extend(law(&[2.0], |_, _| {}).events);
    assert_eq!(twice.metric("lyapunov_increases"), None);
    close(law(&[0.0, 1e-6], |_, _| {}).metric("lyapunov_increases"), 0.0);
    close(law(&[0.0, 1.1e-6], |_, _| {}).metric("lyapunov_increases"), 1.0);
}

/// A rise at 1.1 s and a hand that moves at 0.1 and 1.2 s are in the profile then.
#[test]
fn rises_and_the_hand_are_in_the_profile() {
    let mut values = [3.0; 20];
    values[11] = 4.0;
    let mut run = law(&values, |_, _| {});
    run.events.extend(
        joystick(&[(0.0, 0.0, 0.0), (0.1, 0.7, 0.0), (1.1, 0.7, 0.0), (1.2, -0.7, 0.0)])
            .events
            .into_iter()
            .filter(|event| matches!(event.value, Event::Sample(_))),
    );
    run.events.sort_by_key(|event| event.at);
    let measured = run.measured();
    for (name, want) in [
        ("lyapunov_increases", vec![0.0, 1.0]),
        ("operator_effort", vec![1.0, 2.0]),
        // 0.1, 0.2 at most, and 0.1 s watched.
        ("operator_reversals_per_min", vec![0.0, 150.0]),
    ] {
        let i = crate::metrics::CATALOGUE.iter().position(|row| row.name == name).expect(name);
        let got = measured.profile.contributions(i, 1.0);
        let same = got.iter().zip(&want).all(|(got, want)| (got - want).abs() < 1e-9);
        assert!(got.len() == want.len() && same, "{name}: {got:?}");
    }
}

#[test]
fn the_theorem_does_not_speak_of_moving_discs() {
    let mut scenario = scenario();
    scenario.world.discs = vec![MovingDisc {
        radius_m: 0.1,
        from_m: [0.5, 0.5],
        to_m: [1.0, 0.5],
        speed_mps: 0.1,
        start_s: 0.0,
        to_and_fro: true,
    }];
    let mut run = Run::of(scenario);
    run.events = law(&[1.0, 2.0], |_, _| {}).events;
    assert_eq!(run.metric("lyapunov_increases"), None);
}

/// Joystick samples: (time, v, ω).
fn joystick(samples: &[(f64, f64, f64)]) -> Run {
    let mut run = Run::new();
    run.step(0.0, |_| {});
    for (t_s, v_mps, omega_radps) in samples.iter().copied() {
        let stamp = at(t_s);
        let sample = JoystickSample { stamp, v_mps, omega_radps, dead_man: true };
        let value = Event::Sample(Sample::Joystick(sample));
        run.events.push(Stamped { at: stamp.after_ns(4), value });
    }
    run
}

#[test]
fn effort_is_the_way_of_the_hand() {
    // In shares of full speed: (0,0) → (1,0) → (1,.5) → (0,.5) after a silence of 0.3 s → clipped to
    // (1,.5).
    let run = joystick(&[
        (0.0, 0.0, 0.0),
        (0.1, 0.7, 0.0),
        (0.2, 0.7, 1.0),
        (0.5, 0.0, 1.0),
        (0.6, 3.0, 1.0),
    ]);
    close(run.metric("operator_effort"), 1.0 + 0.5 + 1.0);
    // Across what is not a number there is no way.
    let run = joystick(&[(0.0, 0.0, 0.0), (0.1, f64::NAN, 0.0), (0.2, 0.7, 0.0)]);
    close(run.metric("operator_effort"), 0.0);
    assert_eq!(joystick(&[]).metric("operator_effort"), None);
}

#[test]
fn reversals_are_changes_of_sign_beyond_a_twentieth() {
    // v: + (through 0, ignored) − ; ω: + (−0.09/2 is below the band) + − ; in 1 s.
    let run = joystick(&[
        (0.0, 0.5, 1.0),
        (0.2, 0.0, -0.09),
        (0.4, -0.5, 1.0),
        (0.6, -0.5, 1.0),
        (0.8, -0.5, -1.0),
        (1.0, -0.5, -1.0),
    ]);
    close(run.metric("operator_reversals_per_min"), 120.0);
}

/// The time is that of the samples, 0.1 s apart; a twentieth itself is within the band; the first sign is no
/// change of one.
#[test]
fn reversals_are_counted_over_the_time_of_the_samples() {
    let turns = [1.0, -1.0, 1.0, -0.1, 1.0, 1.0, -1.0, -1.0, -1.0, -1.0, -1.0];
    let samples: Vec<_> =
        turns.iter().enumerate().map(|(i, turn)| (i as f64 * 0.1, 0.0, *turn)).collect();
    // Three in one second.
    close(joystick(&samples).metric("operator_reversals_per_min"), 180.0);
}

#[test]
fn step_times_are_told_where_they_were_recorded() {
    let mut run = Run::new();
    run.step(0.0, |_| {});
    assert_eq!(run.metric("step_time_max_us"), None);
    for i in 1..=100u64 {
        let timing = Timing { stamp: at(0.0), step_index: i, step_cost_ns: i * 1000 };
        run.events.push(Stamped { at: at(0.0).after_ns(10 + i), value: Event::Timing(timing) });
    }
    close(run.metric("step_time_max_us"), 100.0);
    near(run.metric("step_time_p50_us"), 50.0, 0.0102);
    near(run.metric("step_time_p99_us"), 99.0, 0.0102);
}

/// What is kept of many runs holds the numbers, and no path.
#[test]
fn a_bare_measurement_has_the_numbers_alone() {
    let whole = speeds((0..2000).map(|i| (0.001 * f64::from(i % 300), 0.0))).measured();
    let (empty_profile, empty_track) = (Profile::new(), Track::new());
    assert!(whole.profile != empty_profile && whole.track != empty_track);
    let bare = whole.clone().bare();
    assert_eq!(bare, Measured { profile: empty_profile, track: empty_track, ..whole });
}

/// While the law drives, what the safety layer alters changes nothing about who drives; when nobody is asked
/// which echo it was that ended D, only the nearest one is known.
#[test]
fn a_switch_says_who_drives_and_which_echo_it_was() {
    let mut run = Run::new();
    for (t_s, k, projected) in [(0.1, 1.0, true), (0.2, 0.0, true), (0.3, 1.0, false)] {
        run.step(t_s, |step| (step.k, step.projected) = (k, projected));
    }
    let heard = [(3, 0.7, 0.05), (9, 0.4, 0.05), (4, 0.9, 0.15)];
    let echoes =
        heard.map(|(id, range_m, t_s)| SonarEcho { id, range_m, echo: true, fired: at(t_s) });
    let scan = Sample::Sonar(SonarScan { stamp: at(0.0), echoes: echoes.to_vec() });
    run.events.insert(0, Stamped { at: at(0.0), value: Event::Sample(scan) });
    let asked = [(0.2, at(0.15), 0.9), (0.3, at(0.05), 0.7)];
    let mut meter = Meter::new(&run.header);
    for event in &run.events {
        meter.observe(event);
        if let Event::Step(step) = &event.value
            && let Some((_, fired, range_m)) = asked.iter().find(|(t_s, ..)| at(*t_s) == step.stamp)
        {
            meter.ended_by(*fired, *range_m);
        }
    }
    let switches = meter.finish().expect("the run has steps").track.switches;
    assert_eq!(switches.iter().map(|s| s.projected).collect::<Vec<_>>(), [true, false, false]);
    let ended_by: Vec<_> = switches.iter().map(|switch| switch.ended_by).collect();
    assert_eq!(ended_by, [None, Some((4, 0.9)), Some((3, 0.7))]);
    assert!(switches.iter().all(|switch| switch.nearest_echo == Some((9, 0.4))));
}
