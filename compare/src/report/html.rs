//! One offline HTML page.
//!
//! No network, no file beside it: the page's own policy forbids them, and allows no script but ours,
//! which it names by its hash. The script only moves what is drawn already: without it, and on paper,
//! everything but the time slider is there. Everything that comes from a log or a command line is
//! escaped by the template engine, which escapes whatever a template does not declare safe; ours
//! declares nothing safe, and what the script reads are attributes that hold numbers alone.

use minijinja::Environment;
use minijinja::value::Serde;
use serde::Serialize;

use super::honest::{Caveat, caveats};
use super::map::{Map, map};
use super::plot::{Timeline, timeline};
use super::samples::samples;
use super::self_test::SelfTestView;
use super::swaps::SwapRow;
use super::view::{GateRow, LevelRow, LogRow, MetricRow, MomentRow, View, ViolationRow};
use crate::CompareError;
use crate::comparison::{Comparison, MetricChange, ViolationRecord};
use crate::drawing::unit;

/// The name ends in `.html`, which turns escaping on.
const TEMPLATE: &str = "page.html";

/// What of the page is written in languages of its own: the line that stands for it, and it.
const PARTS: [(&str, &str); 2] =
    [("/* page.css */", include_str!("page.css")), ("/* page.js */", include_str!("page.js"))];

/// SHA-256 of `page.js` in base64, by which the page's policy allows it. A test tells the new one.
const SCRIPT_HASH: &str = "TSOXlEtQJDvSZlrFnNLE6bx/M6F/xWli9jmpho30pMg=";

/// Most points of one run that are drawn.
const MOST_POINTS: usize = 300;

/// Most points of all runs together: what keeps the page below 8 MB.
const MOST_POINTS_IN_ALL: usize = 36_000;

/// Most logs that are drawn; the others are listed.
const MOST_DRAWN: usize = 200;

/// Width of the picture of an interval, units; zero is in its middle.
const FOREST: f64 = 90.0;

