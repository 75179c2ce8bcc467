//! What is to be known about the fields of a step.

use crate::Pose;

/// A stage of the controller's data flow. Ordered: an earlier node can be the cause of a later one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Node {
    /// What the controller was given.
    Input,
    /// What it believes about its own motion.
    Estimate,
    /// How far away things are.
    Distances,
    /// Where it should go.
    Reference,
    /// What the feedback law asks for.
    Law,
    /// Who drives.
    Sharing,
    /// What it commanded.
    Command,
}

impl Node {
    /// Every stage, in the order of the data flow.
    pub const ALL: [Node; 7] = [
        Node::Input,
        Node::Estimate,
        Node::Distances,
        Node::Reference,
        Node::Law,
        Node::Sharing,
        Node::Command,
    ];

    /// The name used in reports and machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Node::Input => "input",
            Node::Estimate => "estimate",
            Node::Distances => "distances",
            Node::Reference => "reference",
            Node::Law => "law",
            Node::Sharing => "sharing",
            Node::Command => "command",
        }
    }
}

/// What is to be known about one field of a [`Step`](super::Step).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name, with the unit as its suffix, as in the protobuf schema.
    pub name: &'static str,
    /// Stage of the data flow.
    pub node: Node,
    /// Unit; empty for numbers without one, names and hashes.
    pub unit: &'static str,
}

impl Field {
    /// Whether it is a direction, which is the same after a whole turn: in radians, and no standard
    /// deviation. Of a pose, the heading is one whatever this says of the whole.
    pub fn is_direction(&self) -> bool {
        self.unit == "rad" && !self.name.starts_with("sigma_")
    }
}

/// The value of one field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A measured or computed quantity; NaN where it is unknown.
    Number(f64),
    /// Two of them: (v, ω) or (acceleration, angular acceleration).
    Pair([f64; 2]),
    /// Position and heading.
    Pose(Pose),
    /// A count or a side; compared exactly.
    Integer(i64),
    /// A hash; compared exactly.
    Hash(u64),
    /// Yes or no.
    Flag(bool),
    /// One of a list of names.
    Name(&'static str),
    /// Nothing: the step does not have this field. A log from before it was recorded, or a controller
    /// that has nothing of the kind.
    Absent,
}
