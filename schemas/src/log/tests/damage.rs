//! Damage is named, the whole messages before it are given, nothing panics.

use proptest::collection::vec;
use proptest::prelude::*;

use super::session::{bare, events, log_of, read, text};
use crate::Span;
use crate::log::{LogError, WriterOptions};

/// Where each chunk ends, and how many messages have been written by then, according to the index
/// that the `mcap` crate reads.
fn chunks(log: &[u8]) -> Vec<(usize, usize)> {
    let summary = mcap::Summary::read(log).expect("a whole file").expect("with a summary");
    let mut count = 0;
    let each = summary.chunk_indexes.iter().map(|index| {
        count += summary.stream_chunk(log, index).expect("a whole chunk").count();
        ((index.chunk_start_offset + index.chunk_length) as usize, count)
    });
    each.collect()
}

#[test]
fn a_log_cut_at_any_byte_gives_every_whole_message_and_one_error() {
    let written = events(6);
    let expected = text(&written);
    let log = log_of(&written, &bare(600));
    let chunks = chunks(&log);
    assert!(chunks.len() > 3, "several chunks, or the test says little: {}", chunks.len());
    for length in 0..log.len() {
        let (back, error, complete) = read(&log[..length]);
        let whole = chunks.iter().rev().find(|(end, _)| *end <= length).map_or(0, |chunk| chunk.1);
        assert!(back.len() >= whole, "{length} bytes: {} of {whole} messages", back.len());
        assert_eq!(text(&back), expected[..back.len()], "{length} bytes");
        assert!(!complete, "{length} bytes");
        match error {
            Some(LogError::NotMcap(_)) => assert_eq!(length, 0),
            Some(LogError::Truncated { at_byte, .. }) => assert_eq!(at_byte, length as u64),
            other => panic!("{length} bytes: {other:?}"),
        }
    }
}

#[test]
fn the_readable_part_of_a_cut_chunk_is_given() {
    let written = events(2_000);
    let options = WriterOptions { flush_interval: Span(u64::MAX), ..bare(16 << 20) };
    let log = log_of(&written, &options);
    let (end, _) = chunks(&log)[0];
    let (back, error, _) = read(&log[..end * 3 / 5]);
    assert!(matches!(error, Some(LogError::Truncated { .. })), "{error:?}");
    assert!(back.len() > written.len() / 4, "{} of {}", back.len(), written.len());
    assert_eq!(text(&back), text(&written[..back.len()]));
}

#[test]
fn a_changed_byte_anywhere_is_noticed_and_never_becomes_a_message() {
    let written = events(3);
    let expected = text(&written);
    let log = log_of(&written, &bare(600));
    for place in 0..log.len() {
        for mask in [0x01, 0x80, 0xff] {
            let mut changed = log.clone();
            changed[place] ^= mask;
            let (back, error, complete) = read(&changed);
            assert!(error.is_some(), "byte {place} ^ {mask:02x} went unnoticed");
            assert!(!complete, "byte {place} ^ {mask:02x}");
            let same = text(&back).iter().zip(&expected).all(|(a, b)| a == b);
            assert!(same && back.len() <= expected.len(), "byte {place} ^ {mask:02x}");
        }
    }
}

#[test]
fn a_changed_attachment_is_damage_at_its_place() {
    let log = log_of(&events(3), &bare(600));
    let summary = mcap::Summary::read(&log).expect("a whole file").expect("with a summary");
    let attachments = &summary.attachment_indexes;
    assert!(attachments.iter().any(|index| index.name == "scenario.toml"));
    for index in attachments {
        let mut changed = log.clone();
        // The last byte of the content: the check sum of four bytes follows it.
        changed[(index.offset + index.length) as usize - 5] ^= 0x01;
        let (back, error, _) = read(&changed);
        assert!(back.is_empty());
        assert!(
            matches!(&error, Some(LogError::Damaged { at_byte, after: None, what })
                if *at_byte == index.offset && what.contains(&index.name)),
            "{}: {error:?}",
            index.name
        );
    }
}

#[test]
fn an_error_says_where_and_how_far_the_session_can_be_read() {
    let log = log_of(&events(6), &bare(600));
    let chunks = chunks(&log);
    let (second_chunk, _) = chunks[0];
    let mut changed = log.clone();
    // Inside the compressed content of the second chunk.
    let place = usize::midpoint(second_chunk, chunks[1].0);
    changed[place] ^= 0xff;
    let error = read(&changed).1.expect("noticed");
    assert!(error.is_damage());
    let LogError::Damaged { at_byte, after, .. } = &error else { panic!("{error:?}") };
    // Message indexes stand between two chunks.
    assert!((second_chunk as u64..place as u64).contains(at_byte), "{at_byte}");
    assert!(after.is_some_and(|after| (0.0..0.6).contains(&after)), "{after:?}");
    assert!(error.to_string().starts_with("the log is damaged at byte "), "{error}");

    let error = read(&log[..log.len() - 1]).1.expect("noticed");
    assert!(error.is_damage());
    assert!(error.to_string().contains("cut off at byte"), "{error}");
    assert!(error.to_string().contains("after 0.500 s of session"), "{error}");
}

#[test]
fn bytes_behind_the_end_are_damage() {
    let mut log = log_of(&events(1), &bare(600));
    log.push(0);
    let (back, error, complete) = read(&log);
    assert_eq!(back.len(), 10);
    assert!(matches!(error, Some(LogError::Damaged { .. })), "{error:?}");
    assert!(!complete);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_is_done_to_a_log_only_whole_messages_come_out_of_it(
        from in any::<prop::sample::Index>(),
        removed in 0_usize..400,
        inserted in vec(any::<u8>(), 0..200),
    ) {
        let written = events(3);
        let log = log_of(&written, &bare(600));
        let from = from.index(log.len());
        let mut changed = log.clone();
        changed.splice(from..(from + removed).min(log.len()), inserted);
        let (back, error, complete) = read(&changed);
        prop_assert_eq!(complete, changed == log);
        prop_assert_eq!(error.is_none(), changed == log);
        let expected = text(&written);
        prop_assert!(back.len() <= expected.len());
        prop_assert_eq!(text(&back), &expected[..back.len()]);
    }

    #[test]
    fn any_bytes_at_all_are_refused_without_a_panic(bytes in vec(any::<u8>(), 0..300)) {
        let headed = [b"\x89MCAP0\r\n", bytes.as_slice()].concat();
        for bytes in [&bytes, &headed] {
            let (back, error, complete) = read(bytes);
            prop_assert!(back.is_empty() && error.is_some() && !complete);
        }
    }
}
