//! `tandem check` and `tandem approve`: fixtures replayed with today's defaults against golden results.

use std::fs;
use std::path::Path;

use schemas::Event;
use schemas::log::{LogReader, WriterOptions};

use crate::program::{Workplace, fixtures};

/// Copies one fixture of the repository into a folder of its own.
fn copy_fixture(here: &Workplace, name: &str) {
    let to = here.path("fixtures").join(name);
    fs::create_dir_all(&to).unwrap();
    for file in fs::read_dir(fixtures().join(name)).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), to.join(file.file_name())).unwrap();
    }
}

fn edit(path: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains(from), "{} contains {from}", path.display());
    fs::write(path, text.replace(from, to)).unwrap();
}

#[test]
fn the_repositorys_fixtures_hold() {
    let here = Workplace::new();
    let run = here.tandem(&format!("check --format json {}", fixtures().display())).succeeds();
    let json = run.json();
    assert_eq!(json["ok"], true, "{json}");
    assert_eq!(json["problems"].as_array().unwrap().len(), 0);
    assert!(json["fixtures"].as_array().unwrap().len() >= 5, "{json}");
}

#[test]
fn a_changed_gain_is_named_and_can_be_approved() {
    let here = Workplace::new();
    copy_fixture(&here, "case1");
    here.tandem("check fixtures").succeeds();
    // What a changed default would do: the same fixture under a controller 5 % off in gamma3.
    let file = here.path("fixtures/case1/fixture.toml");
    edit(&file, "\"tandem-kinematic\"", "\"tandem-kinematic:gamma3=2.1\"");
    let run = here.tandem("check --format json fixtures").exits(1).json();
    assert_eq!(run["ok"], false);
    let what = run["problems"][0]["what"].as_str().unwrap();
    // The gain enters the wanted turn rate before anything else (law, not reference).
    assert!(what.contains("omega_star_radps") || what.contains("u_f"), "{what}");
    let (amount, when) = what.split(" by ").nth(1).and_then(|by| by.split_once(" at ")).unwrap();
    let (amount, unit) = amount.split_once(' ').unwrap();
    assert!(amount.parse::<f64>().unwrap() > 0.0 && unit.starts_with("rad/s"), "{what}");
    let (time, rest) = when.split_once(' ').unwrap();
    assert!((0.0..=60.0).contains(&time.parse::<f64>().unwrap()), "{what}");
    assert!(rest.starts_with('s'), "{what}");

    here.tandem("approve fixtures").exits(2);
    here.tandem("approve fixtures --reason gamma3-raised-on-purpose").succeeds();
    here.tandem("check fixtures").succeeds();
    let golden = fs::read_to_string(here.path("fixtures/case1/golden.toml")).unwrap();
    assert!(golden.contains("gamma3-raised-on-purpose"), "the reason is kept: {golden}");
}

/// A golden run that lacks a field in one step is another result, by name and time; one that is older than the
/// field is not.
#[test]
fn a_golden_run_that_lost_a_field() {
    let here = Workplace::new();
    copy_fixture(&here, "case1-lab");
    let golden = here.path("fixtures/case1-lab/golden.mcap");
    let lose = |lost: &dyn Fn(f64) -> bool| {
        let mut from = LogReader::open(fixtures().join("case1-lab/golden.mcap")).unwrap();
        let options = WriterOptions { view: false, ..WriterOptions::offline() };
        let mut to = schemas::log::create(&golden, from.header(), &options).unwrap();
        while let Some(mut event) = from.next_event().unwrap() {
            let at_s = event.at.seconds_since(schemas::SIMULATION_EPOCH);
            if let Event::Step(step) = &mut event.value
                && lost(at_s)
            {
                step.safety_clear_m = None;
            }
            to.write(&event).unwrap();
        }
        to.finish().unwrap();
    };
    lose(&|at_s| (3.99..4.01).contains(&at_s));
    let run = here.tandem("check --format json fixtures").exits(1).json();
    let what = run["problems"][0]["what"].as_str().unwrap();
    assert!(what.contains("at 4.000 s safety_clear_m is absent in A"), "{what}");
    lose(&|_| true);
    here.tandem("check fixtures").succeeds();
}

#[test]
fn a_damaged_golden_run_can_be_approved_anew() {
    let here = Workplace::new();
    copy_fixture(&here, "case1");
    fs::write(here.path("fixtures/case1/golden.mcap"), "damaged").unwrap();
    here.tandem("check fixtures").exits(1);
    here.tandem("approve fixtures --reason the-golden-run-was-damaged").succeeds();
    here.tandem("check fixtures").succeeds();
}

#[test]
fn a_check_that_checks_nothing_is_no_success() {
    let here = Workplace::new();
    fs::create_dir(here.path("nothing")).unwrap();
    let run = here.tandem("check nothing").exits(2);
    assert!(run.stderr.contains("no fixture"), "{}", run.stderr);
}

#[test]
fn a_damaged_or_missing_part_is_a_problem() {
    let here = Workplace::new();
    copy_fixture(&here, "case1");
    fs::remove_file(here.path("fixtures/case1/golden.mcap")).unwrap();
    let run = here.tandem("check --format json fixtures").exits(1).json();
    assert!(run["problems"][0]["remedy"].as_str().unwrap().contains("approve"), "{run}");

    copy_fixture(&here, "case1");
    let log = here.path("fixtures/case1/session.mcap");
    let bytes = fs::read(&log).unwrap();
    fs::write(&log, &bytes[..bytes.len() / 2]).unwrap();
    let run = here.tandem("check --format json fixtures").exits(1).json();
    assert_eq!(run["ok"], false);
}

/// One fixture that cannot be replayed: the others are left as they were, and it is named.
#[test]
fn nothing_is_approved_where_one_fixture_is_bad() {
    let here = Workplace::new();
    copy_fixture(&here, "case1");
    copy_fixture(&here, "case2");
    let first = here.path("fixtures/case1/fixture.toml");
    edit(&first, "\"tandem-kinematic\"", "\"tandem-kinematic:gamma3=2.1\"");
    let golden = here.path("fixtures/case1/golden.toml");
    let before = fs::read_to_string(&golden).unwrap();
    fs::write(here.path("fixtures/case2/session.mcap"), "not a log").unwrap();
    let run = here.tandem("approve fixtures --reason why-not").exits(2);
    assert!(
        run.stderr.contains("case2") && run.stderr.contains("nothing was approved"),
        "{}",
        run.stderr
    );
    assert_eq!(fs::read_to_string(&golden).unwrap(), before);
}
