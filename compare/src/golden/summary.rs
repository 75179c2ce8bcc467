//! The summary of an approved run, as TOML.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::CompareError;
use crate::metrics::{CATALOGUE, Measured};

/// One approval: why the result is what it should be.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Approval {
    /// In the words of who approved.
    pub reason: String,
    /// The output hash that was approved.
    pub output_hash: String,
}

/// What a fixture gives when it is replayed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Golden {
    /// The controller that drove.
    pub controller: String,
    /// `open` or `closed`.
    pub mode: String,
    /// Hash of everything compared, in hexadecimal.
    pub output_hash: String,
    /// Controller steps.
    pub steps: u64,
    /// Those at which the feedback law drove.
    pub engaged_steps: u64,
    /// Every metric that has a meaning for this run.
    #[serde(default)]
    pub metrics: BTreeMap<String, f64>,
    /// Every approval so far, the newest last.
    #[serde(default, rename = "approval")]
    pub approvals: Vec<Approval>,
}

impl Golden {
    /// The summary of a run, not yet approved.
    pub fn of(controller: &str, mode: &str, output_hash: &str, run: &Measured) -> Golden {
        // What a clock measured is never the same twice.
        let values =
            CATALOGUE.iter().zip(run.metrics.values()).filter(|(m, _)| m.group.is_repeatable());
        Golden {
            controller: controller.to_owned(),
            mode: mode.to_owned(),
            output_hash: output_hash.to_owned(),
            steps: run.metrics.steps,
            engaged_steps: run.metrics.engaged_steps,
            metrics: values.filter_map(|(m, value)| Some((m.name.to_owned(), (*value)?))).collect(),
            approvals: Vec::new(),
        }
    }

    /// This run in place of an older golden result, whose approvals are kept.
    ///
    /// # Errors
    /// [`CompareError::Golden`] for an empty reason: an approval is worth what its reason says.
    pub fn approved(
        mut self,
        older: Option<&Golden>,
        reason: &str,
    ) -> Result<Golden, CompareError> {
        let reason = reason.trim();
        if reason.is_empty() {
            return Err(CompareError::Golden("an approval needs a reason".to_owned()));
        }
        self.approvals = older.map(|golden| golden.approvals.clone()).unwrap_or_default();
        self.approvals
            .push(Approval { reason: reason.to_owned(), output_hash: self.output_hash.clone() });
        Ok(self)
    }

    /// Whether the two runs came out the same; approvals aside.
    pub fn same_result(&self, other: &Golden) -> bool {
        let bare = |golden: &Golden| Golden { approvals: Vec::new(), ..golden.clone() };
        bare(self) == bare(other)
    }

    /// Reads `golden.toml`.
    ///
    /// # Errors
    /// [`CompareError::Golden`]: not TOML, a key missing or unknown, or no approval in it.
    pub fn from_toml(text: &str) -> Result<Golden, CompareError> {
        let golden: Golden =
            toml::from_str(text).map_err(|error| CompareError::Golden(error.to_string()))?;
        match golden.approvals.last() {
            Some(last) if last.output_hash == golden.output_hash => Ok(golden),
            Some(last) => Err(CompareError::Golden(format!(
                "the output hash {} was never approved; the last approval is for {}",
                golden.output_hash, last.output_hash
            ))),
            None => Err(CompareError::Golden("there is no [[approval]] in it".to_owned())),
        }
    }

    /// `golden.toml`.
    ///
    /// # Errors
    /// [`CompareError::Golden`]; every field has a TOML form, so that is not expected.
    pub fn to_toml(&self) -> Result<String, CompareError> {
        toml::to_string(self).map_err(|error| CompareError::Golden(error.to_string()))
    }
}
