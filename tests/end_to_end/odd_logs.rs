//! Logs as the field leaves them: with gaps, missing topics, numbers that are none, times that go back,
//! heads of other versions. Each has a defined result, the same every time, and none is a panic.

use std::fs;
use std::path::Path;

use mcap::records::MessageHeader;
use schemas::log::{LogReader, Topic, WriterOptions, create};
use schemas::{Event, Sample, Stamped};
use serde_json::Value;

use crate::program::{Run, Workplace};

/// The same log with some of its events other ones, or none.
fn edit(from: &Path, to: &Path, mut change: impl FnMut(Stamped<Event>) -> Option<Stamped<Event>>) {
    let mut log = LogReader::open(from).unwrap();
    let mut edited = create(to, log.header(), &WriterOptions::offline()).unwrap();
    while let Some(event) = log.next_event().unwrap() {
        if let Some(event) = change(event) {
            edited.write(&event).unwrap();
        }
    }
    edited.finish().unwrap();
}

/// The same file, message by message, with another head or other times, as another program might write.
fn forge(
    from: &Path,
    to: &Path,
    head: impl Fn(&mut std::collections::BTreeMap<String, String>),
    time: impl Fn(usize, u64) -> u64,
) {
    let bytes = fs::read(from).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let mut forged = mcap::Writer::new(fs::File::create(to).unwrap()).unwrap();
    for index in &summary.metadata_indexes {
        let mut metadata = mcap::read::metadata(&bytes, index).unwrap();
        head(&mut metadata.metadata);
        forged.write_metadata(&metadata).unwrap();
    }
    for index in &summary.attachment_indexes {
        forged.attach(&mcap::read::attachment(&bytes, index).unwrap()).unwrap();
    }
    for (number, message) in mcap::MessageStream::new(&bytes).unwrap().enumerate() {
        let message = message.unwrap();
        let channel = &message.channel;
        let schema = channel.schema.as_ref().unwrap();
        let schema = forged.add_schema(&schema.name, &schema.encoding, &schema.data).unwrap();
        let id = forged
            .add_channel(schema, &channel.topic, &channel.message_encoding, &channel.metadata)
            .unwrap();
        let header = MessageHeader {
            channel_id: id,
            sequence: message.sequence,
            log_time: time(number, message.log_time),
            publish_time: message.publish_time,
        };
        forged.write_to_known_channel(&header, &message.data).unwrap();
    }
    forged.finish().unwrap();
}

fn topic(event: &Stamped<Event>) -> Topic {
    Topic::of(&event.value)
}

/// Seconds from the start of a simulated session.
fn seconds(event: &Stamped<Event>) -> f64 {
    event.at.seconds_since(schemas::SIMULATION_EPOCH)
}

/// The same log, without a field in the steps that are asked for.
fn lose(from: &Path, to: &Path, lost: impl Fn(f64) -> bool) {
    edit(from, to, |mut event| {
        let at_s = seconds(&event);
        if let Event::Step(step) = &mut event.value
            && lost(at_s)
        {
            step.safety_clear_m = None;
        }
        Some(event)
    });
}

/// A log that is older than a field comes back as it is; one that lacks the field in one step has lost it there,
/// and `replay` and `diff` say where.
#[test]
fn a_field_that_is_not_there() {
    let here = Workplace::new();
    let whole = session(&here);
    lose(&whole, &here.path("older.mcap"), |_| true);
    lose(&whole, &here.path("lost.mcap"), |at_s| (3.99..4.01).contains(&at_s));
    assert_eq!(replay(&here, "open", "older.mcap")["identical_to_recorded"], true);
    here.tandem("diff older.mcap whole.mcap").succeeds();
    let lost = replay(&here, "open", "lost.mcap");
    assert_eq!(lost["identical_to_recorded"], false);
    assert_eq!(lost["max_deviation_field"], "safety_clear_m");
    assert_eq!(lost["max_deviation_at_s"], 4.0);
    assert_eq!(
        (&lost["first_cause"]["a"], &lost["first_cause"]["t_s"]),
        (&"absent".into(), &4.0.into())
    );
    let text = here.tandem("replay lost.mcap").exits(1).stdout;
    assert!(text.contains("safety_clear_m is known to one of both only at 4.00 s"), "{text}");
    let diff = here.tandem("diff --format json whole.mcap lost.mcap").exits(1).json();
    assert_eq!(diff["fields"].as_array().unwrap().len(), 1, "{diff}");
    assert_eq!(diff["fields"][0]["count"], 1);
    let cause = &diff["first_cause"];
    assert_eq!((&cause["field"], &cause["t_s"]), (&"safety_clear_m".into(), &4.0.into()), "{diff}");
    assert_eq!(cause["b"], "absent");
}

