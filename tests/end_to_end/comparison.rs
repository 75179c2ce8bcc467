//! `tandem diff`, `metrics` and `compare`, from the command line to the machine-readable result.

use std::fs;

use crate::program::Workplace;

#[test]
fn a_run_does_not_differ_from_itself() {
    let here = Workplace::new();
    here.record("a.mcap", "--scenario case1 --duration 20");
    let diff = here.tandem("diff --format json a.mcap a.mcap").succeeds().json();
    assert_eq!(diff["same"], true);
    assert!(diff["compared"]["steps"].as_u64().unwrap() > 100);
    assert_eq!(diff["first_cause"], serde_json::Value::Null);
}

#[test]
fn a_diff_names_the_first_cause() {
    let here = Workplace::new();
    here.record("a.mcap", "--scenario case1 --duration 20");
    here.tandem("replay --controller tandem-kinematic:gamma3=2.1 a.mcap -o b.mcap").succeeds();
    let diff = here.tandem("diff --format json a.mcap b.mcap").exits(1).json();
    assert_eq!(diff["same"], false);
    // A gain of the law changes nothing before the law.
    assert_eq!(diff["first_cause"]["node"], "law", "{}", diff["first_cause"]);
    assert!(diff["first_cause"]["t_s"].as_f64().unwrap() >= 0.0);
    assert!(!diff["fields"].as_array().unwrap().is_empty());
}

/// 24 sessions in random rooms, recorded with the person alone and again with the printed law, each
/// replayed into the printed and the corrected law (exact rays, closed loop).
///
/// A against A says `same`. The printed law leaves the admissible set in some (10–16 % of such rooms,
/// docs/controller.md section 9), and every leaving is listed; the corrected law leaves it in none.
#[test]
fn versions_are_compared_on_the_same_people() {
    for recorded_with in ["human", "paper-kinematic"] {
        let here = Workplace::new();
        let mut logs = String::new();
        for kind in [
            "rect:goal",
            "rect:joystick",
            "slant:goal",
            "slant:joystick",
            "disc:goal",
            "disc:joystick",
        ] {
            for number in 1..=4 {
                let name = format!("{}-{number}.mcap", kind.replace(':', "-"));
                here.record(
                    &name,
                    &format!(
                        "--scenario random:{kind}:{number} --sensors exact --controller \
                         {recorded_with}"
                    ),
                );
                logs.extend([" ", &name]);
            }
        }

        let same = here
            .tandem(&format!(
                "compare --format json --a tandem-kinematic --b tandem-kinematic {logs}"
            ))
            .succeeds()
            .json();
        assert_eq!(same["verdict"], "same");
        assert_eq!(same["logs"].as_array().unwrap().len(), 24);
        for metric in same["metrics"].as_array().unwrap() {
            assert!(metric["delta"] == 0.0 || metric["delta"].is_null(), "{metric}");
        }

        let json = here
            .tandem(&format!(
                "compare --format json --a paper-kinematic --b tandem-kinematic --report report \
                 {logs}"
            ))
            .json();
        assert_ne!(json["verdict"], "same");
        assert_ne!(json["verdict"], "failed", "{}", json["reason"]);
        let violations = json["violations"].as_array().unwrap();
        let left = |arm: &str| {
            let of_arm = violations.iter().filter(|violation| violation["arm"] == arm);
            of_arm.filter(|violation| violation["kind"] == "left_admissible_set").count()
        };
        assert!(left("a") > 0, "recorded with {recorded_with}: {violations:?}");
        assert_eq!(left("b"), 0, "recorded with {recorded_with}: {violations:?}");
        for violation in violations {
            for key in ["log", "t_s", "kind", "arm"] {
                assert!(!violation[key].is_null(), "{violation}");
            }
        }
        // Every log is accounted for, and every report exists.
        assert_eq!(json["logs"].as_array().unwrap().len(), 24);
        let reports = json["report"].as_array().unwrap();
        for ending in [".html", ".md", ".json"] {
            let report = reports.iter().find(|path| path.as_str().unwrap().ends_with(ending));
            let path = report.unwrap_or_else(|| panic!("a {ending} report")).as_str().unwrap();
            assert!(fs::metadata(here.path(path)).unwrap().len() > 1000, "{path}");
        }
    }
}

