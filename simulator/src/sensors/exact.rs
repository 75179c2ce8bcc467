//! The sensor of the suite `exact`: the truth, from which the controller casts its own rays.

use schemas::{ExactPose, Time};

use crate::plant::Plant;

pub(crate) fn exact_pose(stamp: Time, plant: &Plant) -> ExactPose {
    let twist = plant.twist();
    ExactPose { stamp, pose: plant.pose(), v_mps: twist.v_mps, omega_radps: twist.omega_radps }
}
