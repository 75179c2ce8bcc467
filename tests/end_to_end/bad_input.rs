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

/// What a replay of a cut log writes says that it is of a part; what is asked of the part that can be read is
/// whole, and goes into a comparison, which the cut log does not.
#[test]
fn a_replay_of_a_cut_log_does_not_pass_for_whole() {
    let here = Workplace::new();
    let log = here.record("whole.mcap", "--scenario case1-lab --duration 6");
    let bytes = fs::read(&log).unwrap();
    fs::write(here.path("cut.mcap"), &bytes[..bytes.len() * 2 / 3]).unwrap();
    for mode in ["open", "closed"] {
        let replay = format!("replay cut.mcap --format json --force --mode {mode} -o out.mcap");
        let json = here.tandem(&replay).exits(1).json();
        let damage = json["runs"][0]["damage"].as_str().unwrap();
        let info = here.tandem("info out.mcap --format json").exits(1);
        assert!(info.error_line().contains("made from a log that is cut off"), "{}", info.stderr);
        assert_eq!(info.json()["complete"], false, "{mode}");

        // The way out that is told is one.
        let (_, way_out) = damage.split_once("`tandem ").expect("a command");
        let (_, to_s) = way_out.split_once("--to ").unwrap();
        let to_s: f64 = to_s.split_once(' ').unwrap().0.parse().unwrap();
        let json = here.tandem(&format!("{replay} --to {to_s}")).succeeds().json();
        assert_eq!(json["runs"][0]["damage"], serde_json::Value::Null);
        let info = here.tandem("info out.mcap --format json").succeeds().json();
        assert!((info["duration_s"].as_f64().unwrap() - to_s).abs() < 0.1, "{info}");
    }
    let compare = "compare --a human --b paper-kinematic --format json";
    let cut = here.tandem(&format!("{compare} cut.mcap")).exits(1);
    assert_eq!(cut.json()["verdict"], "failed");
    assert_eq!(cut.error_line().matches("cut off at byte").count(), 1, "{}", cut.stderr);
    assert!(cut.stderr.contains("`tandem replay LOG --to "), "names the way out: {}", cut.stderr);
    let part = here.tandem(&format!("{compare} out.mcap")).json();
    assert_eq!(part["logs"][0]["status"], "ok", "{part}");
}

/// A cut log is measured and drawn as far as it goes, which is said to everybody.
#[test]
fn what_stands_before_a_cut_is_measured_and_drawn() {
    let here = Workplace::new();
    let log = here.record("whole.mcap", "--scenario case1-lab --duration 6");
    let bytes = fs::read(&log).unwrap();
    fs::write(here.path("cut.mcap"), &bytes[..bytes.len() * 2 / 3]).unwrap();
    fs::write(here.path("stub.mcap"), &bytes[..12_000]).unwrap();

    let run = here.tandem("metrics whole.mcap cut.mcap --format json").exits(1);
    assert!(run.error_line().contains("cut.mcap: the log is cut off at byte"), "{}", run.stderr);
    let [whole, cut] = [0, 1].map(|i| run.json()["runs"][i].clone());
    assert_eq!((&whole["whole"], &whole["damage"]), (&true.into(), &serde_json::Value::Null));
    assert_eq!(cut["whole"], false);
    assert!(cut["damage"].as_str().unwrap().contains("cut off at byte"), "{cut}");
    let share = |run: &serde_json::Value| run["metrics"]["human_share"]["value"].as_f64();
    assert!(share(&cut).is_some() && share(&whole).is_some(), "{cut}");
    let text = here.tandem("metrics whole.mcap cut.mcap").exits(1).stdout;
    assert!(text.contains("cut.mcap (part)") && !text.contains("whole.mcap (part)"), "{text}");

    let run = here.tandem("plot cut.mcap -o cut.svg --format json").exits(1);
    assert!(run.error_line().contains("cut off at byte"), "{}", run.stderr);
    let drawn = run.json();
    assert_eq!(drawn["whole"], false);
    assert!(drawn["damage"].as_str().unwrap().contains("cut off at byte"), "{drawn}");
    let duration_s = drawn["duration_s"].as_f64().unwrap();
    assert!(0.5 < duration_s && duration_s < 5.5, "{duration_s}");
    assert!(fs::read_to_string(here.path("cut.svg")).unwrap().contains("only a part"));
    let drawn = here.tandem("plot whole.mcap -o whole.svg --format json").succeeds().json();
    assert_eq!(drawn["whole"], true);
    assert!(!fs::read_to_string(here.path("whole.svg")).unwrap().contains("only a part"));

    // Where there is nothing to measure or draw, the reason is what was wrong with the log.
    for command in ["metrics stub.mcap", "plot stub.mcap -o stub.svg"] {
        let run = here.tandem(command).exits(1);
        assert!(run.error_line().contains("cut off at byte"), "{command}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{command}");
    }
    assert!(!here.path("stub.svg").exists());
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
        ("check nowhere", "in a clone of the repository"),
        ("check .", "session.mcap and fixture.toml"),
        (
            "replay log.mcap --from -5",
            "'--from <T>': expected seconds from the start of the log, 0 or",
        ),
        (
            "replay log.mcap --to -0.5",
            "'--to <T>': expected seconds from the start of the log, 0 or",
        ),
        ("replay log.mcap --hang-after -1", "more than 0 seconds"),
        ("record --seed -1 -o x.mcap", "invalid digit"),
        ("replay log.mcap --threads -1", "-1 is not in 1..=65535"),
        ("replay log.mcap --fault latency=1e9", "the value of latency is seconds, from 0 to 10"),
    ] {
        let run = here.tandem(line).exits(2);
        assert!(run.error_line().contains(what), "`{line}` should speak of {what}: {}", run.stderr);
        assert!(!here.path("x.mcap").exists(), "`{line}` leaves nothing behind");
    }
}

