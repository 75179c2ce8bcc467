//! How far two values may be apart and still count as the same.
//!
//! Exact by default: replay is judged bit for bit. A tolerance file looks like this:
//!
//! ```toml
//! base = "practical"               # where to start from: "exact" (the default) or "practical"
//! ignore = ["state_hash"]          # fields that are not compared
//! [default]                        # every field without a row of its own or of its unit
//! abs = 1e-9
//! rel = 1e-9
//! [units."m/s"]                    # every field with that unit
//! abs = 1e-4
//! [fields.z1]
//! abs = 1e-6
//! ```
//!
//! `practical` takes for the same what nobody would notice: a millimetre, a milliradian, a millimetre
//! or a milliradian a second, ten times that for accelerations, a microsecond, and a millionth of
//! numbers without a unit; hashes are not compared. Rows of the file come before it.

use std::collections::{BTreeMap, BTreeSet};

use schemas::Step;
use serde::{Deserialize, Serialize};

use super::field::{Row, command_rows, step_rows};
use super::reading::Cell;
use crate::CompareError;

/// Two numbers count as the same when |a − b| ≤ `abs` or |a − b| ≤ `rel` · max(|a|, |b|).
///
/// Flags, names, counts and hashes have no tolerance: they are equal or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Tolerance {
    /// Absolute, in the field's unit.
    pub abs: f64,
    /// Relative to the larger of the two.
    pub rel: f64,
}

impl Tolerance {
    /// Whether the two count as the same. NaN equals NaN; a number never equals NaN, nor anything nothing.
    /// Directions are as far apart as the short way round.
    pub(super) fn same(self, row: &Row, a: Cell, b: Cell) -> bool {
        match (a, b) {
            (Cell::Number(a), Cell::Number(b)) => {
                if a == b || (a.is_nan() && b.is_nan()) {
                    return true;
                }
                let apart = row.apart(a, b);
                let larger = libm::fabs(a).max(libm::fabs(b));
                // An infinity is equal to itself only, whatever the tolerance.
                let within = |most: f64| most > 0.0 && apart <= most;
                apart.is_finite() && (within(self.abs) || within(self.rel * larger))
            }
            (Cell::Integer(a), Cell::Integer(b)) => a == b,
            (Cell::Hash(a), Cell::Hash(b)) => a == b,
            (Cell::Flag(a), Cell::Flag(b)) => a == b,
            (Cell::Name(a), Cell::Name(b)) => a == b,
            (Cell::Absent, Cell::Absent) => true,
            _ => false,
        }
    }
}

/// What a tolerance file starts from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Base {
    /// Bit for bit.
    #[default]
    Exact,
    /// What nobody would notice.
    Practical,
}

/// The tolerances of [`Base::Practical`], by unit.
const PRACTICAL: [(&str, Tolerance); 8] = [
    ("m", Tolerance { abs: 1e-3, rel: 0.0 }),
    ("rad", Tolerance { abs: 1e-3, rel: 0.0 }),
    ("m/s", Tolerance { abs: 1e-3, rel: 0.0 }),
    ("rad/s", Tolerance { abs: 1e-3, rel: 0.0 }),
    ("m/s²", Tolerance { abs: 1e-2, rel: 0.0 }),
    ("rad/s²", Tolerance { abs: 1e-2, rel: 0.0 }),
    ("s", Tolerance { abs: 1e-6, rel: 0.0 }),
    ("", Tolerance { abs: 1e-6, rel: 1e-6 }),
];

/// What [`Base::Practical`] does not compare.
const PRACTICAL_IGNORES: [&str; 2] = ["input_hash", "state_hash"];

/// The tolerance of every field.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Tolerances {
    /// What the rest is put on top of.
    pub base: Base,
    /// For every field without a row of its own or of its unit.
    pub default: Tolerance,
    /// By unit: `m/s`. An input's unit is that of velocities, whichever law it is of.
    pub units: BTreeMap<String, Tolerance>,
    /// By field: `z1`, or `u_s` for both of its components, or `u_s[0]` for one.
    pub fields: BTreeMap<String, Tolerance>,
    /// Fields that are not compared at all.
    pub ignore: BTreeSet<String>,
}

impl Tolerances {
    /// Bit for bit.
    pub fn exact() -> Tolerances {
        Tolerances::default()
    }

    /// Close enough for any practical purpose.
    pub fn practical() -> Tolerances {
        Tolerances { base: Base::Practical, ..Tolerances::default() }
    }

    /// Reads a tolerance file.
    ///
    /// # Errors
    /// The TOML does not parse, names an unknown field, or a tolerance is negative or NaN.
    pub fn from_toml(text: &str) -> Result<Tolerances, CompareError> {
        let read: Tolerances =
            toml::from_str(text).map_err(|error| CompareError::Tolerance(error.to_string()))?;
        let mut known: BTreeSet<String> = Step::FIELDS.iter().map(|f| f.name.to_owned()).collect();
        known.extend(step_rows().into_iter().chain(command_rows()).map(|row| row.name));
        for name in read.fields.keys().chain(&read.ignore) {
            if !known.contains(name) {
                return Err(CompareError::Tolerance(format!("unknown field `{name}`")));
            }
        }
        if let Some(unit) = read.units.keys().find(|u| !PRACTICAL.iter().any(|(p, _)| p == u)) {
            let known: Vec<String> =
                PRACTICAL.iter().map(|(unit, _)| format!("{unit:?}")).collect();
            let known = known.join(", ");
            return Err(CompareError::Tolerance(format!(
                "unknown unit {unit:?}: expected one of {known}"
            )));
        }
        let rows = read.fields.iter().chain(&read.units);
        let rows = rows.map(|(name, tolerance)| (name.as_str(), tolerance));
        for (name, tolerance) in rows.chain([("default", &read.default)]) {
            for (key, value) in [("abs", tolerance.abs), ("rel", tolerance.rel)] {
                if value.is_nan() || value < 0.0 {
                    return Err(CompareError::Tolerance(format!(
                        "{name}.{key} is {value}; it must be 0 or more"
                    )));
                }
            }
        }
        Ok(read)
    }

    /// The tolerance of one row; `None` where it is not compared.
    pub(super) fn of(&self, row: &Row) -> Option<Tolerance> {
        let whole = row.name.split(['[', '.']).next().unwrap_or(&row.name);
        if self.ignore.contains(&row.name) || self.ignore.contains(whole) {
            return None;
        }
        let practical = self.base == Base::Practical;
        let own = self.fields.get(&row.name).or_else(|| self.fields.get(whole));
        if own.is_none() && practical && PRACTICAL_IGNORES.contains(&row.name.as_str()) {
            return None;
        }
        let unit = row.unit.split_once(" or ").map_or(row.unit.as_str(), |(velocity, _)| velocity);
        let own = own.or_else(|| self.units.get(unit));
        let of_base = || {
            let mut rows = PRACTICAL.iter().filter(|(of, _)| practical && *of == unit);
            rows.next().map(|(_, tolerance)| tolerance)
        };
        Some(own.or_else(of_base).copied().unwrap_or(self.default))
    }
}
