//! Domain types to and from the generated protobuf types, which stay inside this crate.

use crate::step::canonical;
use crate::{
    Command, Disc, EncoderSample, ExactPose, Gap, ImuSample, JoystickSample, Pose, SonarEcho,
    SonarScan, Time, Timing, Truth, Twist, proto,
};

impl From<Pose> for proto::Pose {
    fn from(pose: Pose) -> Self {
        proto::Pose {
            x_m: canonical(pose.x_m),
            y_m: canonical(pose.y_m),
            theta_rad: canonical(pose.theta_rad),
        }
    }
}

impl From<proto::Pose> for Pose {
    fn from(wire: proto::Pose) -> Self {
        Pose { x_m: wire.x_m, y_m: wire.y_m, theta_rad: wire.theta_rad }
    }
}

/// A pose that was not sent is unknown, not the origin.
fn pose_or_unknown(wire: Option<proto::Pose>) -> Pose {
    wire.map_or(Pose { x_m: f64::NAN, y_m: f64::NAN, theta_rad: f64::NAN }, Pose::from)
}

impl From<&SonarScan> for proto::SonarScan {
    fn from(scan: &SonarScan) -> Self {
        let echoes = scan.echoes.iter().map(|echo| proto::SonarEcho {
            id: u32::from(echo.id),
            range_m: canonical(echo.range_m),
            echo: echo.echo,
            fired_ns: echo.fired.0,
        });
        proto::SonarScan { stamp_ns: scan.stamp.0, echoes: echoes.collect() }
    }
}

impl From<proto::SonarScan> for SonarScan {
    fn from(wire: proto::SonarScan) -> Self {
        let echoes = wire.echoes.into_iter().map(|echo| SonarEcho {
            // An id that no robot has stays one that no robot has.
            id: u8::try_from(echo.id).unwrap_or(u8::MAX),
            range_m: echo.range_m,
            echo: echo.echo,
            fired: Time(echo.fired_ns),
        });
        SonarScan { stamp: Time(wire.stamp_ns), echoes: echoes.collect() }
    }
}

impl From<&ImuSample> for proto::ImuSample {
    fn from(imu: &ImuSample) -> Self {
        let [accel_x_mps2, accel_y_mps2, accel_z_mps2] = imu.accel_mps2.map(canonical);
        let [gyro_x_radps, gyro_y_radps, gyro_z_radps] = imu.gyro_radps.map(canonical);
        let [mag_x_ut, mag_y_ut, mag_z_ut] = imu.mag_ut.map(canonical);
        proto::ImuSample {
            stamp_ns: imu.stamp.0,
            accel_x_mps2,
            accel_y_mps2,
            accel_z_mps2,
            gyro_x_radps,
            gyro_y_radps,
            gyro_z_radps,
            mag_x_ut,
            mag_y_ut,
            mag_z_ut,
        }
    }
}

impl From<proto::ImuSample> for ImuSample {
    fn from(wire: proto::ImuSample) -> Self {
        ImuSample {
            stamp: Time(wire.stamp_ns),
            accel_mps2: [wire.accel_x_mps2, wire.accel_y_mps2, wire.accel_z_mps2],
            gyro_radps: [wire.gyro_x_radps, wire.gyro_y_radps, wire.gyro_z_radps],
            mag_ut: [wire.mag_x_ut, wire.mag_y_ut, wire.mag_z_ut],
        }
    }
}

impl From<&EncoderSample> for proto::EncoderSample {
    fn from(encoders: &EncoderSample) -> Self {
        proto::EncoderSample {
            stamp_ns: encoders.stamp.0,
            left_m: canonical(encoders.left_m),
            right_m: canonical(encoders.right_m),
            left_mps: canonical(encoders.left_mps),
            right_mps: canonical(encoders.right_mps),
        }
    }
}

impl From<proto::EncoderSample> for EncoderSample {
    fn from(wire: proto::EncoderSample) -> Self {
        EncoderSample {
            stamp: Time(wire.stamp_ns),
            left_m: wire.left_m,
            right_m: wire.right_m,
            left_mps: wire.left_mps,
            right_mps: wire.right_mps,
        }
    }
}

impl From<&JoystickSample> for proto::JoystickSample {
    fn from(joystick: &JoystickSample) -> Self {
        proto::JoystickSample {
            stamp_ns: joystick.stamp.0,
            v_mps: canonical(joystick.v_mps),
            omega_radps: canonical(joystick.omega_radps),
            dead_man: joystick.dead_man,
        }
    }
}

