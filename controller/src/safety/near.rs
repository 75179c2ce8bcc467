//! What stands near the robot, as the swept body meets it.
//!
//! Gathered once a step: everything within reach, each thing with how near it is already. A motion is
//! judged against all of them. Allocates in [`Near::new`] only.

use schemas::{Body, Disc, Footprint, HalfPlane, Obstacle, Pose};

/// Bounds on distances are compared with this slack, metres, so that rounding never passes over a thing.
const HAIR_M: f64 = 1e-6;

/// One thing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Thing {
    Wall(HalfPlane),
    /// By its place in the list of obstacles.
    Obstacle(usize),
    Disc(Disc),
}

/// Which outline of the robot has to stay clear of a thing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Outline {
    /// The footprint.
    Rectangle,
    /// The circle that the footprint can turn in.
    TurningCircle,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct NearThing {
    thing: Thing,
    outline: Outline,
    /// Distance of the outline at the start, metres.
    start_m: f64,
    /// Bound on its speed, m/s.
    speed_mps: f64,
    /// How much nearer than it was heard it is taken to be, metres.
    doubt_m: f64,
}

impl NearThing {
    /// How near the outline may come to what it is near to already, metres: no nearer, but for a share of
    /// the doubt, and never nearer than the guard to where the thing was heard.
    fn allowed_m(&self, keep: &Keep) -> f64 {
        let heard_m = (keep.guard_m - self.doubt_m).min(self.start_m);
        (self.start_m - keep.doubt_share * self.doubt_m).max(heard_m)
    }
}

/// Everything within reach of a robot at one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Near {
    footprint: Footprint,
    circle_m: f64,
    obstacles: Vec<Obstacle>,
    things: Vec<NearThing>,
    pose: Pose,
    /// The body there.
    body: Body,
    reach_m: f64,
    horizon_s: f64,
    /// Whether the turning circle is to stay clear of what it is clear of.
    keep_circle_m: Option<f64>,
    known: [bool; 2],
    /// How fast anything may move, m/s.
    fastest_mps: f64,
    /// Whether something is within the turning circle.
    crowded: bool,
    /// Distance of the turning circle to the nearest thing, metres.
    circle_clear_m: f64,
}

/// How a place is judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keep {
    /// Distance to be kept, metres.
    pub guard_m: f64,
    /// Seconds from now.
    pub later_s: f64,
    /// Share of a thing's doubt that may be given up within a period.
    pub doubt_share: f64,
    /// Forward speed there, m/s: its sign says which way the robot goes.
    pub v_mps: f64,
}

impl Near {
    /// Nothing yet, about a body of this footprint; room for `most` discs beside the walls and
    /// `obstacles` of a room.
    pub fn new(footprint: Footprint, obstacles: &[Obstacle], most: usize) -> Near {
        Near {
            footprint,
            circle_m: footprint.circumscribed_radius_m(),
            obstacles: obstacles.to_vec(),
            things: Vec::with_capacity(most + obstacles.len()),
            pose: Pose::default(),
            body: Body::new(&footprint, &Pose::default()),
            reach_m: 0.0,
            horizon_s: 0.0,
            keep_circle_m: None,
            known: [true; 2],
            fastest_mps: 0.0,
            crowded: false,
            circle_clear_m: f64::INFINITY,
        }
    }

    /// Starts again: about a body at `pose` to which nothing matters that is farther than `reach_m` beyond
    /// its turning circle, and that rests `horizon_s` after the surroundings were as they are known, at
    /// the latest.
    /// With `keep_circle_m` the turning circle stays that clear of everything that it is that clear
    /// of, and only what is nearer is left to the rectangle.
    pub fn clear(
        &mut self,
        pose: &Pose,
        (reach_m, horizon_s): (f64, f64),
        keep_circle_m: Option<f64>,
    ) {
        self.things.clear();
        self.pose = *pose;
        self.body = Body::new(&self.footprint, pose);
        self.reach_m = reach_m + self.circle_m;
        self.horizon_s = horizon_s;
        self.keep_circle_m = keep_circle_m;
        self.known = [true; 2];
        self.fastest_mps = 0.0;
        self.crowded = false;
        self.circle_clear_m = f64::INFINITY;
    }

    /// Says whether the directions ahead and behind have been looked at.
    pub fn looked(&mut self, known: [bool; 2]) {
        self.known = known;
    }

    /// Whether the way of `v_mps` has been looked at.
    pub fn knows_the_way(&self, v_mps: f64) -> bool {
        let [ahead, behind] = self.known;
        (ahead || v_mps <= 0.0) && (behind || v_mps >= 0.0)
    }

    /// Whether something is within the turning circle, though not what may only be there.
    pub fn crowded(&self) -> bool {
        self.crowded
    }

    /// How clear the turning circle is of everything, metres; +∞ with nothing within reach.
    pub fn circle_clear_m(&self) -> f64 {
        self.circle_clear_m
    }

    /// Adds a wall.
    pub fn wall(&mut self, wall: &HalfPlane) {
        if wall.distance_m(self.pose.position_m()) <= self.reach_m {
            self.add(Thing::Wall(*wall), 0.0, 0.0);
        }
    }

    /// Adds every obstacle.
    pub fn obstacles(&mut self) {
        for index in 0..self.obstacles.len() {
            if self.obstacles[index].distance_m(self.pose.position_m()) <= self.reach_m {
                self.add(Thing::Obstacle(index), 0.0, 0.0);
            }
        }
    }

