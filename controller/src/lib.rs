//! The shared controller of a mobile robot: estimation, perception, reference, feedback law,
//! sharing and safety layer, and the [`Runner`] that latches inputs and steps them.
//!
//! In: samples of sensors and joystick, and the instants at which to step. Out: at each step a
//! command and a [`schemas::Step`] that explains it. No I/O, no clock, no randomness: the same
//! inputs give the same bits on every machine.

mod digest;
pub mod estimation;
pub mod frame;
pub mod law;
mod mutation;
mod params;
pub mod perception;
pub mod plan;
mod runner;
pub mod safety;
mod session;
pub mod sharing;
pub mod side;
mod spec;
pub mod target;
pub mod travel;
mod version;
pub mod wanted;

pub use mutation::Mutation;
pub use params::{Allowed, Parameter, Params, Setting};
pub use runner::{Look, Outcome, Ray, Runner, Setup, Shielded};
pub use session::Session;
pub use spec::{Law, Spec, SpecError};
pub use version::{Version, versions};
