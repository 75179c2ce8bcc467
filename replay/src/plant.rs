//! The plant as a log shows it: commands against what the wheels and the robot then did.
//!
//! In: one pass over a log. Out: gain, delay, limits of acceleration, and slip, each with a range of
//! confidence, or not at all where the log does not excite it. Each axis follows its command as a
//! delayed ramp,
//!
//! ```text
//! ẏ(t) = clip(g u(t − τ) − y(t), ± a)   (at once where a is infinite)
//! ```
//!
//! or, under a law that commands accelerations, as the integral of the delayed command within ± a. The
//! parameters are those of least squared error, found on a grid that is refined; a parameter's range
//! holds the values at which the error grows by no more than chance would have it.

mod doubt;
mod response;

use std::io::Read;

pub use doubt::{AxisDoubt, PlantClaim, PlantDoubt};

use schemas::log::{LogReader, Topic};
use schemas::{Event, Plant, Sample, Time};

use response::{Course, Fit, too_short};

/// As much of a log is looked at, seconds: it tells enough, and memory stays bounded.
const LOOK_S: f64 = 120.0;

/// Samples closer than this say the same twice; the effective number is that of this spacing,
/// seconds.
const INDEPENDENT_S: f64 = 0.2;

/// A limit that nobody feels, m/s² or rad/s².
const FREE: f64 = 100.0;

/// Oldest gyro reading that goes with an encoder reading, seconds.
const TOGETHER_S: f64 = 0.015;

/// A value with the range in which it lies with 95 % confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The best value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end; +∞ for a limit that may not be there.
    pub high: f64,
}

/// What a log says about its plant; `None` where it says nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlantEstimate {
    /// Speed reached ÷ speed commanded, forwards.
    pub gain_v: Option<Estimate>,
    /// Turn rate reached ÷ turn rate commanded.
    pub gain_omega: Option<Estimate>,
    /// From a command to its first effect, seconds.
    pub delay_s: Option<Estimate>,
    /// Largest acceleration, m/s²; an infinite value where none was felt.
    pub accel_mps2: Option<Estimate>,
    /// Largest angular acceleration, rad/s²; an infinite value where none was felt.
    pub alpha_radps2: Option<Estimate>,
    /// Share of the wheels' motion that does not become the robot's.
    pub slip: Option<Estimate>,
    /// Why it says nothing at all, where it does not.
    pub untold: Option<Untold>,
}

/// Why a log says nothing about its plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Untold {
    /// Nobody commanded anything.
    #[error("the log holds no command")]
    NoCommand,
    /// Nobody looked at what the robot did.
    #[error("the log holds neither encoder readings nor exact poses")]
    NoMotion,
    /// A robot at rest, or in steady motion, is like any other.
    #[error("commands hardly change in it")]
    AtRest,
    /// There is too little of it.
    #[error("the log is too short")]
    Short,
}

impl PlantEstimate {
    /// Identifies the plant of a log. What comes after damage is not looked at.
    pub fn of_log<R: Read>(log: LogReader<R>) -> PlantEstimate {
        let seen = Seen::in_log(log);
        seen.estimate_of(&seen.fits())
    }

    /// A plant with everything that the log shows in place of what was claimed.
    #[must_use]
    pub fn applied_to(&self, claimed: Plant) -> Plant {
        let felt = |limit: Option<Estimate>| limit.is_some_and(|limit| limit.value.is_finite());
        let limits_acceleration = match (self.accel_mps2, self.alpha_radps2) {
            (None, None) => claimed.limits_acceleration,
            (accel, alpha) => felt(accel) || felt(alpha),
        };
        let limit = |found: Option<Estimate>, claimed: f64| match found {
            Some(found) if found.value.is_finite() => found.value,
            // Where only the other axis is limited, this one is as good as not.
            Some(_) if limits_acceleration => FREE,
            _ => claimed,
        };
        Plant {
            actuator_delay_s: self.delay_s.map_or(claimed.actuator_delay_s, |delay| delay.value),
            slip: self.slip.map_or(claimed.slip, |slip| slip.value.clamp(0.0, 0.9)),
            limits_acceleration,
            accel_max_mps2: limit(self.accel_mps2, claimed.accel_max_mps2),
            alpha_max_radps2: limit(self.alpha_radps2, claimed.alpha_max_radps2),
            ..claimed
        }
    }
}

/// What has been read of a log.
struct Seen {
    start: Time,
    track_m: f64,
    /// By axis: forwards and turning.
    commands: [Course; 2],
    accelerations: bool,
    /// What the wheels did, or with exact rays the robot.
    wheels: [Course; 2],
    exact: bool,
    /// The wheels' turn rate with the gyro's, for slip.
    turns: Vec<[f64; 2]>,
    /// The newest reading of the gyro about z, with its time.
    gyro: Option<(f64, f64)>,
}

impl Seen {
    fn new(start: Time, track_m: f64) -> Seen {
        Seen {
            start,
            track_m,
            commands: Default::default(),
            accelerations: false,
            wheels: Default::default(),
            exact: false,
            turns: Vec::new(),
            gyro: None,
        }
    }

    /// The beginning of a log.
    fn in_log<R: Read>(log: LogReader<R>) -> Seen {
        let start = log.header().run.start;
        let mut log = log.only(&[Topic::Command, Topic::Encoders, Topic::Imu, Topic::Exact]);
        let mut seen = Seen::new(start, log.header().scenario.robot.track_m);
        while let Ok(Some(event)) = log.next_event() {
            if event.at.seconds_since(start) > LOOK_S {
                break;
            }
            seen.observe(&event.value);
        }
        seen
    }

