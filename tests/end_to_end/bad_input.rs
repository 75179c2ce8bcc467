//! Bad input ends in one line of error that says what to do, with exit status 2 (1 where a file is
//! damaged), and never in a panic.

use std::collections::BTreeMap;
use std::fs;

use crate::program::Workplace;

#[test]
fn a_missing_file() {
    let here = Workplace::new();
    for command in ["replay", "info", "diff other.mcap", "metrics"] {
        let run = here.tandem(&format!("{command} nowhere.mcap")).exits(2);
        assert!(run.stderr.contains(".mcap"), "{command} names the file: {}", run.stderr);
        assert!(run.stderr.to_lowercase().contains("no such file"), "{}", run.stderr);
    }
    let run = here.tandem("compare --a human --b paper-kinematic nowhere.mcap").exits(2);
    assert!(run.stderr.contains("nowhere.mcap"), "{}", run.stderr);
}

#[test]
fn files_that_are_no_logs() {
    let here = Workplace::new();
    fs::write(here.path("empty.mcap"), b"").unwrap();
    fs::write(here.path("text.mcap"), "once upon a time there was a robot\n").unwrap();
    for file in ["empty.mcap", "text.mcap"] {
        for command in ["replay", "info"] {
            let run = here.tandem(&format!("{command} {file}")).exits(2);
            let line = run.error_line();
            assert!(line.contains(file) && line.contains("not an MCAP file"), "{line}");
            assert!(line.contains("tandem record"), "says what to do: {line}");
        }
    }
}

#[test]
fn an_mcap_file_of_somebody_else() {
    let here = Workplace::new();
    let file = fs::File::create(here.path("foreign.mcap")).unwrap();
    let mut writer = mcap::Writer::new(file).unwrap();
    let schema = writer.add_schema("std_msgs/String", "ros2msg", b"string data").unwrap();
    let channel = writer.add_channel(schema, "/chatter", "cdr", &BTreeMap::new()).unwrap();
    let header = mcap::records::MessageHeader {
        channel_id: channel,
        sequence: 0,
        log_time: 1,
        publish_time: 1,
    };
    writer.write_to_known_channel(&header, b"hello").unwrap();
    writer.finish().unwrap();
    let run = here.tandem("replay foreign.mcap").exits(2);
    let line = run.error_line();
    assert!(line.contains("foreign.mcap") && line.contains("not a session log"), "{line}");
}

#[test]
fn a_log_cut_in_the_middle() {
    let here = Workplace::new();
    let log = here.record("whole.mcap", "--scenario case1 --duration 20");
    let bytes = fs::read(&log).unwrap();
    fs::write(here.path("cut.mcap"), &bytes[..bytes.len() * 2 / 3]).unwrap();
    let whole = here.tandem("replay --format json whole.mcap").succeeds().json();
    let run = here.tandem("replay --format json cut.mcap").exits(1);
    let line = run.error_line();
    assert!(line.contains("cut.mcap") && line.contains("cut off at byte"), "{line}");
    // What stands before the cut was replayed.
    let steps = |json: &serde_json::Value| json["runs"][0]["steps"].as_u64().unwrap();
    let replayed = steps(&run.json());
    assert!(replayed > 0 && replayed < steps(&whole), "{replayed}");
    // So is it compared: as far as it goes nothing differs, and nobody says that all is the same.
    for pair in ["whole.mcap cut.mcap", "cut.mcap whole.mcap", "cut.mcap cut.mcap"] {
        let run = here.tandem(&format!("diff --format json {pair}")).exits(1);
        assert!(run.error_line().contains("cut off at byte"), "{}", run.stderr);
        let json = run.json();
        assert_eq!(json["compared"]["steps"], replayed, "{pair}");
        assert_eq!((&json["same"], &json["whole"]), (&false.into(), &false.into()), "{json}");
        assert!(json["fields"].as_array().unwrap().is_empty(), "{json}");
        assert!(json["damage"][0]["what"].as_str().unwrap().contains("cut off"), "{json}");
    }
    let text = here.tandem("diff whole.mcap cut.mcap").exits(1).stdout;
    assert!(text.contains("as far as both runs can be read"), "{text}");
    // And a cut file is not a complete one.
    let info = here.tandem("info --format json cut.mcap").exits(1).json();
    assert_eq!(info["complete"], false);
}

