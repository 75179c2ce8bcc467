//! One comparable value, taken out of a message.

use schemas::{Command, Step, Value};
use serde::{Deserialize, Serialize};

/// What one run says about one field. In JSON a number, a string or a boolean; NaN and the
/// infinities, which JSON has no numbers for, are the strings `"NaN"`, `"inf"`, `"-inf"`.
#[derive(Clone, Debug)]
pub enum Reading {
    /// A quantity, or a count.
    Number(f64),
    /// Yes or no.
    Flag(bool),
    /// A name, or a hash in hexadecimal; `absent` for a field that a step does without.
    Text(String),
}

impl PartialEq for Reading {
    /// Equality as a diff sees it: NaN equals NaN.
    fn eq(&self, other: &Reading) -> bool {
        match (self, other) {
            (Reading::Number(a), Reading::Number(b)) => a == b || (a.is_nan() && b.is_nan()),
            (Reading::Flag(a), Reading::Flag(b)) => a == b,
            (Reading::Text(a), Reading::Text(b)) => a == b,
            _ => false,
        }
    }
}

impl std::fmt::Display for Reading {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Reading::Number(x) => write!(f, "{x}"),
            Reading::Flag(yes) => f.write_str(if *yes { "true" } else { "false" }),
            Reading::Text(text) => f.write_str(text),
        }
    }
}

impl Serialize for Reading {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Reading::Number(x) if x.is_finite() => serializer.serialize_f64(*x),
            Reading::Number(x) => serializer.collect_str(x),
            Reading::Flag(yes) => serializer.serialize_bool(*yes),
            Reading::Text(text) => serializer.serialize_str(text),
        }
    }
}

impl<'de> Deserialize<'de> for Reading {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Plain {
            Flag(bool),
            Number(f64),
            Text(String),
        }
        Ok(match Plain::deserialize(deserializer)? {
            Plain::Flag(yes) => Reading::Flag(yes),
            Plain::Number(x) => Reading::Number(x),
            Plain::Text(text) => match text.as_str() {
                "NaN" => Reading::Number(f64::NAN),
                "inf" => Reading::Number(f64::INFINITY),
                "-inf" => Reading::Number(f64::NEG_INFINITY),
                _ => Reading::Text(text),
            },
        })
    }
}

/// One component of a message while it is compared; small, without a heap.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cell {
    Number(f64),
    Integer(i64),
    Hash(u64),
    Flag(bool),
    Name(&'static str),
    Absent,
}

impl Cell {
    pub(super) fn is_absent(self) -> bool {
        matches!(self, Cell::Absent)
    }

    pub(super) fn reading(self) -> Reading {
        match self {
            Cell::Number(x) => Reading::Number(x),
            Cell::Integer(n) => Reading::Number(n as f64),
            Cell::Hash(hash) => Reading::Text(format!("{hash:016x}")),
            Cell::Flag(yes) => Reading::Flag(yes),
            Cell::Name(name) => Reading::Text(name.to_owned()),
            Cell::Absent => Reading::Text("absent".to_owned()),
        }
    }
}

/// The cells of a step in the order of `STEP_ROWS`.
pub(super) fn step_cells(step: &Step) -> Vec<Cell> {
    let mut cells = vec![Cell::Integer(i64::try_from(step.step_index).unwrap_or(i64::MAX))];
    for value in step.values() {
        match value {
            Value::Number(x) => cells.push(Cell::Number(x)),
            Value::Pair(pair) => cells.extend(pair.map(Cell::Number)),
            Value::Pose(pose) => {
                cells.extend([pose.x_m, pose.y_m, pose.theta_rad].map(Cell::Number));
            }
            Value::Integer(n) => cells.push(Cell::Integer(n)),
            Value::Hash(hash) => cells.push(Cell::Hash(hash)),
            Value::Flag(yes) => cells.push(Cell::Flag(yes)),
            Value::Name(name) => cells.push(Cell::Name(name)),
            Value::Absent => cells.push(Cell::Absent),
        }
    }
    cells
}

/// The cells of a command. Accelerations that were not commanded are NaN.
pub(super) fn command_cells(command: &Command) -> Vec<Cell> {
    let [accel, alpha] = command.accel.unwrap_or([f64::NAN; 2]);
    [command.twist.v_mps, command.twist.omega_radps, accel, alpha].map(Cell::Number).to_vec()
}
