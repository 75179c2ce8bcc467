//! The distance frame: the world angle ψ of e1, and its rate `ω_r`.
//!
//! In: which way the target moves or lies, which way the nearest face looks, the heading. Out: ψ,
//! where it came from, `ω_r`, and whether it jumped (specification §6).

use std::f64::consts::FRAC_PI_2;

use schemas::FrameSource;

use crate::law::arctangent::wrap;
use crate::params::choice;

choice! {
    /// How ψ is chosen.
    Frame {
        /// Direction of the target's velocity (the paper's text); the last one when it rests; the
        /// direction of Δ when the target is predicted; the heading before any.
        Reference = "ref",
        /// Normal of the nearest face turned by the number of quarters that brings it nearest to
        /// the direction of the target's velocity (of Δ when the target rests or is predicted);
        /// `ref` where no normal is known.
        Wall = "wall",
    }
}

/// How far the wanted direction may turn away from the quarter in force before another is taken:
/// 45° + 10° (specification §6).
const KEEP_RAD: f64 = 55.0 * std::f64::consts::PI / 180.0;

/// Fastest change of ψ that is a turn and not a jump, rad/s (specification §6).
const TURN_LIMIT_RADPS: f64 = 0.5;

/// Change of ψ that is never a jump, radians (specification §6).
const TURN_SLACK_RAD: f64 = 1e-3;

/// Which way the target moves, or lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// World angle of the target's velocity, radians; `None` when it rests.
    pub velocity_rad: Option<f64>,
    /// World angle of the displacement to the target, radians; `None` when it is underfoot.
    pub displacement_rad: Option<f64>,
    /// Whether the target is predicted from the joystick.
    pub predicted: bool,
}

/// The frame of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framed {
    /// ψ, radians, in (−π, π]: not unwrapped, so that it does not depend on turns long past.
    pub psi_rad: f64,
    /// Where it came from.
    pub source: FrameSource,
    /// `ω_r`, rad/s; 0 at a jump.
    pub omega_r_radps: f64,
    /// Whether ψ jumped, or is the first.
    pub jumped: bool,
}

/// ψ of this step, given that of the previous one.
///
/// `face_rad` is the world angle from the robot straight into the nearest face, where known.
pub fn frame(
    rule: Frame,
    previous_rad: Option<f64>,
    aim: &Aim,
    face_rad: Option<f64>,
    heading_rad: f64,
    period_s: f64,
) -> Framed {
    let (angle_rad, source) = match (rule, face_rad) {
        (Frame::Wall, Some(face_rad)) => {
            (quarter(face_rad, previous_rad, aim, heading_rad), FrameSource::Wall)
        }
        _ => reference(previous_rad, aim, heading_rad),
    };
    let psi_rad = wrap(angle_rad);
    let Some(previous_rad) = previous_rad else {
        return Framed { psi_rad, source, omega_r_radps: 0.0, jumped: true };
    };
    let change_rad = wrap(psi_rad - previous_rad);
    // Written so that what is not a number is a jump.
    let turned = libm::fabs(change_rad) < TURN_LIMIT_RADPS * period_s + TURN_SLACK_RAD;
    Framed {
        psi_rad,
        source,
        omega_r_radps: if turned { change_rad / period_s } else { 0.0 },
        jumped: !turned,
    }
}

fn reference(previous_rad: Option<f64>, aim: &Aim, heading_rad: f64) -> (f64, FrameSource) {
    let displacement_rad = if aim.predicted { aim.displacement_rad } else { None };
    if let Some(angle_rad) = aim.velocity_rad {
        (angle_rad, FrameSource::TargetVelocity)
    } else if let Some(angle_rad) = displacement_rad {
        (angle_rad, FrameSource::Displacement)
    } else if let Some(angle_rad) = previous_rad {
        (angle_rad, FrameSource::Kept)
    } else {
        (heading_rad, FrameSource::Heading)
    }
}

