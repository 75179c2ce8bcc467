//! Echoes that contradict what was heard around them just before.
//!
//! A sonar that hears another one's sound reports something near by where nothing stands. To take that for a
//! thing at once stops the robot, or takes the person's control away, for nothing; never to do so runs into
//! what steps out from behind a corner. What tells them apart is that a thing does not come alone: a sonar
//! that heard far away one sweep ago hears something nearer only if that came nearer meanwhile, or came in
//! from beside, where another sonar has heard it, be it a while ago: someone who walks past a blind gap is
//! heard by nobody there.

use schemas::{SONARS, Span, Time};

use super::cones::{Cones, Reading};
use crate::digest::Digest;

/// What was heard is a thing that an echo may be part of if it is no farther away than this beyond it, metres.
/// Chosen: the width of a person.
const BESIDE_M: f64 = 0.3;

/// Something heard a while ago may have changed its range this fast since, m/s. Chosen: of 2520 people who cross
/// under each `tandem-*` version 7 are then met by a robot that moves towards them, at up to 0.05 m/s (8 if no
/// echo is passed over); 11 with 0.4, 14 with 0, at up to 0.27 m/s.
const MOVED_MPS: f64 = 0.8;

/// Readings older than this say nothing about now: two sweeps are 0.64 s, one that was missed included.
const RECENT: Span = Span(700_000_000);

/// How long something near is reckoned with after it was heard: a person takes 0.6 s to cross a blind gap 0.5 m
/// away at 0.3 m/s, and two sonars may take a sweep more each, one missed. With 0.7 s it is 9 of those.
const LATELY: Span = Span(1_500_000_000);

/// What each sonar has heard near by of late, be it false itself: two echoes out of nowhere in a row count.
#[derive(Clone, Debug)]
pub(super) struct Nearby {
    /// When, and how far away, metres.
    heard: [Option<(Time, f64)>; SONARS.len()],
}

impl Nearby {
    pub(super) fn new() -> Nearby {
        Nearby { heard: [None; SONARS.len()] }
    }

    /// Takes an echo of the sonar `id` from `range_m`. One from beyond where the thing that was near may be by
    /// now does not let it be forgotten.
    pub(super) fn hear(&mut self, id: usize, range_m: f64, fired: Time) {
        let beyond = self.may_be_m(id, fired).is_some_and(|[_, farthest_m]| range_m > farthest_m);
        if !beyond {
            self.heard[id] = Some((fired, range_m));
        }
    }

    /// Whether an echo of the sonar `id` from `range_m`, heard at `fired`, is not to count before another firing
    /// hears it too. `cones` still hold the reading before it.
    pub(super) fn surprised(&self, cones: &Cones, id: usize, range_m: f64, fired: Time) -> bool {
        let recent = |id: usize| {
            let at = cones.fired(id)?;
            (fired.since(at) <= RECENT).then(|| cones.reading(id))
        };
        let looked_past =
            matches!(recent(id), Some(Reading::Echo(before_m)) if before_m >= range_m + BESIDE_M);
        // They are numbered around the robot.
        let on_either_side =
            |by: usize| [id + by, id + SONARS.len() - by].map(|id| id % SONARS.len());
        // Nothing known is no proof that nothing is there.
        let silent_beside = || {
            on_either_side(1).into_iter().all(|beside| match recent(beside) {
                Some(Reading::Echo(beside_m)) => beside_m >= range_m + BESIDE_M,
                Some(Reading::Silent) => true,
                Some(Reading::Unknown) | None => false,
            })
        };
        // What it heard itself before it looked past it is no less there.
        let may_be_part = |beside: usize| {
            self.may_be_m(beside, fired)
                .is_some_and(|[nearest_m, _]| nearest_m < range_m + BESIDE_M)
        };
        let alone = || !(0..=2).flat_map(on_either_side).any(may_be_part);
        looked_past && silent_beside() && alone()
    }

    /// Between which ranges of the sonar `id` what it has heard near by of late may be at `now`, metres.
    fn may_be_m(&self, id: usize, now: Time) -> Option<[f64; 2]> {
        let (fired, range_m) = self.heard[id]?;
        let moved_m = MOVED_MPS * now.seconds_since(fired);
        (now.since(fired) <= LATELY).then_some([range_m - moved_m, range_m + moved_m])
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        for heard in &self.heard {
            digest.word(u64::from(heard.is_some()));
            if let Some((fired, range_m)) = heard {
                digest.time(*fired, start);
                digest.number(*range_m);
            }
        }
    }
}
