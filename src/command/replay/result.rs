//! What `tandem replay` says: one line of JSON, or a few of text, for each replay.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use compare::Measured;
use replay::{Mode, Outcome};
use serde::Serialize;

use super::human_name;
use crate::status::Status;

/// One replay of one log.
#[derive(Serialize)]
pub(super) struct Run {
    pub(super) log: String,
    pub(super) output: Option<String>,
    pub(super) mode: &'static str,
    pub(super) human: Option<&'static str>,
    pub(super) controller: String,
    pub(super) steps: u64,
    pub(super) engaged_steps: u64,
    pub(super) output_hash: Option<String>,
    pub(super) identical_to_recorded: bool,
    pub(super) max_deviation: Option<f64>,
    pub(super) max_deviation_field: Option<&'static str>,
    pub(super) max_deviation_at_s: Option<f64>,
    /// Until when the recorded person is to be believed; the whole replay where nothing parted.
    pub(super) horizon_s: Option<f64>,
    /// When each criterion was first crossed.
    pub(super) horizon: Option<Crossings>,
    /// Greatest distance from the recorded state: 1 at half a metre or one radian.
    pub(super) furthest: Option<f64>,
    /// Metrics until the horizon; those of the whole run are in `tandem metrics`.
    pub(super) until_horizon: Option<BTreeMap<&'static str, Option<f64>>>,
    pub(super) realtime_factor: Option<f64>,
    pub(super) cpu_s: Option<f64>,
    pub(super) error: Option<String>,
    #[serde(skip)]
    pub(super) duration_s: f64,
    #[serde(skip)]
    pub(super) status: Status,
    /// For the ladder.
    #[serde(skip)]
    pub(super) measured: Option<Measured>,
}

/// First crossings, seconds; null where there was none.
#[derive(Serialize)]
#[expect(clippy::struct_field_names, reason = "they share their unit")]
pub(super) struct Crossings {
    pub(super) state_s: Option<f64>,
    pub(super) sensor_s: Option<f64>,
    pub(super) human_s: Option<f64>,
}

impl Run {
    /// A log that could not be replayed.
    pub(super) fn failed(
        log: &Path,
        mode: Mode,
        controller: &str,
        status: Status,
        error: String,
    ) -> Run {
        Run {
            log: log.display().to_string(),
            output: None,
            mode: mode.name(),
            human: human_name(mode),
            controller: controller.to_owned(),
            steps: 0,
            engaged_steps: 0,
            output_hash: None,
            identical_to_recorded: false,
            max_deviation: None,
            max_deviation_field: None,
            max_deviation_at_s: None,
            horizon_s: None,
            horizon: None,
            furthest: None,
            until_horizon: None,
            realtime_factor: None,
            cpu_s: None,
            error: Some(error),
            duration_s: 0.0,
            status,
            measured: None,
        }
    }

    /// A log that was replayed; files, times and status are for the caller to add.
    pub(super) fn of(log: &Path, mode: Mode, controller: &str, outcome: Outcome) -> Run {
        let deviation = outcome.max_deviation.as_ref();
        Run {
            steps: outcome.steps,
            engaged_steps: outcome.engaged_steps,
            max_deviation: deviation.map(|deviation| deviation.amount),
            max_deviation_field: deviation.map(|deviation| deviation.field),
            max_deviation_at_s: deviation.map(|deviation| deviation.t_s),
            output_hash: Some(outcome.output_hash),
            identical_to_recorded: outcome.identical_to_recorded,
            horizon_s: outcome.horizon.map(|h| h.first_s().unwrap_or(outcome.duration_s)),
            horizon: outcome.horizon.map(|horizon| Crossings {
                state_s: horizon.state_s,
                sensor_s: horizon.sensor_s,
                human_s: horizon.human_s,
            }),
            furthest: outcome.furthest,
            duration_s: outcome.duration_s,
            error: None,
            ..Run::failed(log, mode, controller, Status::Done, String::new())
        }
    }

    /// The run as a few lines.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        let (Some(hash), human) = (&self.output_hash, self.human) else {
            return format!("{}: not replayed\n", self.log);
        };
        let loop_name =
            human.map_or_else(|| self.mode.to_owned(), |h| format!("{} ({h})", self.mode));
        let _ = writeln!(text, "{}", self.log);
        let _ = writeln!(text, "  controller   {} · {loop_name} loop", self.controller);
        let _ = writeln!(
            text,
            "  steps        {} ({} with the feedback law driving)",
            self.steps, self.engaged_steps
        );
        let verdict = match (self.identical_to_recorded, self.max_deviation_field) {
            (true, _) => "identical, bit for bit".to_owned(),
            (false, Some(field)) => format!(
                "differs; most in {field}, by {:.6} at {:.2} s",
                self.max_deviation.unwrap_or(f64::NAN),
                self.max_deviation_at_s.unwrap_or(f64::NAN)
            ),
            (false, None) if self.error.is_some() => {
                "no difference as far as the log goes".to_owned()
            }
            (false, None) => "differs, though in no number of a step".to_owned(),
        };
        let _ = writeln!(text, "  recording    {verdict}");
        if let Some(horizon) = &self.horizon {
            let _ = writeln!(text, "  horizon      {}", self.horizon_text(horizon));
        }
        let _ = writeln!(text, "  hash         {hash}");
        if let Some(factor) = self.realtime_factor {
            let _ = writeln!(text, "  speed        {factor:.0} × real time");
        }
        if let Some(output) = &self.output {
            let _ = writeln!(text, "  written to   {output}");
        }
        text
    }

    fn horizon_text(&self, horizon: &Crossings) -> String {
        let crossings: Vec<String> = [
            ("state", horizon.state_s),
            ("sensors", horizon.sensor_s),
            ("person", horizon.human_s),
        ]
        .into_iter()
        .filter_map(|(name, at_s)| at_s.map(|at_s| format!("{name} at {at_s:.2} s")))
        .collect();
        if crossings.is_empty() {
            "the whole replay: nothing parted from the recording".to_owned()
        } else {
            format!(
                "{:.2} of {:.2} s (left the recording: {})",
                self.horizon_s.unwrap_or(f64::NAN),
                self.duration_s,
                crossings.join(", ")
            )
        }
    }
}
