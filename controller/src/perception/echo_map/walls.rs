//! Walls between neighbouring echoes.
//!
//! Beside the body no cone looks at what stands between the sonars' axes, 0.3 m apart and more; a corner of
//! the body that turns sweeps just there. Two points that are neighbours all around the robot, and nearer to
//! each other than the body is wide, are taken for ends of one wall.

/// Neighbours farther apart than this, metres, are not taken for one wall: the body may fit between.
const APART_M: f64 = 0.5;

/// … nor those nearer than this, between which nothing fits; and as far apart the points stand that the
/// wall becomes.
const STEP_M: f64 = 0.05;

/// Only what is as near as this to the middle of the body, metres, matters: it turns within 0.354 m.
const NEAR_M: f64 = 0.7;

/// More points than this are not put in.
pub(super) const MOST_POINTS: usize = 64;

/// Calls `each` with points along the walls between `points_m`, which come in the order of their directions
/// about `about_m`.
pub(super) fn between(points_m: &[[f64; 2]], about_m: [f64; 2], mut each: impl FnMut([f64; 2])) {
    let squared = |[x, y]: [f64; 2]| x * x + y * y;
    let from_to = |a: [f64; 2], b: [f64; 2]| [b[0] - a[0], b[1] - a[1]];
    let near = |at_m: [f64; 2]| squared(from_to(about_m, at_m)) < NEAR_M * NEAR_M;
    let Some(mut before_m) = points_m.last().copied() else { return };
    let mut left = MOST_POINTS;
    for at_m in points_m {
        let from_m = std::mem::replace(&mut before_m, *at_m);
        if !near(from_m) || !near(*at_m) {
            continue;
        }
        let way_m = from_to(from_m, *at_m);
        let apart_m = squared(way_m).sqrt();
        if !(STEP_M..APART_M).contains(&apart_m) {
            continue;
        }
        let parts = (apart_m / STEP_M).ceil();
        for part in 1..parts as usize {
            if left == 0 {
                return;
            }
            left -= 1;
            let share = part as f64 / parts;
            each([from_m[0] + share * way_m[0], from_m[1] + share * way_m[1]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between_all(points_m: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut walls = Vec::new();
        between(points_m, [0.0; 2], |at_m| walls.push(at_m));
        walls
    }

    /// Two echoes of one wall at x = 0.4, 0.2 m apart: three points between them, evenly, on the wall.
    #[test]
    fn a_wall_stands_between_its_echoes() {
        // The way around, behind the robot, is another 0.2 m, and the same wall.
        let walls = between_all(&[[0.4, -0.1], [0.4, 0.1]]);
        assert_eq!(walls.len(), 6);
        for [x_m, y_m] in walls {
            assert!((x_m - 0.4).abs() < 1e-12 && y_m.abs() < 0.051, "{x_m} {y_m}");
        }
    }

    /// Where the body may fit between, where nothing does, far away, and with nobody beside: none.
    #[test]
    fn no_wall_is_made_up_elsewhere() {
        assert_eq!(between_all(&[[0.0, -0.26], [0.0, 0.26]]), Vec::<[f64; 2]>::new());
        assert_eq!(between_all(&[[0.4, 0.0], [0.4, 0.04]]), Vec::<[f64; 2]>::new());
        assert_eq!(between_all(&[[0.8, -0.1], [0.8, 0.1]]), Vec::<[f64; 2]>::new());
        assert_eq!(between_all(&[[0.4, 0.0]]), Vec::<[f64; 2]>::new());
        assert_eq!(between_all(&[]), Vec::<[f64; 2]>::new());
        assert_eq!(between_all(&[[f64::NAN, 0.0], [0.4, 0.1]]), Vec::<[f64; 2]>::new());
    }

    /// However many neighbours there are.
    #[test]
    fn there_is_room_for_all_that_come() {
        let zigzag: Vec<[f64; 2]> =
            (0..100).map(|i| [0.2, if i % 2 == 0 { 0.1 } else { -0.1 }]).collect();
        assert_eq!(between_all(&zigzag).len(), MOST_POINTS);
    }
}
