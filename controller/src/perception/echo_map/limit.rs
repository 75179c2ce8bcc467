//! Which remembered echo ends a ray: for explanations, never for decisions.

use schemas::{Footprint, Pose, Time};

use super::beam::unit;
use super::doubt::Doubts;
use super::gaps::Gaps;
use super::points::Point;
use super::ray::{Lane, Ray};
use super::sightings::drawn_nearer_m;
use super::{EchoMap, Odometry};

/// The echo that a ray ends at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitingEcho {
    /// Free travel up to it, metres: what the ray itself says, bit for bit.
    pub free_m: f64,
    /// When its sonar fired. Two sonars fire at once; with the range this tells which one.
    pub fired: Time,
    /// The range it was heard at, metres; 0 in contact.
    pub range_m: f64,
    /// Where on the echo's arc the ray meets it, metres, world frame, as remembered.
    pub at_m: [f64; 2],
    /// How much nearer than that it counts, metres, for its uncertainty.
    pub nearer_by_m: f64,
    /// Whether another firing heard it too.
    pub confirmed: bool,
    /// Whether it stands for a blind gap beside the cone that heard it.
    pub in_gap: bool,
}

impl EchoMap {
    /// The echo that ends [`EchoMap::law_ray_m`]; `None` where nothing is met or nothing is known.
    /// To be asked after [`EchoMap::advance`] with the same odometry, from the pose given there.
    pub fn law_limit(
        &self,
        odometry: &Odometry,
        from: &Pose,
        angle_rad: f64,
    ) -> Option<LimitingEcho> {
        let way = self.way(from, angle_rad);
        self.limit(true, odometry, from, angle_rad, |point_m| way.free_m(&[point_m]))
    }

    /// The echo that ends [`EchoMap::law_travel_m`], likewise.
    pub fn law_travel_limit(
        &self,
        footprint: &Footprint,
        odometry: &Odometry,
        from: &Pose,
        angle_rad: f64,
    ) -> Option<LimitingEcho> {
        let lane = Lane::of(footprint, from, angle_rad);
        self.limit(true, odometry, from, angle_rad, |point_m| lane.free_m(&[point_m]))
    }

    /// The echo that ends [`EchoMap::safety_ray_m`], likewise.
    pub fn safety_limit(
        &self,
        odometry: &Odometry,
        from: &Pose,
        angle_rad: f64,
    ) -> Option<LimitingEcho> {
        let way = self.way(from, angle_rad);
        self.limit(false, odometry, from, angle_rad, |point_m| way.free_m(&[point_m]))
    }

    fn way(&self, from: &Pose, angle_rad: f64) -> Ray {
        let radius_m = self.settings.inflation_m;
        Ray { from_m: from.position_m(), along: unit(angle_rad), radius_m }
    }

    fn limit(
        &self,
        laws: bool,
        odometry: &Odometry,
        from: &Pose,
        angle_rad: f64,
        free_m: impl Fn([f64; 2]) -> f64,
    ) -> Option<LimitingEcho> {
        let now = self.advanced_to.filter(|_| self.knows(from, angle_rad))?;
        // The law's scan is made of confirmed points, and does not reckon with what moves.
        let shows = |point_m: &[f64; 2]| {
            if laws {
                self.law_points().contains(point_m)
            } else {
                self.safety_points().contains(point_m)
            }
        };
        let doubts = Doubts {
            cones: &self.cones,
            now,
            odometer_m: odometry.odometer_m(),
            v_disc_mps: self.settings.v_disc_mps,
        };
        let mut nearest: Option<LimitingEcho> = None;
        let mut offer = |point: &Point, in_gap: bool| {
            if !point.counts() || laws && !point.confirmed {
                return;
            }
            let doubt = doubts.about(point);
            let nearer_by_m = if laws { doubt.stands_m } else { doubt.nearer_m() };
            let Some(drawn_m) = drawn_nearer_m(from.position_m(), point.at_m, nearer_by_m) else {
                return;
            };
            let free_m = free_m(drawn_m);
            // Of several points in one direction the scan shows the nearest alone; looking for it there
            // is the costly part.
            if free_m < nearest.map_or(f64::INFINITY, |echo| echo.free_m)
                && (in_gap || shows(&drawn_m))
            {
                let Point { at_m, range_m, fired, confirmed, .. } = *point;
                nearest = Some(LimitingEcho {
                    free_m,
                    fired,
                    range_m,
                    at_m,
                    nearer_by_m,
                    confirmed,
                    in_gap,
                });
            }
        };
        self.points.as_slice().iter().for_each(|point| offer(point, false));
        if Gaps::hold(angle_rad - from.theta_rad) {
            self.gaps.points(now, self.settings.lease_s).for_each(|point| offer(point, true));
        }
        nearest
    }
}
