//! The faults there are, and how they are asked for.

use std::fmt::{self, Display, Formatter};
use std::ops::RangeInclusive;
use std::str::FromStr;

use schemas::{SONAR_REACH_M, SONARS, Sample, Time};

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
    ("sonar-bias=M", "error of every sonar range, metres, at most 5"),
    ("sonar-dead=ID", "a sonar that hears nothing, 0 to 15"),
    ("gyro-bias=RADPS", "error of the turn rate about z, rad/s, at most 10"),
    ("encoder-slip=SHARE", "how much further than the robot the left wheels go"),
    ("latency=S", "how much later sensors arrive, seconds, at most 10"),
    ("jitter=S", "how much later at most, each reading by its own, seconds, at most 10"),
    ("controller-hang=S", "a controller that does not answer from then on, seconds from the start"),
    ("controller-panic=S", "a controller that panics then, seconds from the start"),
    ("joystick-freeze=FROM-TO", "a joystick that is stuck, seconds from the start"),
];

/// What a value may be.
const SHARE: &str = "a share from 0 to 1";
const LATE: &str = "seconds, from 0 to 10";
const INSTANT: &str = "seconds from the start, from 0 to 86400 (a day)";
const RANGE: &str = "metres, from -5 to 5 (the reach of a sonar)";
const TURN_RATE: &str = "rad/s, from -10 to 10";
const SONAR: &str = "the number of a sonar, from 0 to 15";
const FROM_TO: &str = "FROM-TO, both seconds, from 0 to 86400 (a day), FROM before TO";

/// The bounds that they tell. Beyond them a value is a slip of the finger: no sensor is so late and still
/// of use, no gyro of such a robot reads so much, and no session is so long.
const LATEST_S: f64 = 10.0;
const LAST_S: f64 = 86_400.0;
const FASTEST_RADPS: f64 = 10.0;

/// A fault that does not do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadFault {
    /// There is none of that name.
    #[error("bad fault {0:?}: expected one of {names}", names = names())]
    Unknown(String),
    /// Its value is none, or beyond what it may be.
    #[error("bad fault {name}={value}: the value of {name} is {allowed}")]
    Value {
        /// The fault.
        name: String,
        /// What was asked for.
        value: String,
        /// What may be.
        allowed: &'static str,
    },
    /// It would be over before it begins.
    #[error(
        "bad fault {0:?}: it ends before it begins; write joystick-freeze=FROM-TO, FROM before TO"
    )]
    Backwards(String),
    /// It is there already.
    #[error("fault {0} is there already: name each kind once, sonar-dead once for each sonar")]
    Twice(String),
}

fn names() -> String {
    FAULTS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

impl FromStr for Fault {
    type Err = BadFault;

    fn from_str(text: &str) -> Result<Fault, BadFault> {
        let unknown = || BadFault::Unknown(text.to_owned());
        let (name, value) = text.split_once('=').ok_or_else(unknown)?;
        let bad = |allowed: &'static str| BadFault::Value {
            name: name.to_owned(),
            value: value.to_owned(),
            allowed,
        };
        let range = || parse(value, -SONAR_REACH_M..=SONAR_REACH_M).ok_or_else(|| bad(RANGE));
        let turn_rate =
            || parse(value, -FASTEST_RADPS..=FASTEST_RADPS).ok_or_else(|| bad(TURN_RATE));
        let late = || parse(value, 0.0..=LATEST_S).ok_or_else(|| bad(LATE));
        let instant = || parse(value, 0.0..=LAST_S).ok_or_else(|| bad(INSTANT));
        let share = || parse(value, 0.0..=1.0).ok_or_else(|| bad(SHARE));
        Ok(match name {
            "sonar-dropout" => Fault::SonarDropout(share()?),
            "cross-talk" => Fault::CrossTalk(share()?),
            "sonar-bias" => Fault::SonarBias(range()?),
            "sonar-dead" => {
                let id = value.parse().ok().filter(|id| usize::from(*id) < SONARS.len());
                Fault::SonarDead(id.ok_or_else(|| bad(SONAR))?)
            }
            "gyro-bias" => Fault::GyroBias(turn_rate()?),
            "encoder-slip" => Fault::EncoderSlip(share()?),
            "latency" => Fault::Latency(late()?),
            "jitter" => Fault::Jitter(late()?),
            "joystick-freeze" => {
                let span = value.split_once('-').and_then(|(from, to)| {
                    Some((parse(from, 0.0..=LAST_S)?, parse(to, 0.0..=LAST_S)?))
                });
                let (from_s, to_s) = span.ok_or_else(|| bad(FROM_TO))?;
                if from_s >= to_s {
                    return Err(BadFault::Backwards(text.to_owned()));
                }
                Fault::JoystickFreeze(from_s, to_s)
            }
            "controller-hang" => Fault::ControllerHang(instant()?),
            "controller-panic" => Fault::ControllerPanic(instant()?),
            _ => return Err(unknown()),
        })
    }
}