/// What the template sees.
#[derive(Serialize)]
struct Page {
    verdict: &'static str,
    mark: &'static str,
    reason: String,
    a: String,
    b: String,
    facts: Vec<(&'static str, String)>,
    metrics: Vec<Metric>,
    explained: Vec<MetricRow>,
    undefined: String,
    violation_counts: (usize, usize, usize),
    violations: Vec<At<ViolationRow>>,
    moments: Vec<At<MomentRow>>,
    caveats: Vec<Caveat>,
    gate: Vec<GateRow>,
    levels: Vec<LevelRow>,
    swaps: Vec<SwapRow>,
    self_test: Option<SelfTestView>,
    logs: Vec<Log>,
    drawn: usize,
    points: usize,
    script_hash: &'static str,
}

/// One metric, with its interval as a picture.
#[derive(Serialize)]
struct Metric {
    #[serde(flatten)]
    row: MetricRow,
    forest: Option<Forest>,
}

/// An interval about zero: its ends and its middle, units.
#[derive(Serialize)]
struct Forest {
    from: String,
    to: String,
    at: String,
}

/// Something that happened in a log, with the number of that log.
#[derive(Serialize)]
struct At<T> {
    #[serde(flatten)]
    row: T,
    index: Option<usize>,
}

/// One log.
#[derive(Serialize)]
struct Log {
    #[serde(flatten)]
    row: LogRow,
    index: usize,
    drawn: bool,
    /// Which level of the ladder is drawn; empty where there is only one way.
    level: String,
    map: Option<Map>,
    timeline: Option<Timeline>,
    /// What the script reads, for either arm.
    samples_a: String,
    samples_b: String,
    violations: Vec<ViolationRow>,
}

/// The comparison as a page, verdict first.
///
/// # Errors
/// [`CompareError::Page`]; the template is part of the program, so that is not expected.
pub fn html(comparison: &Comparison) -> Result<String, CompareError> {
    let source = PARTS.iter().fold(include_str!("page.html").to_owned(), |page, (line, part)| {
        page.replace(line, part.trim_end())
    });
    let mut environment = Environment::new();
    environment.add_template(TEMPLATE, &source)?;
    let page = Page::new(comparison);
    Ok(environment.get_template(TEMPLATE)?.render(Serde(&page))?)
}

impl Page {
    fn new(comparison: &Comparison) -> Page {
        let view = View::new(comparison);
        let drawn = drawn(comparison);
        let runs = 2 * drawn.iter().filter(|drawn| **drawn).count();
        let points = (MOST_POINTS_IN_ALL / runs.max(1)).min(MOST_POINTS);
        let index = |log: &str| comparison.logs.iter().position(|row| row.log == log);
        Page {
            verdict: view.verdict,
            mark: view.mark,
            reason: view.reason.clone(),
            a: view.a.clone(),
            b: view.b.clone(),
            facts: view.facts.clone(),
            metrics: view
                .defined_metrics()
                .map(|row| Metric {
                    row: row.clone(),
                    forest: comparison.metric(&row.name).and_then(forest),
                })
                .collect(),
            explained: view.metrics.clone(),
            undefined: view.undefined_metrics().join(", "),
            violation_counts: view.violation_counts,
            caveats: caveats(comparison),
            logs: view
                .logs
                .iter()
                .enumerate()
                .map(|(i, row)| log(comparison, &view, i, row, drawn[i].then_some(points)))
                .collect(),
            drawn: runs / 2,
            points,
            script_hash: SCRIPT_HASH,
            gate: view.gate,
            levels: view.levels,
            swaps: view.swaps,
            self_test: view.self_test,
            violations: at(view.violations, |row| index(&row.log)),
            moments: at(view.moments, |row| index(&row.log)),
        }
    }
}

fn at<T>(rows: Vec<T>, index: impl Fn(&T) -> Option<usize>) -> Vec<At<T>> {
    rows.into_iter().map(|row| At { index: index(&row), row }).collect()
}

/// Which logs are drawn: all, or where there are too many those in which most happens.
fn drawn(comparison: &Comparison) -> Vec<bool> {
    let weight = |i: usize| {
        let name = &comparison.logs[i].log;
        let held = comparison.violations.iter().filter(|v| v.new && v.log == *name).count();
        let moments = comparison.moments.iter().filter(|moment| moment.log == *name).count();
        (held, moments)
    };
    let mut order: Vec<usize> = (0..comparison.logs.len()).collect();
    if order.len() > MOST_DRAWN {
        // The sort is stable: of equals the first ones are drawn.
        order.sort_by_key(|i| std::cmp::Reverse(weight(*i)));
        order.truncate(MOST_DRAWN);
    }
    let mut drawn = vec![false; comparison.logs.len()];
    for i in order {
        drawn[i] = true;
    }
    drawn
}

fn log(
    comparison: &Comparison,
    view: &View,
    index: usize,
    row: &LogRow,
    points: Option<usize>,
) -> Log {
    let scene = comparison.scenes.get(index).filter(|scene| scene.log == row.log).zip(points);
    let level = scene.map_or("", |(scene, _)| scene.human.as_str());
    // Those of another level happened elsewhere: they are listed, and not on the map.
    let of_log: Vec<&ViolationRecord> = comparison
        .violations
        .iter()
        .filter(|v| v.log == row.log && (v.human.is_empty() || v.human == level))
        .collect();
    let samples_of = |track: Option<&crate::Track>| {
        track.zip(points).map_or_else(String::new, |(track, points)| samples(track, points))
    };
    Log {
        row: row.clone(),
        index,
        drawn: points.is_some(),
        level: if comparison.human.len() > 1 { level.to_owned() } else { String::new() },
        map: scene.and_then(|(scene, points)| map(scene, &of_log, points)),
        timeline: scene.and_then(|(scene, points)| timeline(scene, points)),
        samples_a: samples_of(scene.and_then(|(scene, _)| scene.a.as_ref())),
        samples_b: samples_of(scene.and_then(|(scene, _)| scene.b.as_ref())),
        violations: view.violations.iter().filter(|v| v.log == row.log).cloned().collect(),
    }
}

/// Where the interval of a change lies about zero, scaled to itself; `None` without an interval.
fn forest(change: &MetricChange) -> Option<Forest> {
    let (ci, delta) = (change.ci?, change.delta?);
    let reach = [ci.low, ci.high, delta].map(libm::fabs).into_iter().fold(0.0, f64::max);
    let x = |value: f64| unit(0.5 * FOREST + 0.45 * FOREST * value / reach);
    let drawable = reach > 0.0 && reach.is_finite();
    drawable.then(|| Forest { from: x(ci.low), to: x(ci.high), at: x(delta) })
}

#[cfg(test)]
mod tests {
    use sha2::{Digest as _, Sha256};

    /// The policy of the page allows the script that is in it, and no other.
    #[test]
    fn the_hash_of_the_script_is_its_own() {
        let script = include_str!("page.js").trim_end();
        let hash = base64(&Sha256::digest(script.as_bytes()));
        assert_eq!(super::SCRIPT_HASH, hash, "page.js was changed: SCRIPT_HASH is to be {hash}");
    }

    /// RFC 4648.
    fn base64(bytes: &[u8]) -> String {
        const LETTERS: &[u8; 64] =
            b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let mut text = String::new();
        for chunk in bytes.chunks(3) {
            let word = chunk.iter().fold(0_u32, |word, byte| word << 8 | u32::from(*byte))
                << (8 * (3 - chunk.len()));
            for i in 0..4 {
                let letter = LETTERS[(word >> (18 - 6 * i)) as usize % 64];
                text.push(if i <= chunk.len() { char::from(letter) } else { '=' });
            }
        }
        text
    }

    /// RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_standard() {
        let texts = ["", "f", "fo", "foo", "foobar"].map(|text| base64(text.as_bytes()));
        assert_eq!(texts, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYmFy"]);
    }
}
