//! A replay's log holds recording and replay side by side, for `tandem diff`, for viewers, and for
//! every other command, which reads the replay in it.

use std::collections::BTreeMap;
use std::fs;

use schemas::log::{Arm, LogReader};
use schemas::{Event, Stamped};

use crate::program::Workplace;

fn arm(here: &Workplace, file: &str, arm: Arm) -> Vec<Stamped<Event>> {
    let log = LogReader::open(here.path(file)).unwrap().arm(arm).unwrap();
    log.collect::<Result<_, _>>().unwrap()
}

fn text(events: &[Stamped<Event>]) -> Vec<String> {
    events.iter().map(|event| format!("{event:?}")).collect()
}

#[test]
fn recording_and_replay_stand_side_by_side() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario random:slant:tracker:6 --duration 10");
    let replay = "replay --mode closed --controller paper-kinematic log.mcap -o both.mcap";
    here.tandem(replay).succeeds();
    let recorded = LogReader::open(here.path("log.mcap")).unwrap();
    let head = recorded.header().clone();
    let a = LogReader::open(here.path("both.mcap")).unwrap().arm(Arm::A).unwrap();
    assert_eq!(a.header(), &head);
    let recorded: Vec<_> = recorded.collect::<Result<_, _>>().unwrap();
    assert_eq!(text(&arm(&here, "both.mcap", Arm::A)), text(&recorded));

    // Both in all topics, viewers' topics too; those of A as often as they were recorded.
    let info = here.tandem("info --format json both.mcap").succeeds().json();
    let counts: BTreeMap<String, u64> = info["channels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| (c["topic"].as_str().unwrap().to_owned(), c["count"].as_u64().unwrap()))
        .collect();
    assert!(counts.keys().all(|topic| topic.starts_with("/A/") || topic.starts_with("/B/")));
    for topic in ["/step", "/command", "/joystick", "/truth", "/tf", "/scene", "/log"] {
        for arm in ["/A", "/B"] {
            assert!(counts[&format!("{arm}{topic}")] > 0, "{arm}{topic}");
        }
    }
    assert_eq!(info["run"]["controller"], "paper-kinematic");

    // The layout lies beside it, and is the one that is attached.
    let layout = fs::read(here.path("both.layout.json")).unwrap();
    let log = fs::read(here.path("both.mcap")).unwrap();
    let index = &mcap::Summary::read(&log).unwrap().unwrap().attachment_indexes;
    let index = index.iter().find(|index| index.name == "layout.json").unwrap();
    assert_eq!(&*mcap::read::attachment(&log, index).unwrap().data, &layout[..]);
}

/// One file says what two files say.
#[test]
fn diff_reads_both_from_one_file() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1 --duration 15");
    for mode in ["open", "closed"] {
        let replay =
            format!("replay --force --mode {mode} log.mcap --controller paper-kinematic -o x.mcap");
        here.tandem(&replay).succeeds();
        let one = here.tandem("diff --format json x.mcap").exits(1).json();
        let two = here.tandem("diff --format json log.mcap x.mcap").exits(1).json();
        assert_eq!(one, two);
        assert!(one["first_cause"]["node"].is_string(), "{one}");
        assert!(one["compared"]["steps"].as_u64().unwrap() > 100);

        here.tandem(&format!("replay --force --mode {mode} log.mcap -o same.mcap")).succeeds();
        let same = here.tandem("diff --format json same.mcap").succeeds().json();
        assert_eq!(same["same"], true);
    }
    // Where there is one run, there is nothing to compare it with.
    let run = here.tandem("diff log.mcap").exits(2);
    assert!(run.error_line().contains("one run, not two"), "{}", run.stderr);
}

#[test]
fn a_part_is_cut_from_both() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1-lab --duration 9");
    here.tandem("replay --mode closed --from 3 --to 6 log.mcap -o part.mcap").succeeds();
    let (a, b) = (arm(&here, "part.mcap", Arm::A), arm(&here, "part.mcap", Arm::B));
    assert_eq!(text(&a), text(&b));
    assert!(a.len() > 100);
    here.tandem("diff part.mcap").succeeds();
}

/// Several logs go into a folder, with one layout; a layout that is another one is not written over.
#[test]
fn a_folder_holds_one_layout() {
    let here = Workplace::new();
    here.record("p.mcap", "--scenario case1 --duration 3");
    here.record("q.mcap", "--scenario case2 --duration 3");
    here.tandem("replay p.mcap q.mcap --controller human -o out").succeeds();
    let mut names: Vec<_> = fs::read_dir(here.path("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["layout.json", "p.human.mcap", "q.human.mcap"]);
    here.tandem("replay p.mcap q.mcap --controller paper-kinematic -o out").succeeds();
    fs::write(here.path("out/layout.json"), "{}").unwrap();
    here.tandem("replay p.mcap q.mcap --controller tandem-kinematic -o out").exits(2);
    here.tandem("replay p.mcap q.mcap --controller tandem-kinematic -o out --force").succeeds();
}
