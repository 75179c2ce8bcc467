//! Where the robot went, seen from above.

use schemas::Footprint;
use serde::Serialize;

use super::recording::{Point, Recording};
use crate::drawing::{Bounds, Plan, path, unit};

/// Width and height that a map is fitted into, units.
const MOST: [f64; 2] = [720.0, 380.0];

/// How often the body is drawn on its way, at most.
const BODIES: usize = 12;

/// A body that has moved less than this since it was drawn last is left out, units.
const CLOSE: f64 = 14.0;

/// A map, ready to be drawn.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Map {
    width: String,
    pub(super) height: String,
    room: String,
    obstacles: Vec<String>,
    walks: Vec<Walk>,
    /// Path of the task's target.
    task: Option<String>,
    /// The whole way, and the parts on which the feedback law drove.
    way: String,
    feedback: Vec<String>,
    bodies: Vec<Body>,
    metre: String,
}

/// A moving disc.
#[derive(Clone, Debug, Serialize)]
struct Walk {
    way: String,
    radius: String,
    /// Where it is whenever the body is drawn.
    at: Vec<[String; 2]>,
}

/// The robot at one instant.
#[derive(Clone, Debug, Serialize)]
struct Body {
    at: [String; 2],
    /// From its centre in the direction of its heading.
    nose: [String; 2],
    outline: Option<String>,
    label: String,
}

/// The map of a run; `None` where nothing has a place. And its height, units.
pub(super) fn map(run: &Recording) -> Option<(Map, f64)> {
    let scenario = &run.header.scenario;
    let footprint = scenario.robot.footprint;
    let mut content = Bounds::EMPTY;
    for point in &run.points {
        content.take(point.pose.position_m(), footprint.circumscribed_radius_m());
    }
    let plan = Plan::of(Some(scenario), content, MOST)?;
    let on_plan = |point: &Point| plan.at(point.pose.position_m());
    let feedback = run
        .feedback_s()
        .iter()
        .map(|[from_s, until_s]| {
            let within = |point: &&Point| point.t_s >= *from_s && point.t_s <= *until_s;
            path(run.points.iter().filter(within).map(on_plan))
        })
        .filter(|part| !part.is_empty())
        .collect();
    let times = instants(run.end_s);
    let mut drawn_at: Option<[f64; 2]> = None;
    let mut bodies = Vec::new();
    for t_s in &times {
        let Some(point) = nearest(&run.points, *t_s) else { continue };
        let [x, y] = on_plan(point);
        if drawn_at.is_none_or(|[from_x, from_y]| libm::hypot(x - from_x, y - from_y) >= CLOSE) {
            bodies.extend(body(&plan, footprint, point, *t_s));
            drawn_at = Some([x, y]);
        }
    }
    let walks = scenario
        .world
        .discs
        .iter()
        .map(|disc| Walk {
            way: plan.points(&[disc.from_m, disc.to_m]),
            radius: unit(disc.radius_m * plan.scale),
            at: times.iter().map(|t_s| plan.point(disc.at(*t_s).centre_m)).collect(),
        })
        .collect();
    let task = scenario.task.and_then(|task| {
        let end = task.target(task.until_s.min(run.end_s)).0;
        let finite = task.from_m.iter().chain(&end).all(|x| x.is_finite());
        finite.then(|| plan.points(&[task.from_m, end]))
    });
    let height = plan.size[1];
    let map = Map {
        width: unit(plan.size[0]),
        height: unit(height),
        room: plan.points(&plan.room_m),
        obstacles: scenario.world.obstacles.iter().map(|o| plan.points(&o.corners_m)).collect(),
        walks,
        task,
        way: path(run.points.iter().map(on_plan)),
        feedback,
        bodies,
        metre: unit(plan.scale),
    };
    Some((map, height))
}

/// Round instants at which the body is drawn.
fn instants(end_s: f64) -> Vec<f64> {
    let step_s = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 60.0]
        .into_iter()
        .find(|step_s| end_s / step_s <= BODIES as f64)
        .unwrap_or(end_s / BODIES as f64);
    (0..=(end_s / step_s) as usize).map(|i| i as f64 * step_s).collect()
}

fn nearest(points: &[Point], t_s: f64) -> Option<&Point> {
    let off = |point: &&Point| libm::fabs(point.t_s - t_s);
    points.iter().min_by(|a, b| off(a).total_cmp(&off(b)))
}

fn body(plan: &Plan, footprint: Footprint, point: &Point, t_s: f64) -> Option<Body> {
    let pose = &point.pose;
    pose.is_finite().then(|| {
        let ahead_m = if footprint == Footprint::POINT { 0.12 } else { 0.5 * footprint.length_m };
        Body {
            at: plan.point(pose.position_m()),
            nose: plan.point(pose.transform(ahead_m, 0.0)),
            outline: plan.body(footprint, pose),
            label: format!("{t_s}"),
        }
    })
}
