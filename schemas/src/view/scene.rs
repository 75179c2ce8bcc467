//! `/scene`: room, obstacles, moving discs, robot, danger, sonar cones, target and distances.
//!
//! Every update holds every entity, also those with nothing to show just now: a viewer that seeks
//! restores only the last update, and an empty entity is what takes an old one away.

use foxglove::messages::line_primitive::Type::{LineList, LineLoop, LineStrip};
use foxglove::messages::{
    ArrowPrimitive, Color, CubePrimitive, CylinderPrimitive, LinePrimitive, SceneEntity,
    SceneUpdate, TextPrimitive, TriangleListPrimitive, Vector3,
};

use super::Seen;
use super::frames::{Frames, WORLD};
use super::journal::Driving;
use super::primitives::{
    arrow, colour, cylinder, identity, lines, point, polygon, pose, timestamp,
};
use super::room::{Segment, walls};
use crate::log::Arm;
use crate::{Disc, Footprint, Pose, SONAR_REACH_M, SONARS, Scenario, SonarEcho, Step, Time};

/// Age at which a reading has faded away, seconds: three sweeps of all sonars.
const FADED_S: f64 = 1.0;
/// How high the robot's body is drawn, metres.
const BODY_HEIGHT_M: f64 = 0.28;
/// Radius at which a point robot is drawn, metres.
const POINT_RADIUS_M: f64 = 0.06;
/// How high the gauge of danger stands, metres: so much is danger 1.
const GAUGE_HEIGHT_M: f64 = 0.8;
/// How thick it is, metres.
const GAUGE_WIDTH_M: f64 = 0.08;

/// What stays the same over a session.
#[derive(Debug)]
pub(super) struct Stage {
    walls: Vec<Segment>,
    obstacles: Vec<Vec<[f64; 2]>>,
    footprint: Footprint,
    /// Half the opening of a sonar's cone.
    half_cone_rad: f64,
    frames: Frames,
    arm: Option<Arm>,
}

impl Stage {
    pub(super) fn new(scenario: &Scenario, arm: Option<Arm>) -> Stage {
        let obstacles = scenario.world.obstacles.iter();
        Stage {
            walls: walls(scenario),
            obstacles: obstacles.map(|obstacle| obstacle.corners_m.clone()).collect(),
            footprint: scenario.robot.footprint,
            half_cone_rad: half_cone_deg(scenario).to_radians(),
            frames: Frames::of(arm),
            arm,
        }
    }

    /// Everything there is to see at `at`.
    pub(super) fn scene(&self, at: Time, seen: &Seen) -> SceneUpdate {
        let odom = self.frames.odom;
        let mut entities = vec![
            self.room(),
            discs(seen.truth.as_ref().map_or(&[], |truth| &truth.discs)),
            self.robot(seen),
            self.estimate(seen),
            self.danger(seen),
            self.sonar(at, &seen.sonar),
            seen.step.as_deref().map_or_else(|| entity(odom, "target"), |step| target(step, odom)),
            seen.step
                .as_deref()
                .map_or_else(|| entity(odom, "distances"), |step| distances(step, odom)),
        ];
        for entity in &mut entities {
            entity.timestamp = Some(timestamp(at));
        }
        SceneUpdate { deletions: Vec::new(), entities }
    }

    fn room(&self) -> SceneEntity {
        let ends = self.walls.iter().flatten().map(|end| point(*end, 0.0)).collect();
        let mut outlines = vec![lines(LineList, ends, 0.05, colour::SOLID)];
        let mut fillings = Vec::new();
        for corners in &self.obstacles {
            let corners_at_floor = corners.iter().map(|corner| point(*corner, 0.0)).collect();
            outlines.push(lines(LineLoop, corners_at_floor, 0.05, colour::SOLID));
            fillings.push(polygon(corners, 0.0, colour::faded(colour::SOLID, 0.5)));
        }
        SceneEntity { lines: outlines, triangles: fillings, ..entity(WORLD, "room") }
    }

