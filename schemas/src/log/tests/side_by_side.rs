//! Contract of a log with two runs: each comes back as it was written, with its own head; whoever
//! knows nothing of arms reads B; one file keeps the order of time.

use super::session::{bare, events, header, log_of, read, text};
use crate::log::info::inspect_source;
use crate::log::{
    Arm, LogError, LogReader, SideBySide, Stop, Topic, WriteAbError, WriterOptions, write_ab,
};
use crate::{Event, Header, Span, Stamped};

/// A second run: another controller, every event half a control period later, and fewer of them.
fn other() -> (Header, Vec<Stamped<Event>>) {
    let mut header = header();
    "paper-kinematic".clone_into(&mut header.run.controller);
    "playback".clone_into(&mut header.run.driver);
    "gamma3 = 1.0\n".clone_into(&mut header.params_toml);
    let mut events = events(15);
    for event in &mut events {
        event.at = event.at + Span(50_000_000);
    }
    (header, events)
}

fn pull<E>(
    events: &[Stamped<Event>],
) -> impl FnMut() -> Result<Option<Stamped<Event>>, E> + use<'_, E> {
    let mut events = events.iter().cloned();
    move || Ok(events.next())
}

fn both(options: &WriterOptions) -> Vec<u8> {
    let (b_header, b) = other();
    let written = write_ab::<_, LogError>(
        Vec::new(),
        [&header(), &b_header],
        options,
        pull(&events(25)),
        pull(&b),
        || None,
    );
    written.expect("a vector takes all").0
}

fn read_arm(log: &[u8], arm: Arm) -> (Header, Vec<Stamped<Event>>) {
    let mut reader = LogReader::new(log).expect("a log").arm(arm).expect("two runs");
    let header = reader.header().clone();
    let events = reader.by_ref().collect::<Result<Vec<_>, _>>().expect("whole");
    assert!(reader.is_complete());
    (header, events)
}

#[test]
fn both_runs_come_back_with_their_heads() {
    let (b_header, b) = other();
    for options in [bare(4096), WriterOptions::offline()] {
        let log = both(&options);
        let (head, back) = read_arm(&log, Arm::A);
        assert_eq!((head, text(&back)), (header(), text(&events(25))));
        let (head, back) = read_arm(&log, Arm::B);
        assert_eq!((head, text(&back)), (b_header.clone(), text(&b)));
    }
}

#[test]
fn a_reader_that_is_not_told_reads_b() {
    let log = both(&WriterOptions::default());
    let reader = LogReader::new(log.as_slice()).expect("a log");
    assert!(reader.has_arms());
    assert_eq!(reader.header().run.controller, "paper-kinematic");
    let (back, error, complete) = read(&log);
    assert!(error.is_none() && complete);
    assert_eq!(text(&back), text(&other().1));
    // And only what it wants of it.
    let steps = LogReader::new(log.as_slice()).expect("a log").only(&[Topic::Step]);
    assert_eq!(steps.filter_map(Result::ok).count(), 15);
}

#[test]
fn a_log_of_one_run_has_no_arms() {
    let log = log_of(&events(3), &WriterOptions::default());
    let reader = LogReader::new(log.as_slice()).expect("a log");
    assert!(!reader.has_arms());
    assert!(matches!(reader.arm(Arm::B), Err(LogError::OneRun)));
}

#[test]
fn the_file_keeps_the_order_of_time() {
    let log = both(&WriterOptions::default());
    let mut last = 0;
    let (mut a, mut b) = (0, 0);
    for message in mcap::MessageStream::new(&log).expect("MCAP") {
        let message = message.expect("whole");
        assert!(message.log_time >= last, "{} goes back", message.channel.topic);
        last = message.log_time;
        a += usize::from(message.channel.topic.starts_with("/A/"));
        b += usize::from(message.channel.topic.starts_with("/B/"));
    }
    let info = inspect_source(log.as_slice()).expect("a log");
    assert!(info.complete);
    assert_eq!(info.messages as usize, a + b);
    let count = |topic: &str| info.channels.iter().find(|c| c.topic == topic).map(|c| c.count);
    assert_eq!((count("/A/step"), count("/B/step"), count("/step")), (Some(25), Some(15), None));
    assert!(count("/A/scene") > Some(20) && count("/B/scene") > Some(10));
    // Schemas are shared: one per message, not per arm.
    let summary = mcap::Summary::read(&log).expect("MCAP").expect("a summary");
    let names: Vec<_> = summary.schemas.values().map(|schema| schema.name.clone()).collect();
    assert_eq!(names.iter().filter(|name| *name == "tandem.v1.Step").count(), 1);
}

#[test]
fn a_run_that_goes_back_or_behind_the_other_is_refused() {
    let all = events(2);
    let mut log = SideBySide::new(Vec::new(), [&header(), &header()], &bare(4096)).expect("starts");
    log.write(Arm::A, &all[3]).expect("in order");
    log.write(Arm::B, &all[3]).expect("the same instant in the other run");
    assert!(matches!(log.write(Arm::B, &all[3]), Err(LogError::Order { .. })));
    assert!(matches!(log.write(Arm::A, &all[2]), Err(LogError::Order { .. })));
    log.write(Arm::A, &all[5]).expect("in order");
    assert!(matches!(log.write(Arm::B, &all[4]), Err(LogError::Order { .. })));
}

/// Runs that were stopped read to where they were, and then say so; nobody takes them for whole.
#[test]
fn runs_that_were_stopped_say_so() {
    let written = |periods, by| {
        let (header, events) = (header(), events(periods));
        let (a, b) = (pull::<LogError>(&events), pull(&events));
        write_ab(Vec::new(), [&header, &header], &bare(4096), a, b, || Some(by))
            .expect("a vector takes all")
            .0
    };
    let log = written(25, Stop::Source);
    for arm in [Arm::A, Arm::B] {
        let mut reader = LogReader::new(&log[..]).expect("a log").arm(arm).expect("two runs");
        let mut read = Vec::new();
        let end = loop {
            match reader.next_event() {
                Ok(event) => read.push(event.expect("it says that it was stopped")),
                Err(error) => break error,
            }
        };
        assert_eq!(text(&read), text(&events(25)));
        let says = matches!(end, LogError::Stopped { by: Stop::Source, after: Some(_) });
        assert!(says && end.is_damage(), "{end}");
        assert!(!reader.is_complete());
        assert!(matches!(reader.next_event(), Ok(None)));
    }
    let info = inspect_source(&log[..]).expect("a log");
    assert!(!info.complete && matches!(info.damage, Some(LogError::Stopped { .. })));
    // Everybody else reads a whole MCAP file.
    let messages = mcap::MessageStream::new(&log).expect("MCAP").map(Result::unwrap).count();
    assert_eq!(messages, 2 * events(25).len());
    let nothing = inspect_source(&written(0, Stop::Told)[..]).expect("a log");
    let told = Some(LogError::Stopped { by: Stop::Told, after: None });
    assert_eq!(format!("{:?}", nothing.damage), format!("{told:?}"));
}

#[test]
fn a_run_that_fails_is_the_error() {
    let mut count = 0;
    let failing = || {
        count += 1;
        if count < 5 { Ok(events(1).get(count).cloned()) } else { Err("out of paper") }
    };
    let heads = [&header(), &header()];
    let result = write_ab(Vec::new(), heads, &bare(4096), pull(&events(2)), failing, || None);
    assert!(matches!(result, Err(WriteAbError::Run("out of paper"))));
}
