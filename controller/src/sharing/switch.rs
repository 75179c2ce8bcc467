//! The sharing function k (13), a hysteresis switch, and the selection (14).

use schemas::Region;

/// The memory of the hysteresis switch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switch {
    /// k = 1: the person drives. False before the first sample: the state has not been seen in the
    /// safe set.
    pub human: bool,
    /// Whether the state has ever been seen in the safe set.
    pub seen_safe: bool,
}

impl Switch {
    /// k after the state was classified: 1 in the safe set, 0 in the dangerous one, else unchanged.
    #[must_use]
    pub fn next(self, region: Region) -> Switch {
        match region {
            Region::Safe => Switch { human: true, seen_safe: true },
            Region::Hysteresis => self,
            Region::Danger | Region::Unspecified => Switch { human: false, ..self },
        }
    }

    /// k as a number.
    pub fn k(self) -> f64 {
        f64::from(u8::from(self.human))
    }
}

/// (14) for k ∈ {0, 1}: one input or the other, bit for bit. Selected and not multiplied, because
/// 0 · NaN is NaN.
pub fn select(human: bool, u_f: [f64; 2], u_h: [f64; 2]) -> [f64; 2] {
    if human { u_h } else { u_f }
}
