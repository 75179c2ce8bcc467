//! The remembered points: where echoes came from, in the odometry frame.
//!
//! An echo says that something stood somewhere on an arc across the cone, and that nothing stood
//! nearer. So it adds the arc's points, and bears on those that are there already:
//!
//! - it **confirms** points of another firing that lie on the same arc, and is confirmed by them;
//! - it **replaces** those of them that it repeats, so that a wall seen a hundred times stays one wall;
//! - once confirmed it **carves**: what two such echoes have looked through is gone. Silence never
//!   carves, because a wall at a slant is silent too; nor does an unconfirmed echo, because the detours
//!   that sound takes off such walls pretend to look through them.

#![expect(
    clippy::needless_bitwise_bool,
    reason = "without branches several points are looked at at once"
)]

use schemas::{Span, Time};

use super::beam::ARC_POINTS;
use crate::digest::Digest;

/// A confirmed point is remembered this long (prototype: longer lets odometry drift in).
const CONFIRMED_LIFE: Span = Span(5_000_000_000);

/// … but where the robot has hardly moved since, by this much of the odometer, metres, odometry has not
/// drifted either, and it is remembered for this long: a robot that waits before a corner which
/// only echoes now and then must not forget it. This holds for what so many other firings have heard: a false
/// echo is easily confirmed by one, when something else stands near the place, and would hold a robot that
/// rests before it for as long.
const RESTING_WITHIN_M: f64 = 0.3;
const RESTING_LIFE: Span = Span(60_000_000_000);
const RESTING_HEARD: u8 = 2;

/// An unconfirmed one this long: a sonar fires again after 0.32 s.
const UNCONFIRMED_LIFE: Span = Span(400_000_000);

/// … but one heard from as near as this, metres, may be someone who comes nearer still: while its sonar has
/// heard nothing since it is remembered this long, for one of two sweeps may be silent.
const COMING_NEAR_M: f64 = 0.5;
const COMING_LIFE: Span = Span(720_000_000);

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

/// How many echoes must have looked through a point before it goes.
const CARVE_HITS: u8 = 2;

/// … and a confirmed one that was heard from nearer than this, metres. A convex corner echoes only now and
/// then, from 1.2 m at the farthest, and while it keeps silent what stands behind it is heard: two such
/// echoes in a row are common there, four are not.
const CARVE_NEAR_M: f64 = 1.0;
const CARVE_NEAR_HITS: u8 = 4;

/// An echo, placed in the odometry frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedEcho {
    /// Which sonar heard it, by id.
    pub(super) sonar: u8,
    /// Face of the sonar, metres.
    pub(super) from_m: [f64; 2],
    /// Unit vector along the axis.
    pub(super) axis: [f64; 2],
    /// The arc's points, metres.
    pub(super) arc_m: [[f64; 2]; ARC_POINTS],
    /// Range, metres; 0 in contact.
    pub(super) range_m: f64,
    /// When the sonar fired.
    pub(super) fired: Time,
    /// The odometer then, metres.
    pub(super) odometer_m: f64,
}

/// A place from which an echo may have come.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// Which sonar heard it, by id.
    pub(super) sonar: u8,
    /// Position, metres.
    pub(super) at_m: [f64; 2],
    /// Range at which it was heard, metres.
    pub(super) range_m: f64,
    /// When it was heard.
    pub(super) fired: Time,
    /// The odometer then, metres.
    pub(super) odometer_m: f64,
    /// Whether another firing heard it too.
    pub(super) confirmed: bool,
    /// How many other firings have heard it, of all the echoes that repeated one another.
    heard: u8,
    /// How many newer echoes have looked through it.
    carved: u8,
    /// When something was first heard here, of all the echoes that repeated one another.
    pub(super) since: Time,
}

impl Point {
    /// A point of `echo`.
    pub(super) fn new(echo: &PlacedEcho, at_m: [f64; 2], confirmed: bool) -> Point {
        let PlacedEcho { sonar, range_m, fired, odometer_m, .. } = *echo;
        let heard = u8::from(confirmed);
        Point { sonar, at_m, range_m, fired, odometer_m, confirmed, heard, carved: 0, since: fired }
    }

    /// How many echoes must have looked through it before it goes.
    fn carving_hits(&self) -> u8 {
        if self.confirmed && self.range_m < CARVE_NEAR_M { CARVE_NEAR_HITS } else { CARVE_HITS }
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        digest.numbers(&[self.at_m[0], self.at_m[1], self.range_m, self.odometer_m]);
        digest.time(self.fired, start);
        digest.time(self.since, start);
        let Point { sonar, heard, carved, confirmed, .. } = *self;
        digest.word(u64::from(u32::from_le_bytes([sonar, heard, carved, u8::from(confirmed)])));
    }
}

