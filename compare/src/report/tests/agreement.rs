//! Contract: terminal, JSON, Markdown, `JUnit`, HTML and CSV of one comparison, with gate, ladder,
//! attribution and self-test, agree on every number. JSON is read as it is; what it says is printed
//! here anew, and has to stand in every other form that tells of it.

use std::collections::BTreeMap;

use serde_json::Value;

use super::super::number::{seconds, with_unit};
use super::{arm, attribute, csv_rows};
use crate::report::{csv, html, json, junit, markdown, number, signed, terminal};
use crate::synthetic::{pair, question};
use crate::{Comparison, FalseAlarms, Gate, GateFile, Mutant, SelfTest, Swap, Unchanged, Verdict};

/// Ten logs of two levels with a gate, one of them failed, one with a violation at one level and one with a
/// violation at both; swaps and a self-test.
fn comparison() -> Comparison {
    let gate = "[violations]\nnew = 3\n[metrics.override_m]\nmargin = 0.01\n\
                [metrics.min_clearance_m]\nmargin = 0.2\nlog_limit = -1.0\n\
                [metrics.human_share]\nmargin = 0.05\nrequired_n = 40\n";
    let mut question = question();
    question.gate = Some(GateFile::from_toml(gate).expect("sound"));
    question.human = vec!["intent".to_owned(), "playback".to_owned()];
    let params = |g: f64| crate::ArmInfo {
        params_hash: "0123456789abcdef".to_owned(),
        params_toml: format!("g = {g:?}\n"),
    };
    question.provenance = crate::Provenance {
        version: "1.2.3".to_owned(),
        commit: "0123456789abcdef".to_owned(),
        a: params(1.0),
        b: params(2.5),
        ..crate::Provenance::default()
    };
    let logs = (0..10)
        .map(|i| {
            let w = 0.003 * f64::from(i);
            let closest = |b: f64| if i == 4 { -0.03 } else { b };
            let name = format!("run {i}.mcap");
            let mut log = pair(&name, &arm(2.0, 0.05 + w), &arm(0.9 + 10.0 * w, closest(0.06)));
            let stressed_m = if i == 7 { -0.02 } else { closest(0.055) };
            let stressed = pair(&name, &arm(2.1, 0.04 + w), &arm(1.0 + 7.0 * w, stressed_m));
            log.levels.extend(stressed.levels);
            for (level, name) in log.levels.iter_mut().zip(["intent", "playback"]) {
                level.human = name.to_owned();
                level.estimates = name == "intent";
                level.horizon_s = Some(2.0 + w);
            }
            if i == 0 {
                let mut recorded = arm(1.7, 0.045).measured();
                recorded.violations.clear();
                log.recorded = Some(recorded);
            }
            if i == 9 {
                log.levels[1].b = Err("stopped answering".to_owned());
            }
            log
        })
        .collect();
    let mut got = crate::compare(&question, logs).expect("engages");
    let values = |sign: f64| -> crate::Values {
        let of = |m: &crate::MetricChange| Some((m.name.clone(), sign * m.delta? * 0.937));
        got.metrics.iter().filter_map(of).collect()
    };
    got.swaps = vec![Swap { key: "g".to_owned(), forth: values(1.0), back: values(0.5) }];
    let mutant = |name: &str, named: usize, gate| Mutant {
        name: name.to_owned(),
        nodes: vec!["law".to_owned()],
        sessions: 9,
        differing: 8,
        named,
        misnamed: BTreeMap::new(),
        caught: named == 8,
        first_cause: Some("at 1 s".to_owned()),
        verdict: Verdict::Worse,
        gate,
    };
    let mutants = vec![mutant("one", 8, Gate::Fail), mutant("two", 7, Gate::Undecided)];
    let alarms = FalseAlarms {
        comparisons: 187,
        alarms: 3,
        share: 3.0 / 187.0,
        undecided: 41,
        called: 5,
        failed: 2,
    };
    got.self_test = Some(SelfTest::new(9, Unchanged::default(), mutants, alarms));
    got
}

/// A table: rows of cells.
type Table = Vec<Vec<String>>;

