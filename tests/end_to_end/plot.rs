//! `tandem plot`: one file that stands alone, never over another one unasked.

use std::fs;

use schemas::log::{LogReader, WriterOptions, create};

use crate::program::Workplace;

#[test]
fn a_run_becomes_a_picture_and_its_facts() {
    let here = Workplace::new();
    here.record("log.mcap", "--scenario case1");
    let json = here.tandem("plot log.mcap -o log.svg --format json").succeeds().json();
    let picture = fs::read_to_string(here.path("log.svg")).unwrap();
    assert!(picture.starts_with("<svg ") && picture.trim_end().ends_with("</svg>"));
    assert_eq!(json["bytes"].as_u64().unwrap(), picture.len() as u64);
    assert!(picture.len() < 60_000, "{}", picture.len());
    // First k = 0 of Case I (specification, section 11).
    let first_s = json["feedback_s"][0][0].as_f64().unwrap();
    assert!((5.2..5.8).contains(&first_s), "{json}");
    // The facts agree with the metrics.
    let metrics = here.tandem("metrics log.mcap --format json").succeeds().json();
    let value = |name: &str| metrics["runs"][0]["metrics"][name]["value"].as_f64().unwrap();
    let share = json["feedback_share"].as_f64().unwrap();
    assert!((1.0 - value("human_share") - share).abs() < 0.01, "{json}");
    assert!((value("min_clearance_m") - json["least_clearance_m"].as_f64().unwrap()).abs() < 1e-3);
    // The same log makes the same bytes; nothing is overwritten unasked.
    let again = here.tandem("plot log.mcap -o log.svg").exits(2);
    assert!(again.error_line().contains("--force"), "{}", again.stderr);
    here.tandem("plot log.mcap -o log.svg --force").succeeds();
    assert_eq!(picture, fs::read_to_string(here.path("log.svg")).unwrap());
}

#[test]
fn bad_input_is_one_line_and_leaves_nothing_behind() {
    let here = Workplace::new();
    let log = here.record("log.mcap", "--scenario case1 --duration 2");
    let header = LogReader::open(&log).unwrap().header().clone();
    create(here.path("empty.mcap"), &header, &WriterOptions::offline()).unwrap().finish().unwrap();
    for (line, what) in [
        ("plot nowhere.mcap -o x.svg", "nowhere.mcap"),
        ("plot empty.mcap -o x.svg", "no controller step"),
        ("plot log.mcap -o log.mcap --force", "is the input"),
        ("plot log.mcap -o log.png", "the picture is an .svg file"),
    ] {
        let run = here.tandem(line).exits(2);
        assert!(run.error_line().contains(what), "`{line}`: {}", run.stderr);
        assert!(!here.path("x.svg").exists());
    }
    let bytes = fs::read(&log).unwrap();
    fs::write(here.path("cut.mcap"), &bytes[..bytes.len() * 2 / 3]).unwrap();
    let run = here.tandem("plot cut.mcap -o x.svg").exits(1);
    assert!(run.error_line().contains("cut off at byte"), "{}", run.stderr);
    assert!(!here.path("x.svg").exists());
}
