//! What is written is what is read, bit for bit up to what a log does not keep: which NaN it was, and
//! the sign of zero.

use proptest::collection::vec;
use proptest::prelude::*;

use super::session::{bare, events, header, log_of, read, text};
use crate::log::{Encoder, LogReader, Topic, WriterOptions};
use crate::{
    Command, Disc, EncoderSample, Event, ExactPose, FrameSource, Gap, ImuSample, JoystickSample,
    LawBranch, Pose, Reason, ReferenceSource, Region, SIMULATION_EPOCH, Sample, SonarEcho,
    SonarScan, Stamped, Step, Time, Timing, Truth, Twist,
};

#[test]
fn every_kind_of_event_comes_back_as_it_was() {
    let written = events(25);
    for options in [bare(1), bare(4096), WriterOptions::default()] {
        let log = log_of(&written, &options);
        let (back, error, complete) = read(&log);
        assert!(error.is_none(), "{error:?}");
        assert!(complete);
        assert_eq!(text(&back), text(&written));
    }
}

#[test]
fn the_head_comes_back_as_it_was() {
    let log = log_of(&[], &WriterOptions::default());
    let reader = LogReader::new(log.as_slice()).expect("a log without events is a log");
    assert_eq!(reader.header(), &header());
}

#[test]
fn equal_sessions_are_equal_files() {
    let written = events(40);
    let options = WriterOptions::default();
    assert_eq!(log_of(&written, &options), log_of(&written, &options));
}

#[test]
fn a_sample_made_canonical_is_what_a_log_gives_back() {
    let odd_nan = f64::from_bits(0xfff8_0000_0000_1234);
    let samples = [
        Sample::Joystick(JoystickSample {
            stamp: SIMULATION_EPOCH,
            v_mps: -0.0,
            omega_radps: odd_nan,
            dead_man: true,
        }),
        Sample::Exact(ExactPose {
            stamp: SIMULATION_EPOCH,
            pose: Pose { x_m: -0.0, y_m: -1.5, theta_rad: odd_nan },
            v_mps: -0.0,
            omega_radps: -0.0,
        }),
        Sample::Encoders(EncoderSample {
            stamp: SIMULATION_EPOCH,
            left_m: -0.0,
            right_m: odd_nan,
            left_mps: -0.0,
            right_mps: f64::NEG_INFINITY,
        }),
        Sample::Imu(ImuSample {
            stamp: SIMULATION_EPOCH,
            accel_mps2: [-0.0, odd_nan, 1.0],
            gyro_radps: [-0.0; 3],
            mag_ut: [odd_nan; 3],
        }),
        Sample::Sonar(SonarScan {
            stamp: SIMULATION_EPOCH,
            echoes: vec![SonarEcho { id: 3, range_m: -0.0, echo: true, fired: Time(0) }],
        }),
    ];
    for (index, mut sample) in samples.into_iter().enumerate() {
        let at = SIMULATION_EPOCH.after_ns(index as u64);
        let written = [Stamped { at, value: Event::Sample(sample.clone()) }];
        let (back, _, _) = read(&log_of(&written, &bare(1 << 16)));
        sample.make_canonical();
        let Event::Sample(back) = &back[0].value else { panic!("a sample") };
        // The text form shows the sign of zero; bytes show which NaN it is.
        assert_eq!(format!("{back:?}"), format!("{sample:?}"));
        let bytes =
            |sample: &Sample| Encoder::new().encode(&Event::Sample(sample.clone())).1.to_vec();
        assert_eq!(bytes(back), bytes(&sample));
        assert!(!format!("{back:?}").contains("-0.0"), "{back:?}");
    }
}

/// Any number, odd ones more often than chance would have it.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => any::<f64>(),
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => Just(f64::NEG_INFINITY),
        1 => Just(0.0),
        1 => Just(-0.0),
        1 => any::<u64>().prop_map(f64::from_bits),
    ]
}

fn pose() -> impl Strategy<Value = Pose> {
    [number(), number(), number()].prop_map(|[x_m, y_m, theta_rad]| Pose { x_m, y_m, theta_rad })
}

fn time() -> impl Strategy<Value = Time> {
    any::<u64>().prop_map(Time)
}

fn sample() -> impl Strategy<Value = Sample> {
    let echo = (0_u8..16, number(), any::<bool>(), time())
        .prop_map(|(id, range_m, echo, fired)| SonarEcho { id, range_m, echo, fired });
    let three = || [number(), number(), number()];
    prop_oneof![
        (time(), vec(echo, 0..20))
            .prop_map(|(stamp, echoes)| Sample::Sonar(SonarScan { stamp, echoes })),
        (time(), three(), three(), three()).prop_map(|(stamp, accel_mps2, gyro_radps, mag_ut)| {
            Sample::Imu(ImuSample { stamp, accel_mps2, gyro_radps, mag_ut })
        }),
        (time(), [number(), number(), number(), number()]).prop_map(
            |(stamp, [left_m, right_m, left_mps, right_mps])| {
                Sample::Encoders(EncoderSample { stamp, left_m, right_m, left_mps, right_mps })
            }
        ),
        (time(), number(), number(), any::<bool>()).prop_map(
            |(stamp, v_mps, omega_radps, dead_man)| {
                Sample::Joystick(JoystickSample { stamp, v_mps, omega_radps, dead_man })
            }
        ),
        (time(), pose(), number(), number()).prop_map(|(stamp, pose, v_mps, omega_radps)| {
            Sample::Exact(ExactPose { stamp, pose, v_mps, omega_radps })
        }),
    ]
}

