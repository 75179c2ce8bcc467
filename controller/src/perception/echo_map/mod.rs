//! From sonar echoes to safe distances.
//!
//! In: sonar scans, the [`Odometry`] that says where the robot was when each sonar fired, and the
//! pose that the next command will find the robot at. Out: how far the disc about the body may travel
//! in any direction, for the feedback law and for the safety layer, and whether that is known at all.
//!
//! Once a step:
//! 1. each echo is placed at the pose of its own firing, as an arc across its cone, and confirms,
//!    replaces or carves what is remembered (`points`);
//! 2. what has grown old is forgotten;
//! 3. the rest is drawn nearer by its uncertainty and sorted by direction about the predicted pose: the
//!    virtual scan (`scan`). Confirmed points make the scan of the law, all points that of the safety
//!    layer, but for those of echoes that contradict what their sonar heard just before (`surprise`): a
//!    false echo may stop the robot for 0.4 s, but never starts the feedback law. Only the
//!    safety layer reckons with what has moved since it was heard: the law's distances would sway with
//!    every sweep, and k with them;
//! 4. rays are answered from the scans, and by `cones` where nothing is known.
//!
//! Where no cone looks (60–80° and 100–120° on either side) the nearest echo of the sonars within 30°
//! counts (specification, section 10), beside what is remembered (`gaps`).
//!
//! Constants said to come from the prototype were chosen in a simulation study that preceded this
//! program.

mod arc;
mod beam;
mod cones;
mod doubt;
mod faces;
mod firings;
mod gaps;
mod life;
mod limit;
mod points;
mod ray;
mod scan;
mod sightings;
mod surprise;
mod walls;

use std::cell::{Cell, Ref, RefCell};
use std::ops::Deref;

use schemas::{Disc, Footprint, Pose, SONARS, SonarEcho, SonarScan, Time};

use self::beam::{Beam, BodyToWorld, unit};
use self::cones::{Cones, Reading};
use self::doubt::Doubts;
use self::faces::Faces;
use self::gaps::Gaps;
pub use self::limit::LimitingEcho;
use self::points::{PlacedEcho, Points};
use self::ray::{Lane, Ray, least_free_m};
use self::scan::Scan;
use self::sightings::{Sightings, drawn_nearer_m};
use self::surprise::Nearby;
use crate::digest::Digest;
use crate::estimation::Odometry;

/// How many readings wait for the next step, at most: two full sweeps. More are placed at once.
const PENDING: usize = 2 * SONARS.len();

/// A stamp this much older than its predecessor, seconds, is a new clock, not a late reading.
const CLOCK_SET_S: f64 = 1.0;

/// What the map is to assume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EchoMapSettings {
    /// Radius of the disc whose free travel is asked for, metres: the circumscribed radius of the
    /// footprint.
    pub inflation_m: f64,
    /// Speed bound of moving obstacles, m/s.
    pub v_disc_mps: f64,
    /// Age from which a reading no longer counts and its cone is unknown, seconds (specification,
    /// section 10).
    pub lease_s: f64,
}

/// A short memory of echoes and what follows from it. Allocates in [`EchoMap::new`] only.
#[derive(Clone, Debug)]
pub struct EchoMap {
    settings: EchoMapSettings,
    beams: [Beam; SONARS.len()],
    /// Readings that wait to be placed, with the odometer at which they came in, metres.
    pending: Vec<(SonarEcho, f64)>,
    cones: Cones,
    nearby: Nearby,
    gaps: Gaps,
    points: Points,
    faces: Faces,
    sightings: Sightings,
    law: Scan,
    /// Made when it is first asked for, which most steps never do.
    safety: RefCell<Scan>,
    safety_made: Cell<bool>,
    /// What the gaps' points add, for the law and for the safety layer, metres, world frame.
    law_gaps: Vec<[f64; 2]>,
    safety_gaps: Vec<[f64; 2]>,
    advanced_to: Option<Time>,
}

impl EchoMap {
    /// An empty map: everything is unknown.
    pub fn new(settings: EchoMapSettings) -> EchoMap {
        EchoMap {
            settings,
            beams: Beam::all(),
            pending: Vec::with_capacity(PENDING),
            cones: Cones::new(),
            nearby: Nearby::new(),
            gaps: Gaps::new(),
            points: Points::new(),
            faces: Faces::new(),
            sightings: Sightings::new(),
            law: Scan::new(settings.inflation_m),
            safety: RefCell::new(Scan::new(settings.inflation_m)),
            safety_made: Cell::new(true),
            law_gaps: Vec::with_capacity(Gaps::MOST_POINTS),
            safety_gaps: Vec::with_capacity(Gaps::MOST_POINTS),
            advanced_to: None,
        }
    }

