//! The forms of a report: that they agree, that they escape, and how they look.

mod agreement;

use std::collections::BTreeMap;

use schemas::{MovingDisc, Reason};

use super::{
    catalogue_text, csv, diff_text, html, json, junit, markdown, metrics_text, number, signed,
    terminal,
};
use crate::synthetic::{Run, block, pair, question, scenario, task};
use crate::{CATALOGUE, Comparison, LogPair, Question, Verdict, compare};

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
    failed.levels[0].b = Err("controller stopped answering".to_owned());
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

/// A metric's name without the star of those that the verdict rests on.
fn unstarred(name: &str) -> String {
    name.trim_end_matches(" *").to_owned()
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
            let name = unstarred(cells.remove(0));
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
            let name = unstarred(&cells[0]);
            crate::metric(&name).filter(|_| cells.len() == 10)?;
            let kept = [3, 4, 6, 7, 8, 9].map(|i| cells[i].clone()).to_vec();
            Some((name, kept))
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
            (unstarred(&cells[0]), kept)
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
    assert!(want["override_m"][3].starts_with('[') && want["override_m"][3].contains('.'));
    assert_eq!(from_terminal(&comparison), want);
    assert_eq!(from_markdown(&comparison), want);
    assert_eq!(from_page(&comparison), want);
}

/// Rows of CSV, as RFC 4180 reads them.
fn csv_rows(text: &str) -> Vec<Vec<String>> {
    let (mut rows, mut row, mut cell, mut quoted) = (Vec::new(), Vec::new(), String::new(), false);
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        match (c, quoted) {
            ('"', true) if characters.peek() == Some(&'"') => {
                characters.next();
                cell.push('"');
            }
            ('"', _) => quoted = !quoted,
            (',', false) => row.push(std::mem::take(&mut cell)),
            ('\r', false) => {}
            ('\n', false) => {
                row.push(std::mem::take(&mut cell));
                rows.push(std::mem::take(&mut row));
            }
            (c, _) => cell.push(c),
        }
    }
    rows
}

/// The value of an attribute of the first such element in a piece of XML.
fn attribute<'a>(xml: &'a str, name: &str) -> &'a str {
    xml.split_once(&format!(" {name}=\"")).expect(name).1.split('"').next().expect("ends")
}

#[test]
fn per_log_numbers_agree_in_json_csv_and_junit() {
    let comparison = comparison();
    // Not by way of text: the reader of JSON rounds the last digit.
    let value = serde_json::to_value(&comparison).expect("has a JSON form");
    let rows = csv_rows(&csv(&comparison));
    let column = |name: &str| rows[0].iter().position(|head| head == name).expect(name);
    assert!(rows.iter().all(|row| row.len() == rows[0].len()));
    let xml = junit(&comparison);
    let cases: Vec<&str> = xml.split("<testcase").skip(1).collect();
    let logs = value["logs"].as_array().expect("is a list");
    assert_eq!(cases.len(), logs.len());
    let mut compared = 0;
    for (log, case) in logs.iter().zip(cases) {
        let name = log["log"].as_str().expect("has a name");
        assert_eq!(attribute(case, "name"), name);
        assert_eq!(case.contains("<error"), log["status"] == "failed");
        for (metric, change) in log["metrics"].as_object().expect("by name") {
            let of = |key: &str| change[key].as_f64();
            let row = rows
                .iter()
                .find(|row| row[column("log")] == name && row[column("metric")] == *metric)
                .expect("has a row");
            for key in ["a", "b", "delta"] {
                assert_eq!(row[column(key)].parse().ok(), of(key), "{name} {metric} {key}");
            }
            let line = format!(
                "{metric}: {}, {}, {}\n",
                number(of("a")),
                number(of("b")),
                signed(of("delta"))
            );
            assert!(case.contains(&line), "{line} in {case}");
            compared += 1;
        }
    }
    assert_eq!(compared, 2 * CATALOGUE.len());
    // The failed log is there too, with its reason.
    let failed = rows.iter().find(|row| row[column("status")] == "failed").expect("has a row");
    assert_eq!(failed[column("error")], "B: controller stopped answering");
}

