//! When which streams of a recording were silent.

use std::collections::BTreeMap;

use schemas::log::Topic;
use schemas::{Event, Gap, Time};

/// Streams with the stretches in which they said nothing: open intervals, in order, none within reach of
/// another.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Silence(BTreeMap<String, Vec<(Time, Time)>>);

impl Silence {
    /// That of a recording's notes, in whatever order they come.
    pub(super) fn of(gaps: &[Gap]) -> Silence {
        let mut sorted: Vec<&Gap> = gaps.iter().filter(|gap| gap.start < gap.end).collect();
        sorted.sort_by_key(|gap| gap.start);
        let mut streams: BTreeMap<String, Vec<(Time, Time)>> = BTreeMap::new();
        for gap in sorted {
            let stream = streams.entry(gap.stream.clone()).or_default();
            match stream.last_mut() {
                // Those that overlap are one; where one ends as the next begins, a sample stands between.
                Some((_, end)) if gap.start < *end => *end = gap.end.max(*end),
                _ => stream.push((gap.start, gap.end)),
            }
        }
        Silence(streams)
    }

    /// Whether an event is a sample from within a silence of its stream.
    pub(super) fn swallows(&self, event: &Event) -> bool {
        if self.0.is_empty() {
            return false;
        }
        let Event::Sample(sample) = event else { return false };
        let Some(stream) = self.0.get(Topic::of(event).name()) else { return false };
        let stamp = sample.stamp();
        let begun = stream.partition_point(|(start, _)| *start < stamp);
        begun > 0 && stamp < stream[begun - 1].1
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use schemas::{ImuSample, Sample};

    use super::*;

    fn gap(stream: &str, start: u64, end: u64) -> Gap {
        Gap { stream: stream.to_owned(), start: Time(start), end: Time(end), ..Gap::default() }
    }

    fn imu(stamp: u64) -> Event {
        Event::Sample(Sample::Imu(ImuSample {
            stamp: Time(stamp),
            accel_mps2: [0.0; 3],
            gyro_radps: [0.0; 3],
            mag_ut: [0.0; 3],
        }))
    }

    /// The first and the last sample of a gap are those that were heard.
    #[test]
    fn a_gap_begins_after_a_sample_and_ends_before_one() {
        let silence =
            Silence::of(&[gap("/imu", 20, 30), gap("/imu", 10, 20), gap("/sonar", 0, 99)]);
        let lost: Vec<u64> = (0..40).filter(|stamp| silence.swallows(&imu(*stamp))).collect();
        let expected: Vec<u64> = (11..20).chain(21..30).collect();
        assert_eq!(lost, expected);
    }

    proptest! {
        /// The same as asking every gap.
        #[test]
        fn gaps_are_found_as_if_each_were_asked(
            ends in prop::collection::vec((0_u64..40, 0_u64..40), 0..12),
        ) {
            let gaps: Vec<Gap> = ends.iter().map(|(start, end)| gap("/imu", *start, *end)).collect();
            let silence = Silence::of(&gaps);
            for stamp in 0..41 {
                let asked = ends.iter().any(|(start, end)| *start < stamp && stamp < *end);
                prop_assert_eq!(silence.swallows(&imu(stamp)), asked, "{}", stamp);
            }
        }
    }
}
