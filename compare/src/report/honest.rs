//! How far a comparison is to be believed, in rows: what, how it stands, what that means.

use serde::Serialize;

use super::number::{number, with_unit};
use super::warned;
use crate::comparison::Comparison;

/// One thing that bears on how far to believe the rest.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Caveat {
    pub(super) what: &'static str,
    pub(super) state: String,
    pub(super) meaning: &'static str,
}

/// Everything that bears on it.
pub(super) fn caveats(comparison: &Comparison) -> Vec<Caveat> {
    vec![
        logs(comparison),
        person(comparison),
        fit(comparison),
        horizon(comparison),
        plant(comparison),
        floor(comparison),
    ]
}

fn logs(comparison: &Comparison) -> Caveat {
    let (all, failed) = (comparison.logs.len(), comparison.failed_logs());
    Caveat {
        what: "logs",
        state: format!("{all} asked for, {all} reported, {failed} of them failed"),
        meaning: "Nothing was left out. A log that failed in either arm is listed and counts as a \
                  failure.",
    }
}

fn person(comparison: &Comparison) -> Caveat {
    let (state, meaning) = if comparison.human.is_empty() {
        (
            "as recorded".to_owned(),
            "Open loop: both arms were given the recorded sensors and person. What they say \
             differs; how the robot moves cannot.",
        )
    } else if comparison.human.iter().all(|level| level == "playback" || level == "path") {
        (
            comparison.human.join(", "),
            "The recorded joystick, whatever the robot does. A real person would have reacted: \
             this is a stress level, not an estimate.",
        )
    } else {
        (
            comparison.human.join(", "),
            "Models of the recorded person, who react to the robot. Where they disagree, the log \
             cannot decide.",
        )
    };
    Caveat { what: "person", state, meaning }
}

fn fit(comparison: &Comparison) -> Caveat {
    let fitted = comparison.human.iter().any(|level| level == "fitted");
    Caveat {
        what: "fit",
        state: if fitted { "a person was fitted" } else { "no person was fitted" }.to_owned(),
        meaning: "On the recorded states every model returns the recorded joystick bit for bit; \
                  how well it does elsewhere is known only where people were simulated.",
    }
}

fn horizon(comparison: &Comparison) -> Caveat {
    let mut known: Vec<(f64, &str)> =
        comparison.logs.iter().filter_map(|log| Some((log.horizon_s?, log.log.as_str()))).collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let state = match known.first() {
        None => "not determined".to_owned(),
        Some((shortest_s, log)) => format!(
            "known in {} logs, median {}, shortest {} ({log})",
            known.len(),
            with_unit(&number(Some(known[known.len() / 2].0)), "s"),
            with_unit(&number(Some(*shortest_s)), "s"),
        ),
    };
    Caveat {
        what: "horizon",
        state,
        meaning: "Until then the simulated robot is near the recorded one, and the recorded person \
                  is to be believed. Metrics are over whole runs.",
    }
}

fn plant(comparison: &Comparison) -> Caveat {
    let untold = comparison.plants_untold();
    let state = match (comparison.plant_doubts(), untold) {
        (Some(doubts), None) => warned(&doubts),
        (Some(doubts), Some(untold)) => warned(&format!("{doubts}; {untold}")),
        (None, _) if comparison.human.is_empty() => "as recorded".to_owned(),
        (None, _) if comparison.plant.is_empty() => "not looked at".to_owned(),
        (None, untold) if comparison.plant == "identified" => match untold {
            None => "identified from each log".to_owned(),
            Some(untold) => {
                format!("identified from each log that shows it, else as claimed; {untold}")
            }
        },
        (None, None) => "as claimed; every log was tested, and none contradicts it".to_owned(),
        (None, Some(untold)) if comparison.logs.iter().all(|log| log.plant_untold.is_some()) => {
            format!("as claimed, and untested: {untold}")
        }
        (None, Some(untold)) => {
            format!("as claimed; no log that was tested contradicts it, {untold}")
        }
    };
    Caveat {
        what: "plant",
        state,
        meaning: "How the simulated robot answers its commands. Where the recorded one answered \
                  otherwise, everything here is about another robot.",
    }
}

fn floor(comparison: &Comparison) -> Caveat {
    let known: Vec<String> = comparison
        .metrics
        .iter()
        .filter(|metric| metric.primary)
        .filter_map(|metric| {
            let floor = with_unit(&number(Some(metric.floor?)), &metric.unit);
            Some(format!("{} {floor}", metric.name))
        })
        .collect();
    Caveat {
        what: "floor",
        state: if known.is_empty() { "not measured".to_owned() } else { known.join(", ") },
        meaning: "How far the simulated A is from the recorded one. No change below it is called \
                  real.",
    }
}
