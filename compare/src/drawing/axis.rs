//! A quantity along an axis.

use super::unit;

/// From a quantity to a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Axis {
    low: f64,
    high: f64,
    /// Where the lowest and the highest value stand.
    ends: [f64; 2],
    logarithmic: bool,
}

/// One mark of an axis.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(crate) struct Tick {
    /// Coordinate.
    pub(crate) at: String,
    /// What it says.
    pub(crate) label: String,
}

impl Axis {
    /// A linear axis; a range without a length is given one.
    pub(crate) fn linear(low: f64, high: f64, ends: [f64; 2]) -> Axis {
        let (low, high) = if low < high { (low, high) } else { (low - 0.5, low + 0.5) };
        Axis { low, high, ends, logarithmic: false }
    }

    /// A logarithmic axis from `low` to `high`, both above 0.
    pub(crate) fn logarithmic(low: f64, high: f64, ends: [f64; 2]) -> Axis {
        let low = libm::floor(libm::log10(low));
        let high = libm::ceil(libm::log10(high)).max(low + 1.0);
        Axis { low, high, ends, logarithmic: true }
    }

    /// The values at its two ends.
    pub(crate) fn range(self) -> [f64; 2] {
        let value = |x: f64| if self.logarithmic { libm::pow(10.0, x) } else { x };
        [value(self.low), value(self.high)]
    }

    /// Where a value stands; beyond the ends for values beyond the range, and at the low end for
    /// values that a logarithmic axis does not have. NaN for NaN.
    pub(crate) fn at(self, value: f64) -> f64 {
        let value = match (self.logarithmic, value > 0.0 || value.is_nan()) {
            (false, _) => value,
            (true, true) => libm::log10(value),
            (true, false) => self.low,
        };
        self.ends[0] + (self.ends[1] - self.ends[0]) * (value - self.low) / (self.high - self.low)
    }

    /// About `wanted` marks at round values.
    pub(crate) fn ticks(self, wanted: usize) -> Vec<Tick> {
        let (low, high) = (self.low, self.high);
        let rough = (high - low) / wanted.max(1) as f64;
        let step = if self.logarithmic { libm::ceil(rough).max(1.0) } else { round_step(rough) };
        let first = libm::ceil(low / step - 1e-9) as i64;
        let last = libm::floor(high / step + 1e-9) as i64;
        (first..=last)
            .map(|i| i as f64 * step)
            .map(|mark| {
                // A multiple of a round step, printed without the rounding of the product.
                let value = libm::round(mark / step * 1e6) / 1e6 * step;
                let label = if self.logarithmic {
                    decade(mark)
                } else {
                    format!("{}", libm::round(value * 1e9) / 1e9 + 0.0)
                };
                let at = self.ends[0] + (self.ends[1] - self.ends[0]) * (mark - low) / (high - low);
                Tick { at: unit(at), label }
            })
            .collect()
    }
}

/// The least of 1, 2, 5 times a power of ten that is not less than `rough`.
fn round_step(rough: f64) -> f64 {
    let decade = libm::pow(10.0, libm::floor(libm::log10(rough)));
    [1.0, 2.0, 5.0]
        .iter()
        .map(|factor| factor * decade)
        .find(|step| *step >= rough * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

fn decade(exponent: f64) -> String {
    match exponent as i32 {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        n => format!("1e{n}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: Axis, wanted: usize) -> Vec<String> {
        axis.ticks(wanted).into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn values_stand_where_proportion_says() {
        let down = Axis::linear(-1.0, 3.0, [80.0, 0.0]);
        assert_eq!(
            [down.at(-1.0), down.at(1.0), down.at(3.0), down.at(5.0)],
            [80.0, 40.0, 0.0, -40.0]
        );
        assert!(down.at(f64::NAN).is_nan());
        let decades = Axis::logarithmic(2e-6, 5.0, [70.0, 0.0]);
        assert_eq!([decades.at(1e-6), decades.at(1.0), decades.at(10.0)], [70.0, 10.0, 0.0]);
        assert_eq!(decades.at(0.0), 70.0);
        assert!(decades.at(f64::NAN).is_nan());
    }

    #[test]
    fn ticks_are_round_and_within() {
        assert_eq!(
            labels(Axis::linear(0.0, 60.0, [0.0, 600.0]), 6),
            ["0", "10", "20", "30", "40", "50", "60"]
        );
        assert_eq!(labels(Axis::linear(-0.31, 0.72, [80.0, 0.0]), 3), ["0", "0.5"]);
        assert_eq!(labels(Axis::linear(0.0, 0.3, [80.0, 0.0]), 3), ["0", "0.1", "0.2", "0.3"]);
        assert_eq!(
            labels(Axis::logarithmic(1e-6, 1.0, [80.0, 0.0]), 3),
            ["1e-6", "1e-4", "1e-2", "1"]
        );
        // A constant has an axis too.
        assert_eq!(Axis::linear(2.0, 2.0, [80.0, 0.0]).at(2.0), 40.0);
        assert!(!labels(Axis::linear(2.0, 2.0, [80.0, 0.0]), 3).is_empty());
    }
}
