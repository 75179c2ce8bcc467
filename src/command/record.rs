//! `tandem record`: a session into a log.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, anyhow, bail, ensure};
use clap::{Args, ValueEnum};
use recorder::{Pace, RecordError, Recorded, Simulated};
use schemas::log::WriterOptions;
use schemas::{Driver, Event, RunInfo, SIMULATION_EPOCH, Scenario, SensorSuite, Span};

use crate::cli::{Common, Format};
use crate::command::info;
use crate::controller_choice::ControllerChoice;
use crate::status::Status;
use crate::{interrupt, logs, output};

/// Record a session into a log.
///
/// The simulated robot is driven by a scripted person and the chosen controller together. Every
/// sensor reading, joystick sample and controller step goes into an MCAP file that opens in
/// Foxglove with a picture, and that `tandem replay` can bring back.
#[derive(Args)]
#[command(after_help = "\
Examples:
  tandem record -o session.mcap
  tandem record --scenario random:disc:goal:7 --controller human --seed 3 -o h7.mcap
  tandem record --controller tandem-kinematic:gamma3=2.5 --sensors exact -o try.mcap

The log can be read while it grows, and after a crash as far as it got. With --force, a log that is
there already stays until the new one is whole, which grows beside it as LOG.unfinished.")]
pub struct Record {
    /// Where the session happens: `sim`, the simulation
    #[arg(long, default_value = "sim", value_name = "SOURCE")]
    pub from: String,
    /// Scenario by name (see `tandem scenarios`), `random:…`, or a TOML file
    #[arg(long, default_value = "case1-lab", value_name = "S")]
    pub scenario: String,
    /// Controller that shares the robot (see `tandem controllers`)
    #[arg(long, default_value = "tandem-kinematic", value_name = "C")]
    pub controller: ControllerChoice,
    /// Who steers [default: the scenario's]
    #[arg(long, value_enum)]
    pub driver: Option<DriverName>,
    /// Sensor suite [default: the scenario's]
    #[arg(long, value_enum)]
    pub sensors: Option<SensorsName>,
    /// Seed of sensor, hand and actuator noise
    #[arg(long, default_value_t = 0, value_name = "N", allow_negative_numbers = true)]
    pub seed: u64,
    /// How long, in seconds [default: the scenario's]
    #[arg(long, value_name = "SECONDS", value_parser = positive_seconds, allow_negative_numbers = true)]
    pub duration: Option<f64>,
    /// Who was driving; kept in the log and shown in reports
    #[arg(long, default_value = "", value_name = "NAME", hide_default_value = true)]
    pub operator: String,
    /// Anything worth remembering about the session
    #[arg(long, default_value = "", value_name = "TEXT", hide_default_value = true)]
    pub note: String,
    /// Run no faster than the clock
    #[arg(long)]
    pub realtime: bool,
    /// Leave out the topics that are for viewers only (/tf, /pose, /scene, …): a smaller log
    #[arg(long)]
    pub no_view: bool,
    /// The log to write
    #[arg(long, short, value_name = "LOG")]
    pub output: PathBuf,
}

/// `--driver`.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum DriverName {
    /// Pursues the task's target
    Goal,
    /// Plays the scenario's joystick script
    Script,
    /// Moves the joystick freely, at random
    Joystick,
    /// Wants to be at places: acts and waits, errs, backs off when blocked
    Hesitant,
    /// Wants to be at places: steers around what stands in the way, as walkers do
    Flowing,
    /// Drives on until something is ahead, then turns away
    Explorer,
    /// Follows the task's target with a sluggish hand and lapses
    Tracker,
}

/// `--sensors`.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum SensorsName {
    /// Exact rays from the true pose
    Exact,
    /// Sixteen sonars, IMU and encoders
    Sonar,
}

/// The longest session, seconds: beyond a day it is a slip of the finger that fills the disk.
const LONGEST_S: f64 = 86_400.0;

fn positive_seconds(text: &str) -> Result<f64, String> {
    match text.trim_end_matches('s').parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= LONGEST_S => Ok(seconds),
        _ => Err(format!("expected a positive number of seconds, at most {LONGEST_S} (a day)")),
    }
}

impl Record {
    pub fn run(&self, common: &Common) -> Result<Status> {
        if self.from != "sim" {
            bail!("source `{}` is not supported by this version: only `sim` is", self.from);
        }
        let recorded = self.record(common)?;
        let log = schemas::log::inspect(&self.output)
            .with_context(|| self.output.display().to_string())?;
        if common.format == Format::Json {
            info::print(common, &self.output, &log)?;
        } else {
            output::say(
                common,
                &format!(
                    "{}: {:.1} s, {} steps, feedback drove in {}{}",
                    self.output.display(),
                    log.duration_s,
                    recorded.steps,
                    recorded.engaged_steps,
                    if recorded.interrupted { " (interrupted; the log is whole)" } else { "" },
                ),
            );
        }
        Ok(Status::Done)
    }