/// Options that would do nothing are refused with the way out, not passed over.
#[test]
fn options_without_effect() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1 --duration 2");
    let compare = "compare --a human --b tandem-kinematic log.mcap";
    for (line, option, way_out) in [
        ("replay log.mcap --human fitted".to_owned(), "--human", "--mode closed"),
        ("replay log.mcap --plant identified".to_owned(), "--plant", "--mode closed"),
        ("replay log.mcap --world map".to_owned(), "--world", "--mode closed"),
        ("replay log.mcap --floor".to_owned(), "--floor", "--mode closed"),
        ("replay log.mcap --fault-seed 3".to_owned(), "--fault-seed", "--fault"),
        ("replay log.mcap --mode closed --fault-seed 0".to_owned(), "--fault-seed", "--fault"),
        (format!("{compare} --mode open --human ladder"), "--human", "--mode closed"),
        (format!("{compare} --mode open --plant identified"), "--plant", "--mode closed"),
        (format!("{compare} --fault-seed 1"), "--fault-seed", "--fault"),
    ] {
        let run = here.tandem(&line).exits(2);
        let error = run.error_line();
        assert!(error.contains(option) && error.contains(way_out), "`{line}`: {error}");
    }
    let run = here.tandem(&format!("{compare} --ab 1")).exits(2);
    assert!(run.stderr.contains("--report"), "{}", run.stderr);
    for line in
        ["--floor --plant identified --human fitted", "--world map --fault-seed 3 --fault jitter=0"]
    {
        here.record("sonar.mcap", "--scenario case1-lab --duration 5 --force");
        here.tandem(&format!("replay sonar.mcap --mode closed {line}")).succeeds();
    }
}

