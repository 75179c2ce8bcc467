//! Contract: `Runner::step` is total, and the rows of the bad-input policy (specification §10) that
//! are tested here give the command and the reason that they should.

use controller::{Law, Runner, Setup, Spec, versions};
use proptest::prelude::*;
use schemas::{
    Driver, EncoderSample, ExactPose, HalfPlane, ImuSample, JoystickSample, Plant, Pose, Reason,
    ReferenceSource, Region, Sample, Scenario, SensorSuite, SonarEcho, SonarScan, Span, Start,
    Step, Task, Time, World,
};

const START: Time = Time(1_000_000_000_000);
const VERSIONS: [&str; 2] = ["paper-kinematic", "tandem-kinematic"];

/// A room of 4 m × 4 m about the origin, a 0.5 m × 0.5 m robot in the middle.
fn scenario(task: Option<Task>) -> Scenario {
    let walls = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    Scenario {
        name: "test".to_owned(),
        summary: String::new(),
        duration_s: 10.0,
        sensors: SensorSuite::Exact,
        driver: Driver::Joystick,
        start: Start::default(),
        task,
        robot: schemas::Robot::default(),
        plant: Plant::default(),
        noise: schemas::Noise::default(),
        person: schemas::Person::default(),
        controller: schemas::Overrides::default(),
        world: World {
            room: walls.map(|normal| HalfPlane { normal, offset_m: 2.0 }).to_vec(),
            ..World::default()
        },
        explored: None,
    }
}

fn runner_for(version: &str, scenario: Scenario, sensors: SensorSuite) -> Runner {
    let spec = Spec::resolve(version, &[]).expect("a version of the list");
    Runner::new(&Setup { spec, scenario, sensors, start: START }).expect("defaults go together")
}

fn runner(version: &str) -> Runner {
    runner_for(version, scenario(None), SensorSuite::Exact)
}

fn at(t_s: f64) -> Time {
    START + Span::from_seconds(t_s)
}

fn exact(t_s: f64, x_m: f64, theta_rad: f64) -> Sample {
    let pose = Pose { x_m, y_m: 0.0, theta_rad };
    Sample::Exact(ExactPose { stamp: at(t_s), pose, v_mps: 0.0, omega_radps: 0.0 })
}

fn joystick(t_s: f64, v_mps: f64, omega_radps: f64) -> Sample {
    Sample::Joystick(JoystickSample { stamp: at(t_s), v_mps, omega_radps, dead_man: true })
}

fn step(runner: &mut Runner, t_s: f64, samples: &[Sample]) -> Step {
    for sample in samples {
        runner.observe(sample);
    }
    let outcome = runner.step(at(t_s));
    assert_eq!(outcome.command.stamp, at(t_s));
    assert_eq!([outcome.command.twist.v_mps, outcome.command.twist.omega_radps], outcome.step.u_s);
    outcome.step
}

#[test]
fn with_good_input_in_the_open_the_person_drives() {
    for version in VERSIONS {
        let step =
            step(&mut runner(version), 0.0, &[exact(0.0, 0.0, 0.0), joystick(0.0, 0.2, 0.1)]);
        assert_eq!((step.k, step.reason, step.region), (1.0, Reason::Human, Region::Safe));
        assert_eq!(step.u_s, [0.2, 0.1]);
        assert_eq!(step.u_h, [0.2, 0.1]);
        // Everything is in the step, though the law does not drive.
        for value in
            [step.z1, step.z2, step.theta_star_rad, step.lyapunov, step.u_f[0], step.danger]
        {
            assert!(value.is_finite(), "{step:?}");
        }
    }
}

#[test]
fn a_joystick_that_is_not_a_number_asks_for_nothing() {
    for version in VERSIONS {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for sample in [joystick(0.1, bad, 0.0), joystick(0.1, 0.2, bad)] {
                let mut runner = runner(version);
                step(&mut runner, 0.0, &[exact(0.0, 0.0, 0.0), joystick(0.0, 0.2, 0.0)]);
                let step = step(&mut runner, 0.1, &[exact(0.1, 0.0, 0.0), sample]);
                assert_eq!((step.k, step.reason), (0.0, Reason::JoystickInvalid));
                assert_eq!(step.u_h, [0.0; 2]);
                assert_eq!(step.reference_source, ReferenceSource::Hold);
                assert_eq!([step.delta1_m, step.delta2_m], [0.0; 2]);
            }
        }
    }
}