/// Twice replayed, it is twice the same. In open loop the recording controller says by its exit status
/// whether it is the recording.
fn replay(here: &Workplace, mode: &str, log: &str) -> Value {
    let run = |_| -> Run { here.tandem(&format!("replay --format json --mode {mode} {log}")) };
    let [once, again] = [0, 1].map(run).map(|run| {
        let result = run.json()["runs"][0].clone();
        let differs = mode == "open" && result["identical_to_recorded"] == false;
        run.exits(i32::from(differs));
        result
    });
    assert_eq!(once["output_hash"], again["output_hash"], "{mode} {log}");
    assert!(once["error"].is_null(), "{once}");
    once
}

fn session(here: &Workplace) -> std::path::PathBuf {
    here.record("whole.mcap", "--scenario random:rect:flowing:3 --duration 8")
}

/// A stream that falls silent for a while, and a hole in all of them: the rest is replayed, step by step
/// as they were recorded; the controller was deaf, so it says something else than it did.
#[test]
fn gaps() {
    let here = Workplace::new();
    let whole = session(&here);
    let steps = replay(&here, "open", "whole.mcap")["steps"].as_u64().unwrap();
    let inside = |event: &Stamped<Event>| (3.0..5.0).contains(&seconds(event));
    for silent in [Topic::Sonar, Topic::Imu, Topic::Encoders, Topic::Joystick] {
        edit(&whole, &here.path("gap.mcap"), |event| {
            (topic(&event) != silent || !inside(&event)).then_some(event)
        });
        let run = replay(&here, "open", "gap.mcap");
        assert_eq!(run["steps"], steps, "{silent:?}");
        assert_eq!(run["identical_to_recorded"], false, "{silent:?}");
        let at_s = run["max_deviation_at_s"].as_f64().unwrap();
        assert!(at_s >= 3.0, "{silent:?}: before the gap nothing differs, but at {at_s}");
        // A closed loop makes its own sensors; a joystick that was silent asks for nothing.
        let closed = replay(&here, "closed", "gap.mcap");
        assert_eq!(closed["steps"], steps, "{silent:?}");
    }
    edit(&whole, &here.path("hole.mcap"), |event| (!inside(&event)).then_some(event));
    let open = replay(&here, "open", "hole.mcap");
    // 3.0, 3.1, …, 4.9 s are gone.
    assert_eq!(open["steps"], steps - 20);
    assert_eq!(replay(&here, "closed", "hole.mcap")["steps"], steps);
}

/// Topics that were never there: what can be done without them is done, the rest is refused by name.
#[test]
fn missing_topics() {
    let here = Workplace::new();
    let whole = session(&here);
    let steps = replay(&here, "open", "whole.mcap")["steps"].clone();
    for gone in [Topic::Sonar, Topic::Imu, Topic::Encoders, Topic::Joystick, Topic::Truth] {
        edit(&whole, &here.path("less.mcap"), |event| (topic(&event) != gone).then_some(event));
        let run = replay(&here, "open", "less.mcap");
        assert_eq!(run["steps"], steps, "{gone:?}");
        // The truth is nothing that a controller hears.
        assert_eq!(run["identical_to_recorded"], gone == Topic::Truth, "{gone:?}");
        if gone == Topic::Joystick {
            let run = here.tandem("replay --mode closed less.mcap").exits(2);
            assert!(run.error_line().contains("no /joystick message"), "{}", run.stderr);
        } else {
            assert_eq!(replay(&here, "closed", "less.mcap")["steps"], steps, "{gone:?}");
        }
    }
    edit(&whole, &here.path("idle.mcap"), |event| {
        (!matches!(topic(&event), Topic::Step | Topic::Command)).then_some(event)
    });
    let run = here.tandem("replay idle.mcap").exits(2);
    assert!(run.error_line().contains("no controller step"), "{}", run.stderr);
    // In closed loop the controller makes its own steps; there are none to be identical to.
    let run = replay(&here, "closed", "idle.mcap");
    // The last one comes after the last thing that the log holds.
    assert_eq!(run["steps"].as_u64(), steps.as_u64().map(|steps| steps - 1));
    assert_eq!(run["identical_to_recorded"], false);
}

