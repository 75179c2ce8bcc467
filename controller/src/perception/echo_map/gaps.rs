//! The blind gaps between the cones: 60–80° and 100–120° on either side.
//!
//! No sonar looks there; in those directions the nearest echo of the sonars within 30° counts as well
//! as what is remembered (specification, section 10). So each of those sonars puts points into the gap,
//! as far away as what it last heard; they hold as long as a reading does. They are asked only along
//! directions in a gap: as obstacles for every direction they would hide much that is known to be free.

use schemas::{SONARS, Time};

use super::beam::{Beam, BodyToWorld, unit};
use super::cones::apart_rad;
use super::points::{PlacedEcho, Point};
use crate::digest::Digest;

/// Points per gap and sonar, 5° apart like those of an arc.
const GAP_POINTS: usize = 3;

/// One gap.
struct Gap {
    /// Directions of its points in the body frame, degrees.
    directions_deg: [f64; GAP_POINTS],
    /// The sonars within 30° of each of them, by id.
    sonars: [usize; 3],
}

const GAPS: [Gap; 4] = [
    Gap { directions_deg: [65.0, 70.0, 75.0], sonars: [0, 1, 15] },
    Gap { directions_deg: [105.0, 110.0, 115.0], sonars: [0, 14, 15] },
    Gap { directions_deg: [-65.0, -70.0, -75.0], sonars: [6, 7, 8] },
    Gap { directions_deg: [-105.0, -110.0, -115.0], sonars: [7, 8, 9] },
];

/// Where the gaps are, on either side, degrees off ahead.
const EDGES_DEG: [[f64; 2]; 2] = [[60.0, 80.0], [100.0, 120.0]];

/// The points in the gaps: per gap, the last ones of each of its sonars.
#[derive(Clone, Debug)]
pub(super) struct Gaps {
    /// Unit vectors towards each gap's points, body frame.
    directions: [[[f64; 2]; GAP_POINTS]; GAPS.len()],
    filled: [[Option<[Point; GAP_POINTS]>; 3]; GAPS.len()],
}

impl Gaps {
    /// How many points there can be.
    pub(super) const MOST_POINTS: usize = GAPS.len() * 3 * GAP_POINTS;

    pub(super) fn new() -> Gaps {
        Gaps {
            directions: GAPS.map(|gap| gap.directions_deg.map(|deg| unit(deg.to_radians()))),
            filled: [[None; 3]; GAPS.len()],
        }
    }

    pub(super) fn clear(&mut self) {
        self.filled = [[None; 3]; GAPS.len()];
    }

    /// Takes the echo of a sonar, heard where `to_world` says.
    pub(super) fn hear(
        &mut self,
        id: usize,
        beams: &[Beam; SONARS.len()],
        to_world: &BodyToWorld,
        echo: &PlacedEcho,
        confirmed: bool,
    ) {
        for ((gap, directions), filled) in GAPS.iter().zip(&self.directions).zip(&mut self.filled) {
            let Some(slot) = gap.sonars.iter().position(|sonar| *sonar == id) else { continue };
            let mount_m = beams[id].mount_m;
            filled[slot] = Some(directions.map(|direction| {
                // As far from the centre as the echo would be, had the sonar looked that way.
                let reach_m = mount_m[0] * direction[0] + mount_m[1] * direction[1] + echo.range_m;
                let at_m = to_world.point_m(direction.map(|component| reach_m * component));
                Point::new(echo, at_m, confirmed)
            }));
        }
    }

    /// Whether a direction in the body frame lies in a gap.
    pub(super) fn hold(body_angle_rad: f64) -> bool {
        let off_ahead_deg = apart_rad(body_angle_rad, 0.0).to_degrees();
        EDGES_DEG.iter().any(|[from, to]| off_ahead_deg > *from && off_ahead_deg < *to)
    }

    /// The points that still count at `now`: those not older than the lease, seconds.
    pub(super) fn points(&self, now: Time, lease_s: f64) -> impl Iterator<Item = &Point> {
        self.filled
            .iter()
            .flatten()
            .flatten()
            .flatten()
            .filter(move |point| now.seconds_since(point.fired) <= lease_s)
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        for (slot, points) in self.filled.iter().flatten().enumerate() {
            for point in points.iter().flatten() {
                digest.word(slot as u64);
                point.fold(digest, start);
            }
        }
    }
}
