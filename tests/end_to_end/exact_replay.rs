//! Replay with the controller that recorded a log gives the recording back, bit for bit.
//!
//! Open loop shows that a step depends on nothing but what the log holds; closed loop shows that
//! recording and replaying share one loop, one world and one set of sensors.

use crate::program::Workplace;

const SESSIONS: [&str; 9] = [
    "--scenario case1",
    "--scenario case1 --controller paper-kinematic --seed 3",
    "--scenario case2 --controller tandem-kinematic:margin=always",
    "--scenario case3 --duration 40",
    "--scenario case1-lab --duration 20 --seed 5",
    "--scenario random:rect:goal:1 --controller human",
    "--scenario random:slant:joystick:2 --seed 9",
    "--scenario random:disc:goal:3 --controller paper-kinematic",
    "--scenario random:disc:joystick:4 --sensors exact",
];

#[test]
fn the_recording_comes_back() {
    let here = Workplace::new();
    let mut logs = String::new();
    for (index, session) in SESSIONS.iter().enumerate() {
        let name = format!("{index}.mcap");
        here.record(&name, session);
        logs.extend([" ", &name]);
    }
    for mode in ["open", "closed"] {
        let result = here.tandem(&format!("replay --format json --mode {mode} {logs}")).succeeds();
        let runs = result.json()["runs"].as_array().unwrap().clone();
        assert_eq!(runs.len(), SESSIONS.len());
        for (run, session) in runs.iter().zip(SESSIONS) {
            assert_eq!(run["identical_to_recorded"], true, "{mode} {session}: {run}");
            assert_eq!(run["max_deviation"], serde_json::Value::Null, "{mode} {session}");
            assert!(run["steps"].as_u64().unwrap() > 10, "{mode} {session}");
        }
        // Twice the same, whatever the number of threads.
        let again = here
            .tandem(&format!("replay --format json --threads 1 --mode {mode} {logs}"))
            .succeeds();
        let hashes = |runs: &serde_json::Value| {
            let runs = runs["runs"].as_array().unwrap();
            runs.iter().map(|run| run["output_hash"].clone()).collect::<Vec<_>>()
        };
        assert_eq!(hashes(&result.json()), hashes(&again.json()));
    }
}

#[test]
fn a_recording_is_made_again_by_the_same_command() {
    let here = Workplace::new();
    let options = "--scenario case1-lab --seed 7 --duration 10";
    let [a, b] =
        ["a.mcap", "b.mcap"].map(|name| std::fs::read(here.record(name, options)).unwrap());
    assert!(a == b, "the same command makes the same bytes");
    let other = here.record("c.mcap", "--scenario case1-lab --seed 8 --duration 10");
    assert!(a != std::fs::read(other).unwrap(), "another seed makes another session");
}

#[test]
fn another_controller_is_not_identical() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1");
    let run = here.tandem("replay --format json --controller paper-kinematic log.mcap").succeeds();
    let run = &run.json()["runs"][0];
    assert_eq!(run["identical_to_recorded"], false);
    assert!(run["max_deviation"].as_f64().unwrap() > 0.0);
    // What differs first is what a diff of the two finds, in the same words.
    let replay = "replay --controller paper-kinematic log.mcap";
    here.tandem(&format!("{replay} -o both.mcap")).succeeds();
    let cause = &here.tandem("diff both.mcap --format json").exits(1).json()["first_cause"];
    assert_eq!(&run["first_cause"], cause);
    let text = here.tandem(replay).succeeds().stdout;
    assert!(text.contains(cause["reason"].as_str().unwrap()), "{text}");
    let unit = run["max_deviation_unit"].as_str().unwrap();
    let field = run["max_deviation_field"].as_str().unwrap();
    assert!(!unit.is_empty() && text.contains(&format!("most       {field}, by ")), "{text}");
    assert!(text.contains(&format!(" {unit} at ")), "{text}");
}

#[test]
fn a_replay_written_to_a_log_is_a_log() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario random:rect:joystick:6");
    here.tandem("replay --mode closed --controller paper-kinematic log.mcap -o other.mcap")
        .succeeds();
    // It says what made it, and replays identically in its turn.
    let info = here.tandem("info --format json other.mcap").succeeds().json();
    assert_eq!(info["run"]["controller"], "paper-kinematic");
    assert_eq!(info["run"]["source_hash"].as_str().unwrap().len(), 64);
    let again = here.tandem("replay --format json --mode closed other.mcap").succeeds().json();
    assert_eq!(again["runs"][0]["identical_to_recorded"], true);
    // Nothing is overwritten unasked.
    here.tandem("replay log.mcap -o other.mcap").exits(2);
    here.tandem("replay log.mcap -o other.mcap --force").succeeds();
}

