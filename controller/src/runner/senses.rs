//! What the controller knows about its own motion and about what is around it, from either sensor
//! suite.
//!
//! In: samples. Out: an estimate of pose and speeds, and rays. With exact rays the estimate is the
//! exact pose and rays go into the attached world; with sonars odometry and the map of echoes take
//! their place.

use schemas::{Disc, ExactPose, Footprint, Pose, Sample, Scenario, SensorSuite, Time, World};

use crate::digest::Digest;
use crate::estimation::{Estimate, Odometry, Report};
use crate::params::Params;
use crate::perception::echo_map::{EchoMap, EchoMapSettings, LimitingEcho};
use crate::safety::Near;
use crate::travel::{DBody, LawBody};

/// One sensor suite's view.
#[derive(Clone, Debug)]
pub(super) enum Senses {
    Exact(Box<Exact>),
    Sonar(Box<Sonar>),
}

#[derive(Clone, Debug)]
pub(super) struct Exact {
    world: World,
    footprint: Footprint,
    inflation_m: f64,
    latest: Option<ExactPose>,
    /// Seconds since the start of the session, as of the step in hand.
    t_s: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Sonar {
    footprint: Footprint,
    odometry: Odometry,
    map: EchoMap,
}

impl Senses {
    pub(super) fn new(scenario: &Scenario, suite: SensorSuite, params: &Params) -> Senses {
        let footprint = scenario.robot.footprint;
        let inflation_m = footprint.circumscribed_radius_m();
        match suite {
            SensorSuite::Exact => Senses::Exact(Box::new(Exact {
                world: scenario.world.clone(),
                footprint,
                inflation_m,
                latest: None,
                t_s: 0.0,
            })),
            SensorSuite::Sonar => Senses::Sonar(Box::new(Sonar {
                footprint,
                odometry: Odometry::new(scenario.start.pose, scenario.robot.track_m),
                map: EchoMap::new(EchoMapSettings {
                    inflation_m,
                    v_disc_mps: params.v_disc_mps,
                    lease_s: params.sonar_lease_s,
                }),
            })),
        }
    }

    pub(super) fn observe(&mut self, sample: &Sample) {
        match (self, sample) {
            (Senses::Exact(exact), Sample::Exact(pose)) => exact.latest = Some(*pose),
            (Senses::Sonar(sonar), Sample::Sonar(scan)) => sonar.map.observe(scan, &sonar.odometry),
            (Senses::Sonar(sonar), Sample::Imu(imu)) => sonar.odometry.imu(imu),
            (Senses::Sonar(sonar), Sample::Encoders(encoders)) => sonar.odometry.encoders(encoders),
            // The joystick is no sense; and neither suite looks at what belongs to the other.
            _ => {}
        }
    }

    pub(super) fn estimate(&self) -> Estimate {
        match self {
            Senses::Exact(exact) => {
                let unknown = Pose { x_m: f64::NAN, y_m: f64::NAN, theta_rad: f64::NAN };
                exact.latest.map_or(
                    Estimate {
                        pose: unknown,
                        v_mps: 0.0,
                        omega_radps: 0.0,
                        reached: None,
                        stamp: None,
                    },
                    |exact| Estimate {
                        pose: exact.pose,
                        v_mps: exact.v_mps,
                        omega_radps: exact.omega_radps,
                        reached: Some(exact.stamp),
                        stamp: Some(exact.stamp),
                    },
                )
            }
            Senses::Sonar(sonar) => sonar.odometry.estimate(),
        }
    }

    /// What the estimator says about itself at `now`; nothing where the pose is exact.
    pub(super) fn report(&self, now: Time) -> Option<Report> {
        match self {
            Senses::Exact(_) => None,
            Senses::Sonar(sonar) => Some(sonar.odometry.report(now)),
        }
    }

    /// Gets ready for rays from `about`, once in each step.
    pub(super) fn advance(&mut self, now: Time, t_s: f64, about: &Pose) {
        match self {
            Senses::Exact(exact) => exact.t_s = t_s,
            Senses::Sonar(sonar) => sonar.map.advance(now, &sonar.odometry, about),
        }
    }