/// A fault that meets nothing is told, where the result alone would look as if nothing mattered.
#[test]
fn faults_that_meet_nothing() {
    let here = Workplace::new();
    here.record("exact.mcap", "--scenario case1 --duration 3");
    here.record("sonar.mcap", "--scenario case1-lab --duration 3");
    let says = "--fault sonar-dead=3 changed nothing: there was no reading of sonar 3";
    for mode in ["open", "closed", "closed --human ladder"] {
        let replay = format!("replay --mode {mode} --fault sonar-dead=3 exact.mcap sonar.mcap");
        let run = here.tandem(&format!("{replay} --format json")).succeeds();
        let warnings: Vec<&str> = run.stderr.lines().filter(|l| l.contains("warning")).collect();
        assert_eq!(warnings, [format!("warning: exact.mcap: {says}")], "{}", run.stderr);
        for run in run.json()["runs"].as_array().unwrap() {
            let unmet = run["unmet_faults"].as_array().unwrap();
            assert_eq!(unmet.len(), usize::from(run["log"] == "exact.mcap"), "{run}");
        }
        let text = here.tandem(&replay).succeeds().stdout;
        assert!(text.contains(&format!("fault        ! {says}")), "{text}");
    }
    let compare =
        "compare --a human --b tandem-kinematic --fault sonar-dead=3 exact.mcap sonar.mcap";
    let run = here.tandem(&format!("{compare} --format json"));
    assert!(run.stderr.contains(&format!("warning: {says} in 1 of 2 logs")), "{}", run.stderr);
    assert_eq!(run.json()["logs"][0]["unmet_faults"], serde_json::json!([says]));
    assert!(run.json()["logs"][1]["unmet_faults"].is_null());
    // A controller that is to break down after the end does not; one that is to within it does.
    let says = "--fault controller-panic=100 changed nothing: there was no step at or after 100 s";
    for mode in ["open", "closed"] {
        let replay = format!("replay --mode {mode} exact.mcap --format json --fault");
        let run = here.tandem(&format!("{replay} controller-panic=100")).succeeds();
        assert!(run.stderr.contains(&format!("warning: exact.mcap: {says}")), "{}", run.stderr);
        assert_eq!(run.json()["runs"][0]["unmet_faults"], serde_json::json!([says]));
        let run = here.tandem(&format!("{replay} controller-panic=2"));
        assert_eq!(run.status, 2, "{}", run.stderr);
        assert!(run.stderr.contains("the controller panicked"), "{}", run.stderr);
        assert!(!run.stderr.contains("changed nothing"), "{}", run.stderr);
    }
    let run = here.tandem("replay exact.mcap --fault sonar-dead=20").exits(2);
    assert!(run.stderr.contains("from 0 to 15"), "{}", run.stderr);
}

#[test]
fn an_end_beyond_the_end() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1 --duration 4");
    for mode in ["open", "closed"] {
        let replay = format!("replay --mode {mode} log.mcap");
        let run = here.tandem(&format!("{replay} --to 9")).succeeds();
        let says = "warning: log.mcap: --to 9 is beyond its end at 4.00 s";
        assert!(run.stderr.contains(says), "{mode}: {}", run.stderr);
        for to in ["4", "4.05", "2.5"] {
            let run = here.tandem(&format!("{replay} --to {to}")).succeeds();
            assert!(!run.stderr.contains("warning"), "{mode} {to}: {}", run.stderr);
        }
    }
}

/// What a replay of a part wrote begins in the middle of a session: that is told when it is replayed itself,
/// not of a part of a whole log.
#[test]
fn a_log_of_a_part() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1-lab --duration 4");
    let part = here.tandem("replay log.mcap --from 2 -o part.mcap").succeeds();
    assert!(!part.stderr.contains("middle of its session"), "{}", part.stderr);
    for mode in ["open", "closed"] {
        let run = here.tandem(&format!("replay part.mcap --mode {mode} --format json"));
        let says = "warning: part.mcap: the log begins in the middle of its session, at 2.00 s";
        assert!(run.stderr.contains(says), "{mode}: {}", run.stderr);
        assert!(run.stdout.contains("\"begins_late_s\": 2.0"), "{mode}: {}", run.stdout);
    }
    // Sessions start at 12:00; messages between two steps come before the part's first one.
    let info = |log: &str| here.tandem(&format!("info {log} --format json")).succeeds().json();
    let [whole, part] = ["log.mcap", "part.mcap"].map(info);
    assert_eq!(whole["begins_late_s"], serde_json::Value::Null);
    let begins_s = part["begins_late_s"].as_f64().unwrap();
    assert!((begins_s - 2.0).abs() < 0.1, "{begins_s}");
    let seconds = |info: &serde_json::Value| {
        let start = info["start"].as_str().unwrap();
        start[start.len() - 3..start.len() - 1].parse::<u32>().unwrap()
    };
    assert_eq!(seconds(&part) - seconds(&whole), 2);
    let text = here.tandem("info part.mcap").succeeds().stdout;
    assert!(text.contains("begins in the middle of its session, at 2.0"), "{text}");
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
    // A setting in a scenario's name: what is wrong is said once.
    let run = here.tandem("record --scenario random:rect:goal:1:slip=7 -o x.mcap").exits(2);
    let line = run.error_line();
    assert_eq!(line.matches("plant.slip = 7").count(), 1, "{line}");
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

