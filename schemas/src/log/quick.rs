//! Samples decoded straight from their bytes, without a message in between.
//!
//! What a sensor says is a handful of numbers of eight bytes each, and a log holds hundreds of such
//! messages per second. Anything that is not just that (an unknown field, another order of bytes, an end
//! too early) is left to the general decoder, which also says what is wrong.

use super::Topic;
use super::bytes::Bytes;
use crate::{EncoderSample, Event, ImuSample, JoystickSample, Sample, SonarEcho, SonarScan, Time};

/// Protobuf's wire types, the lowest three bits of a field's key.
const VARINT: u8 = 0;
const EIGHT_BYTES: u8 = 1;
const LENGTH: u8 = 2;

/// The event in a message of a sensor or the joystick; `None` where the general decoder has to look.
#[inline]
pub(super) fn decode(topic: Topic, data: &[u8]) -> Option<Event> {
    Some(Event::Sample(match topic {
        Topic::Sonar => Sample::Sonar(sonar(data)?),
        Topic::Imu => {
            let [stamp, ax, ay, az, gx, gy, gz, mx, my, mz] = words(data, no_bit)?;
            Sample::Imu(ImuSample {
                stamp: Time(stamp),
                accel_mps2: [ax, ay, az].map(f64::from_bits),
                gyro_radps: [gx, gy, gz].map(f64::from_bits),
                mag_ut: [mx, my, mz].map(f64::from_bits),
            })
        }
        Topic::Encoders => {
            let [stamp, travel @ ..] = words::<5>(data, no_bit)?;
            let [left_m, right_m, left_mps, right_mps] = travel.map(f64::from_bits);
            let stamp = Time(stamp);
            Sample::Encoders(EncoderSample { stamp, left_m, right_m, left_mps, right_mps })
        }
        Topic::Joystick => {
            let mut dead_man = false;
            let [stamp, asked @ ..] = words::<3>(data, |field, bit| {
                dead_man = bit;
                field == 4
            })?;
            let [v_mps, omega_radps] = asked.map(f64::from_bits);
            Sample::Joystick(JoystickSample { stamp: Time(stamp), v_mps, omega_radps, dead_man })
        }
        _ => return None,
    }))
}

fn no_bit(_field: usize, _bit: bool) -> bool {
    false
}

/// The fields 1 to N, each of eight bytes, as words; those that are absent are 0. Fields of one bit go to
/// `bit`, which says whether it knows them.
fn words<const N: usize>(
    data: &[u8],
    mut bit: impl FnMut(usize, bool) -> bool,
) -> Option<[u64; N]> {
    let (mut words, mut rest) = match all(data) {
        Some((words, rest)) => (words, Bytes(rest)),
        None => ([0; N], Bytes(data)),
    };
    while !rest.0.is_empty() {
        let (field, wire) = key(&mut rest)?;
        match wire {
            EIGHT_BYTES => *words.get_mut(field - 1)? = rest.u64()?,
            VARINT => {
                let value = rest.u8().filter(|value| *value < 2)?;
                bit(field, value == 1).then_some(())?;
            }
            _ => return None,
        }
    }
    Some(words)
}

/// The fields 1 to N where none is absent and each stands in its place, as in most messages, and what
/// follows them.
fn all<const N: usize>(data: &[u8]) -> Option<([u64; N], &[u8])> {
    let (fields, rest) = data.split_at_checked(9 * N)?;
    let mut words = [0; N];
    for (index, ([key, value @ ..], word)) in
        fields.as_chunks::<9>().0.iter().zip(&mut words).enumerate()
    {
        if usize::from(*key) != (index + 1) << 3 | usize::from(EIGHT_BYTES) {
            return None;
        }
        *word = u64::from_le_bytes(*value);
    }
    Some((words, rest))
}

/// Number (1 to 15) and wire type of a field.
fn key(rest: &mut Bytes<'_>) -> Option<(usize, u8)> {
    let key = rest.u8().filter(|key| (8..128).contains(key))?;
    Some((usize::from(key >> 3), key & 7))
}

