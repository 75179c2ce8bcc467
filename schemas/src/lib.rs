//! The vocabulary of Tandem.
//!
//! - Plain domain types with units in their names: what sensors say ([`Sample`]), what a controller
//!   does ([`Step`], [`Command`]), what really happened ([`Truth`]), where ([`World`]) and under
//!   which circumstances ([`Scenario`]).
//! - The protobuf schemas `tandem/v1/*.proto` behind them, which no other crate sees.
//! - The session log: typed events written to and read from MCAP files.
//!
//! Frames follow REP 103 (x forward, y left, counter-clockwise positive); SI units throughout.

mod angle;
mod command;
mod event;
mod explored;
mod gap;
pub mod log;
mod motion;
mod robot;
mod run;
mod sample;
mod scenario;
mod step;
mod time;
mod timing;
mod truth;
pub mod view;
mod wire;
mod world;

pub use angle::wrap;
pub use command::Command;
pub use event::{Event, Pulled, Source};
pub use explored::{Cell, Explored};
pub use gap::Gap;
pub use motion::{Pose, Twist};
pub use robot::{Footprint, SONAR_BLIND_M, SONAR_REACH_M, SONARS, SonarMount};
pub use run::{FORMAT_VERSION, Header, RunInfo};
pub use sample::{
    EncoderSample, ExactPose, ImuSample, JoystickSample, Sample, SonarEcho, SonarScan,
};
pub use scenario::{
    Driver, EncoderNoise, GoalDriver, GyroBiasStep, ImuNoise, JoystickNoise, Noise, Overrides,
    Person, Plant, Robot, Scenario, ScenarioError, SensorSuite, SlipBurst, SonarNoise, Start,
    Stroke, Task,
};
pub use step::{
    EstimatorStatus, Field, FrameSource, Lacking, LawBranch, Node, Reason, ReferenceSource, Region,
    Step, Value,
};
pub use time::{NS_PER_S, SIMULATION_EPOCH, Span, Stamped, Time};
pub use timing::Timing;
pub use truth::{Disc, Truth};
pub use world::{Body, HalfPlane, MovingDisc, NearestFace, Obstacle, WalkedPath, World};

/// Types generated from `proto/tandem/v1`.
#[expect(clippy::pedantic, reason = "generated code")]
pub(crate) mod proto {
    include!(concat!(env!("OUT_DIR"), "/tandem.v1.rs"));
}
