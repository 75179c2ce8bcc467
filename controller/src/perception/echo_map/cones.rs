//! What each sonar said last, and whether that still counts.

use schemas::{SONAR_REACH_M, SONARS, SonarEcho, Time};

use super::beam::{Beam, HALF_CONE_DEG};
use crate::digest::Digest;

/// A direction that no cone contains goes by the sonars within this, degrees (specification,
/// section 10).
const GAP_REACH_DEG: f64 = 30.0;

/// Ranges below this, metres, are contact. The device is blind below 0.10 m; the rest is two
/// standard deviations (1 % of the range) and a margin.
const CONTACT_M: f64 = 0.12;

/// Ranges of echoes up to this, metres, are believed: the reach and two standard deviations.
const FARTHEST_ECHO_M: f64 = SONAR_REACH_M * 1.02;

/// Angles are compared with this slack, radians, so that neighbouring cones share their edge.
const EDGE_RAD: f64 = 1e-9;

/// What one firing meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Reading {
    /// Nothing that can be believed.
    Unknown,
    /// Nothing came back from within reach.
    Silent,
    /// An echo from this far, metres; 0 in contact.
    Echo(f64),
}

impl Reading {
    /// Judges a message (specification, section 10): NaN, zero, negative and beyond-reach ranges are
    /// unknown unless the device itself says that there was no echo.
    pub(super) fn of(echo: &SonarEcho) -> Reading {
        if !echo.echo {
            Reading::Silent
        } else if echo.range_m > 0.0 && echo.range_m < CONTACT_M {
            Reading::Echo(0.0)
        } else if (CONTACT_M..=FARTHEST_ECHO_M).contains(&echo.range_m) {
            Reading::Echo(echo.range_m)
        } else {
            Reading::Unknown
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Cone {
    fired: Option<Time>,
    reading: Reading,
    /// When it last heard an echo.
    echoed: Option<Time>,
    fresh: bool,
    heard: bool,
}

/// The sixteen cones.
#[derive(Clone, Debug)]
pub(super) struct Cones {
    cones: [Cone; SONARS.len()],
    all_fresh: bool,
}

impl Cones {
    pub(super) fn new() -> Cones {
        let silent = Cone {
            fired: None,
            reading: Reading::Unknown,
            echoed: None,
            fresh: false,
            heard: false,
        };
        Cones { cones: [silent; SONARS.len()], all_fresh: false }
    }

    /// What this sonar said last.
    pub(super) fn reading(&self, id: usize) -> Reading {
        self.cones[id].reading
    }

    /// When this sonar last fired.
    pub(super) fn fired(&self, id: usize) -> Option<Time> {
        self.cones[id].fired
    }

    /// Whether this sonar has heard an echo after an instant.
    pub(super) fn echoed_after(&self, id: u8, instant: Time) -> bool {
        self.cones[usize::from(id)].echoed > Some(instant)
    }

    /// Takes a sonar's newest reading.
    pub(super) fn hear(&mut self, id: usize, fired: Time, reading: Reading) {
        let cone = &mut self.cones[id];
        cone.fired = Some(fired);
        cone.reading = reading;
        if matches!(reading, Reading::Echo(_)) {
            cone.echoed = Some(fired);
        }
        cone.heard |= reading != Reading::Unknown;
    }

    /// Decides which readings still count at `now`: those not older than the lease, seconds.
    pub(super) fn age(&mut self, now: Time, lease_s: f64) {
        for cone in &mut self.cones {
            let young = cone.fired.is_some_and(|fired| now.seconds_since(fired) <= lease_s);
            cone.fresh = young && cone.reading != Reading::Unknown;
        }
        self.all_fresh = self.cones.iter().all(|cone| cone.fresh);
    }

    /// Whether all readings count: then every direction is known.
    pub(super) fn all_fresh(&self) -> bool {
        self.all_fresh
    }

    pub(super) fn heard_all(&self) -> bool {
        self.cones.iter().all(|cone| cone.heard)
    }

    pub(super) fn dead(&self) -> bool {
        self.cones.iter().all(|cone| !cone.fresh)
    }

    /// How many do not count.
    pub(super) fn unknown(&self) -> usize {
        self.cones.iter().filter(|cone| !cone.fresh).count()
    }

    /// Whether all cones that contain a direction in the body frame count, or, where none contains
    /// it, all within 30° of it.
    pub(super) fn known(&self, beams: &[Beam; SONARS.len()], body_angle_rad: f64) -> bool {
        if self.all_fresh {
            return body_angle_rad.is_finite();
        }
        let fresh_within = |reach_deg: f64| {
            let reach_rad = reach_deg.to_radians() + EDGE_RAD;
            let mut fresh = None;
            for (beam, cone) in beams.iter().zip(&self.cones) {
                if apart_rad(body_angle_rad, beam.bearing_rad) <= reach_rad {
                    fresh = Some(fresh.unwrap_or(true) && cone.fresh);
                }
            }
            fresh
        };
        fresh_within(HALF_CONE_DEG).or_else(|| fresh_within(GAP_REACH_DEG)).unwrap_or(false)
    }

    pub(super) fn fold(&self, digest: &mut Digest, start: Time) {
        for cone in &self.cones {
            let Some(fired) = cone.fired else {
                digest.word(u64::MAX);
                continue;
            };
            digest.time(fired, start);
            digest.number(match cone.reading {
                Reading::Unknown => f64::NAN,
                Reading::Silent => f64::INFINITY,
                Reading::Echo(range_m) => range_m,
            });
            let flags = [cone.echoed.is_some(), cone.fresh, cone.heard];
            digest.word(flags.into_iter().fold(0, |word, flag| word << 1 | u64::from(flag)));
            if let Some(echoed) = cone.echoed {
                digest.time(echoed, start);
            }
        }
    }
}

/// How far apart two directions are, radians, 0 to π; NaN if either is not finite.
pub(super) fn apart_rad(a_rad: f64, b_rad: f64) -> f64 {
    use std::f64::consts::TAU;
    let turn_rad = a_rad - b_rad;
    // Within a turn, as most are, a remainder is quickly had.
    let turn_rad = if turn_rad.abs() < TAU {
        if turn_rad < 0.0 { turn_rad + TAU } else { turn_rad }
    } else {
        turn_rad.rem_euclid(TAU)
    };
    if turn_rad > 0.5 * TAU { TAU - turn_rad } else { turn_rad }
}

#[cfg(test)]
mod tests {
    use schemas::SIMULATION_EPOCH;

    use super::*;

    fn said(range_m: f64, echo: bool) -> Reading {
        Reading::of(&SonarEcho { id: 0, range_m, echo, fired: SIMULATION_EPOCH })
    }

    /// Specification, section 10, bad input policy.
    #[test]
    fn readings_are_judged_by_the_policy() {
        for range_m in [f64::NAN, -1.0, 0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, 5.2] {
            assert_eq!(said(range_m, true), Reading::Unknown, "{range_m}");
        }
        for range_m in [5.0, f64::NAN, 0.0, -1.0] {
            assert_eq!(said(range_m, false), Reading::Silent, "{range_m}");
        }
        assert_eq!(said(0.05, true), Reading::Echo(0.0));
        assert_eq!(said(0.11, true), Reading::Echo(0.0));
        assert_eq!(said(0.12, true), Reading::Echo(0.12));
        assert_eq!(said(5.0, true), Reading::Echo(5.0));
    }

    fn all_fresh() -> Cones {
        let mut cones = Cones::new();
        for id in 0..SONARS.len() {
            cones.hear(id, SIMULATION_EPOCH, Reading::Silent);
        }
        cones
    }

    /// With the sonar at 50° (id 1) unknown, its cone 40–60° is; so is the blind gap 60–80°, which
    /// goes by the sonars within 30°: 50° and both at 90°. 30° and 90° themselves are not.
    #[test]
    fn an_unknown_cone_takes_its_gap_with_it() {
        let beams = Beam::all();
        let mut cones = all_fresh();
        cones.hear(1, SIMULATION_EPOCH, Reading::Unknown);
        cones.age(SIMULATION_EPOCH, 0.5);
        let known = |deg: f64| cones.known(&beams, deg.to_radians());
        for deg in [40.0, 45.0, 60.0, 61.0, 70.0, 79.0, 430.0, -310.0] {
            assert!(!known(deg), "{deg}");
        }
        for deg in [39.0, 30.0, 81.0, 90.0, 110.0, -50.0, -70.0, 180.0, 0.0] {
            assert!(known(deg), "{deg}");
        }
    }

    /// ±90° are watched by two sonars each; both must count.
    #[test]
    fn a_direction_with_two_sonars_needs_both() {
        let beams = Beam::all();
        for id in [0, 15] {
            let mut cones = all_fresh();
            cones.hear(id, SIMULATION_EPOCH, Reading::Unknown);
            cones.age(SIMULATION_EPOCH, 0.5);
            assert!(!cones.known(&beams, 90_f64.to_radians()), "{id}");
            assert!(!cones.known(&beams, 110_f64.to_radians()), "{id}");
            assert!(cones.known(&beams, -90_f64.to_radians()), "{id}");
        }
    }

    #[test]
    fn readings_expire_after_half_a_second() {
        let mut cones = all_fresh();
        let ms = 1_000_000;
        cones.age(SIMULATION_EPOCH.after_ns(500 * ms), 0.5);
        assert!(cones.cones.iter().all(|cone| cone.fresh));
        cones.age(SIMULATION_EPOCH.after_ns(501 * ms), 0.5);
        assert!(cones.dead());
        assert!(cones.heard_all(), "heard once is heard");
    }

    #[test]
    fn a_direction_that_is_no_number_is_unknown() {
        let beams = Beam::all();
        let mut cones = all_fresh();
        cones.age(SIMULATION_EPOCH, 0.5);
        assert!(!cones.known(&beams, f64::NAN));
        cones.hear(0, SIMULATION_EPOCH, Reading::Unknown);
        cones.age(SIMULATION_EPOCH, 0.5);
        assert!(!cones.known(&beams, f64::NAN) && !cones.known(&beams, f64::INFINITY));
    }

    #[test]
    fn unheard_sonars_are_unknown() {
        let cones = Cones::new();
        assert!(cones.dead() && !cones.heard_all());
        assert!(!cones.known(&Beam::all(), 0.0) && !cones.known(&Beam::all(), 1.0));
    }
}
