//! The closed lists of names that fields draw on.

use super::Value;
use super::wire::{FieldType, Wire};
use crate::proto;

/// A closed list of names: the domain enum, its protobuf numbers and its lower-case names.
macro_rules! names {
    ($(#[$doc:meta])* $type:ident { $($(#[$vdoc:meta])* $variant:ident = $name:literal),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub enum $type {
            /// Not set, or a name that a later version of the schema added.
            #[default]
            Unspecified,
            $($(#[$vdoc])* $variant),*
        }

        impl $type {
            /// The name in reports and machine-readable output.
            pub fn name(self) -> &'static str {
                match self {
                    $type::Unspecified => "unspecified",
                    $($type::$variant => $name),*
                }
            }
        }

        impl Wire<i32> for $type {
            fn to_wire(&self) -> i32 {
                match self {
                    $type::Unspecified => 0,
                    $($type::$variant => proto::$type::$variant as i32),*
                }
            }
            fn from_wire(wire: i32) -> Self {
                match proto::$type::try_from(wire) {
                    $(Ok(proto::$type::$variant) => $type::$variant,)*
                    _ => $type::Unspecified,
                }
            }
        }

        impl FieldType for $type {
            const UNKNOWN: $type = $type::Unspecified;

            fn value(&self) -> Value {
                Value::Name(self.name())
            }
        }
    };
}

names! {
    /// Class of the state in the sets (12).
    Region {
        /// The person may drive.
        Safe = "safe",
        /// Whoever drove, drives on.
        Hysteresis = "hysteresis",
        /// The feedback law drives.
        Danger = "danger",
    }
}

names! {
    /// Where the direction ψ of the distance frame came from.
    FrameSource {
        /// The robot's heading: nothing better is known yet.
        Heading = "heading",
        /// The velocity of the target.
        TargetVelocity = "target_velocity",
        /// The displacement to a predicted target.
        Displacement = "displacement",
        /// The normal of the nearest face.
        Wall = "wall",
        /// The direction of an earlier step.
        Kept = "kept",
    }
}

names! {
    /// Where the target came from.
    ReferenceSource {
        /// The task's trajectory.
        Task = "task",
        /// Predicted from the joystick.
        Joystick = "joystick",
        /// No usable joystick: the target is where the robot is.
        Hold = "hold",
    }
}

names! {
    /// Which part of the feedback law spoke.
    LawBranch {
        /// Left-hand side selected, d2 = d2l.
        Left = "left",
        /// Right-hand side selected, d2 = d2r.
        Right = "right",
        /// Wanted speed below `v_rest`.
        Rest = "rest",
        /// No feedback could be formed.
        None = "none",
    }
}

names! {
    /// Why the command is what it is.
    Reason {
        /// The person drives.
        Human = "human",
        /// The state is in the dangerous set.
        Danger = "danger",
        /// The state is in the hysteresis set and was dangerous before.
        Hysteresis = "hysteresis",
        /// Contact: D ≤ 0.
        Contact = "contact",
        /// No state has been seen in the safe set yet.
        NotYetSafe = "not_yet_safe",
        /// No joystick sample for longer than its lease.
        JoystickSilent = "joystick_silent",
        /// The joystick's value is not a number.
        JoystickInvalid = "joystick_invalid",
        /// The pose is not a number.
        PoseInvalid = "pose_invalid",
        /// No odometry for longer than its lease.
        OdometryStale = "odometry_stale",
        /// No distance sensor has been heard from.
        SensorsDead = "sensors_dead",
        /// A distance that the law needs is unknown.
        DistanceUnknown = "distance_unknown",
        /// The feedback law's value is not a number.
        FeedbackInvalid = "feedback_invalid",
        /// The safety layer would have had to alter what the person asked for.
        WouldBeProjected = "would_be_projected",
        /// A robot with sonars stands still for a fixed time at the start.
        Starting = "starting",
    }
}

names! {
    /// How the estimator fares. Where several things are true, the one that tells most.
    EstimatorStatus {
        /// Encoders and gyro agree.
        Ok = "ok",
        /// The wheels turn as the robot does not: their samples are turned away.
        Slip = "slip",
        /// The left counter stands while the right one and the gyro say that it should not.
        EncoderLeftDead = "encoder_left_dead",
        /// The same the other way round.
        EncoderRightDead = "encoder_right_dead",
        /// The gyro is silent: the wheels give the heading.
        GyroMissing = "gyro_missing",
        /// The encoders are silent.
        EncodersMissing = "encoders_missing",
        /// The gyro's bias has changed and is being learnt again.
        GyroBias = "gyro_bias",
        /// A turn rate was turned away.
        GyroRejected = "gyro_rejected",
        /// Samples were turned away for so long that the filter believes them again.
        Recovering = "recovering",
    }
}
