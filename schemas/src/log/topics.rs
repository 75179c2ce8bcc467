//! The topics of a session log, in one table.

use crate::{Event, Sample, Time};

/// A topic of the session log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Topic {
    /// `/sonar`
    Sonar,
    /// `/imu`
    Imu,
    /// `/encoders`
    Encoders,
    /// `/joystick`
    Joystick,
    /// `/exact`
    Exact,
    /// `/truth`
    Truth,
    /// `/step`
    Step,
    /// `/command`
    Command,
    /// `/gap`
    Gap,
    /// `/timing`
    Timing,
    /// `/tf`
    Tf,
    /// `/pose`
    Pose,
    /// `/pose_truth`
    PoseTruth,
    /// `/scene`
    Scene,
    /// `/log`
    Log,
    /// `/map`
    Map,
}

/// When a topic's messages count in the comparison of two runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compared {
    /// In every replay.
    Always,
    /// Only in closed loop, where the replay makes them anew.
    ClosedLoop,
    /// Never: measured by a clock, or made from the others.
    Never,
}

impl Compared {
    /// The name in lists and machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Compared::Always => "always",
            Compared::ClosedLoop => "closed",
            Compared::Never => "never",
        }
    }
}

/// What is to be known about a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TopicInfo {
    /// Which one it is.
    pub topic: Topic,
    /// Its name in the log.
    pub name: &'static str,
    /// Fully qualified name of its protobuf message.
    pub schema: &'static str,
    /// How often it appears.
    pub rate: &'static str,
    /// Whether it counts in a comparison.
    pub compared: Compared,
    /// Whether it only exists for viewers, made from the other topics.
    pub view: bool,
    /// One line for a list.
    pub summary: &'static str,
}

const fn row(
    topic: Topic,
    name: &'static str,
    schema: &'static str,
    rate: &'static str,
    compared: Compared,
    summary: &'static str,
) -> TopicInfo {
    let view = matches!(
        topic,
        Topic::Tf | Topic::Pose | Topic::PoseTruth | Topic::Scene | Topic::Log | Topic::Map
    );
    TopicInfo { topic, name, schema, rate, compared, view, summary }
}

/// Every topic, in the order of [`Topic`].
#[rustfmt::skip]
pub const TOPICS: [TopicInfo; 16] = {
    use Compared::{Always, ClosedLoop, Never};
    [
        row(Topic::Sonar, "/sonar", "tandem.v1.SonarScan", "25 Hz", ClosedLoop, "fresh sonar readings, each with its firing time"),
        row(Topic::Imu, "/imu", "tandem.v1.ImuSample", "100 Hz", ClosedLoop, "specific force, turn rate and magnetic field in the body frame"),
        row(Topic::Encoders, "/encoders", "tandem.v1.EncoderSample", "50 Hz", ClosedLoop, "travel and speed of the left and right wheels"),
        row(Topic::Joystick, "/joystick", "tandem.v1.JoystickSample", "50 Hz", ClosedLoop, "velocities that the person asks for"),
        row(Topic::Exact, "/exact", "tandem.v1.ExactPose", "control period", ClosedLoop, "true pose and speeds, from which a controller casts exact rays"),
        row(Topic::Truth, "/truth", "tandem.v1.Truth", "50 Hz", ClosedLoop, "what really happened (simulation only; no controller reads it)"),
        row(Topic::Step, "/step", "tandem.v1.Step", "control period", Always, "every quantity of one controller step"),
        row(Topic::Command, "/command", "tandem.v1.Command", "control period", Always, "what went to the actuators"),
        row(Topic::Gap, "/gap", "tandem.v1.Gap", "events", Never, "stretches without a stream that should have been there (not recorded yet)"),
        row(Topic::Timing, "/timing", "tandem.v1.Timing", "control period", Never, "measured wall time of each step (not recorded yet)"),
        row(Topic::Tf, "/tf", "foxglove.FrameTransforms", "10 Hz", Never, "frames of robot and odometry, for viewers"),
        row(Topic::Pose, "/pose", "foxglove.PoseInFrame", "10 Hz", Never, "estimated pose, for viewers"),
        row(Topic::PoseTruth, "/pose_truth", "foxglove.PoseInFrame", "10 Hz", Never, "true pose, for viewers"),
        row(Topic::Scene, "/scene", "foxglove.SceneUpdate", "10 Hz", Never, "room, robot, sonar cones and reference, for viewers"),
        row(Topic::Log, "/log", "foxglove.Log", "events", Never, "who drives from now on and why, for viewers"),
        row(Topic::Map, "/map", "foxglove.Grid", "once", Never, "what is known of a room that was mapped from a log, for viewers"),
    ]
};

impl Topic {
    /// The topic that an event is written to.
    pub fn of(event: &Event) -> Topic {
        match event {
            Event::Sample(Sample::Sonar(_)) => Topic::Sonar,
            Event::Sample(Sample::Imu(_)) => Topic::Imu,
            Event::Sample(Sample::Encoders(_)) => Topic::Encoders,
            Event::Sample(Sample::Joystick(_)) => Topic::Joystick,
            Event::Sample(Sample::Exact(_)) => Topic::Exact,
            Event::Truth(_) => Topic::Truth,
            Event::Step(_) => Topic::Step,
            Event::Command(_) => Topic::Command,
            Event::Gap(_) => Topic::Gap,
            Event::Timing(_) => Topic::Timing,
        }
    }

    /// The topic of this name, if it is one of ours.
    pub fn from_name(name: &str) -> Option<Topic> {
        TOPICS.iter().find(|info| info.name == name).map(|info| info.topic)
    }

    /// Its row in [`TOPICS`].
    pub fn info(self) -> &'static TopicInfo {
        &TOPICS[self as usize]
    }

    /// Its name in the log.
    pub fn name(self) -> &'static str {
        self.info().name
    }
}

/// The time stamp that an event carries in its payload.
pub(super) fn payload_stamp(event: &Event) -> Time {
    match event {
        Event::Sample(sample) => sample.stamp(),
        Event::Truth(truth) => truth.stamp,
        Event::Step(step) => step.stamp,
        Event::Command(command) => command.stamp,
        Event::Gap(gap) => gap.stamp,
        Event::Timing(timing) => timing.stamp,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_at_their_topics_index() {
        for (index, info) in TOPICS.iter().enumerate() {
            assert_eq!(info.topic as usize, index, "{}", info.name);
            assert_eq!(Topic::from_name(info.name), Some(info.topic));
            assert!(!info.view || info.compared == Compared::Never, "{}", info.name);
        }
        assert_eq!(Topic::from_name("/nosuch"), None);
    }
}
