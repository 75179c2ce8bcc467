//! The contract: each fault does what its name says, to nothing else, the same for every controller.

use super::*;
use crate::session::{record, same, scenario, spec};
use crate::{Mode, Person, Replay};
use schemas::{Event, SensorSuite};

fn replayed(faults: &[&str], mode: Mode, controller: &str) -> [Vec<Stamped<Event>>; 2] {
    let scenario = scenario("random:rect:joystick:7", 6.0);
    let log = record(&scenario, "human", SensorSuite::Sonar);
    let faults = faults.iter().map(|fault| fault.parse().expect("a fault")).collect();
    let faults = Faults::new(faults, 3).expect("each of them once");
    let mut replay = Replay::new(|| Ok(log.open()), &spec(controller, &scenario), mode)
        .expect("replays")
        .under(faults);
    let events = std::iter::from_fn(|| replay.next_event()).collect();
    [log.events, events]
}

fn samples(events: &[Stamped<Event>]) -> Vec<&Sample> {
    let sample = |event: &'_ Stamped<Event>| matches!(event.value, Event::Sample(_));
    events
        .iter()
        .filter(|event| sample(event))
        .map(|event| match &event.value {
            Event::Sample(sample) => sample,
            _ => unreachable!("filtered"),
        })
        .collect()
}

/// Whether every pair of samples with the same stamp differs exactly where `differs` says.
fn differ_where(faults: &[&str], modes: &[Mode], differs: impl Fn(&Sample) -> bool) {
    for mode in modes {
        let [before, after] = replayed(faults, *mode, "human");
        let (before, after) = (samples(&before), samples(&after));
        assert_eq!(before.len(), after.len(), "{faults:?}");
        let mut any = false;
        for (before, after) in before.iter().zip(&after) {
            let differ = format!("{before:?}") != format!("{after:?}");
            any |= differ;
            assert!(!differ || differs(before), "{faults:?}: {before:?} became {after:?}");
        }
        assert!(any, "{faults:?} does nothing");
    }
}

#[test]
fn faults_alter_what_they_are_named_after() {
    // The person drives alone: what sensors say moves nothing, and what the joystick says does.
    let both = [Mode::Open, Mode::Closed(Person::Playback)];
    for sonar in ["sonar-dropout=0.5", "cross-talk=0.5", "sonar-bias=0.2"] {
        differ_where(&[sonar], &both, |sample| matches!(sample, Sample::Sonar(_)));
    }
    differ_where(
        &["sonar-dead=3"],
        &both,
        |sample| matches!(sample, Sample::Sonar(scan) if scan.echoes.iter().any(|echo| echo.id == 3)),
    );
    differ_where(&["gyro-bias=0.1"], &both, |sample| matches!(sample, Sample::Imu(_)));
    differ_where(&["encoder-slip=0.1"], &both, |sample| matches!(sample, Sample::Encoders(_)));
    differ_where(&["joystick-freeze=2-4"], &both[..1], |sample| match sample {
        Sample::Joystick(joystick) => {
            (2.0..4.0).contains(&joystick.stamp.seconds_since(schemas::SIMULATION_EPOCH))
        }
        _ => false,
    });
}

/// A joystick may be stuck more than once, and says the same each time from beginning to end.
#[test]
fn a_joystick_may_be_stuck_more_than_once() {
    let [_, after] = replayed(&["joystick-freeze=4-5", "joystick-freeze=1-2"], Mode::Open, "human");
    for (from_s, to_s) in [(1.0, 2.0), (4.0, 5.0)] {
        let mut said: Vec<String> = samples(&after)
            .iter()
            .filter_map(|sample| match sample {
                Sample::Joystick(joystick) => Some(joystick),
                _ => None,
            })
            .filter(|joystick| {
                let t_s = joystick.stamp.seconds_since(schemas::SIMULATION_EPOCH);
                (from_s..to_s).contains(&t_s)
            })
            .map(|joystick| format!("{} {}", joystick.v_mps, joystick.omega_radps))
            .collect();
        assert!(said.len() > 10);
        said.dedup();
        assert_eq!(said.len(), 1, "{from_s} s");
    }
}