/// What the JSON says, printed by the rules of a report: by the name of a table.
#[expect(clippy::too_many_lines, reason = "one table after the other, each a list of its cells")]
fn expected(json: &Value) -> BTreeMap<&'static str, Table> {
    let list = |of: &Value| of.as_array().cloned().unwrap_or_default();
    let text = |of: &Value| of.as_str().unwrap_or_default().to_owned();
    let ci = |of: &Value| match of.as_array() {
        None => number(None),
        Some(ends) => format!("[{}, {}]", signed(ends[0].as_f64()), signed(ends[1].as_f64())),
    };
    let metrics = list(&json["metrics"]);
    let mut tables = BTreeMap::new();
    tables.insert(
        "metrics",
        metrics
            .iter()
            .filter(|m| m["n"] != 0 || m["only_a"] != 0 || m["only_b"] != 0)
            .map(|m| {
                let mut n = m["n"].to_string();
                for (key, arm) in [("only_a", "A"), ("only_b", "B")] {
                    if m[key] != 0 {
                        n.extend([" (+", &m[key].to_string(), " ", arm, " only)"]);
                    }
                }
                let (a, b) = (number(m["a"].as_f64()), number(m["b"].as_f64()));
                let delta = signed(m["delta"].as_f64());
                let p = number(m["p"].as_f64());
                let deciding = ["safety", "authority"].map(Value::from).contains(&m["group"]);
                let star = if m["primary"] == true && deciding { " *" } else { "" };
                vec![
                    format!("{}{star}", text(&m["name"])),
                    text(&m["unit"]),
                    text(&m["better"]),
                    a,
                    b,
                    delta,
                    ci(&m["ci"]),
                    p,
                    n,
                ]
            })
            .collect(),
    );
    tables.insert(
        "gate",
        metrics
            .iter()
            .filter(|m| m["gate"] != "none")
            .map(|m| vec![text(&m["name"]), text(&m["gate"]), text(&m["gate_reason"])])
            .collect(),
    );
    tables.insert(
        "levels",
        metrics
            .iter()
            .filter(|m| m["primary"] == true)
            .flat_map(|m| list(&m["levels"]).into_iter().map(|level| (m["name"].clone(), level)))
            .filter(|(_, level)| level["n"] != 0)
            .map(|(name, level)| {
                let counts = if level["estimates"] == true { "estimate" } else { "stress" };
                let (a, b) = (number(level["a"].as_f64()), number(level["b"].as_f64()));
                let delta = signed(level["delta"].as_f64());
                vec![
                    text(&name),
                    text(&level["human"]),
                    counts.to_owned(),
                    a,
                    b,
                    delta,
                    ci(&level["ci"]),
                ]
            })
            .collect(),
    );
    let mut violations = list(&json["violations"]);
    violations.sort_by_key(|v| v["new"] != true);
    tables.insert(
        "violations",
        violations
            .iter()
            .map(|v| {
                let mark = match (v["new"] == true, v["possible"] == true) {
                    (true, _) => "✕",
                    (_, true) => "?",
                    _ => "",
                };
                let kind: crate::ViolationKind =
                    serde_json::from_value(v["kind"].clone()).expect("a kind");
                let of = |key: &str| v[key].as_f64().expect("a number");
                vec![
                    mark.to_owned(),
                    text(&v["arm"]).to_uppercase(),
                    text(&v["log"]),
                    seconds(of("t_s")),
                    kind.words().to_owned(),
                    seconds(of("until_s") - of("t_s")),
                    with_unit(&number(Some(of("depth_m"))), "m"),
                    with_unit(&number(Some(of("speed_mps"))), "m/s"),
                ]
            })
            .collect(),
    );
    tables.insert(
        "moments",
        list(&json["moments"])
            .iter()
            .map(|m| {
                let unit =
                    crate::metric(m["metric"].as_str().expect("a name")).expect("known").unit;
                let share = format!("{:.0} %", 100.0 * m["share"].as_f64().expect("a number"));
                vec![
                    text(&m["log"]),
                    seconds(m["t_s"].as_f64().expect("a number")),
                    text(&m["metric"]),
                    with_unit(&signed(m["delta"].as_f64()), unit),
                    share,
                    text(&m["why"]),
                ]
            })
            .collect(),
    );
    let change = &json["provenance"]["parameters"][0];
    let swap = &json["swaps"][0];
    tables.insert(
        "swaps",
        metrics
            .iter()
            .filter(|m| swap["forth"][text(&m["name"])].is_number())
            .map(|m| {
                let of = |way: &str| signed(swap[way][text(&m["name"])].as_f64());
                let delta = signed(m["delta"].as_f64());
                vec![
                    text(&m["name"]),
                    delta,
                    text(&swap["key"]),
                    text(&change["a"]),
                    text(&change["b"]),
                    of("forth"),
                    of("back"),
                ]
            })
            .collect(),
    );
    tables.insert(
        "mutants",
        list(&json["self_test"]["mutants"])
            .iter()
            .map(|m| {
                let caught = if m["caught"] == true { "yes" } else { "NO" };
                vec![
                    text(&m["name"]),
                    text(&m["nodes"][0]),
                    format!("{} of {}", m["differing"], m["sessions"]),
                    format!("{} of {}", m["named"], m["differing"]),
                    caught.to_owned(),
                    text(&m["verdict"]),
                    text(&m["gate"]),
                ]
            })
            .collect(),
    );
    tables
}