    /// Free travel of the body's circle along a world angle, for the law, metres; NaN if unknown.
    pub(super) fn law_ray_m(&self, from: &Pose, angle_rad: f64) -> f64 {
        match self {
            Senses::Exact(exact) => exact.ray_m(from, angle_rad),
            Senses::Sonar(sonar) => sonar.map.law_ray_m(from, angle_rad),
        }
    }

    /// Free travel along a world angle of what the law's distances are about, metres; NaN if unknown.
    pub(super) fn law_m(&self, body: LawBody, from: &Pose, angle_rad: f64) -> f64 {
        match body {
            LawBody::Disc => self.law_ray_m(from, angle_rad),
            LawBody::Lane => self.travel_m(DBody::Footprint, from, angle_rad) - self.bulge_m(),
        }
    }

    /// The echo that ends [`Senses::law_m`], where one does.
    pub(super) fn law_end(
        &self,
        body: LawBody,
        from: &Pose,
        angle_rad: f64,
    ) -> Option<LimitingEcho> {
        match body {
            LawBody::Disc => self.law_limit(from, angle_rad),
            LawBody::Lane => {
                let end = self.travel_limit(DBody::Footprint, from, angle_rad)?;
                Some(LimitingEcho { free_m: end.free_m - self.bulge_m(), ..end })
            }
        }
    }

    /// How far the circle about the body reaches beyond its front, metres.
    fn bulge_m(&self) -> f64 {
        let footprint = match self {
            Senses::Exact(exact) => exact.footprint,
            Senses::Sonar(sonar) => sonar.footprint,
        };
        footprint.circumscribed_radius_m() - 0.5 * footprint.length_m
    }

    /// Free travel along a world angle of what D is about, metres; NaN if unknown.
    pub(super) fn travel_m(&self, body: DBody, from: &Pose, angle_rad: f64) -> f64 {
        match (body, self) {
            (DBody::Disc, _) => self.law_ray_m(from, angle_rad),
            (DBody::Footprint, Senses::Exact(exact)) => {
                let Exact { world, footprint, t_s, .. } = &**exact;
                world.travel_m(footprint, from.position_m(), angle_rad, *t_s)
            }
            (DBody::Footprint, Senses::Sonar(sonar)) => {
                sonar.map.law_travel_m(&sonar.footprint, from, angle_rad)
            }
        }
    }

    /// The echo that ends [`Senses::travel_m`], where one does.
    pub(super) fn travel_limit(
        &self,
        body: DBody,
        from: &Pose,
        angle_rad: f64,
    ) -> Option<LimitingEcho> {
        match (body, self) {
            (DBody::Disc, _) => self.law_limit(from, angle_rad),
            (DBody::Footprint, Senses::Exact(_)) => None,
            (DBody::Footprint, Senses::Sonar(sonar)) => {
                let Sonar { footprint, odometry, map } = &**sonar;
                map.law_travel_limit(footprint, odometry, from, angle_rad)
            }
        }
    }

    /// Free travel of the body's circle for the safety layer, which trusts less.
    pub(super) fn safety_ray_m(&self, from: &Pose, angle_rad: f64) -> f64 {
        match self {
            Senses::Exact(exact) => exact.ray_m(from, angle_rad),
            Senses::Sonar(sonar) => sonar.map.safety_ray_m(from, angle_rad),
        }
    }

    /// The echo that ends [`Senses::law_ray_m`], where one does.
    pub(super) fn law_limit(&self, from: &Pose, angle_rad: f64) -> Option<LimitingEcho> {
        match self {
            Senses::Exact(_) => None,
            Senses::Sonar(sonar) => sonar.map.law_limit(&sonar.odometry, from, angle_rad),
        }
    }

    /// The echo that ends [`Senses::safety_ray_m`], where one does.
    pub(super) fn safety_limit(&self, from: &Pose, angle_rad: f64) -> Option<LimitingEcho> {
        match self {
            Senses::Exact(_) => None,
            Senses::Sonar(sonar) => sonar.map.safety_limit(&sonar.odometry, from, angle_rad),
        }
    }

