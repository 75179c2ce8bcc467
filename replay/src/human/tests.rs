//! The contract of the ladder: on the recorded states every level does what was recorded; off them
//! the estimates steer for what the person steered for.

use super::*;
use crate::recording::{Moment, State};
use crate::session::{record, scenario};
use crate::{Mode, Replay};
use proptest::prelude::*;
use schemas::{Pose, SIMULATION_EPOCH, SensorSuite, wrap};
use simulator::{HumanView, JOYSTICK_PERIOD, Request};

fn levels() -> [Person; 4] {
    Person::ladder(Gains { k_theta: 1.3, delay_s: 0.26 })
}

fn view(index: u64, state: &State) -> HumanView {
    let stamp = SIMULATION_EPOCH.after_ns(index * JOYSTICK_PERIOD.0);
    HumanView {
        t_s: stamp.seconds_since(SIMULATION_EPOCH),
        stamp,
        index,
        pose: state.pose,
        v_mps: state.v_mps,
        omega_radps: state.omega_radps,
    }
}

/// Closed loop with the recording controller is the recording at every level: with both laws, exact
/// rays and sonars, tasks and free rides, people who react and people who do not.
#[test]
fn every_level_is_the_recording_under_the_recording_controller() {
    let sessions = [
        ("case1", "paper-kinematic", SensorSuite::Exact),
        ("case1-lab", "tandem-kinematic", SensorSuite::Sonar),
        ("case1-dynamic", "tandem-dynamic", SensorSuite::Exact),
        ("random:rect:goal:1", "human", SensorSuite::Sonar),
        ("random:disc:joystick:2", "paper-kinematic", SensorSuite::Exact),
        ("random:slant:hesitant:3", "tandem-kinematic", SensorSuite::Sonar),
        ("random:rect:flowing:4", "tandem-dynamic", SensorSuite::Exact),
        ("random:disc:explorer:5", "tandem-kinematic", SensorSuite::Exact),
        ("random:slant:tracker:6", "paper-dynamic", SensorSuite::Exact),
    ];
    for (name, controller, sensors) in sessions {
        let log = record(&scenario(name, 6.0), controller, sensors);
        let recording = Recording::read(log.open()).expect("has a joystick");
        assert!(!Reaction::of(&recording).is_blind(), "{name}: the estimates would be playback");
        for person in levels() {
            let mut replay =
                Replay::new(|| Ok(log.open()), &log.spec, Mode::Closed(person)).expect("replays");
            let mut count = 0;
            while replay.next_event().is_some() {
                count += 1;
            }
            let outcome = replay.finish().expect("has steps");
            let told = format!("{name} {controller} {}", person.name());
            assert!(outcome.identical_to_recorded, "{told}: {:?}", outcome.max_deviation);
            assert_eq!(count, log.events.len(), "{told}");
            assert_eq!(outcome.furthest, Some(0.0), "{told}");
            assert_eq!(outcome.horizon.and_then(|horizon| horizon.first_s()), None, "{told}");
        }
    }
}

/// With another controller the levels part from each other: none is another in disguise.
#[test]
fn levels_differ_once_the_robot_is_elsewhere() {
    let scenario = scenario("random:slant:tracker:6", 12.0);
    let log = record(&scenario, "human", SensorSuite::Exact);
    let spec = crate::session::spec("tandem-kinematic", &scenario);
    let hashes: Vec<String> = levels()
        .into_iter()
        .map(|person| {
            let mut replay =
                Replay::new(|| Ok(log.open()), &spec, Mode::Closed(person)).expect("replays");
            while replay.next_event().is_some() {}
            let outcome = replay.finish().expect("has steps");
            assert!(outcome.furthest.is_some_and(|furthest| furthest > 0.0));
            outcome.output_hash
        })
        .collect();
    for (i, hash) in hashes.iter().enumerate() {
        assert!(!hashes[..i].contains(hash), "level {i} is the same as one before it");
    }
}

