//! `tandem map`: a scenario and a log to look at; `replay --world` drives in it.

use std::fs;

use schemas::log::{LogReader, WriterOptions, create};
use schemas::{Cell, Event, Header, Scenario, World};

use crate::program::Workplace;

/// A recorded session, and the same as a real robot would leave it: no world in its head, no truth.
fn record(here: &Workplace) {
    let whole = here.record("whole.mcap", "--scenario random:rect:explorer:8 --duration 25");
    let mut log = LogReader::open(&whole).unwrap();
    let scenario = Scenario { world: World::default(), ..log.header().scenario.clone() };
    let header = Header { scenario, ..log.header().clone() };
    let mut bare = create(here.path("log.mcap"), &header, &WriterOptions::offline()).unwrap();
    while let Some(event) = log.next_event().unwrap() {
        if !matches!(event.value, Event::Truth(_)) {
            bare.write(&event).unwrap();
        }
    }
    bare.finish().unwrap();
}

#[test]
fn a_log_becomes_a_world_that_can_be_driven_in() {
    let here = Workplace::new();
    record(&here);
    let mapped = here.tandem("map log.mcap -o room.toml --format json").succeeds().json();
    assert!(mapped["walls_m"].as_f64().unwrap() > 5.0, "{mapped}");
    assert!(mapped["free_m2"].as_f64().unwrap() > 5.0, "{mapped}");
    let text = fs::read_to_string(here.path("room.toml")).unwrap();
    let scenario = Scenario::from_toml(&text).unwrap();
    assert_eq!(scenario.name, "room");
    let explored = scenario.explored.as_ref().unwrap();
    assert_eq!(explored.at(scenario.start.pose.position_m()), Cell::Free);

    // It is to be looked at: the grid once, the faces in every scene.
    let info = here.tandem("info room.mcap --format json").succeeds().json();
    let channels = info["channels"].as_array().unwrap();
    let count = |topic: &str| {
        let of = channels.iter().find(|channel| channel["topic"] == topic);
        of.map(|channel| channel["count"].as_u64().unwrap())
    };
    assert_eq!(count("/map"), Some(1));
    assert!(count("/scene") > Some(100));

    // And driven in: recorded anew, and replayed in closed loop in place of the log's own.
    here.record("again.mcap", "--scenario room.toml --driver explorer --duration 5");
    let replay = |options: &str| {
        let command = format!("replay --format json --mode closed {options} log.mcap");
        here.tandem(&command).succeeds().json()["runs"][0].clone()
    };
    let nowhere = replay("");
    let in_file = replay("--world room.toml");
    let in_map = replay("--world map");
    assert_eq!(in_file["output_hash"], in_map["output_hash"]);
    assert_ne!(in_file["output_hash"], nowhere["output_hash"]);
    // Nothing of the log's own person is lost by it.
    assert_eq!(in_file["steps"], nowhere["steps"]);

    let said = here.tandem("replay --mode closed log.mcap").succeeds();
    assert!(said.stderr.contains("the log has no world"), "{}", said.stderr);
}

/// A replay that is written says which world it was in.
#[test]
fn the_world_goes_into_the_replays_log() {
    let here = Workplace::new();
    record(&here);
    here.tandem("map log.mcap -o room.toml").succeeds();
    here.tandem("replay --mode closed --world room.toml log.mcap -o out.mcap").succeeds();
    let log = LogReader::open(here.path("out.mcap")).unwrap();
    let room = Scenario::from_toml(&fs::read_to_string(here.path("room.toml")).unwrap()).unwrap();
    assert_eq!(log.header().scenario.world, room.world);
    let recorded = log.arm(schemas::log::Arm::A).unwrap();
    assert!(recorded.header().scenario.world.is_empty());
}

#[test]
fn what_cannot_be_mapped_is_said() {
    let here = Workplace::new();
    here.record("exact.mcap", "--scenario case1 --duration 3");
    here.record("log.mcap", "--scenario random:rect:explorer:8 --duration 3");
    fs::write(here.path("bad.toml"), "name = 3").unwrap();
    for (line, what) in [
        ("map exact.mcap -o x.toml", "no echo of a sonar"),
        ("map log.mcap -o x.txt", "a scenario is a .toml file"),
        ("map nowhere.mcap -o x.toml", "nowhere.mcap"),
        (
            "map log.mcap -o log.toml",
            "beside log.toml goes a log to look at it by: log.mcap is the input",
        ),
        ("replay log.mcap --world map", "--mode closed"),
        ("replay exact.mcap --mode closed --world map", "no echo of a sonar"),
        ("replay log.mcap --mode closed --world bad.toml", "bad.toml"),
    ] {
        let run = here.tandem(line).exits(2);
        assert!(run.error_line().contains(what), "`{line}`: {}", run.stderr);
        assert!(!here.path("x.toml").exists() && !here.path("x.mcap").exists());
    }
    here.tandem("map log.mcap -o room.toml").succeeds();
    let again = here.tandem("map log.mcap -o room.toml").exits(2);
    assert!(again.error_line().contains("--force"), "{}", again.stderr);
    fs::remove_file(here.path("room.toml")).unwrap();
    let beside = here.tandem("map log.mcap -o room.toml").exits(2);
    assert!(beside.error_line().contains("beside room.toml"), "{}", beside.stderr);
    assert!(beside.error_line().contains("room.mcap exists"), "{}", beside.stderr);
}

/// A log that ends early is mapped as far as it goes, and that is said.
#[test]
fn a_cut_log_is_mapped_as_far_as_it_goes() {
    let here = Workplace::new();
    let log = here.record("log.mcap", "--scenario random:rect:explorer:8 --duration 20");
    let bytes = fs::read(&log).unwrap();
    fs::write(here.path("cut.mcap"), &bytes[..bytes.len() * 2 / 3]).unwrap();
    let run = here.tandem("map cut.mcap -o room.toml").exits(1);
    assert!(run.stderr.contains("mapped as far as that"), "{}", run.stderr);
    assert!(here.path("room.toml").exists() && here.path("room.mcap").exists());
}
