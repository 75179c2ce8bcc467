//! Where the moving discs are.

use super::{MovingDisc, WalkedPath, World, minus};
use crate::Disc;

impl MovingDisc {
    /// Where the disc is, `t_s` seconds after the start of the session.
    pub fn at(&self, t_s: f64) -> Disc {
        let way_m = minus(self.to_m, self.from_m);
        let length_m = libm::hypot(way_m[0], way_m[1]);
        let walked_m = self.speed_mps * (t_s - self.start_s);
        // The comparisons also take a NaN, and a disc with nowhere to go, to the start.
        let share = if length_m > 0.0 && walked_m > 0.0 {
            let along_m = if self.to_and_fro {
                let lap_m = walked_m.rem_euclid(2.0 * length_m);
                if lap_m <= length_m { lap_m } else { 2.0 * length_m - lap_m }
            } else if walked_m < length_m {
                walked_m
            } else {
                length_m
            };
            along_m / length_m
        } else {
            0.0
        };
        Disc {
            centre_m: [self.from_m[0] + share * way_m[0], self.from_m[1] + share * way_m[1]],
            radius_m: self.radius_m,
        }
    }
}

impl WalkedPath {
    /// Where the disc is, `t_s` seconds after the start of the session; `None` before it came and after
    /// it went.
    pub fn at(&self, t_s: f64) -> Option<Disc> {
        let after = self.points.partition_point(|[at_s, ..]| *at_s <= t_s);
        let [from_s, from_x, from_y] = *self.points.get(after.checked_sub(1)?)?;
        let Some([to_s, to_x, to_y]) = self.points.get(after).copied() else {
            // The very end still belongs to it.
            let there = from_s == t_s;
            let centre_m = [from_x, from_y];
            return there.then_some(Disc { centre_m, radius_m: self.radius_m });
        };
        let share = (t_s - from_s) / (to_s - from_s);
        let centre_m = [from_x + share * (to_x - from_x), from_y + share * (to_y - from_y)];
        Some(Disc { centre_m, radius_m: self.radius_m })
    }

    /// Fastest that it was seen to move, m/s.
    pub fn speed_mps(&self) -> f64 {
        let speeds = self.points.windows(2).map(|pair| {
            let way_m = minus([pair[1][1], pair[1][2]], [pair[0][1], pair[0][2]]);
            libm::hypot(way_m[0], way_m[1]) / (pair[1][0] - pair[0][0])
        });
        speeds.fold(0.0, |fastest, speed| if speed > fastest { speed } else { fastest })
    }
}

impl World {
    /// Where the moving discs are, `t_s` seconds after the start of the session.
    pub fn discs_at(&self, t_s: f64) -> impl Iterator<Item = Disc> + '_ {
        let walked = self.paths.iter().filter_map(move |path| path.at(t_s));
        self.discs.iter().map(move |disc| disc.at(t_s)).chain(walked)
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.room.is_empty() && self.obstacles.is_empty() && !self.moves()
    }

    /// Whether anything in it moves.
    pub fn moves(&self) -> bool {
        !self.discs.is_empty() || !self.paths.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WALKER: MovingDisc = MovingDisc {
        radius_m: 0.2,
        from_m: [1.0, 2.0],
        to_m: [1.0, 4.0],
        speed_mps: 0.5,
        start_s: 1.0,
        to_and_fro: false,
    };

    /// A disc waits until its start, walks at its speed, and stops at the end or turns there.
    #[test]
    fn walks_and_stops_or_turns() {
        let y_m = |disc: &MovingDisc, t_s: f64| disc.at(t_s).centre_m[1];
        assert_eq!(y_m(&WALKER, -3.0), 2.0);
        assert_eq!(y_m(&WALKER, 1.0), 2.0);
        assert_eq!(y_m(&WALKER, 3.0), 3.0);
        assert_eq!(y_m(&WALKER, 5.0), 4.0);
        assert_eq!(y_m(&WALKER, 50.0), 4.0);
        let pacing = MovingDisc { to_and_fro: true, ..WALKER };
        assert_eq!(y_m(&pacing, 3.0), 3.0);
        assert_eq!(y_m(&pacing, 8.0), 2.5);
        assert_eq!(y_m(&pacing, 9.0), 2.0);
        assert_eq!(y_m(&pacing, 11.0), 3.0);
    }

    /// A walked path is there from its first instant to its last, and halfway between two points
    /// halfway in time.
    #[test]
    fn a_path_is_walked_as_it_was_seen() {
        let path = WalkedPath {
            radius_m: 0.2,
            points: vec![[1.0, 0.0, 0.0], [2.0, 1.0, 0.0], [4.0, 1.0, 1.0]],
        };
        let at = |t_s: f64| path.at(t_s).map(|disc| disc.centre_m);
        assert_eq!(at(0.9), None);
        assert_eq!(at(1.0), Some([0.0, 0.0]));
        assert_eq!(at(1.5), Some([0.5, 0.0]));
        assert_eq!(at(3.0), Some([1.0, 0.5]));
        assert_eq!(at(4.0), Some([1.0, 1.0]));
        assert_eq!(at(4.1), None);
        assert_eq!(at(f64::NAN), None);
        assert_eq!(path.speed_mps(), 1.0);
        let world = World { paths: vec![path], discs: vec![WALKER], ..World::default() };
        assert_eq!(world.discs_at(0.0).count(), 1);
        assert_eq!(world.discs_at(2.0).count(), 2);
    }

    /// Nowhere to go, no time and no finite way leave a disc where it started.
    #[test]
    fn stays_where_it_cannot_walk() {
        let resting = MovingDisc { to_m: WALKER.from_m, to_and_fro: true, ..WALKER };
        assert_eq!(resting.at(9.0).centre_m, WALKER.from_m);
        assert_eq!(WALKER.at(f64::NAN).centre_m, WALKER.from_m);
    }
}
