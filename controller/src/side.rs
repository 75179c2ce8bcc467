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