/// The direction among `face_rad` + n·90° to take for ψ.
fn quarter(face_rad: f64, previous_rad: Option<f64>, aim: &Aim, heading_rad: f64) -> f64 {
    let nearest_to =
        |angle_rad: f64| face_rad + FRAC_PI_2 * libm::round(wrap(angle_rad - face_rad) / FRAC_PI_2);
    let wanted_rad = aim.velocity_rad.or(aim.displacement_rad);
    match (previous_rad.map(nearest_to), wanted_rad) {
        (Some(kept_rad), Some(wanted_rad)) => {
            if libm::fabs(wrap(wanted_rad - kept_rad)) <= KEEP_RAD {
                kept_rad
            } else {
                nearest_to(wanted_rad)
            }
        }
        (Some(kept_rad), None) => kept_rad,
        (None, Some(wanted_rad)) => nearest_to(wanted_rad),
        (None, None) => nearest_to(heading_rad),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const PERIOD_S: f64 = 0.1;
    const NOWHERE: Aim = Aim { velocity_rad: None, displacement_rad: None, predicted: false };

    fn towards(angle_rad: f64) -> Aim {
        Aim { velocity_rad: Some(angle_rad), ..NOWHERE }
    }

    fn degrees(angle: f64) -> f64 {
        angle * PI / 180.0
    }

    fn wall(previous: Option<f64>, aim: &Aim, face_rad: f64) -> Framed {
        frame(Frame::Wall, previous, aim, Some(face_rad), 0.3, PERIOD_S)
    }

    fn reference(previous: Option<f64>, aim: &Aim) -> Framed {
        frame(Frame::Reference, previous, aim, Some(1.0), 0.3, PERIOD_S)
    }

    /// The paper's text, case by case, and what it leaves open (table at the head of the
    /// specification).
    #[test]
    fn the_reference_frame_follows_the_target() {
        let of = |previous, aim: &Aim| {
            let framed = reference(previous, aim);
            (framed.psi_rad, framed.source)
        };
        let displaced = Aim { displacement_rad: Some(0.7), ..NOWHERE };
        let predicted = Aim { predicted: true, ..displaced };
        assert_eq!(of(Some(2.0), &towards(1.2)), (1.2, FrameSource::TargetVelocity));
        assert_eq!(of(Some(2.0), &displaced), (2.0, FrameSource::Kept), "a task's target rests");
        assert_eq!(of(Some(2.0), &predicted), (0.7, FrameSource::Displacement));
        assert_eq!(of(Some(2.0), &NOWHERE), (2.0, FrameSource::Kept));
        assert_eq!(of(None, &NOWHERE), (0.3, FrameSource::Heading));
    }

    /// ψ is the face's normal plus quarters, nearest to where the target goes, or lies if it rests.
    #[test]
    fn the_wall_frame_turns_by_quarters() {
        for quarters in -3..=3 {
            let face_rad = 0.2 + f64::from(quarters) * FRAC_PI_2;
            for (aim, expected) in [(0.5, 0.2), (1.5, 0.2 + FRAC_PI_2), (-2.8, 0.2 - PI)] {
                let framed = wall(None, &towards(aim), face_rad);
                assert!((wrap(framed.psi_rad - expected)).abs() < 1e-12, "{framed:?}");
                assert_eq!(framed.source, FrameSource::Wall);
            }
        }
        let resting = Aim { displacement_rad: Some(1.5), ..NOWHERE };
        let framed = wall(None, &resting, 0.2);
        assert!((framed.psi_rad - (0.2 + FRAC_PI_2)).abs() < 1e-12);
        // Nothing to go by but the heading of 0.3.
        assert!((wall(None, &NOWHERE, 0.2).psi_rad - 0.2).abs() < 1e-12);
    }

    /// The old choice holds up to 45° + 10° from where the target goes.
    #[test]
    fn the_quarter_is_kept_within_55_degrees() {
        let kept = wall(Some(0.0), &towards(degrees(54.0)), 0.0);
        assert_eq!((kept.psi_rad, kept.jumped), (0.0, false));
        let changed = wall(Some(0.0), &towards(degrees(56.0)), 0.0);
        assert!((changed.psi_rad - FRAC_PI_2).abs() < 1e-12);
        assert!(changed.jumped);
        assert_eq!(changed.omega_r_radps, 0.0);
        // Coming back it holds as long.
        let back = wall(Some(FRAC_PI_2), &towards(degrees(36.0)), 0.0);
        assert!((back.psi_rad - FRAC_PI_2).abs() < 1e-12);
        assert!(!back.jumped);
        // Without an aim the quarter nearest to the old ψ stays, though the face is another.
        assert!((wall(Some(0.1), &NOWHERE, FRAC_PI_2).psi_rad).abs() < 1e-12);
    }

    /// `ω_r` = Δψ/Ts below 0.5 rad/s · Ts + 1 mrad, across ±π too; else a jump.
    #[test]
    fn slow_turns_are_rates_and_fast_ones_jumps() {
        let turned = |from: f64, to: f64| reference(Some(from), &towards(to));
        let slow = turned(0.0, 0.04);
        assert!((slow.omega_r_radps - 0.4).abs() < 1e-12 && !slow.jumped);
        let limit = 0.5 * PERIOD_S + 1e-3;
        assert!(!turned(0.0, limit - 1e-9).jumped);
        assert!(turned(0.0, limit + 1e-9).jumped);
        let across = turned(PI - 0.01, -PI + 0.01);
        assert!((across.omega_r_radps - 0.2).abs() < 1e-9 && !across.jumped);
        let first = reference(None, &towards(0.5));
        assert!(first.jumped && first.omega_r_radps == 0.0);
    }

    /// Where no face is known, `wall` is `ref`.
    #[test]
    fn without_a_face_the_wall_frame_is_the_reference_frame() {
        for aim in [towards(1.2), NOWHERE] {
            for previous in [None, Some(2.0)] {
                let blind = frame(Frame::Wall, previous, &aim, None, 0.3, PERIOD_S);
                assert_eq!(blind, reference(previous, &aim));
            }
        }
    }
}
