//! The simulated counterpart of a session: world, plant, sensors with seeded noise, and scripted
//! people, stepped as one pull source.
//!
//! - In: a [`schemas::Scenario`] (built in, see [`scenarios`], made from a number, or read from a
//!   file), a noise seed, and the commands of whoever drives.
//! - Out: the session's events in log order, through [`schemas::Source`].
//!
//! Recording and closed-loop replay use the same [`Simulation`]; they differ in the [`Human`] that
//! they give it. Everything is a function of scenario, seed and commands alone: no clock, no
//! environment, no global randomness.

mod error;
mod heading;
mod human;
mod noise;
mod plant;
mod scenario;
mod sensors;
mod simulation;

pub use error::SimulatorError;
pub use human::{Human, HumanView, Request, driver};
pub use noise::{Purpose, Reading, Stream};
pub use scenario::{scenario, scenarios};
pub use sensors::{EARTH_FIELD_UT, GRAVITY_MPS2, SONAR_CONE_HALF_DEG};
pub use simulation::{JOYSTICK_PERIOD, Simulation, SimulationSetup};
