//! What ends a ray, told: the echo with its sonar, or the thing of the world.

use controller::Ray;
use schemas::{Pose, SONARS, SonarEcho};

use super::account::{EchoMet, RayTold};
use super::moment::Moment;
use super::thing;

/// Tells rays of one moment.
pub struct Teller<'a> {
    pub moment: &'a Moment,
    /// Where they start: the pose at which the command takes effect.
    pub from: Pose,
}

impl Teller<'_> {
    /// What a ray says.
    pub fn tell(&self, ray: &Ray) -> RayTold {
        let Moment { header, step, truth, .. } = self.moment;
        let (scenario, start) = (&header.scenario, header.run.start);
        let exact = header.run.sensors == "exact";
        let radius_m = scenario.robot.footprint.circumscribed_radius_m();
        let ends_at = |from_m: [f64; 2], angle_rad: f64, t_s: f64| {
            thing::nearest(&scenario.world, t_s, |alone| {
                alone.ray_m(from_m, angle_rad, radius_m, t_s)
            })
        };
        let thing = exact
            .then(|| {
                let t_s = step.stamp.seconds_since(start);
                ends_at(self.from.position_m(), ray.angle_rad, t_s)
            })
            .flatten();
        let off_heading_rad = ray.angle_rad - self.from.theta_rad;
        let really = truth.as_ref().filter(|_| !exact).and_then(|truth| {
            // The same direction as seen from the robot: its estimate of the heading may be off.
            let angle_rad = truth.pose.theta_rad + ray.angle_rad - step.pose.theta_rad;
            ends_at(truth.pose.position_m(), angle_rad, truth.stamp.seconds_since(start))
        });
        let (truth_thing, truth_free_m) = really.unzip();
        let turned = off_heading_rad.rem_euclid(std::f64::consts::TAU).to_degrees();
        RayTold {
            off_heading_deg: if turned > 180.0 { turned - 360.0 } else { turned },
            free_m: ray.free_m,
            known: !ray.free_m.is_nan(),
            echo: ray.echo.as_ref().map(|echo| {
                let heard = self.heard(|heard| {
                    heard.fired == echo.fired
                        && (heard.range_m == echo.range_m || echo.range_m == 0.0)
                });
                EchoMet {
                    sonar: heard.map(|heard| heard.id),
                    bearing_deg: heard
                        .and_then(|heard| SONARS.get(usize::from(heard.id)))
                        .map(|mount| mount.bearing_deg),
                    range_m: heard.map_or(echo.range_m, |heard| heard.range_m),
                    heard_s_before: step.stamp.seconds_since(echo.fired),
                    at_m: echo.at_m,
                    nearer_by_m: echo.nearer_by_m,
                    confirmed: echo.confirmed,
                    in_gap: echo.in_gap,
                }
            }),
            thing: thing.map(|(name, _)| name),
            truth_free_m,
            truth_thing,
        }
    }

    /// The recorded echo behind a remembered one.
    fn heard(&self, is: impl Fn(&SonarEcho) -> bool) -> Option<&SonarEcho> {
        self.moment.echoes.iter().find(|echo| echo.echo && is(echo))
    }
}
