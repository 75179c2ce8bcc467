//! What reading and replaying cost, as multiples of bare decompression in the same run.
//!
//!     cargo bench --bench replay_cost [-- MINUTES]
//!
//! Records ten minutes of free driving with sonars, exact to the last bit and without viewer topics,
//! into memory. The limit of any replay is to decompress the log's chunks, each in one shot, into a
//! buffer that is reused. The peer reads with the `mcap` crate's own stream and decodes with prost what a
//! controller needs, into messages that are used again. Every row is measured in every round, in turn; printed is the median over
//! the rounds, of CPU time.

use std::hint::black_box;
use std::io::Cursor;

use prost::Message as _;

use controller::{Runner, Session, Setup, Spec};
use recorder::Simulated;
use replay::{Mode, Person, Replay};
use rustix::time::{ClockId, clock_gettime};
use schemas::log::{LogReader, Topic, WriterOptions};
use schemas::{Event, Header, Sample, Scenario, SensorSuite, Time};

const ROUNDS: usize = 7;

/// What is measured; says how much it went through.
type Work<'a> = Box<dyn FnMut() -> usize + 'a>;

/// A session of `minutes`, as the bytes of its log.
fn record(minutes: f64) -> Vec<u8> {
    let scenario = simulator::scenario("random:rect:joystick:7").unwrap();
    let scenario = Scenario { duration_s: minutes * 60.0, ..scenario };
    let spec = Spec::for_scenario("tandem-kinematic", &scenario, &[]).unwrap();
    let simulated = Simulated { sensors: SensorSuite::Sonar, ..Simulated::of(spec, scenario) };
    let (simulation, runner) = simulated.begin().unwrap();
    let header = simulated.header();
    let mut session = Session::new(simulation, runner);
    let options = WriterOptions { view: false, ..WriterOptions::offline() };
    let mut log = schemas::log::LogWriter::new(Cursor::new(Vec::new()), &header, &options).unwrap();
    while let Ok(Some(event)) = session.next_event() {
        log.write(&event).unwrap();
    }
    log.finish().unwrap().0.into_inner()
}

fn cpu_ns() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 * 1e9 + time.tv_nsec as f64
}

/// The compressed chunks of a log, each with the size of its content.
fn chunks(log: &[u8]) -> Vec<(&[u8], usize)> {
    let summary = mcap::Summary::read(log).unwrap().expect("a finished log has a summary");
    let chunk = |index: &mcap::records::ChunkIndex| {
        let begin = usize::try_from(index.compressed_data_offset().unwrap()).unwrap();
        let content = &log[begin..begin + index.compressed_size as usize];
        (content, index.uncompressed_size as usize)
    };
    summary.chunk_indexes.iter().map(chunk).collect()
}

fn read(log: &[u8], topics: Option<&[Topic]>) -> usize {
    let mut reader = LogReader::new(log).unwrap();
    if let Some(topics) = topics {
        reader = reader.only(topics);
    }
    let mut events = 0;
    while let Some(event) = reader.next_event().unwrap() {
        black_box(event);
        events += 1;
    }
    events
}

fn replay(log: &[u8], spec: &Spec, mode: Mode) -> usize {
    let open = || LogReader::new(Cursor::new(log.to_vec()));
    let mut replay = Replay::new(open, spec, mode).unwrap();
    let mut events = 0;
    while let Some(event) = replay.next_event() {
        black_box(event);
        events += 1;
    }
    assert!(replay.finish().unwrap().identical_to_recorded);
    events
}

/// What the controller is fed in open loop, and nothing else: its own cost beside reading.
fn steps_alone(setup: &Setup, fed: &[Fed]) -> usize {
    let mut runner = Runner::new(setup).unwrap();
    for fed in fed {
        match fed {
            Fed::Sample(sample) => runner.observe(sample),
            Fed::StepAt(now) => {
                black_box(runner.step(*now));
            }
        }
    }
    fed.len()
}

enum Fed {
    Sample(Box<Sample>),
    StepAt(Time),
}

fn fed(log: &[u8]) -> (Setup, Vec<Fed>) {
    let mut reader = LogReader::new(log).unwrap();
    let Header { run, params_toml, scenario } = reader.header().clone();
    let spec = Spec::from_recorded(&run.controller, &params_toml).unwrap();
    let setup = Setup { spec, scenario, sensors: SensorSuite::Sonar, start: run.start };
    let mut fed = Vec::new();
    while let Some(event) = reader.next_event().unwrap() {
        match event.value {
            Event::Sample(sample) => fed.push(Fed::Sample(Box::new(sample))),
            Event::Step(step) => fed.push(Fed::StepAt(step.stamp)),
            _ => {}
        }
    }
    (setup, fed)
}

fn replay_both(log: &[u8], specs: &[Spec]) -> usize {
    let log = LogReader::new(Cursor::new(log.to_vec())).unwrap();
    let mut replays: Vec<_> =
        Replay::side_by_side(log, specs).into_iter().map(Result::unwrap).collect();
    let mut events = 0;
    loop {
        let mut over = true;
        for replay in &mut replays {
            if let Some(event) = replay.next_event() {
                black_box(event);
                events += 1;
                over = false;
            }
        }
        if over {
            return events;
        }
    }
}

