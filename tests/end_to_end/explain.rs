//! `tandem explain`: the words are reviewed as text, and bad input ends in one line.
//!
//! The snapshots show fixtures: they change when fixtures are recorded anew, and are then to be read
//! again (`cargo insta review`).

use std::fs;

use schemas::log::{LogReader, WriterOptions, create};

use crate::program::{Workplace, fixtures};

fn copy(here: &Workplace, fixture: &str) {
    let session = fixtures().join(fixture).join("session.mcap");
    fs::copy(session, here.path(&format!("{fixture}.mcap"))).unwrap();
}

#[test]
fn the_words_are_as_reviewed() {
    let here = Workplace::new();
    for (fixture, at) in [("case1", "6"), ("case1-lab", "9.6"), ("random-human", "3")] {
        copy(&here, fixture);
        let run = here.tandem(&format!("explain {fixture}.mcap --at {at}")).succeeds();
        assert!(run.stderr.is_empty(), "{}", run.stderr);
        insta::assert_snapshot!(format!("explain-{fixture}"), run.stdout);
    }
}

/// With sonars the echo behind D is named, and it is one that the log holds.
#[test]
fn an_echo_is_named_by_sonar_range_and_time() {
    let here = Workplace::new();
    here.record("lab.mcap", "--scenario case1-lab --duration 8 --seed 1");
    let told = here.tandem("explain lab.mcap --at 7 --format json").succeeds().json();
    assert_eq!(told["untraced"], serde_json::Value::Null, "{told}");
    let echo = &told["sets"]["asked"][0]["ray"]["echo"];
    let (sonar, range_m) = (echo["sonar"].as_u64().unwrap(), echo["range_m"].as_f64().unwrap());
    let heard_s_before = echo["heard_s_before"].as_f64().unwrap();
    assert!(echo["confirmed"].as_bool().unwrap() && heard_s_before >= 0.0, "{echo}");
    let mut log = LogReader::open(here.path("lab.mcap")).unwrap();
    let start = log.header().run.start;
    let mut found = 0;
    while let Some(event) = log.next_event().unwrap() {
        let schemas::Event::Sample(schemas::Sample::Sonar(scan)) = event.value else { continue };
        found += scan
            .echoes
            .iter()
            // JSON is read to the last digit or two, not to the last bit.
            .filter(|heard| u64::from(heard.id) == sonar && (heard.range_m - range_m).abs() < 1e-12)
            .filter(|heard| (7.0 - heard.fired.seconds_since(start) - heard_s_before).abs() < 1e-9)
            .count();
    }
    assert_eq!(found, 1, "{echo}");
    // The truth stands beside it.
    assert!(told["truth"]["clearance_m"].as_f64().unwrap() > 0.0);
    assert!(told["truth"]["nearest"].is_string());
    assert_eq!(told["echoes"].as_array().unwrap().len(), 16);
}

/// Seconds and instants of the calendar name the same step; a step is in force until the next.
#[test]
fn times_may_be_written_in_two_ways() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1 --duration 3");
    let of = |at: &str| {
        let told = here.tandem(&format!("explain log.mcap --format json --at {at}"));
        told.succeeds().json()["step_index"].as_u64().unwrap()
    };
    assert_eq!([of("0"), of("1.2"), of("1.25"), of("1.2s")], [0, 12, 12, 12]);
    assert_eq!(of("2025-01-01T00:00:01.25Z"), 12);
}

#[test]
fn a_human_alone_is_explained_as_such() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario random:rect:goal:1 --controller human --duration 3");
    let run = here.tandem("explain log.mcap --at 2").succeeds();
    assert!(run.stdout.contains("The person drives (k = 1 from the start)"), "{}", run.stdout);
    assert!(run.stdout.contains("this version has no projection"), "{}", run.stdout);
}

/// A controller that this build does not have, or that behaves otherwise now, is no obstacle: the
/// recorded numbers are told, and it is said that rays are not named.
#[test]
fn what_cannot_be_stepped_again_is_told_from_the_record() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1 --duration 3");
    let mut log = LogReader::open(here.path("log.mcap")).unwrap();
    for (name, controller, gamma) in
        [("other.mcap", "experiment-7", "0.2"), ("changed.mcap", "tandem-kinematic", "0.25")]
    {
        let mut header = log.header().clone();
        header.run.controller = controller.to_owned();
        header.params_toml =
            header.params_toml.replace("gamma1 = 0.2", &format!("gamma1 = {gamma}"));
        let mut copy = create(here.path(name), &header, &WriterOptions::offline()).unwrap();
        let mut original = LogReader::open(here.path("log.mcap")).unwrap();
        while let Some(event) = original.next_event().unwrap() {
            copy.write(&event).unwrap();
        }
        copy.finish().unwrap();
    }
    assert!(log.next_event().unwrap().is_some());
    let other = here.tandem("explain other.mcap --at 2").succeeds().stdout;
    assert!(other.contains("not part of this build") && other.contains("experiment-7"), "{other}");
    let changed = here.tandem("explain changed.mcap --at 2").succeeds().stdout;
    assert!(changed.contains("does not make the recorded step again"), "{changed}");
    let json = here.tandem("explain changed.mcap --at 2 --format json").succeeds().json();
    assert!(json["sets"]["distance_m"].as_f64().unwrap() > 0.0, "{json}");
    assert!(json["sets"]["asked"][0]["ray"].is_null(), "{json}");
}

#[test]
fn bad_input_is_one_line_that_says_what_there_is() {
    let here = Workplace::new();
    let log = here.record("log.mcap", "--scenario case1 --duration 3");
    let header = LogReader::open(&log).unwrap().header().clone();
    create(here.path("empty.mcap"), &header, &WriterOptions::offline()).unwrap().finish().unwrap();
    for (line, what) in [
        ("log.mcap --at 99", vec!["log.mcap", "99.000 s", "from 0.000 s to 3.000 s"]),
        ("log.mcap --at -1", vec!["log.mcap", "-1.000 s", "from 0.000 s to 3.000 s"]),
        (
            "log.mcap --at 2024-12-31T23:59:59Z",
            vec!["log.mcap", "-1.000 s", "2025-01-01T00:00:00.000Z"],
        ),
        ("log.mcap --at soon", vec!["soon", "12.4", "Z"]),
        ("log.mcap --at NaN", vec!["NaN"]),
        ("empty.mcap --at 1", vec!["empty.mcap", "no controller step"]),
        ("nowhere.mcap --at 1", vec!["nowhere.mcap", "No such file"]),
    ] {
        let run = here.tandem(&format!("explain {line}")).exits(2);
        let error = run.error_line();
        assert!(what.iter().all(|what| error.contains(what)), "`{line}`: {error}");
        assert!(run.stdout.is_empty());
    }
    // A cut log is explained as far as it goes.
    let bytes = fs::read(here.record("long.mcap", "--scenario case1 --duration 20")).unwrap();
    fs::write(here.path("cut.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    here.tandem("explain cut.mcap --at 1").succeeds();
    let run = here.tandem("explain cut.mcap --at 19").exits(1);
    assert!(run.error_line().contains("cut off at byte"), "{}", run.stderr);
}