#[test]
fn a_silent_joystick_asks_for_nothing() {
    for version in VERSIONS {
        let mut runner = runner(version);
        let first = step(&mut runner, 0.0, &[exact(0.0, 0.0, 0.0), joystick(0.0, 0.2, 0.0)]);
        assert_eq!(first.reason, Reason::Human);
        let still = step(&mut runner, 0.2, &[exact(0.2, 0.0, 0.0)]);
        assert_eq!(still.reason, Reason::Human, "0.2 s is not yet silence");
        let silent = step(&mut runner, 0.21, &[exact(0.21, 0.0, 0.0)]);
        assert_eq!((silent.k, silent.reason), (0.0, Reason::JoystickSilent));
        assert_eq!(silent.u_h, [0.0; 2]);
        assert_eq!(silent.reference_source, ReferenceSource::Hold);
        // In the middle of a room there is nothing to do then.
        assert_eq!(silent.u_s, [0.0; 2]);
        // A stamp from the future is no life sign either.
        let ahead = step(&mut runner, 0.3, &[exact(0.3, 0.0, 0.0), joystick(99.0, 0.2, 0.0)]);
        assert_eq!(ahead.reason, Reason::JoystickSilent);
        let back = step(&mut runner, 0.4, &[exact(0.4, 0.0, 0.0), joystick(0.4, 0.2, 0.0)]);
        assert_eq!((back.k, back.reason), (1.0, Reason::Human));
    }
}

#[test]
fn silence_holds_the_target_of_a_task_too() {
    let task = Task { from_m: [0.0; 2], velocity_mps: [0.3, 0.0], until_s: 10.0 };
    for version in VERSIONS {
        let mut runner = runner_for(version, scenario(Some(task)), SensorSuite::Exact);
        let first = step(&mut runner, 1.0, &[exact(1.0, 0.0, 0.0), joystick(1.0, 0.2, 0.0)]);
        assert_eq!(first.reference_source, ReferenceSource::Task);
        assert_eq!([first.target_x_m, first.target_y_m], [0.3, 0.0]);
        let silent = step(&mut runner, 1.5, &[exact(1.5, 0.0, 0.0)]);
        assert_eq!(silent.reference_source, ReferenceSource::Hold);
        assert_eq!(silent.u_s, [0.0; 2]);
    }
}

#[test]
fn a_released_dead_man_button_stops() {
    for version in VERSIONS {
        let mut runner = runner(version);
        let released = Sample::Joystick(JoystickSample {
            stamp: at(0.0),
            v_mps: 0.3,
            omega_radps: 0.5,
            dead_man: false,
        });
        // Near a wall, where the feedback law alone would move.
        let step = step(&mut runner, 0.0, &[exact(0.0, 1.6, 0.3), released]);
        assert_eq!((step.k, step.u_s), (0.0, [0.0; 2]));
    }
}

#[test]
fn a_pose_that_is_not_a_number_stops() {
    for version in VERSIONS {
        for theta in [f64::NAN, f64::INFINITY] {
            let mut runner = runner(version);
            step(&mut runner, 0.0, &[exact(0.0, 0.0, 0.0), joystick(0.0, 0.2, 0.0)]);
            let step = step(&mut runner, 0.1, &[exact(0.1, 0.0, theta), joystick(0.1, 0.2, 0.0)]);
            assert_eq!((step.k, step.reason, step.u_s), (0.0, Reason::PoseInvalid, [0.0; 2]));
        }
    }
}

#[test]
fn stale_odometry_stops() {
    for version in VERSIONS {
        let mut runner = runner(version);
        let none = step(&mut runner, 0.0, &[joystick(0.0, 0.2, 0.0)]);
        assert_eq!((none.reason, none.u_s), (Reason::OdometryStale, [0.0; 2]));
        let fresh = step(&mut runner, 0.1, &[exact(0.1, 0.0, 0.0), joystick(0.1, 0.2, 0.0)]);
        assert_eq!(fresh.reason, Reason::Human);
        let stale = step(&mut runner, 0.31, &[joystick(0.31, 0.2, 0.0)]);
        assert_eq!((stale.k, stale.reason, stale.u_s), (0.0, Reason::OdometryStale, [0.0; 2]));
    }
}

