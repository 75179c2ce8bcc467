//! The controller's parameters: one table of rows, from which the struct, its reading and writing
//! as TOML, its ranges and its documentation are made.
//!
//! In: TOML tables with flat keys. Out: [`Params`], or an error that names the key, the value and
//! what is allowed.

mod choice;
mod nearest;

pub(crate) use choice::choice;
pub(crate) use nearest::nearest;

use crate::frame::Frame;
use crate::law::BranchSigns;
use crate::runner::ReverseLaw;
use crate::safety::{Projection, Saturation};
use crate::sharing::{Precaution, Sets};
use crate::side::SideRule;
use crate::spec::SpecError;
use crate::target::PredictedTarget;
use crate::travel::{DBody, DMode, LawBody};

/// What values a parameter may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Allowed {
    /// Numbers from `min` to `max`, both included.
    Range {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// One of these names.
    Names(&'static [&'static str]),
}

impl std::fmt::Display for Allowed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Allowed::Range { min, max } => write!(f, "a number from {min} to {max}"),
            Allowed::Names(names) => write!(f, "one of {}", names.join(", ")),
        }
    }
}

/// The value of one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// A quantity.
    Number(f64),
    /// One of a list of names.
    Name(&'static str),
}

impl From<Setting> for toml::Value {
    fn from(setting: Setting) -> Self {
        match setting {
            Setting::Number(number) => toml::Value::Float(number),
            Setting::Name(name) => toml::Value::String(name.to_owned()),
        }
    }
}

/// One row of the table of parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Key in parameter files and on the command line.
    pub key: &'static str,
    /// Unit; empty for numbers without one and for names.
    pub unit: &'static str,
    /// What it may be.
    pub allowed: Allowed,
    /// Its value unless a version says otherwise.
    pub default: Setting,
    /// Where that value comes from.
    pub source: &'static str,
    /// What it means, in a sentence.
    pub meaning: &'static str,
}

/// A parameter's type: how it is read from and written to TOML.
trait Kind: Copy {
    fn read(key: &'static str, value: &toml::Value, allowed: Allowed) -> Result<Self, SpecError>;
    fn setting(self) -> Setting;
}

fn refused(key: &'static str, value: &toml::Value, allowed: Allowed) -> SpecError {
    SpecError::Value { key, value: value.to_string(), allowed: allowed.to_string() }
}

impl Kind for f64 {
    fn read(key: &'static str, value: &toml::Value, allowed: Allowed) -> Result<f64, SpecError> {
        let number = match value {
            toml::Value::Float(number) => *number,
            toml::Value::Integer(number) => *number as f64,
            _ => return Err(refused(key, value, allowed)),
        };
        match allowed {
            // Written so that NaN fails.
            Allowed::Range { min, max } if number >= min && number <= max => Ok(number),
            _ => Err(refused(key, value, allowed)),
        }
    }

