//! The faults there are, and how they are asked for.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

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

/// A fault that does not do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadFault {
    /// There is none of that name, or its value is none.
    #[error("bad fault {0:?}: expected one of {names}", names = names())]
    Unknown(String),
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
        let bad = || BadFault::Unknown(text.to_owned());
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
                let (from_s, to_s) = (at_least_0(from)?, at_least_0(to)?);
                if from_s >= to_s {
                    return Err(BadFault::Backwards(text.to_owned()));
                }
                Fault::JoystickFreeze(from_s, to_s)
            }
            "controller-hang" => Fault::ControllerHang(at_least_0(value)?),
            "controller-panic" => Fault::ControllerPanic(at_least_0(value)?),
            _ => return Err(bad()),
        })
    }
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

    /// Whether the joystick is stuck at `t_s` seconds from the start.
    pub(super) fn freezes_at(&self, t_s: f64) -> bool {
        matches!(self, Fault::JoystickFreeze(from_s, to_s) if (*from_s..*to_s).contains(&t_s))
    }
}