/// The remembered points.
#[derive(Clone, Debug)]
pub(super) struct Points {
    kept: Vec<Point>,
    /// Places in `kept` of the points that the echo in hand can bear on.
    met: Vec<u16>,
    confirm_slope: f64,
    carve_slope: f64,
    carve_own_slope: f64,
}

impl Points {
    /// How many points are kept, at most. Two echoes of five points every 40 ms for 5 s are 1250 if
    /// none repeats another; repeats, carving and the short life of the unconfirmed leave 200 to 400.
    pub(super) const CAPACITY: usize = 1024;

    pub(super) fn new() -> Points {
        Points {
            kept: Vec::with_capacity(Points::CAPACITY),
            met: Vec::with_capacity(Points::CAPACITY),
            confirm_slope: libm::tan(CONFIRM_HALF_CONE_DEG.to_radians()),
            carve_slope: libm::tan(CARVE_HALF_CONE_DEG.to_radians()),
            carve_own_slope: libm::tan(CARVE_OWN_HALF_CONE_DEG.to_radians()),
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Point> {
        self.kept.iter()
    }

    pub(super) fn as_slice(&self) -> &[Point] {
        &self.kept
    }

    pub(super) fn clear(&mut self) {
        self.kept.clear();
    }

    /// Takes an echo; true if it is confirmed.
    pub(super) fn hear(&mut self, echo: &PlacedEcho) -> bool {
        let arc = Arc::of(echo, self.confirm_slope, [self.carve_slope, self.carve_own_slope]);
        self.meet(&arc);
        let confirms = |met: &u16| {
            let point = &self.kept[usize::from(*met)];
            arc.confirms(point, &arc.sight(point.at_m))
        };
        let confirmed = self.met.iter().any(confirms);
        let mut points = echo.arc_m.map(|at_m| Point::new(echo, at_m, confirmed));
        if confirmed {
            self.date_back(&arc, &mut points);
            self.weigh(&arc);
        }
        for point in points {
            self.make_room();
            self.kept.push(point);
        }
        confirmed
    }

    /// Collects, in order, the points that an echo can bear on at all: few of those there are.
    fn meet(&mut self, arc: &Arc<'_>) {
        // Written so that every point costs the same, without a branch.
        self.met.resize(self.kept.len(), 0);
        let mut count = 0;
        for (index, point) in self.kept.iter().enumerate() {
            self.met[count] = index as u16;
            count += usize::from(arc.concerns(&arc.sight(point.at_m)));
        }
        self.met.truncate(count);
    }

    /// Since when there is something at each of an echo's points, and how many have heard it: as long as at
    /// the points that it repeats, and one more than those.
    fn date_back(&self, arc: &Arc<'_>, points: &mut [Point; ARC_POINTS]) {
        for point in self.met.iter().map(|met| &self.kept[usize::from(*met)]) {
            if point.fired >= arc.echo.fired {
                continue;
            }
            for newer in points.iter_mut() {
                let adds = point.since < newer.since || point.heard >= newer.heard;
                if adds && arc.repeats_at(point, newer.at_m) {
                    newer.since = newer.since.min(point.since);
                    newer.heard = newer.heard.max(point.heard.saturating_add(1));
                }
            }
        }
    }

    /// Lets a confirmed echo bear on every point that it meets.
    fn weigh(&mut self, arc: &Arc<'_>) {
        let mut gone = 0;
        for index in 0..self.met.len() {
            let met = self.met[index];
            let point = &mut self.kept[usize::from(met)];
            let older = point.fired < arc.echo.fired;
            let sight = arc.sight(point.at_m);
            let mut goes = false;
            if older && arc.carves(point, &sight) {
                point.carved += 1;
                goes = point.carved >= point.carving_hits();
            } else if arc.confirms(point, &sight) {
                point.confirmed = true;
                point.heard = point.heard.saturating_add(1);
                goes = older && arc.repeats(point);
            }
            self.met[gone] = met;
            gone += usize::from(goes);
        }
        self.met.truncate(gone);
        self.drop_met();
    }

    /// Forgets the points collected. The last one kept takes the place of each.
    fn drop_met(&mut self) {
        let mut gone = self.met.as_slice();
        while let [first, rest @ ..] = gone {
            gone = rest;
            while let [rest @ .., last] = gone
                && usize::from(*last) + 1 == self.kept.len()
            {
                self.kept.pop();
                gone = rest;
            }
            self.kept.swap_remove(usize::from(*first));
        }
    }

    /// Forgets what is too old at `now`, when the odometer stands at `odometer_m`. `silent_since` says
    /// whether a point's sonar has heard no echo since.
    pub(super) fn age(
        &mut self,
        now: Time,
        odometer_m: f64,
        silent_since: impl Fn(&Point) -> bool,
    ) {
        self.kept.retain(|point| {
            let life = if !point.confirmed {
                let silent = point.range_m < COMING_NEAR_M && silent_since(point);
                if silent { COMING_LIFE } else { UNCONFIRMED_LIFE }
            } else if point.heard >= RESTING_HEARD
                && odometer_m - point.odometer_m <= RESTING_WITHIN_M
            {
                RESTING_LIFE
            } else {
                CONFIRMED_LIFE
            };
            now.since(point.fired) <= life
        });
    }

    /// When full, forgets the oldest point.
    fn make_room(&mut self) {
        if self.kept.len() < Points::CAPACITY {
            return;
        }
        let oldest = self.kept.iter().enumerate().min_by_key(|(_, point)| point.fired);
        if let Some((index, _)) = oldest {
            self.kept.swap_remove(index);
        }
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        for point in &self.kept {
            point.fold(digest, start);
        }
    }
}

/// An echo with what is needed to compare points with it.
struct Arc<'a> {
    echo: &'a PlacedEcho,
    /// Squared distances between which a point lies on the arc, metres².
    on_arc_m2: [f64; 2],
    confirm_slope: f64,
    carve_slope: f64,
    carve_own_slope: f64,
    /// Squared distance up to which the echo has looked through a point, metres².
    carve_below_m2: f64,
    repeat_within_m2: f64,
    /// Squared distance and way ahead from which on a point may stand where one of the arc's does.
    repeat_beyond_m2: f64,
    repeat_ahead_m: f64,
}

/// A point as seen along an echo's axis.
struct Sight {
    forward_m: f64,
    aside_m: f64,
    distance_m2: f64,
}

impl Arc<'_> {
    fn of(echo: &PlacedEcho, confirm_slope: f64, carve_slopes: [f64; 2]) -> Arc<'_> {
        let [carve_slope, carve_own_slope] = carve_slopes;
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
            on_arc_m2: [nearest_m * nearest_m, farthest_m * farthest_m],
            confirm_slope,
            carve_slope,
            carve_own_slope,
            carve_below_m2: carve_below_m * carve_below_m,
            repeat_within_m2: repeat_m * repeat_m,
            repeat_beyond_m2: repeat_beyond_m * repeat_beyond_m,
            repeat_ahead_m: ARC_LEAST_COSINE * range_m - repeat_m - HAIR_M,
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