#[test]
fn sonars_are_waited_for_and_missed() {
    for version in VERSIONS {
        let mut runner = runner_for(version, scenario(None), SensorSuite::Sonar);
        let wheels = |t_s: f64| {
            Sample::Encoders(EncoderSample { stamp: at(t_s), ..EncoderSample::default() })
        };
        let early = step(&mut runner, 0.1, &[wheels(0.1), joystick(0.1, 0.2, 0.0)]);
        assert_eq!((early.reason, early.u_s), (Reason::Starting, [0.0; 2]));
        let deaf = step(&mut runner, 0.5, &[wheels(0.5), joystick(0.5, 0.2, 0.0)]);
        assert_eq!((deaf.reason, deaf.u_s), (Reason::SensorsDead, [0.0; 2]));
        assert_eq!(deaf.sonars_unknown, Some(16));
        // One sonar that speaks is not enough to go anywhere: what it does not see is unknown.
        let echo = SonarEcho { id: 3, range_m: 2.0, echo: true, fired: at(0.6) };
        let scan = Sample::Sonar(SonarScan { stamp: at(0.6), echoes: vec![echo] });
        let one = step(&mut runner, 0.6, &[wheels(0.6), scan, joystick(0.6, 0.2, 0.0)]);
        assert_eq!((one.k, one.reason), (0.0, Reason::DistanceUnknown));
        assert_eq!(one.u_s[0], 0.0);
        assert!(one.distance_human_m.is_nan());
        assert_eq!(one.sonars_unknown, Some(15));
    }
}

/// What the safety layer sees stands in the step: 0.3 m before a wall a body that turns in a wider circle has
/// the wall in it by the difference; in the middle of the room, at rest, nothing is within reach.
#[test]
fn a_step_says_what_the_safety_layer_sees() {
    let body_m = schemas::Robot::default().footprint.circumscribed_radius_m();
    let near = [exact(0.0, 1.7, 0.0), joystick(0.0, 0.2, 0.0)];
    let swept = step(&mut runner("tandem-kinematic"), 0.0, &near);
    let clear_m = swept.safety_clear_m.expect("its body is swept");
    assert!((clear_m - (0.3 - body_m)).abs() < 1e-9, "{clear_m}");
    assert_eq!(swept.sonars_unknown, None, "there are none");
    let far = [exact(0.0, 0.0, 0.0), joystick(0.0, 0.2, 0.0)];
    let free = step(&mut runner("tandem-kinematic"), 0.0, &far);
    assert_eq!(free.safety_clear_m, Some(f64::INFINITY));
    let bare = step(&mut runner("paper-kinematic"), 0.0, &near);
    assert_eq!(bare.safety_clear_m, None, "there is no safety layer");
}

#[test]
fn contact_stops_forward_motion_and_allows_turning_and_leaving() {
    // The footprint's front reaches 0.25 m, so at x = 1.78 it is 3 cm beyond the wall ahead, and the
    // body's circle 13 cm.
    for version in VERSIONS {
        let mut runner = runner(version);
        let step_ = step(&mut runner, 0.0, &[exact(0.0, 1.78, 0.0), joystick(0.0, 0.2, 0.3)]);
        assert_eq!((step_.k, step_.region), (0.0, Region::Danger));
        assert_eq!(step_.reason, Reason::Contact);
        assert!(step_.distance_human_m < 0.0);
        assert_eq!(step_.u_s[0], 0.0);
        let back = step(&mut runner, 0.1, &[exact(0.1, 1.78, 0.0), joystick(0.1, -0.2, 0.0)]);
        assert_eq!((back.k, back.u_s), (1.0, [-0.2, 0.0]), "{version}: backing away is free");
    }
}

