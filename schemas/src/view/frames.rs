//! Frames and poses: `/tf`, `/pose`, `/pose_truth`.
//!
//! `world` holds everything. `base_link` is the robot where it really is, or where it believes to be
//! if that is all there is. `odom`, in which a session's estimates are given, starts at the scenario's
//! start pose and coincides with `world`; `base_link_estimate` is the robot where it believes to be.
//! Where two runs stand side by side, all but `world` are there twice, with `A/` and `B/` before them.

use foxglove::messages::{FrameTransform, FrameTransforms, PoseInFrame, Vector3};

use super::primitives::{pose, rotation, timestamp};
use crate::log::Arm;
use crate::{Pose, Time};

/// The frame of everything that stands still.
pub(super) const WORLD: &str = "world";
/// The frames of one run. Two runs side by side share the world, and nothing else.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frames {
    /// The frame of a session's estimates.
    pub(super) odom: &'static str,
    /// The robot.
    pub(super) base: &'static str,
    /// The robot as it believes to be.
    pub(super) estimate: &'static str,
}

impl Frames {
    pub(super) fn of(arm: Option<Arm>) -> Frames {
        let [odom, base, estimate] = match arm {
            None => ["odom", "base_link", "base_link_estimate"],
            Some(Arm::A) => ["A/odom", "A/base_link", "A/base_link_estimate"],
            Some(Arm::B) => ["B/odom", "B/base_link", "B/base_link_estimate"],
        };
        Frames { odom, base, estimate }
    }

    /// All frames in one message: a viewer that seeks restores only the last one of a topic.
    pub(super) fn transforms(
        &self,
        at: Time,
        robot: Option<Pose>,
        estimate: Option<Pose>,
    ) -> FrameTransforms {
        let still = Some((WORLD, self.odom, Pose::default()));
        let robot = robot.map(|pose| (WORLD, self.base, pose));
        let estimate = estimate.map(|pose| (self.odom, self.estimate, pose));
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
}

/// One pose in a frame.
pub(super) fn pose_in(frame: &str, at: Time, planar: &Pose) -> PoseInFrame {
    PoseInFrame {
        timestamp: Some(timestamp(at)),
        frame_id: frame.to_owned(),
        pose: Some(pose(planar, 0.0)),
    }
}
