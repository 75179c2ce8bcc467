//! Contract of the session log: what is written is what is read, and damage is named, never passed
//! over and never a panic.

mod damage;
mod foreign;
mod round_trip;
pub(crate) mod session;
mod side_by_side;
mod streaming;