/// A number that is none, in each stream for two seconds: no command becomes one.
#[test]
fn numbers_that_are_none() {
    let here = Workplace::new();
    let whole = session(&here);
    let steps = replay(&here, "open", "whole.mcap")["steps"].clone();
    for (number, bad) in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300].into_iter().enumerate() {
        edit(&whole, &here.path("odd.mcap"), |mut event| {
            if (3.0..5.0).contains(&seconds(&event)) {
                match &mut event.value {
                    Event::Sample(Sample::Sonar(scan)) => {
                        scan.echoes.iter_mut().for_each(|echo| echo.range_m = bad);
                    }
                    Event::Sample(Sample::Imu(imu)) => imu.gyro_radps[2] = bad,
                    Event::Sample(Sample::Encoders(encoders)) => encoders.left_m = bad,
                    Event::Sample(Sample::Joystick(joystick)) => joystick.v_mps = bad,
                    Event::Truth(truth) => truth.pose.x_m = bad,
                    _ => {}
                }
            }
            Some(event)
        });
        for mode in ["open", "closed"] {
            let began = std::time::Instant::now();
            assert_eq!(replay(&here, mode, "odd.mcap")["steps"], steps, "{mode} {bad}");
            // One pose that is far off must not make a search of the whole universe, which would take
            // forever; ten minutes are for a machine that has much else to do.
            assert!(began.elapsed().as_secs() < 600, "{mode} {bad}: {:?}", began.elapsed());
            let out = format!("{mode}{number}.mcap");
            let status = i32::from(mode == "open");
            here.tandem(&format!("replay --mode {mode} odd.mcap -o {out}")).exits(status);
            for event in LogReader::open(here.path(&out)).unwrap() {
                if let Event::Command(command) = event.unwrap().value {
                    let twist = command.twist;
                    assert!(
                        twist.v_mps.is_finite() && twist.omega_radps.is_finite(),
                        "{mode} {bad}: {twist:?}"
                    );
                }
            }
        }
        here.tandem("map odd.mcap -o room.toml --force").succeeds();
    }
}

/// Times that go back or stand still end a log there: what stands before is replayed, and the exit status
/// says that it was not all.
#[test]
fn times_that_go_back() {
    let here = Workplace::new();
    let whole = session(&here);
    let steps = replay(&here, "open", "whole.mcap")["steps"].as_u64().unwrap();
    for back_ns in [0, 1_000_000_000] {
        // One message in the middle has the time of the one before it, or an earlier one.
        let at = 2000;
        forge(
            &whole,
            &here.path("back.mcap"),
            |_| {},
            |number, time| {
                if number == at { time - 1_000_000_000 - back_ns } else { time }
            },
        );
        for mode in ["open", "closed"] {
            let run =
                here.tandem(&format!("replay --format json --mode {mode} back.mcap")).exits(1);
            let result = run.json()["runs"][0].clone();
            let error = result["error"].as_str().unwrap();
            assert!(error.contains("log time does not increase"), "{error}");
            let replayed = result["steps"].as_u64().unwrap();
            assert!(0 < replayed && replayed < steps, "{replayed} of {steps}");
            assert_eq!(result["identical_to_recorded"], false);
        }
    }
}

/// A head with fewer keys, as older programs wrote it, or with more, reads as if nothing were missing; a
/// version that never was or is not known yet is refused.
#[test]
fn heads_of_other_versions() {
    let here = Workplace::new();
    let whole = session(&here);
    let hash = replay(&here, "open", "whole.mcap")["output_hash"].clone();
    forge(
        &whole,
        &here.path("old.mcap"),
        |head| {
            head.retain(|key, _| !["commit", "dirty", "note", "operator"].contains(&key.as_str()));
        },
        |_, time| time,
    );
    assert_eq!(replay(&here, "open", "old.mcap")["output_hash"], hash);
    for (version, says) in [("0", "format version 0"), ("2", "format version 2 is newer")] {
        forge(
            &whole,
            &here.path("other.mcap"),
            |head| {
                head.insert("format_version".to_owned(), version.to_owned());
            },
            |_, time| time,
        );
        for command in ["replay", "info", "metrics"] {
            let run = here.tandem(&format!("{command} other.mcap")).exits(2);
            assert!(run.error_line().contains(says), "{command}: {}", run.stderr);
        }
    }
}
