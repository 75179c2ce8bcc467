//! Which side distance is d2 (3).
//!
//! In: the distances to the left and to the right with their admissible wanted values. Out: a side.

use crate::law::Side;
use crate::params::choice;

choice! {
    /// Which side distance the feedback law looks at.
    SideRule {
        /// The side on which the robot, or its admissible wanted place, is nearer to the edge;
        /// the present side is favoured (specification §6, erratum 8).
        Near = "near",
        /// The side with the smaller error |ln(d2/dr2)|, ties left (3). It drops the side that is
        /// being approached.
        Printed = "printed",
    }
}

/// A side distance and the admissible wanted distance on that side, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideDistance {
    /// d2l or d2r.
    pub d_m: f64,
    /// `d_r2l` or `d_r2r`.
    pub d_r_m: f64,
}

/// The side to look at. `favour` (`near` only) is what the value of the `previous` side is
/// multiplied by. A side whose distance is unknown is not chosen while the other's is known: no
/// feedback can be formed from it, and the safety layer guards it.
pub fn choose(
    rule: SideRule,
    left: &SideDistance,
    right: &SideDistance,
    previous: Option<Side>,
    favour: f64,
) -> Side {
    let left_wins = match (left.d_m.is_nan(), right.d_m.is_nan()) {
        (false, false) => match rule {
            SideRule::Near => {
                let value = |distance: &SideDistance, side: Side| {
                    let near_m = distance.d_m.min(distance.d_r_m);
                    if previous == Some(side) { favour * near_m } else { near_m }
                };
                value(left, Side::Left) <= value(right, Side::Right)
            }
            SideRule::Printed => {
                let error =
                    |distance: &SideDistance| libm::fabs(libm::log(distance.d_m / distance.d_r_m));
                error(left) <= error(right)
            }
        },
        (true, true) => previous != Some(Side::Right),
        (left_unknown, _) => !left_unknown,
    };
    if left_wins { Side::Left } else { Side::Right }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(d_m: f64, d_r_m: f64) -> SideDistance {
        SideDistance { d_m, d_r_m }
    }

    /// Ties go left; `near` favours the present side by a tenth.
    #[test]
    fn ties_and_favours() {
        let same = of(0.5, 0.5);
        for rule in [SideRule::Near, SideRule::Printed] {
            assert_eq!(choose(rule, &same, &same, None, 0.9), Side::Left);
        }
        let near = |left: f64, right: f64, previous| {
            choose(SideRule::Near, &of(left, 1.0), &of(right, 1.0), previous, 0.9)
        };
        assert_eq!(near(0.5, 0.46, Some(Side::Left)), Side::Left);
        assert_eq!(near(0.5, 0.44, Some(Side::Left)), Side::Right);
        assert_eq!(near(0.46, 0.5, Some(Side::Right)), Side::Right);
        assert_eq!(near(0.44, 0.5, Some(Side::Right)), Side::Left);
    }

    /// Erratum 8: as printed, the wall that is being approached is dropped.
    #[test]
    fn the_printed_rule_drops_the_near_wall() {
        let (near_wall, far_wall) = (of(0.02, 0.3), of(0.9, 1.0));
        assert_eq!(choose(SideRule::Printed, &near_wall, &far_wall, None, 0.9), Side::Right);
        assert_eq!(choose(SideRule::Near, &near_wall, &far_wall, None, 0.9), Side::Left);
    }

    #[test]
    fn an_unknown_side_is_not_chosen_while_the_other_is_known() {
        let unknown = of(f64::NAN, f64::NAN);
        for rule in [SideRule::Near, SideRule::Printed] {
            for previous in [None, Some(Side::Left), Some(Side::Right)] {
                assert_eq!(choose(rule, &unknown, &of(1.0, 1.0), previous, 0.9), Side::Right);
                assert_eq!(choose(rule, &of(1.0, 1.0), &unknown, previous, 0.9), Side::Left);
                let both = choose(rule, &unknown, &unknown, previous, 0.9);
                assert_eq!(both, previous.unwrap_or(Side::Left));
            }
        }
    }
}