/// The sentences that stand in every form but CSV: verdict, gate, self-test, parameters.
fn sentences(json: &Value) -> Vec<String> {
    let test = &json["self_test"];
    let (power, alarms) = (&test["power"], &test["false_alarms"]);
    let share = |of: &Value| number(of.as_f64());
    let of_metrics = |gate: &str| {
        let metrics = json["metrics"].as_array().expect("a list");
        metrics.iter().filter(|m| m["gate"] == gate).count()
    };
    assert!(["pass", "fail", "undecided"].iter().all(|gate| of_metrics(gate) > 0), "one of each");
    vec![
        json["reason"].as_str().expect("a text").to_owned(),
        json["gate"]["reasons"][0].as_str().expect("a text").to_owned(),
        "g 1.0 in A, 2.5 in B".to_owned(),
        format!("{} of 2, {}", test["caught"], share(&test["caught_share"])),
        format!(
            "{} fail ({}), {} undecided, {} pass",
            power["failed"],
            share(&power["failed_share"]),
            power["undecided"],
            power["passed"]
        ),
        format!(
            "{} of {} comparisons with other noise, {}; {} undecided",
            alarms["alarms"],
            alarms["comparisons"],
            share(&alarms["share"]),
            alarms["undecided"]
        ),
        format!("{} better or worse, {} failed", alarms["called"], alarms["failed"]),
        "1 at some levels only: confirm live".to_owned(),
    ]
}

/// The first Markdown table after a heading, without its head.
fn of_markdown(text: &str, after: &str) -> Table {
    let (_, text) = text.split_once(after).expect(after);
    let lines = text.lines().skip_while(|line| !line.starts_with('|'));
    let rows = lines.take_while(|line| line.starts_with('|')).skip(2);
    rows.map(|line| {
        let line = line.trim_start_matches("| ").trim_end_matches(" |");
        line.split(" | ").map(|cell| cell.trim().replace('\\', "")).collect()
    })
    .collect()
}

/// The body of the first HTML table after a text, tags and pictures left out.
fn of_page(page: &str, after: &str) -> Table {
    let (_, table) = page.split_once(after).expect(after);
    let body = table.split_once("<tbody>").expect("a body").1;
    let body = body.split_once("</tbody>").expect("an end").0;
    // Rows that name a group have a class.
    let rows = body.split("<tr").skip(1).filter(|row| row.starts_with('>')).map(|row| {
        let cells = row.split("<t").skip(1).filter(|cell| cell.starts_with(['d', 'h']));
        cells.map(|cell| plain(cell.split_once('>').expect("a tag").1)).collect()
    });
    rows.collect()
}

/// Text without markup.
fn plain(html: &str) -> String {
    let text: String = html
        .split('<')
        .enumerate()
        .map(|(i, part)| if i == 0 { part } else { part.split_once('>').map_or("", |(_, t)| t) })
        .collect();
    let text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"");
    text.replace("&#x27;", "'").replace("&#x2f;", "/").replace("&amp;", "&").trim().to_owned()
}

/// Rows of text from behind the line that starts so to the next blank one; empty cells are not seen.
fn of_terminal(text: &str, first: &str) -> Table {
    let lines = text.lines().skip_while(|line| !line.starts_with(first)).skip(1);
    let cells = |line: &str| -> Vec<String> {
        line.split("  ").map(str::trim).filter(|c| !c.is_empty()).map(str::to_owned).collect()
    };
    let ends = |line: &&str| line.is_empty() || line.starts_with(['▲', '…']);
    lines.take_while(|line| !ends(line) && !line.starts_with("undefined")).map(cells).collect()
}

fn without(mut table: Table, column: usize) -> Table {
    for row in &mut table {
        row.remove(column);
    }
    table
}

/// A table without its empty cells, as they are seen in a terminal.
fn seen(table: &Table) -> Table {
    let full = |row: &Vec<String>| row.iter().filter(|cell| !cell.is_empty()).cloned().collect();
    table.iter().map(full).collect()
}

