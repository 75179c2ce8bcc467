//! The session log: typed events written to and read from MCAP files.
//!
//! [`LogWriter`] takes [`Event`]s in the order of their log times and makes an MCAP file that any
//! viewer opens; [`LogReader`] gives the same events back. Both stream: memory follows one chunk,
//! not the file. [`Encoder`] gives the canonical bytes of an event, for hashing; [`inspect`] tells
//! what a log holds without replaying it; [`TOPICS`] lists what can be in one.
//!
//! A log carries at its head the metadata record `tandem.run` and the attachments `params.toml`,
//! `scenario.toml` and `layout.json`, so that it can be replayed and looked at without anything
//! but itself.
//!
//! Two runs of one session can stand side by side in a file, under `/A` and `/B`: [`write_ab`] makes
//! such a log, and [`LogReader::arm`] chooses between them.
//!
//! [`Event`]: crate::Event

mod arm;
mod bytes;
mod chunk;
mod descriptors;
mod encode;
mod error;
mod file;
mod header;
mod info;
mod messages;
mod quick;
mod reader;
mod records;
mod side_by_side;
mod topics;
mod writer;

#[cfg(test)]
pub(crate) mod tests;

pub use arm::Arm;
pub use descriptors::DESCRIPTORS;
#[cfg(test)]
pub(crate) use descriptors::schema_data;
pub use encode::Encoder;
pub use error::{LogError, Stop};
pub use info::{ChannelInfo, GapInfo, LogInfo, inspect};
pub use reader::LogReader;
pub use side_by_side::{SideBySide, WriteAbError, write_ab};
pub use topics::{Compared, TOPICS, Topic, TopicInfo};
pub use writer::{LogWriter, Sink, Summary, WriterOptions, create};
