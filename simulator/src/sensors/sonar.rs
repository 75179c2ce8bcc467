//! The sixteen sonars: which fire when, and what they hear.
//!
//! Every 40 ms one disc of each array fires: sonars i and 8 + i, i = slot mod 8, so that a full
//! sweep takes 0.32 s. A range counts from the sonar's own face. What a faulty sonar hears
//! ([`SonarNoise`]):
//!
//! 1. the nearest face within the cone that it meets at no more than the incidence limit,
//! 2. or a nearer convex corner within [`CORNER_REACH_M`] that nothing hides, with some probability,
//! 3. or, where only grazing faces are in reach, with some probability a false echo from farther
//!    away: sound that came back by a detour;
//! 4. with some probability nothing at all, or another sonar's echo at a random shorter range;
//! 5. with a range error proportional to the range.
//!
//! The ring of the sonar itself hides everything nearer than [`SONAR_BLIND_M`]: that, and a sonar
//! pressed into something, reads [`SONAR_BLIND_M`].

use schemas::{
    Pose, SONAR_BLIND_M, SONAR_REACH_M, SONARS, SonarEcho, SonarNoise, SonarScan, Time, World,
};

use super::cone::{Cone, Fan, SONAR_CONE_HALF_DEG, Surfaces};
use crate::heading::sincos;
use crate::noise::{Purpose, Reading, Stream};

/// Sonars in one array, and firings in a full sweep.
const ARRAY: usize = 8;

/// Within this distance a convex corner may echo, metres.
const CORNER_REACH_M: f64 = 1.2;

/// Which draw of a reading's noise is for what. Never renumber: recorded seeds mean these.
mod draw {
    pub(super) const DROP_OUT: u64 = 0;
    pub(super) const CROSS_TALK: u64 = 1;
    pub(super) const CROSS_TALK_RANGE: u64 = 2;
    pub(super) const LONG_ECHO: u64 = 3;
    pub(super) const LONG_ECHO_RANGE: u64 = 4;
    pub(super) const RANGE_ERROR: u64 = 5;
    pub(super) const FIRST_CORNER: u64 = 16;
}

/// One sonar on the body.
struct Mount {
    forward_m: f64,
    left_m: f64,
    axis: [f64; 2],
    noise: Stream,
}

/// All sonars, and the surfaces that they hear.
pub(crate) struct Sonars {
    mounts: [Mount; 16],
    surfaces: Surfaces,
    fan: Fan,
    noise: Option<SonarNoise>,
    least_cosine: f64,
}

impl Sonars {
    pub(crate) fn new(world: &World, noise: Option<SonarNoise>, seed: u64) -> Sonars {
        let mount = |id: usize| {
            let (sin, cos) = libm::sincos(SONARS[id].bearing_deg.to_radians());
            Mount {
                forward_m: SONARS[id].x_m,
                left_m: SONARS[id].y_m,
                axis: [cos, sin],
                noise: Stream::new(seed, Purpose::Sonar(id as u8)),
            }
        };
        Sonars {
            mounts: core::array::from_fn(mount),
            surfaces: Surfaces::new(world),
            fan: Fan::new(noise.map_or(SONAR_CONE_HALF_DEG, |noise| noise.half_cone_deg)),
            noise,
            least_cosine: noise
                .map_or(0.0, |noise| libm::cos(noise.incidence_limit_deg.to_radians())),
        }
    }

    /// The scan of firing slot `slot`, at a pose, `t_s` after the start.
    pub(crate) fn scan(
        &mut self,
        slot: u64,
        stamp: Time,
        t_s: f64,
        pose: &Pose,
        world: &World,
    ) -> SonarScan {
        self.surfaces.discs.clear();
        self.surfaces.discs.extend(world.discs_at(t_s));
        let (sin, cos) = sincos(pose.theta_rad);
        let firing = (slot % ARRAY as u64) as usize;
        let echoes = [firing, ARRAY + firing].map(|id| {
            let mount = &self.mounts[id];
            let tip_m = [
                pose.x_m + mount.forward_m * cos - mount.left_m * sin,
                pose.y_m + mount.forward_m * sin + mount.left_m * cos,
            ];
            let axis = [
                mount.axis[0] * cos - mount.axis[1] * sin,
                mount.axis[0] * sin + mount.axis[1] * cos,
            ];
            let heard_m = if self.surfaces.buries(tip_m) {
                Some(SONAR_BLIND_M)
            } else {
                let cone = self.fan.aim(tip_m, axis);
                match &self.noise {
                    None => audible(cone.nearest_m(&self.surfaces)),
                    Some(noise) => {
                        // A sonar's readings are numbered by its own firings.
                        let reading = mount.noise.reading(slot / ARRAY as u64);
                        self.hear(noise, reading, &cone, tip_m)
                    }
                }
            };
            SonarEcho {
                id: id as u8,
                range_m: heard_m.unwrap_or(SONAR_REACH_M),
                echo: heard_m.is_some(),
                fired: stamp,
            }
        });
        SonarScan { stamp, echoes: echoes.to_vec() }
    }

