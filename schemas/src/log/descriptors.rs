//! The schema records of our channels: self-contained protobuf descriptor sets.

use foxglove::Encode;
use foxglove::messages::{FrameTransforms, Grid, Log, PoseInFrame, SceneUpdate};
use prost::Message;
use prost_types::FileDescriptorSet;

use super::Topic;

/// Every file of `proto/tandem/v1` as an encoded `FileDescriptorSet`: comments stripped, imports before
/// their users. For programs that read logs without the `.proto` files.
pub const DESCRIPTORS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/tandem.v1.fds"));

/// The descriptor set for a topic's message: the file that defines it and all that it imports.
pub(crate) fn schema_data(topic: Topic) -> Vec<u8> {
    match topic {
        Topic::Tf => foxglove_schema::<FrameTransforms>(),
        Topic::Pose | Topic::PoseTruth => foxglove_schema::<PoseInFrame>(),
        Topic::Scene => foxglove_schema::<SceneUpdate>(),
        Topic::Log => foxglove_schema::<Log>(),
        Topic::Map => foxglove_schema::<Grid>(),
        _ => tandem_schema(topic.info().schema),
    }
}

fn foxglove_schema<T: Encode>() -> Vec<u8> {
    T::get_schema().map(|schema| schema.data.into_owned()).unwrap_or_default()
}

fn tandem_schema(message: &str) -> Vec<u8> {
    let all = FileDescriptorSet::decode(DESCRIPTORS).expect("the build wrote this descriptor set");
    let defines = |file: &&prost_types::FileDescriptorProto| {
        file.message_type.iter().any(|m| format!("{}.{}", file.package(), m.name()) == message)
    };
    let root = all.file.iter().find(defines).map(|file| file.name().to_owned());

    // Imports stand before their users, so one walk from the back finds the whole closure.
    let mut wanted: Vec<String> = root.into_iter().collect();
    let mut needed = FileDescriptorSet::default();
    for file in all.file.iter().rev() {
        if wanted.iter().any(|name| name == file.name()) {
            wanted.extend(file.dependency.iter().cloned());
            needed.file.insert(0, file.clone());
        }
    }
    needed.encode_to_vec()
}
