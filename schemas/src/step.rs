//! One step of the controller, field by field.
//!
//! The table at the end is the only place that knows the list of fields: it makes the domain type,
//! its way to and from protobuf, and the catalogue ([`Step::FIELDS`]) that diffs, explanations and
//! reports go by. Each field belongs to a [`Node`] of the data flow, in the order in which one
//! quantity causes the next.

mod field;
mod lacking;
mod names;
mod wire;

use crate::{Pose, Time, proto};
pub use field::{Field, Node, Value};
pub use lacking::Lacking;
pub use names::{EstimatorStatus, FrameSource, LawBranch, Reason, ReferenceSource, Region};
pub(crate) use wire::canonical;
use wire::{FieldType, Wire};

macro_rules! step {
    ($($node:ident { $($(#[$doc:meta])+ $name:ident: $type:ty, $unit:literal;)* })*) => {
        /// One step of the controller: what it was given, what it made of it, what it commanded.
        ///
        /// Symbols and signs are those of the controller's documentation; distances and angles
        /// refer to the frame (e1, e2) turned by `psi_rad`. Unknown numbers are NaN.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Step {
            /// The instant the step stands for.
            pub stamp: Time,
            /// Steps since the start of the session, from 0.
            pub step_index: u64,
            $($($(#[$doc])+ pub $name: $type,)*)*
        }

        impl Step {
            /// Every field but the stamp and the index, in the order of the data flow.
            pub const FIELDS: &'static [Field] = &[
                $($(Field { name: stringify!($name), node: Node::$node, unit: $unit },)*)*
            ];

            /// Every field's value, in the order of [`Step::FIELDS`].
            pub fn values(&self) -> [Value; Step::FIELDS.len()] {
                [$($(FieldType::value(&self.$name),)*)*]
            }

            /// Leaves out the fields that `other` does without and that may be left out: what a recording
            /// from before them can be compared with.
            pub fn leave_out_as(&mut self, other: &Step) {
                $($(FieldType::leave_out_as(&mut self.$name, &other.$name);)*)*
            }
        }

        impl From<&Step> for proto::Step {
            fn from(step: &Step) -> Self {
                proto::Step {
                    stamp_ns: step.stamp.0,
                    step_index: step.step_index,
                    $($($name: step.$name.to_wire(),)*)*
                }
            }
        }

        impl From<proto::Step> for Step {
            fn from(wire: proto::Step) -> Self {
                Step {
                    stamp: Time(wire.stamp_ns),
                    step_index: wire.step_index,
                    $($($name: Wire::from_wire(wire.$name),)*)*
                }
            }
        }

        impl Step {
            /// A step in which nothing is known yet: NaN, `Unspecified`, zero.
            pub fn unknown(stamp: Time, step_index: u64) -> Step {
                Step { stamp, step_index, $($($name: <$type as FieldType>::UNKNOWN,)*)* }
            }
        }
    };
}

step! {
    Input {
        /// Control period Ts.
        control_period_s: f64, "s";
        /// Requested forward speed, as the joystick gave it.
        v_h_mps: f64, "m/s";
        /// Requested turn rate, as the joystick gave it.
        omega_h_radps: f64, "rad/s";
        /// Age of that joystick sample.
        joystick_age_s: f64, "s";
        /// Covers every sample observed since the previous step.
        input_hash: u64, "";
    }
    Estimate {
        /// Estimated pose in the odometry frame, which starts at the scenario's start pose.
        pose: Pose, "m, m, rad";
        /// Estimated forward speed.
        v_mps: f64, "m/s";
        /// Estimated turn rate.
        omega_radps: f64, "rad/s";
        /// Age of the newest odometry.
        odometry_age_s: f64, "s";
        /// Roll by the attitude filter; with sonars only, like all that follows here.
        roll_rad: f64, "rad";
        /// Pitch by the attitude filter, positive nose down.
        pitch_rad: f64, "rad";
        /// Heading by the attitude filter, from magnetic north where a field is measured.
        yaw_rad: f64, "rad";
        /// Standard deviation of the estimated x.
        sigma_x_m: f64, "m";
        /// Standard deviation of the estimated y.
        sigma_y_m: f64, "m";
        /// Standard deviation of the estimated heading.
        sigma_theta_rad: f64, "rad";
        /// The gyro's constant error, as learnt so far.
        gyro_bias_radps: f64, "rad/s";
        /// Normalised innovation squared of the newest encoder sample.
        encoder_innovation: f64, "";
        /// Normalised innovation squared of the newest turn rate.
        gyro_innovation: f64, "";
        /// Encoder samples turned away since the start.
        encoders_rejected: i32, "";
        /// Turn rates turned away since the start.
        gyro_rejected: i32, "";
        /// How the estimator fares.
        estimator_status: EstimatorStatus, "";
    }
    Distances {
        /// Where ψ came from.
        frame_source: FrameSource, "";
        /// World angle ψ of e1.
        psi_rad: f64, "rad";
        /// `ω_r` = dψ/dt.
        omega_r_radps: f64, "rad/s";
        /// Distance to the edge of the admissible set along e1, capped at B.
        d1_m: f64, "m";
        /// The same along +e2.
        d2l_m: f64, "m";
        /// The same along −e2.
        d2r_m: f64, "m";
        /// D: distance to the edge of the admissible set along the direction of travel.
        distance_human_m: f64, "m";
        /// D as compared with the critical distances: with sonars more by what they measure too short; less guard
        /// and travel in one period, where on.
        distance_effective_m: f64, "m";
        /// Sonars whose cones are unknown: not heard yet, silent for too long, or nonsense. The safety
        /// layer takes what they look at for blocked. None with exact rays.
        sonars_unknown: Option<i32>, "";
        /// How clear the body's turning circle is of the nearest thing that the safety layer reckons with,
        /// negative within it, +∞ with nothing within reach. None where no body is swept.
        safety_clear_m: Option<f64>, "m";
    }
    Reference {
        /// Where the target came from.
        reference_source: ReferenceSource, "";
        /// Target `p_d`, x.
        target_x_m: f64, "m";
        /// Target `p_d`, y.
        target_y_m: f64, "m";
        /// Velocity of the target, x.
        target_vx_mps: f64, "m/s";
        /// Velocity of the target, y.
        target_vy_mps: f64, "m/s";
        /// Δ1: displacement to the target along e1.
        delta1_m: f64, "m";
        /// Δ2: displacement to the target along e2.
        delta2_m: f64, "m";
        /// Velocity of the target along e1.
        q1_mps: f64, "m/s";
        /// Velocity of the target along e2.
        q2_mps: f64, "m/s";
        /// Selected side σ: +1 left, −1 right.
        side: i32, "";
        /// Wanted distance ahead.
        d_d1_m: f64, "m";
        /// Wanted distance on the selected side.
        d_d2_m: f64, "m";
        /// Admissible wanted distance ahead (8).
        d_r1_m: f64, "m";
        /// Admissible wanted distance on the selected side (8).
        d_r2_m: f64, "m";
        /// Rate of `d_r1`.
        d_r1_rate_mps: f64, "m/s";
        /// Rate of `d_r2`.
        d_r2_rate_mps: f64, "m/s";
        /// Second rate of `d_r1`.
        d_r1_accel_mps2: f64, "m/s²";
        /// Second rate of `d_r2`.
        d_r2_accel_mps2: f64, "m/s²";
    }
    Law {
        /// Which part of the law spoke.
        law_branch: LawBranch, "";
        /// ln(d1/`d_r1`) (7).
        z1: f64, "";
        /// ln(d2/`d_r2`) (7).
        z2: f64, "";
        /// Heading relative to e1.
        theta_e_rad: f64, "rad";
        /// Wanted θe.
        theta_star_rad: f64, "rad";
        /// Rate of the wanted θe.
        theta_star_rate_radps: f64, "rad/s";
        /// Wanted speed.
        v_star_mps: f64, "m/s";
        /// Wanted turn rate relative to the frame (dynamic law; the kinematic law's `ω_f` − `ω_r`).
        omega_star_radps: f64, "rad/s";
        /// Lyapunov function (10) or (16).
        lyapunov: f64, "";
        /// Feedback input: (v, ω) or (acceleration, angular acceleration); m/s, rad/s or m/s², rad/s².
        u_f: [f64; 2], "m/s or m/s², rad/s or rad/s²";
    }
    Sharing {
        /// Human input after clipping to the limits; m/s, rad/s or m/s², rad/s².
        u_h: [f64; 2], "m/s or m/s², rad/s or rad/s²";
        /// Class of the state in the sets (12).
        region: Region, "";
        /// Sharing function k (13): 1 the person drives, 0 the feedback law.
        k: f64, "";
        /// How near danger is, for the person: 0 far, 1 at the edge of the dangerous set.
        danger: f64, "";
        /// Why.
        reason: Reason, "";
    }
    Command {
        /// Input chosen by (14), before the safety layer; m/s, rad/s or m/s², rad/s².
        u_s_before_projection: [f64; 2], "m/s or m/s², rad/s or rad/s²";
        /// Input applied; m/s, rad/s or m/s², rad/s².
        u_s: [f64; 2], "m/s or m/s², rad/s or rad/s²";
        /// Whether S1 scaled the feedback input.
        saturated: bool, "";
        /// Whether the safety layer altered the input.
        projected: bool, "";
        /// Covers the controller's whole state after the step.
        state_hash: u64, "";
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_survives_the_wire() {
        let mut step = Step::unknown(Time(7), 3);
        step.k = 1.0;
        step.side = -1;
        step.u_h = [0.25, -0.5];
        step.region = Region::Hysteresis;
        step.pose = Pose { x_m: 1.0, y_m: 2.0, theta_rad: 3.0 };
        step.input_hash = u64::MAX;
        (step.sonars_unknown, step.safety_clear_m) = (Some(0), Some(f64::INFINITY));
        let back = Step::from(proto::Step::from(&step));
        // NaN differs from itself, so compare what is printed.
        assert_eq!(format!("{step:?}"), format!("{back:?}"));
    }

    /// A log from before a field was recorded has no tag of it; what it lacks is unknown, not zero.
    #[test]
    fn a_step_from_before_a_field_reads_without_it() {
        let mut step = Step::unknown(Time(7), 3);
        (step.sonars_unknown, step.safety_clear_m) = (Some(3), Some(0.25));
        let mut wire = proto::Step::from(&step);
        (wire.sonars_unknown, wire.safety_clear_m) = (None, None);
        let old = Step::from(wire);
        assert_eq!((old.sonars_unknown, old.safety_clear_m), (None, None));
        let absent = old.values().iter().filter(|value| **value == Value::Absent).count();
        assert_eq!(absent, 2);
        // Made like the old one a new step lacks them too, and nothing else; an old one is like a new one.
        let mut like_old = step.clone();
        like_old.leave_out_as(&old);
        assert_eq!(format!("{like_old:?}"), format!("{old:?}"));
        let mut like_new = step.clone();
        like_new.leave_out_as(&step);
        assert_eq!(format!("{like_new:?}"), format!("{step:?}"));
    }

    #[test]
    fn directions_are_told_from_rates_and_deviations() {
        let directions: Vec<&str> = Step::FIELDS
            .iter()
            .filter(|field| field.is_direction())
            .map(|field| field.name)
            .collect();
        let all = ["roll_rad", "pitch_rad", "yaw_rad", "psi_rad", "theta_e_rad", "theta_star_rad"];
        assert_eq!(directions, all);
    }

    #[test]
    fn nodes_are_listed_in_causal_order() {
        assert!(Step::FIELDS.windows(2).all(|w| w[0].node <= w[1].node));
    }
}