/// A person most of whom waits in a file is the same at every level, and so is the horizon.
#[test]
fn a_person_in_a_file_is_the_same() {
    for (name, other) in
        [("random:slant:tracker:6", "tandem-kinematic"), ("random:rect:flowing:4", "paper-dynamic")]
    {
        let scenario = scenario(name, 12.0);
        let log = record(&scenario, "human", SensorSuite::Sonar);
        let spec = crate::session::spec(other, &scenario);
        let recordings = [
            Recording::read(log.open()).expect("has a joystick"),
            Recording::read_keeping(log.open(), 16).expect("has a joystick"),
        ]
        .map(Arc::new);
        assert_eq!(Reaction::of(&recordings[0]), Reaction::of(&recordings[1]));
        let [gains, of_file] =
            [0, 1].map(|which: usize| Gains::pooled(&[Arc::clone(&recordings[which])]));
        assert_eq!(gains, of_file);
        for person in Person::ladder(gains) {
            let [memory, file] = recordings.each_ref().map(|recording| {
                let mut replay: Replay<std::io::Cursor<Vec<u8>>> =
                    Replay::of_recording(recording, &spec, person).expect("replays");
                while replay.next_event().is_some() {}
                replay.finish().expect("has steps")
            });
            assert!(memory.furthest.is_some_and(|furthest| furthest > 0.0));
            assert_eq!(memory, file, "{name} {}", person.name());
        }
    }
}

fn number(strange: bool) -> BoxedStrategy<f64> {
    if strange {
        prop_oneof![
            8 => -2.0..2.0_f64,
            1 => Just(0.0),
            1 => Just(f64::NAN),
            1 => Just(f64::INFINITY),
        ]
        .boxed()
    } else {
        (-2.0..2.0_f64).boxed()
    }
}