    /// Takes a scan. Its echoes wait for [`EchoMap::advance`], when odometry has caught up with them.
    /// Readings of unknown sonars, and readings that are late or come twice, are ignored.
    pub fn observe(&mut self, scan: &SonarScan, odometry: &Odometry) {
        for echo in &scan.echoes {
            if self.pending.len() == PENDING {
                self.place_pending(odometry);
            }
            if usize::from(echo.id) < SONARS.len() {
                self.pending.push((*echo, odometry.odometer_m()));
            }
        }
    }

    /// Brings the map to `now`: places what was heard, ages the rest, and prepares the rays about
    /// `about`, the pose they will be asked from. To be called once a step, before any ray.
    pub fn advance(&mut self, now: Time, odometry: &Odometry, about: &Pose) {
        if self.advanced_to.is_some_and(|before| before.seconds_since(now) > CLOCK_SET_S) {
            self.forget();
        }
        self.advanced_to = Some(now);
        self.place_pending(odometry);
        let cones = &self.cones;
        self.points.age(now, odometry.odometer_m(), |firing| {
            !cones.echoed_after(firing.sonar, firing.fired)
        });
        self.cones.age(now, self.settings.lease_s);
        self.look(now, odometry.odometer_m(), about.position_m());
    }

    /// Free travel, metres, of the disc from `from` along the world angle `angle_rad`, through what at
    /// least two firings have heard. +∞ where the direction has been looked at and nothing is met,
    /// negative in contact, NaN where nothing is known: a sonar that looks there is silent for more
    /// than 0.5 s, gave nonsense, or has not fired yet. The heading of `from` says which sonars look.
    pub fn law_ray_m(&self, from: &Pose, angle_rad: f64) -> f64 {
        if self.knows(from, angle_rad) {
            self.ray_m(&self.law, &self.law_gaps, from, angle_rad)
        } else {
            f64::NAN
        }
    }

    /// The same for a footprint about `from` that points along the world angle `angle_rad`: how far it
    /// may go on straight before its front meets something, metres (specification, section 5).
    pub fn law_travel_m(&self, footprint: &Footprint, from: &Pose, angle_rad: f64) -> f64 {
        if !self.knows(from, angle_rad) {
            return f64::NAN;
        }
        let lane = Lane::of(footprint, from, angle_rad);
        let remembered_m = self.law.travel_m(&lane);
        if Gaps::hold(angle_rad - from.theta_rad) {
            remembered_m.min(lane.free_m(&self.law_gaps))
        } else {
            remembered_m
        }
    }

    /// The same through everything that was heard, with the unknown as 0: blocked. Never NaN.
    pub fn safety_ray_m(&self, from: &Pose, angle_rad: f64) -> f64 {
        if self.knows(from, angle_rad) {
            self.ray_m(&self.safety(), &self.safety_gaps, from, angle_rad)
        } else {
            0.0
        }
    }

    /// A bound on the safety layer's rays from `from`, metres: whatever the direction, none is shorter. −∞ where
    /// one may be unknown.
    pub(crate) fn safety_least_m(&self, from: &Pose) -> f64 {
        let from_m = from.position_m();
        if !self.cones.all_fresh() || !from.is_finite() || from_m != self.sightings.about_m() {
            return f64::NEG_INFINITY;
        }
        let away_m2 = |[x_m, y_m]: &[f64; 2]| {
            let [dx, dy] = [x_m - from_m[0], y_m - from_m[1]];
            dx * dx + dy * dy
        };
        let in_gaps_m2 = self.safety_gaps.iter().map(away_m2).fold(f64::INFINITY, f64::min);
        least_free_m(self.settings.inflation_m, self.sightings.least_m().min(in_gaps_m2.sqrt()))
    }

    /// The points that the law's rays meet, metres, world frame: the nearest per direction about the
    /// pose given to [`EchoMap::advance`], drawn nearer by their uncertainty.
    pub fn law_points(&self) -> &[[f64; 2]] {
        self.law.points_m()
    }