#[test]
fn before_the_safe_set_was_seen_the_law_drives() {
    let mut runner = runner("tandem-kinematic");
    // In the hysteresis set of v = 0.2: between Dc(b1 = 1) = 0.167 and Dc(b2 = 1.3) = 0.268 before
    // the front, which is 0.25 m ahead.
    let x_m = 2.0 - 0.25 - 0.21;
    let hysteresis = [exact(0.0, x_m, 0.0), joystick(0.0, 0.2, 0.0)];
    let first = step(&mut runner, 0.0, &hysteresis);
    assert_eq!((first.k, first.region), (0.0, Region::Hysteresis));
    assert_eq!(first.reason, Reason::NotYetSafe);
    let open = step(&mut runner, 0.1, &[exact(0.1, 0.0, 0.0), joystick(0.1, 0.2, 0.0)]);
    assert_eq!((open.k, open.reason), (1.0, Reason::Human));
    let kept = step(&mut runner, 0.2, &[exact(0.2, x_m, 0.0), joystick(0.2, 0.2, 0.0)]);
    assert_eq!((kept.k, kept.region), (1.0, Region::Hysteresis));
    let danger = step(&mut runner, 0.3, &[exact(0.3, x_m + 0.1, 0.0), joystick(0.3, 0.2, 0.0)]);
    assert_eq!((danger.k, danger.reason, danger.danger), (0.0, Reason::Danger, 1.0));
    let after = step(&mut runner, 0.4, &[exact(0.4, x_m, 0.0), joystick(0.4, 0.2, 0.0)]);
    assert_eq!((after.k, after.reason), (0.0, Reason::Hysteresis));
}

#[test]
fn control_is_granted_only_where_the_projection_would_not_alter_it() {
    // Driving along a wall 4 mm beside the body's circle: D along the heading is metres, the cone
    // of the safety layer meets the wall; the body itself does not.
    let circle_y_m = 2.0 - 0.25 * std::f64::consts::SQRT_2 - 0.004;
    // 1 cm beside it, turning away: D is metres again, and a rear corner would swing out.
    let body_y_m = 2.0 - 0.25 - 0.01;
    for (projection, y_m, asked, granted) in [
        ("cone", circle_y_m, [0.7, 0.0], false),
        ("circle", circle_y_m, [0.7, 0.0], true),
        ("rectangle", circle_y_m, [0.7, 0.0], true),
        ("circle", body_y_m, [0.2, 0.0], true),
        ("circle", body_y_m, [0.2, -0.5], false),
        ("both", body_y_m, [0.2, 0.0], true),
        ("both", body_y_m, [0.2, -0.5], false),
        ("rectangle", body_y_m, [0.2, -0.5], false),
    ] {
        let overrides = [("projection".to_owned(), projection.into())].into_iter().collect();
        let spec = Spec::resolve("tandem-kinematic", &[&overrides]).expect("a version");
        let setup =
            Setup { spec, scenario: scenario(None), sensors: SensorSuite::Exact, start: START };
        let mut runner = Runner::new(&setup).expect("defaults go together");
        let pose = Pose { x_m: -1.0, y_m, theta_rad: 0.0 };
        let exact = Sample::Exact(ExactPose { stamp: at(0.0), pose, v_mps: 0.0, omega_radps: 0.0 });
        let step = step(&mut runner, 0.0, &[exact, joystick(0.0, asked[0], asked[1])]);
        assert!(step.distance_human_m > 2.0);
        if granted {
            assert_eq!((step.k, step.u_s), (1.0, asked), "{projection} at {y_m}");
        } else {
            assert_eq!((step.k, step.reason), (0.0, Reason::WouldBeProjected), "{projection}");
            assert_eq!(step.region, Region::Danger);
        }
    }
}

#[test]
fn the_person_alone_always_has_control() {
    let mut runner = runner("human");
    let near = step(&mut runner, 0.0, &[exact(0.0, 1.7, 0.0), joystick(0.0, 5.0, 0.3)]);
    assert_eq!((near.k, near.reason, near.u_s), (1.0, Reason::Human, [0.7, 0.3]));
    assert_eq!(near.region, Region::Danger, "what the sets say is logged all the same");
    let silent = step(&mut runner, 1.0, &[exact(1.0, 1.7, 0.0)]);
    assert_eq!((silent.reason, silent.u_s), (Reason::JoystickSilent, [0.0; 2]));
}

