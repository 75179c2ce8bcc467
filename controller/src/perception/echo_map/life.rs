//! How long points are remembered.

use schemas::{Span, Time};

use super::firings::Firing;
use super::points::Point;

/// A confirmed point is remembered this long (prototype: longer lets odometry drift in).
const CONFIRMED_LIFE: Span = Span(5_000_000_000);

/// … but where the robot has hardly moved since, by this much of the odometer, metres, odometry has not
/// drifted either, and it is remembered for this long: a robot that waits before a corner which
/// only echoes now and then must not forget it. This holds for what so many other firings have heard at the
/// same place: a false echo is easily confirmed by those of something else that stands near, and would hold a
/// robot that rests before it for as long. Chosen: a person who has waited that long has looked.
const RESTING_WITHIN_M: f64 = 0.3;
const RESTING_LIFE: Span = Span(20_000_000_000);
const RESTING_HEARD: u8 = 2;

/// An unconfirmed one this long: a sonar fires again after 0.32 s.
const UNCONFIRMED_LIFE: Span = Span(400_000_000);

/// … but one heard from as near as this, metres, may be someone who comes nearer still: while its sonar has
/// heard nothing since it is remembered this long, for one of two sweeps may be silent.
const COMING_NEAR_M: f64 = 0.5;
const COMING_LIFE: Span = Span(720_000_000);

/// What tells points of one firing from each other when they age or are doubted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kind(u8);

impl Kind {
    /// Of those that a point's life depends on, how many there are.
    const OF_LIFE: u8 = 4;

    /// That of a point.
    pub(super) fn of(point: &Point) -> Kind {
        let rests = point.heard >= RESTING_HEARD;
        let flags = [point.confirmed, rests, point.stands(), point.counts()];
        Kind(flags.into_iter().rev().fold(0, |bits, flag| bits << 1 | u8::from(flag)))
    }

    /// See [`Point::confirmed`].
    pub(super) fn confirmed(self) -> bool {
        self.0 & 1 != 0
    }

    /// See [`Point::stands`].
    pub(super) fn stands(self) -> bool {
        self.0 & 4 != 0
    }

    /// See [`Point::counts`].
    pub(super) fn counts(self) -> bool {
        self.0 & 8 != 0
    }

    /// As one of [`Kind::OF_LIFE`]: confirmed or not, heard by [`RESTING_HEARD`] others or not.
    fn of_life(self) -> u8 {
        self.0 & 3
    }

    /// Whether it is among those that [`Life::old`] tells of.
    pub(super) fn is_among(self, old: u8) -> bool {
        old >> self.of_life() & 1 != 0
    }
}

/// Since when what is kept must have been heard.
pub(super) struct Life {
    odometer_m: f64,
    /// A confirmed point, usually and at the longest.
    confirmed_since: [Time; 2],
    unconfirmed_since: [Time; 2],
}

impl Life {
    /// For an age as of `now`, when the odometer stands at `odometer_m`.
    pub(super) fn new(now: Time, odometer_m: f64) -> Life {
        let since = |life: Span| Time(now.0.saturating_sub(life.0));
        Life {
            odometer_m,
            confirmed_since: [since(CONFIRMED_LIFE), since(RESTING_LIFE)],
            unconfirmed_since: [since(UNCONFIRMED_LIFE), since(COMING_LIFE)],
        }
    }

    /// For which kinds of life, as bits, the points of a firing are too old. `silent_since` says whether its
    /// sonar has heard no echo since.
    pub(super) fn old(&self, firing: &Firing, silent_since: impl Fn(&Firing) -> bool) -> u8 {
        let resting = self.odometer_m - firing.odometer_m <= RESTING_WITHIN_M;
        let coming = (firing.range_m < COMING_NEAR_M) & silent_since(firing);
        (0..Kind::OF_LIFE)
            .map(|kind| {
                let (confirmed, rests) = (kind & 1 != 0, kind & 2 != 0);
                let long = if confirmed { rests & resting } else { coming };
                let [usual, longer] =
                    if confirmed { self.confirmed_since } else { self.unconfirmed_since };
                u8::from(firing.fired < if long { longer } else { usual }) << kind
            })
            .fold(0, |all, old| all | old)
    }
}
