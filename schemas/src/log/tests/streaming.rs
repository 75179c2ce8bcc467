//! Memory follows one chunk, the file follows the clock of the log, and a log is what it says it is.

use std::io::{self, Write};

use super::session::{bare, events, header, log_of};
use crate::log::info::inspect_source;
use crate::log::{
    LogError, LogReader, LogWriter, Sink, TOPICS, Topic, WriterOptions, create, inspect,
};
use crate::{Event, NS_PER_S, SIMULATION_EPOCH, Span, Stamped, Time};

/// The largest buffers that reading a log needed, bytes.
fn most_buffered(log: &[u8]) -> usize {
    let mut reader = LogReader::new(log).expect("opens");
    let mut most = 0;
    while reader.next_event().expect("reads").is_some() {
        most = most.max(reader.buffered_bytes());
    }
    assert!(reader.is_complete());
    most
}

#[test]
fn the_readers_memory_follows_one_chunk_and_not_the_file() {
    let options = WriterOptions { chunk_bytes: 32 << 10, ..WriterOptions::default() };
    let short = log_of(&events(100), &options);
    let long = log_of(&events(1_500), &options);
    assert!(long.len() > 10 * short.len(), "{} against {}", long.len(), short.len());
    let (short, long) = (most_buffered(&short), most_buffered(&long));
    assert!(long <= short * 11 / 10, "{long} against {short} bytes");
    // A chunk overruns by at most one message and holds the schemas besides.
    assert!(long < 4 * (32 << 10), "{long} bytes");
}

/// What is not a file on a disk takes a log too, though there is nothing to wait for.
#[cfg(unix)]
#[test]
fn a_log_may_go_to_a_device() {
    let mut log = create("/dev/null", &header(), &bare(4096)).expect("opens");
    for event in &events(5) {
        log.write(event).expect("takes all");
    }
    let (_, summary) = log.finish().expect("ends");
    assert_eq!(summary.messages, events(5).len() as u64);
}

#[test]
fn the_writers_chunks_end_by_size_and_by_log_time() {
    let chunks = |log: &[u8]| {
        mcap::Summary::read(log).expect("whole").expect("a summary").chunk_indexes.len()
    };
    // 100 events a second for 20 s.
    let written = events(200);
    let never = Span(u64::MAX);
    let by_time = WriterOptions { flush_interval: Span(NS_PER_S), ..bare(64 << 20) };
    assert_eq!(chunks(&log_of(&written, &by_time)), 20);
    let in_one = WriterOptions { flush_interval: never, ..bare(64 << 20) };
    assert_eq!(chunks(&log_of(&written, &in_one)), 1);
    let by_size = WriterOptions { flush_interval: never, ..bare(16 << 10) };
    let content: usize =
        log_of(&written, &WriterOptions { flush_interval: never, ..bare(1) }).len();
    assert!(chunks(&log_of(&written, &by_size)) > 10, "of {content} bytes");
}