    /// The range that a faulty sonar reports; `None` for no echo.
    fn hear(
        &self,
        noise: &SonarNoise,
        reading: Reading,
        cone: &Cone,
        tip_m: [f64; 2],
    ) -> Option<f64> {
        if reading.happens(draw::DROP_OUT, noise.dropout) {
            return None;
        }
        let true_m = self.echo_m(noise, reading, cone, tip_m);
        if reading.happens(draw::CROSS_TALK, noise.cross_talk) {
            let farthest_m = true_m.unwrap_or(SONAR_REACH_M);
            return Some(reading.between(draw::CROSS_TALK_RANGE, SONAR_BLIND_M, farthest_m));
        }
        let [error, _] = reading.normals(draw::RANGE_ERROR);
        audible(true_m? * (1.0 + noise.range_fraction * error))
    }

    /// How far away the sound that comes back says its origin is; not yet cut to the sonar's reach.
    fn echo_m(
        &self,
        noise: &SonarNoise,
        reading: Reading,
        cone: &Cone,
        tip_m: [f64; 2],
    ) -> Option<f64> {
        let mut nearest_m = f64::INFINITY;
        let mut grazing_m = f64::INFINITY;
        for hit in cone.fan(&self.surfaces) {
            let least_m =
                if hit.cosine >= self.least_cosine { &mut nearest_m } else { &mut grazing_m };
            if hit.distance_m < *least_m {
                *least_m = hit.distance_m;
            }
        }
        for (corner, draw) in self.surfaces.corners_m().zip(draw::FIRST_CORNER..) {
            let offset_m = [corner[0] - tip_m[0], corner[1] - tip_m[1]];
            let squared = offset_m[0] * offset_m[0] + offset_m[1] * offset_m[1];
            if squared > CORNER_REACH_M * CORNER_REACH_M || !cone.holds(offset_m) {
                continue;
            }
            let distance_m = libm::sqrt(squared);
            if distance_m < nearest_m
                && reading.happens(draw, noise.corner_echo)
                && self.sees(tip_m, offset_m, distance_m)
            {
                nearest_m = distance_m;
            }
        }
        if nearest_m < SONAR_REACH_M {
            Some(nearest_m)
        } else if grazing_m < SONAR_REACH_M && reading.happens(draw::LONG_ECHO, noise.long_echo) {
            Some(reading.between(draw::LONG_ECHO_RANGE, grazing_m, SONAR_REACH_M))
        } else {
            None
        }
    }

    /// Whether nothing stands between a point and what is at an offset from it. A corner belongs to
    /// two faces; rounding may put it on either side of them by a hair.
    fn sees(&self, tip_m: [f64; 2], offset_m: [f64; 2], distance_m: f64) -> bool {
        const HAIR_M: f64 = 1e-9;
        if distance_m <= HAIR_M {
            return true;
        }
        let along = [offset_m[0] / distance_m, offset_m[1] / distance_m];
        self.surfaces.first_hit_m(tip_m, along) >= distance_m - HAIR_M
    }
}

/// A range as the device reports it: nothing from beyond its reach, nothing nearer than its ring.
fn audible(range_m: f64) -> Option<f64> {
    if range_m < SONAR_BLIND_M {
        Some(SONAR_BLIND_M)
    } else if range_m < SONAR_REACH_M {
        Some(range_m)
    } else {
        None
    }
}

#[cfg(test)]
mod tests;
