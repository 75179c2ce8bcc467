//! `tandem compare --self-test`: does a comparison find nothing where there is nothing, and what is
//! wrong on purpose where there is something?
//!
//! In: a controller, sessions, a person, a gate. Out: a [`SelfTest`], and the pairs of the controller
//! with itself. Everything is replayed in closed loop: the controller, itself again, itself renamed,
//! each mutant, and itself under noise of other seeds. Comparison number i of those holds seed i
//! against seed i + 1: no two of them are the same, and neighbours share one run.

mod mutants;
mod sessions;

use std::io::Cursor;
use std::sync::Arc;
use std::time::Duration;

use ::compare::{
    Compared, Diff, Differ, FalseAlarms, GateFile, LevelPair, LogPair, Measured, Meter, Question,
    SelfTest, Tolerances, Unchanged, compare,
};
use anyhow::{Context as _, Result, bail, ensure};
use controller::{Law, Mutation, Spec};
use replay::{Faults, Person, Replay};
use schemas::{Event, Header, Stamped};

use crate::arm::{caught, made};
use crate::cli::Common;
use crate::controller_choice::ControllerChoice;
use crate::fleet::watch;
use crate::{fleet, interrupt};

use mutants::Mutant;
pub use sessions::{Session, built_in, of_logs};

/// The gate where none is named.
const GATE: &str = include_str!("gate.toml");

/// The first seed of other noise; recordings have small ones of their own.
const FIRST_SEED: u64 = 1_000_003;

/// How far the seeds of one session are from those of the next: sessions that share a seed share
/// their noise, and are no independent evidence.
const SEEDS_OF_A_SESSION: u64 = 100_000;

/// What is asked.
pub struct Ask {
    /// The controller.
    pub controller: ControllerChoice,
    /// The sessions.
    pub sessions: Vec<Session>,
    /// How the recorded person is brought back.
    pub person: Person,
    /// The gate; one of our own where none is named.
    pub gate: Option<GateFile>,
    /// How many comparisons with other noise.
    pub comparisons: usize,
    /// What every replay is put under.
    pub faults: Faults,
    /// After how long a controller that does not answer is given up.
    pub hang_after: Duration,
}

/// What came of it, and the controller against itself.
pub struct Answer {
    /// The judgement.
    pub test: SelfTest,
    /// The controller against itself, whole.
    pub itself: Vec<LogPair>,
    /// What stands at the head of the first session.
    pub header: Header,
}

/// What one session gives.
struct Runs {
    itself: LogPair,
    renamed: LogPair,
    /// By mutant; `None` where the mutant is no other controller.
    mutants: Vec<Option<LogPair>>,
    /// By seed.
    noisy: Vec<LogPair>,
}