/// Two levels, a gate, differing parameters: what every form says of them.
#[test]
fn every_form_tells_gate_levels_and_provenance() {
    let gate = "[metrics.override_m]\nmargin = 0.01\n[metrics.min_clearance_m]\nlog_limit = 0.0\n\
                [metrics.collisions]\nlog_limit = 0\n";
    let mut question = question();
    question.gate = Some(crate::GateFile::from_toml(gate).expect("sound"));
    question.provenance = crate::Provenance {
        version: "1.2.3".to_owned(),
        commit: "0123456789abcdef".to_owned(),
        dirty: true,
        a: crate::ArmInfo { params_hash: "aaaa".repeat(8), params_toml: "g = 1.0".to_owned() },
        b: crate::ArmInfo { params_hash: "bbbb".repeat(8), params_toml: "g = 2.0".to_owned() },
        parameters: Vec::new(),
    };
    let mut log = pair("corridor", &arm(2.0, 0.05), &arm(1.0, 0.06));
    let mut stressed = pair("corridor", &arm(2.0, 0.05), &arm(1.0, -0.05)).levels.remove(0);
    (stressed.human, stressed.estimates) = ("playback".to_owned(), false);
    log.levels[0].human = "fitted".to_owned();
    log.levels.push(stressed);
    let got = compare(&question, vec![log]).expect("engages");
    let forms = [terminal(&got), markdown(&got), page(&got), junit(&got)];
    for text in &forms {
        for said in
            ["g 1.0 in A, 2.0 in B", "aaaaaaaaaaaa in A", "1.2.3, 0123456789ab", "uncommitted"]
        {
            assert!(text.contains(said), "{said} in {text}");
        }
        // Too few logs for the margin; the limit holds; B collides in the stress level only.
        assert!(text.contains("1 logs or clusters, 8 required"), "{text}");
        assert!(text.contains("1 at some levels only: confirm live"), "{text}");
    }
    assert_eq!(got.gate.as_ref().map(|gate| gate.outcome), Some(crate::Gate::Undecided));
    for text in &forms[..2] {
        assert!(text.contains("playback") && text.contains("stress"));
    }
    let xml = &forms[3];
    assert!(
        xml.contains("<testcase classname=\"gate\" name=\"collisions\">\n</testcase>"),
        "{xml}"
    );
    assert_eq!(xml.matches("<skipped").count(), 1);
    assert_eq!(attribute(xml, "tests"), "4");
    // Each level's numbers are in the JSON and in the CSV.
    let text = csv(&got);
    let rows = csv_rows(&text);
    let clearance = |level: &str| {
        let row = rows.iter().find(|row| row[6] == level && row[7] == "min_clearance_m");
        row.expect("has a row")[11].parse::<f64>().expect("a number")
    };
    assert_eq!((clearance(""), clearance("fitted"), clearance("playback")), (0.06, 0.06, -0.05));
}

/// Names from outside stay text in XML and in CSV.
#[test]
fn xml_and_csv_escape_what_comes_from_outside() {
    let evil = "a,\"b\"<c>&'d'\n\u{1}";
    let got = compare(&question(), vec![pair(evil, &arm(2.0, -0.1), &arm(1.0, -0.2))]);
    let got = got.expect("engages");
    let xml = junit(&got);
    assert!(xml.contains("name=\"a,&quot;b&quot;&lt;c&gt;&amp;&apos;d&apos;\n?\""), "{xml}");
    let text = csv(&got);
    let rows = csv_rows(&text);
    assert!(rows.iter().skip(1).all(|row| row[0] == evil && row.len() == rows[0].len()));
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
    failed.levels[0].a = Err(evil.to_owned());
    let log = LogPair { operator: evil.to_owned(), ..pair(evil, &arm(2.0, -0.1), &arm(1.0, -0.2)) };
    let comparison = compare(&question, vec![log, failed]).expect("the controllers engage");
    let text = page(&comparison);
    assert!(text.contains("&lt;script&gt;"));
    // The only script is the page's own.
    assert_eq!(text.matches("<script").count(), 1);
    assert!(!text.contains("<img"));
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
        assert!([5, 7, 9, 11].contains(&bars), "{line}");
    }
    assert!(!text.contains("<img>"));
    assert!(text.contains("\\`d\\` \\*e\\* \\[f\\](g) run_1"));
}