    /// Adds a disc that may move at up to `speed_mps`.
    pub fn disc(&mut self, disc: Disc, speed_mps: f64, doubt_m: f64) {
        let [dx, dy] = [disc.centre_m[0] - self.pose.x_m, disc.centre_m[1] - self.pose.y_m];
        let within_m = self.reach_m + disc.radius_m + speed_mps * self.horizon_s;
        if dx * dx + dy * dy <= within_m * within_m {
            self.add(Thing::Disc(disc), speed_mps, doubt_m);
        }
    }

    /// `doubt_m`: how much nearer than it should be the thing is taken to be.
    fn add(&mut self, thing: Thing, speed_mps: f64, doubt_m: f64) {
        let mut near =
            NearThing { thing, outline: Outline::TurningCircle, start_m: 0.0, speed_mps, doubt_m };
        near.start_m = self.distance_m(&near, &self.body, &self.pose);
        self.fastest_mps = self.fastest_mps.max(speed_mps);
        self.circle_clear_m = self.circle_clear_m.min(near.start_m + doubt_m);
        self.crowded |= near.start_m + doubt_m < 0.0;
        if self.keep_circle_m.is_some_and(|keep_m| near.start_m + doubt_m >= keep_m) {
            self.things.push(near);
            return;
        }
        near.outline = Outline::Rectangle;
        near.start_m = self.distance_m(&near, &self.body, &self.pose);
        self.things.push(near);
    }

    fn distance_m(&self, near: &NearThing, body: &Body, pose: &Pose) -> f64 {
        match (near.outline, near.thing) {
            (Outline::Rectangle, Thing::Wall(wall)) => body.to_wall_m(&wall),
            (Outline::Rectangle, Thing::Obstacle(index)) => {
                body.to_obstacle_m(&self.obstacles[index])
            }
            (Outline::Rectangle, Thing::Disc(disc)) => body.to_disc_m(&disc),
            (Outline::TurningCircle, Thing::Wall(wall)) => {
                wall.distance_m(pose.position_m()) - self.circle_m
            }
            (Outline::TurningCircle, Thing::Obstacle(index)) => {
                self.obstacles[index].distance_m(pose.position_m()) - self.circle_m
            }
            (Outline::TurningCircle, Thing::Disc(disc)) => {
                let [dx, dy] = [disc.centre_m[0] - pose.x_m, disc.centre_m[1] - pose.y_m];
                libm::sqrt(dx * dx + dy * dy) - disc.radius_m - self.circle_m
            }
        }
    }

    /// Whether a thing is certainly farther than `within_m` from a body at `pose`: told without its outline.
    fn is_beyond(&self, near: &NearThing, pose: &Pose, within_m: f64) -> bool {
        let Thing::Disc(disc) = near.thing else { return false };
        let [dx, dy] = [disc.centre_m[0] - pose.x_m, disc.centre_m[1] - pose.y_m];
        // No point of the body is farther from its centre than the circle.
        let reach_m = within_m + disc.radius_m + self.circle_m + HAIR_M;
        reach_m > 0.0 && dx * dx + dy * dy > reach_m * reach_m
    }

    /// Where everything was gathered about.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Radius of the turning circle, metres: no point of the body is farther from its centre.
    pub fn circle_m(&self) -> f64 {
        self.circle_m
    }

    /// By how much a body at `pose` is farther from everything than it has to be, metres: negative
    /// where it comes nearer than the guard to something, or nearer than it is already where that is
    /// less. +∞ with nothing within reach.
    pub fn slack_m(&self, pose: &Pose, keep: &Keep) -> f64 {
        if self.things.is_empty() {
            return f64::INFINITY;
        }
        let body = Body::new(&self.footprint, pose);
        // Only what moves is met on the way.
        let ways = if self.fastest_mps > 0.0 {
            &[Way::new(&body, pose, keep), Way::new(&self.body, &self.pose, keep)][..]
        } else {
            &[]
        };
        let mut least_m = f64::INFINITY;
        // Nothing has to be left more room than this.
        let most_m = keep.guard_m + self.fastest_mps * keep.later_s;
        for near in &self.things {
            if self.is_beyond(near, pose, most_m + least_m) {
                continue;
            }
            // What may come against the robot's way has to be left room for, however near it is already;
            // what the robot leaves behind, or stands before, it need only not come nearer to.
            let required_m = if ways.iter().any(|way| way.meets(near, keep.later_s)) {
                keep.guard_m + near.speed_mps * keep.later_s
            } else {
                keep.guard_m.min(near.allowed_m(keep))
            };
            if self.is_beyond(near, pose, required_m + least_m) {
                continue;
            }
            let slack_m = self.distance_m(near, &body, pose) - required_m;
            if slack_m.is_nan() {
                return f64::NAN;
            }
            least_m = least_m.min(slack_m);
        }
        least_m
    }
}

/// Which way a robot goes.
struct Way<'a> {
    pose: &'a Pose,
    /// Unit vector along its heading.
    forward: [f64; 2],
    v_mps: f64,
}

impl Way<'_> {
    fn new<'a>(body: &Body, pose: &'a Pose, keep: &Keep) -> Way<'a> {
        Way { pose, forward: body.forward(), v_mps: keep.v_mps }
    }

    /// Whether it may have something that moves before it: before the line through its centre across
    /// its way, or where that thing can have come `later_s` from now.
    fn meets(&self, near: &NearThing, later_s: f64) -> bool {
        let Thing::Disc(disc) = near.thing else { return false };
        if near.speed_mps == 0.0 || self.v_mps == 0.0 {
            return false;
        }
        let [cos, sin] = self.forward;
        let [dx, dy] = [disc.centre_m[0] - self.pose.x_m, disc.centre_m[1] - self.pose.y_m];
        let before_m = libm::copysign(1.0, self.v_mps) * (dx * cos + dy * sin);
        before_m + near.speed_mps * later_s > 0.0
    }
}