    /// The points that the safety layer's rays meet, likewise.
    pub fn safety_points(&self) -> impl Deref<Target = [[f64; 2]]> {
        Ref::map(self.safety(), Scan::points_m)
    }

    /// The points that the safety layer's rays meet besides in the blind gaps, likewise; few and only
    /// of the last half second.
    pub fn safety_gap_points(&self) -> &[[f64; 2]] {
        &self.safety_gaps
    }

    /// Signed distance, metres, from a footprint at `at` to the nearest of the points that the safety
    /// layer's rays meet outside the gaps; minus the least way out of the footprint for a point within
    /// it, +∞ where there is none, NaN at a pose that is not finite. What is not known is not looked at:
    /// ask [`EchoMap::known`] for the directions that matter.
    pub fn safety_clearance_m(&self, footprint: &Footprint, at: &Pose) -> f64 {
        if !at.is_finite() {
            return f64::NAN;
        }
        let ahead = unit(at.theta_rad);
        let half_m = [0.5 * footprint.length_m, 0.5 * footprint.width_m];
        let mut least_m = f64::INFINITY;
        for [x, y] in self.safety().points_m() {
            let [dx, dy] = [x - at.x_m, y - at.y_m];
            let beyond_m = (dx * ahead[0] + dy * ahead[1]).abs() - half_m[0];
            let aside_m = (dy * ahead[0] - dx * ahead[1]).abs() - half_m[1];
            let outside_m = libm::hypot(beyond_m.max(0.0), aside_m.max(0.0));
            least_m = least_m.min(outside_m + beyond_m.max(aside_m).min(0.0));
        }
        least_m
    }

    /// Most points there can be, those of walls between them too.
    pub(crate) const MOST_POINTS: usize = Points::CAPACITY + walls::MOST_POINTS;

