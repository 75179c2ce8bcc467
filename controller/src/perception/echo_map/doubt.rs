//! How much nearer than remembered a point may be.

#![expect(
    clippy::needless_bitwise_bool,
    reason = "without branches: neighbours in the list of points are of every kind"
)]

use schemas::{Span, Time};

use super::cones::Cones;
use super::points::Point;

/// Uncertainty of a range as a share of it: its standard deviation (robot's data; prototype).
const RANGE_SHARE: f64 = 0.01;

/// Metres by which odometry may have drifted per metre of the odometer since the echo, and at most
/// (prototype, with 3 % of slip).
const DRIFT_SHARE: f64 = 0.03;
const DRIFT_MOST_M: f64 = 0.12;

/// What echoed may be on its way towards the robot until its sonar has heard an echo again, or for this
/// long: silence does not say that it is gone. Chosen: two sweeps, one of them silent.
const MOVING: Span = Span(700_000_000);

/// What has echoed from one place for this long stands: within the reach of a repetition, 3 cm
/// and 2 % of the range, it can have moved by 5 cm/s. Chosen: three sweeps.
const STANDS_AFTER: Span = Span(1_000_000_000);

/// The doubt about where a point is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubt {
    /// How much nearer it may be if it stands, metres.
    pub(super) stands_m: f64,
    /// Whether what echoed there may have left for elsewhere …
    pub(super) moves: bool,
    /// … and how far it may have come since, metres; 0 if it stands.
    pub(super) moved_m: f64,
}

impl Doubt {
    /// How much nearer it may be in all, metres.
    pub(super) fn nearer_m(&self) -> f64 {
        self.stands_m + self.moved_m
    }
}

/// What doubts follow from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubts<'a> {
    pub(super) cones: &'a Cones,
    pub(super) now: Time,
    /// The odometer now, metres.
    pub(super) odometer_m: f64,
    /// Speed bound of moving obstacles, m/s.
    pub(super) v_disc_mps: f64,
}

impl Doubts<'_> {
    pub(super) fn about(&self, point: &Point) -> Doubt {
        let drift_m = (DRIFT_SHARE * (self.odometer_m - point.odometer_m)).min(DRIFT_MOST_M);
        let since = self.now.since(point.fired);
        // Without branches: neighbours in the list of points are of every kind.
        let moves =
            !stands(point) & (since < MOVING) & !self.cones.echoed_after(point.sonar, point.fired);
        let moved_m = self.v_disc_mps * since.seconds();
        Doubt {
            stands_m: RANGE_SHARE * point.range_m + drift_m,
            moves,
            moved_m: if moves { moved_m } else { 0.0 },
        }
    }
}

/// Whether what echoed has been there for so long that it is not reckoned to move.
fn stands(point: &Point) -> bool {
    point.confirmed & (point.fired.since(point.since) >= STANDS_AFTER)
}
