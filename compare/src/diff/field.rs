//! The rows of a diff: one per comparable component of a step or a command.

use schemas::{Node, Pose, Step, Time, Value, wrap};
use serde::{Deserialize, Serialize};

use super::reading::Cell;
use super::tolerance::Tolerance;

/// What is to be known about one row.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) name: String,
    pub(super) node: Node,
    pub(super) unit: String,
    /// A fingerprint of what other rows show or of what no row shows: never the first cause while
    /// a quantity can be it.
    pub(super) hidden_state: bool,
    /// A direction, which is the same after a whole turn.
    pub(super) direction: bool,
}

/// What the target is told by. It follows from request and estimate alone, and the frame in which
/// distances are measured follows from it.
const TARGET: [&str; 5] =
    ["reference_source", "target_x_m", "target_y_m", "target_vx_mps", "target_vy_mps"];

impl Row {
    /// How far two numbers of this row are apart, directions the short way round.
    pub(super) fn apart(&self, a: f64, b: f64) -> f64 {
        apart(self.direction, a, b)
    }

    /// Whether it tells of the target.
    pub(super) fn is_target(&self) -> bool {
        TARGET.contains(&self.name.as_str())
    }

    /// Where it stands among causes: by its stage, but for the target, which the distances follow from.
    pub(super) fn rank(&self) -> (Node, bool) {
        if self.is_target() { (Node::Estimate, true) } else { (self.node, false) }
    }
}

/// How far two numbers are apart, directions the short way round.
pub(super) fn apart(direction: bool, a: f64, b: f64) -> f64 {
    let off = a - b;
    // Infinities have no direction.
    libm::fabs(if direction && off.is_finite() { wrap(off) } else { off })
}

/// Of a unit that depends on the law, `m/s or m/s²`, the one for velocities or for accelerations; any
/// other unit as it is.
pub fn unit_of_law(unit: &str, accelerates: bool) -> &str {
    match unit.split_once(" or ") {
        None => unit,
        Some((velocity, acceleration)) => {
            if accelerates {
                acceleration
            } else {
                velocity
            }
        }
    }
}

/// The rows of a step: its index, then every field's components in causal order.
pub(super) fn step_rows() -> Vec<Row> {
    // The values of any step tell which fields have several components.
    let values = Step::unknown(Time(0), 0).values();
    let mut rows = vec![row("step_index", Node::Input, "")];
    for (field, value) in Step::FIELDS.iter().zip(values) {
        let mut units = field.unit.split(", ");
        let mut unit = || units.next().unwrap_or(field.unit);
        match value {
            Value::Pair(_) => {
                for part in ["[0]", "[1]"] {
                    rows.push(row(&format!("{}{part}", field.name), field.node, unit()));
                }
            }
            Value::Pose(Pose { .. }) => {
                for part in ["x_m", "y_m", "theta_rad"] {
                    let row = row(&format!("{}.{part}", field.name), field.node, unit());
                    rows.push(Row { direction: part == "theta_rad", ..row });
                }
            }
            _ => rows.push(Row {
                direction: field.is_direction(),
                ..row(field.name, field.node, field.unit)
            }),
        }
    }
    rows
}

/// The rows of a command.
pub(super) fn command_rows() -> Vec<Row> {
    [
        ("command.v_mps", "m/s"),
        ("command.omega_radps", "rad/s"),
        ("command.accel_mps2", "m/s²"),
        ("command.alpha_radps2", "rad/s²"),
    ]
    .map(|(name, unit)| row(name, Node::Command, unit))
    .to_vec()
}

fn row(name: &str, node: Node, unit: &str) -> Row {
    Row {
        name: name.to_owned(),
        node,
        unit: unit.to_owned(),
        hidden_state: name == "state_hash",
        direction: false,
    }
}

/// How one field differs between two runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldDifference {
    /// The field, or `steps_only_in_a`, `steps_only_in_b`, `commands_only_in_a`,
    /// `commands_only_in_b` for messages that the other run does not have.
    pub field: String,
    /// Stage of the data flow.
    pub node: String,
    /// Unit; empty without one.
    pub unit: String,
    /// Largest |a − b|, of directions the short way round, over the messages that differ; `None` where no
    /// difference is a finite number (a name, a hash, a number against NaN).
    pub max_abs: Option<f64>,
    /// When that was, seconds from the start.
    pub max_abs_at_s: Option<f64>,
    /// Largest |a − b| / max(|a|, |b|) likewise.
    pub max_rel: Option<f64>,
    /// When the field differed first, seconds from the start.
    pub first_at_s: f64,
    /// In how many messages it differs.
    pub count: u64,
    /// In how many of these only one of the runs has a number (the other NaN, or nothing there).
    pub undefined: u64,
    /// By how many steps the second run lags behind the first, negative where it leads; `None` where
    /// no shift of up to five steps explains at least nine tenths of the squared difference.
    pub lag_steps: Option<i32>,
    /// What was allowed.
    pub tolerance: Tolerance,
}

impl FieldDifference {
    /// None yet of a row.
    pub(super) fn of(row: &Row, t_s: f64, tolerance: Tolerance) -> Self {
        Self::new(&row.name, row.node, &row.unit, t_s, tolerance)
    }

    pub(super) fn new(name: &str, node: Node, unit: &str, t_s: f64, tolerance: Tolerance) -> Self {
        FieldDifference {
            field: name.to_owned(),
            node: node.name().to_owned(),
            unit: unit.to_owned(),
            max_abs: None,
            max_abs_at_s: None,
            max_rel: None,
            first_at_s: t_s,
            count: 0,
            undefined: 0,
            lag_steps: None,
            tolerance,
        }
    }

    /// Counts one more message in which the field differs.
    pub(super) fn add(&mut self, t_s: f64, row: &Row, a: Cell, b: Cell) {
        self.count += 1;
        self.first_at_s = self.first_at_s.min(t_s);
        let (a, b) = match (a, b) {
            (Cell::Number(a), Cell::Number(b)) => (a, b),
            (Cell::Integer(a), Cell::Integer(b)) => (a as f64, b as f64),
            _ => return,
        };
        if a.is_nan() != b.is_nan() {
            self.undefined += 1;
        }
        let apart = row.apart(a, b);
        if !apart.is_finite() {
            return;
        }
        if self.max_abs.is_none_or(|most| apart > most) {
            self.max_abs = Some(apart);
            self.max_abs_at_s = Some(t_s);
        }
        // The larger of the two is not 0, since they differ.
        let relative = apart / libm::fabs(a).max(libm::fabs(b));
        if self.max_rel.is_none_or(|most| relative > most) {
            self.max_rel = Some(relative);
        }
    }

    /// Counts one more message in which one of the runs lacks the field.
    pub(super) fn count_lacking(&mut self, t_s: f64) {
        self.count += 1;
        self.undefined += 1;
        self.first_at_s = self.first_at_s.min(t_s);
    }

    /// Adds the messages of `lacking`, in which one of the runs lacks the field.
    pub(super) fn merge(&mut self, lacking: &FieldDifference) {
        self.count += lacking.count;
        self.undefined += lacking.undefined;
        self.first_at_s = self.first_at_s.min(lacking.first_at_s);
    }
}
