//! A log seen from above: the room, what stands and walks in it, and both paths.

use std::fmt::Write;

use schemas::{Footprint, HalfPlane, Pose, Scenario};
use serde::Serialize;

use crate::comparison::{Arm, Scene, ViolationRecord};
use crate::metrics::{Track, TrackPoint};

/// Width and height that a map is fitted into, SVG units.
const WIDTH: f64 = 620.0;
const HEIGHT: f64 = 440.0;

/// How far beyond paths and obstacles a map looks for walls, metres.
const LOOKS_FOR_WALLS_M: f64 = 2.0;

/// Blank around everything drawn, metres.
const BORDER_M: f64 = 0.25;

/// Most points of a drawn path.
pub(super) const MOST_POINTS: usize = 300;

/// A map, ready to be drawn.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Map {
    width: String,
    height: String,
    /// Corners of the free space inside the room.
    room: String,
    obstacles: Vec<String>,
    /// Where discs walk: from, to, and radius.
    discs: Vec<DiscShape>,
    /// Path of the task's target.
    task: Option<String>,
    a: Option<PathShape>,
    b: Option<PathShape>,
    /// Length of the scale bar of one metre.
    metre: String,
    violations: Vec<Cross>,
}

#[derive(Clone, Debug, Serialize)]
struct DiscShape {
    from: [String; 2],
    to: [String; 2],
    radius: String,
}

#[derive(Clone, Debug, Serialize)]
struct PathShape {
    line: String,
    start: [String; 2],
    end: [String; 2],
    /// The body at the end; empty for a point robot.
    body: String,
}

/// A violation's place.
#[derive(Clone, Debug, Serialize)]
struct Cross {
    at: [String; 2],
    arm: &'static str,
    label: String,
}

/// From metres in the world to units of the picture, y upwards to y downwards.
#[derive(Clone, Copy, Debug)]
struct View {
    left_m: f64,
    top_m: f64,
    scale: f64,
}

impl View {
    fn point(self, p: [f64; 2]) -> [String; 2] {
        [unit((p[0] - self.left_m) * self.scale), unit((self.top_m - p[1]) * self.scale)]
    }

    fn points(self, all: &[[f64; 2]]) -> String {
        all.iter().map(|p| self.point(*p).join(",")).collect::<Vec<_>>().join(" ")
    }
}

/// A coordinate, to a tenth of a unit.
pub(super) fn unit(x: f64) -> String {
    format!("{:.1}", x + 0.0)
}

/// A bounding box.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
}