impl Ask {
    /// Runs everything.
    pub fn answer(self, common: &Common) -> Result<Answer> {
        ensure!(!self.sessions.is_empty(), "no session to test with");
        let this = Arc::new(self);
        let gate = match &this.gate {
            Some(gate) => gate.clone(),
            None => GateFile::from_toml(GATE)?,
        };
        let first = this.spec(&this.sessions[0])?;
        if first.law == Law::Human {
            bail!("`human` shares nothing: name a controller whose mutants can be told from it");
        }
        let sonars = this.sessions.iter().any(|s| s.recording.header().run.sensors != "exact");
        let mutants = mutants::mutants(first.law, sonars);
        let numbered: Vec<(u64, Session)> = (0..).zip(this.sessions.iter().cloned()).collect();
        let (ask, of_all) = (Arc::clone(&this), mutants.clone());
        let work = move |(number, session): &(u64, Session)| {
            let first_seed = FIRST_SEED + number * SEEDS_OF_A_SESSION;
            ask.runs(session, &of_all, first_seed)
        };
        let all = watch::each(common, numbered, "testing", this.hang_after, work);
        let named = all.into_iter().zip(&this.sessions);
        let mut all = named
            .map(|(runs, session)| runs.with_context(|| session.name.clone()))
            .collect::<Result<Vec<Runs>>>()?;
        interrupt::check()?;

        let differing = Unchanged {
            itself: differing(all.iter().map(|runs| &runs.itself)),
            renamed: differing(all.iter().map(|runs| &runs.renamed)),
        };
        let question = this.question(gate);
        let mut told = Vec::new();
        for (i, mutant) in mutants.iter().enumerate() {
            let pairs: Vec<LogPair> =
                all.iter_mut().filter_map(|runs| runs.mutants[i].take()).collect();
            if !pairs.is_empty() {
                let comparison = compare(&question, pairs)?;
                told.push(::compare::Mutant::of(&mutant.name, mutant.nodes, &comparison));
            }
        }
        let numbers: Vec<usize> = (0..this.comparisons).collect();
        let noisy = fleet::each(common, &numbers, "comparing", |i| {
            let pairs = all.iter().map(|runs| runs.noisy[*i].clone()).collect();
            Ok(compare(&question, pairs)?)
        });
        let mut false_alarms = FalseAlarms::default();
        for comparison in noisy {
            let c = comparison?;
            false_alarms.add(&c);
        }
        let test = SelfTest::new(this.sessions.len(), differing, told, false_alarms);
        Ok(Answer {
            test,
            itself: all.into_iter().map(|runs| runs.itself).collect(),
            header: this.sessions[0].recording.header().clone(),
        })
    }

    fn question(&self, gate: GateFile) -> Question {
        Question {
            a: self.controller.label().to_owned(),
            b: "mutant".to_owned(),
            mode: "closed".to_owned(),
            human: vec![self.person.name().to_owned()],
            gate: Some(gate),
            ..Question::default()
        }
    }

    fn spec(&self, session: &Session) -> Result<Spec> {
        self.controller.for_log(session.recording.header()).with_context(|| session.name.clone())
    }

    /// Everything that one session is run for.
    fn runs(&self, session: &Session, mutants: &[Mutant], first_seed: u64) -> Result<Runs> {
        let spec = self.spec(session)?;
        let mut events = Vec::new();
        let a = self.run(session, &spec, None, |event| events.push(event.clone()))?;
        let against = |spec: &Spec, mutation| {
            let mut diff = Differ::new(&Tolerances::exact(), session.start(), session.start());
            let mut of_a = events.iter();
            let b = self.run(session, spec, mutation, |event| {
                of_a.next().into_iter().for_each(|event| diff.a(event));
                diff.b(event);
            });
            of_a.for_each(|event| diff.a(event));
            let diff = diff.finish().map_err(|error| error.to_string());
            (b.map_err(|error| format!("{error:#}")), diff)
        };
        // Neither path nor profile: of these only the numbers are looked at.
        let bare = |(b, diff): (Result<Measured, String>, _)| {
            self.pair(session, a.clone().bare(), b.map(Measured::bare), diff)
        };
        let mut changed = Vec::new();
        for mutant in mutants {
            changed.push(match mutant.of(&spec) {
                Ok(None) => None,
                Ok(Some((spec, mutation))) => Some(bare(against(&spec, mutation))),
                Err(error) => {
                    let error = format!("{error:#}");
                    Some(bare((Err(error.clone()), Err(error))))
                }
            });
        }
        let renamed = bare(against(&reordered(&spec)?, None));
        let (again, diff) = against(&spec, None);
        Ok(Runs {
            itself: self.pair(session, a.clone(), again, diff),
            renamed,
            mutants: changed,
            noisy: self.noisy(session, &spec, first_seed)?,
        })
    }