    /// A bound on the safety layer's rays from `from`, metres: none is shorter; −∞ where that is not known
    /// beforehand.
    pub(super) fn safety_least_m(&self, from: &Pose) -> f64 {
        match self {
            Senses::Exact(_) => f64::NEG_INFINITY,
            Senses::Sonar(sonar) => sonar.map.safety_least_m(from),
        }
    }

    /// What [`Senses::gather`] can be asked to fill.
    pub(super) fn room_for_near(scenario: &Scenario, suite: SensorSuite) -> Near {
        let footprint = scenario.robot.footprint;
        match suite {
            SensorSuite::Exact => {
                let world = &scenario.world;
                let most = world.room.len() + world.discs.len() + world.paths.len();
                Near::new(footprint, &world.obstacles, most)
            }
            SensorSuite::Sonar => Near::new(footprint, &[], EchoMap::MOST_POINTS),
        }
    }

    /// Whether the surroundings are looked at one direction after the other.
    pub(super) fn swept_in_turn(&self) -> bool {
        matches!(self, Senses::Sonar(_))
    }

    /// Adds what is near; to be asked after [`Senses::advance`]. What may move does so at no more
    /// than `v_disc_mps`.
    pub(super) fn gather(&self, near: &mut Near, v_disc_mps: f64) {
        match self {
            Senses::Exact(exact) => {
                for wall in &exact.world.room {
                    near.wall(wall);
                }
                near.obstacles();
                for moving in &exact.world.discs {
                    // How fast a thing is, is known here as well.
                    let speed_mps = moving.speed_mps.min(v_disc_mps);
                    near.disc(moving.at(exact.t_s), speed_mps, 0.0);
                }
                for path in &exact.world.paths {
                    if let Some(disc) = path.at(exact.t_s) {
                        near.disc(disc, path.speed_mps().min(v_disc_mps), 0.0);
                    }
                }
            }
            Senses::Sonar(sonar) => {
                near.looked(sonar.map.knows_the_ways());
                for (disc, may_move) in sonar.map.near_points() {
                    let speed_mps = if may_move { v_disc_mps } else { 0.0 };
                    near.disc(disc, speed_mps, disc.radius_m);
                }
                sonar.map.walls_between(|centre_m| {
                    near.disc(Disc { centre_m, radius_m: 0.0 }, 0.0, 0.0);
                });
            }
        }
    }

    /// World angle from the robot straight into the nearest face, where known.
    pub(super) fn face_direction_rad(&self, from: &Pose) -> Option<f64> {
        match self {
            Senses::Exact(exact) => exact
                .world
                .nearest_face(from.position_m(), exact.t_s)
                .map(|face| face.direction_rad)
                .filter(|angle_rad| angle_rad.is_finite()),
            Senses::Sonar(sonar) => sonar.map.face_direction_rad(from),
        }
    }

    /// How many sonars' cones are unknown; `None` without sonars.
    pub(super) fn sonars_unknown(&self) -> Option<i32> {
        match self {
            Senses::Exact(_) => None,
            // There are sixteen.
            Senses::Sonar(sonar) => i32::try_from(sonar.map.unknown_cones()).ok(),
        }
    }

    /// Whether no distance sensor can be believed.
    pub(super) fn dead(&self) -> bool {
        match self {
            Senses::Exact(_) => false,
            Senses::Sonar(sonar) => sonar.map.dead(),
        }
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        match self {
            Senses::Exact(exact) => {
                if let Some(latest) = &exact.latest {
                    digest.time(latest.stamp, start);
                    digest.pose(&latest.pose);
                    digest.numbers(&[latest.v_mps, latest.omega_radps]);
                }
            }
            Senses::Sonar(sonar) => {
                sonar.odometry.fold(digest, start);
                sonar.map.fold(digest, start);
            }
        }
    }
}

impl Exact {
    fn ray_m(&self, from: &Pose, angle_rad: f64) -> f64 {
        self.world.ray_m(from.position_m(), angle_rad, self.inflation_m, self.t_s)
    }
}
