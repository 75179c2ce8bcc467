//! What goes wrong at night: Ctrl-C, a crash, a full disk. Nothing recorded until then is lost, and
//! nobody is told that all is well.

use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::program::Workplace;

/// A recording that runs at the pace of the clock, so that it can be disturbed.
fn slow_recording(here: &Workplace, log: &str) -> Child {
    slow_recording_into(here, log, log)
}

/// The same into `log`, which grows as `grows`; whatever stands there already.
fn slow_recording_into(here: &Workplace, log: &str, grows: &str) -> Child {
    let child = Command::new(assert_cmd::cargo::cargo_bin("tandem"))
        .args(["record", "--quiet", "--force", "--realtime", "--scenario", "case1-lab", "-o"])
        .arg(here.path(log))
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    // Until something has reached the disk: the head (12 kB), a second of session (27 kB), and some of the next, so
    // that the first is there whole.
    let began = Instant::now();
    let size = || std::fs::metadata(here.path(grows)).map_or(0, |file| file.len());
    while size() < 45_000 {
        assert!(began.elapsed() < Duration::from_secs(30), "nothing is written");
        sleep(Duration::from_millis(50));
    }
    child
}

fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").args([name, &child.id().to_string()]).status();
    assert!(status.expect("kill is there").success());
}

#[test]
fn ctrl_c_finishes_the_log() {
    let here = Workplace::new();
    let mut recording = slow_recording(&here, "log.mcap");
    signal(&recording, "-INT");
    assert!(recording.wait().unwrap().success(), "an interrupted recording is a whole one");
    let info = here.tandem("info --format json log.mcap").succeeds().json();
    assert_eq!(info["complete"], true);
    let replay = here.tandem("replay --format json log.mcap").succeeds().json();
    assert_eq!(replay["runs"][0]["identical_to_recorded"], true);
    here.tandem("replay --format json --mode closed log.mcap").succeeds();
}

#[test]
fn a_crash_leaves_what_was_recorded() {
    let here = Workplace::new();
    let mut recording = slow_recording(&here, "log.mcap");
    signal(&recording, "-KILL");
    assert!(!recording.wait().unwrap().success());
    let info = here.tandem("info --format json log.mcap").exits(1).json();
    assert_eq!(info["complete"], false);
    assert!(info["messages"].as_u64().unwrap() > 0, "{info}");
    let run = here.tandem("replay --format json log.mcap").exits(1);
    assert!(run.error_line().contains("cut off"), "{}", run.stderr);
    assert!(run.json()["runs"][0]["steps"].as_u64().unwrap() > 0);
}

/// A log that is recorded over stays until the new one is whole: after a crash and on a full disk the old one
/// is there, and what was recorded until then beside it.
#[test]
fn a_log_that_is_recorded_over_stays_until_the_new_one_is_whole() {
    let here = Workplace::new();
    let log = here.record("log.mcap", "--scenario case1 --duration 2");
    let old = std::fs::read(&log).unwrap();
    let beside = "log.mcap.unfinished";

    let mut recording = slow_recording_into(&here, "log.mcap", beside);
    signal(&recording, "-KILL");
    assert!(!recording.wait().unwrap().success());
    assert!(std::fs::read(&log).unwrap() == old, "after a crash the old one is there");
    let info = here.tandem(&format!("info --format json {beside}")).exits(1).json();
    assert!(info["messages"].as_u64().unwrap() > 0, "{info}");

    // No file may grow beyond some 20 to 40 kB, as the shell counts: the disk is full soon.
    let full = Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 40; exec \"$0\" \"$@\""])
        .arg(assert_cmd::cargo::cargo_bin("tandem"))
        .args(["record", "--force", "--scenario", "case1-lab", "-o"])
        .arg(&log)
        .output()
        .expect("there is a shell");
    let stderr = String::from_utf8(full.stderr).unwrap();
    assert_eq!(full.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains(beside), "{stderr}");
    assert!(std::fs::read(&log).unwrap() == old, "on a full disk the old one is there");

    let mut recording = slow_recording_into(&here, "log.mcap", beside);
    signal(&recording, "-INT");
    assert!(recording.wait().unwrap().success(), "an interrupted recording is a whole one");
    let info = here.tandem("info --format json log.mcap").succeeds().json();
    assert_eq!(info["run"]["scenario"], "case1-lab", "it is the new one");
    assert!(!here.path(beside).exists());
}