/// The page needs nothing but itself, and forbids itself the rest.
#[test]
fn the_page_stands_alone() {
    let text = page(&comparison());
    assert!(text.contains("default-src 'none'"));
    for outside in
        ["http:", "https:", "//cdn", "src=", "<link", "@import", "url(", "fetch(", "onclick"]
    {
        assert!(!text.contains(outside), "{outside}");
    }
    // One script, which stands in the page as it is, and which the policy names by its hash.
    assert_eq!(text.matches("<script").count(), 1);
    let script = include_str!("page.js").trim_end();
    assert!(text.contains(&format!("<script>{script}</script>")));
    assert!(text.contains("script-src 'sha256-") && !text.contains("script-src 'unsafe"));
    assert!(text.starts_with("<!doctype html>"));
    assert!(text.contains("prefers-color-scheme: dark"));
    assert!(text.contains("#0072B2") && text.contains("#D55E00"));
    assert!(text.contains("scope=\"col\"") && text.contains("scope=\"row\""));
    // A map with the block, the walker and both paths, and a ribbon and plots for both arms.
    for drawn in [
        "class=\"thing\"",
        "class=\"walk\"",
        "<path class=\"a\"",
        "<path class=\"b\"",
        "<path class=\"law-a\"",
        "class=\"robot ra\"",
        "class=\"robot rb\"",
        "class=\"cursor\"",
        "class=\"forest\"",
        "type=\"range\"",
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

/// Verdict, metrics, violations, moments, belief, logs: in this order.
#[test]
fn the_page_begins_with_the_verdict() {
    let text = page(&comparison());
    let at = |what: &str| text.find(what).unwrap_or_else(|| panic!("{what}"));
    let order = [
        "<h1>",
        "class=\"verdict",
        "id=\"metrics\"",
        "id=\"violations\"",
        "id=\"moments\"",
        "id=\"belief\"",
        "id=\"logs\"",
    ];
    assert!(order.windows(2).all(|pair| at(pair[0]) < at(pair[1])));
    // The honest part: nothing was left out, and what is not known is said to be unknown.
    for said in [
        "3 asked for, 3 reported, 1 of them failed",
        "<th scope=\"row\">horizon</th><td>not determined</td>",
        "<th scope=\"row\">floor</th><td>not measured</td>",
        "3 of 3 logs",
    ] {
        assert!(text.contains(said), "{said}");
    }
}

/// Every time that is told leads to a log of the page, and to that time.
#[test]
fn times_lead_to_where_they_are() {
    let comparison = comparison();
    let text = page(&comparison);
    let links: Vec<&str> = text.split("class=\"jump\" ").skip(1).collect();
    assert!(
        links.len() >= comparison.moments.len() + comparison.violations.len(),
        "{}",
        links.len()
    );
    for link in links {
        let value = |key: &str| {
            link.split(&format!("{key}=\"")).nth(1).and_then(|rest| rest.split('"').next()).unwrap()
        };
        let (log, t_s) = (value("data-log"), value("data-t").parse::<f64>().unwrap());
        assert_eq!(value("href"), format!("#log-{log}"));
        assert!(text.contains(&format!("id=\"log-{log}\"")) && (0.0..=3.0).contains(&t_s));
    }
}

/// A hundred and fifty logs whose every number jumps about still make a page of less than 8 MB.
#[test]
fn many_logs_make_no_page_that_is_too_large() {
    let run = |phase: f64| {
        let mut run = Run::new();
        for i in 0..600 {
            let t_s = f64::from(i) * 0.1;
            let noise = |rate: f64| libm::sin(rate * f64::from(i * i) + phase);
            run.truth(t_s, |truth| {
                truth.pose.x_m = 2.0 + noise(1.1);
                truth.pose.y_m = 1.0 + noise(1.7);
                truth.clearance_m = 1.0 + noise(2.3);
            });
            run.step(t_s, |step| {
                step.k = f64::from(noise(0.9) > 0.0);
                step.v_h_mps = noise(3.1);
                step.omega_h_radps = noise(0.7);
                step.distance_human_m = 2.0 + noise(0.3);
                step.lyapunov = 2.0 + noise(0.5);
            });
            run.command(t_s, noise(1.3), noise(2.9));
        }
        run
    };
    let (a, b) = (run(0.0), run(1.0));
    let first = pair("0", &a, &b);
    let logs = (0..150).map(|i| LogPair { log: i.to_string(), ..first.clone() }).collect();
    let text = page(&compare(&question(), logs).expect("the controllers engage"));
    assert!(text.contains("150 of 150 logs"));
    assert!(text.len() < 8_000_000, "{} bytes", text.len());
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
        .map(|log| {
            diff_text(log.levels[0].diff.as_ref().expect("compared").as_ref().expect("has steps"))
        })
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

/// What a report says of the plants: that no log contradicts its own is said of those that were tested only.
#[test]
fn the_plant_is_told_as_far_as_it_was_tested() {
    let told = |plants: &[(&str, Option<&str>, Option<&str>)], plant: &str| {
        let logs = plants.iter().map(|(log, doubt, untold)| LogPair {
            plant_doubt: doubt.map(str::to_owned),
            plant_untold: untold.map(str::to_owned),
            ..pair(log, &arm(2.0, 0.2), &arm(1.0, 0.2))
        });
        let human = vec!["playback".to_owned()];
        let question = Question { human, plant: plant.to_owned(), ..question() };
        let comparison = compare(&question, logs.collect()).expect("the controllers engage");
        let rows = super::honest::caveats(&comparison);
        rows.into_iter().find(|row| row.what == "plant").expect("there is such a row").state
    };
    let (sound, still) = (("a", None, None), ("b", None, Some("it stands still")));
    let other = ("c", Some("it slips"), None);
    let tested = told(&[sound, sound], "recorded");
    assert_eq!(tested, "as claimed; every log was tested, and none contradicts it");
    let part = told(&[sound, still], "recorded");
    let says = "1 of 2 logs say nothing of it (b: it stands still)";
    assert_eq!(part, format!("as claimed; no log that was tested contradicts it, {says}"));
    let none = told(&[still, still], "recorded");
    let nothing = "no log says anything of it (b: it stands still)";
    assert_eq!(none, format!("as claimed, and untested: {nothing}"));
    for untested in [part, none] {
        assert!(!untested.contains("every log"), "{untested}");
    }
    let doubted = told(&[other, sound], "recorded");
    assert!(
        doubted.starts_with("! in 1 of 2 logs") && doubted.contains("c: it slips"),
        "{doubted}"
    );
    assert!(told(&[other, still], "recorded").ends_with(says));
    assert_eq!(told(&[sound], "identified"), "identified from each log");
    let identified = told(&[still], "identified");
    assert_eq!(
        identified,
        format!("identified from each log that shows it, else as claimed; {nothing}")
    );
    assert_eq!(told(&[sound], ""), "not looked at");
}
