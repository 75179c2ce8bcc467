//! A controller that hangs or panics is the failure of its own log: the others are replayed, and nothing
//! waits for it.

use std::time::{Duration, Instant};

use crate::program::Workplace;

#[test]
fn a_controller_that_hangs_or_panics_fails_its_own_logs() {
    let here = Workplace::new();
    here.record("long.mcap", "--scenario case1 --duration 6");
    here.record("short.mcap", "--scenario case1 --duration 3");
    for (fault, says) in [
        ("controller-hang=4", "the controller hung: it did not answer within 1.5 s"),
        ("controller-panic=4", "the controller panicked: as --fault controller-panic=4 has it"),
    ] {
        for mode in ["open", "closed"] {
            for threads in [1, 2] {
                let began = Instant::now();
                let command = format!(
                    "replay --format json --threads {threads} --mode {mode} --hang-after 1.5 \
                     --fault {fault} long.mcap short.mcap"
                );
                let run = here.tandem(&command);
                assert!(began.elapsed() < Duration::from_mins(1), "{command}");
                assert_eq!(run.status, 2, "{command}: {}", run.stderr);
                assert!(run.error_line().contains(says), "{}", run.stderr);
                let result = run.json();
                let (long, short) = (&result["runs"][0], &result["runs"][1]);
                assert!(long["error"].as_str().unwrap().contains(says), "{long}");
                assert_eq!(long["output_hash"], serde_json::Value::Null);
                // The other log ends before the controller breaks: it is what it always is.
                assert_eq!(short["identical_to_recorded"], true, "{short}");
                assert_eq!(short["error"], serde_json::Value::Null);
            }
        }
    }
}

/// Patience that makes no sense is refused.
#[test]
fn patience_is_a_positive_number() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1 --duration 2");
    for patience in ["0", "-1", "soon", "1e300"] {
        here.tandem(&format!("replay --hang-after {patience} log.mcap")).exits(2);
    }
}

#[test]
fn what_a_broken_controller_leaves_behind_is_not_taken_for_a_run() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1 --duration 6");
    for fault in ["controller-hang=2", "controller-panic=2"] {
        let command = format!("replay log.mcap --hang-after 1.5 --fault {fault} -o out.mcap");
        assert_eq!(here.tandem(&command).status, 2, "{command}");
        assert!(!here.path("out.mcap").exists(), "{fault}");
    }
    here.tandem("replay log.mcap -o out.mcap").succeeds();
    assert!(!here.path("out.mcap.unfinished").exists());
}