    fn setting(self) -> Setting {
        Setting::Number(self)
    }
}

macro_rules! named_kinds {
    ($($type:ty),* $(,)?) => {$(
        impl Kind for $type {
            fn read(
                key: &'static str,
                value: &toml::Value,
                allowed: Allowed,
            ) -> Result<Self, SpecError> {
                value
                    .as_str()
                    .and_then(<$type>::from_name)
                    .ok_or_else(|| refused(key, value, allowed))
            }

            fn setting(self) -> Setting {
                Setting::Name(self.name())
            }
        }
    )*};
}

named_kinds!(
    DMode,
    DBody,
    LawBody,
    Frame,
    SideRule,
    BranchSigns,
    Sets,
    Precaution,
    Saturation,
    Projection,
    ReverseLaw,
    PredictedTarget,
);

/// Numbers from `min` to `max`.
const fn range(min: f64, max: f64) -> Allowed {
    Allowed::Range { min, max }
}

macro_rules! parameters {
    ($($(#[doc = $meaning:literal])+ $key:ident: $type:ty = $default:expr, $unit:literal, $allowed:expr, $source:literal;)*) => {
        /// Every parameter of the controller. Which of them matter depends on the law.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Params {
            $($(#[doc = $meaning])+ pub $key: $type,)*
        }

        impl Default for Params {
            /// The values of the table, before any version's differences.
            fn default() -> Params {
                Params { $($key: $default,)* }
            }
        }

        impl Params {
            /// How many there are.
            pub const COUNT: usize = [$(stringify!($key)),*].len();

            /// The table: one row for each parameter.
            pub fn table() -> [Parameter; Params::COUNT] {
                [$(Parameter {
                    key: stringify!($key),
                    unit: $unit,
                    allowed: $allowed,
                    default: <$type as Kind>::setting($default),
                    source: $source,
                    meaning: concat!($($meaning),+).trim_ascii_start(),
                },)*]
            }

            /// The values, in the order of [`Params::table`].
            pub fn settings(&self) -> [Setting; Params::COUNT] {
                [$(<$type as Kind>::setting(self.$key),)*]
            }

            /// Sets one parameter.
            ///
            /// # Errors
            /// No parameter has that key, or the value is of another type or out of its range.
            pub fn set(&mut self, key: &str, value: &toml::Value) -> Result<(), SpecError> {
                match key {
                    $(stringify!($key) => {
                        self.$key = <$type as Kind>::read(stringify!($key), value, $allowed)?;
                    })*
                    _ => {
                        let keys = [$(stringify!($key)),*];
                        let nearest = nearest(key, keys.into_iter());
                        return Err(SpecError::UnknownKey { key: key.to_owned(), nearest });
                    }
                }
                Ok(())
            }
        }
    };
}

parameters! {
    /// Control period Ts.
    control_period_s: f64 = 0.1, "s", range(0.0005, 1.0), "paper, section V (sampling time)";
    /// Gain γ1 of z1.
    gamma1: f64 = 0.2, "1/s", range(1e-6, 100.0), "specification §8 (a fit; the paper gives none)";
    /// Gain γ2 of z2.
    gamma2: f64 = 0.2, "1/s", range(1e-6, 100.0), "specification §8 (a fit; the paper gives none)";
    /// Gain γ3 of the heading error (kinematic law) or of v − v* (dynamic law).
    gamma3: f64 = 2.0, "1/s", range(1e-6, 100.0), "specification §8 (a fit; the paper gives none)";
    /// Gain γ4 of ωe − ωe* (dynamic law).
    gamma4: f64 = 6.0, "1/s", range(1e-6, 100.0), "specification §8, dynamic Case II";
    /// Gain γ5 of the heading error in ωe* (dynamic law); 0 in the paper.
    gamma5: f64 = 1.0, "1/s", range(0.0, 100.0), "specification §8, dynamic Case II";
    /// Weight λ of the distance terms in u1 (dynamic law); 1 in the paper.
    lambda: f64 = 0.3, "", range(0.0, 1.0), "specification §8, dynamic Case II";
    /// Least admissible wanted distance ε of (8).
    epsilon_m: f64 = 0.05, "m", range(1e-4, 10.0), "specification §8 (a fit; the paper gives none)";
    /// Radius r of the arc of (8).
    r_m: f64 = 0.5, "m", range(1e-3, 100.0), "specification §8 (a fit; the paper gives none)";
    /// Cap B of the distances that the feedback law sees (remark 1).
    cap_m: f64 = 1.0, "m", range(1e-3, 1000.0), "specification §8 (a fit; the paper gives none)";
    /// b1 of the dangerous set (12) where a task is given.
    b1_task_m: f64 = 2.45, "m", range(1e-3, 1000.0), "specification §8 (a fit; the paper gives none)";
    /// b2 of the safe set (12) where a task is given; greater than b1.
    b2_task_m: f64 = 2.6, "m", range(1e-3, 1000.0), "specification §8 (a fit; the paper gives none)";
    /// b1 of the dangerous set (12) in free driving.
    b1_free_m: f64 = 1.0, "m", range(1e-3, 1000.0), "specification §8 (a fit; the paper gives none)";
    /// b2 of the safe set (12) in free driving; greater than b1.
    b2_free_m: f64 = 1.3, "m", range(1e-3, 1000.0), "specification §8 (a fit; the paper gives none)";
    /// Wanted speed below which the feedback law rests; 0 turns the rule off.
    v_rest_mps: f64 = 0.004, "m/s", range(0.0, 10.0), "specification §3";
    /// Along which directions D is measured where a task is given.
    d_mode_task: DMode = DMode::Both, "", Allowed::Names(DMode::NAMES), "specification §5";
    /// Along which directions D is measured in free driving.
    d_mode_free: DMode = DMode::Sweep, "", Allowed::Names(DMode::NAMES), "specification §5";
    /// Whose free travel D is.
    d_body: DBody = DBody::Footprint, "", Allowed::Names(DBody::NAMES), "specification §5";
    /// Whose free travel the law's distances are.
    law_body: LawBody = LawBody::Lane, "", Allowed::Names(LawBody::NAMES), "specification §6";
    /// With which sensors k = 1 is waited for.
    wait: Precaution = Precaution::Always, "", Allowed::Names(Precaution::NAMES), "specification §5, open point f";
    /// How long k = 1 must have been possible without a break before it is granted again.
    grant_s: f64 = 0.2, "s", range(0.0, 10.0), "specification §5, open point f";
    /// How long k = 0 lasts at least.
    dwell_s: f64 = 0.0, "s", range(0.0, 60.0), "specification §5, open point f";
    /// Which robot the feedback law drives where the person asks to go backwards.
    reverse_law: ReverseLaw = ReverseLaw::Mirrored, "", Allowed::Names(ReverseLaw::NAMES), "specification §6, open point e";
    /// What becomes of the predicted target while the feedback law drives.
    predicted_target: PredictedTarget = PredictedTarget::Follows, "", Allowed::Names(PredictedTarget::NAMES), "specification §7, open point e";
    /// How the direction ψ of the distance frame is chosen.
    frame: Frame = Frame::Wall, "", Allowed::Names(Frame::NAMES), "specification §6";
    /// Which side distance the feedback law looks at.
    side_rule: SideRule = SideRule::Near, "", Allowed::Names(SideRule::NAMES), "specification §6, erratum 8";
    /// What the present side's distance is multiplied by when sides are compared by `near`.
    side_favour: f64 = 0.9, "", range(0.0, 1.0), "specification §6";
    /// Which signs the right-hand side of the feedback law has.
    branch_signs: BranchSigns = BranchSigns::Sigma, "", Allowed::Names(BranchSigns::NAMES), "specification §3, erratum 7";
    /// Which form of the sets (12) classifies the state.
    sets: Sets = Sets::Total, "", Allowed::Names(Sets::NAMES), "specification §5, errata 10 and 11";
    /// When the sets see D less the guard and the travel of one period.
    margin: Precaution = Precaution::Never, "", Allowed::Names(Precaution::NAMES), "specification §5";
    /// How much longer than measured with sonars the sets take D to be, which the doubt about echoes makes
    /// too short.
    sonar_shortfall_m: f64 = 0.08, "m", range(0.0, 1.0), "measured: specification §5";
    /// Distance that the swept body keeps from everything that it is that far from.
    body_guard_m: f64 = 0.03, "m", range(0.0, 1.0), "specification §9, S2 and S3";
    /// Distance kept free by the margin and by the cone of the safety layer.
    guard_m: f64 = 0.02, "m", range(0.0, 1.0), "specification §8";
    /// Bound that is assumed on the speed of things that move.
    v_disc_mps: f64 = 0.3, "m/s", range(0.0, 5.0), "specification §8";
    /// How the input is brought within the plant's limits.
    saturation: Saturation = Saturation::Scale, "", Allowed::Names(Saturation::NAMES), "specification §9, S1";
    /// Which safety layer has the last word.
    projection: Projection = Projection::Both, "", Allowed::Names(Projection::NAMES), "specification §9, S2 and S3";
    /// Half-angle that the cone of the safety layer has beyond the turn of one period.
    cone_rad: f64 = 0.05, "rad", range(0.0, 1.5), "specification §9, S2";
    /// How far ahead the joystick's arc predicts the target.
    prediction_s: f64 = 1.5, "s", range(0.01, 60.0), "specification §7 (Case III)";
    /// How far ahead in time the point lies that stands for where the person wants to go.
    intent_s: f64 = 2.0, "s", range(0.0, 60.0), "specification §5";
    /// How long the requested turn is swept when D is measured by `sweep`.
    sweep_s: f64 = 0.3, "s", range(0.0, 10.0), "specification §5";
    /// Acceleration per speed error that a request becomes (dynamic law).
    human_gain_v: f64 = 4.0, "1/s", range(0.0, 1000.0), "specification §7";
    /// Angular acceleration per turn rate error that a request becomes (dynamic law).
    human_gain_omega: f64 = 4.0, "1/s", range(0.0, 1000.0), "specification §7";
    /// How long a robot with sonars stands still at the start, until all of them have fired.
    start_still_s: f64 = 0.3, "s", range(0.0, 60.0), "specification §10 (the last of a sweep fires after 0.28 s)";
    /// Age beyond which a joystick sample no longer counts.
    joystick_lease_s: f64 = 0.2, "s", range(0.0, 60.0), "specification §10";
    /// Age beyond which odometry no longer counts.
    odometry_lease_s: f64 = 0.2, "s", range(0.0, 60.0), "specification §10";
    /// Age beyond which a sonar that has not spoken no longer counts.
    sonar_lease_s: f64 = 0.5, "s", range(0.0, 60.0), "specification §10";
    /// Distance beyond the safe threshold at which the danger shown to the person falls to 0.
    danger_band_m: f64 = 0.5, "m", range(1e-3, 100.0), "chosen: a second of travel at half speed";
}

#[cfg(test)]
mod tests;
