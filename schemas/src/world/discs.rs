//! Where the moving discs are.

use super::{MovingDisc, World, minus};
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

impl World {
    /// Where the moving discs are, `t_s` seconds after the start of the session.
    pub fn discs_at(&self, t_s: f64) -> impl Iterator<Item = Disc> + '_ {
        self.discs.iter().map(move |disc| disc.at(t_s))
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

    /// Nowhere to go, no time and no finite way leave a disc where it started.
    #[test]
    fn stays_where_it_cannot_walk() {
        let resting = MovingDisc { to_m: WALKER.from_m, to_and_fro: true, ..WALKER };
        assert_eq!(resting.at(9.0).centre_m, WALKER.from_m);
        assert_eq!(WALKER.at(f64::NAN).centre_m, WALKER.from_m);
    }
}
