//! What `tandem replay` says: one line of JSON, or a few of text, for each replay.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use compare::report::with_unit;
use compare::{CATALOGUE, FirstCause, Measured};
use replay::{AxisDoubt, Estimate, Mode, Outcome, PlantDoubt, PlantEstimate, WarmUp};
use serde::Serialize;

use super::destination::human_name;
use crate::faults;
use crate::interrupt::Interrupted;
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
    pub(super) max_deviation_unit: Option<&'static str>,
    pub(super) max_deviation_at_s: Option<f64>,
    /// What differs first between recording, A, and replay, B.
    pub(super) first_cause: Option<FirstCause>,
    /// Until when the recorded person is to be believed; the whole replay where nothing parted.
    pub(super) horizon_s: Option<f64>,
    /// When each criterion was first crossed.
    pub(super) horizon: Option<Crossings>,
    /// Greatest distance from the recorded state: 1 at half a metre or one radian.
    pub(super) furthest: Option<f64>,
    /// Metrics until the horizon; those of the whole run are in `tandem metrics`.
    pub(super) until_horizon: Option<BTreeMap<&'static str, Option<f64>>>,
    /// Where only a part was replayed: whether its beginning is what the whole log gives.
    pub(super) warm_up: Option<&'static str>,
    /// With `--plant identified`: what the log shows of its plant.
    pub(super) plant: Option<Plant>,
    /// Where the log is clearly at odds with the plant that it claims, and that was driven.
    pub(super) plant_doubt: Option<Doubt>,
    /// With `--floor`: how far each metric of the recording controller's replay is from the recorded.
    pub(super) floor: Option<BTreeMap<&'static str, f64>>,
    /// The faults that met nothing that they could change.
    pub(super) unmet_faults: Vec<String>,
    /// Where the log begins in the middle of its session, seconds from the session's start.
    pub(super) begins_late_s: Option<f64>,
    pub(super) realtime_factor: Option<f64>,
    pub(super) cpu_s: Option<f64>,
    /// What is wrong with the log, where it could be replayed in part only.
    pub(super) damage: Option<String>,
    pub(super) error: Option<String>,
    /// Where the part that was replayed begins, seconds from the start of the log.
    #[serde(skip)]
    pub(super) from_s: f64,
    /// The recorded control period, seconds.
    #[serde(skip)]
    pub(super) period_s: f64,
    #[serde(skip)]
    pub(super) duration_s: f64,
    /// The last thing replayed, seconds from the start of the log.
    #[serde(skip)]
    pub(super) end_s: f64,
    /// Whether Ctrl-C kept it from being replayed to its end.
    #[serde(skip)]
    pub(super) interrupted: bool,
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

impl Crossings {
    /// Whether nothing was crossed.
    pub(super) fn never(&self) -> bool {
        [self.state_s, self.sensor_s, self.human_s] == [None; 3]
    }
}

/// What a log shows of its plant; null where it shows nothing.
#[derive(Serialize)]
pub(super) struct Plant {
    gain_v: Option<Range>,
    gain_omega: Option<Range>,
    delay_s: Option<Range>,
    accel_mps2: Option<Range>,
    alpha_radps2: Option<Range>,
    slip: Option<Range>,
    /// Why it shows nothing at all.
    untold: Option<String>,
}

/// That a plant is not the recorded one; the numbers stand with the result.
const CONTRADICTED: &str = "the log contradicts the plant that it claims";

/// What to do about it.
const WAY_OUT: &str = "--plant identified drives what the log shows";

/// A claimed plant that the log contradicts, and what it shows instead.
#[derive(Serialize)]
pub(super) struct Doubt {
    says: String,
    claimed: schemas::Plant,
    found: Plant,
    /// What either leaves unexplained of the speeds, root mean square; null where the claim does.
    forwards: Option<Rest>,
    turning: Option<Rest>,
}

/// m/s forwards, rad/s turning.
#[derive(Serialize)]
struct Rest {
    claimed: f64,
    found: f64,
}

impl Doubt {
    pub(super) fn of(doubt: &PlantDoubt) -> Doubt {
        let rest = |axis: Option<AxisDoubt>| {
            axis.map(|axis| Rest { claimed: axis.claimed_rest, found: axis.found_rest })
        };
        Doubt {
            says: doubt.to_string(),
            claimed: doubt.claimed,
            found: Plant::of(&doubt.found),
            forwards: rest(doubt.forwards),
            turning: rest(doubt.turning),
        }
    }
}

