//! How an echo bears on the points that are there already.

#![expect(
    clippy::needless_bitwise_bool,
    reason = "without branches several points are looked at at once"
)]

use schemas::Span;

use super::beam::ARC_POINTS;
use super::points::{PlacedEcho, Point};

/// Firings no farther apart than this may hear each other and do not confirm each other.
const OTHER_FIRING: Span = Span(50_000_000);

/// A point confirms an echo inside its cone and this much beyond, degrees.
const CONFIRM_HALF_CONE_DEG: f64 = 13.0;

/// … whose range differs by no more than this, metres, and this share of the range.
const CONFIRM_WITHIN_M: f64 = 0.10;
const CONFIRM_WITHIN_SHARE: f64 = 0.03;

/// … close by no more than this, metres, and this share of the range: where all is near, a false echo from
/// before the body would be confirmed by whatever stands behind it.
const CONFIRM_CLOSE_M: f64 = 0.04;
const CONFIRM_CLOSE_SHARE: f64 = 0.2;

/// A new point replaces confirming ones within this, metres, and this share of its range: about the
/// noise of a range.
const REPEAT_WITHIN_M: f64 = 0.03;
const REPEAT_WITHIN_SHARE: f64 = 0.02;

/// An echo carves no farther than this off its axis, degrees: its cone less a margin.
const CARVE_HALF_CONE_DEG: f64 = 8.0;

/// … but for points of the sonar itself, which are up to 10° off: what a false echo put at the edges of a
/// cone would stay before a robot at rest as long as it remembers.
const CARVE_OWN_HALF_CONE_DEG: f64 = 11.0;

/// … and nearer than this share of its range less this many metres: what is left keeps the noise
/// of a range from carving the obstacle itself, and no more, since points that stay there wrongly hide
/// free space.
const CARVE_SHARE: f64 = 0.95;
const CARVE_SHORT_M: f64 = 0.05;

/// The least cosine of the angle between an echo's axis and one of its arc's points, which are up to
/// 10° off; and a slack for rounding, metres. For telling quickly what cannot be near the arc.
const ARC_LEAST_COSINE: f64 = 0.98;
const HAIR_M: f64 = 1e-6;

/// Slopes of the cones within which echoes confirm and carve: tangents of their half-angles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    confirm: f64,
    carve: f64,
    carve_own: f64,
}

impl Slopes {
    pub(super) fn new() -> Slopes {
        let [confirm, carve, carve_own] =
            [CONFIRM_HALF_CONE_DEG, CARVE_HALF_CONE_DEG, CARVE_OWN_HALF_CONE_DEG]
                .map(|half_cone_deg| libm::tan(half_cone_deg.to_radians()));
        Slopes { confirm, carve, carve_own }
    }
}

/// An echo with what is needed to compare points with it.
pub(super) struct Arc<'a> {
    echo: &'a PlacedEcho,
    slopes: Slopes,
    /// Squared distances between which a point lies on the arc, metres².
    on_arc_m2: [f64; 2],
    /// Squared distance up to which the echo has looked through a point, metres².
    carve_below_m2: f64,
    repeat_within_m2: f64,
    /// Squared distance and way ahead from which on a point may stand where one of the arc's does.
    repeat_beyond_m2: f64,
    repeat_ahead_m: f64,
}

/// A point as seen along an echo's axis.
pub(super) struct Sight {
    forward_m: f64,
    aside_m: f64,
    distance_m2: f64,
}

impl Arc<'_> {
    pub(super) fn of(echo: &PlacedEcho, slopes: Slopes) -> Arc<'_> {
        let range_m = echo.range_m;
        let within_m = (CONFIRM_WITHIN_M + CONFIRM_WITHIN_SHARE * range_m)
            .min(CONFIRM_CLOSE_M + CONFIRM_CLOSE_SHARE * range_m);
        let nearest_m = (range_m - within_m).max(0.0);
        let farthest_m = range_m + within_m;
        let repeat_m = REPEAT_WITHIN_M + REPEAT_WITHIN_SHARE * range_m;
        let repeat_beyond_m = (range_m - repeat_m - HAIR_M).max(0.0);
        let carve_below_m = (CARVE_SHARE * range_m - CARVE_SHORT_M).max(0.0);
        Arc {
            echo,
            slopes,
            on_arc_m2: [nearest_m * nearest_m, farthest_m * farthest_m],
            carve_below_m2: carve_below_m * carve_below_m,
            repeat_within_m2: repeat_m * repeat_m,
            repeat_beyond_m2: repeat_beyond_m * repeat_beyond_m,
            repeat_ahead_m: ARC_LEAST_COSINE * range_m - repeat_m - HAIR_M,
        }
    }

    pub(super) fn sight(&self, at_m: [f64; 2]) -> Sight {
        let [from_m, axis] = [self.echo.from_m, self.echo.axis];
        let [dx, dy] = [at_m[0] - from_m[0], at_m[1] - from_m[1]];
        Sight {
            forward_m: dx * axis[0] + dy * axis[1],
            aside_m: (dy * axis[0] - dx * axis[1]).abs(),
            distance_m2: dx * dx + dy * dy,
        }
    }

    /// Whether a point can matter to the echo: false only where it neither carves, confirms nor repeats.
    pub(super) fn concerns(&self, sight: &Sight) -> bool {
        // The cones of carving are within that of confirming, and what repeats is nearer than what
        // confirms.
        let may_repeat =
            (sight.distance_m2 >= self.repeat_beyond_m2) & (sight.forward_m >= self.repeat_ahead_m);
        (sight.distance_m2 <= self.on_arc_m2[1]) & (self.in_cone(sight) | may_repeat)
    }

    fn in_cone(&self, sight: &Sight) -> bool {
        // As near to the sonar's face as this, a direction says nothing.
        (sight.aside_m <= self.slopes.confirm * sight.forward_m)
            | (sight.distance_m2 <= CONFIRM_WITHIN_M * CONFIRM_WITHIN_M)
    }

    /// Whether the echo is newer than a point.
    pub(super) fn is_after(&self, point: &Point) -> bool {
        point.fired < self.echo.fired
    }

    /// Whether the echo has looked through a point.
    pub(super) fn carves(&self, point: &Point, sight: &Sight) -> bool {
        let own = point.sonar == self.echo.sonar;
        let slope = if own { self.slopes.carve_own } else { self.slopes.carve };
        sight.distance_m2 < self.carve_below_m2 && sight.aside_m <= slope * sight.forward_m
    }

    /// Whether a point of another firing lies on the arc.
    pub(super) fn confirms(&self, point: &Point, sight: &Sight) -> bool {
        let [nearest_m2, farthest_m2] = self.on_arc_m2;
        self.in_cone(sight)
            && (nearest_m2..=farthest_m2).contains(&sight.distance_m2)
            && point.fired.0.abs_diff(self.echo.fired.0) > OTHER_FIRING.0
    }

    /// Which of the arc's points stand where this one does.
    pub(super) fn repeats(&self, point: &Point) -> [bool; ARC_POINTS] {
        self.echo.arc_m.map(|at_m| {
            let [dx, dy] = [at_m[0] - point.at_m[0], at_m[1] - point.at_m[1]];
            dx * dx + dy * dy <= self.repeat_within_m2
        })
    }
}
