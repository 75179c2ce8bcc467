//! What came of a replay, counted while it runs.

use std::sync::Arc;

use schemas::log::LogError;
use schemas::{Event, Field, Stamped, Step, Time, Value, wrap};

use crate::{Covered, Fault, Horizon, OutputHash, ReplayError, WarmUp};

/// The largest difference between a replayed and a recorded step.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// Name of the field.
    pub field: &'static str,
    /// Absolute difference in the field's unit; +∞ where only one of the two is a number, or has the field.
    pub amount: f64,
    /// When, seconds from the start of the session.
    pub t_s: f64,
}

/// What came of a replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Steps replayed.
    pub steps: u64,
    /// Steps in which the feedback law drove (k = 0).
    pub engaged_steps: u64,
    /// Hash of the replayed messages.
    pub output_hash: String,
    /// Hash of the recorded ones.
    pub recorded_hash: String,
    /// Whether the two agree: every compared message is the recorded one, bit for bit.
    pub identical_to_recorded: bool,
    /// The largest difference from the recorded steps; `None` where no number differs.
    pub max_deviation: Option<Deviation>,
    /// Simulated or replayed time, seconds.
    pub duration_s: f64,
    /// The last thing that was replayed, seconds from the start of the session.
    pub end_s: f64,
    /// The faults that met nothing that they could change: the log has no such sensor, say.
    pub unmet_faults: Vec<Fault>,
    /// Where the log begins in the middle of its session: its first step, seconds from the session's start.
    /// What the controller had learnt until then is not in it.
    pub begins_late_s: Option<f64>,
    /// Why the replay ended before the log should have, where it did.
    pub damage: Option<String>,
    /// Closed loop: when the simulated run parted from the recorded one.
    pub horizon: Option<Horizon>,
    /// Closed loop: the greatest distance between simulated and recorded state, 1 at half a metre or
    /// one radian. 0 certifies that the person would have seen the same throughout.
    pub furthest: Option<f64>,
    /// Where only a part was replayed: whether its beginning is what the whole log gives.
    pub warm_up: Option<WarmUp>,
}

/// The running count behind an [`Outcome`].
pub(crate) struct Tally {
    start: Time,
    first: Option<Time>,
    last: Time,
    steps: u64,
    engaged_steps: u64,
    replayed: OutputHash,
    recorded: OutputHash,
    lacking: Lacking,
    /// Index and time of the first recorded step.
    begins: Option<(u64, f64)>,
    deviation: Option<Deviation>,
    pub(crate) damage: Option<Arc<LogError>>,
}

/// The fields that one of both lacks. Whether that is from before a field, or of another kind, or lost it in
/// some step, shows at the end only: until then both answers are kept.
struct Lacking {
    /// By field: whether a recorded step has it, and whether a replayed one does.
    had: [[bool; 2]; Step::FIELDS.len()],
    /// By field: when the one had it and the other did not, first, seconds from the start.
    apart_s: [Option<f64>; Step::FIELDS.len()],
    /// What was replayed with nothing left out of it, from where something is.
    whole: Option<OutputHash>,
}

const RECORDED: usize = 0;
const REPLAYED: usize = 1;

impl Lacking {
    fn new() -> Lacking {
        let fields = [[false; 2]; Step::FIELDS.len()];
        Lacking { had: fields, apart_s: [None; Step::FIELDS.len()], whole: None }
    }

    fn hear(&mut self, step: &Step, whose: usize) {
        for (had, value) in self.had.iter_mut().zip(step.values()) {
            had[whose] |= value != Value::Absent;
        }
    }

