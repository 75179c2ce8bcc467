//! The forms of a report: that they agree, that they escape, and how they look.

use std::collections::BTreeMap;

use schemas::{MovingDisc, Reason};

use super::{
    catalogue_text, diff_text, html, json, markdown, metrics_text, number, signed, terminal,
};
use crate::synthetic::{Run, block, pair, question, scenario, task};
use crate::{CATALOGUE, Comparison, LogPair, Verdict, compare};

/// A run of three seconds in a room with a block and a walker: the feedback law takes over after
/// `human_s` and halves the speed.
fn arm(human_s: f64, closest_m: f64) -> Run {
    let mut scenario = scenario();
    scenario.task = Some(task());
    scenario.world.obstacles = vec![block(2.0, 0.4)];
    scenario.world.discs = vec![MovingDisc {
        radius_m: 0.2,
        from_m: [3.5, 0.5],
        to_m: [3.5, 1.5],
        speed_mps: 0.1,
        start_s: 0.0,
        to_and_fro: true,
    }];
    let mut run = Run::of(scenario);
    let mut x_m = 1.0;
    for i in 0..30 {
        let t_s = f64::from(i) * 0.1;
        let v_mps = if t_s < human_s { 0.5 } else { 0.25 };
        run.truth(t_s, |truth| {
            truth.pose.x_m = x_m;
            truth.clearance_m = closest_m + 0.01 * f64::from(29 - i);
            truth.clearance_static_m = truth.clearance_m;
        });
        run.step(t_s, |step| {
            step.pose.x_m = x_m;
            if t_s >= human_s {
                step.k = 0.0;
                step.reason = Reason::Danger;
                step.distance_human_m = 0.4;
            }
        });
        run.command(t_s, v_mps, 0.0);
        x_m += 0.1 * v_mps;
    }
    run
}

/// Two logs that went well, with a violation in A, and one that failed.
fn comparison() -> Comparison {
    let mut failed = pair("fallen", &arm(1.0, 0.2), &arm(1.0, 0.2));
    failed.b = Err("controller stopped answering".to_owned());
    let logs = vec![
        pair("corridor", &arm(2.0, -0.04), &arm(1.0, 0.06)),
        pair("doorway", &arm(2.0, 0.123_456), &arm(1.5, 0.2)),
        failed,
    ];
    let mut comparison = compare(&question(), logs).expect("the controllers engage");
    comparison.report = vec!["out/report.html".to_owned()];
    comparison
}

fn page(comparison: &Comparison) -> String {
    html(comparison).expect("the template fits")
}

/// A metric's printed cells, A to n, by name.
type Printed = BTreeMap<String, Vec<String>>;

fn from_json(comparison: &Comparison) -> Printed {
    let text = json(comparison).expect("has a JSON form");
    let value: serde_json::Value = serde_json::from_str(&text).expect("is JSON");
    let rows = value["metrics"].as_array().expect("is a list");
    rows.iter()
        .filter(|row| row["n"] != 0 || row["only_a"] != 0 || row["only_b"] != 0)
        .map(|row| {
            let of = |key: &str| row[key].as_f64();
            let ci = row["ci"].as_array().map_or_else(
                || number(None),
                |ends| format!("[{}, {}]", signed(ends[0].as_f64()), signed(ends[1].as_f64())),
            );
            let name = row["name"].as_str().expect("has a name").to_owned();
            let mut n = number(of("n"));
            for (key, arm) in [("only_a", "A"), ("only_b", "B")] {
                if row[key] != 0 {
                    n.extend([" (+", &row[key].to_string(), " ", arm, " only)"]);
                }
            }
            let cells =
                vec![number(of("a")), number(of("b")), signed(of("delta")), ci, number(of("p")), n];
            (name, cells)
        })
        .collect()
}