/// A closed loop into `output`, stopped once it has written something: what is left of it.
fn stopped_replay(here: &Workplace, line: &str, written: &str) -> Output {
    let child = Command::new(assert_cmd::cargo::cargo_bin("tandem"))
        .current_dir(here.path("."))
        .args(["replay", "--mode", "closed", "--threads", "1"])
        .args(line.split_whitespace())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let began = Instant::now();
    let size = || std::fs::metadata(here.path(written)).map_or(0, |file| file.len());
    while size() < 100_000 {
        assert!(began.elapsed() < Duration::from_mins(1), "nothing is written");
        sleep(Duration::from_millis(5));
    }
    signal(&child, "-INT");
    child.wait_with_output().expect("it ends")
}

/// A replay that was stopped is there as far as it went, and nobody takes it for the whole: it says so to whoever
/// reads it.
#[test]
fn ctrl_c_leaves_a_replay_that_says_so() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario random:rect:joystick:3 --duration 1200");
    let run = stopped_replay(&here, "log.mcap -o both.mcap", "both.mcap.unfinished");
    assert_eq!(run.status.code(), Some(2));
    assert!(!here.path("both.mcap.unfinished").exists());
    let info = here.tandem("info --format json both.mcap").exits(1);
    assert!(info.error_line().contains("stopped before its end"), "{}", info.stderr);
    let json = info.json();
    assert_eq!(json["complete"], false);
    let reached_s = json["duration_s"].as_f64().unwrap();
    assert!(0.0 < reached_s && reached_s < 1199.0, "{reached_s}");
    let diff = here.tandem("diff --format json both.mcap").exits(1);
    assert!(diff.error_line().contains("stopped before its end"), "{}", diff.stderr);
    let json = diff.json();
    assert!(json["fields"].as_array().unwrap().is_empty(), "{json}");
    assert_eq!((&json["same"], &json["whole"]), (&false.into(), &false.into()));
    let steps = json["compared"]["steps"].as_f64().unwrap();
    assert!((steps - 10.0 * reached_s).abs() < 3.0, "{steps} steps in {reached_s} s");
}

/// What Ctrl-C kept from being replayed is counted in one sentence, not told level by level.
#[test]
fn ctrl_c_ends_a_ladder_in_one_sentence() {
    let here = Workplace::new();
    for log in ["a", "b", "c"] {
        let long = "--scenario random:rect:joystick:3 --duration 1200 --seed";
        here.record(&format!("{log}.mcap"), &format!("{long} {}", log.len()));
    }
    let line = "a.mcap b.mcap c.mcap --human ladder -o out";
    let begun = "out/a.tandem-kinematic.playback.mcap.unfinished";
    let run = stopped_replay(&here, line, begun);
    assert_eq!(run.status.code(), Some(2));
    let [stdout, stderr] = [run.stdout, run.stderr].map(|text| String::from_utf8(text).unwrap());
    let errors: Vec<&str> = stderr.lines().filter(|line| line.starts_with("error")).collect();
    let all = "error: interrupted; 3 of 3 logs not replayed to the end, 1 of them in part";
    assert_eq!(errors, [all], "{stderr}");
    assert!(!stderr.contains("was begun"), "{stderr}");
    assert!(!stdout.contains("not replayed"), "{stdout}");
    assert!(stdout.contains("playback") && !stdout.contains("fitted"), "{stdout}");
}

/// `/dev/full` takes no byte: every write fails as on a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_that_names_the_file() {
    let here = Workplace::new();
    let run = here.tandem("record --force --scenario case1 -o /dev/full").exits(2);
    let line = run.error_line();
    assert!(line.contains("/dev/full") && line.contains("No space left"), "{line}");
}
