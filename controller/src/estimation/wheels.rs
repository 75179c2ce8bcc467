//! What the wheels' counters say, and whether they can be believed.

use schemas::{EncoderSample, Time};

use crate::digest::Digest;

/// Wheels that say they went faster than this, m/s, have lost count. The Pioneer 3-AT reaches 1.2.
const FASTEST_WHEEL_MPS: f64 = 2.5;

/// Wheels slower than this, m/s, and without travel, stand still.
const STANDING_MPS: f64 = 1e-3;

/// For how long the wheels must stand before the robot is taken to stand, seconds. Longer than a body
/// takes to stop shaking, short within the 0.3 s of standing at the start.
const STANDING_S: f64 = 0.1;

/// Travel, metres, that a wheel must have missed, by what the other wheel and the gyro say, before
/// its counter counts as dead: thirty ticks.
const MISSED_M: f64 = 0.03;

/// Which side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

/// What the wheels did between two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rolled {
    /// Travel, metres; left, then right.
    pub(super) by_m: [f64; 2],
    pub(super) elapsed_s: f64,
    /// Whether a counter jumped farther than a wheel can go.
    pub(super) jumped: bool,
    /// For how long the wheels have stood, seconds; 0 while they move.
    pub(super) stood_s: f64,
}

impl Rolled {
    /// Mean travel, metres, and turn, radians.
    pub(super) fn travel_and_turn(&self, track_m: f64) -> [f64; 2] {
        let [left_m, right_m] = self.by_m;
        [0.5 * (left_m + right_m), (right_m - left_m) / track_m]
    }

    pub(super) fn standing(&self) -> bool {
        self.stood_s >= STANDING_S
    }
}

/// The newest counters, and for how long which of them have not moved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Wheels {
    newest: Option<EncoderSample>,
    standing_since: Option<Time>,
    /// Travel that each counter has missed since it last moved, metres.
    missed_m: [f64; 2],
}

impl Wheels {
    /// The newest sample.
    pub(super) fn newest(&self) -> Option<&EncoderSample> {
        self.newest.as_ref()
    }

    pub(super) fn stamp(&self) -> Option<Time> {
        self.newest.map(|newest| newest.stamp)
    }

    /// Takes a sample whose counters are finite and which is newer than the one before; `None` if
    /// there was none.
    pub(super) fn take(&mut self, sample: &EncoderSample) -> Option<Rolled> {
        let previous = self.newest.replace(*sample)?;
        let elapsed_s = sample.stamp.seconds_since(previous.stamp);
        let by_m = [sample.left_m - previous.left_m, sample.right_m - previous.right_m];
        let fastest_m = by_m[0].abs().max(by_m[1].abs());
        let speeds_mps = [sample.left_mps, sample.right_mps];
        let at_rest = (0..2).all(|side| stands(by_m[side], speeds_mps[side]));
        let stood_s = if at_rest {
            let since = *self.standing_since.get_or_insert(previous.stamp);
            sample.stamp.seconds_since(since)
        } else {
            self.standing_since = None;
            0.0
        };
        Some(Rolled { by_m, elapsed_s, jumped: fastest_m > FASTEST_WHEEL_MPS * elapsed_s, stood_s })
    }

    /// Which counter has died, given how far the body turned meanwhile, by the gyro. A counter that
    /// stands while the other one runs is dead unless the robot turns about that very wheel.
    pub(super) fn dead(&mut self, rolled: &Rolled, turn_rad: f64, track_m: f64) -> Option<Side> {
        let [left_m, right_m] = rolled.by_m;
        let newest = self.newest?;
        let expected_m = [right_m - track_m * turn_rad, left_m + track_m * turn_rad];
        let others_m = [right_m, left_m];
        let speeds_mps = [newest.left_mps, newest.right_mps];
        for side in 0..2 {
            if !stands(rolled.by_m[side], speeds_mps[side]) {
                self.missed_m[side] = 0.0;
            } else if others_m[side] != 0.0 {
                self.missed_m[side] += expected_m[side];
            }
        }
        match self.missed_m.map(|missed_m| missed_m.abs() > MISSED_M) {
            [true, false] => Some(Side::Left),
            [false, true] => Some(Side::Right),
            _ => None,
        }
    }

    /// What the wheels did when no gyro is there to say which of them is dead: nothing is dead.
    pub(super) fn presume_alive(&mut self) {
        self.missed_m = [0.0; 2];
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        digest.word(u64::from(self.newest.is_some()));
        if let Some(newest) = &self.newest {
            digest.time(newest.stamp, start);
            digest.numbers(&[newest.left_m, newest.right_m, newest.left_mps, newest.right_mps]);
        }
        digest.word(u64::from(self.standing_since.is_some()));
        if let Some(since) = self.standing_since {
            digest.time(since, start);
        }
        digest.numbers(&self.missed_m);
    }
}

/// Whether a wheel stands: no travel counted, no speed reported.
fn stands(by_m: f64, speed_mps: f64) -> bool {
    by_m == 0.0 && (speed_mps.is_nan() || speed_mps.abs() <= STANDING_MPS)
}

/// A wheel's speed as reported, if it can be true.
pub(super) fn reported_mps(speed_mps: f64) -> Option<f64> {
    (speed_mps.abs() <= FASTEST_WHEEL_MPS).then_some(speed_mps)
}

/// Forward speed as the wheels report it, if both do and it can be true.
pub(super) fn reported_speed_mps(sample: &EncoderSample) -> Option<f64> {
    Some(0.5 * (reported_mps(sample.left_mps)? + reported_mps(sample.right_mps)?))
}
