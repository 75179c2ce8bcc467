//! From numbers to coordinates of a picture: what figures and reports have in common.
//!
//! - [`Plan`]: the world from above, metres to units;
//! - [`Axis`]: a quantity along an axis, with round ticks;
//! - [`path`]: many points as a short path that looks the same.
//!
//! Everything comes out as text, rounded once, so that equal runs make equal pictures.

mod axis;
mod line;
mod plan;

pub(crate) use axis::{Axis, Tick};
pub(crate) use line::path;
pub(crate) use plan::{Bounds, Plan};

/// A coordinate, to a tenth of a unit.
pub(crate) fn unit(x: f64) -> String {
    // Adding zero takes −0 to 0.
    let text = format!("{:.1}", x + 0.0);
    let short = text.strip_suffix(".0").unwrap_or(&text);
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::unit;

    #[test]
    fn coordinates_are_short() {
        let texts = [0.0, -0.0, 3.0, -0.04, 12.25, 1e3].map(unit);
        assert_eq!(texts, ["0", "0", "3", "0", "12.2", "1000"]);
    }
}