#[test]
fn arguments_that_mean_nothing() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1 --duration 2");
    for (line, what) in [
        ("replay log.mcap --controller nobody", "tandem-kinematic"),
        ("replay log.mcap --controller tandem-kinematic:gamma3=-1", "gamma3"),
        ("replay log.mcap --controller tandem-kinematic:gama3=1", "gamma3"),
        ("replay log.mcap --controller tandem-kinematic:gamma3", "key=value"),
        ("replay log.mcap --controller tandem-kinematic:no.toml", "no.toml"),
        ("record --scenario nowhere -o x.mcap", "case1"),
        ("record --scenario no.toml -o x.mcap", "no.toml"),
        ("record --from p2os:/dev/ttyUSB0 -o x.mcap", "sim"),
        ("record --scenario case3 --driver goal -o x.mcap", "task"),
        ("record --duration -1 -o x.mcap", "positive"),
        ("record -o log.mcap", "--force"),
        ("check nowhere", "nowhere"),
    ] {
        let run = here.tandem(line).exits(2);
        assert!(run.error_line().contains(what), "`{line}` should speak of {what}: {}", run.stderr);
        assert!(!here.path("x.mcap").exists(), "`{line}` leaves nothing behind");
    }
}

#[test]
fn another_control_period_in_open_loop() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1 --duration 2");
    let run =
        here.tandem("replay log.mcap --controller tandem-kinematic:control_period_s=0.05").exits(2);
    assert!(run.error_line().contains("--mode closed"), "{}", run.stderr);
}

#[test]
fn a_scenario_with_a_wrong_key() {
    let here = Workplace::new();
    fs::write(here.path("own.toml"), "name = \"own\"\nduration = 3.0\n").unwrap();
    let run = here.tandem("record --scenario own.toml -o x.mcap").exits(2);
    let line = run.error_line();
    assert!(line.contains("own.toml") && line.contains("duration"), "{line}");
}

#[test]
fn an_output_that_is_the_input() {
    let here = Workplace::new();
    let log = here.record("log.mcap", "--scenario case1 --duration 5");
    let before = fs::read(&log).unwrap();
    let run = here.tandem("replay log.mcap -o log.mcap --force --quiet").exits(2);
    assert!(run.stderr.contains("is the input"), "{}", run.stderr);
    assert!(before == fs::read(&log).unwrap(), "the recording is untouched");
}

#[test]
fn one_recording_named_twice() {
    let here = Workplace::new();
    here.record("a.mcap", "--scenario case1 --duration 5");
    fs::copy(here.path("a.mcap"), here.path("b.mcap")).unwrap();
    let run = here.tandem("compare --a human --b tandem-kinematic a.mcap b.mcap").exits(2);
    assert!(run.error_line().contains("same recording"), "{}", run.stderr);
}

#[test]
fn a_failing_check_fails_whoever_reads_it() {
    let here = Workplace::new();
    here.record("a.mcap", "--scenario case1 --duration 5");
    here.tandem("replay a.mcap --controller paper-kinematic -o b.mcap").succeeds();
    // Nobody reads standard output: the pipe is closed before the program writes.
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("tandem"))
        .current_dir(here.path("."))
        .args(["diff", "a.mcap", "b.mcap"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(1));
}

#[test]
fn two_logs_for_one_output() {
    let here = Workplace::new();
    for folder in ["p", "q"] {
        here.record(&format!("{folder}/log.mcap"), "--scenario case1 --duration 2");
    }
    let run = here.tandem("replay p/log.mcap q/log.mcap -o out --force").exits(2);
    assert!(run.error_line().contains("both be written"), "{}", run.stderr);
}

#[test]
fn a_log_cut_before_its_first_step() {
    let here = Workplace::new();
    let log = here.record("whole.mcap", "--scenario case1-lab --duration 5");
    let bytes = fs::read(&log).unwrap();
    // The head is a few kilobytes; the first chunk of messages ends far behind.
    fs::write(here.path("cut.mcap"), &bytes[..12_000]).unwrap();
    for mode in ["open", "closed"] {
        let run = here.tandem(&format!("replay cut.mcap --mode {mode} -o out.mcap")).exits(1);
        assert!(run.stderr.contains("cut off at byte"), "{mode}: {}", run.stderr);
        assert!(!here.path("out.mcap").exists(), "no result, no file");
    }
    let run = here.tandem("diff cut.mcap whole.mcap").exits(1);
    assert!(run.error_line().contains("cut off at byte"), "{}", run.stderr);
}
