//! A controller that hangs or panics is the failure of its own log: the others are replayed, and nothing
//! waits for it.

use std::fs;

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
                let command = format!(
                    "replay --format json --threads {threads} --mode {mode} --hang-after 1.5 \
                     --fault {fault} long.mcap short.mcap"
                );
                let run = here.tandem(&command);
                // That it ends at all says that nobody waited for the one that hangs.
                assert_eq!(run.status, 2, "{command}: {}", run.stderr);
                // The shorter log has no step that late, and says so.
                let said: Vec<&str> = run.stderr.lines().filter(|line| !line.is_empty()).collect();
                let unmet = format!(
                    "warning: short.mcap: --fault {fault} changed nothing: there was no step at or after 4 s"
                );
                assert_eq!(said.len(), 2, "{}", run.stderr);
                assert_eq!(said[0], unmet);
                assert!(said[1].starts_with("error: ") && said[1].contains(says), "{}", said[1]);
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

const BROKEN: [(&str, &str); 2] = [
    ("controller-hang=4", "the controller hung: it did not answer within 1.5 s"),
    ("controller-panic=4", "the controller panicked: as --fault controller-panic=4 has it"),
];

/// In a comparison it fails its log, with parameters swapped it is left out of the swap and named, and a
/// self-test of it ends with the reason.
#[test]
fn wherever_a_controller_breaks_its_log_fails_and_says_so() {
    let here = Workplace::new();
    here.record("long.mcap", "--scenario case1 --duration 6");
    here.record("short.mcap", "--scenario case1 --duration 3");
    for (fault, says) in BROKEN {
        let both = "--a tandem-kinematic --b tandem-kinematic:gamma3=2.5 --attribute --format json";
        let run = here.tandem(&format!(
            "compare {both} --hang-after 1.5 --fault {fault} long.mcap short.mcap"
        ));
        let json = run.json();
        assert_eq!(run.status, 1, "{}", run.stderr);
        assert_eq!(json["faults"], serde_json::json!([fault]));
        let (long, short) = (&json["logs"][0], &json["logs"][1]);
        assert!(long["error"].as_str().unwrap().contains(says), "{long}");
        assert_eq!(short["status"], "ok", "{short}");
        assert!(run.stderr.contains("left out of a swap: long.mcap: "), "{}", run.stderr);
        // What is swapped is the one parameter, over the log that could be run.
        assert_eq!(json["swaps"][0]["key"], "gamma3", "{}", json["swaps"]);
        let run = here.tandem(&format!(
            "compare --self-test --alarms 1 --a tandem-kinematic --hang-after 1.5 --fault {fault} \
             short.mcap long.mcap"
        ));
        assert_eq!(run.status, 2, "{}", run.stderr);
        let line = run.error_line();
        assert!(line.contains("long.mcap") && line.contains(says), "{line}");
    }
}

/// A fixture whose controller breaks is a problem of its own; the others are checked.
#[test]
fn a_fixture_whose_controller_breaks_has_failed() {
    let here = Workplace::new();
    for (name, faults) in
        [("sound", ""), ("broken", "faults = [\"sonar-dead=3\"]\nfault_seed = 2\n")]
    {
        let folder = here.path("fixtures").join(name);
        fs::create_dir_all(&folder).unwrap();
        here.record(
            &format!("fixtures/{name}/session.mcap"),
            "--scenario random:rect:goal:1 --duration 6",
        );
        let toml = format!(
            "summary = \"a room\"\nmade_by = \"this test\"\ncontroller = \"tandem-kinematic\"\n\
             mode = \"closed\"\n{faults}"
        );
        fs::write(folder.join("fixture.toml"), toml).unwrap();
    }
    // A fixture may have faults; they are part of what it gives.
    here.tandem("approve --reason test fixtures").succeeds();
    here.tandem("check fixtures").succeeds();
    let broken = here.path("fixtures/broken/fixture.toml");
    let toml = fs::read_to_string(&broken).unwrap();
    fs::write(&broken, toml.replace("sonar-dead=3", "sonar-dead=4")).unwrap();
    here.tandem("check fixtures").exits(1);
    for (fault, says) in BROKEN {
        fs::write(&broken, toml.replace("sonar-dead=3", fault)).unwrap();
        let run = here.tandem("check fixtures --format json --hang-after 1.5").exits(1);
        let json = run.json();
        let problems = json["problems"].as_array().unwrap();
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert!(problems[0]["what"].as_str().unwrap().contains(says), "{problems:?}");
        assert!(problems[0]["at"].as_str().unwrap().ends_with("broken"), "{problems:?}");
    }
    fs::write(&broken, toml.replace("sonar-dead=3", "sonar-dead=99")).unwrap();
    here.tandem("check fixtures").exits(2);
}

/// What could never say anything is refused before anything is run.
#[test]
fn faults_that_make_no_sense_are_refused() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1 --duration 2");
    for (line, says) in [
        ("replay --fault joystick-freeze=10-5 log.mcap", "ends before it begins"),
        ("replay --fault latency=0.1 --fault latency=0.1 log.mcap", "already"),
        (
            "compare --a recorded --b tandem-kinematic --fault sonar-dead=3 log.mcap",
            "`recorded` is not",
        ),
        (
            "compare --a tandem-kinematic --b tandem-dynamic --attribute log.mcap",
            "different laws (kinematic, dynamic)",
        ),
    ] {
        let run = here.tandem(line).exits(2);
        assert!(run.stderr.contains(says), "{line}: {}", run.stderr);
        assert!(run.stdout.is_empty(), "{line}: {}", run.stdout);
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