    /// Everything that was heard and counts, each point as a disc of its uncertainty, world frame, and whether it
    /// may be on its way. To be asked after [`EchoMap::advance`].
    pub(crate) fn near_points(&self) -> impl Iterator<Item = (Disc, bool)> + '_ {
        let doubts = self.sightings.doubts();
        let counted = self.points.as_slice().iter().zip(doubts).filter(|(point, _)| point.counts());
        counted.map(|(point, (nearer_m, moves))| {
            (Disc { centre_m: point.at_m, radius_m: nearer_m }, moves)
        })
    }

    /// Where walls may be between neighbouring confirmed points, near the place given to
    /// [`EchoMap::advance`]: see [`walls`].
    pub(crate) fn walls_between(&self, each: impl FnMut([f64; 2])) {
        walls::between(self.law.points_m(), self.sightings.about_m(), each);
    }

    /// Whether the ways ahead and behind have been looked at: every sonar within 50° of either.
    pub(crate) fn knows_the_ways(&self) -> [bool; 2] {
        const ACROSS_DEG: [f64; 7] = [-50.0, -30.0, -10.0, 0.0, 10.0, 30.0, 50.0];
        [0.0, 180.0].map(|way_deg: f64| {
            ACROSS_DEG.iter().all(|off_deg| self.known((way_deg + off_deg).to_radians()))
        })
    }

    /// Whether every sonar has given a valid reading at least once.
    pub fn heard_all(&self) -> bool {
        self.cones.heard_all()
    }

    /// How many of the cones are unknown.
    pub fn unknown_cones(&self) -> usize {
        self.cones.unknown()
    }

    /// Whether no cone is known.
    pub fn dead(&self) -> bool {
        self.cones.dead()
    }

    /// Whether a direction in the body frame is being looked at: the cones that contain it, or, where
    /// none does, those within 30°, all gave a valid reading in the last 0.5 s.
    pub fn known(&self, body_angle_rad: f64) -> bool {
        self.cones.known(&self.beams, body_angle_rad)
    }

    /// World angle from `from` straight into the nearest face, radians, from −π to π; `None` where too
    /// few echoes agree on one. To be asked after [`EchoMap::advance`].
    pub fn face_direction_rad(&self, from: &Pose) -> Option<f64> {
        let now = self.advanced_to.filter(|_| from.is_finite())?;
        self.faces.nearest_rad(&self.points, from.position_m(), now)
    }

    /// Takes the whole state into a hash; `start` is the start of the session.
    pub(crate) fn fold(&self, digest: &mut Digest, start: Time) {
        if let Some(now) = self.advanced_to {
            digest.time(now, start);
        }
        for (echo, odometer_m) in &self.pending {
            digest.word(u64::from(echo.id) << 1 | u64::from(echo.echo));
            digest.time(echo.fired, start);
            digest.numbers(&[echo.range_m, *odometer_m]);
        }
        self.cones.fold(digest, start);
        self.nearby.fold(digest, start);
        self.gaps.fold(digest, start);
        self.points.fold(digest, start);
    }

    fn knows(&self, from: &Pose, angle_rad: f64) -> bool {
        from.is_finite() && self.known(angle_rad - from.theta_rad)
    }

    fn ray_m(&self, scan: &Scan, gaps_m: &[[f64; 2]], from: &Pose, angle_rad: f64) -> f64 {
        let from_m = from.position_m();
        let along = unit(angle_rad);
        let remembered_m = scan.free_m(from_m, along);
        if Gaps::hold(angle_rad - from.theta_rad) {
            let ray = Ray { from_m, along, radius_m: self.settings.inflation_m };
            remembered_m.min(ray.free_m(gaps_m))
        } else {
            remembered_m
        }
    }

    /// The scan of the safety layer.
    fn safety(&self) -> Ref<'_, Scan> {
        if !self.safety_made.replace(true) {
            self.safety.borrow_mut().take(&self.sightings, self.sightings.drawn_m());
        }
        self.safety.borrow()
    }

    fn forget(&mut self) {
        self.cones = Cones::new();
        self.nearby = Nearby::new();
        self.gaps.clear();
        self.points.clear();
    }

    fn place_pending(&mut self, odometry: &Odometry) {
        for index in 0..self.pending.len() {
            let (echo, odometer_m) = self.pending[index];
            self.place(&echo, odometer_m, odometry);
        }
        self.pending.clear();
    }

    fn place(&mut self, echo: &SonarEcho, odometer_m: f64, odometry: &Odometry) {
        let id = usize::from(echo.id);
        match self.cones.fired(id) {
            Some(before) if before.seconds_since(echo.fired) > CLOCK_SET_S => self.forget(),
            Some(before) if before >= echo.fired => return,
            _ => {}
        }
        // Without a pose an echo is nowhere; nor is its silence.
        let Some(pose) = odometry.pose_at(echo.fired) else {
            self.cones.hear(id, echo.fired, Reading::Unknown);
            return;
        };
        let reading = Reading::of(echo);
        let doubted = match reading {
            Reading::Echo(range_m) => self.nearby.surprised(&self.cones, id, range_m, echo.fired),
            Reading::Silent | Reading::Unknown => false,
        };
        self.cones.hear(id, echo.fired, reading);
        let Reading::Echo(range_m) = reading else { return };
        self.nearby.hear(id, range_m, echo.fired);

        let to_world = BodyToWorld::new(&pose);
        let beam = &self.beams[id];
        let from_m = to_world.point_m(beam.mount_m);
        let arc = beam.arc.map(|direction| to_world.vector(direction));
        let placed = PlacedEcho {
            sonar: echo.id,
            from_m,
            axis: arc[arc.len() / 2],
            arc_m: arc.map(|[x, y]| [from_m[0] + range_m * x, from_m[1] + range_m * y]),
            range_m,
            fired: echo.fired,
            odometer_m,
        };
        let confirmed = self.points.hear(&placed, doubted);
        if confirmed || !doubted {
            self.gaps.hear(id, &self.beams, &to_world, &placed, confirmed);
        }
    }

    /// Builds both scans about a place.
    fn look(&mut self, now: Time, odometer_m: f64, about_m: [f64; 2]) {
        let EchoMapSettings { v_disc_mps, lease_s, .. } = self.settings;
        let doubts = Doubts { cones: &self.cones, now, odometer_m, v_disc_mps };
        self.sightings.take(&self.points, about_m, |firing| doubts.about_firing(firing));
        self.law.take(&self.sightings, self.sightings.law_drawn_m());
        self.safety_made.set(false);

        self.law_gaps.clear();
        self.safety_gaps.clear();
        for point in self.gaps.points(now, lease_s) {
            let doubt = doubts.about(point);
            let drawn_nearer_m = |by_m| drawn_nearer_m(about_m, point.at_m, by_m);
            self.safety_gaps.extend(drawn_nearer_m(doubt.nearer_m()));
            if point.confirmed {
                self.law_gaps.extend(drawn_nearer_m(doubt.stands_m));
            }
        }
    }
}

#[cfg(test)]
mod tests;