/// The dynamic model's stop brakes as hard as it takes and may (specification §10).
#[test]
fn a_dynamic_law_stops_by_braking() {
    let moving = |t_s: f64, v_mps: f64, omega_radps: f64, theta_rad: f64| {
        let pose = Pose { x_m: 0.0, y_m: 0.0, theta_rad };
        Sample::Exact(ExactPose { stamp: at(t_s), pose, v_mps, omega_radps })
    };
    for version in ["paper-dynamic", "tandem-dynamic"] {
        let period_s = Spec::resolve(version, &[]).expect("it is listed").params.control_period_s;
        let mut runner = runner(version);
        for sample in [moving(0.0, 0.01, 0.6, 0.0), joystick(0.0, 0.5, 0.0)] {
            runner.observe(&sample);
        }
        let driving = runner.step(at(0.0));
        assert_eq!((driving.step.k, driving.step.reason), (1.0, Reason::Human));
        // 4 · (0.5 − 0.01) = 1.96 m/s², 4 · (0 − 0.6) = −2.4 rad/s².
        assert!((driving.step.u_s[0] - 1.96).abs() < 1e-12);
        assert!((driving.step.u_s[1] + 2.4).abs() < 1e-12);
        assert_eq!(driving.command.accel, Some(driving.step.u_s));
        assert!((driving.command.twist.v_mps - (0.01 + 1.96 * period_s)).abs() < 1e-12);
        for (t_s, exact, reason) in [
            (0.1, moving(0.1, 0.3, -0.01, f64::NAN), Reason::PoseInvalid),
            (1.0, moving(0.2, 0.3, -0.01, 0.0), Reason::OdometryStale),
        ] {
            runner.observe(&exact);
            runner.observe(&joystick(t_s, 0.5, 0.0));
            let stopped = runner.step(at(t_s)).step;
            assert_eq!((stopped.k, stopped.reason), (0.0, reason));
            let expected = [(-0.3 / period_s).max(-2.0), (0.01 / period_s).min(6.0)];
            assert_eq!(stopped.u_s, expected, "{version}");
        }
        runner.observe(&moving(1.1, f64::NAN, 0.1, 0.0));
        runner.observe(&joystick(1.1, 0.5, 0.0));
        let blind = runner.step(at(1.1)).step;
        assert_eq!((blind.k, blind.reason), (0.0, Reason::PoseInvalid));
        assert!(blind.u_s.iter().all(|u| u.is_finite()));
    }
}

/// Erratum 13: at rest at a wall the present speed alone would be safe for ever.
#[test]
fn the_dynamic_law_asks_about_present_and_requested_speed() {
    let x_m = 2.0 - 0.25 * std::f64::consts::SQRT_2 - 0.1;
    let near_wall = |v_mps: f64| {
        let pose = Pose { x_m, y_m: 0.0, theta_rad: 0.0 };
        Sample::Exact(ExactPose { stamp: at(0.0), pose, v_mps, omega_radps: 0.0 })
    };
    for (actual, requested, expected) in [
        (0.0, 0.0, Region::Safe),
        (0.0, 0.5, Region::Danger),
        (0.5, 0.0, Region::Danger),
        (0.0, -0.5, Region::Safe),
    ] {
        let mut runner = runner("tandem-dynamic");
        let step = step_of(&mut runner, 0.0, &[near_wall(actual), joystick(0.0, requested, 0.0)]);
        assert_eq!(step.region, expected, "{actual} {requested}");
    }
}

fn step_of(runner: &mut Runner, t_s: f64, samples: &[Sample]) -> Step {
    for sample in samples {
        runner.observe(sample);
    }
    runner.step(at(t_s)).step
}

#[test]
fn hashes_tell_inputs_and_states_apart() {
    let run = |v: f64| {
        let mut runner = runner("tandem-kinematic");
        step(&mut runner, 0.0, &[exact(0.0, 0.0, 0.0), joystick(0.0, v, 0.0)])
    };
    let (a, again, b) = (run(0.2), run(0.2), run(0.2 + 1e-16 * 4.0));
    assert_eq!((a.input_hash, a.state_hash), (again.input_hash, again.state_hash));
    assert_ne!(a.input_hash, b.input_hash);
    assert_ne!(a.state_hash, b.state_hash);
}

/// Any f64 at all, with the awkward ones made likely.
fn anything() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => -3.0..3.0f64,
        1 => any::<f64>(),
        1 => prop_oneof![
            Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(f64::MAX),
            Just(f64::MIN), Just(0.0), Just(-0.0), Just(1e300), Just(f64::MIN_POSITIVE),
        ],
    ]
}

