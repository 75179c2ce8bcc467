//! Which loop, with which person, on which plant: the options that `replay` and `compare` share.

use std::time::Duration;

use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use replay::{Gains, Mode, Person};

/// Open or closed loop, and with which person.
#[derive(Args, Clone, Copy)]
pub struct How {
    /// Open loop (recorded sensors) or closed loop (recorded person, simulated robot)
    #[arg(long, value_enum, default_value_t = ModeName::Open)]
    pub mode: ModeName,
    /// How the recorded person is brought back in closed loop
    #[arg(long, value_enum, default_value_t = HumanName::Playback)]
    pub human: HumanName,
    /// Give up on a controller that does not answer for so many seconds; its log then has failed
    #[arg(long, default_value = "30", value_name = "SECONDS", value_parser = patience,
          allow_negative_numbers = true)]
    pub hang_after: Duration,
}

/// `--mode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ModeName {
    /// Recorded sensors in, outputs compared
    Open,
    /// Recorded person, simulated robot
    Closed,
}

/// `--human`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum HumanName {
    /// The joystick as a function of time: a person who does not look
    Playback,
    /// The joystick as a function of the distance travelled: one who never gives in
    Path,
    /// Where the joystick pointed, or the task's trajectory: an estimate with nothing fitted
    Intent,
    /// A person fitted to the logs, with what the fit leaves unexplained: an estimate
    Fitted,
    /// All of them, side by side
    Ladder,
}

/// `--plant`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PlantName {
    /// As the log's scenario has it
    Recorded,
    /// Identified from the log: commands against what wheels and gyro then showed
    Identified,
}

/// A span of real time.
pub fn patience(text: &str) -> Result<Duration, String> {
    let seconds = seconds(text).ok().filter(|seconds| *seconds > 0.0);
    let seconds = seconds.ok_or("expected more than 0 seconds, such as 30")?;
    Duration::try_from_secs_f64(seconds).map_err(|error| error.to_string())
}

pub(super) fn seconds(text: &str) -> Result<f64, String> {
    match text.trim_end_matches('s').parse::<f64>() {
        Ok(seconds) if seconds >= 0.0 && seconds.is_finite() => Ok(seconds),
        _ => Err("expected seconds from the start of the log, 0 or more, such as 12.5".to_owned()),
    }
}

impl HumanName {
    /// The levels that it names.
    pub fn levels(self, gains: Gains) -> Vec<Person> {
        match self {
            HumanName::Playback => vec![Person::Playback],
            HumanName::Path => vec![Person::Path],
            HumanName::Intent => vec![Person::Intent],
            HumanName::Fitted => vec![Person::Fitted(gains)],
            HumanName::Ladder => Person::ladder(gains).to_vec(),
        }
    }
}

impl ModeName {
    /// Refuses what would have no effect in open loop.
    pub fn refuse_without_effect(self, human: HumanName, plant: PlantName) -> Result<()> {
        let open = self == ModeName::Open;
        ensure!(
            !open || human == HumanName::Playback,
            "in open loop the recorded joystick is heard: --human goes with --mode closed"
        );
        ensure!(
            !open || plant == PlantName::Recorded,
            "in open loop the robot moves as recorded: --plant goes with --mode closed"
        );
        Ok(())
    }

    /// With the one person that it needs; of the ladder its last level.
    pub fn with(self, human: HumanName, gains: Gains) -> Mode {
        match self {
            ModeName::Open => Mode::Open,
            ModeName::Closed => Mode::Closed(human.levels(gains).pop().unwrap_or(Person::Playback)),
        }
    }

    /// Whether a fit is needed.
    pub fn needs_gains(self, human: HumanName) -> bool {
        self == ModeName::Closed && matches!(human, HumanName::Fitted | HumanName::Ladder)
    }
}