impl From<proto::JoystickSample> for JoystickSample {
    fn from(wire: proto::JoystickSample) -> Self {
        JoystickSample {
            stamp: Time(wire.stamp_ns),
            v_mps: wire.v_mps,
            omega_radps: wire.omega_radps,
            dead_man: wire.dead_man,
        }
    }
}

impl From<&ExactPose> for proto::ExactPose {
    fn from(exact: &ExactPose) -> Self {
        proto::ExactPose {
            stamp_ns: exact.stamp.0,
            pose: Some(exact.pose.into()),
            v_mps: canonical(exact.v_mps),
            omega_radps: canonical(exact.omega_radps),
        }
    }
}

impl From<proto::ExactPose> for ExactPose {
    fn from(wire: proto::ExactPose) -> Self {
        ExactPose {
            stamp: Time(wire.stamp_ns),
            pose: pose_or_unknown(wire.pose),
            v_mps: wire.v_mps,
            omega_radps: wire.omega_radps,
        }
    }
}

impl From<&Command> for proto::Command {
    fn from(command: &Command) -> Self {
        let [accel_mps2, alpha_radps2] = command.accel.unwrap_or_default().map(canonical);
        proto::Command {
            stamp_ns: command.stamp.0,
            v_mps: canonical(command.twist.v_mps),
            omega_radps: canonical(command.twist.omega_radps),
            accelerates: command.accel.is_some(),
            accel_mps2,
            alpha_radps2,
        }
    }
}

impl From<proto::Command> for Command {
    fn from(wire: proto::Command) -> Self {
        Command {
            stamp: Time(wire.stamp_ns),
            twist: Twist { v_mps: wire.v_mps, omega_radps: wire.omega_radps },
            accel: wire.accelerates.then_some([wire.accel_mps2, wire.alpha_radps2]),
        }
    }
}

impl From<&Truth> for proto::Truth {
    fn from(truth: &Truth) -> Self {
        let discs = truth.discs.iter().map(|disc| proto::Disc {
            x_m: canonical(disc.centre_m[0]),
            y_m: canonical(disc.centre_m[1]),
            radius_m: canonical(disc.radius_m),
        });
        proto::Truth {
            stamp_ns: truth.stamp.0,
            pose: Some(truth.pose.into()),
            v_mps: canonical(truth.v_mps),
            omega_radps: canonical(truth.omega_radps),
            clearance_m: canonical(truth.clearance_m),
            clearance_static_m: canonical(truth.clearance_static_m),
            discs: discs.collect(),
        }
    }
}

impl From<proto::Truth> for Truth {
    fn from(wire: proto::Truth) -> Self {
        let discs = wire
            .discs
            .into_iter()
            .map(|disc| Disc { centre_m: [disc.x_m, disc.y_m], radius_m: disc.radius_m });
        Truth {
            stamp: Time(wire.stamp_ns),
            pose: pose_or_unknown(wire.pose),
            v_mps: wire.v_mps,
            omega_radps: wire.omega_radps,
            clearance_m: wire.clearance_m,
            clearance_static_m: wire.clearance_static_m,
            discs: discs.collect(),
        }
    }
}

impl From<&Gap> for proto::Gap {
    fn from(gap: &Gap) -> Self {
        proto::Gap {
            stamp_ns: gap.stamp.0,
            stream: gap.stream.clone(),
            start_ns: gap.start.0,
            end_ns: gap.end.0,
            cause: gap.cause.clone(),
        }
    }
}

impl From<proto::Gap> for Gap {
    fn from(wire: proto::Gap) -> Self {
        Gap {
            stamp: Time(wire.stamp_ns),
            stream: wire.stream,
            start: Time(wire.start_ns),
            end: Time(wire.end_ns),
            cause: wire.cause,
        }
    }
}

impl From<&Timing> for proto::Timing {
    fn from(timing: &Timing) -> Self {
        proto::Timing {
            stamp_ns: timing.stamp.0,
            step_index: timing.step_index,
            step_cost_ns: timing.step_cost_ns,
        }
    }
}

impl From<proto::Timing> for Timing {
    fn from(wire: proto::Timing) -> Self {
        Timing {
            stamp: Time(wire.stamp_ns),
            step_index: wire.step_index,
            step_cost_ns: wire.step_cost_ns,
        }
    }
}