/// Any instant, mostly within the session.
fn instant() -> impl Strategy<Value = Time> {
    prop_oneof![4 => (0.0..2.0f64).prop_map(at), 1 => any::<u64>().prop_map(Time)]
}

fn sample() -> impl Strategy<Value = Sample> {
    let triple = || [anything(), anything(), anything()];
    prop_oneof![
        (instant(), triple(), anything(), anything()).prop_map(
            |(stamp, [x, y, theta], v, omega)| {
                let pose = Pose { x_m: x, y_m: y, theta_rad: theta };
                Sample::Exact(ExactPose { stamp, pose, v_mps: v, omega_radps: omega })
            }
        ),
        (instant(), anything(), anything(), any::<bool>()).prop_map(
            |(stamp, v_mps, omega_radps, dead_man)| Sample::Joystick(JoystickSample {
                stamp,
                v_mps,
                omega_radps,
                dead_man,
            })
        ),
        (instant(), triple(), triple(), triple()).prop_map(|(stamp, accel, gyro, mag)| {
            Sample::Imu(ImuSample { stamp, accel_mps2: accel, gyro_radps: gyro, mag_ut: mag })
        }),
        (instant(), [anything(), anything(), anything(), anything()]).prop_map(
            |(stamp, [left_m, right_m, left_mps, right_mps])| Sample::Encoders(EncoderSample {
                stamp,
                left_m,
                right_m,
                left_mps,
                right_mps,
            })
        ),
        (
            instant(),
            prop::collection::vec((any::<u8>(), anything(), any::<bool>(), instant()), 0..20),
        )
            .prop_map(|(stamp, echoes)| {
                let echoes = echoes.into_iter().map(|(id, range_m, echo, fired)| SonarEcho {
                    id: id % 20,
                    range_m,
                    echo,
                    fired,
                });
                Sample::Sonar(SonarScan { stamp, echoes: echoes.collect() })
            }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Whatever comes, in whatever order: no panic, commands within the limits, k = 1 only with the
    /// person's own input, and the same bits from the same input.
    #[test]
    fn step_is_total(
        version in 0..versions().len(),
        sonar in any::<bool>(),
        task in any::<bool>(),
        batches in prop::collection::vec(
            (prop::collection::vec(sample(), 0..6), instant()), 1..20,
        ),
    ) {
        let version = versions()[version];
        let sensors = if sonar { SensorSuite::Sonar } else { SensorSuite::Exact };
        let task = task.then_some(Task {
            from_m: [0.0; 2], velocity_mps: [0.3, 0.2], until_s: 1.0,
        });
        let mut runner = runner_for(version.name, scenario(task), sensors);
        let mut twin = runner_for(version.name, scenario(task), sensors);
        for (samples, now) in batches {
            for sample in &samples {
                runner.observe(sample);
                twin.observe(sample);
            }
            let outcome = runner.step(now);
            // NaN differs from itself, so compare what is printed.
            prop_assert_eq!(format!("{outcome:?}"), format!("{:?}", twin.step(now)));
            let ([u1, u2], twist) = (outcome.step.u_s, outcome.command.twist);
            let most = if version.law == Law::Dynamic { [2.0, 6.0] } else { [0.7, 2.0] };
            prop_assert!(u1.abs() <= most[0] && u2.abs() <= most[1], "{:?}", outcome.step);
            prop_assert!(twist.v_mps.abs() <= 0.7 && twist.omega_radps.abs() <= 2.0);
            prop_assert_eq!(outcome.command.accel.is_some(), version.law == Law::Dynamic);
            prop_assert!(outcome.step.k == 0.0 || outcome.step.k == 1.0);
            prop_assert!((0.0..=1.0).contains(&outcome.step.danger));
            if outcome.step.k == 1.0 {
                prop_assert_eq!(
                    outcome.step.u_s.map(f64::to_bits), outcome.step.u_h.map(f64::to_bits)
                );
            }
            prop_assert!(outcome.step.reason != Reason::Unspecified);
            prop_assert!(version.law == Law::Human || outcome.step.k == 0.0
                || outcome.step.reason == Reason::Human);
        }
    }
}
