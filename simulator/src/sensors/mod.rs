//! What the robot's sensors would have said: each a function of the true motion and of its own
//! noise.

mod cone;
mod encoders;
mod exact;
mod imu;
mod sonar;

pub use cone::SONAR_CONE_HALF_DEG;
pub(crate) use encoders::Encoders;
pub(crate) use exact::exact_pose;
pub(crate) use imu::Imu;
pub use imu::{EARTH_FIELD_UT, GRAVITY_MPS2};
pub(crate) use sonar::Sonars;
