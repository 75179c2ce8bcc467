//! Files that other programs made: rewritten logs are read, other things are named for what they are.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::MessageHeader;
use mcap::write::Metadata;

use super::session::{events, header, read, text};
use crate::log::header::{PARAMS, RUN, SCENARIO, STOPPED, to_map};
use crate::log::info::inspect_source;
use crate::log::reader::Opened;
use crate::log::{Encoder, LogError, LogReader, Stop, Topic, descriptors};
use crate::{FORMAT_VERSION, Header};

type Mcap = mcap::Writer<Cursor<Vec<u8>>>;

/// A file made with another writer: `fill` puts in what it likes.
fn file(options: mcap::WriteOptions, fill: impl FnOnce(&mut Mcap)) -> Vec<u8> {
    let mut mcap = options.create(Cursor::new(Vec::new())).expect("memory takes all");
    fill(&mut mcap);
    mcap.finish().expect("memory takes all");
    mcap.into_inner().into_inner()
}

fn put_head(mcap: &mut Mcap, header: &Header) {
    let metadata = Metadata { name: RUN.to_owned(), metadata: to_map(&header.run) };
    mcap.write_metadata(&metadata).expect("memory takes all");
    put_attachment(mcap, PARAMS, header.params_toml.as_bytes());
    put_attachment(mcap, SCENARIO, header.scenario.to_toml().as_bytes());
}

fn put_attachment(mcap: &mut Mcap, name: &str, data: &[u8]) {
    mcap.attach(&mcap::Attachment {
        log_time: 1,
        create_time: 1,
        name: name.to_owned(),
        media_type: "text/plain".to_owned(),
        data: Cow::Borrowed(data),
    })
    .expect("memory takes all");
}

/// One message on a channel of one's own choosing.
fn put(mcap: &mut Mcap, topic: &str, schema: &str, at: u64, data: &[u8]) {
    let schema = mcap.add_schema(schema, "protobuf", b"").expect("memory takes all");
    let channel_id =
        mcap.add_channel(schema, topic, "protobuf", &BTreeMap::new()).expect("memory takes all");
    let head = MessageHeader { channel_id, sequence: 0, log_time: at, publish_time: at };
    mcap.write_to_known_channel(&head, data).expect("memory takes all");
}

fn default() -> mcap::WriteOptions {
    mcap::WriteOptions::new()
}

fn only_error(log: &[u8]) -> LogError {
    match LogReader::new(log) {
        Ok(_) => panic!("this should not open"),
        Err(error) => error,
    }
}

#[test]
fn a_log_rewritten_by_another_program_reads_the_same() {
    let written = events(4);
    let variants = [
        ("no compression", default().compression(None)),
        ("lz4", default().compression(Some(mcap::Compression::Lz4))),
        ("no chunks", default().use_chunks(false)),
        ("zstd, sums left out", {
            default().calculate_chunk_crcs(false).calculate_data_section_crc(false)
        }),
        ("no summary", default().emit_summary_records(false).emit_message_indexes(false)),
    ];
    for (name, options) in variants {
        let log = file(options, |mcap| {
            put_head(mcap, &header());
            let mut encoder = Encoder::new();
            for event in &written {
                // A topic of somebody else's between ours.
                put(mcap, "/elsewhere", "other.Message", event.at.0, b"\xff\xff");
                let info = Topic::of(&event.value).info();
                let (topic, data) = encoder.encode(&event.value);
                put(mcap, topic, info.schema, event.at.0, data);
            }
        });
        let (back, error, complete) = read(&log);
        assert!(error.is_none(), "{name}: {error:?}");
        assert!(complete, "{name}");
        assert_eq!(text(&back), text(&written), "{name}");
        for cut in (0..log.len()).step_by(5) {
            let (back, error, _) = read(&log[..cut]);
            assert!(error.is_some(), "{name} cut at {cut}");
            assert_eq!(text(&back), text(&written[..back.len()]), "{name} cut at {cut}");
        }
    }
}

