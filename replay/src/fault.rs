//! Faults put into a replay: named, seeded, and the same for every controller.
//!
//! A fault alters what the controller hears between the source, a log or a simulation, and the
//! session; it never alters what happened. What is random about it depends on the seed, the fault and
//! the number of the reading alone, so that two controllers meet the same faults.

mod delayed;

use std::str::FromStr;

use schemas::log::Topic;
use schemas::{Command, Event, Gap, Pulled, Sample, Source, Stamped, Time};
use simulator::{Purpose, Stream};

use delayed::Delayed;

/// Farthest range that cross-talk makes up, metres.
const CROSS_TALK_M: f64 = 3.0;

/// One fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// This share of the sonar readings hears nothing.
    SonarDropout(f64),
    /// This share of the sonar readings is another sonar's echo, at a random shorter range.
    CrossTalk(f64),
    /// Every sonar range is wrong by so much, metres.
    SonarBias(f64),
    /// The sonar of this number hears nothing.
    SonarDead(u8),
    /// The gyro's turn rate about z is wrong by so much, rad/s.
    GyroBias(f64),
    /// The left wheels turn by this share more than the robot moves.
    EncoderSlip(f64),
    /// Sensors arrive this much later, seconds; their stamps stay.
    Latency(f64),
    /// Sensors arrive up to this much later, each by its own, seconds.
    Jitter(f64),
    /// The joystick says the same from one instant to another, seconds from the start.
    JoystickFreeze(f64, f64),
    /// The controller never answers from this instant on, seconds from the start.
    ControllerHang(f64),
    /// The controller panics at this instant, seconds from the start.
    ControllerPanic(f64),
}

/// The faults' names, with what each value means.
pub const FAULTS: &[(&str, &str)] = &[
    ("sonar-dropout=SHARE", "sonar readings that hear nothing"),
    ("cross-talk=SHARE", "sonar readings that are another sonar's echo, at a random shorter range"),
    ("sonar-bias=M", "error of every sonar range, metres"),
    ("sonar-dead=ID", "a sonar that hears nothing, 0 to 15"),
    ("gyro-bias=RADPS", "error of the turn rate about z, rad/s"),
    ("encoder-slip=SHARE", "how much further than the robot the left wheels go"),
    ("latency=S", "how much later sensors arrive, seconds"),
    ("jitter=S", "how much later at most, each reading by its own, seconds"),
    ("controller-hang=S", "a controller that does not answer from then on, seconds from the start"),
    ("controller-panic=S", "a controller that panics then, seconds from the start"),
    ("joystick-freeze=FROM-TO", "a joystick that is stuck, seconds from the start"),
];

/// A fault that does not read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("bad fault {0:?}: expected one of {names}", names = names())]
pub struct BadFault(String);

fn names() -> String {
    FAULTS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

impl FromStr for Fault {
    type Err = BadFault;

    fn from_str(text: &str) -> Result<Fault, BadFault> {
        let bad = || BadFault(text.to_owned());
        let (name, value) = text.split_once('=').ok_or_else(bad)?;
        let number = |value: &str| {
            value.parse::<f64>().ok().filter(|number| number.is_finite()).ok_or_else(bad)
        };
        let at_least_0 =
            |value: &str| number(value).and_then(|x| if x < 0.0 { Err(bad()) } else { Ok(x) });
        let share =
            |value: &str| at_least_0(value).and_then(|x| if x > 1.0 { Err(bad()) } else { Ok(x) });
        Ok(match name {
            "sonar-dropout" => Fault::SonarDropout(share(value)?),
            "cross-talk" => Fault::CrossTalk(share(value)?),
            "sonar-bias" => Fault::SonarBias(number(value)?),
            "sonar-dead" => {
                Fault::SonarDead(value.parse().ok().filter(|id| *id < 16).ok_or_else(bad)?)
            }
            "gyro-bias" => Fault::GyroBias(number(value)?),
            "encoder-slip" => Fault::EncoderSlip(share(value)?),
            "latency" => Fault::Latency(at_least_0(value)?),
            "jitter" => Fault::Jitter(at_least_0(value)?),
            "joystick-freeze" => {
                let (from, to) = value.split_once('-').ok_or_else(bad)?;
                Fault::JoystickFreeze(at_least_0(from)?, at_least_0(to)?)
            }
            "controller-hang" => Fault::ControllerHang(at_least_0(value)?),
            "controller-panic" => Fault::ControllerPanic(at_least_0(value)?),
            _ => return Err(bad()),
        })
    }
}

/// Does to whoever steps at `t_s` what a broken controller does: never comes back, or panics.
#[expect(clippy::panic, reason = "asked for, to show what becomes of the others")]
fn break_down(faults: &[Fault], t_s: f64) {
    for fault in faults {
        match fault {
            Fault::ControllerHang(at_s) if t_s >= *at_s => loop {
                std::thread::park();
            },
            Fault::ControllerPanic(at_s) if t_s >= *at_s => {
                panic!("as --fault controller-panic={at_s} has it");
            }
            _ => {}
        }
    }
}

/// Faults with the seed of what is random about them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faults {
    /// What is wrong.
    pub faults: Vec<Fault>,
    /// Seed.
    pub seed: u64,
}

/// A source whose samples are faulty.
pub(crate) struct Faulty<S> {
    source: S,
    faults: Faults,
    /// When which streams were silent.
    gaps: Vec<Gap>,
    start: Time,
    /// Samples heard, by kind: the numbers that noise goes by.
    heard: [u64; 5],
    /// The last joystick before it froze.
    stuck: Option<[f64; 2]>,
    delayed: Delayed,
}