    /// Records without telling; also the way in for `demo`.
    pub fn record(&self, common: &Common) -> Result<Recorded> {
        let mut scenario = scenario(&self.scenario)?;
        if let Some(duration_s) = self.duration {
            scenario.duration_s = duration_s;
        }
        let driver = self.driver.map_or(scenario.driver, |driver| match driver {
            DriverName::Goal => Driver::Goal,
            DriverName::Script => Driver::Script,
            DriverName::Joystick => Driver::Joystick,
            DriverName::Hesitant => Driver::Hesitant,
            DriverName::Flowing => Driver::Flowing,
            DriverName::Explorer => Driver::Explorer,
            DriverName::Tracker => Driver::Tracker,
        });
        let sensors = self.sensors.map_or(scenario.sensors, |sensors| match sensors {
            SensorsName::Exact => SensorSuite::Exact,
            SensorsName::Sonar => SensorSuite::Sonar,
        });
        ensure!(
            scenario.duration_s <= LONGEST_S,
            "scenario {}: duration_s = {} is more than {LONGEST_S} (a day)",
            scenario.name,
            scenario.duration_s
        );
        let spec = self.controller.for_scenario(&scenario)?;
        let (start, duration) = (SIMULATION_EPOCH, Span::from_seconds(scenario.duration_s));
        output::detail(common, || {
            format!("{}: {} with\n{}", self.output.display(), scenario.name, spec.params_toml())
        });
        let simulated =
            Simulated { sensors, driver, seed: self.seed, ..Simulated::of(spec, scenario) };
        let (simulation, runner) = simulated.begin()?;
        let run = RunInfo {
            operator: self.operator.clone(),
            note: self.note.clone(),
            ..simulated.header().run
        };
        let Simulated { spec, scenario, .. } = simulated;
        let header = logs::header(&spec, scenario, start, runner.control_period(), run);

        logs::guard(&self.output, common.force)?;
        let place = Place::of(&self.output)?;
        let path = || place.growing.display().to_string();
        let rhythm =
            if self.realtime { WriterOptions::default() } else { WriterOptions::offline() };
        let options = WriterOptions { view: !self.no_view, ..rhythm };
        let log = schemas::log::create(&place.growing, &header, &options).with_context(path)?;

        let bar = output::bar(
            common,
            duration.0 / 1_000_000,
            "recording",
            "{msg:38} {bar:30} {percent}% {eta}",
        );
        let pace = self.realtime.then(|| Pace::new(start));
        let recorded = recorder::record(simulation, runner, log, |event| {
            if let Some(pace) = &pace {
                pace.wait_for(event.at);
            }
            if let (Event::Step(step), false) = (&event.value, bar.is_hidden()) {
                bar.set_message(signal(step.k, step.danger));
            }
            bar.set_position(event.at.0.saturating_sub(start.0) / 1_000_000);
            !interrupt::pressed()
        });
        bar.finish_and_clear();
        let recorded = recorded.map_err(|error| match error {
            RecordError::Log(error) => anyhow!(error).context(path()),
            RecordError::Source(never) => match never {},
        })?;
        place.settle()?;
        Ok(recorded)
    }
}

/// Where a log is recorded. It grows in its own place, so that a crash leaves what was recorded; where
/// another stands there, beside it, so that a crash leaves that one too.
struct Place {
    growing: PathBuf,
    /// The log that it is to replace.
    old: Option<PathBuf>,
}

impl Place {
    fn of(output: &Path) -> Result<Place> {
        // A pipe or a device takes what is written to it, and is not to be replaced.
        if !output.is_file() {
            return Ok(Place { growing: output.to_owned(), old: None });
        }
        // What a link points to is replaced, not the link.
        let old = fs::canonicalize(output).with_context(|| output.display().to_string())?;
        Ok(Place { growing: output::unfinished(&old), old: Some(old) })
    }

    /// Puts the log, which is whole now, where it was asked for.
    fn settle(&self) -> Result<()> {
        let Some(old) = &self.old else { return Ok(()) };
        fs::rename(&self.growing, old)
            .with_context(|| format!("{} cannot be put in place", self.growing.display()))
    }
}

/// Who drives and how near danger is, as a person sees it while recording:
/// `person drives, danger 0.4 ####......`.
fn signal(k: f64, danger: f64) -> String {
    const TENTHS: &str = "##########..........";
    let who = if k == 1.0 { "person drives" } else { "law drives" };
    if danger.is_nan() {
        return format!("{who}, danger not known");
    }
    let danger = danger.clamp(0.0, 1.0);
    let filled = (10.0 * danger).round() as usize;
    format!("{:14} danger {danger:.1} {}", format!("{who},"), &TENTHS[10 - filled..20 - filled])
}

/// A scenario by name, or from a TOML file.
pub fn scenario(name: &str) -> Result<Scenario> {
    if Path::new(name).extension().is_some_and(|extension| extension == "toml") {
        let text =
            fs::read_to_string(name).with_context(|| format!("cannot read scenario {name}"))?;
        return Scenario::from_toml(&text).with_context(|| format!("scenario {name}"));
    }
    Ok(simulator::scenario(name)?)
}

#[cfg(test)]
mod tests {
    use super::signal;

    #[test]
    fn the_signal_grows_with_danger() {
        assert_eq!(signal(1.0, 0.0), "person drives, danger 0.0 ..........");
        assert_eq!(signal(1.0, 0.42), "person drives, danger 0.4 ####......");
        assert_eq!(signal(0.0, 1.0), "law drives,    danger 1.0 ##########");
        assert_eq!(signal(0.0, 9.0), signal(0.0, 1.0));
        assert_eq!(signal(0.0, f64::NAN), "law drives, danger not known");
    }
}
