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

/// The wedge is so much wider than the cone at the sonar's face, metres: what is as near as
/// [`CONFIRM_WITHIN_M`] lies in it whichever way, and what repeats the end of a short arc.
const WEDGE_AT_FACE_M: f64 = 0.11;

/// Slack for rounding, metres and per metre from the origin: places are rounded to 32 bits, and some sums of
/// products of them, each to 6e-8 of itself.
const HAIR_M: f64 = 4e-5;
const HAIR_SHARE: f64 = 4e-6;

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
    /// The wedge that everything lies in that can matter: see [`Arc::may_concern`].
    wedge: Wedge,
}

/// A wedge about an axis, up to a line across it. With the way ahead and aside reckoned from the origin, no
/// point has to be moved first; and in 32 bits a processor reckons twice as many at once.
#[derive(Clone, Copy, Debug)]
struct Wedge {
    axis: [f32; 2],
    /// The way ahead where it ends, metres.
    end_m: f32,
    /// The way aside of its middle, metres.
    middle_m: f32,
    /// Its half-width at the origin, metres, and by how much that grows on the way ahead.
    half_m: f32,
    growth: f32,
}

/// A point as seen along an echo's axis.
struct Sight {
    forward_m: f64,
    aside_m: f64,
    distance_m2: f64,
}

/// What an echo does to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bearing {
    /// Nothing.
    None,
    /// It has looked through the point.
    Carves,
    /// It confirms the point.
    Confirms,
    /// It confirms the point, and puts one of its own in the place of it.
    Replaces,
}

/// What an echo and a point are to each other.
pub(super) struct Meeting {
    /// What the echo does to the point once it is confirmed.
    pub(super) bearing: Bearing,
    /// Whether the point, of another firing, lies on the arc: so it confirms the echo.
    pub(super) confirms: bool,
    /// Which of the arc's points stand where this older one does.
    pub(super) repeated: [bool; ARC_POINTS],
}

impl Arc<'_> {
    pub(super) fn of(echo: &PlacedEcho, slopes: Slopes) -> Arc<'_> {
        let range_m = echo.range_m;
        let within_m = (CONFIRM_WITHIN_M + CONFIRM_WITHIN_SHARE * range_m)
            .min(CONFIRM_CLOSE_M + CONFIRM_CLOSE_SHARE * range_m);
        let nearest_m = (range_m - within_m).max(0.0);
        let farthest_m = range_m + within_m;
        let repeat_m = REPEAT_WITHIN_M + REPEAT_WITHIN_SHARE * range_m;
        let carve_below_m = (CARVE_SHARE * range_m - CARVE_SHORT_M).max(0.0);
        Arc {
            echo,
            slopes,
            on_arc_m2: [nearest_m * nearest_m, farthest_m * farthest_m],
            carve_below_m2: carve_below_m * carve_below_m,
            repeat_within_m2: repeat_m * repeat_m,
            wedge: Wedge::of(echo, farthest_m, slopes.confirm * farthest_m),
        }
    }

    fn sight(&self, at_m: [f64; 2]) -> Sight {
        let [from_m, axis] = [self.echo.from_m, self.echo.axis];
        let [dx, dy] = [at_m[0] - from_m[0], at_m[1] - from_m[1]];
        Sight {
            forward_m: dx * axis[0] + dy * axis[1],
            aside_m: (dy * axis[0] - dx * axis[1]).abs(),
            distance_m2: dx * dx + dy * dy,
        }
    }

    /// Whether a point at a place can matter to the echo: false only where it neither carves, confirms nor
    /// repeats.
    pub(super) fn may_concern(&self, [x_m, y_m]: [f32; 2]) -> bool {
        let Wedge { axis, end_m, middle_m, half_m, growth } = self.wedge;
        let forward_m = x_m * axis[0] + y_m * axis[1];
        let aside_m = y_m * axis[0] - x_m * axis[1];
        (forward_m <= end_m) & ((aside_m - middle_m).abs() <= half_m + growth * forward_m)
    }

    /// What the echo and a point are to each other.
    pub(super) fn meet(&self, point: &Point) -> Meeting {
        let sight = self.sight(point.at_m);
        let older = point.fired < self.echo.fired;
        let [nearest_m2, farthest_m2] = self.on_arc_m2;
        let on_arc = (sight.distance_m2 >= nearest_m2) & (sight.distance_m2 <= farthest_m2);
        let other_firing = point.fired.0.abs_diff(self.echo.fired.0) > OTHER_FIRING.0;
        let confirms = on_arc & self.in_cone(&sight) & other_firing;
        let carves = older & self.carves(point, &sight);
        // What repeats is nearer to the arc than what confirms need be, and lies beyond what is carved.
        let may_repeat = older & on_arc & !carves;
        let repeated = if may_repeat { self.repeats(point) } else { [false; ARC_POINTS] };
        let bearing = if carves {
            Bearing::Carves
        } else if !confirms {
            Bearing::None
        } else if repeated == [false; ARC_POINTS] {
            Bearing::Confirms
        } else {
            Bearing::Replaces
        };
        Meeting { bearing, confirms, repeated }
    }

    fn in_cone(&self, sight: &Sight) -> bool {
        // As near to the sonar's face as this, a direction says nothing.
        (sight.aside_m <= self.slopes.confirm * sight.forward_m)
            | (sight.distance_m2 <= CONFIRM_WITHIN_M * CONFIRM_WITHIN_M)
    }

    /// Whether the echo has looked through a point.
    fn carves(&self, point: &Point, sight: &Sight) -> bool {
        let own = point.sonar == self.echo.sonar;
        let slope = if own { self.slopes.carve_own } else { self.slopes.carve };
        (sight.distance_m2 < self.carve_below_m2) & (sight.aside_m <= slope * sight.forward_m)
    }

    /// Which of the arc's points stand where this one does.
    fn repeats(&self, point: &Point) -> [bool; ARC_POINTS] {
        self.echo.arc_m.map(|at_m| {
            let [dx, dy] = [at_m[0] - point.at_m[0], at_m[1] - point.at_m[1]];
            dx * dx + dy * dy <= self.repeat_within_m2
        })
    }
}