impl<S: Source> Faulty<S> {
    pub(crate) fn new(source: S, start: Time) -> Faulty<S> {
        Faulty {
            source,
            faults: Faults::default(),
            gaps: Vec::new(),
            start,
            heard: [0; 5],
            stuck: None,
            delayed: Delayed::default(),
        }
    }

    pub(crate) fn put(&mut self, faults: Faults) {
        self.faults = faults;
    }

    /// Lets streams fall silent as they did in a recording.
    pub(crate) fn silence(&mut self, gaps: &[Gap]) {
        self.gaps = gaps.to_vec();
    }

    /// The next thing of the source that was not lost in a gap.
    fn heard(&mut self) -> Result<Option<Pulled>, S::Error> {
        loop {
            let next = self.source.pull()?;
            let lost = match &next {
                Some(Pulled::Event(Stamped { value: event @ Event::Sample(sample), .. })) => {
                    let (topic, stamp) = (Topic::of(event).name(), sample.stamp());
                    self.gaps
                        .iter()
                        .any(|gap| gap.stream == topic && gap.start < stamp && stamp < gap.end)
                }
                _ => false,
            };
            if !lost {
                return Ok(next);
            }
        }
    }

    pub(crate) fn source_mut(&mut self) -> &mut S {
        &mut self.source
    }

    /// Alters a sample, and says how much later it arrives, seconds.
    fn alter(&mut self, sample: &mut Sample) -> f64 {
        let kind = match sample {
            Sample::Sonar(_) => 0,
            Sample::Imu(_) => 1,
            Sample::Encoders(_) => 2,
            Sample::Joystick(_) => 3,
            Sample::Exact(_) => 4,
        };
        let index = self.heard[kind];
        self.heard[kind] += 1;
        let mut late_s = 0.0;
        for (number, fault) in self.faults.faults.iter().enumerate() {
            let draw = Stream::new(self.faults.seed, Purpose::Fault(number as u8)).reading(index);
            match (fault, &mut *sample) {
                (Fault::SonarDropout(share), Sample::Sonar(scan)) => {
                    for echo in &mut scan.echoes {
                        echo.echo &= !draw.happens(u64::from(echo.id), *share);
                    }
                }
                (Fault::CrossTalk(share), Sample::Sonar(scan)) => {
                    for echo in &mut scan.echoes {
                        let id = u64::from(echo.id);
                        if draw.happens(id, *share) {
                            let most_m = if echo.echo { echo.range_m } else { CROSS_TALK_M };
                            echo.range_m = draw.between(100 + id, schemas::SONAR_BLIND_M, most_m);
                            echo.echo = true;
                        }
                    }
                }
                (Fault::SonarBias(bias_m), Sample::Sonar(scan)) => {
                    for echo in &mut scan.echoes {
                        echo.range_m = (echo.range_m + bias_m).max(schemas::SONAR_BLIND_M);
                    }
                }
                (Fault::SonarDead(id), Sample::Sonar(scan)) => {
                    for echo in scan.echoes.iter_mut().filter(|echo| echo.id == *id) {
                        echo.echo = false;
                    }
                }
                (Fault::GyroBias(bias_radps), Sample::Imu(imu)) => imu.gyro_radps[2] += bias_radps,
                (Fault::EncoderSlip(share), Sample::Encoders(encoders)) => {
                    encoders.left_m *= 1.0 + share;
                    encoders.left_mps *= 1.0 + share;
                }
                (Fault::JoystickFreeze(from_s, to_s), Sample::Joystick(joystick)) => {
                    let t_s = joystick.stamp.seconds_since(self.start);
                    if (*from_s..*to_s).contains(&t_s) {
                        let now = [joystick.v_mps, joystick.omega_radps];
                        [joystick.v_mps, joystick.omega_radps] = *self.stuck.get_or_insert(now);
                    } else {
                        self.stuck = None;
                    }
                }
                (_, Sample::Joystick(_)) => {}
                (Fault::Latency(latency_s), _) => late_s += latency_s,
                (Fault::Jitter(jitter_s), _) => late_s += draw.between(kind as u64, 0.0, *jitter_s),
                _ => {}
            }
        }
        late_s
    }
}

impl<S: Source> Source for Faulty<S> {
    type Error = S::Error;

    fn pull(&mut self) -> Result<Option<Pulled>, S::Error> {
        if self.faults.faults.is_empty() {
            return self.heard();
        }
        loop {
            if !self.delayed.knows_next() {
                let mut next = self.heard()?;
                if let Some(Pulled::Event(Stamped { at, value: Event::Sample(sample) })) = &mut next
                {
                    let late_s = self.alter(sample);
                    if late_s > 0.0 {
                        let (at, sample) = (*at, sample.clone());
                        self.delayed.hold(at + schemas::Span::from_seconds(late_s), sample);
                        continue;
                    }
                }
                self.delayed.next(next);
            }
            let next = self.delayed.take();
            if let Some(Pulled::StepDue { now, .. }) = &next {
                break_down(&self.faults.faults, now.seconds_since(self.start));
            }
            return Ok(next);
        }
    }

    fn actuate(&mut self, command: &Command) {
        self.source.actuate(command);
    }
}

#[cfg(test)]
mod tests;
