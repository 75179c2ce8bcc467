//! Which of two runs that stand side by side in one file.

use super::Topic;

/// One of two runs of the same session in one log, under `/A` and `/B`.
///
/// In a replay's log A is the recording and B the replay; in a comparison's they are its arms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arm {
    /// Under `/A`.
    A,
    /// Under `/B`. Its head is the log's own: whoever knows of no arms reads this one.
    B,
}

impl Arm {
    /// The name: `A` or `B`.
    pub fn name(self) -> &'static str {
        match self {
            Arm::A => "A",
            Arm::B => "B",
        }
    }

    /// The name of one of its topics, e.g. `/A/step`.
    pub fn topic(self, topic: Topic) -> String {
        format!("/{}{}", self.name(), topic.name())
    }

    /// A topic's name as a file has it, taken apart; `None` where it is none of ours.
    pub(crate) fn split(name: &str) -> Option<(Option<Arm>, Topic)> {
        for arm in [Arm::A, Arm::B] {
            let rest = name.strip_prefix('/').and_then(|name| name.strip_prefix(arm.name()));
            if let Some(topic) = rest.and_then(Topic::from_name) {
                return Some((Some(arm), topic));
            }
        }
        Topic::from_name(name).map(|topic| (None, topic))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::TOPICS;

    #[test]
    fn every_topic_has_a_name_of_its_own_in_each_arm() {
        for topic in TOPICS.map(|info| info.topic) {
            assert_eq!(Arm::split(topic.name()), Some((None, topic)));
            for arm in [Arm::A, Arm::B] {
                assert_eq!(Arm::split(&arm.topic(topic)), Some((Some(arm), topic)));
            }
        }
        assert_eq!(Arm::A.topic(Topic::Step), "/A/step");
        for foreign in ["/A", "/C/step", "A/step", "/A//step", "/Astep", "/A/A/step"] {
            assert_eq!(Arm::split(foreign), None, "{foreign}");
        }
    }
}
