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

/// More points than this are not put in: of more the nearest.
pub(super) const MOST_POINTS: usize = 64;

/// Calls `each` with points along the walls between `points_m`, which come in the order of their directions
/// about `about_m`: with the nearest ones, should there be many.
pub(super) fn between(points_m: &[[f64; 2]], about_m: [f64; 2], each: impl FnMut([f64; 2])) {
    let near = |at_m: [f64; 2]| apart_m2(about_m, at_m) < NEAR_M * NEAR_M;
    let Some(mut before_m) = points_m.last().copied() else { return };
    let mut nearest = Nearest::to(about_m);
    for at_m in points_m {
        let from_m = std::mem::replace(&mut before_m, *at_m);
        if !near(from_m) || !near(*at_m) {
            continue;
        }
        let apart_m = apart_m2(from_m, *at_m).sqrt();
        if !(STEP_M..APART_M).contains(&apart_m) {
            continue;
        }
        let way_m = [at_m[0] - from_m[0], at_m[1] - from_m[1]];
        let parts = (apart_m / STEP_M).ceil();
        for part in 1..parts as usize {
            let share = part as f64 / parts;
            nearest.take([from_m[0] + share * way_m[0], from_m[1] + share * way_m[1]]);
        }
    }
    nearest.points_m().iter().copied().for_each(each);
}

fn apart_m2(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    dx * dx + dy * dy
}

/// The nearest of some points, whatever the order in which they come.
struct Nearest {
    about_m: [f64; 2],
    kept_m: [[f64; 2]; MOST_POINTS],
    count: usize,
    /// The farthest one kept, once there is no room for more.
    farthest: usize,
}

impl Nearest {
    fn to(about_m: [f64; 2]) -> Nearest {
        Nearest { about_m, kept_m: [[0.0; 2]; MOST_POINTS], count: 0, farthest: 0 }
    }

    fn points_m(&self) -> &[[f64; 2]] {
        &self.kept_m[..self.count]
    }

    /// Whether `a` is farther away than `b`; of two that are as far away, one and always the same.
    fn is_farther(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        let key = |at_m: [f64; 2]| [apart_m2(self.about_m, at_m), at_m[0], at_m[1]];
        let before = |(a, b): (f64, f64)| a.total_cmp(&b);
        let order = key(a).into_iter().zip(key(b)).map(before).find(|order| order.is_ne());
        order.is_some_and(std::cmp::Ordering::is_gt)
    }

    fn take(&mut self, at_m: [f64; 2]) {
        if self.count < MOST_POINTS {
            self.kept_m[self.count] = at_m;
            self.count += 1;
        } else if self.is_farther(self.kept_m[self.farthest], at_m) {
            self.kept_m[self.farthest] = at_m;
        } else {
            return;
        }
        if self.count == MOST_POINTS {
            for index in 0..MOST_POINTS {
                if self.is_farther(self.kept_m[index], self.kept_m[self.farthest]) {
                    self.farthest = index;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

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

    fn sorted(mut points_m: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        points_m.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        points_m
    }

    /// Far walls come first in the order of directions, and near ones last: the near ones are all there.
    #[test]
    fn far_walls_leave_room_for_near_ones() {
        let zigzag = |x_m: f64, pairs: usize| -> Vec<[f64; 2]> {
            (0..pairs).flat_map(|_| [[x_m, -0.1], [x_m, 0.1]]).collect()
        };
        let walls = between_all(&[zigzag(0.6, 50), zigzag(-0.3, 5)].concat());
        // Three on each of the nine ways between the near ones; the ways to the far ones are longer than
        // any wall.
        assert_eq!(walls.iter().filter(|at_m| at_m[0] == -0.3).count(), 27);
        assert_eq!(walls.len(), MOST_POINTS);
    }

    proptest! {
        /// The nearest are kept, in whichever order they come, with many that are as far away as others.
        #[test]
        fn the_nearest_are_kept_in_any_order(
            cells in prop::collection::vec([-6..=6_i32, -6..=6_i32], 0..150),
            about in [-3..=3_i32, -3..=3_i32],
            turn in 0..150_usize,
        ) {
            let about_m = about.map(f64::from);
            let came: Vec<[f64; 2]> = cells.iter().map(|cell| cell.map(f64::from)).collect();
            let keep = |points_m: &[[f64; 2]]| {
                let mut nearest = Nearest::to(about_m);
                for at_m in points_m {
                    nearest.take(*at_m);
                }
                sorted(nearest.points_m().to_vec())
            };
            let kept = keep(&came);
            let mut otherwise = came.clone();
            otherwise.reverse();
            prop_assert_eq!(&keep(&otherwise), &kept);
            otherwise.rotate_left(turn.min(came.len()));
            prop_assert_eq!(&keep(&otherwise), &kept);
            prop_assert_eq!(&keep(&sorted(came.clone())), &kept);
            // By sorting all of them: the distances of the first.
            let distances = |points_m: &[[f64; 2]]| {
                let mut all: Vec<f64> =
                    points_m.iter().map(|at_m| apart_m2(about_m, *at_m)).collect();
                all.sort_by(f64::total_cmp);
                all
            };
            let mut nearest = distances(&came);
            nearest.truncate(MOST_POINTS);
            prop_assert_eq!(distances(&kept), nearest);
        }

        /// The same walls are found wherever one begins to go around.
        #[test]
        fn walls_do_not_depend_on_where_one_begins(
            ring in prop::collection::vec([-0.6..0.6f64, -0.6..0.6f64], 2..120),
            turn in 0..120_usize,
        ) {
            let mut turned = ring.clone();
            turned.rotate_left(turn.min(ring.len()));
            prop_assert_eq!(sorted(between_all(&turned)), sorted(between_all(&ring)));
        }
    }
}
