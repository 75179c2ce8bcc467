//! How much nearer than remembered a point may be.

use schemas::{Span, Time};

use super::cones::Cones;
use super::firings::Firing;
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

/// What the doubts about all points of one firing have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct FiringDoubt {
    /// See [`Doubt`].
    pub(super) stands_m: f64,
    /// Whether what does not stand moves, and how far it may have come since, metres; 0 if it does not.
    moves: bool,
    moved_m: f64,
}

impl FiringDoubt {
    /// None at all.
    #[cfg(test)]
    pub(super) const NONE: FiringDoubt = FiringDoubt { stands_m: 0.0, moves: false, moved_m: 0.0 };

    /// The doubt about those of its points that stand, or about the others.
    pub(super) fn of(&self, stands: bool) -> Doubt {
        let FiringDoubt { stands_m, moves, moved_m } = *self;
        if stands {
            Doubt { stands_m, moves: false, moved_m: 0.0 }
        } else {
            Doubt { stands_m, moves, moved_m }
        }
    }
}

impl Doubts<'_> {
    /// About one point.
    pub(super) fn about(&self, point: &Point) -> Doubt {
        self.about_firing(&point.firing()).of(point.stands())
    }

    /// About the points of a firing.
    pub(super) fn about_firing(&self, firing: &Firing) -> FiringDoubt {
        let drift_m = (DRIFT_SHARE * (self.odometer_m - firing.odometer_m)).min(DRIFT_MOST_M);
        let since = self.now.since(firing.fired);
        // Without branches: neighbours in the list of firings are of every kind.
        let moves = (since < MOVING) & !self.cones.echoed_after(firing.sonar, firing.fired);
        let moved_m = self.v_disc_mps * since.seconds();
        FiringDoubt {
            stands_m: RANGE_SHARE * firing.range_m + drift_m,
            moves,
            moved_m: if moves { moved_m } else { 0.0 },
        }
    }
}
