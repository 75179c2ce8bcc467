//! The study's tables, as Markdown.

use std::fmt::Write as _;

use compare::CATALOGUE;

use crate::score::{
    Calls, Record, apart_m, certified, coverage, error_ratio, error_ratios, mean_ratio, pairs,
    right_signs, spread_tells,
};
use crate::session::Pair;
use crate::{Ground, PAIRS, PEOPLE};

/// The rows: levels, and what is made of them.
const ROWS: [&str; 6] = ["no change", "playback", "path", "intent", "fitted", "estimate"];

/// Everything about one ground; `fleets` are in the order of [`PAIRS`].
pub(crate) fn section(ground: Ground, fleets: &[Vec<Record>], null: &[Vec<Record>]) -> String {
    let title = match ground {
        Ground::Ideal => "The plant that the log claims",
        Ground::Mismatched => "Another plant than the log claims",
        Ground::Identified => "Another plant, identified from the log",
    };
    let all: Vec<&Record> = fleets.iter().flatten().collect();
    let mut text = format!("\n## {title}\n\n{} predictions.\n\n", all.len());
    text += &levels(fleets, &all);
    let (still, moved) = certified(&all);
    let _ = writeln!(
        text,
        "\nThe interval over all levels holds {:.0} % of the true changes. The spread between levels \
         tells the worse half of the predictions from the better with an area of {:.2}. The robot \
         never left the recorded state at any level in {still} predictions; {moved} of those moved \
         otherwise after all.\n",
        100.0 * coverage(&all),
        spread_tells(&all),
    );
    text += &parts(fleets, &all);
    text += &metrics(&all);
    text += &calls(fleets, null);
    text
}

fn levels(fleets: &[Vec<Record>], all: &[&Record]) -> String {
    let mut text = String::from(
        "| level | error ÷ change | of the mean | right signs | off before the horizon | after |\n\
         |---|---|---|---|---|---|\n",
    );
    let slices: Vec<&[Record]> = fleets.iter().map(Vec::as_slice).collect();
    for row in ROWS {
        let said = pairs(all, row);
        let halves = [0, 1].map(|which| {
            apart_m(all, row, which).map_or_else(|| "–".to_owned(), |m| format!("{m:.2} m"))
        });
        let _ = writeln!(
            text,
            "| {row} | {:.2} | {:.2} | {:.0} % | {} | {} |",
            error_ratio(&said),
            mean_ratio(&slices, row),
            100.0 * right_signs(&said),
            halves[0],
            halves[1]
        );
    }
    text
}

/// By person and by pair: error ÷ change.
fn parts(fleets: &[Vec<Record>], all: &[&Record]) -> String {
    let mut text = String::from(
        "| error ÷ change | playback | path | intent | fitted | estimate |\n|---|---|---|---|---|---|\n",
    );
    let mut line = |label: &str, part: &[&Record]| {
        let _ = write!(text, "| {label} |");
        for row in &ROWS[1..] {
            let _ = write!(text, " {:.2} |", error_ratio(&pairs(part, row)));
        }
        text.push('\n');
    };
    for person in PEOPLE {
        let part: Vec<&Record> =
            all.iter().filter(|record| record.person == person).copied().collect();
        line(person, &part);
    }
    for (fleet, pair) in fleets.iter().zip(PAIRS) {
        line(&label(pair), &fleet.iter().collect::<Vec<_>>());
    }
    text
}

fn label((a, b): Pair) -> String {
    let same = if b.1.is_empty() { "" } else { ", wider sets" };
    format!("`{}` → `{}`{same}", a.0, b.0)
}

fn metrics(all: &[&Record]) -> String {
    let mut text = String::from(
        "\n| error ÷ change | playback | path | intent | fitted | estimate |\n|---|---|---|---|---|---|\n",
    );
    let ratios: Vec<_> = ROWS[1..].iter().map(|row| error_ratios(&pairs(all, row))).collect();
    for (index, metric) in CATALOGUE.iter().enumerate() {
        if ratios.iter().all(|row| row[index].is_none()) {
            continue;
        }
        let _ = write!(text, "| `{}` |", metric.name);
        for row in &ratios {
            let ratio = row[index].map_or_else(|| "–".to_owned(), |ratio| format!("{ratio:.2}"));
            let _ = write!(text, " {ratio} |");
        }
        text.push('\n');
    }
    text
}

fn calls(fleets: &[Vec<Record>], null: &[Vec<Record>]) -> String {
    let (mut whole, mut parts, mut nothing) =
        (Calls::default(), Calls::default(), Calls::default());
    for fleet in fleets {
        whole.count(&fleet.iter().collect::<Vec<_>>());
        for person in PEOPLE {
            let part: Vec<&Record> =
                fleet.iter().filter(|record| record.person == person).collect();
            parts.count(&part);
        }
    }
    for fleet in null {
        nothing.count(&fleet.iter().collect::<Vec<_>>());
    }
    let sessions = fleets.first().map_or(0, Vec::len);
    let mut text = String::from(
        "\n| agreement of all levels | real effects | called | wrong sign |\n|---|---|---|---|\n",
    );
    for (label, calls) in [("logs", &whole), ("logs of one kind of person", &parts)] {
        let logs = if label == "logs" { sessions } else { sessions / PEOPLE.len() };
        let _ = writeln!(
            text,
            "| fleets of {logs} {label} | {} | {} ({:.0} %) | {} |",
            calls.real,
            calls.found,
            100.0 * f64::from(calls.found) / f64::from(calls.real),
            calls.wrong
        );
    }
    if !null.is_empty() {
        let _ = writeln!(
            text,
            "\nOf {} metrics of controllers that differ by 1 % of one gain {} are called, with {} true \
             differences beyond chance among them.",
            nothing.cells, nothing.called, nothing.real
        );
    }
    text
}