/// Every row of `some` is one of `all`, and there are some.
fn assert_among(some: &Table, all: &Table, form: &str) {
    assert!(!some.is_empty(), "{form}: no rows");
    for row in some {
        assert!(all.contains(row), "{form}: {row:?}");
    }
}

/// What there is to compare, and the JSON that it is compared with.
fn told() -> (Comparison, Value, BTreeMap<&'static str, Table>) {
    let comparison = comparison();
    let text = json(&comparison).expect("has a form");
    let read: Value = serde_json::from_str(&text).expect("is JSON");
    let want = expected(&read);
    for (name, least) in [
        ("metrics", 20),
        ("gate", 3),
        ("levels", 10),
        ("violations", 3),
        ("moments", 10),
        ("swaps", 10),
        ("mutants", 2),
    ] {
        assert!(want[name].len() >= least, "{name}: {:?}", want[name]);
    }
    (comparison, read, want)
}

#[test]
fn markdown_agrees_with_json() {
    let (comparison, read, want) = told();
    let text = markdown(&comparison);
    assert_eq!(without(of_markdown(&text, "- **A**"), 5), want["metrics"]);
    assert_eq!(of_markdown(&text, "### Gate"), want["gate"]);
    assert_eq!(of_markdown(&text, "### Levels of the ladder"), want["levels"]);
    assert_eq!(of_markdown(&text, "### Violations"), want["violations"]);
    assert_among(&of_markdown(&text, "### Moments"), &want["moments"], "Markdown");
    assert_among(&of_markdown(&text, "### Which parameter"), &want["swaps"], "Markdown");
    assert_eq!(of_markdown(&text, "### Self-test"), want["mutants"]);
    for sentence in sentences(&read) {
        assert!(text.replace('\\', "").contains(&sentence), "{sentence} in {text}");
    }
}

#[test]
fn the_page_agrees_with_json() {
    let (comparison, read, want) = told();
    let page = html(&comparison).expect("the template fits");
    assert_eq!(without(of_page(&page, "<caption>Means over"), 5), want["metrics"]);
    assert_eq!(of_page(&page, "<caption>The gate, metric by metric"), want["gate"]);
    assert_eq!(of_page(&page, "<summary>Each level of the ladder"), want["levels"]);
    assert_eq!(of_page(&page, "<caption>✕ is held against B"), want["violations"]);
    assert_among(&of_page(&page, "<caption>Stretches in which"), &want["moments"], "page");
    assert_among(&of_page(&page, "<h3>Which parameter"), &want["swaps"], "page");
    assert_eq!(without(of_page(&page, "<summary>Each mutant"), 7), want["mutants"]);
    let text = plain(&page);
    for sentence in sentences(&read) {
        assert!(text.contains(&sentence), "{sentence}");
    }
    // How far to believe it: the floor of every metric that has one.
    for metric in read["metrics"].as_array().expect("a list") {
        if let (Some(floor), true) = (metric["floor"].as_f64(), metric["primary"] == true) {
            let (name, unit) = (metric["name"].as_str().expect("a name"), &metric["unit"]);
            let said = with_unit(&number(Some(floor)), unit.as_str().expect("a unit"));
            assert!(text.contains(&format!("{name} {said}")), "{name} {said}");
        }
    }
    let mut compared = 0;
    for log in read["logs"].as_array().expect("a list").iter().filter(|l| l["status"] == "ok") {
        let name = log["log"].as_str().expect("a name");
        let of_log: Table =
            want["moments"].iter().filter(|m| m[0] == name).map(|m| m[1..].to_vec()).collect();
        assert_eq!(of_page(&page, &format!("<caption>Moments of {name}")), of_log);
        for row in of_page(&page, &format!("<summary>Metrics of {name}")) {
            let change = &log["metrics"][&row[0]];
            let of = |key: &str| change[key].as_f64();
            let printed = [number(of("a")), number(of("b")), signed(of("delta"))];
            assert_eq!(row[2..], printed, "{name} {}", row[0]);
            compared += 1;
        }
        let horizon = with_unit(&number(log["horizon_s"].as_f64()), "s");
        assert!(text.contains(&format!("Horizon: {horizon}.")), "{name} {horizon}");
        assert!(text.contains(log["first_cause"]["reason"].as_str().expect("differs")));
    }
    assert!(compared > 300, "{compared}");
}

