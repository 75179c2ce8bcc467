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

use schemas::{Span, Time};

use super::arc::{Arc, Bearing, Meeting, Slopes};
use super::beam::ARC_POINTS;
use super::firings::{Firing, Firings, Slot};
use super::life::{Kind, Life};
use crate::digest::Digest;

/// How many echoes must have looked through a point before it goes.
const CARVE_HITS: u8 = 2;

/// … and a confirmed one that was heard from nearer than this, metres. A convex corner echoes only now and
/// then, from 1.2 m at the farthest, and while it keeps silent what stands behind it is heard: two such
/// echoes in a row are common there, four are not.
const CARVE_NEAR_M: f64 = 1.0;
const CARVE_NEAR_HITS: u8 = 4;

/// What has echoed from one place for this long stands: within the reach of a repetition, 3 cm
/// and 2 % of the range, it can have moved by 5 cm/s. Chosen: three sweeps.
const STANDS_AFTER: Span = Span(1_000_000_000);

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
    /// from 1 on for a point of an echo that was confirmed when it was heard, from 0 on for any other.
    pub(super) heard: u8,
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
        self.confirmed || !self.doubted
    }

    /// How many echoes must have looked through it before it goes.
    fn carving_hits(&self) -> u8 {
        if self.confirmed && self.range_m < CARVE_NEAR_M { CARVE_NEAR_HITS } else { CARVE_HITS }
    }

    /// What it has in common with others of its echo.
    pub(super) fn firing(&self) -> Firing {
        let Point { sonar, range_m, fired, odometer_m, .. } = *self;
        Firing { sonar, range_m, fired, odometer_m }
    }

    /// Whether what echoed has been there for so long that it is not reckoned to move.
    pub(super) fn stands(&self) -> bool {
        self.confirmed & (self.fired.since(self.since) >= STANDS_AFTER)
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
    /// Where they are, metres, by axis, and nearly there: what each echo asks of every point.
    x_m: Vec<f64>,
    y_m: Vec<f64>,
    nearly_x_m: Vec<f32>,
    nearly_y_m: Vec<f32>,
    /// Which firing each is of, and of which kind it is: what a step asks of every point.
    firing: Vec<Slot>,
    kind: Vec<Kind>,
    firings: Firings,
    /// By firing: for which kinds of life, as bits, its points are too old.
    old: Vec<u8>,
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

    /// How many firings they are of, at most: that of the echo in hand may have no point yet.
    pub(super) const FIRINGS: usize = Points::CAPACITY + 1;

    pub(super) fn new() -> Points {
        Points {
            kept: Vec::with_capacity(Points::CAPACITY),
            x_m: Vec::with_capacity(Points::CAPACITY),
            y_m: Vec::with_capacity(Points::CAPACITY),
            nearly_x_m: Vec::with_capacity(Points::CAPACITY),
            nearly_y_m: Vec::with_capacity(Points::CAPACITY),
            firing: Vec::with_capacity(Points::CAPACITY),
            kind: Vec::with_capacity(Points::CAPACITY),
            firings: Firings::new(Points::FIRINGS),
            old: Vec::with_capacity(Points::FIRINGS),
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
            points.keep(Point::new(&echo, *at_m, true));
        }
        points
    }

    /// Keeps one more point, as of a firing of its own.
    #[cfg(test)]
    pub(super) fn keep(&mut self, point: Point) {
        let firing = self.firings.add(point.firing());
        self.push(point, firing);
        self.firings.release(firing);
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

    /// What the points are of.
    pub(super) fn firings(&self) -> &[Firing] {
        self.firings.as_slice()
    }

    /// Of each point, in their order, where its firing is among those, and its kind.
    pub(super) fn kinds(&self) -> impl Iterator<Item = (usize, Kind)> {
        self.firing.iter().map(|slot| usize::from(*slot)).zip(self.kind.iter().copied())
    }

    pub(super) fn clear(&mut self) {
        self.kept.clear();
        self.x_m.clear();
        self.y_m.clear();
        self.nearly_x_m.clear();
        self.nearly_y_m.clear();
        self.firing.clear();
        self.kind.clear();
        self.firings.clear();
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
        let firing = self.firings.add(Firing::of(echo));
        for point in points {
            self.make_room();
            self.push(point, firing);
        }
        self.firings.release(firing);
        confirmed
    }

    /// Collects, in order, the points that an echo can bear on at all: few of those there are.
    fn meet(&mut self, arc: &Arc<'_>) {
        self.met.clear();
        let places_m = self.nearly_x_m.chunks(AT_ONCE).zip(self.nearly_y_m.chunks(AT_ONCE));
        for (first, (x_m, y_m)) in (0..).step_by(AT_ONCE).zip(places_m) {
            // So that several are asked at once, each answers with a byte, and eight are looked at together.
            let mut concerned = [0; AT_ONCE];
            for (concerned, (x_m, y_m)) in concerned.iter_mut().zip(x_m.iter().zip(y_m)) {
                *concerned = u8::from(arc.may_concern([*x_m, *y_m]));
            }
            for (start, eight) in (first..).step_by(8).zip(concerned.as_chunks().0) {
                let mut left = u64::from_le_bytes(*eight);
                while left != 0 {
                    self.met.push(start + (left.trailing_zeros() / 8) as u16);
                    left &= left - 1;
                }
            }
        }
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
                    self.kind[usize::from(met)] = Kind::of(point);
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

    /// Keeps a point of a firing, which it holds.
    fn push(&mut self, point: Point, firing: Slot) {
        let [x_m, y_m] = point.at_m;
        self.firings.hold(firing);
        self.kept.push(point);
        self.x_m.push(x_m);
        self.y_m.push(y_m);
        self.nearly_x_m.push(x_m as f32);
        self.nearly_y_m.push(y_m as f32);
        self.firing.push(firing);
        self.kind.push(Kind::of(&point));
    }

    /// Forgets a point. The last one kept takes its place.
    fn remove(&mut self, index: usize) {
        self.kept.swap_remove(index);
        self.x_m.swap_remove(index);
        self.y_m.swap_remove(index);
        self.nearly_x_m.swap_remove(index);
        self.nearly_y_m.swap_remove(index);
        self.kind.swap_remove(index);
        self.firings.release(self.firing.swap_remove(index));
    }

    /// Forgets what is too old at `now`, when the odometer stands at `odometer_m`. `silent_since` says
    /// whether a firing's sonar has heard no echo since.
    pub(super) fn age(
        &mut self,
        now: Time,
        odometer_m: f64,
        silent_since: impl Fn(&Firing) -> bool,
    ) {
        let life = Life::new(now, odometer_m);
        self.old.clear();
        let old = self.firings.as_slice().iter().map(|firing| life.old(firing, &silent_since));
        self.old.extend(old);
        if self.old.iter().all(|old| *old == 0) {
            return;
        }
        let mut index = 0;
        while let Some(offset) = self.first_old(index) {
            index += offset;
            self.remove(index);
        }
    }

    /// How many points from `index` on come before the first one that is too old.
    fn first_old(&self, index: usize) -> Option<usize> {
        let points = self.firing[index..].iter().zip(&self.kind[index..]);
        points
            .map(|(firing, kind)| kind.is_among(self.old[usize::from(*firing)]))
            .position(|old| old)
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

#[cfg(test)]
mod tests;