/// Under the recording controller every model of the person is the recording, on every fixture; and
/// the ladder runs them all, with nothing between them.
#[test]
fn every_level_of_the_ladder_is_the_recording() {
    let here = Workplace::new();
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let mut logs = Vec::new();
    for entry in std::fs::read_dir(&folder).unwrap() {
        let log = entry.unwrap().path().join("session.mcap");
        if log.is_file() {
            logs.push(log.display().to_string());
        }
    }
    assert!(logs.len() >= 7, "{logs:?}");
    let command = format!("replay --format json --mode closed --human ladder {}", logs.join(" "));
    let result = here.tandem(&command).succeeds().json();
    let runs = result["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 4 * logs.len());
    for run in runs {
        assert_eq!(run["identical_to_recorded"], true, "{run}");
        assert_eq!(run["furthest"], 0.0, "{run}");
        assert!(run["horizon_s"].as_f64().unwrap() > 1.0, "{run}");
        assert_eq!(run["horizon"]["state_s"], serde_json::Value::Null);
    }
    let ladder = result["ladder"].as_array().unwrap();
    assert_eq!(ladder.len(), logs.len());
    assert!(ladder.iter().all(|log| log["spread_m"] == 0.0));
}

/// Under another controller the levels part, the horizon says when, and logs come ranked by spread.
#[test]
fn the_ladder_spreads_under_another_controller() {
    let here = Workplace::new();
    for (name, person) in [("a.mcap", "tracker"), ("b.mcap", "joystick"), ("c.mcap", "flowing")] {
        here.record(name, &format!("--scenario random:slant:{person}:6 --controller human"));
    }
    let command = "replay --format json --mode closed --human ladder \
                   --controller tandem-kinematic a.mcap b.mcap c.mcap -o out";
    let result = here.tandem(command).succeeds().json();
    let runs = result["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 12);
    for run in runs {
        assert!(std::path::Path::new(&here.path(run["output"].as_str().unwrap())).is_file());
    }
    let ladder = result["ladder"].as_array().unwrap();
    let spread = |i: usize| ladder[i]["spread_m"].as_f64().unwrap();
    assert!(spread(0) >= spread(1) && spread(1) >= spread(2));
    let scripted = ladder.iter().find(|log| log["log"] == "b.mcap").unwrap();
    assert_eq!(scripted["person"], "scripted");
    let share = &scripted["metrics"]["human_share"];
    assert_eq!(share["levels"]["intent"], share["levels"]["playback"]);
    assert_eq!(share["levels"]["fitted"], share["estimate"]);
}

/// A part of a log is what the whole gives there, and continues the recording in closed loop.
#[test]
fn a_part_of_a_log() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1-lab --duration 12");
    for mode in ["open", "closed"] {
        let command = format!("replay --format json --mode {mode} --from 4 --to 9 log.mcap");
        let run = here.tandem(&command).succeeds().json()["runs"][0].clone();
        assert_eq!(run["identical_to_recorded"], true, "{run}");
        assert_eq!(run["warm_up"], "exact");
        // Both ends included: 4.0, 4.1, …, 9.0 s.
        assert_eq!(run["steps"], 51);
    }
    here.tandem("replay --from 9 --to 4 log.mcap").exits(2);
    here.tandem("replay --from -1 log.mcap").exits(2);
    let late = here.tandem("replay --from 99 log.mcap").exits(2);
    assert!(
        late.stderr.contains("none in the part that was asked for (--from, --to)"),
        "{}",
        late.stderr
    );
    // The horizon is told as everything is: from the start of the log.
    let part = "replay --mode closed --controller human --from 8 --to 12 log.mcap";
    let told = here.tandem(&format!("{part} --format json")).succeeds().json();
    let run = &told["runs"][0];
    let horizon_s = run["horizon_s"].as_f64().unwrap();
    assert!(horizon_s > 8.0 && horizon_s < 12.0, "{run}");
    let words = here.tandem(part).succeeds().stdout;
    assert!(words.contains(&format!("{horizon_s:.2} of 8.00 to 12.00 s")), "{words}");
}

/// The plant is identified from the log, and the floor of an exact replay is zero.
#[test]
fn plant_and_floor() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario random:rect:joystick:3 --controller human");
    let command = "replay --format json --mode closed --human fitted --floor log.mcap";
    let run = here.tandem(command).succeeds().json()["runs"][0].clone();
    let floor = run["floor"].as_object().unwrap();
    assert!(floor.contains_key("human_share") && floor.values().all(|gap| gap == 0.0), "{run}");
    let words = here.tandem("replay --mode closed --floor log.mcap").succeeds().stdout;
    assert!(words.contains("floor        0 in every metric that a verdict goes by"), "{words}");
    let command = "replay --format json --mode closed --plant identified log.mcap";
    let run = here.tandem(command).succeeds().json()["runs"][0].clone();
    // Random rooms have a plant that slips by 3 %, and nothing else.
    let slip = run["plant"]["slip"]["value"].as_f64().unwrap();
    assert!((slip - 0.03).abs() < 0.01, "{run}");
    assert!(run["plant"]["delay_s"]["value"].as_f64().unwrap() < 0.011);
    assert_eq!(run["plant"]["accel_mps2"]["value"], serde_json::Value::Null);
}

/// Faults are refused by name, and repeat with their seed.
#[test]
fn faults_are_named_and_seeded() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1-lab --duration 8");
    let hash = |options: &str| {
        let run = here.tandem(&format!("replay --format json --mode closed {options} log.mcap"));
        run.succeeds().json()["runs"][0]["output_hash"].as_str().unwrap().to_owned()
    };
    let faulty = "--fault sonar-dropout=0.4 --fault latency=0.02";
    assert_eq!(hash(faulty), hash(faulty));
    assert_ne!(hash(faulty), hash(""));
    assert_ne!(hash(faulty), hash(&format!("{faulty} --fault-seed 1")));
    here.tandem("replay --fault sonar-dead=17 log.mcap").exits(2);
}