/// Half of the readings drop out, give or take five standard deviations of a binomial.
#[test]
fn a_share_is_a_share() {
    let [before, after] = replayed(&["sonar-dropout=0.5"], Mode::Open, "human");
    let heard = |events: &[Stamped<Event>]| {
        let echoes = |sample: &&Sample| match sample {
            Sample::Sonar(scan) => scan.echoes.iter().filter(|echo| echo.echo).count(),
            _ => 0,
        };
        samples(events).iter().map(echoes).sum::<usize>() as f64
    };
    let (before, after) = (heard(&before), heard(&after));
    assert!((after - 0.5 * before).abs() < 5.0 * libm::sqrt(0.25 * before), "{after} of {before}");
}

/// Late sensors keep their stamps and arrive later, never the joystick, and log times increase.
#[test]
fn late_sensors_arrive_late() {
    let [before, after] = replayed(&["latency=0.03", "jitter=0.02"], Mode::Open, "human");
    assert!(after.windows(2).all(|pair| pair[0].at < pair[1].at));
    let mut last_s: f64 = 0.0;
    for event in &after {
        let Event::Sample(sample) = &event.value else { continue };
        let late_s = event.at.seconds_since(sample.stamp());
        if matches!(sample, Sample::Joystick(_)) {
            assert!(late_s < 1e-6);
        } else {
            assert!((0.03..0.0501).contains(&late_s), "{late_s}");
            last_s = last_s.max(late_s);
        }
    }
    assert!(last_s > 0.045, "jitter comes on top of latency");
    // What had not arrived by the end is missing, and nothing else.
    assert!(samples(&before).len() - samples(&after).len() < 20);
}

/// The same faults meet every controller; another seed makes others; no fault is no fault.
#[test]
fn faults_are_the_same_for_every_controller() {
    let faults = ["sonar-dropout=0.3", "cross-talk=0.1"];
    let [_, a] = replayed(&faults, Mode::Open, "human");
    let [_, b] = replayed(&faults, Mode::Open, "tandem-kinematic");
    let text = |events: &[Stamped<Event>]| format!("{:?}", samples(events));
    assert_eq!(text(&a), text(&b));
    let [before, after] = replayed(&[], Mode::Open, "human");
    assert!(same(&before, &after));
}

#[test]
fn bad_faults_are_refused_with_what_there_is() {
    for bad in ["", "sonar-dead", "wind=3"] {
        let error = bad.parse::<Fault>().expect_err(bad).to_string();
        assert!(error.contains("sonar-dropout=SHARE"), "{error}");
    }
    for (bad, allowed) in [
        ("sonar-dead=16", "from 0 to 15"),
        ("sonar-dead=-1", "from 0 to 15"),
        ("sonar-dropout=1.5", "from 0 to 1"),
        ("cross-talk=-0.1", "from 0 to 1"),
        ("encoder-slip=half", "from 0 to 1"),
        ("sonar-bias=inf", "metres, from -5 to 5"),
        ("sonar-bias=-5.01", "metres, from -5 to 5"),
        ("gyro-bias=nan", "rad/s, from -10 to 10"),
        ("gyro-bias=1e3", "rad/s, from -10 to 10"),
        ("latency=-1", "seconds, from 0 to 10"),
        ("latency=1e9", "seconds, from 0 to 10"),
        ("jitter=nan", "seconds, from 0 to 10"),
        ("jitter=10.1", "seconds, from 0 to 10"),
        ("controller-hang=-1", "from 0 to 86400"),
        ("controller-panic=1e6", "from 0 to 86400"),
        ("joystick-freeze=3", "FROM-TO"),
        ("joystick-freeze=2-1e9", "from 0 to 86400"),
        ("joystick-freeze=-2-4", "FROM-TO"),
    ] {
        let error = bad.parse::<Fault>().expect_err(bad).to_string();
        let (name, _) = bad.split_once('=').expect("a name and a value");
        assert!(error.contains(bad) && error.contains(&format!("value of {name}")), "{error}");
        assert!(error.contains(allowed), "{error}");
    }
    // What stands at the border does.
    for fine in
        ["sonar-bias=-5", "gyro-bias=10", "latency=10", "jitter=0", "joystick-freeze=0-86400"]
    {
        assert_eq!(fine.parse::<Fault>().expect(fine).to_string(), fine);
    }
    for backwards in ["joystick-freeze=10-5", "joystick-freeze=5-5"] {
        let error = backwards.parse::<Fault>().expect_err(backwards).to_string();
        assert!(error.contains("ends before it begins"), "{error}");
    }
}