/// A sink that counts what reached it and can be read while the writer is at work.
#[derive(Clone, Default)]
struct Shared(std::rc::Rc<std::cell::RefCell<Vec<u8>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
impl Sink for Shared {}

#[test]
fn what_has_been_flushed_survives_a_crash() {
    // The contract of the loss window: whatever the chunk size, everything older than the interval
    // before the last event can be read from what reached the sink, without the writer's end.
    let sink = Shared::default();
    let options = WriterOptions { flush_interval: Span(NS_PER_S), ..bare(64 << 20) };
    let mut writer = LogWriter::new(sink.clone(), &header(), &options).expect("writes");
    let written = events(57);
    for (index, event) in written.iter().enumerate() {
        writer.write(event).expect("writes");
        if index % 13 == 0 {
            let so_far = sink.0.borrow().clone();
            let (back, error, complete) = super::session::read(&so_far);
            assert!(!complete && matches!(error, Some(LogError::Truncated { .. })), "{error:?}");
            let lost_ns = event.at.0 - back.last().map_or(SIMULATION_EPOCH, |last| last.at).0;
            assert!(lost_ns <= NS_PER_S, "{lost_ns} ns lost after event {index}");
        }
    }
    std::mem::forget(writer);
}

#[test]
fn log_times_must_increase_and_the_error_names_topic_and_time() {
    let event = &events(1)[0];
    let mut writer = LogWriter::new(Vec::new(), &header(), &bare(4096)).expect("writes");
    writer.write(event).expect("the first");
    for at in [event.at, Time(event.at.0 - 1)] {
        let error = writer.write(&Stamped { at, value: event.value.clone() }).expect_err("order");
        assert!(matches!(error, LogError::Order { topic: "/sonar", .. }), "{error:?}");
        assert!(error.to_string().contains(&at.0.to_string()), "{error}");
    }
    // The log goes on after a refusal.
    writer.write(&Stamped { at: event.at.after_ns(1), ..event.clone() }).expect("the next");
    let (log, summary) = writer.finish().expect("ends");
    assert_eq!(summary.messages, 2);
    assert_eq!(super::session::read(&log).0.len(), 2);
}

/// A device that is full after some bytes.
struct Full(usize);

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.0 == 0 {
            return Err(io::Error::new(io::ErrorKind::StorageFull, "no space left on device"));
        }
        let taken = bytes.len().min(self.0);
        self.0 -= taken;
        Ok(taken)
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
impl Sink for Full {}

#[test]
fn a_full_device_is_an_error_wherever_it_is_full() {
    let whole = log_of(&events(3), &bare(500)).len();
    let write = |room: usize| -> Result<(), LogError> {
        let mut writer = LogWriter::new(Full(room), &header(), &bare(500))?;
        for event in events(3) {
            writer.write(&event)?;
        }
        writer.finish().map(|_| ())
    };
    for room in (0..whole).step_by(7) {
        let error = write(room).expect_err("no room");
        assert!(matches!(&error, LogError::Io(_)), "{room}: {error:?}");
        assert!(error.to_string().contains("no space"), "{error}");
    }
    assert!(write(whole).is_ok());
}

#[test]
fn the_summary_counts_what_is_in_the_file() {
    let written = events(30);
    let mut writer =
        LogWriter::new(Vec::new(), &header(), &WriterOptions::default()).expect("writes");
    for event in &written {
        writer.write(event).expect("writes");
    }
    let (log, summary) = writer.finish().expect("ends");
    assert_eq!(summary.bytes, log.len() as u64);
    assert_eq!(summary.first, Some(written[0].at));
    assert_eq!(summary.last, written.last().map(|event| event.at));
    let of = |topic: &str| summary.topics.iter().find(|(name, _)| *name == topic).map(|t| t.1);
    assert_eq!(of("/step"), Some(30));
    assert_eq!(of("/gap"), Some(30));
    assert!(of("/scene").is_some_and(|count| count >= 25));

    // The `mcap` crate counts the same.
    let stats = mcap::Summary::read(&log).expect("whole").expect("a summary").stats;
    assert_eq!(stats.map(|stats| stats.message_count), Some(summary.messages));
}

#[test]
fn inspecting_tells_what_the_log_holds() {
    let mut written = events(21);
    // Not every control period has a drop-out.
    written
        .retain(|event| !matches!(&event.value, Event::Gap(gap) if gap.stamp != SIMULATION_EPOCH));
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("a.mcap");
    let mut writer = create(&path, &header(), &WriterOptions::default()).expect("creates");
    for event in &written {
        writer.write(event).expect("writes");
    }
    let (_, summary) = writer.finish().expect("ends");

    let info = inspect(&path).expect("reads");
    assert!(info.complete && info.damage.is_none());
    assert_eq!(info.header, header());
    assert_eq!(info.bytes, std::fs::metadata(&path).expect("exists").len());
    assert_eq!(info.messages, summary.messages);
    // From the first sonar scan at 0 s to the last timing, 9 ranks after 2 s.
    assert!((info.duration_s - 2.000_000_009).abs() < 1e-9, "{}", info.duration_s);
    let step = info.channels.iter().find(|channel| channel.topic == "/step").expect("there");
    assert_eq!((step.schema.as_str(), step.encoding.as_str()), ("tandem.v1.Step", "protobuf"));
    assert_eq!((step.count, step.lost), (21, 0));
    assert!((step.rate_hz - 10.0).abs() < 1e-9, "{}", step.rate_hz);
    assert_eq!(info.gaps.len(), 1);
    assert_eq!(info.gaps[0].stream, "/sonar");
    assert!((info.gaps[0].duration_s - 0.05).abs() < 1e-12 && info.gaps[0].start_s == 0.0);
    let mut topics: Vec<&str> = info.channels.iter().map(|c| c.topic.as_str()).collect();
    assert!(topics.is_sorted());
    topics.retain(|topic| !TOPICS.iter().any(|info| info.name == *topic));
    assert!(topics.is_empty(), "{topics:?}");
}

#[test]
fn inspecting_a_damaged_log_tells_how_much_of_it_is_there() {
    let log = log_of(&events(20), &bare(1000));
    let whole = inspect_source(log.as_slice()).expect("reads");
    let half = inspect_source(&log[..log.len() / 2]).expect("its head is whole");
    assert!(!half.complete);
    assert!(matches!(half.damage, Some(LogError::Truncated { .. })), "{:?}", half.damage);
    assert!(half.messages > 0 && half.messages < whole.messages);
    assert_eq!(half.bytes, log.len() as u64 / 2);
}

#[test]
fn only_the_wanted_topics_are_given() {
    let log = log_of(&events(12), &WriterOptions::default());
    let wanted = [Topic::Joystick, Topic::Step];
    let reader = LogReader::new(log.as_slice()).expect("opens").only(&wanted);
    let topics: Vec<Topic> = reader.map(|event| Topic::of(&event.expect("reads").value)).collect();
    assert_eq!(topics, wanted.repeat(12));
}

#[test]
fn a_missing_file_is_the_file_systems_error() {
    let Err(error) = LogReader::open("no/such/file.mcap") else { panic!("opened") };
    assert!(matches!(&error, LogError::Io(error) if error.kind() == io::ErrorKind::NotFound));
    assert!(!error.is_damage());
}
