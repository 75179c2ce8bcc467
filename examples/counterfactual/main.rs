//! How well replay predicts what another controller would have brought about: the study behind
//! `docs/counterfactual.md`.
//!
//! Simulated people who react are recorded with controller A; from that log alone replay predicts
//! the change that controller B would make; then B is really run with the same person. None of the
//! people belongs to the family that replay fits.
//!
//!     cargo run --release --example counterfactual -- [--sessions N] [--first N] [--out FILE]

mod score;
mod session;
mod table;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context as _, Result, bail};
use replay::{Gains, Person};
use schemas::{Plant, SensorSuite};

use score::{Predicted, Record};
use session::{Case, Pair, Version};

/// Controllers A and B: changes that matter, from the coarse to the fine.
pub(crate) const PAIRS: [Pair; 5] = [
    (("human", &[]), ("tandem-kinematic", &[])),
    (("paper-kinematic", &[]), ("tandem-kinematic", &[])),
    (("tandem-kinematic", &[]), ("tandem-kinematic", WIDER)),
    (("paper-dynamic", &[]), ("tandem-dynamic", &[])),
    (("tandem-kinematic", &[]), ("tandem-dynamic", &[])),
];

/// Sets in which the controller takes over earlier and lets go later.
const WIDER: &[(&str, f64)] =
    &[("b1_free_m", 1.6), ("b2_free_m", 2.0), ("b1_task_m", 1.6), ("b2_task_m", 2.0)];

/// Changes that do not matter: what is called there is called falsely.
const NULL_PAIRS: [Pair; 4] = [
    (("tandem-kinematic", &[]), ("tandem-kinematic", &[("gamma1", 0.202)])),
    (("tandem-kinematic", &[]), ("tandem-kinematic", &[("epsilon_m", 0.0505)])),
    (("tandem-dynamic", &[]), ("tandem-dynamic", &[("gamma3", 4.02)])),
    (("paper-kinematic", &[]), ("paper-kinematic", &[("gamma1", 0.202)])),
];

/// The people.
pub(crate) const PEOPLE: [&str; 4] = ["hesitant", "flowing", "explorer", "tracker"];

/// The rooms.
const ROOMS: [&str; 3] = ["rect", "slant", "disc"];

/// How long a session lasts, seconds.
const DURATION_S: f64 = 20.0;

struct Options {
    sessions: usize,
    first: u64,
    sensors: SensorSuite,
    out: Option<String>,
}

fn options() -> Result<Options> {
    let mut options = Options { sessions: 200, first: 1, sensors: SensorSuite::Exact, out: None };
    let mut arguments = std::env::args().skip(1);
    while let Some(name) = arguments.next() {
        let value = arguments.next().with_context(|| format!("{name} wants a value"))?;
        match name.as_str() {
            "--sessions" => options.sessions = value.parse()?,
            "--first" => options.first = value.parse()?,
            "--sensors" if value == "sonar" => options.sensors = SensorSuite::Sonar,
            "--sensors" if value == "exact" => options.sensors = SensorSuite::Exact,
            "--out" => options.out = Some(value),
            other => bail!("unknown option {other} {value}"),
        }
    }
    Ok(options)
}

/// The plant that is replayed, and the one that there was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ground {
    /// There was the plant that the log claims.
    Ideal,
    /// There was a worse one, and replay believes the log.
    Mismatched,
    /// There was a worse one, and replay identifies it from the log.
    Identified,
}

/// The session of a number.
fn case(options: &Options, number: usize, ground: Ground) -> Result<(Case, &'static str)> {
    let (person, room) =
        (PEOPLE[number % PEOPLE.len()], ROOMS[number / PEOPLE.len() % ROOMS.len()]);
    let seed = options.first + number as u64;
    let mut scenario = simulator::scenario(&format!("random:{room}:{person}:{seed}"))?;
    scenario.duration_s = DURATION_S;
    let plant = if ground == Ground::Ideal {
        scenario.plant
    } else {
        Plant {
            limits_acceleration: true,
            accel_max_mps2: 0.8,
            alpha_max_radps2: 3.0,
            actuator_delay_s: 0.1,
            slip: 0.08,
            ..scenario.plant
        }
    };
    Ok((Case { scenario, plant, seed, sensors: options.sensors }, person))
}

