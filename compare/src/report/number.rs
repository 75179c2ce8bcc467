//! Numbers as every report prints them.

/// What stands for a value that has no meaning.
pub(super) const UNDEFINED: &str = "–";

/// A number to about three significant digits after the point; `–` where it has no meaning.
///
/// `0.031`, `12.35`, `144.8`, `2.0e-7`, `1.2e6`; whole numbers without a point.
pub fn number(x: Option<f64>) -> String {
    let Some(x) = x.filter(|x| !x.is_nan()) else { return UNDEFINED.to_owned() };
    let size = libm::fabs(x);
    if size == libm::floor(size) && size < 1e6 {
        // Adding 0 turns −0 into 0.
        format!("{}", x + 0.0)
    } else if !(0.001..1e5).contains(&size) {
        format!("{x:.1e}")
    } else if size < 10.0 {
        format!("{x:.3}")
    } else if size < 100.0 {
        format!("{x:.2}")
    } else {
        format!("{x:.1}")
    }
}

/// The same with its sign, for a difference.
pub fn signed(x: Option<f64>) -> String {
    let text = number(x);
    if x.is_some_and(|x| x > 0.0) { format!("+{text}") } else { text }
}

/// Two numbers with as many digits as it takes to tell them apart: a report's digits where these do.
pub fn told_apart(a: f64, b: f64) -> (String, String) {
    let short = (number(Some(a)), number(Some(b)));
    // By value: 1 and 1.000 read the same.
    let read = |text: &str| text.parse::<f64>().ok();
    if read(&short.0) != read(&short.1) || a == b {
        return short;
    }
    // Where a dozen digits do not, the shortest form that reads back as the same number does.
    let size = libm::fabs(a);
    let plain = (0.001..1e5).contains(&size);
    (4..=12_i32)
        .map(|digits| {
            let print = |x: f64| {
                if plain {
                    let before = 1 + libm::floor(libm::log10(size)) as i32;
                    let after = (digits - before).max(0) as usize;
                    let text = format!("{x:.after$}");
                    // A number that is round stays so.
                    if after == 0 {
                        text
                    } else {
                        text.trim_end_matches('0').trim_end_matches('.').to_owned()
                    }
                } else {
                    format!("{x:.digits$e}", digits = digits as usize - 1)
                }
            };
            (print(a), print(b))
        })
        .find(|(a, b)| a != b)
        .unwrap_or_else(|| (a.to_string(), b.to_string()))
}

/// A time to a hundredth of a second.
pub(crate) fn seconds(t_s: f64) -> String {
    format!("{t_s:.2} s")
}

/// A printed number with its unit, if it has one of either.
pub fn with_unit(text: &str, unit: &str) -> String {
    if unit.is_empty() || text == UNDEFINED { text.to_owned() } else { format!("{text} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_keep_what_matters() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (3.0, "3"),
            (0.0312, "0.031"),
            (-0.0312, "-0.031"),
            (12.346, "12.35"),
            (144.84, "144.8"),
            (2e-7, "2.0e-7"),
            (1_234_567.0, "1.2e6"),
            (f64::INFINITY, "inf"),
        ];
        for (x, text) in cases {
            assert_eq!(number(Some(x)), text);
        }
        assert_eq!(number(None), "–");
        assert_eq!(number(Some(f64::NAN)), "–");
        assert_eq!(signed(Some(0.5)), "+0.500");
        assert_eq!(signed(Some(-0.5)), "-0.500");
        assert_eq!(signed(Some(0.0)), "0");
        assert_eq!(signed(None), "–");
        let apart = |a, b| {
            let (a, b) = told_apart(a, b);
            format!("{a} {b}")
        };
        assert_eq!(apart(0.5, 0.25), "0.500 0.250");
        assert_eq!(apart(0.403_12, 0.403_14), "0.40312 0.40314");
        assert_eq!(apart(-0.451_998_2, -0.452), "-0.451998 -0.452");
        assert_eq!(apart(1.7731e-9, 1.7738e-9), "1.773e-9 1.774e-9");
        assert_eq!(apart(144.81, 144.84), "144.81 144.84");
        assert_eq!(apart(1.0, 1.0 + f64::EPSILON), "1 1.0000000000000002");
        assert_eq!(with_unit("1", "m"), "1 m");
        assert_eq!(with_unit("–", "m"), "–");
    }
}