/// A value with its range of 95 % confidence; null stands for a limit that was not felt.
#[derive(Serialize)]
struct Range {
    value: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
}

impl Plant {
    pub(super) fn of(found: &PlantEstimate) -> Plant {
        let range = |estimate: Option<Estimate>| {
            let finite = |value: f64| value.is_finite().then_some(value);
            estimate.map(|estimate| Range {
                value: finite(estimate.value),
                low: finite(estimate.low),
                high: finite(estimate.high),
            })
        };
        Plant {
            gain_v: range(found.gain_v),
            gain_omega: range(found.gain_omega),
            delay_s: range(found.delay_s),
            accel_mps2: range(found.accel_mps2),
            alpha_radps2: range(found.alpha_radps2),
            slip: range(found.slip),
            untold: found.untold.map(|why| why.to_string()),
        }
    }

    fn text(&self) -> String {
        if let Some(why) = &self.untold {
            return format!("as claimed: nothing could be identified, since {why}");
        }
        let fields = [
            ("delay", "s", &self.delay_s),
            ("acceleration", "m/s²", &self.accel_mps2),
            ("angular acceleration", "rad/s²", &self.alpha_radps2),
            ("slip", "", &self.slip),
        ];
        let known = fields.into_iter().filter_map(|(name, unit, range)| {
            let range = range.as_ref()?;
            Some(match (range.value, range.low, range.high) {
                (Some(value), Some(low), Some(high)) => {
                    format!("{name} {value:.3} {unit} ({low:.3}–{high:.3})")
                }
                (Some(value), ..) => format!("{name} {value:.3} {unit}, or none"),
                _ => format!("{name} not limited"),
            })
        });
        known.collect::<Vec<_>>().join(", ")
    }
}

impl Run {
    /// A log that could not be replayed.
    pub(super) fn failed(log: &Path, mode: Mode, controller: &str, error: &anyhow::Error) -> Run {
        Run {
            error: Some(format!("{error:#}")),
            status: Status::of_error(error),
            interrupted: Interrupted::caused(error),
            ..Run::blank(log, mode, controller)
        }
    }

