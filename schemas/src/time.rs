//! Instants as integer nanoseconds, so that adding and comparing them never rounds.

use std::ops::Add;

/// Nanoseconds in one second.
pub const NS_PER_S: u64 = 1_000_000_000;

/// When simulated sessions start: 2025-01-01T00:00:00Z. Fixed, so that a simulation never depends
/// on the clock; far from 1970, because viewers misread times near zero.
pub const SIMULATION_EPOCH: Time = Time(1_735_689_600 * NS_PER_S);

/// An instant: nanoseconds since the Unix epoch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Time(pub u64);

impl Time {
    /// Seconds from `start` to `self`; negative when `self` is earlier.
    pub fn seconds_since(self, start: Time) -> f64 {
        if self >= start {
            (self.0 - start.0) as f64 / NS_PER_S as f64
        } else {
            -((start.0 - self.0) as f64 / NS_PER_S as f64)
        }
    }

    /// The span from `start` to `self`; zero when `self` is earlier.
    #[must_use]
    pub fn since(self, start: Time) -> Span {
        Span(self.0.saturating_sub(start.0))
    }

    /// The instant `ns` nanoseconds later, saturating at the end of time.
    #[must_use]
    pub fn after_ns(self, ns: u64) -> Time {
        Time(self.0.saturating_add(ns))
    }
}

impl Add<Span> for Time {
    type Output = Time;

    fn add(self, span: Span) -> Time {
        self.after_ns(span.0)
    }
}

/// A length of time in whole nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span(pub u64);

impl Span {
    /// The span nearest to `seconds`; zero for negative and NaN, saturating for huge values.
    pub fn from_seconds(seconds: f64) -> Span {
        // `as` saturates and takes NaN to zero, which is what is wanted here.
        Span(libm::round(seconds * NS_PER_S as f64) as u64)
    }

    /// The span in seconds.
    pub fn seconds(self) -> f64 {
        self.0 as f64 / NS_PER_S as f64
    }
}

/// A value and the instant at which it entered the log: the order of events.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamped<T> {
    /// The log time. Strictly increasing over a session, whatever the stamps inside the values say.
    pub at: Time,
    /// What happened.
    pub value: T,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_round_and_saturate() {
        assert_eq!(Span::from_seconds(0.1), Span(100_000_000));
        assert_eq!(Span::from_seconds(-1.0), Span(0));
        assert_eq!(Span::from_seconds(f64::NAN), Span(0));
        assert_eq!(Span::from_seconds(f64::INFINITY), Span(u64::MAX));
    }

    #[test]
    fn spans_between_are_not_negative() {
        assert_eq!(Time(5).since(Time(3)), Span(2));
        assert_eq!(Time(3).since(Time(5)), Span(0));
    }

    #[test]
    fn differences_are_signed() {
        let start = Time(5 * NS_PER_S);
        assert_eq!(Time(6 * NS_PER_S).seconds_since(start), 1.0);
        assert_eq!(Time(4 * NS_PER_S).seconds_since(start), -1.0);
    }
}
