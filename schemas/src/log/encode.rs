//! Events to bytes and back.

use prost::Message;

use super::Topic;
use super::quick;
use crate::{
    Command, EncoderSample, Event, ExactPose, Gap, ImuSample, JoystickSample, Sample, SonarScan,
    Step, Timing, Truth, proto,
};

/// Turns events into the bytes that a log holds, reusing one buffer.
///
/// The bytes are canonical: equal events give equal bytes, every NaN is the same NaN, and there is
/// no negative zero. Writing a log and hashing a run go by them alike.
#[derive(Clone, Debug, Default)]
pub struct Encoder {
    buffer: Vec<u8>,
}

impl Encoder {
    /// An encoder with an empty buffer.
    pub fn new() -> Encoder {
        Encoder::default()
    }

    /// Topic and bytes of an event.
    pub fn encode(&mut self, event: &Event) -> (&'static str, &[u8]) {
        self.buffer.clear();
        match event {
            Event::Sample(Sample::Sonar(scan)) => self.put(&proto::SonarScan::from(scan)),
            Event::Sample(Sample::Imu(imu)) => self.put(&proto::ImuSample::from(imu)),
            Event::Sample(Sample::Encoders(encoders)) => {
                self.put(&proto::EncoderSample::from(encoders));
            }
            Event::Sample(Sample::Joystick(joystick)) => {
                self.put(&proto::JoystickSample::from(joystick));
            }
            Event::Sample(Sample::Exact(exact)) => self.put(&proto::ExactPose::from(exact)),
            Event::Truth(truth) => self.put(&proto::Truth::from(truth)),
            Event::Step(step) => self.put(&proto::Step::from(&**step)),
            Event::Command(command) => self.put(&proto::Command::from(command)),
            Event::Gap(gap) => self.put(&proto::Gap::from(gap)),
            Event::Timing(timing) => self.put(&proto::Timing::from(timing)),
        }
        (Topic::of(event).name(), &self.buffer)
    }

    fn put(&mut self, message: &impl Message) {
        message.encode(&mut self.buffer).expect("a vector has room for every message");
    }
}

/// The event that a message of `topic` holds; `None` for a topic that only viewers read.
pub(super) fn decode(topic: Topic, data: &[u8]) -> Result<Option<Event>, prost::DecodeError> {
    match quick::decode(topic, data) {
        Some(event) => Ok(Some(event)),
        None => decode_generally(topic, data),
    }
}

/// The same for whatever protobuf allows.
pub(super) fn decode_generally(
    topic: Topic,
    data: &[u8],
) -> Result<Option<Event>, prost::DecodeError> {
    Ok(Some(match topic {
        Topic::Sonar => {
            Event::Sample(Sample::Sonar(SonarScan::from(proto::SonarScan::decode(data)?)))
        }
        Topic::Imu => Event::Sample(Sample::Imu(ImuSample::from(proto::ImuSample::decode(data)?))),
        Topic::Encoders => Event::Sample(Sample::Encoders(EncoderSample::from(
            proto::EncoderSample::decode(data)?,
        ))),
        Topic::Joystick => Event::Sample(Sample::Joystick(JoystickSample::from(
            proto::JoystickSample::decode(data)?,
        ))),
        Topic::Exact => {
            Event::Sample(Sample::Exact(ExactPose::from(proto::ExactPose::decode(data)?)))
        }
        Topic::Truth => Event::Truth(Truth::from(proto::Truth::decode(data)?)),
        Topic::Step => Event::Step(Box::new(Step::from(proto::Step::decode(data)?))),
        Topic::Command => Event::Command(Command::from(proto::Command::decode(data)?)),
        Topic::Gap => Event::Gap(Gap::from(proto::Gap::decode(data)?)),
        Topic::Timing => Event::Timing(Timing::from(proto::Timing::decode(data)?)),
        Topic::Tf | Topic::Pose | Topic::PoseTruth | Topic::Scene | Topic::Log | Topic::Map => {
            return Ok(None);
        }
    }))
}
