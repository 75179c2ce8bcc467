//! What goes wrong at night: Ctrl-C, a crash, a full disk. Nothing recorded until then is lost, and
//! nobody is told that all is well.

use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::program::Workplace;

/// A recording that runs at the pace of the clock, so that it can be disturbed.
fn slow_recording(here: &Workplace, log: &str) -> Child {
    let child = Command::new(assert_cmd::cargo::cargo_bin("tandem"))
        .args(["record", "--quiet", "--realtime", "--scenario", "case1-lab", "-o"])
        .arg(here.path(log))
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    // Until something has reached the disk: the head, and a second of session.
    let began = Instant::now();
    let size = || std::fs::metadata(here.path(log)).map_or(0, |file| file.len());
    while size() < 30_000 {
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

/// `/dev/full` takes no byte: every write fails as on a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_that_names_the_file() {
    let here = Workplace::new();
    let run = here.tandem("record --force --scenario case1 -o /dev/full").exits(2);
    let line = run.error_line();
    assert!(line.contains("/dev/full") && line.contains("No space left"), "{line}");
}