    fn robot(&self, seen: &Seen) -> SceneEntity {
        let robot = entity(self.frames.base, "robot");
        if seen.robot().is_none() {
            return robot;
        }
        let robot = SceneEntity { texts: self.label(), ..robot };
        let colour = colour::faded(driver_colour(seen.step.as_deref()), self.strength());
        let nose = Pose { x_m: 0.0, y_m: 0.0, theta_rad: 0.0 };
        let arrows = vec![arrow(&nose, BODY_HEIGHT_M, 0.5 * self.footprint.length_m + 0.2, colour)];
        if self.is_point() {
            let body = cylinder([0.0, 0.0], POINT_RADIUS_M, BODY_HEIGHT_M, colour);
            return SceneEntity { cylinders: vec![body], arrows, ..robot };
        }
        let body = CubePrimitive {
            pose: Some(pose(&nose, 0.5 * BODY_HEIGHT_M)),
            size: Some(Vector3 {
                x: self.footprint.length_m,
                y: self.footprint.width_m,
                z: BODY_HEIGHT_M,
            }),
            color: Some(colour::faded(colour, 0.7)),
        };
        SceneEntity { cubes: vec![body], arrows, ..robot }
    }

    /// The body where the robot believes to be, as an outline; nothing where the truth is not known
    /// and the body itself stands there.
    fn estimate(&self, seen: &Seen) -> SceneEntity {
        let estimate = entity(self.frames.estimate, "estimate");
        if seen.truth().is_none() || seen.estimate().is_none() {
            return estimate;
        }
        let (half_length, half_width) = if self.is_point() {
            (POINT_RADIUS_M, POINT_RADIUS_M)
        } else {
            (0.5 * self.footprint.length_m, 0.5 * self.footprint.width_m)
        };
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let outline = corners.map(|(x, y)| point([x * half_length, y * half_width], 0.01));
        let outline = lines(LineLoop, outline.to_vec(), 0.02, colour::UNKNOWN);
        SceneEntity { lines: vec![outline], ..estimate }
    }

    /// How near danger is, the graded signal to the person, as a bar that grows behind the robot in
    /// an outline as high as danger 1; nothing where it is not known.
    fn danger(&self, seen: &Seen) -> SceneEntity {
        let gauge = entity(self.frames.base, "danger");
        let step = seen.step.as_deref();
        let danger = step.map_or(f64::NAN, |step| step.danger.clamp(0.0, 1.0));
        if seen.robot().is_none() || !danger.is_finite() {
            return gauge;
        }
        let place = [-0.5 * self.footprint.length_m - GAUGE_WIDTH_M, 0.0];
        let ends = [point(place, 0.0), point(place, GAUGE_HEIGHT_M)];
        let outline = lines(LineStrip, ends.to_vec(), 0.01, colour::UNKNOWN);
        let height_m = danger * GAUGE_HEIGHT_M;
        let foot = Pose { x_m: place[0], y_m: place[1], theta_rad: 0.0 };
        let bar = CubePrimitive {
            pose: Some(pose(&foot, 0.5 * height_m)),
            size: Some(Vector3 { x: GAUGE_WIDTH_M, y: GAUGE_WIDTH_M, z: height_m }),
            color: Some(colour::faded(driver_colour(step), self.strength())),
        };
        SceneEntity { lines: vec![outline], cubes: vec![bar], ..gauge }
    }

    /// One triangle per sonar, from the sensor to where it heard something, the fainter the older.
    fn sonar(&self, at: Time, echoes: &[Option<SonarEcho>; SONARS.len()]) -> SceneEntity {
        let cones = echoes.iter().zip(SONARS).filter_map(|(echo, mount)| {
            let echo = echo.as_ref()?;
            let freshness = 1.0 - at.seconds_since(echo.fired) / FADED_S;
            let (reach_m, colour) = if echo.echo {
                (echo.range_m, colour::ECHO)
            } else {
                (SONAR_REACH_M, colour::SILENCE)
            };
            if !(freshness > 0.0 && reach_m.is_finite()) {
                return None;
            }
            let at_face =
                Pose { x_m: mount.x_m, y_m: mount.y_m, theta_rad: mount.bearing_deg.to_radians() };
            let ends = [-self.half_cone_rad, self.half_cone_rad].map(|off| {
                let (sin, cos) = libm::sincos(off);
                at_face.transform(reach_m * cos, reach_m * sin)
            });
            // Silence is drawn fainter than an echo, a reading from the future as a fresh one.
            let full = if echo.echo { 0.5 } else { 0.15 };
            let strength = freshness.min(1.0) * full * self.strength();
            let corners = [at_face.position_m(), ends[0], ends[1]];
            Some(TriangleListPrimitive {
                pose: Some(identity()),
                points: corners.map(|corner| point(corner, 0.15)).to_vec(),
                color: Some(colour::faded(colour, strength)),
                ..TriangleListPrimitive::default()
            })
        });
        SceneEntity { triangles: cones.collect(), ..entity(self.frames.base, "sonar") }
    }

