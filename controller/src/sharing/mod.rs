//! Who drives: the sets (12), the sharing function k (13) and the selection (14).
//!
//! In: a distance D and a speed. Out: the class of the state, k, and the chosen input.

mod critical;
mod danger;
mod grant;
mod region;
mod switch;

pub use critical::critical_distance_m;
pub use danger::danger;
pub use grant::{Patience, Wait, another_request};
pub use region::{classify_printed, classify_total};
pub use switch::{Switch, select};

use schemas::SensorSuite;

use crate::params::choice;

choice! {
    /// Which form of the sets (12) classifies the state.
    Sets {
        /// As printed; what is printed twice or not at all is settled by [`classify_printed`].
        Printed = "printed",
        /// In |v| and by critical distances: exactly one class for every D and v.
        Total = "total",
    }
}

choice! {
    /// With which sensors something is done that exact distances do not need: [`crate::Params::margin`],
    /// [`crate::Params::wait`].
    Precaution {
        /// Never.
        Never = "never",
        /// With real sensors.
        Sonar = "sonar",
        /// Always.
        Always = "always",
    }
}

impl Precaution {
    /// Whether it is taken with these sensors.
    pub fn applies(self, sensors: SensorSuite) -> bool {
        match self {
            Precaution::Never => false,
            Precaution::Sonar => sensors == SensorSuite::Sonar,
            Precaution::Always => true,
        }
    }
}
