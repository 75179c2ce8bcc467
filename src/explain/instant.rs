//! `--at`: seconds from the start of a log, or an instant of the calendar.

use std::str::FromStr;

use anyhow::{Result, anyhow, bail};
use schemas::{Span, Time};

/// A time as a user writes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Instant {
    /// Seconds from the start of the log.
    Seconds(f64),
    /// An instant, as in ISO 8601.
    Absolute(Time),
}

impl Instant {
    /// The instant in a log that starts at `start`; `None` where it is before the start.
    pub fn in_log(self, start: Time) -> Option<Time> {
        match self {
            Instant::Seconds(seconds) if seconds < 0.0 => None,
            Instant::Seconds(seconds) => Some(start + Span::from_seconds(seconds)),
            Instant::Absolute(time) => Some(time).filter(|time| *time >= start),
        }
    }

    /// Seconds from `start`.
    pub fn seconds(self, start: Time) -> f64 {
        match self {
            Instant::Seconds(seconds) => seconds,
            Instant::Absolute(time) => time.seconds_since(start),
        }
    }
}

impl FromStr for Instant {
    type Err = anyhow::Error;

    fn from_str(typed: &str) -> Result<Instant> {
        if let Ok(seconds) = typed.trim_end_matches('s').trim_end().parse::<f64>() {
            if !seconds.is_finite() {
                bail!("`{typed}` is no time");
            }
            return Ok(Instant::Seconds(seconds));
        }
        let timestamp: jiff::Timestamp = typed.parse().map_err(|_| {
            anyhow!(
                "`{typed}` is no time: write seconds from the start of the log, as 12.4, or an \
                 instant with its zone, as 2025-01-01T00:00:12.4Z"
            )
        })?;
        let ns = u64::try_from(timestamp.as_nanosecond());
        Ok(Instant::Absolute(Time(ns.map_err(|_| anyhow!("`{typed}` is before 1970"))?)))
    }
}

/// An instant as ISO 8601, to the millisecond.
pub fn iso(time: Time) -> String {
    i64::try_from(time.0)
        .ok()
        .and_then(|ns| jiff::Timestamp::from_nanosecond(i128::from(ns)).ok())
        .map_or_else(|| "unknown".to_owned(), |instant| format!("{instant:.3}"))
}

#[cfg(test)]
mod tests {
    use schemas::SIMULATION_EPOCH;

    use super::*;

    #[test]
    fn seconds_and_instants_mean_the_same() {
        let later = SIMULATION_EPOCH.after_ns(12_400_000_000);
        for typed in
            ["12.4", "12.4 s", "12.4s", "2025-01-01T00:00:12.4Z", "2025-01-01T01:00:12.4+01:00"]
        {
            let instant: Instant = typed.parse().unwrap();
            assert_eq!(instant.in_log(SIMULATION_EPOCH), Some(later), "{typed}");
            assert!((instant.seconds(SIMULATION_EPOCH) - 12.4).abs() < 1e-9);
        }
        assert_eq!(iso(later), "2025-01-01T00:00:12.400Z");
    }

    #[test]
    fn what_is_no_time_is_refused() {
        for typed in ["", "soon", "NaN", "inf", "2025-01-01T00:00:12"] {
            assert!(typed.parse::<Instant>().is_err(), "{typed}");
        }
        let early: Instant = "-1".parse().unwrap();
        assert_eq!(early.in_log(SIMULATION_EPOCH), None);
    }
}
