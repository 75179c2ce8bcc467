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
//! [`Event`]: crate::Event

mod bytes;
mod chunk;
mod descriptors;
mod encode;
mod error;
mod header;
mod info;
mod messages;
mod reader;
mod records;
mod topics;
mod writer;

#[cfg(test)]
pub(crate) mod tests;

pub use descriptors::DESCRIPTORS;
#[cfg(test)]
pub(crate) use descriptors::schema_data;
pub use encode::Encoder;
pub use error::LogError;
pub use info::{ChannelInfo, GapInfo, LogInfo, inspect};
pub use reader::LogReader;
pub use topics::{Compared, TOPICS, Topic, TopicInfo};
pub use writer::{LogWriter, Sink, Summary, WriterOptions, create};
