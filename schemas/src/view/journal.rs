//! `/log`: who drives from now on, and why.

use foxglove::messages::{Log, log::Level};

use super::primitives::timestamp;
use crate::{Gap, Reason, Step, Time};

/// Notices what a reader of the log should be told.
#[derive(Debug, Default)]
pub(super) struct Journal {
    last: Option<(Driving, Reason)>,
}

/// Who drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Driving {
    Human,
    Feedback,
    Unknown,
}

impl Driving {
    /// From the sharing function k (13).
    pub(super) fn of(k: f64) -> Driving {
        if k == 1.0 {
            Driving::Human
        } else if k == 0.0 {
            Driving::Feedback
        } else {
            Driving::Unknown
        }
    }
}

impl Journal {
    /// A line, if the step changes who drives or why.
    pub(super) fn step(&mut self, at: Time, step: &Step) -> Option<Log> {
        let now = (Driving::of(step.k), step.reason);
        if self.last.replace(now) == Some(now) {
            return None;
        }
        let (driving, reason) = now;
        let who = match driving {
            Driving::Human => "k = 1: the person drives".to_owned(),
            Driving::Feedback => "k = 0: the feedback law drives".to_owned(),
            Driving::Unknown => format!("k = {}", step.k),
        };
        let distance = if step.distance_human_m.is_finite() {
            format!(", D = {:.3} m", step.distance_human_m)
        } else {
            String::new()
        };
        let message = format!("{who} ({}{distance})", reason.name());
        Some(line(at, level(driving, reason), "sharing", message))
    }
}

/// A line about a drop-out.
pub(super) fn gap(at: Time, gap: &Gap) -> Log {
    let seconds = gap.end.seconds_since(gap.start);
    let message = format!("nothing on {} for {seconds:.3} s: {}", gap.stream, gap.cause);
    line(at, Level::Warning, "recorder", message)
}

/// The feedback law taking over is a warning, not being able to trust an input an error.
fn level(driving: Driving, reason: Reason) -> Level {
    match reason {
        Reason::Contact
        | Reason::JoystickInvalid
        | Reason::PoseInvalid
        | Reason::OdometryStale
        | Reason::SensorsDead
        | Reason::DistanceUnknown
        | Reason::FeedbackInvalid => Level::Error,
        _ if driving == Driving::Human => Level::Info,
        _ => Level::Warning,
    }
}

fn line(at: Time, level: Level, name: &str, message: String) -> Log {
    Log {
        timestamp: Some(timestamp(at)),
        level: level as i32,
        message,
        name: name.to_owned(),
        file: String::new(),
        line: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(k: f64, reason: Reason, distance_human_m: f64) -> Step {
        Step { distance_human_m, k, reason, ..Step::unknown(Time(7), 0) }
    }

    #[test]
    fn a_line_is_written_when_something_changes_and_only_then() {
        let mut journal = Journal::default();
        let mut write = |k, reason, distance| {
            journal.step(Time(9), &step(k, reason, distance)).map(|log| (log.level, log.message))
        };
        let info = Level::Info as i32;
        let warning = Level::Warning as i32;
        let error = Level::Error as i32;
        let line = |level, text: &str| Some((level, text.to_owned()));
        assert_eq!(
            write(1.0, Reason::Human, 0.5),
            line(info, "k = 1: the person drives (human, D = 0.500 m)")
        );
        assert_eq!(write(1.0, Reason::Human, 0.4), None);
        assert_eq!(
            write(0.0, Reason::Danger, 0.31),
            line(warning, "k = 0: the feedback law drives (danger, D = 0.310 m)")
        );
        assert_eq!(write(0.0, Reason::Danger, 0.3), None);
        assert_eq!(
            write(0.0, Reason::SensorsDead, f64::NAN),
            line(error, "k = 0: the feedback law drives (sensors_dead)")
        );
        assert_eq!(
            write(f64::NAN, Reason::Unspecified, f64::NAN),
            line(warning, "k = NaN (unspecified)")
        );
    }

    #[test]
    fn a_gap_names_stream_length_and_cause() {
        let dropout = Gap {
            stream: "/sonar".to_owned(),
            start: Time(1_000_000_000),
            end: Time(1_250_000_000),
            cause: "unplugged".to_owned(),
            stamp: Time(1_250_000_000),
        };
        let log = gap(Time(1_250_000_000), &dropout);
        assert_eq!(log.message, "nothing on /sonar for 0.250 s: unplugged");
    }
}