/// Everything about one session and one pair.
fn one(
    options: &Options,
    number: usize,
    (a, b): Pair,
    ground: Ground,
    gains: Gains,
) -> Result<Record> {
    let (case, person) = case(options, number, ground)?;
    let (live_a, log) = session::live(&case, a, true)?;
    let (live_b, _) = session::live(&case, b, false)?;
    let log = log.context("a log was asked for")?;
    let recording = session::read(&log, ground == Ground::Identified)?;
    let [spec_a, spec_b] = [session::spec(a, &case.scenario)?, session::spec(b, &case.scenario)?];
    let mut levels = Vec::new();
    for level in Person::ladder(gains) {
        let (sim_a, _) = session::predicted(&recording, &spec_a, level)?;
        let (sim_b, outcome) = session::predicted(&recording, &spec_b, level)?;
        let cut_s = outcome.horizon.and_then(|horizon| horizon.first_s()).unwrap_or(f64::INFINITY);
        levels.push(Predicted {
            name: level.name(),
            change: score::change(&sim_a.metrics(), &sim_b.metrics()),
            apart_m: sim_b.apart(&live_b, cut_s),
            furthest: outcome.furthest.unwrap_or(f64::INFINITY),
        });
    }
    let truth = score::change(&live_a.metrics(), &live_b.metrics());
    Ok(Record { person, truth, levels })
}

/// Works on all jobs, on two threads, keeping their order.
fn each<T: Send>(count: usize, work: impl Fn(usize) -> Result<T> + Sync) -> Result<Vec<T>> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let job = next.fetch_add(1, Ordering::Relaxed);
                    if job >= count {
                        break;
                    }
                    let result = work(job);
                    if let Ok(mut results) = results.lock() {
                        results.push((job, result));
                    }
                }
            });
        }
    });
    let mut results = results.into_inner().unwrap_or_default();
    results.sort_by_key(|(job, _)| *job);
    results.into_iter().map(|(_, result)| result).collect()
}

/// Gains pooled over the logs that a controller recorded.
fn pooled(options: &Options, version: Version, ground: Ground) -> Result<Gains> {
    let logs = each(options.sessions.min(24), |number| {
        let (case, _) = case(options, number, ground)?;
        let (_, log) = session::live(&case, version, true)?;
        session::read(&log.context("a log was asked for")?, ground == Ground::Identified)
    })?;
    Ok(Gains::pooled(&logs))
}

/// All sessions under one pair.
fn fleet(options: &Options, pair: Pair, ground: Ground) -> Result<Vec<Record>> {
    let gains = pooled(options, pair.0, ground)?;
    eprintln!("{ground:?}: {} against {}, {gains:?}", pair.0.0, pair.1.0);
    each(options.sessions, |number| one(options, number, pair, ground, gains))
}

fn main() -> Result<()> {
    let options = options()?;
    let mut text = String::new();
    for ground in [Ground::Ideal, Ground::Mismatched, Ground::Identified] {
        let fleets = PAIRS
            .map(|pair| fleet(&options, pair, ground))
            .into_iter()
            .collect::<Result<Vec<_>>>()?;
        // What a plant does to a change that does not matter is shown well enough by one of them.
        let null = if ground == Ground::Ideal {
            NULL_PAIRS
                .map(|pair| fleet(&options, pair, ground))
                .into_iter()
                .collect::<Result<_>>()?
        } else {
            Vec::new()
        };
        text += &table::section(ground, &fleets, &null);
    }
    match &options.out {
        None => print!("{text}"),
        Some(path) => std::fs::write(path, text)?,
    }
    Ok(())
}