/// The paper's first experiment with body, walls and sixteen faulty sonars: no contact, under any of
/// these seeds of noise, over the whole minute.
#[test]
fn the_laboratory_is_driven_without_contact() {
    let here = Workplace::new();
    let mut logs = String::new();
    for seed in 0..5 {
        let name = format!("{seed}.mcap");
        here.record(&name, &format!("--scenario case1-lab --seed {seed}"));
        logs.extend([" ", &name]);
    }
    let json = here.tandem(&format!("metrics --format json {logs}")).succeeds().json();
    for run in json["runs"].as_array().unwrap() {
        let metrics = &run["metrics"];
        assert_eq!(metrics["collisions"]["value"], 0.0, "{run}");
        assert!(metrics["min_clearance_m"]["value"].as_f64().unwrap() > 0.0, "{run}");
    }
}

#[test]
fn a_log_that_fails_is_counted() {
    let here = Workplace::new();
    here.record("good.mcap", "--scenario random:rect:goal:1 --controller human");
    fs::write(here.path("bad.mcap"), "not a log").unwrap();
    let run = here
        .tandem("compare --format json --a human --b tandem-kinematic good.mcap bad.mcap")
        .exits(1);
    let json = run.json();
    assert_eq!(json["verdict"], "failed");
    let statuses: Vec<_> = json["logs"].as_array().unwrap().iter().map(|l| &l["status"]).collect();
    assert_eq!(statuses.len(), 2, "nothing is dropped");
    assert!(json.to_string().contains("not an MCAP file"), "the reason is given");
}

#[test]
fn metrics_of_a_run_and_their_catalogue() {
    let here = Workplace::new();
    here.record("a.mcap", "--scenario case1");
    let json = here.tandem("metrics --format json a.mcap").succeeds().json();
    let metrics = &json["runs"][0]["metrics"];
    // Case I: the law takes over for a while, and nothing is touched (clearance >= 0.03 m, section V).
    let share = metrics["human_share"]["value"].as_f64().unwrap();
    assert!(share > 0.0 && share < 1.0, "{share}");
    assert!(metrics["min_clearance_m"]["value"].as_f64().unwrap() >= 0.03);
    assert_eq!(metrics["collisions"]["value"], 0.0);
    let list = here.tandem("metrics").succeeds();
    for name in ["min_clearance_m", "human_share", "override_m"] {
        assert!(list.stdout.contains(name), "{}", list.stdout);
    }
}

/// A gate file decides the exit status: passed 0, failed 1, undecided 3, unusable 2. What it says of each
/// metric is in the JSON, and every report is written.
#[test]
fn a_gate_decides_the_exit_status() {
    let here = Workplace::new();
    let mut logs = String::new();
    for number in 1..=8 {
        let name = format!("{number}.mcap");
        here.record(
            &name,
            &format!("--scenario random:rect:joystick:{number} --sensors exact --controller human"),
        );
        logs.extend([" ", &name]);
    }
    let gate = |text: &str| fs::write(here.path("gate.toml"), text).unwrap();
    let compare = |b: &str, more: &str| {
        here.tandem(&format!(
            "compare --format json --force --gate gate.toml --a tandem-kinematic --b {b} {more} {logs}"
        ))
    };
    gate("[metrics.human_share]\nmargin = 0.0\n");
    let passed = compare("tandem-kinematic", "--report out --summary summary.md").exits(0).json();
    assert_eq!(passed["gate"]["outcome"], "pass");
    for report in passed["report"].as_array().unwrap() {
        assert!(here.path(report.as_str().unwrap()).exists(), "{report}");
    }
    assert_eq!(passed["report"].as_array().unwrap().len(), 5);
    let summary = fs::read_to_string(here.path("summary.md")).unwrap();
    assert_eq!(summary, fs::read_to_string(here.path("out/report.md")).unwrap());

    // A human share of more than 1 is never reached.
    gate("[metrics.human_share]\nmean_limit = 1.1\n");
    let failed = compare("tandem-kinematic", "").exits(1).json();
    let of = |json: &serde_json::Value, name: &str| {
        let metrics = json["metrics"].as_array().unwrap();
        metrics.iter().find(|metric| metric["name"] == name).unwrap()["gate"].clone()
    };
    assert_eq!(of(&failed, "human_share"), "fail");
    assert_eq!(of(&failed, "override_m"), "none");

    gate("[metrics.human_share]\nmargin = 0.0\nrequired_n = 9\n");
    assert_eq!(compare("tandem-kinematic", "").exits(3).json()["gate"]["outcome"], "undecided");

    gate("[metrics.human_share]\nmargin = -1\n");
    let refused = compare("tandem-kinematic", "").exits(2);
    assert!(refused.stderr.contains("`metrics.human_share.margin` = -1"), "{}", refused.stderr);
}