fn a_moment() -> impl Strategy<Value = (Moment, State)> {
    let request = prop::option::weighted(
        0.9,
        (number(true), number(true), prop::bool::weighted(0.9))
            .prop_map(|(v_mps, omega_radps, dead_man)| Request { v_mps, omega_radps, dead_man }),
    );
    let state = (number(false), number(false), number(false), number(false), any::<bool>());
    (request, state).prop_map(|(request, (x_m, y_m, v_mps, omega_radps, still))| {
        // Some stand where they stood: the path level must tell time there.
        let pose = if still { Pose::default() } else { Pose { x_m, y_m, theta_rad: 3.0 * x_m } };
        let state = State { pose, v_mps, omega_radps };
        (Moment { request, state: Some(state) }, state)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever was recorded, on the recorded states the recorded joystick comes back bit for bit:
    /// not a number, hands off the button, and silence included.
    #[test]
    fn on_the_recorded_states_the_recorded_joystick_comes_back(
        moments in prop::collection::vec(a_moment(), 1..60),
        task in any::<bool>(),
    ) {
        let name = if task { "random:rect:goal:1" } else { "random:rect:joystick:1" };
        let scenario = scenario(name, 1.0);
        let (moments, states): (Vec<Moment>, Vec<State>) = moments.into_iter().unzip();
        let recording = Arc::new(Recording::for_test(scenario, moments.clone()));
        for person in levels() {
            let mut human = person.of_recording(&recording);
            for (index, (moment, state)) in moments.iter().zip(&states).enumerate() {
                let bits = |request: Option<Request>| {
                    request.map(|r| (r.v_mps.to_bits(), r.omega_radps.to_bits(), r.dead_man))
                };
                let asked = human.joystick(&view(index as u64, state));
                prop_assert_eq!(bits(asked), bits(moment.request), "{} at {}", person.name(), index);
            }
            // After the recording there is nobody.
            prop_assert_eq!(human.joystick(&view(moments.len() as u64, &states[0])), None);
        }
    }

    /// Off the recorded states every level asks for finite numbers within the plant's limits.
    #[test]
    fn off_the_recorded_states_requests_are_finite(
        moments in prop::collection::vec(a_moment(), 1..40),
        elsewhere in prop::collection::vec((number(true), number(true), number(true)), 40),
    ) {
        let scenario = scenario("random:rect:goal:1", 1.0);
        let moments: Vec<Moment> = moments
            .into_iter()
            .map(|(moment, _)| moment)
            .map(|mut moment| {
                // What is not a number is played back as it is.
                moment.request = moment.request.filter(|r| {
                    r.v_mps.is_finite() && r.omega_radps.is_finite()
                });
                moment
            })
            .collect();
        let recording = Arc::new(Recording::for_test(scenario, moments.clone()));
        for person in levels() {
            let mut human = person.of_recording(&recording);
            for (index, (x_m, y_m, theta_rad)) in elsewhere.iter().enumerate() {
                let pose = Pose { x_m: *x_m, y_m: *y_m, theta_rad: *theta_rad };
                let state = State { pose, v_mps: 0.1, omega_radps: 0.0 };
                if let Some(request) = human.joystick(&view(index as u64, &state)) {
                    prop_assert!(request.v_mps.is_finite() && request.omega_radps.is_finite());
                    prop_assert!(request.v_mps.abs() <= 2.0 && request.omega_radps.abs() <= 2.0);
                }
            }
        }
    }
}

/// A person of the family itself: drives to (2, 1), then to (-1, 2), by the law with known gains.
fn by_the_law(gains: &Gains) -> (Recording, Vec<[f64; 2]>) {
    let goals = [[2.0, 1.0], [-1.0, 2.0]];
    let habits =
        bearing::Habits { forward_mps: 0.4, backward_mps: 0.2, turn_radps: 1.2, slow_m: 0.6 };
    let mut pose = Pose::default();
    let mut seen = Vec::new();
    let mut moments = Vec::new();
    let mut truth = Vec::new();
    let dt_s = JOYSTICK_PERIOD.seconds();
    for tick in 0..600 {
        seen.push(pose);
        let goal = goals[usize::from(tick >= 300)];
        let back = goals::delay_ticks(gains.delay_s);
        let looked = seen[usize::saturating_sub(tick, back)];
        let [v_mps, omega_radps] =
            bearing::ask(gains, &habits, &bearing::Goal::At(goal), &looked, 0.0);
        moments.push(Moment {
            request: Some(Request { v_mps, omega_radps, dead_man: true }),
            state: Some(State { pose, v_mps, omega_radps }),
        });
        truth.push(goal);
        let (sin, cos) = libm::sincos(pose.theta_rad);
        pose = Pose {
            x_m: pose.x_m + v_mps * dt_s * cos,
            y_m: pose.y_m + v_mps * dt_s * sin,
            theta_rad: pose.theta_rad + omega_radps * dt_s,
        };
    }
    let mut open = scenario("random:rect:joystick:1", 12.0);
    open.world = schemas::World::default();
    open.start.pose = Pose::default();
    (Recording::for_test(open, moments), truth)
}

/// The goals of a person of the family are found, to the grid's 0.25 m and a radian fraction, but for
/// the second in which they change and while the person stands on a goal.
#[test]
fn goals_are_inferred() {
    let gains = Gains { k_theta: 1.5, delay_s: 0.2 };
    let (recording, truth) = by_the_law(&gains);
    let explained = goals::explain(&recording, &gains, goals::GRID_M, usize::MAX);
    let (mut near, mut judged) = (0, 0);
    for (tick, wanted) in truth.iter().enumerate().step_by(5) {
        let state =
            recording.look().at(tick).and_then(|moment| moment.state).expect("every tick has one");
        let to = |at: [f64; 2]| libm::atan2(at[1] - state.pose.y_m, at[0] - state.pose.x_m);
        let way_m = libm::hypot(wanted[0] - state.pose.x_m, wanted[1] - state.pose.y_m);
        if way_m < 0.5 {
            continue;
        }
        judged += 1;
        if let bearing::Goal::At(found) = explained.goal(tick) {
            near += usize::from(wrap(to(found) - to(*wanted)).abs() < 0.3);
        }
    }
    assert!(judged > 60 && near * 10 >= judged * 9, "{near} of {judged}");
}

/// The gains of people of the family are found, to the neighbours of what is tried: a gain shows
/// only where the stick is not at its end, and trades off against the reaction time.
#[test]
fn gains_are_pooled() {
    for wanted in [Gains { k_theta: 1.0, delay_s: 0.1 }, Gains { k_theta: 2.1, delay_s: 0.3 }] {
        let log = Arc::new(by_the_law(&wanted).0);
        let found = Gains::pooled(&[Arc::clone(&log), log]);
        let ratio = found.k_theta / wanted.k_theta;
        assert!((0.66..1.51).contains(&ratio), "{found:?}");
        assert!((found.delay_s - wanted.delay_s).abs() < 0.11, "{found:?}");
    }
    assert_eq!(Gains::pooled(&[]), Gains::PRIOR);
}

/// Displaced to the left of the recorded way, both estimates turn right, back to where the person
/// was going; playback does not.
#[test]
fn estimates_steer_back_to_the_goal() {
    let (recording, _) = by_the_law(&Gains::PRIOR);
    let recording = Arc::new(recording);
    let tick = 100;
    let moment = recording.look().at(tick).expect("lasts so long");
    let (state, recorded) = (moment.state.expect("has one"), moment.request.expect("has one"));
    let [x_m, y_m] = state.pose.transform(0.0, 0.4);
    let aside = State { pose: Pose { x_m, y_m, ..state.pose }, ..state };
    for person in levels() {
        let mut human = person.of_recording(&recording);
        let mut asked = None;
        // Long enough there for the slowest of reactions.
        for earlier in tick - 30..=tick {
            asked = human.joystick(&view(earlier as u64, &aside));
        }
        let turned = asked.expect("asks").omega_radps - recorded.omega_radps;
        if person.is_estimate() {
            assert!(turned < -0.1, "{}: {turned}", person.name());
        } else if person == Person::Playback {
            assert_eq!(turned, 0.0);
        }
    }
}

/// The path level plays what was asked for where the robot had come as far: half as fast, twice as
/// long; and a rest lasts as long as it lasted.
#[test]
fn path_goes_by_distance() {
    // Half a second at 1 m/s, half a second of rest, half a second at 1 m/s.
    let mut moments = Vec::new();
    let mut x_m = 0.0;
    for tick in 0..75 {
        let v_mps = if (25..50).contains(&tick) { 0.0 } else { 1.0 };
        moments.push(Moment {
            request: Some(Request { v_mps, omega_radps: f64::from(tick), dead_man: true }),
            state: Some(State { pose: Pose { x_m, ..Pose::default() }, v_mps, omega_radps: 0.0 }),
        });
        x_m += 0.02 * v_mps;
    }
    let recording = Arc::new(Recording::for_test(scenario("case1", 1.5), moments));
    let mut human = Person::Path.of_recording(&recording);
    let mut played = Vec::new();
    for tick in 0..75_u64 {
        let pose = Pose { x_m: 0.01 * tick as f64, ..Pose::default() };
        let state = State { pose, v_mps: 0.5, omega_radps: 0.0 };
        played.push(human.joystick(&view(tick, &state)).expect("plays").omega_radps);
    }
    // At half the speed tick 40 of the replay is tick 20 of the recording.
    assert!((played[40] - 20.0).abs() <= 1.0, "{}", played[40]);
    // The rest is reached at tick 50, and half over at its recorded pace by tick 62.
    assert!((played[62] - 37.0).abs() <= 2.0, "{}", played[62]);
}

/// A script is called a script, by what the log says and by what the joystick looks like; a person
/// who looks is not.
#[test]
fn people_who_do_not_react_are_told() {
    let of = |name: &str, driver: &str| {
        let log = record(&scenario(name, 10.0), "human", SensorSuite::Exact);
        let mut recording = Recording::read(log.open()).expect("has a joystick");
        recording.header_mut().run.driver = driver.to_owned();
        Reaction::of(&recording)
    };
    assert_eq!(of("random:rect:joystick:3", "joystick"), Reaction::Scripted);
    assert_eq!(of("random:rect:joystick:3", "somebody"), Reaction::Strokes);
    for name in ["random:slant:flowing:2", "random:rect:flowing:3"] {
        assert_eq!(of(name, "somebody"), Reaction::Reacts, "{name}");
    }
    assert!(Reaction::Scripted.is_blind() && !Reaction::Strokes.is_blind());
}