    /// One run in closed loop; `each` sees its steps and commands.
    fn run(
        &self,
        session: &Session,
        spec: &Spec,
        mutation: Option<Mutation>,
        mut each: impl FnMut(&Stamped<Event>),
    ) -> Result<Measured> {
        let (recording, person) = (&session.recording, self.person);
        made(recording.header(), spec)?;
        let replay: Replay<Cursor<Vec<u8>>> = match mutation {
            None => Replay::of_recording(recording, spec, person)?,
            Some(mutation) => Replay::of_mutant(recording, spec, person, mutation)?,
        };
        let mut replay = replay.under(self.faults.clone());
        let mut meter = Meter::new(recording.header());
        while let Some(event) = caught(|| replay.next_event())? {
            interrupt::check()?;
            meter.observe(&event);
            if matches!(event.value, Event::Step(_) | Event::Command(_)) {
                each(&event);
            }
        }
        Ok(meter.finish()?)
    }

    /// The controller under noise of other seeds: each seed against the one before.
    fn noisy(&self, session: &Session, spec: &Spec, first_seed: u64) -> Result<Vec<LogPair>> {
        let mut pairs = Vec::new();
        let mut before: Option<Measured> = None;
        for i in 0..=self.comparisons {
            let recording = session.recording.as_ref().clone().with_seed(first_seed + i as u64);
            let session = Session {
                name: session.name.clone(),
                hash: session.hash.clone(),
                recording: Arc::new(recording),
            };
            // The name and the order of the parameters differ as well.
            let spec = if i % 2 == 0 { spec.clone() } else { reordered(spec)? };
            let run = self.run(&session, &spec, None, |_| {})?.bare();
            if let Some(before) = before.replace(run.clone()) {
                pairs.push(self.pair(&session, before, Ok(run), Ok(unlike())));
            }
        }
        Ok(pairs)
    }

    fn pair(
        &self,
        session: &Session,
        a: Measured,
        b: Result<Measured, String>,
        diff: Result<Diff, String>,
    ) -> LogPair {
        let header = session.recording.header();
        LogPair {
            log: session.name.clone(),
            operator: header.run.operator.clone(),
            hash: session.hash.clone(),
            scenario: Some(header.scenario.clone()),
            recorded: None,
            plant_doubt: None,
            plant_untold: Some("it was not asked".to_owned()),
            unmet_faults: Vec::new(),
            levels: vec![LevelPair {
                human: self.person.name().to_owned(),
                estimates: self.person.is_estimate(),
                horizon_s: None,
                a: Ok(a),
                b,
                diff: Some(diff),
            }],
        }
    }
}

/// The diff of two runs that heard different noise: they differ from the first sample on, and where is
/// not asked.
fn unlike() -> Diff {
    Diff {
        same: false,
        whole: true,
        same_behaviour: false,
        compared: Compared::default(),
        fields: Vec::new(),
        first_cause: None,
    }
}

/// The same controller under another name, with its parameters read in the opposite order.
fn reordered(spec: &Spec) -> Result<Spec> {
    let lines = spec.params_toml();
    let reversed: String = lines.lines().rev().flat_map(|line| [line, "\n"]).collect();
    let read = Spec::from_recorded(&spec.name, &reversed)?;
    Ok(Spec { name: format!("{} renamed", spec.name), ..read })
}

/// In how many sessions anything that a controller says or does differs, or could not be run.
fn differing<'a>(pairs: impl Iterator<Item = &'a LogPair>) -> usize {
    let same = |level: &LevelPair| matches!(&level.diff, Some(Ok(diff)) if diff.same);
    pairs.filter(|pair| !pair.levels.iter().all(same)).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gate that comes with the program reads, and holds violations against B.
    #[test]
    fn the_gate_of_our_own_is_sound() {
        let gate = GateFile::from_toml(GATE).unwrap();
        assert_eq!(gate.new_violations, 0);
        assert!(gate.metrics.values().all(|metric| metric.margin.is_some_and(|m| m > 0.0)));
    }

    #[test]
    fn a_renamed_controller_is_the_same_controller() {
        let spec = Spec::resolve("tandem-dynamic", &[]).unwrap();
        let renamed = reordered(&spec).unwrap();
        assert_ne!(renamed.name, spec.name);
        assert_eq!((renamed.law, renamed.params), (spec.law, spec.params));
    }
}