fn sonar(data: &[u8]) -> Option<SonarScan> {
    let mut scan = SonarScan { stamp: Time(0), echoes: Vec::with_capacity(2) };
    let mut rest = Bytes(data);
    while !rest.0.is_empty() {
        match key(&mut rest)? {
            (1, EIGHT_BYTES) => scan.stamp = Time(rest.u64()?),
            (2, LENGTH) => {
                let length = rest.u8().filter(|length| *length < 128)?;
                scan.echoes.push(echo(rest.take(usize::from(length))?)?);
            }
            _ => return None,
        }
    }
    Some(scan)
}

fn echo(data: &[u8]) -> Option<SonarEcho> {
    let mut echo = SonarEcho { id: 0, range_m: 0.0, echo: false, fired: Time(0) };
    let mut rest = Bytes(data);
    while !rest.0.is_empty() {
        match key(&mut rest)? {
            (1, VARINT) => echo.id = rest.u8().filter(|id| *id < 128)?,
            (2, EIGHT_BYTES) => echo.range_m = f64::from_bits(rest.u64()?),
            (3, VARINT) => echo.echo = rest.u8().filter(|value| *value < 2)? == 1,
            (4, EIGHT_BYTES) => echo.fired = Time(rest.u64()?),
            _ => return None,
        }
    }
    Some(echo)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::Encoder;
    use super::super::encode::decode_generally;
    use super::*;

    const QUICK: [Topic; 4] = [Topic::Sonar, Topic::Imu, Topic::Encoders, Topic::Joystick];

    fn bytes_of(event: &Event) -> Vec<u8> {
        Encoder::new().encode(event).1.to_vec()
    }

    fn stamp() -> impl Strategy<Value = Time> {
        prop_oneof![Just(0), any::<u64>()].prop_map(Time)
    }

    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![Just(0.0), Just(f64::NAN), Just(f64::INFINITY), any::<f64>()]
    }

    fn sample() -> impl Strategy<Value = Sample> {
        let echo = (0..16_u8, number(), any::<bool>(), stamp())
            .prop_map(|(id, range_m, echo, fired)| SonarEcho { id, range_m, echo, fired });
        let three = || prop::array::uniform3(number());
        prop_oneof![
            (stamp(), prop::collection::vec(echo, 0..5))
                .prop_map(|(stamp, echoes)| Sample::Sonar(SonarScan { stamp, echoes })),
            (stamp(), three(), three(), three()).prop_map(
                |(stamp, accel_mps2, gyro_radps, mag_ut)| {
                    Sample::Imu(ImuSample { stamp, accel_mps2, gyro_radps, mag_ut })
                }
            ),
            (stamp(), prop::array::uniform4(number())).prop_map(
                |(stamp, [left_m, right_m, left_mps, right_mps])| {
                    Sample::Encoders(EncoderSample { stamp, left_m, right_m, left_mps, right_mps })
                }
            ),
            (stamp(), number(), number(), any::<bool>()).prop_map(
                |(stamp, v_mps, omega_radps, dead_man)| {
                    Sample::Joystick(JoystickSample { stamp, v_mps, omega_radps, dead_man })
                }
            ),
        ]
    }

    proptest! {
        /// What this program writes is decoded here, and says what it said.
        #[test]
        fn samples_are_decoded_quickly(sample in sample()) {
            let event = Event::Sample(sample);
            let bytes = bytes_of(&event);
            let quick = decode(Topic::of(&event), &bytes);
            prop_assert_eq!(quick.as_ref().map(bytes_of), Some(bytes));
        }

        /// Whatever else the bytes are, what is decoded here the general decoder decodes alike.
        #[test]
        fn nothing_is_decoded_otherwise(
            sample in sample(),
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
            cut in any::<prop::sample::Index>(),
            uncut in any::<bool>(),
        ) {
            let mut bytes = bytes_of(&Event::Sample(sample));
            if bytes.is_empty() {
                return Ok(());
            }
            for (at, byte) in changes {
                let at = at.index(bytes.len());
                bytes[at] = byte;
            }
            if !uncut {
                bytes.truncate(cut.index(bytes.len()));
            }
            for topic in QUICK {
                if let Some(quick) = decode(topic, &bytes) {
                    let general = decode_generally(topic, &bytes);
                    let general = general.expect("the general decoder takes it too").expect("a sample");
                    prop_assert_eq!(bytes_of(&quick), bytes_of(&general));
                }
            }
        }
    }
}