impl Wedge {
    /// That of an echo, up to a way ahead where it is to be so wide on either side, metres.
    fn of(echo: &PlacedEcho, ahead_m: f64, half_m: f64) -> Wedge {
        let ([x_m, y_m], axis) = (echo.from_m, echo.axis);
        let forward_m = x_m * axis[0] + y_m * axis[1];
        let growth = (half_m - WEDGE_AT_FACE_M).max(0.0) / ahead_m;
        // Rounding grows with the way from the origin.
        let hair_m = HAIR_M + HAIR_SHARE * (x_m.abs() + y_m.abs());
        Wedge {
            axis: axis.map(|component| component as f32),
            end_m: (forward_m + ahead_m + hair_m) as f32,
            middle_m: (y_m * axis[0] - x_m * axis[1]) as f32,
            half_m: (WEDGE_AT_FACE_M - growth * forward_m + hair_m) as f32,
            growth: growth as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use schemas::SIMULATION_EPOCH;

    use super::super::beam::unit;
    use super::*;

    fn echo(from_m: [f64; 2], axis_rad: f64, range_m: f64) -> PlacedEcho {
        let arc_m = [-10.0, -5.0, 0.0, 5.0, 10.0].map(|off_deg: f64| {
            let [x, y] = unit(axis_rad + off_deg.to_radians());
            [from_m[0] + range_m * x, from_m[1] + range_m * y]
        });
        let fired = SIMULATION_EPOCH.after_ns(320_000_000);
        let axis = unit(axis_rad);
        PlacedEcho { sonar: 3, from_m, axis, arc_m, range_m, fired, odometer_m: 0.0 }
    }

    fn older_point(at_m: [f64; 2], sonar: u8) -> Point {
        let echo = PlacedEcho { sonar, fired: SIMULATION_EPOCH, ..echo(at_m, 0.0, 0.0) };
        Point::new(&echo, at_m, true)
    }

    proptest! {
        /// What the wedge leaves out neither confirms nor is carved or repeated, wherever the robot is.
        #[test]
        fn the_wedge_hides_nothing(
            from_m in prop_oneof![
                prop::array::uniform2(-3.0..3.0),
                prop::array::uniform2(-2_000.0..2_000.0),
            ],
            axis_rad in -4.0..4.0_f64,
            range_m in prop_oneof![Just(0.0), 0.0..0.6, 0.0..5.1],
            off_deg in prop_oneof![-14.0..14.0_f64, -180.0..180.0_f64],
            share in prop_oneof![0.9..1.1, 0.0..1.3],
            beyond_m in prop_oneof![Just(0.0), -0.12..0.12],
            sonar in 3_u8..5,
        ) {
            let echo = echo(from_m, axis_rad, range_m);
            let arc = Arc::of(&echo, Slopes::new());
            let [x, y] = unit(axis_rad + off_deg.to_radians());
            let away_m = share * range_m + beyond_m;
            let at_m = [from_m[0] + away_m * x, from_m[1] + away_m * y];
            let Meeting { bearing, confirms, repeated } = arc.meet(&older_point(at_m, sonar));
            let concerns = bearing != Bearing::None || confirms || repeated.contains(&true);
            prop_assert!(!concerns || arc.may_concern(at_m.map(|m| m as f32)), "{bearing:?} {confirms} {repeated:?}");
        }
    }

    /// 2 m ahead: what stands there is met, and repeated by the middle of the arc; what stands 0.155 m nearer
    /// is carved, though it confirms as well; what stands behind, aside or beyond has nothing to do with it.
    #[test]
    fn a_point_is_met_where_the_echo_came_from() {
        let echo = echo([0.0; 2], 0.0, 2.0);
        let arc = Arc::of(&echo, Slopes::new());
        let meet = |at_m| arc.meet(&older_point(at_m, 4));
        let Meeting { bearing, confirms, repeated } = meet([2.0, 0.0]);
        assert_eq!((bearing, confirms), (Bearing::Replaces, true));
        assert_eq!(repeated, [false, false, true, false, false]);
        // 2.0 less 0.1 + 0.03 · 2.0 is 1.84; 0.95 · 2.0 − 0.05 is 1.85.
        let Meeting { bearing, confirms, .. } = meet([1.845, 0.0]);
        assert_eq!((bearing, confirms), (Bearing::Carves, true));
        assert_eq!(meet([2.1, 0.0]).bearing, Bearing::Confirms);
        for at_m in [[-1.0, 0.0], [1.0, 0.6], [2.3, 0.0]] {
            assert_eq!(meet(at_m).bearing, Bearing::None);
            assert!(!arc.may_concern(at_m.map(|m: f64| m as f32)), "{at_m:?}");
        }
    }
}