impl Bounds {
    const EMPTY: Bounds = Bounds { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    fn take(&mut self, p: [f64; 2], around_m: f64) {
        if p.iter().all(|x| x.is_finite()) {
            for (i, x) in p.into_iter().enumerate() {
                self.low[i] = self.low[i].min(x - around_m);
                self.high[i] = self.high[i].max(x + around_m);
            }
        }
    }

    fn grown(self, by_m: f64) -> Bounds {
        Bounds { low: self.low.map(|x| x - by_m), high: self.high.map(|x| x + by_m) }
    }

    fn corners(self) -> Vec<[f64; 2]> {
        let ([x0, y0], [x1, y1]) = (self.low, self.high);
        vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
    }
}

/// The map of a scene; `None` where nothing in it has a place.
pub(super) fn map(scene: &Scene, violations: &[&ViolationRecord]) -> Option<Map> {
    let scenario = scene.scenario.as_ref();
    let tracks: Vec<&Track> = scene.a.iter().chain(&scene.b).collect();
    let radius_m = scenario.map_or(0.0, |s| s.robot.footprint.circumscribed_radius_m());

    let mut content = Bounds::EMPTY;
    for point in tracks.iter().flat_map(|track| &track.points) {
        content.take([point.x_m, point.y_m], radius_m);
    }
    if let Some(scenario) = scenario {
        for corner in scenario.world.obstacles.iter().flat_map(|obstacle| &obstacle.corners_m) {
            content.take(*corner, 0.0);
        }
        for disc in &scenario.world.discs {
            content.take(disc.from_m, disc.radius_m);
            content.take(disc.to_m, disc.radius_m);
        }
    }
    if content.low.iter().chain(&content.high).any(|x| !x.is_finite()) {
        return None;
    }
    let mut room = content.grown(LOOKS_FOR_WALLS_M).corners();
    if let Some(scenario) = scenario {
        for face in &scenario.world.room {
            room = clipped(&room, face);
        }
    }
    let mut shown = content;
    for corner in &room {
        shown.take(*corner, 0.0);
    }
    let shown = shown.grown(BORDER_M);
    let size = [shown.high[0] - shown.low[0], shown.high[1] - shown.low[1]];
    let scale = (WIDTH / size[0]).min(HEIGHT / size[1]);
    let view = View { left_m: shown.low[0], top_m: shown.high[1], scale };

    let footprint = scenario.map_or(Footprint::POINT, |s| s.robot.footprint);
    Some(Map {
        width: unit(size[0] * scale),
        height: unit(size[1] * scale),
        room: view.points(&room),
        obstacles: scenario.map_or_else(Vec::new, |s| {
            s.world.obstacles.iter().map(|o| view.points(&o.corners_m)).collect()
        }),
        discs: scenario.map_or_else(Vec::new, |s| {
            let shape = |disc: &schemas::MovingDisc| DiscShape {
                from: view.point(disc.from_m),
                to: view.point(disc.to_m),
                radius: unit(disc.radius_m * scale),
            };
            s.world.discs.iter().map(shape).collect()
        }),
        task: scenario.and_then(|scenario| target_path(scenario, view)),
        a: scene.a.as_ref().and_then(|track| path(track, footprint, view)),
        b: scene.b.as_ref().and_then(|track| path(track, footprint, view)),
        metre: unit(scale),
        violations: violations.iter().filter_map(|v| cross(scene, v, view)).collect(),
    })
}

/// The part of a convex polygon that lies in a half-plane (Sutherland and Hodgman, 1974).
fn clipped(polygon: &[[f64; 2]], face: &HalfPlane) -> Vec<[f64; 2]> {
    let beyond = |p: [f64; 2]| face.normal[0] * p[0] + face.normal[1] * p[1] - face.offset_m;
    let mut kept = Vec::new();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (at_p, at_q) = (beyond(p), beyond(q));
        if at_p <= 0.0 {
            kept.push(p);
        }
        if (at_p <= 0.0) != (at_q <= 0.0) {
            let share = at_p / (at_p - at_q);
            kept.push([p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])]);
        }
    }
    kept
}

fn target_path(scenario: &Scenario, view: View) -> Option<String> {
    let task = scenario.task?;
    let end = task.target(task.until_s.min(scenario.duration_s)).0;
    let finite = task.from_m.iter().chain(&end).all(|x| x.is_finite());
    finite.then(|| view.points(&[task.from_m, end]))
}

fn path(track: &Track, footprint: Footprint, view: View) -> Option<PathShape> {
    let points: Vec<&TrackPoint> =
        track.points.iter().filter(|p| p.x_m.is_finite() && p.y_m.is_finite()).collect();
    let (first, last) = (points.first()?, points.last()?);
    let every = points.len().div_ceil(MOST_POINTS).max(1);
    let mut line = String::new();
    for (i, point) in points.iter().enumerate() {
        if i % every == 0 || i + 1 == points.len() {
            let [x, y] = view.point([point.x_m, point.y_m]);
            // Writing to a String cannot fail.
            let _ = write!(line, "{x},{y} ");
        }
    }
    let pose = Pose { x_m: last.x_m, y_m: last.y_m, theta_rad: last.theta_rad };
    let (ahead_m, aside_m) = (0.5 * footprint.length_m, 0.5 * footprint.width_m);
    let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
        .map(|(x, y)| pose.transform(x * ahead_m, y * aside_m));
    let has_body = footprint != Footprint::POINT && pose.is_finite();
    Some(PathShape {
        line: line.trim_end().to_owned(),
        start: view.point([first.x_m, first.y_m]),
        end: view.point([last.x_m, last.y_m]),
        body: if has_body { view.points(&corners) } else { String::new() },
    })
}

/// Where the robot was, to the nearest point of its thinned path, when it violated something.
fn cross(scene: &Scene, violation: &ViolationRecord, view: View) -> Option<Cross> {
    let track = if violation.arm == Arm::A { &scene.a } else { &scene.b };
    let off = |p: &TrackPoint| libm::fabs(p.t_s - violation.t_s);
    let nearest = track.as_ref()?.points.iter().min_by(|p, q| off(p).total_cmp(&off(q)))?;
    let finite = nearest.x_m.is_finite() && nearest.y_m.is_finite();
    finite.then(|| Cross {
        at: view.point([nearest.x_m, nearest.y_m]),
        arm: violation.arm.letter(),
        label: format!(
            "{} {} at {}",
            violation.arm.letter(),
            violation.kind.words(),
            super::seconds(violation.t_s)
        ),
    })
}
