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
    /// ψ, radians, on the branch nearest to the previous one.
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
    let Some(previous_rad) = previous_rad else {
        return Framed { psi_rad: wrap(angle_rad), source, omega_r_radps: 0.0, jumped: true };
    };
    let change_rad = wrap(angle_rad - previous_rad);
    // Written so that what is not a number is a jump.
    let turned = libm::fabs(change_rad) < TURN_LIMIT_RADPS * period_s + TURN_SLACK_RAD;
    Framed {
        psi_rad: if change_rad == 0.0 { previous_rad } else { previous_rad + change_rad },
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