/// A fault that meets nothing that it could change is told, with what there was none of; with the sensors that
/// a robot has, and within its session, each meets something.
#[test]
fn faults_that_meet_nothing_are_told() {
    let unmet = |faults: &[&str], sensors, mode| {
        let scenario = scenario("random:rect:joystick:7", 3.0);
        let log = record(&scenario, "human", sensors);
        let faults = faults.iter().map(|fault| fault.parse().expect("a fault")).collect();
        let mut replay = Replay::new(|| Ok(log.open()), &log.spec, mode)
            .expect("replays")
            .under(Faults::new(faults, 0).expect("each of them once"));
        while replay.next_event().is_some() {}
        let unmet = replay.finish().expect("has steps").unmet_faults;
        unmet.iter().map(|fault| (fault.to_string(), fault.misses())).collect::<Vec<_>>()
    };
    let all = [
        "sonar-dropout=0.5",
        "cross-talk=0.1",
        "sonar-bias=-0.2",
        "sonar-dead=3",
        "gyro-bias=0.1",
        "encoder-slip=0.1",
        "latency=0.03",
        "jitter=0.02",
        "joystick-freeze=1-2",
    ];
    for mode in [Mode::Open, Mode::Closed(Person::Playback)] {
        assert_eq!(unmet(&all, SensorSuite::Sonar, mode), []);
        let names: Vec<String> =
            unmet(&all, SensorSuite::Exact, mode).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, all[..6], "exact poses come late, and the joystick is heard");
        let late =
            ["sonar-dead=3", "joystick-freeze=4-5", "controller-hang=3.05", "controller-panic=100"];
        let none = [
            "no reading of sonar 3",
            "no joystick sample from 4 to 5 s",
            "no step at or after 3.05 s",
            "no step at or after 100 s",
        ];
        let told = unmet(&late, SensorSuite::Exact, mode);
        let want: Vec<_> = late
            .iter()
            .zip(none)
            .map(|(fault, none)| ((*fault).to_owned(), none.to_owned()))
            .collect();
        assert_eq!(told, want);
    }
}

/// What is asked for is what is said, and once is enough.
#[test]
fn faults_are_told_as_they_are_asked_for_and_named_once() {
    let of = |names: &[&str]| {
        let faults = names.iter().map(|name| name.parse().expect("a fault")).collect();
        Faults::new(faults, 1)
    };
    let all = [
        "sonar-dropout=0.5",
        "cross-talk=0.1",
        "sonar-bias=-0.2",
        "sonar-dead=3",
        "sonar-dead=4",
        "gyro-bias=0.1",
        "encoder-slip=0.1",
        "latency=0.03",
        "jitter=0.02",
        "joystick-freeze=2-4",
        "joystick-freeze=4-5.5",
        "controller-hang=4",
        "controller-panic=4",
    ];
    assert_eq!(of(&all).expect("each of them once").names(), all);
    for twice in [
        ["sonar-dead=3", "sonar-dead=3"],
        ["latency=0.03", "latency=0.05"],
        ["joystick-freeze=2-4", "joystick-freeze=3-5"],
    ] {
        let error = of(&twice).expect_err("twice").to_string();
        assert!(error.contains(twice[1]) && error.contains("already"), "{error}");
    }
}
