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
    reason = "without branches: neighbours in the list of points are of every kind"
)]

use schemas::{Span, Time};

use super::arc::{Arc, Bearing, Meeting, Slopes};
use super::beam::ARC_POINTS;
use crate::digest::Digest;

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
    /// Whether it is passed over until another firing hears it too.
    pub(super) doubted: bool,
    /// How many other firings have heard something at this very place, of all the echoes that repeated one another;
    /// 1 if one has confirmed it.
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
        Point {
            sonar,
            at_m,
            range_m,
            fired,
            odometer_m,
            confirmed,
            doubted: false,
            heard,
            carved: 0,
            since: fired,
        }
    }

    /// Whether something is taken to be there.
    pub(super) fn counts(&self) -> bool {
        self.confirmed | !self.doubted
    }

    /// How many echoes must have looked through it before it goes.
    fn carving_hits(&self) -> u8 {
        if self.confirmed && self.range_m < CARVE_NEAR_M { CARVE_NEAR_HITS } else { CARVE_HITS }
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        digest.numbers(&[self.at_m[0], self.at_m[1], self.range_m, self.odometer_m]);
        digest.time(self.fired, start);
        digest.time(self.since, start);
        let Point { sonar, heard, carved, confirmed, doubted, .. } = *self;
        let flags = u8::from(doubted) << 1 | u8::from(confirmed);
        digest.word(u64::from(u32::from_le_bytes([sonar, heard, carved, flags])));
    }
}

/// The remembered points.
#[derive(Clone, Debug)]
pub(super) struct Points {
    kept: Vec<Point>,
    /// Where they are, metres, by axis: what each echo asks of every point.
    x_m: Vec<f64>,
    y_m: Vec<f64>,
    /// Places in `kept` of the points that the echo in hand can bear on, and what it means to each.
    met: Vec<u16>,
    bearings: Vec<Bearing>,
    slopes: Slopes,
}

/// How many points an echo is compared with at once.
const AT_ONCE: usize = 32;

impl Points {
    /// How many points are kept, at most. Two echoes of five points every 40 ms for 5 s are 1250 if
    /// none repeats another; repeats, carving and the short life of the unconfirmed leave 200 to 400.
    pub(super) const CAPACITY: usize = 1024;

    pub(super) fn new() -> Points {
        Points {
            kept: Vec::with_capacity(Points::CAPACITY),
            x_m: Vec::with_capacity(Points::CAPACITY),
            y_m: Vec::with_capacity(Points::CAPACITY),
            met: Vec::with_capacity(Points::CAPACITY),
            bearings: Vec::with_capacity(Points::CAPACITY),
            slopes: Slopes::new(),
        }
    }

    /// Points that were heard once, at the start of a session.
    #[cfg(test)]
    pub(super) fn at(points_m: &[[f64; 2]]) -> Points {
        let mut points = Points::new();
        for at_m in points_m {
            let echo = PlacedEcho {
                sonar: 3,
                from_m: [0.0; 2],
                axis: [1.0, 0.0],
                arc_m: [*at_m; ARC_POINTS],
                range_m: 1.0,
                fired: schemas::SIMULATION_EPOCH,
                odometer_m: 0.0,
            };
            points.push(Point::new(&echo, *at_m, true));
        }
        points
    }

    #[cfg(test)]
    pub(super) fn iter(&self) -> impl Iterator<Item = &Point> {
        self.kept.iter()
    }

    pub(super) fn as_slice(&self) -> &[Point] {
        &self.kept
    }

    /// Where they are, metres: along x, and along y.
    pub(super) fn places_m(&self) -> [&[f64]; 2] {
        [&self.x_m, &self.y_m]
    }

    pub(super) fn clear(&mut self) {
        self.kept.clear();
        self.x_m.clear();
        self.y_m.clear();
    }

    /// Takes an echo; true if it is confirmed. If it is not, `doubted` says whether it is to be passed over.
    pub(super) fn hear(&mut self, echo: &PlacedEcho, doubted: bool) -> bool {
        let arc = Arc::of(echo, self.slopes);
        self.meet(&arc);
        let mut points = echo.arc_m.map(|at_m| Point::new(echo, at_m, true));
        let confirmed = self.compare(&arc, &mut points);
        if confirmed {
            self.weigh();
        } else {
            points = echo.arc_m.map(|at_m| Point { doubted, ..Point::new(echo, at_m, false) });
        }
        for point in points {
            self.make_room();
            self.push(point);
        }
        confirmed
    }