/// Every level of the ladder in one comparison: A against A is the same at each, and parameters that
/// differ are told.
#[test]
fn a_comparison_runs_the_whole_ladder() {
    let here = Workplace::new();
    here.record("a.mcap", "--scenario random:rect:goal:3 --sensors exact");
    here.record("b.mcap", "--scenario random:slant:joystick:4 --sensors exact");
    let compare = |b: &str| {
        here.tandem(&format!(
            "compare --format json --human ladder --a tandem-kinematic --b {b} a.mcap b.mcap"
        ))
        .json()
    };
    let same = compare("tandem-kinematic");
    assert_eq!(same["verdict"], "same");
    assert_eq!(same["human"].as_array().unwrap().len(), 4);
    // The recording controller in closed loop is the recording, at every level.
    for floor in same["logs"][0]["floor"].as_object().unwrap().values() {
        assert_eq!(*floor, 0.0);
    }
    let other = compare("tandem-kinematic:gamma3=3.0");
    assert_eq!(other["provenance"]["parameters"][0]["key"], "gamma3");
    assert_eq!(other["logs"][0]["levels"].as_array().unwrap().len(), 4);
}

/// Parameters that differ are swapped one at a time, forth and back; one that is the only one does the
/// whole change either way, and every form says so.
#[test]
fn a_change_is_traced_to_its_parameter() {
    let here = Workplace::new();
    here.record("a.mcap", "--scenario random:rect:goal:3 --sensors exact");
    here.record("b.mcap", "--scenario random:slant:joystick:4 --sensors exact");
    let compare = |b: &str| {
        here.tandem(&format!(
            "compare --format json --force --attribute --report out --a tandem-kinematic --b {b} \
             a.mcap b.mcap"
        ))
    };
    let only = compare("tandem-kinematic:gamma3=3.0").json();
    let swaps = only["swaps"].as_array().unwrap();
    assert_eq!(swaps.len(), 1);
    assert_eq!(swaps[0]["key"], "gamma3");
    let mut compared = 0;
    for metric in only["metrics"].as_array().unwrap() {
        let name = metric["name"].as_str().unwrap();
        let (Some(delta), Some(forth)) =
            (metric["delta"].as_f64(), swaps[0]["forth"][name].as_f64())
        else {
            continue;
        };
        assert!((delta - forth).abs() <= 1e-12 * (1.0 + delta.abs()), "{name}: {delta} {forth}");
        assert_eq!(swaps[0]["forth"][name], swaps[0]["back"][name], "{name}");
        compared += 1;
    }
    assert!(compared > 20, "{compared}");

    // danger_band_m is a signal to the person: nothing moves otherwise for it.
    let two = compare("tandem-kinematic:gamma3=3.0,danger_band_m=0.7").json();
    let swaps = two["swaps"].as_array().unwrap();
    let of = |key: &str| swaps.iter().find(|swap| swap["key"] == key).unwrap();
    let changes = |swap: &serde_json::Value| {
        let values = swap["forth"].as_object().unwrap().values();
        values.filter(|value| value.as_f64() != Some(0.0)).count()
    };
    assert_eq!(changes(of("danger_band_m")), 0);
    assert!(changes(of("gamma3")) > 10);
    for form in ["report.md", "report.html"] {
        let text = fs::read_to_string(here.path("out").join(form)).unwrap();
        let (_, table) = text.split_once("Which parameter makes the difference").expect(form);
        assert!(table.contains("gamma3"), "{form}");
    }

    let other_law = compare("tandem-dynamic").exits(2);
    assert!(other_law.stderr.contains("different laws"), "{}", other_law.stderr);
    assert_eq!(compare("tandem-kinematic").json()["swaps"], serde_json::Value::Null);
}

