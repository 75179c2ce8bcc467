//! Today's run of a fixture against its golden result.

use std::fmt::Write;

use serde::{Deserialize, Serialize};

use super::summary::Golden;
use crate::diff::{Diff, FieldDifference};
use crate::report::{number, told_apart, with_unit};

/// Most fields that a problem names beside the first cause.
const MOST_FIELDS: usize = 5;

/// Something that is not as it should be, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Problem {
    /// Where: the fixture, or a file, time or field in it.
    pub at: String,
    /// What is wrong.
    pub what: String,
    /// What to do.
    pub remedy: String,
}

/// Compares today's run of a fixture with its golden result; no problem means that it still gives
/// what was approved.
///
/// `diff` is the golden run (A) against today's (B), `None` where the golden run could not be
/// read: then a mismatch is still found by its hash, but its field and time cannot be named.
pub fn check(fixture: &str, golden: &Golden, today: &Golden, diff: Option<&Diff>) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut problem = |what: String, remedy: &str| {
        problems.push(Problem {
            at: fixture.to_owned(),
            what,
            remedy: remedy.replace("FIXTURE", fixture),
        });
    };
    let approve = "undo the change, or, if it is meant, accept it: tandem approve FIXTURE --reason \
                   TEXT";
    if golden.steps == 0 || today.steps == 0 {
        problem(
            format!(
                "{} golden steps, {} steps today: nothing was checked",
                golden.steps, today.steps
            ),
            "record FIXTURE again",
        );
        return problems;
    }
    for (what, golden, today) in
        [("controller", &golden.controller, &today.controller), ("mode", &golden.mode, &today.mode)]
    {
        if golden != today {
            problem(
                format!("the golden result is of {what} `{golden}`, today's of `{today}`"),
                "replay FIXTURE with what its fixture.toml names",
            );
            return problems;
        }
    }
    match diff {
        Some(diff) if !diff.same => problem(mismatch(diff), approve),
        Some(diff) if diff.compared.steps == 0 => problem(
            "the golden run holds no step: nothing was checked".to_owned(),
            "approve FIXTURE again",
        ),
        None if golden.output_hash != today.output_hash => problem(
            format!(
                "output hash {} instead of {}; without the golden run its field cannot be named",
                today.output_hash, golden.output_hash
            ),
            approve,
        ),
        _ if golden.output_hash != today.output_hash => problem(
            format!(
                "output hash {} instead of {}, though every step and command agrees: simulated \
                 sensors, joystick or truth differ",
                today.output_hash, golden.output_hash
            ),
            approve,
        ),
        _ => {}
    }
    for (what, golden, today) in [
        ("steps", golden.steps, today.steps),
        ("engaged steps (k = 0)", golden.engaged_steps, today.engaged_steps),
    ] {
        if golden != today {
            problem(format!("{today} {what} instead of {golden}"), approve);
        }
    }
    if let Some(what) = metrics(golden, today) {
        problem(what, approve);
    }
    problems
}

/// The first cause and the fields that moved most, each with its time and amount.
fn mismatch(diff: &Diff) -> String {
    let mut text = String::new();
    if let Some(cause) = &diff.first_cause {
        // Writing to a String cannot fail, here and below.
        let _ = write!(text, "{} (A is the golden run, B today's)", cause.reason);
    }
    let _ =
        write!(text, "; {} of {} messages differ", diff.compared.differing, diff.compared.messages);
    let mut fields: Vec<&FieldDifference> =
        diff.fields.iter().filter(|field| field.max_abs.is_some()).collect();
    fields.sort_by(|x, y| y.max_rel.unwrap_or(0.0).total_cmp(&x.max_rel.unwrap_or(0.0)));
    let named: Vec<String> = fields
        .iter()
        .take(MOST_FIELDS)
        .map(|field| {
            format!(
                "{} by {} at {:.3} s",
                field.field,
                with_unit(&number(field.max_abs), &field.unit),
                field.max_abs_at_s.unwrap_or(field.first_at_s)
            )
        })
        .collect();
    if !named.is_empty() {
        let _ = write!(text, "; at most {}", named.join(", "));
    }
    text
}

/// The metrics that came out differently.
fn metrics(golden: &Golden, today: &Golden) -> Option<String> {
    let mut names: Vec<&String> = golden.metrics.keys().chain(today.metrics.keys()).collect();
    names.sort();
    names.dedup();
    let changed: Vec<String> = names
        .into_iter()
        .filter_map(|name| {
            let (was, is) = (golden.metrics.get(name).copied(), today.metrics.get(name).copied());
            let (was_text, is_text) = match (was, is) {
                (Some(was), Some(is)) => told_apart(was, is),
                _ => (number(was), number(is)),
            };
            (was != is).then(|| format!("{name} {is_text} instead of {was_text}"))
        })
        .collect();
    (!changed.is_empty()).then(|| format!("metrics changed: {}", changed.join(", ")))
}