#[test]
fn what_is_no_log_is_named_for_what_it_is() {
    let cases: [(&[u8], &str); 4] = [
        (b"", "not an MCAP file: it is empty"),
        (b"x", "not an MCAP file: its first bytes are other"),
        (b"a text file, longer than the magic", "not an MCAP file: its first bytes are other"),
        (b"\x89MCAP0\r\n", "cut off at byte 8"),
    ];
    for (bytes, message) in cases {
        let error = only_error(bytes).to_string();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn an_mcap_file_without_our_head_is_not_a_session() {
    let foreign = file(default(), |mcap| put(mcap, "/chat", "other.Message", 5, b"x"));
    let error = only_error(&foreign);
    assert!(matches!(&error, LogError::NotASession(_)), "{error:?}");
    assert!(error.to_string().contains("tandem.run"), "{error}");
    assert!(!error.is_damage());

    let empty = file(default(), |_| {});
    assert!(matches!(only_error(&empty), LogError::NotASession(_)));

    let half = file(default(), |mcap| {
        let metadata = Metadata { name: RUN.to_owned(), metadata: to_map(&header().run) };
        mcap.write_metadata(&metadata).expect("memory takes all");
        put_attachment(mcap, PARAMS, b"");
        put(mcap, "/step", "tandem.v1.Step", 5, b"");
    });
    let error = only_error(&half).to_string();
    assert!(error.contains("scenario.toml"), "{error}");
}

#[test]
fn a_newer_format_is_refused_and_an_odd_head_is_explained() {
    let with = |change: &dyn Fn(&mut BTreeMap<String, String>)| {
        file(default(), |mcap| {
            let mut map = to_map(&header().run);
            change(&mut map);
            mcap.write_metadata(&Metadata { name: RUN.to_owned(), metadata: map })
                .expect("memory takes all");
            put_attachment(mcap, PARAMS, b"");
            put_attachment(mcap, SCENARIO, header().scenario.to_toml().as_bytes());
        })
    };
    let newer = with(&|map| {
        map.insert("format_version".to_owned(), (FORMAT_VERSION + 1).to_string());
    });
    assert!(matches!(
        only_error(&newer),
        LogError::TooNew { found, known } if found == FORMAT_VERSION + 1 && known == FORMAT_VERSION
    ));
    let lacking = with(&|map| {
        map.remove("start_ns");
    });
    assert!(only_error(&lacking).to_string().contains("lacks the key `start_ns`"));
    let odd = with(&|map| {
        map.insert("seed".to_owned(), "many".to_owned());
    });
    assert!(only_error(&odd).to_string().contains("`seed` in `tandem.run` is \"many\""));
    // A key that a later version adds does not stop an older reader.
    let added = with(&|map| {
        map.insert("weather".to_owned(), "fine".to_owned());
    });
    assert_eq!(LogReader::new(added.as_slice()).expect("opens").header().run, header().run);
}

#[test]
fn a_scenario_that_cannot_be_used_is_explained_in_one_line() {
    let log = file(default(), |mcap| {
        let metadata = Metadata { name: RUN.to_owned(), metadata: to_map(&header().run) };
        mcap.write_metadata(&metadata).expect("memory takes all");
        put_attachment(mcap, SCENARIO, b"name = 3");
    });
    let error = only_error(&log).to_string();
    assert!(error.contains("attachment `scenario.toml`: "), "{error}");
    assert!(!error.contains('\n'), "{error}");
}

#[test]
fn another_message_on_one_of_our_topics_is_an_error_on_an_unread_topic_it_is_none() {
    let log = file(default(), |mcap| {
        put_head(mcap, &header());
        put(mcap, "/imu", "sensor_msgs.Imu", 5, b"");
        put(mcap, "/step", "tandem.v1.Step", 6, b"");
    });
    let (_, error, _) = read(&log);
    let error = error.expect("noticed");
    assert!(matches!(error, LogError::Schema { topic: "/imu", .. }), "{error:?}");
    assert!(error.to_string().contains("sensor_msgs.Imu"), "{error}");

    let mut reader = LogReader::new(log.as_slice()).expect("opens").only(&[Topic::Step]);
    assert_eq!(reader.next_event().expect("reads").map(|event| event.at.0), Some(6));
    assert!(reader.next_event().expect("reads").is_none());
    assert!(reader.is_complete());
}

#[test]
fn an_undecodable_message_is_named_by_topic_and_place() {
    let log = file(default(), |mcap| {
        put_head(mcap, &header());
        put(mcap, "/command", "tandem.v1.Command", header().run.start.0 + 1, b"");
        put(mcap, "/step", "tandem.v1.Step", header().run.start.0 + 2, b"\xff\xff\xff");
    });
    let (back, error, _) = read(&log);
    assert_eq!(back.len(), 1);
    assert!(matches!(error, Some(LogError::Decode { topic: "/step", .. })), "{error:?}");
}

// The contract: log times of events increase strictly, as the writer makes them.
#[test]
fn times_that_do_not_increase_are_an_error() {
    for (last, what) in [(4, "goes back"), (6, "repeats")] {
        let log = file(default(), |mcap| {
            put_head(mcap, &header());
            for at in [5, 6, last] {
                put(mcap, "/command", "tandem.v1.Command", at, b"");
            }
        });
        let (back, error, _) = read(&log);
        assert_eq!(back.iter().map(|event| event.at.0).collect::<Vec<_>>(), [5, 6], "{what}");
        assert!(
            matches!(&error, Some(LogError::Order { topic: "/command", at, previous })
                if at.0 == last && previous.0 == 6),
            "{what}: {error:?}"
        );
    }
}

#[test]
fn nothing_is_given_behind_the_mark_of_a_stop() {
    for before in [0, 2] {
        let log = file(default(), |mcap| {
            put_head(mcap, &header());
            (1..=before).for_each(|at| put(mcap, "/other", "tandem.v1.Imu", at, b"abc"));
            let mark = Metadata { name: STOPPED.to_owned(), metadata: BTreeMap::new() };
            mcap.write_metadata(&mark).expect("memory takes all");
            put(mcap, "/other", "tandem.v1.Imu", before + 1, b"abc");
        });
        let mut opened = Opened::new(&log[..]).expect("the head is whole");
        for message in 0..before {
            assert!(matches!(opened.next(), Ok(Some(_))), "{message} of {before}");
        }
        let stop = opened.next().expect_err("the mark");
        assert!(matches!(stop, LogError::Stopped { by: Stop::Told, .. }), "{before}: {stop}");
        for _ in 0..2 {
            assert!(matches!(opened.next(), Ok(None)), "{before}");
        }
        assert!(!opened.messages.is_complete(), "{before}");
    }
}

/// A whole record by hand.
fn record(opcode: u8, claimed: u64, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &claimed.to_le_bytes(), body].concat()
}

/// A chunk record by hand, with its claims.
fn chunk(uncompressed: u64, compression: &str, compressed: u64, data: &[u8]) -> Vec<u8> {
    let mut body = vec![0; 16];
    body.extend(uncompressed.to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend((compression.len() as u32).to_le_bytes());
    body.extend(compression.as_bytes());
    body.extend(compressed.to_le_bytes());
    body.extend(data);
    body
}

#[test]
fn hostile_lengths_are_refused_without_believing_them() {
    let whole = file(default(), |mcap| put_head(mcap, &header()));
    let head = &whole[..mcap_data_end(&whole)];
    let bomb = zstd::bulk::compress(&vec![0; 1 << 20], 1).expect("compresses");
    let text_claim = [&[1, 0][..], &u32::MAX.to_le_bytes(), b"abc"].concat();
    let cases = [
        ("endless chunk", record(0x06, u64::MAX, b"")),
        ("endless message", record(0x05, u64::MAX, b"")),
        ("endless attachment", record(0x09, u64::MAX, b"abc")),
        ("endless unknown record", record(0x99, 1 << 62, b"abc")),
        ("endless text in a schema", record(0x03, text_claim.len() as u64, &text_claim)),
        ("huge content", {
            let body = chunk(1 << 62, "zstd", 3, b"abc");
            record(0x06, body.len() as u64, &body)
        }),
        ("more data than the record", {
            let body = chunk(10, "", 1 << 40, b"abc");
            record(0x06, body.len() as u64, &body)
        }),
        ("a compressed bomb that claims little", {
            let body = chunk(10, "zstd", bomb.len() as u64, &bomb);
            record(0x06, body.len() as u64, &body)
        }),
        ("a compression nobody knows", {
            let body = chunk(3, "xz", 3, b"abc");
            record(0x06, body.len() as u64, &body)
        }),
        ("a record beyond its chunk", {
            let data = record(0x05, 1 << 50, b"");
            let body = chunk(data.len() as u64, "", data.len() as u64, &data);
            record(0x06, body.len() as u64, &body)
        }),
        ("a message on no channel", {
            let data = record(0x05, 22, &[7; 22]);
            let body = chunk(data.len() as u64, "", data.len() as u64, &data);
            record(0x06, body.len() as u64, &body)
        }),
    ];
    for (name, hostile) in cases {
        let log = [head, &hostile].concat();
        let mut reader = LogReader::new(log.as_slice()).expect("the head is whole");
        let error = reader.next_event().expect_err(name);
        assert!(error.is_damage(), "{name}: {error:?}");
        assert!(reader.buffered_bytes() < 4 << 20, "{name}: {}", reader.buffered_bytes());
    }
}

/// A channel record by hand: no schema, a topic that is none of ours.
fn channel(id: u16) -> Vec<u8> {
    let topic = b"/other";
    let mut body = [id.to_le_bytes(), [0; 2]].concat();
    body.extend((topic.len() as u32).to_le_bytes());
    body.extend(topic);
    // No encoding, no further notes.
    body.extend([0; 8]);
    record(0x04, body.len() as u64, &body)
}

/// A message record by hand, with three bytes of payload.
fn message(channel: u16, at: u64) -> Vec<u8> {
    let mut body = channel.to_le_bytes().to_vec();
    body.extend(0_u32.to_le_bytes());
    body.extend([at.to_le_bytes(), at.to_le_bytes()].concat());
    body.extend(b"abc");
    record(0x05, body.len() as u64, &body)
}

#[test]
fn a_message_on_a_channel_not_yet_declared_is_damage_anywhere_in_a_chunk() {
    let whole = file(default(), |mcap| put_head(mcap, &header()));
    let head = &whole[..mcap_data_end(&whole)];
    // The chunk, the data end and the footer carry no check sum: only the channel can tell.
    let log = |records: &[Vec<u8>]| {
        let data = records.concat();
        let body = chunk(data.len() as u64, "", data.len() as u64, &data);
        let chunk = record(0x06, body.len() as u64, &body);
        let end = [record(0x0F, 4, &[0; 4]), record(0x02, 20, &[0; 20])].concat();
        [head, &chunk, &end, b"\x89MCAP0\r\n"].concat()
    };
    let declared = [channel(1), channel(7), message(1, 1), message(7, 2), message(1, 3)];
    let info = inspect_source(&log(&declared)[..]).expect("a log");
    assert!(info.complete && info.messages == 3, "{info:?}");

    let never = [channel(1), message(1, 1), message(7, 2), message(1, 3)];
    let later = [channel(1), message(1, 1), message(7, 2), channel(7), message(7, 3)];
    // Behind a record that is no message, and as the last one.
    let behind = [channel(1), message(1, 1), channel(2), message(7, 2), message(2, 3)];
    let last = [channel(1), message(1, 1), message(7, 2)];
    for (name, records) in
        [("never", &never[..]), ("later", &later), ("behind", &behind), ("last", &last)]
    {
        let log = log(records);
        let info = inspect_source(&log[..]).expect("the head is whole");
        assert!(!info.complete && info.messages == 1, "{name}: {info:?}");
        let mut reader = LogReader::new(&log[..]).expect("the head is whole");
        for error in [info.damage, reader.next_event().err()] {
            let Some(LogError::Damaged { at_byte, what, .. }) = error else {
                panic!("{name}: {error:?}");
            };
            assert_eq!(at_byte, head.len() as u64, "{name}");
            assert_eq!(what, "a message belongs to channel 7, which is unknown", "{name}");
        }
        assert!(matches!(reader.next_event(), Ok(None)) && !reader.is_complete(), "{name}");
    }
}

/// Where the data section ends, by walking over the records.
fn mcap_data_end(log: &[u8]) -> usize {
    let mut at = 8;
    while log[at] != 0x0F {
        let length = u64::from_le_bytes(log[at + 1..at + 9].try_into().expect("eight bytes"));
        at += 9 + length as usize;
    }
    at
}

#[test]
fn every_channel_is_described_by_itself() {
    // The contract of a self-contained schema: the set names every file that its files import, and
    // defines the message that the channel carries.
    for info in super::super::TOPICS {
        let data = descriptors::schema_data(info.topic);
        let set = <prost_types::FileDescriptorSet as prost::Message>::decode(data.as_slice())
            .expect("a descriptor set");
        let files: Vec<&str> =
            set.file.iter().map(prost_types::FileDescriptorProto::name).collect();
        for file in &set.file {
            assert!(file.source_code_info.is_none(), "{}: comments in {}", info.name, file.name());
            for import in &file.dependency {
                assert!(files.contains(&import.as_str()), "{}: {import} is missing", info.name);
            }
        }
        let defined = set.file.iter().any(|file| {
            file.message_type
                .iter()
                .any(|m| format!("{}.{}", file.package(), m.name()) == info.schema)
        });
        assert!(defined, "{}: {} is not defined", info.name, info.schema);
        // Nothing beyond what is needed: /imu imports nothing.
        if info.topic == Topic::Imu {
            assert_eq!(files, ["tandem/v1/imu.proto"]);
        }
    }
}
