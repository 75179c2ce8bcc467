//! Two streams of events, matched and compared as they come.

use schemas::{Event, Node, Stamped, Time};
use serde::{Deserialize, Serialize};

use super::cause::{Candidate, First, FirstCause, sentence};
use super::field::{FieldDifference, Row, command_rows, step_rows, unit_of_law};
use super::lacking::Lacking;
use super::lag::Lag;
use super::reading::{Cell, Reading};
use super::side::{COMMAND, End, Next, STEP, Side};
use super::tolerance::{Tolerance, Tolerances};
use crate::CompareError;

/// How much was compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Compared {
    /// Steps that both runs have.
    pub steps: u64,
    /// Steps and commands that both runs have.
    pub messages: u64,
    /// Those of them that differ.
    pub differing: u64,
}

/// Where two runs differ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diff {
    /// Whether no compared field differs by more than its tolerance and no message is missing, to the end of
    /// both runs.
    pub same: bool,
    /// Whether both runs were read to their end. Otherwise they were compared as far as both go, and nothing
    /// is known of the rest.
    pub whole: bool,
    /// The same but for the controllers' hidden state (`state_hash`): nothing that either run
    /// says, asks for or commands differs, to the end of both.
    pub same_behaviour: bool,
    /// How much was compared.
    pub compared: Compared,
    /// The fields that differ, in the order of the data flow.
    pub fields: Vec<FieldDifference>,
    /// What differed first.
    pub first_cause: Option<FirstCause>,
}

/// What is compared of one topic, and what came of it.
struct Topic {
    rows: Vec<Row>,
    tolerances: Vec<Option<Tolerance>>,
    found: Vec<Option<FieldDifference>>,
    lags: Vec<Lag>,
    lacking: Lacking,
    only: [Option<FieldDifference>; 2],
    only_names: [&'static str; 2],
    node: Node,
    /// Position of the first row among all rows.
    first_order: usize,
    /// Which cell holds the reason that the controller gives.
    reason: Option<usize>,
}

impl Topic {
    fn new(
        rows: Vec<Row>,
        tolerances: &Tolerances,
        only_names: [&'static str; 2],
        node: Node,
        first_order: usize,
    ) -> Topic {
        Topic {
            tolerances: rows.iter().map(|row| tolerances.of(row)).collect(),
            found: rows.iter().map(|_| None).collect(),
            lags: rows.iter().map(Lag::of).collect(),
            lacking: Lacking::default(),
            reason: rows.iter().position(|row| row.name == "reason"),
            rows,
            only: [None, None],
            only_names,
            node,
            first_order,
        }
    }
}

/// Compares two runs event by event.
///
/// Feed both sides in turn, so that little has to wait; [`diff`] does that. Events other than
/// steps and commands are passed over.
pub struct Differ {
    sides: [Side; 2],
    topics: [Topic; 2],
    compared: Compared,
    first: First,
}

impl std::fmt::Debug for Differ {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Differ").field("compared", &self.compared).finish_non_exhaustive()
    }
}

fn seconds(key: i128) -> f64 {
    key as f64 / schemas::NS_PER_S as f64
}

impl Differ {
    /// A comparison of two runs that started at these instants (`Header.run.start`).
    pub fn new(tolerances: &Tolerances, start_a: Time, start_b: Time) -> Differ {
        let steps = step_rows();
        // A missing message comes before the fields of its topic, hence the gaps of one.
        let commands_from = steps.len() + 2;
        Differ {
            sides: [
                Side { start: start_a, ..Side::default() },
                Side { start: start_b, ..Side::default() },
            ],
            topics: [
                Topic::new(
                    steps,
                    tolerances,
                    ["steps_only_in_a", "steps_only_in_b"],
                    Node::Input,
                    1,
                ),
                Topic::new(
                    command_rows(),
                    tolerances,
                    ["commands_only_in_a", "commands_only_in_b"],
                    Node::Command,
                    commands_from,
                ),
            ],
            compared: Compared::default(),
            first: First::default(),
        }
    }

    /// Takes in the next event of the first run.
    pub fn a(&mut self, event: &Stamped<Event>) {
        self.hear(0, event);
    }

