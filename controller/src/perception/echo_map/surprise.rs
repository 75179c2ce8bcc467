//! Echoes that contradict what their sonar heard just before.
//!
//! A sonar that hears another one's sound reports something near by where nothing stands. To take that for a
//! thing at once stops the robot, or takes the person's control away, for nothing; never to do so runs into
//! what steps out from behind a corner. What tells them apart is that a thing does not come alone: a sonar
//! that heard far away one sweep ago hears something nearer only if that came nearer meanwhile, or came in
//! from beside, where the next sonar hears it too.

use schemas::{SONARS, Span, Time};

use super::cones::{Cones, Reading};

/// What came nearer by more than this from one firing to the next did not come by itself, metres: a robot at
/// 0.7 m/s and someone at 0.3 m/s approach each other by 0.32 m in a sweep of 0.32 s; and the noise of two
/// ranges.
const LEAP_M: f64 = 0.35;

/// Something beside is one that it may be part of if it is heard no farther away than this beyond it, metres.
/// Chosen: the width of a person.
const BESIDE_M: f64 = 0.3;

/// Readings older than this say nothing about now: two sweeps are 0.64 s, one that was missed included.
const RECENT: Span = Span(700_000_000);

/// Whether an echo of the sonar `id` from `range_m`, heard at `fired`, is not to count before another firing
/// hears it too. `cones` still hold the reading before it.
pub(super) fn surprises(cones: &Cones, id: usize, range_m: f64, fired: Time) -> bool {
    let recent = |id: usize| {
        let at = cones.fired(id)?;
        (fired.since(at) <= RECENT).then(|| cones.reading(id))
    };
    let leaps = matches!(recent(id), Some(Reading::Echo(before_m)) if before_m > range_m + LEAP_M);
    // They are numbered around the robot. Nothing known is no proof that nothing is there.
    let alone = [id + 1, id + SONARS.len() - 1].into_iter().all(|beside| {
        match recent(beside % SONARS.len()) {
            Some(Reading::Echo(beside_m)) => beside_m >= range_m + BESIDE_M,
            Some(Reading::Silent) => true,
            Some(Reading::Unknown) | None => false,
        }
    });
    leaps && alone
}