fn from_terminal(comparison: &Comparison) -> Printed {
    let text = terminal(comparison);
    let lines = text.lines().skip_while(|line| !line.starts_with("metric ")).skip(1);
    lines
        .take_while(|line| !line.starts_with("undefined") && !line.starts_with('▲'))
        .filter(|line| line.contains("higher") || line.contains("lower"))
        .map(|line| {
            let mut cells: Vec<&str> =
                line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect();
            let name = cells.remove(0).to_owned();
            // The unit, which not all have, and the direction.
            let better = cells.iter().position(|c| ["higher", "lower"].contains(c));
            cells.drain(..=better.expect("has a direction"));
            // The mark stands right behind B.
            let cells = cells
                .into_iter()
                .flat_map(|cell| cell.split_inclusive(['▲', '▼', '○', '=']))
                .map(str::trim)
                .filter(|cell| !["▲", "▼", "○", "="].contains(cell))
                .map(str::to_owned)
                .collect();
            (name, cells)
        })
        .collect()
}

fn from_markdown(comparison: &Comparison) -> Printed {
    let text = markdown(comparison);
    text.lines()
        .filter_map(|line| {
            let cells: Vec<String> = line
                .trim_matches('|')
                .split(" | ")
                .map(|cell| cell.trim().replace('\\', ""))
                .collect();
            crate::metric(&cells[0]).filter(|_| cells.len() == 10)?;
            let kept = [3, 4, 6, 7, 8, 9].map(|i| cells[i].clone()).to_vec();
            Some((cells[0].clone(), kept))
        })
        .collect()
}

fn from_page(comparison: &Comparison) -> Printed {
    let text = page(comparison);
    let table = text.split("<h2 id=\"violations\"").next().expect("has a first part");
    table
        .lines()
        .filter(|line| line.starts_with("<tr><th scope=\"row\""))
        .map(|line| {
            // The text between tags.
            let cells: Vec<String> = line
                .split('<')
                .filter_map(|part| part.split_once('>'))
                .filter(|(tag, _)| tag.starts_with("td") || tag.starts_with("th"))
                .map(|(_, text)| text.to_owned())
                .collect();
            let kept = [3, 4, 6, 7, 8, 9].map(|i| cells[i].clone()).to_vec();
            (cells[0].clone(), kept)
        })
        .collect()
}

#[test]
fn every_form_prints_the_same_numbers() {
    let comparison = comparison();
    let want = from_json(&comparison);
    // There is something to agree on, with an interval and with decimals.
    assert!(want.len() >= 10, "{want:?}");
    assert!(want["min_clearance_m"][0].contains('.'));
    assert!(want["override_m"][3].starts_with("[+"));
    assert_eq!(from_terminal(&comparison), want);
    assert_eq!(from_markdown(&comparison), want);
    assert_eq!(from_page(&comparison), want);
}

#[test]
fn every_form_says_verdict_reason_and_violations() {
    let comparison = comparison();
    assert_eq!(comparison.verdict, Verdict::Failed);
    assert_eq!(comparison.violations.len(), 1);
    for text in [terminal(&comparison), markdown(&comparison), page(&comparison)] {
        assert!(text.contains("failed"));
        assert!(text.contains(&comparison.reason), "{text}");
        assert!(text.contains("left the admissible set"));
        assert!(text.to_lowercase().contains("violations: 1 in a, 0 in b, 0 held against b"));
        assert!(text.contains("controller stopped answering"));
        assert!(text.contains("contact_speed_mps"), "undefined metrics are named");
    }
}

/// Names come from files and command lines: none may become markup.
#[test]
fn the_page_escapes_what_comes_from_outside() {
    let evil = "</title><script>alert('1')</script>\"><img src=x onerror=\"alert(2)\">&";
    let mut question = question();
    question.a = evil.to_owned();
    question.human = vec![evil.to_owned()];
    let mut failed = pair(&format!("{evil}2"), &arm(1.0, 0.2), &arm(1.0, 0.2));
    failed.a = Err(evil.to_owned());
    let log = LogPair { operator: evil.to_owned(), ..pair(evil, &arm(2.0, -0.1), &arm(1.0, -0.2)) };
    let comparison = compare(&question, vec![log, failed]).expect("the controllers engage");
    let text = page(&comparison);
    assert!(text.contains("&lt;script&gt;"));
    assert!(!text.contains("<script") && !text.contains("<img"));
    // Nor does it end an attribute's value.
    assert!(!text.contains("\"><img") && !text.contains("onerror=\""));
    for tag in ["</title>", "<title>end of A</title>"] {
        assert!(text.contains(tag));
    }
}