    /// Takes in the next event of the second run.
    pub fn b(&mut self, event: &Stamped<Event>) {
        self.hear(1, event);
    }

    fn hear(&mut self, side: usize, event: &Stamped<Event>) {
        let Some(topic) = self.sides[side].push(event) else { return };
        if let Some(message) = self.sides[side].queues[topic].back() {
            let has = message.cells.iter().map(|cell| !cell.is_absent());
            self.topics[topic].lacking.hear(side, has);
        }
        self.match_waiting();
    }

    /// Ends both runs.
    ///
    /// # Errors
    /// [`CompareError::NothingToDiff`] when neither run had a step or a command.
    pub fn finish(mut self) -> Result<Diff, CompareError> {
        self.sides.iter_mut().for_each(|side| {
            side.end.get_or_insert(End::Whole);
        });
        self.match_waiting();
        let mut fields = Vec::new();
        for mut topic in self.topics {
            let lacking = std::mem::take(&mut topic.lacking);
            self.compared.differing += lacking.settle(&mut topic.found, &mut self.first);
            fields.extend(topic.only.into_iter().flatten());
            fields.extend(topic.found.into_iter().zip(topic.lags).filter_map(|(found, lag)| {
                Some(FieldDifference { lag_steps: lag.steps(), ..found? })
            }));
        }
        if self.compared.messages == 0 && fields.is_empty() {
            return Err(CompareError::NothingToDiff);
        }
        let whole = self.sides.iter().all(|side| side.end != Some(End::Cut));
        let mut first_cause = self.first.cause();
        if let [Some(a), Some(b)] = self.sides.map(|side| side.accelerates)
            && a == b
        {
            // Which of the two units is known now.
            for field in &mut fields {
                field.unit = unit_of_law(&field.unit, a).to_owned();
            }
            if let Some(cause) = &mut first_cause {
                cause.take_law(a);
            }
        }
        Ok(Diff {
            same: whole && fields.is_empty(),
            whole,
            same_behaviour: whole && fields.iter().all(|field| field.field == "state_hash"),
            compared: self.compared,
            fields,
            first_cause,
        })
    }

    /// Nothing follows on one side: what waits for it waits in vain.
    fn end(&mut self, side: usize, end: End) {
        self.sides[side].end = Some(end);
        self.match_waiting();
    }

    fn match_waiting(&mut self) {
        for topic in [STEP, COMMAND] {
            loop {
                let [a, b] = &self.sides;
                let ended = [a.end, b.end];
                let keys = [&a.queues[topic], &b.queues[topic]].map(|q| q.front().map(|m| m.key));
                match keys {
                    [Some(a), Some(b)] if a == b => self.compare(topic),
                    [Some(a), Some(b)] => self.only(topic, usize::from(b < a)),
                    [Some(_), None] if ended[1] == Some(End::Whole) => self.only(topic, 0),
                    [None, Some(_)] if ended[0] == Some(End::Whole) => self.only(topic, 1),
                    // Nobody knows whether the other run has it.
                    [Some(_), None] if ended[1].is_some() => self.sides[0].queues[topic].clear(),
                    [None, Some(_)] if ended[0].is_some() => self.sides[1].queues[topic].clear(),
                    _ => break,
                }
            }
        }
    }

    /// Takes the next message of a topic from both sides and compares them.
    fn compare(&mut self, topic_index: usize) {
        let [a, b] = &mut self.sides;
        let queues = (&mut a.queues[topic_index], &mut b.queues[topic_index]);
        let (Some(a), Some(b)) = (queues.0.pop_front(), queues.1.pop_front()) else { return };
        self.compared.messages += 1;
        if topic_index == STEP {
            self.compared.steps += 1;
        }
        let t_s = seconds(a.key);
        let topic = &mut self.topics[topic_index];
        let mut differs = false;
        let mut lacking = Vec::new();
        for (i, (&cell_a, &cell_b)) in a.cells.iter().zip(&b.cells).enumerate() {
            let Some(tolerance) = topic.tolerances[i] else { continue };
            if let (Cell::Number(a), Cell::Number(b)) = (cell_a, cell_b)
                && topic.rows[i].node >= Node::Law
            {
                topic.lags[i].pair(a, b);
            }
            if tolerance.same(&topic.rows[i], cell_a, cell_b) {
                continue;
            }
            let row = &topic.rows[i];
            let difference = || FieldDifference::of(row, t_s, tolerance);
            let order = topic.first_order + i;
            let first = || {
                let said = topic.reason.and_then(|r| match (a.cells[r], b.cells[r]) {
                    (Cell::Name(a), Cell::Name(b)) => Some((a, b)),
                    _ => None,
                });
                candidate(a.key, order, row, (cell_a, cell_b), said)
            };
            if cell_a.is_absent() || cell_b.is_absent() {
                topic.lacking.add(i, t_s, difference, first);
                lacking.push(i);
                continue;
            }
            differs = true;
            topic.found[i].get_or_insert_with(difference).add(t_s, row, cell_a, cell_b);
            if self.first.is_beaten_by(a.key, row, order) {
                self.first.take(first());
            }
        }
        if differs {
            self.compared.differing += 1;
        } else {
            topic.lacking.message(lacking);
        }
    }