    /// The first step in which one lacks what both otherwise have, and what.
    fn lost(&self) -> Option<(f64, &'static str)> {
        let fields = Step::FIELDS.iter().zip(self.had).zip(self.apart_s);
        fields
            .filter_map(|((field, had), apart_s)| {
                Some((apart_s.filter(|_| had == [true; 2])?, field.name))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

impl Tally {
    pub(crate) fn new(covered: Covered, start: Time) -> Tally {
        Tally {
            start,
            first: None,
            last: start,
            steps: 0,
            engaged_steps: 0,
            replayed: OutputHash::new(covered, start),
            recorded: OutputHash::new(covered, start),
            lacking: Lacking::new(),
            begins: None,
            deviation: None,
            damage: None,
        }
    }

    /// Takes in a replayed event; `recorded` is the recorded step seen last.
    ///
    /// A field that the recording is too old to have is not held against the replay.
    pub(crate) fn replayed(&mut self, event: &Stamped<Event>, recorded: Option<&Step>) {
        self.first.get_or_insert(event.at);
        self.last = event.at;
        let Event::Step(step) = &event.value else { return self.hash(event, event) };
        self.steps += 1;
        self.engaged_steps += u64::from(step.k == 0.0);
        self.lacking.hear(step, REPLAYED);
        match recorded.filter(|recorded| recorded.stamp == step.stamp) {
            None => self.hash(event, event),
            Some(recorded) => {
                let mut alike = step.clone();
                alike.leave_out_as(recorded);
                self.compare_steps(step, recorded);
                self.hash(&Stamped { at: event.at, value: Event::Step(alike) }, event);
            }
        }
    }

    /// Adds what was replayed to its hashes: as far as the recording has it, and whole.
    fn hash(&mut self, alike: &Stamped<Event>, whole: &Stamped<Event>) {
        if let Some(hash) = &mut self.lacking.whole {
            hash.update(whole);
        }
        self.replayed.update(alike);
    }

    pub(crate) fn recorded(&mut self, event: &Stamped<Event>) {
        if let Event::Step(step) = &event.value {
            self.lacking.hear(step, RECORDED);
            let t_s = step.stamp.seconds_since(self.start);
            self.begins.get_or_insert((step.step_index, t_s));
        }
        self.recorded.update(event);
    }

    fn compare_steps(&mut self, replayed: &Step, recorded: &Step) {
        let t_s = replayed.stamp.seconds_since(self.start);
        let values = replayed.values().into_iter().zip(recorded.values());
        for (number, (field, (a, b))) in Step::FIELDS.iter().zip(values).enumerate() {
            if (a == Value::Absent) != (b == Value::Absent) {
                self.lacking.apart_s[number].get_or_insert(t_s);
                if b == Value::Absent {
                    // Up to here nothing has been left out.
                    self.lacking.whole.get_or_insert_with(|| self.replayed.clone());
                }
                continue;
            }
            let amount = difference(field, &a, &b);
            if amount > self.deviation.as_ref().map_or(0.0, |largest| largest.amount) {
                self.deviation = Some(Deviation { field: field.name, amount, t_s });
            }
        }
    }

    pub(crate) fn finish(mut self) -> Result<Outcome, ReplayError> {
        if self.steps == 0 {
            return Err(self.damage.map_or(ReplayError::NoStep, ReplayError::Log));
        }
        if let Some((t_s, field)) = self.lacking.lost() {
            // Both have the field: that a step of one has not is a difference like any other.
            let amount = f64::INFINITY;
            let known = self.deviation.as_ref().filter(|known| known.amount == amount);
            if known.is_none_or(|known| t_s < known.t_s) {
                self.deviation = Some(Deviation { field, amount, t_s });
            }
            if let Some(whole) = self.lacking.whole.take() {
                self.replayed = whole;
            }
        }
        let (output_hash, recorded_hash) = (self.replayed.hex(), self.recorded.hex());
        Ok(Outcome {
            steps: self.steps,
            engaged_steps: self.engaged_steps,
            // A damaged log has no whole recording to be identical to.
            identical_to_recorded: output_hash == recorded_hash && self.damage.is_none(),
            output_hash,
            recorded_hash,
            max_deviation: self.deviation,
            duration_s: self.last.seconds_since(self.first.unwrap_or(self.start)),
            end_s: self.last.seconds_since(self.start),
            unmet_faults: Vec::new(),
            begins_late_s: self.begins.filter(|(index, _)| *index > 0).map(|(_, t_s)| t_s),
            damage: self.damage.map(|damage| damage.to_string()),
            horizon: None,
            furthest: None,
            warm_up: None,
        })
    }
}

/// How far two values of a field are apart, directions the short way round. NaN equals NaN; a number and a
/// NaN are infinitely far apart. Names, flags and hashes have no distance: they are left to the hash and to
/// `tandem diff`.
fn difference(field: &Field, a: &Value, b: &Value) -> f64 {
    let apart = |off: f64, direction: bool| if direction { wrap(off).abs() } else { off.abs() };
    let of = |a: f64, b: f64, direction: bool| match (a.is_nan(), b.is_nan()) {
        _ if a.to_bits() == b.to_bits() => 0.0,
        (true, true) => 0.0,
        (false, false) => apart(a - b, direction && (a - b).is_finite()),
        _ => f64::INFINITY,
    };
    let number = |a: f64, b: f64| of(a, b, field.is_direction());
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => number(*a, *b),
        (Value::Pair(a), Value::Pair(b)) => number(a[0], b[0]).max(number(a[1], b[1])),
        (Value::Pose(a), Value::Pose(b)) => {
            number(a.x_m, b.x_m).max(number(a.y_m, b.y_m)).max(of(a.theta_rad, b.theta_rad, true))
        }
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use schemas::Pose;

    use super::*;

    /// A turn rate of 3.1 and one of −3.1 are far apart, two directions are not: 2π − 6.2.
    #[test]
    fn directions_differ_the_short_way_round() {
        let apart = |name: &str, a: Value, b: Value| {
            let field = Step::FIELDS.iter().find(|field| field.name == name).expect("is there");
            difference(field, &a, &b)
        };
        let small = core::f64::consts::TAU - 6.2;
        let (a, b) = (Value::Number(3.1), Value::Number(-3.1));
        for field in ["yaw_rad", "psi_rad", "theta_e_rad"] {
            assert!((apart(field, a, b) - small).abs() < 1e-12, "{field}");
            assert_eq!(apart(field, a, Value::Number(f64::NAN)), f64::INFINITY);
            assert_eq!(apart(field, a, Value::Number(f64::INFINITY)), f64::INFINITY);
        }
        for field in ["omega_radps", "sigma_theta_rad", "d1_m"] {
            assert_eq!(apart(field, a, b), 6.2, "{field}");
        }
        let pose = |theta_rad| Value::Pose(Pose { x_m: 1.0, y_m: 2.0, theta_rad });
        assert!((apart("pose", pose(3.1), pose(-3.1)) - small).abs() < 1e-12);
    }
}