/// Beside the report both arms of the logs with most to see stand in one log each, which says of them
/// what the comparison says; moments name the critical distance and the echo that it hangs on.
#[test]
fn both_arms_stand_side_by_side_beside_the_report() {
    let here = Workplace::new();
    here.record("a.mcap", "--scenario random:disc:joystick:1 --duration 9");
    here.record("b.mcap", "--scenario random:rect:goal:2 --duration 9");
    let compare = "compare --format json --a paper-kinematic --b tandem-kinematic a.mcap b.mcap \
                   --report out";
    let json = here.tandem(&format!("{compare} --ab 1")).json();
    let logs = json["logs"].as_array().unwrap();
    let shown: Vec<_> = logs.iter().filter(|log| log["side_by_side"].is_string()).collect();
    assert_eq!(shown.len(), 1, "as many as were asked for");
    let file = format!("out/{}", shown[0]["side_by_side"].as_str().unwrap());
    assert!(json["report"].as_array().unwrap().contains(&file.as_str().into()), "{json}");
    let diff = here.tandem(&format!("diff --format json {file}")).exits(1).json();
    for key in ["t_s", "node", "field", "a", "b"] {
        assert_eq!(diff["first_cause"][key], shown[0]["first_cause"][key], "{key}");
    }
    assert!(here.path("out/ab/layout.json").is_file());
    let page = fs::read_to_string(here.path("out/report.html")).unwrap();
    assert_eq!(page.matches("Both arms in one log").count(), 1);

    let moments = json["moments"].as_array().unwrap();
    let says = |what: &str| moments.iter().any(|m| m["why"].as_str().unwrap().contains(what));
    assert!(says("below Dc = ") && says("what ends it is the echo "), "{moments:?}");

    // Nothing is overwritten unasked; with --force nothing of the earlier one stays.
    here.tandem(&format!("{compare} --ab 2")).exits(2);
    let same = compare.replace("paper-kinematic", "tandem-kinematic");
    here.tandem(&format!("{same} --force")).succeeds();
    assert!(fs::read_dir(here.path("out/ab")).unwrap().all(|entry| {
        entry.unwrap().path().extension().is_some_and(|extension| extension != "mcap")
    }));
}

/// What cannot be written, as on a full disk, is told, and takes neither the verdict nor the rest with it.
#[test]
fn what_cannot_be_written_takes_nothing_with_it() {
    let here = Workplace::new();
    here.record("a.mcap", "--scenario random:disc:joystick:1 --duration 9");
    here.record("b.mcap", "--scenario random:rect:goal:2 --duration 9");
    let compare = "compare --format json --a paper-kinematic --b tandem-kinematic a.mcap b.mcap";
    let verdict = here.tandem(compare).json()["verdict"].clone();
    // A folder in the way of the file that it would be until it is whole.
    let in_the_way = ["out/ab/a.mcap", "out/ab/b.mcap", "out/report.html"];
    for file in in_the_way {
        fs::create_dir_all(here.path(&format!("{file}.unfinished"))).unwrap();
    }
    let run = here.tandem(&format!("{compare} --report out --force --summary none/x.md")).exits(2);
    let json = run.json();
    assert_eq!(json["verdict"], verdict);
    for file in ["out/ab/", "out/report.html", "none/x.md"] {
        let tells = |line: &&str| line.starts_with("error: ") && line.contains(file);
        assert_eq!(run.stderr.lines().filter(tells).count(), 1, "{file}: {}", run.stderr);
        assert!(!json["report"].to_string().contains(file), "{json}");
    }
    for file in ["report.md", "report.json", "junit.xml", "metrics.csv"] {
        let path = format!("out/{file}");
        assert!(json["report"].as_array().unwrap().contains(&path.as_str().into()), "{json}");
        assert!(here.path(&path).is_file(), "{file}");
    }
    let kept = fs::read_to_string(here.path("out/report.json")).unwrap();
    let kept: serde_json::Value = serde_json::from_str(&kept).unwrap();
    assert_eq!(kept, json, "the report tells what there is of it");
}

/// What is compared is not written over, whatever may be.
#[test]
fn a_report_does_not_take_its_own_logs_away() {
    let here = Workplace::new();
    fs::create_dir_all(here.path("report/ab")).unwrap();
    let log = here.record("report/ab/log.mcap", "--scenario case1 --duration 3");
    let compare =
        "compare --a human --b paper-kinematic report/ab/log.mcap --report report --force";
    let run = here.tandem(compare).exits(2);
    assert!(run.error_line().contains("is an input"), "{}", run.stderr);
    assert!(log.exists());
}