#[test]
fn markdown_cells_stay_in_their_cells() {
    let name = "a|b\n| c <img> `d` *e* [f](g) run_1";
    let comparison =
        compare(&question(), vec![pair(name, &arm(2.0, -0.1), &arm(1.0, 0.2))]).expect("engages");
    let text = markdown(&comparison);
    for line in text.lines().filter(|line| line.starts_with('|')) {
        // Columns are what unescaped bars make.
        let bars = line.replace("\\|", "").matches('|').count();
        assert!([4, 7, 9, 11].contains(&bars), "{line}");
    }
    assert!(!text.contains("<img>"));
    assert!(text.contains("\\`d\\` \\*e\\* \\[f\\](g) run_1"));
}

/// The page needs nothing but itself, and forbids itself the rest.
#[test]
fn the_page_stands_alone() {
    let text = page(&comparison());
    assert!(text.contains("default-src 'none'"));
    for outside in ["http:", "https:", "//cdn", "src=", "<link", "<script", "@import", "url("] {
        assert!(!text.contains(outside), "{outside}");
    }
    assert!(text.starts_with("<!doctype html>"));
    assert!(text.contains("prefers-color-scheme: dark"));
    assert!(text.contains("#0072B2") && text.contains("#D55E00"));
    assert!(text.contains("scope=\"col\"") && text.contains("scope=\"row\""));
    // A map with the block, the walker and both paths, and a ribbon and plots for both arms.
    for drawn in [
        "class=\"thing\"",
        "class=\"walk\"",
        "<polyline class=\"a\"",
        "<polyline class=\"b\"",
        "class=\"cross\"",
        "Who drives in A",
        "Who drives in B",
        "forward speed of A and B",
    ] {
        assert!(text.contains(drawn), "{drawn}");
    }
}

/// A log whose numbers are unknown still makes a page.
#[test]
fn unknown_numbers_do_not_reach_the_drawings() {
    let mut run = Run::new();
    run.step(0.0, |step| {
        step.k = 0.0;
        step.pose.x_m = f64::NAN;
        step.v_h_mps = f64::INFINITY;
    });
    run.step(0.1, |step| step.pose.y_m = f64::INFINITY);
    let text = page(&compare(&question(), vec![pair("odd", &run, &run)]).expect("engages"));
    for line in text.lines().filter(|line| line.contains("points=") || line.contains(" d=\"")) {
        assert!(!line.contains("NaN") && !line.contains("inf"), "{line}");
    }
}

#[test]
fn the_terminal_text_is_as_reviewed() {
    insta::assert_snapshot!(terminal(&comparison()));
}

#[test]
fn the_markdown_is_as_reviewed() {
    insta::assert_snapshot!(markdown(&comparison()));
}

#[test]
fn the_diff_text_is_as_reviewed() {
    let logs = [
        pair("same", &arm(2.0, 0.1), &arm(2.0, 0.1)),
        pair("different", &arm(2.0, 0.1), &arm(1.9, 0.1)),
    ];
    let texts: Vec<String> = logs
        .iter()
        .map(|log| diff_text(log.diff.as_ref().expect("compared").as_ref().expect("has steps")))
        .collect();
    insta::assert_snapshot!(texts.join("\n"));
}

#[test]
fn the_metrics_text_is_as_reviewed() {
    let mut estimated = Run::new();
    estimated.step(0.0, |_| {}).command(0.0, 0.5, 0.0);
    let runs = [
        ("corridor".to_owned(), arm(2.0, -0.04).measured()),
        ("robot".to_owned(), estimated.measured()),
    ];
    insta::assert_snapshot!(metrics_text(&runs));
}

#[test]
fn the_catalogue_explains_every_metric() {
    let text = catalogue_text();
    for metric in CATALOGUE {
        assert!(text.contains(metric.name) && text.contains(metric.formula));
    }
}