    /// Whether a point can matter to the echo: false only where it neither carves, confirms nor repeats.
    fn concerns(&self, sight: &Sight) -> bool {
        // The cones of carving are within that of confirming, and what repeats is nearer than what
        // confirms.
        let may_repeat =
            (sight.distance_m2 >= self.repeat_beyond_m2) & (sight.forward_m >= self.repeat_ahead_m);
        (sight.distance_m2 <= self.on_arc_m2[1]) & (self.in_cone(sight) | may_repeat)
    }

    fn in_cone(&self, sight: &Sight) -> bool {
        // As near to the sonar's face as this, a direction says nothing.
        (sight.aside_m <= self.confirm_slope * sight.forward_m)
            | (sight.distance_m2 <= CONFIRM_WITHIN_M * CONFIRM_WITHIN_M)
    }

    /// Whether the echo has looked through a point.
    fn carves(&self, point: &Point, sight: &Sight) -> bool {
        let slope =
            if point.sonar == self.echo.sonar { self.carve_own_slope } else { self.carve_slope };
        sight.distance_m2 < self.carve_below_m2 && sight.aside_m <= slope * sight.forward_m
    }

    /// Whether a point of another firing lies on the arc.
    fn confirms(&self, point: &Point, sight: &Sight) -> bool {
        let [nearest_m2, farthest_m2] = self.on_arc_m2;
        self.in_cone(sight)
            && (nearest_m2..=farthest_m2).contains(&sight.distance_m2)
            && apart(point.fired, self.echo.fired) > OTHER_FIRING
    }

    /// Whether one of the arc's points stands where this one does.
    fn repeats(&self, point: &Point) -> bool {
        self.echo.arc_m.iter().any(|at_m| self.repeats_at(point, *at_m))
    }

    /// Whether a place is that of a point.
    fn repeats_at(&self, point: &Point, at_m: [f64; 2]) -> bool {
        let [dx, dy] = [at_m[0] - point.at_m[0], at_m[1] - point.at_m[1]];
        dx * dx + dy * dy <= self.repeat_within_m2
    }
}

/// How far apart two instants are.
fn apart(a: Time, b: Time) -> Span {
    Span(a.0.abs_diff(b.0))
}
