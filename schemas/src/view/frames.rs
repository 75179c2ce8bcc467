//! Frames and poses: `/tf`, `/pose`, `/pose_truth`.
//!
//! `world` holds everything. `base_link` is the robot where it really is, or where it believes to be
//! if that is all there is. `odom`, in which a session's estimates are given, starts at the scenario's
//! start pose and coincides with `world`; `base_link_estimate` is the robot where it believes to be.

use foxglove::messages::{FrameTransform, FrameTransforms, PoseInFrame, Vector3};

use super::primitives::{pose, rotation, timestamp};
use crate::{Pose, Time};

/// The frame of everything that stands still.
pub(super) const WORLD: &str = "world";
/// The frame of a session's estimates.
pub(super) const ODOM: &str = "odom";
/// The robot.
pub(super) const BASE: &str = "base_link";
/// The robot as it believes to be.
pub(super) const ESTIMATE: &str = "base_link_estimate";

/// All frames in one message: a viewer that seeks restores only the last one of a topic.
pub(super) fn transforms(at: Time, robot: Option<Pose>, estimate: Option<Pose>) -> FrameTransforms {
    let still = Some((WORLD, ODOM, Pose::default()));
    let robot = robot.map(|pose| (WORLD, BASE, pose));
    let estimate = estimate.map(|pose| (ODOM, ESTIMATE, pose));
    let transforms = [still, robot, estimate].into_iter().flatten();
    FrameTransforms {
        transforms: transforms
            .map(|(parent, child, pose)| FrameTransform {
                timestamp: Some(timestamp(at)),
                parent_frame_id: parent.to_owned(),
                child_frame_id: child.to_owned(),
                translation: Some(Vector3 { x: pose.x_m, y: pose.y_m, z: 0.0 }),
                rotation: Some(rotation(pose.theta_rad)),
            })
            .collect(),
    }
}

/// One pose in a frame.
pub(super) fn pose_in(frame: &str, at: Time, planar: &Pose) -> PoseInFrame {
    PoseInFrame {
        timestamp: Some(timestamp(at)),
        frame_id: frame.to_owned(),
        pose: Some(pose(planar, 0.0)),
    }
}