/// A finite number within bounds.
fn parse(text: &str, bounds: RangeInclusive<f64>) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite() && bounds.contains(number))
}

impl Display for Fault {
    /// As it is asked for.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Fault::SonarDropout(share) => write!(f, "sonar-dropout={share}"),
            Fault::CrossTalk(share) => write!(f, "cross-talk={share}"),
            Fault::SonarBias(bias_m) => write!(f, "sonar-bias={bias_m}"),
            Fault::SonarDead(id) => write!(f, "sonar-dead={id}"),
            Fault::GyroBias(bias_radps) => write!(f, "gyro-bias={bias_radps}"),
            Fault::EncoderSlip(share) => write!(f, "encoder-slip={share}"),
            Fault::Latency(latency_s) => write!(f, "latency={latency_s}"),
            Fault::Jitter(jitter_s) => write!(f, "jitter={jitter_s}"),
            Fault::JoystickFreeze(from_s, to_s) => write!(f, "joystick-freeze={from_s}-{to_s}"),
            Fault::ControllerHang(at_s) => write!(f, "controller-hang={at_s}"),
            Fault::ControllerPanic(at_s) => write!(f, "controller-panic={at_s}"),
        }
    }
}

impl Fault {
    /// Whether the two cannot go together: of one kind, and of the same thing.
    pub(super) fn clashes(&self, other: &Fault) -> bool {
        match (self, other) {
            (Fault::SonarDead(one), Fault::SonarDead(another)) => one == another,
            // One may come after the other.
            (
                Fault::JoystickFreeze(from_s, to_s),
                Fault::JoystickFreeze(other_from_s, other_to_s),
            ) => from_s < other_to_s && other_from_s < to_s,
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }

    /// Whether a sample is one that it changes; of its amount nothing is asked. A controller's own faults
    /// change none.
    pub(super) fn meets(&self, sample: &Sample, start: Time) -> bool {
        match (self, sample) {
            (Fault::SonarDead(id), Sample::Sonar(scan)) => {
                scan.echoes.iter().any(|echo| echo.id == *id)
            }
            (
                Fault::SonarDropout(_) | Fault::CrossTalk(_) | Fault::SonarBias(_),
                Sample::Sonar(_),
            )
            | (Fault::GyroBias(_), Sample::Imu(_))
            | (Fault::EncoderSlip(_), Sample::Encoders(_)) => true,
            (Fault::Latency(_) | Fault::Jitter(_), sample) => {
                !matches!(sample, Sample::Joystick(_))
            }
            (Fault::JoystickFreeze(..), Sample::Joystick(joystick)) => {
                self.freezes_at(joystick.stamp.seconds_since(start))
            }
            _ => false,
        }
    }

    /// What there was none of where it met nothing to change.
    pub fn misses(&self) -> String {
        match self {
            Fault::SonarDropout(_) | Fault::CrossTalk(_) | Fault::SonarBias(_) => {
                "no sonar reading".to_owned()
            }
            Fault::SonarDead(id) => format!("no reading of sonar {id}"),
            Fault::GyroBias(_) => "no IMU reading".to_owned(),
            Fault::EncoderSlip(_) => "no encoder reading".to_owned(),
            Fault::Latency(_) | Fault::Jitter(_) => "no sensor reading".to_owned(),
            Fault::JoystickFreeze(from_s, to_s) => {
                format!("no joystick sample from {from_s} to {to_s} s")
            }
            Fault::ControllerHang(at_s) | Fault::ControllerPanic(at_s) => {
                format!("no step at or after {at_s} s")
            }
        }
    }

    /// Whether a controller that is to step at `t_s` seconds from the start hangs or panics.
    pub(super) fn breaks_down_at(&self, t_s: f64) -> bool {
        matches!(self, Fault::ControllerHang(at_s) | Fault::ControllerPanic(at_s) if t_s >= *at_s)
    }

    /// Whether the joystick is stuck at `t_s` seconds from the start.
    pub(super) fn freezes_at(&self, t_s: f64) -> bool {
        matches!(self, Fault::JoystickFreeze(from_s, to_s) if (*from_s..*to_s).contains(&t_s))
    }
}