#[test]
fn the_terminal_agrees_with_json() {
    let (comparison, read, want) = told();
    let text = terminal(&comparison);
    let mark = |cell: &String| ["▲", "▼", "○", "="].contains(&cell.as_str());
    let metrics: Table = of_terminal(&text, "metric ")
        .into_iter()
        .filter(|row| row.len() > 1)
        .map(|row| row.into_iter().filter(|cell| !mark(cell)).collect())
        .collect();
    assert_eq!(metrics, seen(&want["metrics"]));
    let body = text.split_once("\ngate\n").expect("a gate").1;
    assert_eq!(of_terminal(&format!("gate\n{body}"), "gate"), seen(&want["gate"]));
    assert_eq!(of_terminal(&text, "levels of the ladder")[1..], want["levels"]);
    let violations = want["violations"].iter().map(|v| {
        let mut row = v.clone();
        row[5] = format!("for {}", v[5]);
        row[6] = format!("{} deep", v[6]);
        row[7] = format!("at {}", v[7]);
        row
    });
    assert_eq!(of_terminal(&text, "violations: "), seen(&violations.collect()));
    let moments = of_terminal(&text, "the moment that carries");
    assert_among(&moments, &without(want["moments"].clone(), 4), "terminal");
    let swaps = of_terminal(&text, "which parameter makes")[1..].to_vec();
    assert_among(&swaps, &want["swaps"], "terminal");
    assert_eq!(of_terminal(&text, "mutant "), want["mutants"]);
    for sentence in sentences(&read) {
        assert!(text.contains(&sentence), "{sentence} in {text}");
    }
}

#[test]
fn junit_and_csv_agree_with_json() {
    let (comparison, read, want) = told();
    let xml = junit(&comparison);
    let cases: Vec<&str> = xml.split("<testcase").skip(1).collect();
    let case = |name: &str| {
        let mut found = cases.iter().filter(|case| attribute(case, "name") == name);
        found.next().copied().expect("has a case")
    };
    assert_eq!(attribute(&xml, "tests"), cases.len().to_string());
    for row in &want["gate"] {
        let element = match row[1].as_str() {
            "fail" => "<failure",
            "undecided" => "<skipped",
            _ => continue,
        };
        let found = case(&row[0]).split_once(element).expect("has that element").1;
        assert_eq!(plain(attribute(found, "message")), row[2]);
    }
    let tested = plain(case("self-test"));
    for row in &want["mutants"] {
        assert!(tested.contains(&row.join(", ")), "{row:?} in {tested}");
    }
    // Attributes hold what the other forms print as text.
    let text = plain(&xml.replace(['<', '>'], " ").replace("&apos;", "'"));
    for sentence in sentences(&read) {
        assert!(text.contains(&sentence), "{sentence} in {text}");
    }

    // Not by way of text: the reader of JSON rounds the last digit.
    let exact = serde_json::to_value(&comparison).expect("has a form");
    let rows = csv_rows(&csv(&comparison));
    let column = |name: &str| rows[0].iter().position(|head| head == name).expect(name);
    let mut compared = 0;
    for log in exact["logs"].as_array().expect("a list").iter().filter(|l| l["status"] == "ok") {
        let name = log["log"].as_str().expect("a name");
        let levels = log["levels"].as_array().expect("a list").iter();
        let levels =
            levels.map(|level| (level["human"].as_str().expect("a name"), &level["metrics"]));
        for (level, metrics) in std::iter::once(("", &log["metrics"])).chain(levels) {
            for (metric, change) in metrics.as_object().expect("by name") {
                let mut found = rows.iter().filter(|row| {
                    row[column("log")] == name
                        && row[column("level")] == level
                        && row[column("metric")] == *metric
                });
                let row = found.next().expect("has a row");
                for key in ["a", "b", "delta"] {
                    let value = row[column(key)].parse().ok();
                    assert_eq!(value, change[key].as_f64(), "{name} {level} {metric} {key}");
                    compared += 1;
                }
                if level.is_empty() {
                    let of = |key: &str| number(change[key].as_f64());
                    let delta = signed(change["delta"].as_f64());
                    let line = format!("{metric}: {}, {}, {delta}\n", of("a"), of("b"));
                    assert!(case(name).contains(&line), "{line}");
                    let floor = row[column("floor")].parse().ok();
                    assert_eq!(floor, log["floor"][metric].as_f64(), "{name} {metric}");
                }
            }
        }
    }
    assert!(compared > 2000, "{compared}");
}
