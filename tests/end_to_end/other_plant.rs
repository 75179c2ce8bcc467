//! A log that was recorded with another plant than it claims: a closed loop says so, with the numbers and the way
//! out; a log whose claim holds is left alone.

use std::fs;

use schemas::log::{LogReader, WriterOptions, create};
use schemas::{Header, Plant, Scenario};

use crate::program::Workplace;

/// `late.mcap`, whose robot answers 0.2 s late and claims to answer at once; `sound.mcap`, which is what it
/// claims to be.
fn record(here: &Workplace) {
    for (name, driven) in [("late", 0.2), ("sound", 0.0)] {
        let mut scenario = simulator::scenario("random:rect:joystick:3").unwrap();
        scenario.plant = Plant { actuator_delay_s: driven, ..Plant::default() };
        name.clone_into(&mut scenario.name);
        fs::write(here.path(&format!("{name}.toml")), scenario.to_toml()).unwrap();
        let recorded =
            here.record("driven.mcap", &format!("--force --scenario {name}.toml --duration 12"));
        let mut log = LogReader::open(&recorded).unwrap();
        let scenario = Scenario { plant: Plant::default(), ..log.header().scenario.clone() };
        let header = Header { scenario, ..log.header().clone() };
        let path = here.path(&format!("{name}.mcap"));
        let mut claiming = create(path, &header, &WriterOptions::offline()).unwrap();
        while let Some(event) = log.next_event().unwrap() {
            claiming.write(&event).unwrap();
        }
        claiming.finish().unwrap();
    }
}

#[test]
fn a_plant_that_the_log_contradicts_is_told_loudly() {
    let here = Workplace::new();
    record(&here);
    let run = here.tandem("replay --mode closed late.mcap sound.mcap --format json").succeeds();
    let json = run.json();
    let (late, sound) = (&json["runs"][0]["plant_doubt"], &json["runs"][1]["plant_doubt"]);
    assert!(sound.is_null(), "{sound}");
    assert_eq!(late["claimed"]["actuator_delay_s"], 0.0);
    let delay = &late["found"]["delay_s"];
    assert!((delay["value"].as_f64().unwrap() - 0.2).abs() < 0.03, "{delay}");
    let rest = |which: &str| late["forwards"][which].as_f64().unwrap();
    assert!(rest("claimed") > 4.0 * rest("found"), "{late}");
    let warnings: Vec<&str> = run.stderr.lines().filter(|l| l.starts_with("warning: ")).collect();
    assert_eq!(warnings.len(), 1, "{}", run.stderr);
    assert!(warnings[0].contains("late.mcap") && warnings[0].contains("--plant identified"));
    let run = here.tandem("replay --mode closed late.mcap").succeeds();
    let text = run.stdout;
    assert!(text.contains("plant        ! the log contradicts the plant that it claims"), "{text}");
    // The numbers stand with the result, and there alone.
    assert!(text.contains("delay 0.2") && !run.stderr.contains("delay"), "{}", run.stderr);
    // The way out leads out. An open loop drives nothing; that the controller, which goes by the claimed plant
    // too, says something else than it did is another matter, and the exit status tells it.
    for (way, status) in [("--mode closed --plant identified", 0), ("--mode open", 1)] {
        let run = here.tandem(&format!("replay {way} late.mcap --format json")).exits(status);
        assert!(run.json()["runs"][0]["plant_doubt"].is_null(), "{}", run.stdout);
        assert!(!run.stderr.contains("warning"), "{}", run.stderr);
    }
}

/// Where nothing can be identified, that is said with the reason; a comparison does not say of such a log that it
/// holds to its plant.
#[test]
fn a_plant_that_does_not_show() {
    let here = Workplace::new();
    here.record("short.mcap", "--scenario case1-lab --duration 0.5");
    let replay = "replay --mode closed --plant identified short.mcap";
    let text = here.tandem(replay).succeeds().stdout;
    let says = "plant        as claimed: nothing could be identified, since the log is too short";
    assert!(text.contains(says), "{text}");
    let json = here.tandem(&format!("{replay} --format json")).succeeds().json();
    assert_eq!(json["runs"][0]["plant"]["untold"], "the log is too short");
    let both = "compare --a tandem-kinematic --b tandem-kinematic:gamma3=2.1 short.mcap";
    here.tandem(&format!("{both} --report out --ab 0"));
    let text = fs::read_to_string(here.path("out/report.html")).unwrap();
    let says =
        "as claimed, and untested: no log says anything of it (short.mcap: the log is too short)";
    assert!(text.contains(says), "{text}");
}

#[test]
fn a_comparison_says_so_in_every_form() {
    let here = Workplace::new();
    record(&here);
    let both = "compare --a paper-kinematic --b tandem-kinematic";
    let run = here.tandem(&format!("{both} late.mcap sound.mcap --report out --ab 0"));
    let says = "in 1 of 2 logs the robot was another one than both arms drove: late.mcap";
    assert!(run.stderr.contains(says), "{}", run.stderr);
    assert!(run.stdout.contains(says), "{}", run.stdout);
    for form in ["report.html", "report.md", "junit.xml"] {
        let text = fs::read_to_string(here.path("out").join(form)).unwrap();
        assert!(text.contains(says) && text.contains("--plant identified"), "{form}");
    }
    let json = fs::read_to_string(here.path("out/report.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["plant"], "recorded");
    let doubt = |log: usize| &json["logs"][log]["plant_doubt"];
    assert!(doubt(0).as_str().unwrap().contains("delay 0.2"), "{}", doubt(0));
    assert!(doubt(1).is_null());
    // The way out, which changes what is driven; a sound log gives what it gave.
    let identified =
        here.tandem(&format!("{both} --plant identified late.mcap --format json")).json();
    assert_eq!(identified["plant"], "identified");
    assert!(identified["logs"][0]["plant_doubt"].is_null());
    assert_ne!(identified["logs"][0]["metrics"], json["logs"][0]["metrics"]);
    let alone = here.tandem(&format!("{both} sound.mcap")).stderr;
    assert!(!alone.contains("warning"), "{alone}");
    here.tandem(&format!("{both} --mode open --plant identified late.mcap")).exits(2);
}

/// No fixture is doubted.
#[test]
fn fixtures_are_what_they_claim_to_be() {
    for folder in fs::read_dir(crate::program::fixtures()).unwrap() {
        let session = folder.unwrap().path().join("session.mcap");
        if session.is_file() {
            let claim = replay::PlantClaim::of_log(LogReader::open(&session).unwrap());
            assert_eq!(claim, replay::PlantClaim::Stands, "{}", session.display());
        }
    }
}
