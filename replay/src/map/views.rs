//! Echoes, each with where its sonar was and which way it looked.

use std::collections::VecDeque;

use schemas::{Header, Pose, SONARS, SonarEcho, SonarScan, Span, Time, wrap};

/// Farther echoes say too little about where they came from, metres.
const REACH_M: f64 = 3.5;

/// Nearer than this a sonar is as good as touched, metres.
const NEAREST_M: f64 = 0.12;

/// More slip than this is none that a log could show, as a share.
const MOST_SLIP: f64 = 0.2;

/// Longest time between two poses across which a firing is placed.
const LONGEST_GAP: Span = Span(500_000_000);

/// A later echo is a repetition, and no new evidence, if its sonar has moved and turned less than
/// this and heard the same.
const SAME_PLACE_M: f64 = 0.04;
const SAME_AXIS_RAD: f64 = 0.05;

/// What one sonar heard from one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    /// Seconds from the start.
    pub(super) t_s: f64,
    pub(super) from_m: [f64; 2],
    /// The middle of the body.
    pub(super) body_m: [f64; 2],
    /// World angle of the sonar's axis.
    pub(super) axis_rad: f64,
    /// +∞ where nothing was heard.
    pub(super) range_m: f64,
}

impl View {
    /// The point of the arc at an angle from the axis.
    pub(super) fn at(&self, off_rad: f64) -> [f64; 2] {
        self.along(off_rad, self.range_m)
    }

    /// A point at a distance, at an angle from the axis.
    pub(super) fn along(&self, off_rad: f64, distance_m: f64) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.axis_rad + off_rad);
        [self.from_m[0] + distance_m * cos, self.from_m[1] + distance_m * sin]
    }
}

/// Everything heard, and where the body went.
#[derive(Debug)]
pub(super) struct Gathered {
    pub(super) views: Vec<View>,
    /// Of sonars that heard something too far away, or nothing (+∞).
    pub(super) beyond: Vec<View>,
    /// Poses of the body with their times, in seconds from the start.
    pub(super) way: Vec<(f64, Pose)>,
    pub(super) half_size_m: [f64; 2],
}

impl Gathered {
    pub(super) fn is_empty(&self) -> bool {
        self.views.is_empty()
    }
}

/// Echoes that wait for the pose after them.
pub(super) struct Views {
    start: Time,
    /// Where the way began, and what share of it the body really went.
    home_m: [f64; 2],
    gone: f64,
    gathered: Gathered,
    waiting: VecDeque<SonarEcho>,
    before: Option<(Time, Pose)>,
    /// By sonar, the newest view.
    newest: [Option<View>; SONARS.len()],
}

impl Views {
    /// `slip` is the share of the wheels' travel that was lost; the estimate knows nothing of it.
    pub(super) fn new(header: &Header, slip: f64) -> Views {
        let gone = if slip.is_finite() { 1.0 - slip.clamp(-MOST_SLIP, MOST_SLIP) } else { 1.0 };
        let footprint = header.scenario.robot.footprint;
        Views {
            start: header.run.start,
            home_m: header.scenario.start.pose.position_m(),
            gone,
            gathered: Gathered {
                views: Vec::new(),
                beyond: Vec::new(),
                way: Vec::new(),
                half_size_m: [0.5 * footprint.length_m, 0.5 * footprint.width_m],
            },
            waiting: VecDeque::new(),
            before: None,
            newest: [None; SONARS.len()],
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.gathered.is_empty()
    }

    pub(super) fn hear(&mut self, scan: &SonarScan) {
        // What claims to have been fired after it was reported would keep all that follow waiting.
        let usable = |echo: &&SonarEcho| {
            echo.fired <= scan.stamp && (!echo.echo || echo.range_m >= NEAREST_M)
        };
        self.waiting.extend(scan.echoes.iter().filter(usable));
    }

    /// The body believes to be here now: what was fired until now can be placed.
    pub(super) fn stand(&mut self, stamp: Time, pose: &Pose) {
        // Without a pose from before and after nothing is placed.
        while self
            .waiting
            .front()
            .is_some_and(|echo| echo.fired.0.saturating_add(LONGEST_GAP.0) < stamp.0)
        {
            self.waiting.pop_front();
        }
        if !pose.is_finite() {
            return;
        }
        let [x_m, y_m] = [(pose.x_m, 0), (pose.y_m, 1)]
            .map(|(at_m, axis)| self.home_m[axis] + self.gone * (at_m - self.home_m[axis]));
        let pose = &Pose { x_m, y_m, ..*pose };
        self.gathered.way.push((stamp.seconds_since(self.start), *pose));
        if let Some((earlier, from)) = self.before
            && earlier < stamp
        {
            while let Some(echo) = self.waiting.pop_front_if(|echo| echo.fired <= stamp) {
                if echo.fired >= earlier && stamp.0 - earlier.0 <= LONGEST_GAP.0 {
                    let share = echo.fired.seconds_since(earlier) / stamp.seconds_since(earlier);
                    self.place(&echo, &part_way(&from, pose, share));
                }
            }
        }
        self.before = Some((stamp, *pose));
    }

    fn place(&mut self, echo: &SonarEcho, pose: &Pose) {
        let id = usize::from(echo.id);
        let Some(mount) = SONARS.get(id) else { return };
        let view = View {
            t_s: echo.fired.seconds_since(self.start),
            from_m: pose.transform(mount.x_m, mount.y_m),
            body_m: pose.position_m(),
            axis_rad: pose.theta_rad + mount.bearing_deg.to_radians(),
            range_m: if echo.echo { echo.range_m } else { f64::INFINITY },
        };
        let newest = self.newest[id].as_ref();
        let repeated = newest.is_some_and(|newest| {
            let moved_m =
                libm::hypot(view.from_m[0] - newest.from_m[0], view.from_m[1] - newest.from_m[1]);
            moved_m < SAME_PLACE_M
                && wrap(view.axis_rad - newest.axis_rad).abs() < SAME_AXIS_RAD
                && (view.range_m == newest.range_m
                    || (view.range_m - newest.range_m).abs() < 0.03 + 0.02 * view.range_m)
        });
        if !repeated {
            self.newest[id] = Some(view);
            if view.range_m <= REACH_M {
                self.gathered.views.push(view);
            } else {
                self.gathered.beyond.push(view);
            }
        }
    }

    pub(super) fn finish(self) -> Gathered {
        self.gathered
    }
}

/// The pose that share of the way from one to the other, the short way round.
fn part_way(from: &Pose, to: &Pose, share: f64) -> Pose {
    Pose {
        x_m: from.x_m + share * (to.x_m - from.x_m),
        y_m: from.y_m + share * (to.y_m - from.y_m),
        theta_rad: from.theta_rad + share * wrap(to.theta_rad - from.theta_rad),
    }
}
