//! Many points as a short path that looks the same.

use std::fmt::Write;

use super::unit;

/// How far a left-out point may be off the drawn line, units: less than what is seen.
const TOLERANCE: f64 = 0.3;

/// An SVG path through `points`, with a break where either coordinate is not finite.
pub(crate) fn path(points: impl Iterator<Item = [f64; 2]>) -> String {
    let mut text = String::new();
    let mut stretch: Vec<[f64; 2]> = Vec::new();
    let mut draw = |stretch: &mut Vec<[f64; 2]>| {
        for (i, [x, y]) in simplified(stretch).into_iter().enumerate() {
            let command = if i == 0 { 'M' } else { 'L' };
            // Writing to a String cannot fail.
            let _ = write!(text, "{command}{} {}", unit(x), unit(y));
        }
        if let [alone] = stretch.as_slice() {
            // A single point is drawn as a line of no length.
            let _ = write!(text, "L{} {}", unit(alone[0]), unit(alone[1]));
        }
        stretch.clear();
    };
    for point in points {
        if point.iter().all(|x| x.is_finite()) {
            stretch.push(point);
        } else {
            draw(&mut stretch);
        }
    }
    draw(&mut stretch);
    text
}

/// The points that matter: those farther than the tolerance from the line through their kept
/// neighbours (Ramer 1972; Douglas and Peucker 1973). First and last stay.
pub(crate) fn simplified(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut keep = vec![false; points.len()];
    let last = points.len() - 1;
    (keep[0], keep[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let farthest = (from + 1..to)
            .map(|i| (i, off(points[i], points[from], points[to])))
            .fold((from, TOLERANCE), |most, next| if next.1 > most.1 { next } else { most });
        if farthest.0 > from {
            keep[farthest.0] = true;
            open.push((from, farthest.0));
            open.push((farthest.0, to));
        }
    }
    points.iter().zip(keep).filter(|(_, keep)| *keep).map(|(point, _)| *point).collect()
}

/// Distance from a point to a stretch of line.
fn off(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length2 = along[0] * along[0] + along[1] * along[1];
    let share = if length2 > 0.0 {
        ((to[0] * along[0] + to[1] * along[1]) / length2).clamp(0.0, 1.0)
    } else {
        0.0
    };
    libm::hypot(to[0] - share * along[0], to[1] - share * along[1])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_straight_line_needs_two_points() {
        let straight: Vec<[f64; 2]> =
            (0..100).map(|i| [f64::from(i), 2.0 * f64::from(i)]).collect();
        assert_eq!(path(straight.into_iter()), "M0 0L99 198");
    }

    #[test]
    fn what_is_not_finite_breaks_the_line() {
        let points = [[0.0, 1.0], [1.0, 5.0], [2.0, f64::NAN], [3.0, 2.0], [4.0, f64::INFINITY]];
        assert_eq!(path(points.into_iter()), "M0 1L1 5M3 2L3 2");
        assert_eq!(path(std::iter::empty()), "");
    }

    proptest! {
        /// No point is farther from the drawn line than the tolerance.
        #[test]
        fn nothing_that_is_seen_is_lost(
            ys in prop::collection::vec(-50.0..50.0_f64, 2..60),
        ) {
            let points: Vec<[f64; 2]> =
                ys.iter().enumerate().map(|(i, y)| [i as f64, *y]).collect();
            let drawn = simplified(&points);
            prop_assert_eq!((drawn[0], drawn[drawn.len() - 1]), (points[0], points[points.len() - 1]));
            for point in &points {
                let nearest = drawn
                    .windows(2)
                    .map(|ends| off(*point, ends[0], ends[1]))
                    .fold(f64::INFINITY, f64::min);
                prop_assert!(nearest <= TOLERANCE, "{:?} {}", point, nearest);
            }
        }
    }
}
