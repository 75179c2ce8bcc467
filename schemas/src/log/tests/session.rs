//! A small session with every kind of event.

use crate::log::{LogError, LogReader, LogWriter, WriterOptions};
use crate::{
    Command, Disc, EncoderSample, Event, ExactPose, FORMAT_VERSION, Gap, Header, ImuSample,
    JoystickSample, Pose, Reason, Region, RunInfo, SIMULATION_EPOCH, Sample, Scenario, SonarEcho,
    SonarScan, Stamped, Step, Timing, Truth, Twist,
};

pub(crate) fn scenario() -> Scenario {
    let text = r#"
        name = "small"
        duration_s = 1.0
        sensors = "sonar"
        driver = "script"
        [start.pose]
        x_m = 0.5
        y_m = -0.5
        theta_rad = 0.0
        [[person.script]]
        v_mps = 0.4
        omega_radps = 0.1
        duration_s = 1.0
        [task]
        from_m = [1.0, 0.0]
        velocity_mps = [0.5, 0.0]
        until_s = 10.0
        [[world.room]]
        normal = [1.0, 0.0]
        offset_m = 4.0
        [[world.room]]
        normal = [-1.0, 0.0]
        offset_m = 2.0
        [[world.room]]
        normal = [0.0, 1.0]
        offset_m = 2.0
        [[world.room]]
        normal = [0.0, -1.0]
        offset_m = 2.0
        [[world.obstacles]]
        corners_m = [[2.0, 1.0], [3.0, 1.0], [3.0, 1.5]]
    "#;
    Scenario::from_toml(text).expect("a scenario")
}

pub(crate) fn header() -> Header {
    Header {
        run: RunInfo {
            format_version: FORMAT_VERSION,
            program_version: "0.1.0".to_owned(),
            commit: "0123abc".to_owned(),
            dirty: true,
            controller: "tandem-kinematic".to_owned(),
            params_hash: "ff".to_owned(),
            seed: u64::MAX,
            scenario: "small".to_owned(),
            sensors: "sonar".to_owned(),
            driver: "script".to_owned(),
            mode: "record".to_owned(),
            operator: "N. N.".to_owned(),
            note: "zwei Zeilen\nund ein Umlaut: ü".to_owned(),
            start: SIMULATION_EPOCH,
            control_period_ns: 100_000_000,
            source_hash: String::new(),
        },
        params_toml: "gamma1 = 1.0\n".to_owned(),
        scenario: scenario(),
    }
}

/// `periods` control periods of 0.1 s, each with one event of every kind.
pub(crate) fn events(periods: u64) -> Vec<Stamped<Event>> {
    (0..periods).flat_map(period).collect()
}

fn period(index: u64) -> Vec<Stamped<Event>> {
    let stamp = SIMULATION_EPOCH.after_ns(index * 100_000_000);
    let t = index as f64 * 0.1;
    let pose = Pose { x_m: 0.5 + 0.3 * t, y_m: -0.5, theta_rad: 0.01 * t };
    let echo = |id: u8, echo| SonarEcho { id, range_m: 1.0 + t, echo, fired: stamp };
    let mut step = Step::unknown(stamp, index);
    step.pose = pose;
    step.k = if index % 20 < 10 { 1.0 } else { 0.0 };
    step.reason = if index % 20 < 10 { Reason::Human } else { Reason::Danger };
    step.region = Region::Hysteresis;
    step.distance_human_m = 0.7 - 0.01 * t;
    step.target_x_m = 1.0 + 0.5 * t;
    step.target_y_m = 0.0;
    step.psi_rad = 0.0;
    step.d1_m = 2.0;
    step.d2l_m = 1.5;
    step.d2r_m = 1.0;
    step.u_h = [0.4, f64::NAN];
    let events = [
        Event::Sample(Sample::Sonar(SonarScan {
            stamp,
            echoes: vec![echo((index % 8) as u8, true), echo(8 + (index % 8) as u8, false)],
        })),
        Event::Sample(Sample::Imu(ImuSample {
            stamp,
            accel_mps2: [0.1, 0.2, 9.81],
            gyro_radps: [0.0, 0.0, 0.01],
            mag_ut: [20.0, 0.0, -40.0],
        })),
        Event::Sample(Sample::Encoders(EncoderSample {
            stamp,
            left_m: 0.3 * t,
            right_m: 0.3 * t,
            left_mps: 0.3,
            right_mps: 0.3,
        })),
        Event::Sample(Sample::Exact(ExactPose { stamp, pose, v_mps: 0.3, omega_radps: 0.01 })),
        Event::Sample(Sample::Joystick(JoystickSample {
            stamp,
            v_mps: 0.4,
            omega_radps: 0.1,
            dead_man: true,
        })),
        Event::Truth(Truth {
            stamp,
            pose,
            v_mps: 0.3,
            omega_radps: 0.01,
            clearance_m: 0.8,
            clearance_static_m: 0.9,
            discs: vec![Disc { centre_m: [2.0, -1.0], radius_m: 0.3 }],
        }),
        Event::Step(Box::new(step)),
        Event::Command(Command {
            stamp,
            twist: Twist { v_mps: 0.3, omega_radps: 0.01 },
            accel: Some([0.5, -0.5]),
        }),
        Event::Gap(Gap {
            stamp,
            stream: "/sonar".to_owned(),
            start: stamp,
            end: stamp.after_ns(50_000_000),
            cause: "unplugged".to_owned(),
        }),
        Event::Timing(Timing { stamp, step_index: index, step_cost_ns: 1_234 }),
    ];
    let stamped = events.into_iter().enumerate();
    stamped.map(|(rank, value)| Stamped { at: stamp.after_ns(rank as u64), value }).collect()
}

/// Writes a log into memory.
pub(crate) fn log_of(events: &[Stamped<Event>], options: &WriterOptions) -> Vec<u8> {
    let mut writer = LogWriter::new(Vec::new(), &header(), options).expect("a vector takes all");
    for event in events {
        writer.write(event).expect("a vector takes all");
    }
    writer.finish().expect("a vector takes all").0
}

/// Reads as far as it goes.
pub(crate) fn read(log: &[u8]) -> (Vec<Stamped<Event>>, Option<LogError>, bool) {
    let mut reader = match LogReader::new(log) {
        Ok(reader) => reader,
        Err(error) => return (Vec::new(), Some(error), false),
    };
    let mut events = Vec::new();
    loop {
        match reader.next_event() {
            Ok(Some(event)) => events.push(event),
            Ok(None) => return (events, None, reader.is_complete()),
            Err(error) => {
                assert!(matches!(reader.next_event(), Ok(None)), "after an error comes the end");
                return (events, Some(error), reader.is_complete());
            }
        }
    }
}

/// Events as text: NaN equals itself there.
pub(crate) fn text(events: &[Stamped<Event>]) -> Vec<String> {
    events.iter().map(|event| format!("{event:?}")).collect()
}

/// Options for small chunks, without the viewers' topics.
pub(crate) fn bare(chunk_bytes: u64) -> WriterOptions {
    WriterOptions { view: false, chunk_bytes, ..WriterOptions::default() }
}