    /// A run of which nothing is known yet.
    fn blank(log: &Path, mode: Mode, controller: &str) -> Run {
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
            max_deviation_unit: None,
            max_deviation_at_s: None,
            first_cause: None,
            horizon_s: None,
            horizon: None,
            furthest: None,
            until_horizon: None,
            warm_up: None,
            plant: None,
            plant_doubt: None,
            floor: None,
            from_s: 0.0,
            period_s: 0.0,
            realtime_factor: None,
            cpu_s: None,
            damage: None,
            error: None,
            unmet_faults: Vec::new(),
            begins_late_s: None,
            duration_s: 0.0,
            end_s: 0.0,
            interrupted: false,
            status: Status::Done,
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
            max_deviation_unit: deviation.map(|deviation| deviation.unit),
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
            warm_up: outcome.warm_up.map(|warm_up| match warm_up {
                WarmUp::Exact => "exact",
                WarmUp::Differs => "differs",
            }),
            damage: outcome.damage,
            duration_s: outcome.duration_s,
            end_s: outcome.end_s,
            unmet_faults: outcome.unmet_faults.iter().map(faults::unmet).collect(),
            // Where a part was asked for, it is the part that begins there.
            begins_late_s: outcome.begins_late_s.filter(|_| outcome.warm_up.is_none()),
            ..Run::blank(log, mode, controller)
        }
    }

    /// Whether there is a result, be it of a part.
    pub(super) fn is_replayed(&self) -> bool {
        self.output_hash.is_some()
    }

    /// What is to be known about it before it is believed. `to_s`: where it was to end.
    pub(super) fn warnings(&self, to_s: Option<f64>) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.plant_doubt.is_some() {
            warnings.push(format!("{CONTRADICTED}; {WAY_OUT}"));
        }
        warnings.extend(self.unmet_faults.iter().cloned());
        if let Some(t_s) = self.begins_late_s {
            warnings.push(format!(
                "the log begins in the middle of its session, at {t_s:.2} s: what its controller had learnt \
                 until then is not in it, and a closed loop drives from the session's start; replay the whole \
                 log with --from {t_s:.2}"
            ));
        }
        // A log ends within a period of its last step; what ended it early is told by itself.
        let whole = self.is_replayed() && self.error.is_none();
        if let Some(to_s) = to_s.filter(|to_s| whole && *to_s > self.end_s + self.period_s) {
            warnings.push(format!("--to {to_s} is beyond its end at {:.2} s", self.end_s));
        }
        warnings
    }

    /// The run as a few lines.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        let (Some(hash), human) = (&self.output_hash, self.human) else {
            // What was not begun is counted elsewhere.
            return if self.interrupted { text } else { format!("{}: not replayed\n", self.log) };
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
        text.push_str(&self.recording_text());
        if let Some(horizon) = &self.horizon {
            let _ = writeln!(text, "  horizon      {}", self.horizon_text(horizon));
        }
        if let Some(plant) = &self.plant {
            let _ = writeln!(text, "  plant        {}", plant.text());
        }
        if let Some(doubt) = &self.plant_doubt {
            let _ = writeln!(text, "  plant        ! {}", doubt.says);
        }
        for unmet in &self.unmet_faults {
            let _ = writeln!(text, "  fault        ! {unmet}");
        }
        if let Some(floor) = &self.floor {
            let _ = writeln!(text, "  floor        {}", floor_text(floor));
        }
        if self.warm_up == Some("differs") {
            let _ = writeln!(
                text,
                "  warm-up      the simulation did not follow the log: the part begins elsewhere"
            );
        }
        let _ = writeln!(text, "  hash         {hash}");
        if let Some(factor) = self.realtime_factor {
            let _ = writeln!(text, "  speed        {factor:.0} × real time");
        }
        if let Some(output) = &self.output {
            let _ = writeln!(text, "  written to   {output} (A recorded, B replayed)");
        }
        text
    }

    /// How the replay stands to the recording.
    fn recording_text(&self) -> String {
        let verdict = match (self.identical_to_recorded, &self.first_cause) {
            (true, _) => "identical, bit for bit",
            (false, Some(_)) => "differs (A recorded, B replayed)",
            (false, None) if self.error.is_some() => "no difference as far as the log goes",
            (false, None) => "differs, though in nothing that a step says",
        };
        let mut text = format!("  recording    {verdict}\n");
        if let Some(first) = &self.first_cause {
            let _ = writeln!(text, "    first      {}", first.reason);
        }
        if let (Some(field), Some(amount)) = (self.max_deviation_field, self.max_deviation) {
            let at_s = self.max_deviation_at_s.unwrap_or(f64::NAN);
            let _ = if amount.is_infinite() {
                let rest = "`tandem diff` has the rest";
                writeln!(
                    text,
                    "    most       {field} is known to one of both only at {at_s:.2} s ({rest})"
                )
            } else {
                let amount =
                    with_unit(&format!("{amount:.6}"), self.max_deviation_unit.unwrap_or_default());
                writeln!(text, "    most       {field}, by {amount} at {at_s:.2} s")
            };
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
            let part = if self.from_s > 0.0 {
                format!("{:.2} to {:.2} s", self.from_s, self.from_s + self.duration_s)
            } else {
                format!("{:.2} s", self.duration_s)
            };
            format!(
                "{:.2} of {part} (left the recording: {})",
                self.horizon_s.unwrap_or(f64::NAN),
                crossings.join(", ")
            )
        }
    }
}

/// By how much a replay of the recording controller misses the metrics that a verdict goes by.
fn floor_text(floor: &BTreeMap<&'static str, f64>) -> String {
    let off: Vec<String> = CATALOGUE
        .iter()
        .filter(|metric| metric.primary)
        .filter_map(|metric| floor.get(metric.name).map(|off| (metric.name, *off)))
        .filter(|(_, off)| *off != 0.0)
        .map(|(name, off)| format!("{name} {off:.3}"))
        .collect();
    if off.is_empty() {
        "0 in every metric that a verdict goes by".to_owned()
    } else {
        format!("{} off by the replay alone (all metrics: --format json)", off.join(", "))
    }
}