    /// Collects, in order, the points that an echo can bear on at all: few of those there are.
    fn meet(&mut self, arc: &Arc<'_>) {
        // Written so that every point costs the same, without a branch.
        self.met.resize(self.kept.len(), 0);
        let (mut index, mut count) = (0, 0);
        for (x_m, y_m) in self.x_m.chunks(AT_ONCE).zip(self.y_m.chunks(AT_ONCE)) {
            let mut concerned = [false; AT_ONCE];
            for (concerned, (x_m, y_m)) in concerned.iter_mut().zip(x_m.iter().zip(y_m)) {
                *concerned = arc.may_concern([*x_m, *y_m]);
            }
            for concerned in &concerned[..x_m.len()] {
                self.met[count] = index;
                count += usize::from(*concerned);
                index += 1;
            }
        }
        self.met.truncate(count);
    }

    /// Says of each point met what the echo means to it, and whether one of them confirms the echo. For
    /// this case tells `points`, those of the echo, since when there is something at each of them, and how
    /// many have heard it: as long as at the points that it repeats, and one more than those.
    fn compare(&mut self, arc: &Arc<'_>, points: &mut [Point; ARC_POINTS]) -> bool {
        let mut confirmed = false;
        self.bearings.clear();
        for met in &self.met {
            let point = &self.kept[usize::from(*met)];
            let Meeting { bearing, confirms, repeated } = arc.meet(point);
            for (newer, repeated) in points.iter_mut().zip(repeated) {
                // Chosen, not branched to.
                let since = newer.since.min(point.since);
                let heard = newer.heard.max(point.heard.saturating_add(1));
                newer.since = if repeated { since } else { newer.since };
                newer.heard = if repeated { heard } else { newer.heard };
            }
            confirmed |= confirms;
            self.bearings.push(bearing);
        }
        confirmed
    }

    /// Lets a confirmed echo bear on every point that it meets.
    fn weigh(&mut self) {
        let mut gone = 0;
        for (index, bearing) in self.bearings.iter().enumerate() {
            let met = self.met[index];
            let point = &mut self.kept[usize::from(met)];
            let goes = match bearing {
                Bearing::None => false,
                Bearing::Carves => {
                    point.carved += 1;
                    point.carved >= point.carving_hits()
                }
                Bearing::Confirms => {
                    point.confirmed = true;
                    false
                }
                Bearing::Replaces => true,
            };
            self.met[gone] = met;
            gone += usize::from(goes);
        }
        self.met.truncate(gone);
        self.drop_met();
    }

    /// Forgets the points collected. The last one kept takes the place of each.
    fn drop_met(&mut self) {
        // From the last on: what takes the place of one that goes is never one that goes too.
        while let Some(met) = self.met.pop() {
            self.remove(usize::from(met));
        }
    }

    fn push(&mut self, point: Point) {
        let [x_m, y_m] = point.at_m;
        self.kept.push(point);
        self.x_m.push(x_m);
        self.y_m.push(y_m);
    }

    /// Forgets a point. The last one kept takes its place.
    fn remove(&mut self, index: usize) {
        self.kept.swap_remove(index);
        self.x_m.swap_remove(index);
        self.y_m.swap_remove(index);
    }

    /// Forgets what is too old at `now`, when the odometer stands at `odometer_m`. `silent_since` says
    /// whether a point's sonar has heard no echo since.
    pub(super) fn age(
        &mut self,
        now: Time,
        odometer_m: f64,
        silent_since: impl Fn(&Point) -> bool,
    ) {
        // Since when what is kept so long must have been heard.
        let since = |life: Span| Time(now.0.saturating_sub(life.0));
        let confirmed_since = [since(CONFIRMED_LIFE), since(RESTING_LIFE)];
        let unconfirmed_since = [since(UNCONFIRMED_LIFE), since(COMING_LIFE)];
        let is_old = |point: &Point| {
            // Chosen, not branched to: neighbours in the list are of every kind.
            let resting = (point.heard >= RESTING_HEARD)
                & (odometer_m - point.odometer_m <= RESTING_WITHIN_M);
            let coming = (point.range_m < COMING_NEAR_M) & silent_since(point);
            let long = if point.confirmed { resting } else { coming };
            let [usual, longer] = if point.confirmed { confirmed_since } else { unconfirmed_since };
            point.fired < if long { longer } else { usual }
        };
        let mut index = 0;
        while let Some(offset) = self.kept[index..].iter().position(is_old) {
            index += offset;
            self.remove(index);
        }
    }

    /// When full, forgets the oldest point.
    fn make_room(&mut self) {
        if self.kept.len() < Points::CAPACITY {
            return;
        }
        let oldest = self.kept.iter().enumerate().min_by_key(|(_, point)| point.fired);
        if let Some((index, _)) = oldest {
            self.remove(index);
        }
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        for point in &self.kept {
            point.fold(digest, start);
        }
    }
}
