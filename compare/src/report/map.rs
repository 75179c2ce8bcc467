//! A log seen from above: the room, what stands and walks in it, both paths and who drove on them.

use schemas::{Footprint, Pose, Scenario};
use serde::Serialize;

use crate::comparison::{Arm, Scene, ViolationRecord};
use crate::drawing::{Bounds, Plan, path, unit};
use crate::metrics::{Track, TrackPoint};

/// Width and height that a map is fitted into, SVG units.
const MOST: [f64; 2] = [620.0, 440.0];

/// Half the length of the arrow that stands for a point robot, SVG units.
const POINT_ROBOT: f64 = 7.0;

/// A map, ready to be drawn.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Map {
    width: String,
    height: String,
    /// What a script needs to place things: x of the left edge and y of the upper one in metres, and
    /// units per metre.
    place: String,
    /// Corners of the free space inside the room.
    room: String,
    obstacles: Vec<String>,
    /// Where discs walk: from, to, and radius.
    discs: Vec<DiscShape>,
    /// Path of the task's target.
    task: Option<String>,
    /// Outline of the body about its centre, and the line that shows its heading.
    body: String,
    nose: String,
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
    /// What a script needs to move it: from, to (metres), speed, start, and 1 for to and fro.
    walk: String,
}

#[derive(Clone, Debug, Serialize)]
struct PathShape {
    line: String,
    /// The parts on which the feedback law drove.
    feedback: String,
    end: [String; 2],
    /// The body at the end; empty for a point robot.
    end_body: String,
}

/// A violation's place.
#[derive(Clone, Debug, Serialize)]
struct Cross {
    at: [String; 2],
    arm: &'static str,
    label: String,
}

/// The map of a scene; `None` where nothing in it has a place. Paths go through at most `points`
/// points.
pub(super) fn map(scene: &Scene, violations: &[&ViolationRecord], points: usize) -> Option<Map> {
    let scenario = scene.scenario.as_ref();
    let footprint = scenario.map_or(Footprint::POINT, |s| s.robot.footprint);
    let mut content = Bounds::EMPTY;
    for point in scene.a.iter().chain(&scene.b).flat_map(|track| &track.points) {
        content.take([point.x_m, point.y_m], footprint.circumscribed_radius_m());
    }
    let plan = Plan::of(scenario, content, MOST)?;
    let shape = |disc: &schemas::MovingDisc| {
        let ([x0, y0], [x1, y1]) = (disc.from_m, disc.to_m);
        let to_and_fro = u8::from(disc.to_and_fro);
        DiscShape {
            from: plan.point(disc.from_m),
            to: plan.point(disc.to_m),
            radius: unit(disc.radius_m * plan.scale),
            walk: format!("{x0},{y0},{x1},{y1},{},{},{to_and_fro}", disc.speed_mps, disc.start_s),
        }
    };
    let things = |of: fn(&Plan, &Scenario) -> Vec<String>| {
        scenario.map_or_else(Vec::new, |scenario| of(&plan, scenario))
    };
    let (body, nose) = body(footprint, plan.scale);
    let [left_m, top_m] = plan.corner_m();
    Some(Map {
        width: unit(plan.size[0]),
        height: unit(plan.size[1]),
        place: format!("{left_m},{top_m},{}", plan.scale),
        room: plan.points(&plan.room_m),
        obstacles: things(|plan, scenario| {
            scenario.world.obstacles.iter().map(|o| plan.points(&o.corners_m)).collect()
        }),
        discs: scenario.map_or_else(Vec::new, |s| s.world.discs.iter().map(shape).collect()),
        task: scenario.and_then(|scenario| target_path(scenario, &plan)),
        body,
        nose,
        a: scene.a.as_ref().and_then(|track| way(track, footprint, &plan, points)),
        b: scene.b.as_ref().and_then(|track| way(track, footprint, &plan, points)),
        metre: unit(plan.scale),
        violations: violations.iter().filter_map(|v| cross(scene, v, &plan)).collect(),
    })
}

/// A robot about its own centre, heading along +x, in units; y downwards.
fn body(footprint: Footprint, scale: f64) -> (String, String) {
    if footprint == Footprint::POINT {
        let (long, short) = (unit(POINT_ROBOT), unit(0.7 * POINT_ROBOT));
        return (format!("{long},0 -{short},-{short} -{short},{short}"), "M0 0".to_owned());
    }
    let [ahead, aside] = [footprint.length_m, footprint.width_m].map(|m| unit(0.5 * m * scale));
    let outline = format!("{ahead},{aside} -{ahead},{aside} -{ahead},-{aside} {ahead},-{aside}");
    (outline, format!("M0 0L{ahead} 0"))
}

fn target_path(scenario: &Scenario, plan: &Plan) -> Option<String> {
    let task = scenario.task?;
    let end = task.target(task.until_s.min(scenario.duration_s)).0;
    let finite = task.from_m.iter().chain(&end).all(|x| x.is_finite());
    finite.then(|| plan.points(&[task.from_m, end]))
}

fn way(track: &Track, footprint: Footprint, plan: &Plan, points: usize) -> Option<PathShape> {
    let known = |p: &&&TrackPoint| p.x_m.is_finite() && p.y_m.is_finite();
    let thinned = track.thinned(points);
    let known: Vec<&TrackPoint> = thinned.iter().filter(known).copied().collect();
    let last = known.last()?;
    let on_plan = |point: &TrackPoint| plan.at([point.x_m, point.y_m]);
    let pose = Pose { x_m: last.x_m, y_m: last.y_m, theta_rad: last.theta_rad };
    let nowhere = [f64::NAN; 2];
    Some(PathShape {
        line: path(known.iter().map(|point| on_plan(point))),
        feedback: path(
            known.iter().map(|point| if point.k == 0.0 { on_plan(point) } else { nowhere }),
        ),
        end: plan.point([last.x_m, last.y_m]),
        end_body: plan.body(footprint, &pose).unwrap_or_default(),
    })
}

/// Where the robot was, to the nearest point of its thinned path, when it violated something.
fn cross(scene: &Scene, violation: &ViolationRecord, plan: &Plan) -> Option<Cross> {
    let track = if violation.arm == Arm::A { &scene.a } else { &scene.b };
    let off = |p: &TrackPoint| libm::fabs(p.t_s - violation.t_s);
    let nearest = track.as_ref()?.points.iter().min_by(|p, q| off(p).total_cmp(&off(q)))?;
    let finite = nearest.x_m.is_finite() && nearest.y_m.is_finite();
    finite.then(|| Cross {
        at: plan.point([nearest.x_m, nearest.y_m]),
        arm: violation.arm.letter(),
        label: format!(
            "{} {} at {}",
            violation.arm.letter(),
            violation.kind.words(),
            super::seconds(violation.t_s)
        ),
    })
}