    /// Takes the next message of a topic from one side: the other side does not have it.
    fn only(&mut self, topic_index: usize, side: usize) {
        let Some(message) = self.sides[side].queues[topic_index].pop_front() else { return };
        let t_s = seconds(message.key);
        let topic = &mut self.topics[topic_index];
        let name = topic.only_names[side];
        let difference = topic.only[side].get_or_insert_with(|| {
            FieldDifference::new(name, topic.node, "messages", t_s, Tolerance::default())
        });
        difference.count += 1;
        difference.first_at_s = difference.first_at_s.min(t_s);
        let row = Row {
            name: name.to_owned(),
            node: topic.node,
            unit: String::new(),
            hidden_state: false,
            direction: false,
        };
        let order = topic.first_order - 1;
        if self.first.is_beaten_by(message.key, &row, order) {
            let there = (Cell::Flag(side == 0), Cell::Flag(side == 1));
            let mut candidate = candidate(message.key, order, &row, there, None);
            let what = if topic_index == STEP { "step" } else { "command" };
            let (has, lacks) = if side == 0 { ("A", "B") } else { ("B", "A") };
            candidate.cause.reason =
                format!("at {t_s:.3} s {has} has a {what} that {lacks} does not have");
            self.first.take(candidate);
        }
    }
}

fn candidate(
    key: i128,
    order: usize,
    row: &Row,
    (a, b): (Cell, Cell),
    said: Option<(&str, &str)>,
) -> Candidate {
    let t_s = seconds(key);
    let (a, b): (Reading, Reading) = (a.reading(), b.reading());
    let reason = sentence(t_s, row, (&a, &b), said);
    let cause = FirstCause {
        t_s,
        node: row.node.name().to_owned(),
        field: row.name.clone(),
        unit: row.unit.clone(),
        a,
        b,
        reason,
    };
    Candidate { key, rank: row.rank(), order, hidden_state: row.hidden_state, cause }
}

/// Compares two runs, reading each no further ahead than the other.
///
/// `next_a` and `next_b` give the next event of their run, or [`Next`]: how it ends, `None` for its proper end.
///
/// # Errors
/// What reading gives, and [`CompareError::NothingToDiff`].
pub fn diff<E: From<CompareError>, N: Into<Next>>(
    tolerances: &Tolerances,
    (start_a, mut next_a): (Time, impl FnMut() -> Result<N, E>),
    (start_b, mut next_b): (Time, impl FnMut() -> Result<N, E>),
) -> Result<Diff, E> {
    let mut differ = Differ::new(tolerances, start_a, start_b);
    loop {
        let [a, b] = &differ.sides;
        let (next, side) = match (a.end, b.end) {
            (Some(_), Some(_)) => return Ok(differ.finish()?),
            (None, None) if a.waiting() <= b.waiting() => (next_a()?, 0),
            (None, Some(_)) => (next_a()?, 0),
            _ => (next_b()?, 1),
        };
        match (next.into(), side) {
            (Next::Event(event), 0) => differ.a(&event),
            (Next::Event(event), _) => differ.b(&event),
            (Next::End, side) => differ.end(side, End::Whole),
            (Next::Cut, side) => differ.end(side, End::Cut),
        }
    }
}
