//! `JUnit` XML: a test case for each log and for each gated metric, as merge-request pages show them.
//!
//! A log fails where it could not be compared (an error) or where B does harm on it that A does not. Its
//! metrics stand in its output. A gated metric fails where the gate does, and is skipped where the gate
//! cannot decide. No case has a time: nothing here is measured by a clock.

use std::fmt::Write;

use super::view::{LogRow, View};
use crate::comparison::{Comparison, Gate};

/// The comparison as `JUnit` XML.
pub fn junit(comparison: &Comparison) -> String {
    let view = View::new(comparison);
    let suite = format!("{} against {}", view.b, view.a);
    let mut cases = String::new();
    let (mut failures, mut errors, mut skipped) = (0, 0, 0);
    for log in &view.logs {
        let held: Vec<String> = view
            .violations
            .iter()
            .filter(|v| v.new && v.log == log.log)
            .map(|v| format!("B {} at {}", v.kind, v.t))
            .collect();
        let verdict = if log.failed {
            errors += 1;
            element("error", &log.error)
        } else if held.is_empty() {
            String::new()
        } else {
            failures += 1;
            element("failure", &held.join("; "))
        };
        case(&mut cases, &suite, &log.log, &verdict, Some(&output(log)));
    }
    for metric in comparison.metrics.iter().filter(|metric| metric.gate != Gate::None) {
        let verdict = match metric.gate {
            Gate::Fail => {
                failures += 1;
                element("failure", &metric.gate_reason)
            }
            Gate::Undecided => {
                skipped += 1;
                element("skipped", &metric.gate_reason)
            }
            Gate::Pass | Gate::None => String::new(),
        };
        case(&mut cases, "gate", &metric.name, &verdict, None);
    }
    let mut tests =
        view.logs.len() + comparison.metrics.iter().filter(|m| m.gate != Gate::None).count();
    if let Some(test) = &view.self_test {
        tests += 1;
        let mut output = String::new();
        for (name, value) in &test.facts {
            let _ = writeln!(output, "{name}: {value}");
        }
        for mutant in &test.mutants {
            let _ = writeln!(output, "{}", mutant.cells().join(", "));
        }
        let passed = test.state == "passed";
        failures += usize::from(!passed);
        let verdict = if passed { String::new() } else { element("failure", &test.reason) };
        case(&mut cases, "self-test", "self-test", &verdict, Some(&output));
    }
    let counts = format!(
        "tests=\"{tests}\" failures=\"{failures}\" errors=\"{errors}\" skipped=\"{skipped}\""
    );
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {counts}>\n<testsuite name=\"{}\" \
         {counts}>\n<properties>\n",
        escaped(&suite)
    );
    let verdict = [("verdict", view.verdict.to_owned()), ("reason", view.reason.clone())];
    for (name, value) in verdict.iter().chain(&view.facts) {
        // Writing to a String cannot fail, here and below.
        let _ =
            writeln!(text, "<property name=\"{}\" value=\"{}\"/>", escaped(name), escaped(value));
    }
    let _ = writeln!(text, "</properties>\n{cases}</testsuite>\n</testsuites>");
    text
}

fn element(name: &str, message: &str) -> String {
    format!("<{name} message=\"{}\"/>\n", escaped(message))
}

fn case(text: &mut String, class: &str, name: &str, verdict: &str, output: Option<&str>) {
    let (class, name) = (escaped(class), escaped(name));
    let _ = writeln!(text, "<testcase classname=\"{class}\" name=\"{name}\">");
    text.push_str(verdict);
    if let Some(output) = output {
        let _ = writeln!(text, "<system-out>{}</system-out>", escaped(output));
    }
    text.push_str("</testcase>\n");
}

/// What is printed of a log: a line for each metric, `name: A, B, B - A`.
fn output(log: &LogRow) -> String {
    let mut text = String::new();
    for metric in &log.metrics {
        let _ = writeln!(text, "{}: {}, {}, {}", metric.name, metric.a, metric.b, metric.delta);
    }
    if !log.first_cause.is_empty() {
        let _ = writeln!(text, "first cause: {}", log.first_cause);
    }
    if !log.indicative.is_empty() {
        let _ = writeln!(text, "indicative only: {}", log.indicative);
    }
    text
}

/// Text for an attribute or an element; what XML 1.0 cannot hold at all becomes a question mark.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&apos;"),
            '\n' | '\t' => escaped.push(c),
            '\r' => escaped.push(' '),
            c if c < ' ' || matches!(c, '\u{fffe}' | '\u{ffff}') => escaped.push('?'),
            c => escaped.push(c),
        }
    }
    escaped
}