/// The messages that a controller hears, as an outsider would declare them from the log's own schemas.
mod peer {
    #[derive(Clone, PartialEq, prost::Message)]
    pub(super) struct SonarEcho {
        #[prost(uint32, tag = "1")]
        id: u32,
        #[prost(double, tag = "2")]
        range_m: f64,
        #[prost(bool, tag = "3")]
        echo: bool,
        #[prost(fixed64, tag = "4")]
        fired_ns: u64,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub(super) struct SonarScan {
        #[prost(fixed64, tag = "1")]
        stamp_ns: u64,
        #[prost(message, repeated, tag = "2")]
        echoes: Vec<SonarEcho>,
    }

    /// IMU, encoder and joystick samples: a stamp and up to nine numbers.
    #[derive(Clone, PartialEq, prost::Message)]
    pub(super) struct Numbers {
        #[prost(fixed64, tag = "1")]
        stamp_ns: u64,
        #[prost(double, tag = "2")]
        a: f64,
        #[prost(double, tag = "3")]
        b: f64,
        #[prost(double, tag = "4")]
        c: f64,
        #[prost(double, tag = "5")]
        d: f64,
        #[prost(double, tag = "6")]
        e: f64,
        #[prost(double, tag = "7")]
        f: f64,
        #[prost(double, tag = "8")]
        g: f64,
        #[prost(double, tag = "9")]
        h: f64,
        #[prost(double, tag = "10")]
        i: f64,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub(super) struct Joystick {
        #[prost(fixed64, tag = "1")]
        stamp_ns: u64,
        #[prost(double, tag = "2")]
        v_mps: f64,
        #[prost(double, tag = "3")]
        omega_radps: f64,
        #[prost(bool, tag = "4")]
        dead_man: bool,
    }
}

/// How an outsider reads a log: the crate's stream of messages, and prost for those that matter.
fn stream_and_decode(log: &[u8]) -> usize {
    let mut scan = peer::SonarScan::default();
    let (mut numbers, mut joystick) = (peer::Numbers::default(), peer::Joystick::default());
    let mut decoded = 0;
    for message in mcap::MessageStream::new(log).unwrap() {
        let message = message.unwrap();
        let data = &message.data[..];
        match message.channel.topic.as_str() {
            "/sonar" => {
                scan.clear();
                scan.merge(data).unwrap();
                black_box(&scan);
            }
            "/imu" | "/encoders" => {
                numbers.clear();
                numbers.merge(data).unwrap();
                black_box(&numbers);
            }
            "/joystick" => {
                joystick.clear();
                joystick.merge(data).unwrap();
                black_box(&joystick);
            }
            _ => continue,
        }
        decoded += 1;
    }
    decoded
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let minutes = std::env::args().skip(1).find_map(|text| text.parse().ok()).unwrap_or(10.0);
    let log = record(minutes);
    let chunks = chunks(&log);
    let spec = {
        let header = LogReader::new(log.as_slice()).unwrap().header().clone();
        Spec::from_recorded(&header.run.controller, &header.params_toml).unwrap()
    };
    let mut buffer = Vec::new();
    let mut zstd = zstd::bulk::Decompressor::new().unwrap();
    let mut decompress = || {
        for (content, size) in &chunks {
            buffer.clear();
            buffer.reserve(*size);
            zstd.decompress_to_buffer(content, &mut buffer).unwrap();
            black_box(&buffer);
        }
        chunks.len()
    };
    let (setup, fed) = fed(&log);
    // What a comparison replays: two versions over one reading.
    let both = [spec.clone(), Spec::resolve("paper-kinematic", &[]).unwrap()];
    let sensors = [Topic::Sonar, Topic::Imu, Topic::Encoders, Topic::Joystick, Topic::Exact];
    let mut rows: Vec<(&str, Work<'_>)> = vec![
        ("decompression of every chunk, one shot each", Box::new(&mut decompress)),
        ("reading sensors and joystick", Box::new(|| read(&log, Some(&sensors)))),
        ("reading every event", Box::new(|| read(&log, None))),
        (
            "`mcap::MessageStream`, nothing decoded",
            Box::new(|| mcap::MessageStream::new(&log).unwrap().map(black_box).count()),
        ),
        (
            "`mcap::MessageStream`, sensors and joystick by prost",
            Box::new(|| stream_and_decode(&log)),
        ),
        ("the controller alone, on samples in memory", Box::new(|| steps_alone(&setup, &fed))),
        ("open-loop replay", Box::new(|| replay(&log, &spec, Mode::Open))),
        ("open-loop replay into two controllers", Box::new(|| replay_both(&log, &both))),
        ("closed-loop replay", Box::new(|| replay(&log, &spec, Mode::Closed(Person::Playback)))),
    ];
    let mut times = vec![Vec::new(); rows.len()];
    for _ in 0..ROUNDS {
        for ((_, work), times) in rows.iter_mut().zip(&mut times) {
            let from_ns = cpu_ns();
            assert!(black_box(work()) > 0);
            times.push(cpu_ns() - from_ns);
        }
    }
    let events = read(&log, None);
    println!("{minutes} minutes, {events} events, {} KiB\n", log.len() / 1024);
    println!(
        "| work | × decompression | ns per event here | × real time here |\n|---|---|---|---|"
    );
    let limit_ns = median(&mut times[0]);
    for ((name, _), times) in rows.iter().zip(&mut times) {
        let ns = median(times);
        let speed = minutes * 60e9 / ns;
        println!("| {name} | {:.2} | {:.0} | {speed:.0} |", ns / limit_ns, ns / events as f64);
    }
}
