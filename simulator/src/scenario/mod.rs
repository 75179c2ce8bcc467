//! The scenarios that can be named: the paper's case studies, read from `scenarios/*.toml`, and
//! rooms made from a number.

mod random;

use schemas::{Plant, Scenario, ScenarioError};

use crate::SimulatorError;

/// The built-in scenarios in the order of a list. The paper's simulations come first, then its
/// experiments.
const BUILT_IN: [(&str, &str); 8] = [
    ("case1", include_str!("../../scenarios/case1.toml")),
    ("case2", include_str!("../../scenarios/case2.toml")),
    ("case3", include_str!("../../scenarios/case3.toml")),
    ("case1-dynamic", include_str!("../../scenarios/case1-dynamic.toml")),
    ("case2-dynamic", include_str!("../../scenarios/case2-dynamic.toml")),
    ("case1-lab", include_str!("../../scenarios/case1-lab.toml")),
    ("case2-lab", include_str!("../../scenarios/case2-lab.toml")),
    ("case3-lab", include_str!("../../scenarios/case3-lab.toml")),
];

/// How random scenarios are named, with what each form makes.
const RANDOM: [(&str, &str); 2] = [
    ("random:N", "room, start, task and driver made from the whole number N"),
    (
        "random:rect|slant|disc:goal|joystick|hesitant|flowing|explorer|tracker:N",
        "the same with the kind of room (rectangular, slanted, with walking people) and the driver chosen",
    ),
];

/// What there is to name: every built-in scenario and every form of a random one, each with a
/// sentence about it.
pub fn scenarios() -> Vec<(String, String)> {
    let built_in = BUILT_IN.iter().map(|&(name, text)| {
        let summary = Scenario::from_toml(text).map_or_else(|e| e.to_string(), |it| it.summary);
        (name.to_owned(), summary)
    });
    let random = RANDOM.iter().map(|&(form, summary)| (form.to_owned(), summary.to_owned()));
    built_in.chain(random).collect()
}

/// The scenario of a name: a built-in one, `random:N`, or `random:KIND:DRIVER:N`; with keys of its
/// plant set differently where `:key=value,key=value` follows, as after a controller's name.
///
/// # Errors
/// There is none of that name; the error says which there are and which comes nearest. Or the plant
/// has no such key, or the value is no TOML or out of range.
pub fn scenario(name: &str) -> Result<Scenario, SimulatorError> {
    match name.rsplit_once(':') {
        Some((base, settings)) if settings.contains('=') => {
            let mut scenario = named(base)?;
            scenario.plant = with_settings(&scenario, settings)
                .map_err(|why| SimulatorError::Scenario { name: name.to_owned(), why })?;
            name.clone_into(&mut scenario.name);
            Ok(scenario)
        }
        _ => named(name),
    }
}

/// The scenario's plant, with keys set as `key=value,key=value` says.
fn with_settings(scenario: &Scenario, settings: &str) -> Result<Plant, ScenarioError> {
    let mut plant: toml::Table =
        toml::from_str(&toml::to_string(&scenario.plant).map_err(|e| {
            // Cannot be: a plant is numbers and a truth value.
            ScenarioError::Value(e.to_string())
        })?)?;
    let changed: toml::Table = settings.replace(',', "\n").parse()?;
    plant.extend(changed);
    let plant: Plant = plant.try_into()?;
    Scenario { plant, ..scenario.clone() }.check()?;
    Ok(plant)
}

fn named(name: &str) -> Result<Scenario, SimulatorError> {
    if let Some((_, text)) = BUILT_IN.iter().find(|(known, _)| *known == name) {
        return Scenario::from_toml(text)
            .map_err(|why| SimulatorError::Scenario { name: name.to_owned(), why });
    }
    if let Some(rest) = name.strip_prefix("random:") {
        return random::scenario(name, rest);
    }
    Err(unknown(name))
}

fn unknown(name: &str) -> SimulatorError {
    let known: Vec<&str> =
        BUILT_IN.iter().map(|(known, _)| *known).chain(RANDOM.map(|(form, _)| form)).collect();
    let nearest = known.iter().min_by_key(|known| edits(name, known)).copied().unwrap_or_default();
    SimulatorError::UnknownScenario {
        name: name.to_owned(),
        nearest: nearest.to_owned(),
        known: known.join(", "),
    }
}

/// Levenshtein distance: letters to insert, delete or replace.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, other) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(letter != *other);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests;