/// A mistyped folder is not made; one that is named as a folder is.
#[test]
fn an_output_in_a_folder_that_is_not_there() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1-lab --duration 3");
    for line in [
        "record --scenario case1 --duration 2 -o fixturs/x.mcap",
        "replay log.mcap -o fixturs/x.mcap",
        "plot log.mcap -o fixturs/x.svg",
        "map log.mcap -o fixturs/x.toml",
    ] {
        let run = here.tandem(line).exits(2);
        let error = run.error_line();
        assert!(error.contains("there is no folder fixturs; make it"), "`{line}`: {error}");
        assert!(!here.path("fixturs").exists(), "`{line}`");
    }
    fs::copy(here.path("log.mcap"), here.path("other.mcap")).unwrap();
    here.tandem("replay log.mcap other.mcap -o new/out").succeeds();
    assert!(here.path("new/out/other.tandem-kinematic.mcap").is_file());
    here.tandem("replay log.mcap -o one/").succeeds();
    assert!(here.path("one/log.tandem-kinematic.mcap").is_file());
    let compare = "compare --a paper-kinematic --b paper-kinematic log.mcap --report new/report";
    here.tandem(compare).succeeds();
    assert!(here.path("new/report/report.html").is_file());
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
        fs::create_dir(here.path(folder)).unwrap();
        here.record(&format!("{folder}/log.mcap"), "--scenario case1 --duration 2");
    }
    let run = here.tandem("replay p/log.mcap q/log.mcap -o out --force").exits(2);
    assert!(run.error_line().contains("both be written"), "{}", run.stderr);
    // The name is the one that it would be.
    assert!(run.stderr.contains("out/log.tandem-kinematic.mcap"), "{}", run.stderr);
    let run = here.tandem("replay p/log.mcap p/log.mcap -o out").exits(2);
    assert!(run.error_line().contains("p/log.mcap is named twice"), "{}", run.stderr);
    fs::rename(here.path("q/log.mcap"), here.path("other.mcap")).unwrap();
    for several in ["p/log.mcap other.mcap", "other.mcap --mode closed --human ladder"] {
        let run = here.tandem(&format!("replay {several} -o both.mcap")).exits(2);
        let line = run.error_line();
        assert!(line.contains("both.mcap: several results") && line.contains("-o both"), "{line}");
        assert!(!here.path("both.mcap").exists());
    }
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
    assert_eq!(run.stdout, "", "there is nothing to tell a person but the error");
    // A program that reads the result gets one, whichever run is cut.
    for (runs, cut) in [
        ("cut.mcap whole.mcap", &["cut.mcap"][..]),
        ("whole.mcap cut.mcap", &["cut.mcap"]),
        ("cut.mcap cut.mcap", &["cut.mcap", "cut.mcap"]),
    ] {
        let run = here.tandem(&format!("diff {runs} --format json")).exits(1);
        assert!(run.error_line().contains("cut off at byte"), "{runs}: {}", run.stderr);
        let result = run.json();
        for word in ["same", "whole", "same_behaviour"] {
            assert_eq!(result[word], false, "{runs}: {word}");
        }
        let none = serde_json::json!({ "steps": 0, "messages": 0, "differing": 0 });
        assert_eq!(result["compared"], none, "{runs}");
        assert_eq!(result["fields"], serde_json::json!([]), "{runs}");
        assert_eq!(result.get("first_cause"), Some(&serde_json::Value::Null), "{runs}");
        let damage = result["damage"].as_array().unwrap();
        let named: Vec<_> = damage.iter().map(|damage| damage["run"].as_str().unwrap()).collect();
        assert_eq!(named, cut, "{runs}");
        for damage in damage {
            assert!(damage["what"].as_str().unwrap().contains("cut off at byte"), "{damage}");
        }
    }
}