    /// Of two robots the first is drawn fainter: the second is the one in question.
    fn strength(&self) -> f64 {
        if self.arm == Some(Arm::A) { 0.4 } else { 1.0 }
    }

    /// Which robot it is, where there are two.
    fn label(&self) -> Vec<TextPrimitive> {
        let label = self.arm.map(|arm| TextPrimitive {
            pose: Some(pose(&Pose::default(), BODY_HEIGHT_M + 0.1)),
            billboard: true,
            font_size: 0.3,
            scale_invariant: false,
            color: Some(colour::SOLID),
            text: arm.name().to_owned(),
        });
        label.into_iter().collect()
    }

    fn is_point(&self) -> bool {
        self.footprint.length_m <= 0.0 || self.footprint.width_m <= 0.0
    }
}

/// As wide as the session's sonars hear; where their noise is not modelled, as the data sheet says.
fn half_cone_deg(scenario: &Scenario) -> f64 {
    scenario.noise.sonar.as_ref().map_or(10.0, |noise| noise.half_cone_deg)
}

fn entity(frame: &str, id: &str) -> SceneEntity {
    SceneEntity {
        frame_id: frame.to_owned(),
        id: id.to_owned(),
        frame_locked: true,
        ..SceneEntity::default()
    }
}

fn driver_colour(step: Option<&Step>) -> Color {
    match step.map(|step| Driving::of(step.k)) {
        Some(Driving::Human) => colour::HUMAN,
        Some(Driving::Feedback) => colour::FEEDBACK,
        Some(Driving::Unknown) | None => colour::UNKNOWN,
    }
}

fn discs(discs: &[Disc]) -> SceneEntity {
    let finite = discs.iter().filter(|disc| finite(disc.centre_m) && disc.radius_m.is_finite());
    let cylinders: Vec<CylinderPrimitive> =
        finite.map(|disc| cylinder(disc.centre_m, disc.radius_m, 1.2, colour::PERSON)).collect();
    SceneEntity { cylinders, ..entity(WORLD, "discs") }
}

/// The target `p_d`, its velocity, and the displacement from the robot's estimate to it.
fn target(step: &Step, odom: &str) -> SceneEntity {
    let target = entity(odom, "target");
    let place = [step.target_x_m, step.target_y_m];
    if !finite(place) {
        return target;
    }
    let disc = cylinder(place, 0.08, 0.04, colour::TARGET);
    let mut displacement: Vec<LinePrimitive> = Vec::new();
    if step.pose.is_finite() {
        let ends = [step.pose.position_m(), place].map(|end| point(end, 0.02));
        displacement.push(lines(LineStrip, ends.to_vec(), 0.02, colour::TARGET));
    }
    let mut velocity: Vec<ArrowPrimitive> = Vec::new();
    let speed_mps = libm::hypot(step.target_vx_mps, step.target_vy_mps);
    if speed_mps.is_finite() && speed_mps > 0.0 {
        let heading = libm::atan2(step.target_vy_mps, step.target_vx_mps);
        let from = Pose { x_m: place[0], y_m: place[1], theta_rad: heading };
        // As long as the way of one second.
        velocity.push(arrow(&from, 0.02, speed_mps, colour::TARGET));
    }
    SceneEntity { cylinders: vec![disc], lines: displacement, arrows: velocity, ..target }
}

/// d1 along e1, d2l to its left and d2r to its right, from the robot's estimate.
fn distances(step: &Step, odom: &str) -> SceneEntity {
    let distances = entity(odom, "distances");
    if !(step.pose.is_finite() && step.psi_rad.is_finite()) {
        return distances;
    }
    let frame = Pose { theta_rad: step.psi_rad, ..step.pose };
    let rays = [(step.d1_m, (1.0, 0.0)), (step.d2l_m, (0.0, 1.0)), (step.d2r_m, (0.0, -1.0))];
    let rays = rays.iter().filter(|(distance_m, _)| distance_m.is_finite());
    let ends = rays.flat_map(|(distance_m, (forward, left))| {
        let end = frame.transform(distance_m * forward, distance_m * left);
        [point(step.pose.position_m(), 0.03), point(end, 0.03)]
    });
    let ends: Vec<_> = ends.collect();
    SceneEntity { lines: vec![lines(LineList, ends, 0.015, colour::DISTANCE)], ..distances }
}

fn finite(place: [f64; 2]) -> bool {
    place.iter().all(|x| x.is_finite())
}