/// A step in which the fields of every type are drawn, and many of the others.
fn step() -> impl Strategy<Value = Step> {
    let names = (
        prop::sample::select(vec![Region::Unspecified, Region::Safe, Region::Danger]),
        prop::sample::select(vec![Reason::Human, Reason::Contact, Reason::Starting]),
        prop::sample::select(vec![LawBranch::Left, LawBranch::Rest, LawBranch::None]),
        prop::sample::select(vec![FrameSource::Wall, FrameSource::Kept]),
        prop::sample::select(vec![ReferenceSource::Task, ReferenceSource::Hold]),
    );
    let pairs = [[number(), number()], [number(), number()], [number(), number()]];
    let hashes = (any::<u64>(), any::<u64>(), any::<i32>(), any::<[bool; 2]>());
    (time(), any::<u64>(), pose(), vec(number(), 9), pairs, names, hashes).prop_map(
        |(stamp, index, pose, numbers, [u_h, u_f, u_s], names, (input, state, side, flags))| Step {
            pose,
            v_mps: numbers[0],
            k: numbers[1],
            danger: numbers[2],
            d1_m: numbers[3],
            lyapunov: numbers[4],
            distance_human_m: numbers[5],
            z1: numbers[6],
            d_r2_accel_mps2: numbers[7],
            safety_clear_m: flags[0].then_some(numbers[8]),
            sonars_unknown: flags[1].then_some(side),
            u_h,
            u_f,
            u_s,
            region: names.0,
            reason: names.1,
            law_branch: names.2,
            frame_source: names.3,
            reference_source: names.4,
            input_hash: input,
            state_hash: state,
            side,
            saturated: flags[0],
            projected: flags[1],
            ..Step::unknown(stamp, index)
        },
    )
}

fn event() -> impl Strategy<Value = Event> {
    let disc = ([number(), number()], number())
        .prop_map(|(centre_m, radius_m)| Disc { centre_m, radius_m });
    prop_oneof![
        3 => sample().prop_map(Event::Sample),
        1 => step().prop_map(|step| Event::Step(Box::new(step))),
        1 => (time(), number(), number(), prop::option::of([number(), number()])).prop_map(
            |(stamp, v_mps, omega_radps, accel)| {
                Event::Command(Command { stamp, twist: Twist { v_mps, omega_radps }, accel })
            }
        ),
        1 => (time(), pose(), [number(), number(), number(), number()], vec(disc, 0..4)).prop_map(
            |(stamp, pose, [v_mps, omega_radps, clearance_m, clearance_static_m], discs)| {
                Event::Truth(Truth {
                    stamp, pose, v_mps, omega_radps, clearance_m, clearance_static_m, discs,
                })
            }
        ),
        1 => (time(), ".*", time(), time(), ".*").prop_map(|(stamp, stream, start, end, cause)| {
            Event::Gap(Gap { stamp, stream, start, end, cause })
        }),
        1 => (time(), any::<u64>(), any::<u64>()).prop_map(|(stamp, step_index, step_cost_ns)| {
            Event::Timing(Timing { stamp, step_index, step_cost_ns })
        }),
    ]
}

/// The bytes of an event: equal bytes are equal events, NaN included.
fn bytes(event: &Event) -> (&'static str, Vec<u8>) {
    let mut encoder = Encoder::new();
    let (topic, data) = encoder.encode(event);
    (topic, data.to_vec())
}

/// An event as text, with what a log does not keep taken out.
fn shown(event: &Event) -> String {
    let mut text = format!("{event:?}");
    for end in [',', ']', ')', ' '] {
        text = text.replace(&format!("-0.0{end}"), &format!("0.0{end}"));
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_event_comes_back_as_it_was(
        values in vec((event(), 1_u64..2_000_000_000), 1..60),
        chunk_bytes in 1_u64..20_000,
        view in any::<bool>(),
    ) {
        let mut at = SIMULATION_EPOCH;
        let written: Vec<Stamped<Event>> = values
            .into_iter()
            .map(|(value, gap_ns)| {
                at = at.after_ns(gap_ns);
                Stamped { at, value }
            })
            .collect();
        let options = WriterOptions { view, chunk_bytes, ..WriterOptions::default() };
        let (back, error, complete) = read(&log_of(&written, &options));
        prop_assert!(error.is_none(), "{error:?}");
        prop_assert!(complete);
        prop_assert_eq!(back.len(), written.len());
        for (back, written) in back.iter().zip(&written) {
            prop_assert_eq!(back.at, written.at);
            prop_assert_eq!(shown(&back.value), shown(&written.value));
            prop_assert_eq!(bytes(&back.value), bytes(&written.value));
            prop_assert_eq!(bytes(&back.value).0, Topic::of(&written.value).name());
        }
    }
}
