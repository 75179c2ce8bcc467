//! `tandem compare --self-test`: nothing is found where there is nothing, and what is wrong on purpose is
//! found where it is.

use std::fs;
use std::path::Path;

use crate::program::Workplace;

/// A small set: one session of each kind of person, sonars, a seed of its own each.
fn sessions(here: &Workplace, more: &str) -> String {
    let mut logs = String::new();
    for (seed, kind) in ["rect:goal:31", "slant:joystick:32", "disc:goal:33"].iter().enumerate() {
        let name = format!("{seed}.mcap");
        here.record(&name, &format!("--scenario random:{kind} --seed {seed} {more}"));
        logs.extend([" ", &name]);
    }
    logs
}

/// A against itself is the same, at least 95 % of the mutants are caught, and no comparison with other
/// noise raises an alarm; every form of the report says so.
#[test]
fn mutants_are_caught_and_nothing_else_is() {
    let here = Workplace::new();
    let logs = sessions(&here, "");
    let run = here.tandem(&format!(
        "compare --format json --self-test --alarms 3 --a tandem-kinematic --report out \
         --summary summary.md {logs}"
    ));
    let json = run.succeeds().json();
    assert_eq!(json["verdict"], "same");
    let test = &json["self_test"];
    assert_eq!(test["passed"], true, "{}", test["reason"]);
    assert_eq!(test["sessions"], 3);
    assert_eq!(test["differing"], serde_json::json!({ "itself": 0, "renamed": 0 }));
    assert!(test["caught_share"].as_f64().unwrap() >= 0.95, "{}", test["reason"]);
    assert_eq!(test["false_alarms"]["comparisons"], 3);
    assert_eq!(test["false_alarms"]["alarms"], 0);
    let mutants = test["mutants"].as_array().unwrap();
    assert!(mutants.len() >= 25);
    // The first cause names the stage of each kind of mutant.
    for (name, node) in [
        ("gamma3 +10 %", "law"),
        ("gamma3 -10 %", "law"),
        ("r_m +10 %", "reference"),
        ("the other side_rule", "reference"),
        ("sonar 5 dropped", "distances"),
        ("left and right mixed up", "distances"),
        ("estimate one step late", "estimate"),
        ("feedback turns the wrong way", "law"),
        ("no hysteresis", "sharing"),
        ("command one step late", "command"),
    ] {
        let mutant = mutants.iter().find(|mutant| mutant["name"] == name).expect(name);
        assert_eq!(mutant["nodes"], serde_json::json!([node]), "{name}");
        assert_eq!(mutant["caught"], true, "{mutant}");
        assert_eq!(mutant["named"], mutant["differing"], "{mutant}");
    }

    let caught = format!("{} of {}", test["caught"], mutants.len());
    for form in ["report.html", "report.md", "junit.xml"] {
        let text = fs::read_to_string(here.path("out").join(form)).unwrap();
        assert!(text.contains(&caught) && text.contains("command one step late"), "{form}");
    }
    let summary = fs::read_to_string(here.path("summary.md")).unwrap();
    assert!(summary.contains("Self-test ✓ passed"), "{summary}");
}

/// Beside a comparison of two controllers it takes that comparison's logs and gate, and where it is not
/// passed the exit status says so: a controller that no session calls upon cannot be told from its
/// mutants.
#[test]
fn it_stands_beside_a_comparison() {
    let here = Workplace::new();
    here.record("a.mcap", "--scenario case1 --controller human --duration 12");
    let run = here.tandem(
        "compare --format json --self-test --alarms 1 --a paper-kinematic --b tandem-kinematic a.mcap",
    );
    let json = run.json();
    assert_eq!((&json["a"], &json["b"]), (&"paper-kinematic".into(), &"tandem-kinematic".into()));
    let test = &json["self_test"];
    assert_eq!(test["sessions"], 1);
    assert_eq!(test["passed"], false, "{}", test["reason"]);
    assert_eq!(run.status, 1, "{}", test["reason"]);
    // Exact rays: nothing could be told of a sonar.
    let mutants = test["mutants"].as_array().unwrap();
    assert!(mutants.iter().all(|mutant| mutant["name"] != "sonar 5 dropped"));
}

#[test]
fn what_cannot_be_tested_is_refused() {
    let here = Workplace::new();
    here.record("a.mcap", "--scenario case1 --duration 5");
    for (line, said) in [
        ("compare --self-test --a human a.mcap", "shares nothing"),
        ("compare --self-test --a tandem-kinematic --mode open a.mcap", "closed loop"),
        ("compare --self-test --a tandem-kinematic --b paper-kinematic", "no log"),
        ("compare --self-test --a tandem-kinematic nowhere.mcap", "nowhere.mcap"),
    ] {
        let run = here.tandem(line).exits(2);
        assert!(run.stderr.contains(said), "{line}: {}", run.stderr);
    }
    here.tandem("compare --alarms 5 --a human --b human a.mcap").exits(2);
}

/// Mutations are made in one place, and asked for in one: nothing that drives a robot knows the word.
#[test]
fn nothing_else_knows_of_mutations() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut knowing = Vec::new();
    let mut folders: Vec<_> = ["src", "examples", "benches"].map(|part| root.join(part)).to_vec();
    for part in ["schemas", "controller", "simulator", "recorder", "replay", "compare"] {
        folders.push(root.join(part).join("src"));
    }
    // By the name of what is done wrong, or by what makes and replays a controller that does it.
    let words = ["Mutation", "Runner::mutant", "of_mutant", "fn mutant(setup"];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = fs::read_to_string(&path).unwrap_or_default();
            if words.iter().any(|word| text.contains(word)) {
                let name = path.strip_prefix(root).unwrap();
                knowing.push(name.to_str().unwrap().replace('\\', "/"));
            }
        }
    }
    knowing.sort();
    assert_eq!(
        knowing,
        [
            "controller/src/lib.rs",
            "controller/src/mutation.rs",
            "controller/src/runner/mod.rs",
            "replay/src/closed.rs",
            "replay/src/lib.rs",
            "src/self_test/mod.rs",
            "src/self_test/mutants.rs",
        ]
    );
}
