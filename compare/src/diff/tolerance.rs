//! How far two values may be apart and still count as the same.
//!
//! Exact by default: replay is judged bit for bit. A tolerance file looks like this:
//!
//! ```toml
//! ignore = ["state_hash"]          # fields that are not compared
//! [default]                        # every field without a row of its own
//! abs = 1e-9
//! rel = 1e-9
//! [fields.z1]
//! abs = 1e-6
//! ```

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
    /// Whether the two count as the same. NaN equals NaN; a number never equals NaN.
    pub(super) fn same(self, a: Cell, b: Cell) -> bool {
        match (a, b) {
            (Cell::Number(a), Cell::Number(b)) => {
                if a == b || (a.is_nan() && b.is_nan()) {
                    return true;
                }
                let apart = libm::fabs(a - b);
                let larger = libm::fabs(a).max(libm::fabs(b));
                // An infinity is equal to itself only, whatever the tolerance.
                apart.is_finite() && (apart <= self.abs || apart <= self.rel * larger)
            }
            (Cell::Integer(a), Cell::Integer(b)) => a == b,
            (Cell::Hash(a), Cell::Hash(b)) => a == b,
            (Cell::Flag(a), Cell::Flag(b)) => a == b,
            (Cell::Name(a), Cell::Name(b)) => a == b,
            _ => false,
        }
    }
}

/// The tolerance of every field.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Tolerances {
    /// For every field without a row of its own.
    pub default: Tolerance,
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
        let rows = read.fields.iter().map(|(name, tolerance)| (name.as_str(), tolerance));
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
        let own = self.fields.get(&row.name).or_else(|| self.fields.get(whole));
        Some(own.copied().unwrap_or(self.default))
    }
}