    fn observe(&mut self, event: &Event) {
        match event {
            Event::Command(command) => {
                let t_s = command.stamp.seconds_since(self.start);
                self.accelerations |= command.accel.is_some();
                let inputs =
                    command.accel.unwrap_or([command.twist.v_mps, command.twist.omega_radps]);
                for (course, input) in self.commands.iter_mut().zip(inputs) {
                    course.push(t_s, input);
                }
            }
            Event::Sample(Sample::Encoders(encoders)) => {
                let t_s = encoders.stamp.seconds_since(self.start);
                let (left, right) = (encoders.left_mps, encoders.right_mps);
                let turn = (right - left) / self.track_m;
                self.wheels[0].push(t_s, 0.5 * (left + right));
                self.wheels[1].push(t_s, turn);
                if let Some((_, gyro)) = self.gyro.filter(|(at_s, _)| t_s - at_s <= TOGETHER_S) {
                    self.turns.push([turn, gyro]);
                }
            }
            Event::Sample(Sample::Imu(imu)) => {
                let t_s = imu.stamp.seconds_since(self.start);
                self.gyro = Some((t_s, imu.gyro_radps[2])).filter(|(_, gyro)| gyro.is_finite());
            }
            Event::Sample(Sample::Exact(exact)) => {
                let t_s = exact.stamp.seconds_since(self.start);
                self.exact = true;
                self.wheels[0].push(t_s, exact.v_mps);
                self.wheels[1].push(t_s, exact.omega_radps);
            }
            _ => {}
        }
    }

    fn fits(&self) -> [Option<Fit>; 2] {
        [0, 1].map(|axis| {
            Fit::of(&self.commands[axis], &self.wheels[axis], self.accelerations, INDEPENDENT_S)
        })
    }

    fn estimate_of(&self, fits: &[Option<Fit>; 2]) -> PlantEstimate {
        let of =
            |axis: usize, pick: fn(&Fit) -> Option<Estimate>| fits[axis].as_ref().and_then(pick);
        let (gain_v, gain_omega) = (of(0, |fit| fit.gain), of(1, |fit| fit.gain));
        // The limits are the wheels'; with exact rays the robot's were seen, less by the slip.
        let of_wheels = |limit: Option<Estimate>, gain: Option<Estimate>| {
            let share = gain.filter(|_| self.exact).map_or(1.0, |gain| gain.value);
            limit.map(|limit| Estimate {
                value: limit.value / share,
                low: limit.low / share,
                high: limit.high / share,
            })
        };
        let slip = if self.exact {
            // With exact rays nobody sees the wheels: what the robot lacks of its command is slip.
            narrower(gain_v, gain_omega).map(|gain| Estimate {
                value: 1.0 - gain.value,
                low: 1.0 - gain.high,
                high: 1.0 - gain.low,
            })
        } else {
            slip(&self.turns)
        };
        let says = gain_v.or(gain_omega).or(slip).is_some();
        PlantEstimate {
            gain_v,
            gain_omega,
            delay_s: narrower(of(0, |fit| fit.delay_s), of(1, |fit| fit.delay_s)),
            accel_mps2: of_wheels(of(0, |fit| fit.limit), gain_v),
            alpha_radps2: of_wheels(of(1, |fit| fit.limit), gain_omega),
            slip,
            untold: (!says).then(|| self.untold()),
        }
    }

    /// Why nothing can be said of it.
    fn untold(&self) -> Untold {
        let none = |courses: &[Course; 2]| courses.iter().all(Course::is_empty);
        if none(&self.commands) {
            Untold::NoCommand
        } else if none(&self.wheels) {
            Untold::NoMotion
        } else if (0..2).all(|axis| too_short(&self.commands[axis], &self.wheels[axis])) {
            Untold::Short
        } else {
            Untold::AtRest
        }
    }
}

/// The one of two estimates of one thing that knows better.
fn narrower(a: Option<Estimate>, b: Option<Estimate>) -> Option<Estimate> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.high - b.low < a.high - a.low { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Slip by the regression of the gyro's turn rate on the wheels'; the gyro's bias is the intercept.
fn slip(turns: &[[f64; 2]]) -> Option<Estimate> {
    let n = turns.len() as f64;
    let mean = |of: usize| turns.iter().map(|pair| pair[of]).sum::<f64>() / n;
    let (mean_wheel, mean_gyro) = (mean(0), mean(1));
    let (mut wheel, mut both) = (0.0, 0.0);
    for pair in turns {
        wheel += (pair[0] - mean_wheel) * (pair[0] - mean_wheel);
        both += (pair[0] - mean_wheel) * (pair[1] - mean_gyro);
    }
    // A robot that hardly turned says nothing: 0.1 rad/s of deviation.
    if turns.len() < 50 || wheel / n < 0.01 {
        return None;
    }
    let slope = both / wheel;
    let rest: f64 = turns
        .iter()
        .map(|pair| {
            let off = pair[1] - mean_gyro - slope * (pair[0] - mean_wheel);
            off * off
        })
        .sum();
    // The wheels' own error drags the slope down; at 1 % of speed that is 0.01 %, and left alone.
    let error = 2.0 * libm::sqrt(rest / (n - 2.0) / wheel);
    let value = 1.0 - slope;
    value.is_finite().then_some(Estimate { value, low: value - error, high: value + error })
}

#[cfg(test)]
mod tests;
