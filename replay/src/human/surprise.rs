//! What candidates cost in a block: the truncated square of what their law asks for less what the person
//! did ask for.

use schemas::Pose;

use super::bearing::{Gains, Goal, Habits, ask, ask_both};

/// What counts as one unit of surprise: m/s and rad/s.
const SIGMA: [f64; 2] = [0.15, 0.5];

/// Surprise beyond which a block no longer counts against a goal (its square).
pub(super) const TRUNCATED: f64 = 6.0;

/// A block of time: what was seen and what was asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub(super) pose: Pose,
    pub(super) t_s: f64,
    pub(super) asked: [f64; 2],
}

/// What each candidate costs in a block, worked out when asked for.
pub(super) struct Surprises<'a> {
    candidates: &'a [Goal],
    gains: &'a Gains,
    habits: &'a Habits,
    block: Block,
    /// Where no direction can say more than [`TRUNCATED`] does.
    hopeless: Sector,
    /// Not a number where it is not worked out yet.
    known: Vec<f64>,
    /// How many points there are to be at: as many to back up to follow them.
    points: usize,
}

impl<'a> Surprises<'a> {
    pub(super) fn new(
        candidates: &'a [Goal],
        gains: &'a Gains,
        habits: &'a Habits,
    ) -> Surprises<'a> {
        let ahead = candidates.iter().position(|goal| matches!(goal, Goal::At(_)));
        let ahead = ahead.unwrap_or(candidates.len());
        let block = Block { pose: Pose::default(), t_s: 0.0, asked: [0.0; 2] };
        Surprises {
            candidates,
            gains,
            habits,
            block,
            hopeless: Sector::EVERYWHERE,
            known: vec![f64::NAN; candidates.len()],
            points: (candidates.len() - ahead) / 2,
        }
    }

    /// Goes on to a block.
    pub(super) fn begin(&mut self, block: Block) {
        self.block = block;
        self.known.fill(f64::NAN);
        self.hopeless = Sector::of(self, TRUNCATED);
    }

    /// What a candidate costs in this block.
    pub(super) fn of(&mut self, index: usize) -> f64 {
        if self.known[index].is_nan() {
            if self.hopeless.excludes(&self.candidates[index]) {
                self.known[index] = TRUNCATED;
            } else {
                self.find(index);
            }
        }
        self.known[index]
    }

    fn find(&mut self, index: usize) {
        let Surprises { candidates, gains, habits, block, points, .. } = *self;
        let pair = match candidates[index] {
            Goal::At(_) => Some((index, index + points)),
            Goal::BackTo(_) => index.checked_sub(points).map(|ahead| (ahead, index)),
            _ => None,
        };
        // A point's bearing is the same for going there and for backing up to it, and the turn alone is
        // often surprise enough.
        let by_turn = |turn_radps: f64, speed_mps: &dyn Fn() -> f64| {
            let omega = (block.asked[1] - turn_radps) / SIGMA[1];
            if omega * omega >= TRUNCATED {
                TRUNCATED
            } else {
                surprise(block.asked, [speed_mps(), turn_radps])
            }
        };
        if let Some((ahead, back)) = pair
            && let (Some(Goal::At(at_m)), Some(Goal::BackTo(back_m))) =
                (candidates.get(ahead), candidates.get(back))
            && at_m == back_m
            && let Some(both) = ask_both(gains, habits, *at_m, &block.pose, by_turn)
        {
            [self.known[ahead], self.known[back]] = both;
        } else {
            let model = ask(gains, habits, &candidates[index], &block.pose, block.t_s);
            self.known[index] = surprise(block.asked, model);
        }
    }
}

fn surprise(asked: [f64; 2], model: [f64; 2]) -> f64 {
    let [v, omega] = [0, 1].map(|axis| (asked[axis] - model[axis]) / SIGMA[axis]);
    (v * v + omega * omega).min(TRUNCATED)
}

/// The directions in which a point may lie that surprises less than some bound by the turn alone.
///
/// It is a little larger than it need be, so that rounding excludes nobody.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sector {
    from_m: [f64; 2],
    /// Unit vectors along the right and the left edge.
    edges: [[f64; 2]; 2],
    span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Span {
    Nothing,
    /// Less than half of all directions.
    Narrow,
    Wide,
    Everything,
}

impl Sector {
    const EVERYWHERE: Sector =
        Sector { from_m: [0.0; 2], edges: [[1.0, 0.0]; 2], span: Span::Everything };

    /// Where the points lie that may cost less than `bound` in a block.
    pub(super) fn of(surprises: &Surprises<'_>, bound: f64) -> Sector {
        use core::f64::consts::{PI, TAU};
        // Directions, and turn rates.
        const MARGIN: f64 = 1e-6;
        let Surprises { gains, habits, block, .. } = surprises;
        let (asked, most) = (block.asked[1], habits.turn_radps);
        let reach = SIGMA[1] * libm::sqrt(bound) + MARGIN;
        let k = gains.k_theta;
        if !(asked.is_finite() && reach.is_finite() && block.pose.is_finite() && k > MARGIN) {
            return Sector::EVERYWHERE;
        }
        let (low, high) = (asked - reach, asked + reach);
        // Beyond the fastest turn all bearings ask for the same.
        let right = if low <= -most { -PI } else { (low / k).max(-PI) } - MARGIN;
        let left = if high >= most { PI } else { (high / k).min(PI) } + MARGIN;
        let span = if low > most || high < -most || right > left {
            Span::Nothing
        } else if left - right >= TAU {
            Span::Everything
        } else if left - right <= PI {
            Span::Narrow
        } else {
            Span::Wide
        };
        let edge = |bearing_rad: f64| {
            let (sin, cos) = libm::sincos(block.pose.theta_rad + bearing_rad);
            [cos, sin]
        };
        Sector { from_m: block.pose.position_m(), edges: [edge(right), edge(left)], span }
    }

    /// Whether a goal is a point that costs as much as the bound, or more.
    pub(super) fn excludes(&self, goal: &Goal) -> bool {
        // Nearer than this, metres, a direction means little.
        const NEAR_M: f64 = 1e-2;
        let (at_m, sign) = match goal {
            Goal::At(at_m) => (at_m, 1.0),
            Goal::BackTo(at_m) => (at_m, -1.0),
            Goal::Follow(_) | Goal::Rest => return false,
        };
        let way_m = [sign * (at_m[0] - self.from_m[0]), sign * (at_m[1] - self.from_m[1])];
        if way_m[0].abs() + way_m[1].abs() < NEAR_M {
            return false;
        }
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let [right, left] = self.edges;
        let (past_right, past_left) = (cross(right, way_m) < 0.0, cross(way_m, left) < 0.0);
        match self.span {
            Span::Nothing => true,
            Span::Narrow => past_right || past_left,
            Span::Wide => past_right && past_left,
            Span::Everything => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use schemas::Task;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(512))]

        /// Shortcuts change no candidate's cost, whatever the order of the candidates; and what a sector
        /// excludes costs as much as its bound, up to rounding.
        #[test]
        fn each_candidate_costs_what_the_law_says(
            points in prop::collection::vec(prop::array::uniform2(-3.0..3.0f64), 0..6),
            (x_m, y_m, theta_rad) in (-3.0..3.0f64, -3.0..3.0f64, -7.0..7.0f64),
            asked in prop::array::uniform2(prop_oneof![8 => -1.5..1.5f64, 1 => Just(f64::NAN)]),
            turned in any::<bool>(),
            (k_theta, turn_radps) in (0.7..3.0f64, prop_oneof![Just(0.3), 0.3..2.0f64]),
            bound in prop_oneof![Just(1e-3), 0.0..6.0f64],
        ) {
            let task = Task { from_m: [1.0, 1.0], velocity_mps: [0.5, 0.0], until_s: 4.0 };
            let mut candidates = vec![Goal::Rest, Goal::Follow(task)];
            candidates.extend(points.iter().map(|at_m| Goal::At(*at_m)));
            candidates.extend(points.iter().map(|at_m| Goal::BackTo(*at_m)));
            if turned {
                candidates.reverse();
            }
            let pose = Pose { x_m, y_m, theta_rad };
            let block = Block { pose, t_s: 1.0, asked };
            let habits = Habits { forward_mps: 0.4, backward_mps: 0.2, turn_radps, slow_m: 0.5 };
            let gains = Gains { k_theta, ..Gains::PRIOR };
            let mut surprises = Surprises::new(&candidates, &gains, &habits);
            surprises.begin(block);
            let sector = Sector::of(&surprises, bound);
            for (index, goal) in candidates.iter().enumerate() {
                let model = ask(&gains, &habits, goal, &pose, 1.0);
                let costs = surprise(asked, model);
                prop_assert_eq!(surprises.of(index).to_bits(), costs.to_bits());
                prop_assert!(!sector.excludes(goal) || costs >= bound);
            }
        }
    }

    /// A person who asks for a turn to the left by nearly all that the stick gives is after nothing on the
    /// right; ahead, behind and on the left is told apart by the bound.
    #[test]
    fn a_sector_is_where_the_turn_points() {
        let candidates = [Goal::Rest];
        let habits = Habits { forward_mps: 0.4, backward_mps: 0.2, turn_radps: 1.5, slow_m: 0.5 };
        let gains = Gains { k_theta: 1.0, delay_s: 0.0 };
        let mut surprises = Surprises::new(&candidates, &gains, &habits);
        surprises.begin(Block { pose: Pose::default(), t_s: 0.0, asked: [0.2, 1.0] });
        let within = |bound: f64, bearing_rad: f64| {
            let at_m = [2.0 * libm::cos(bearing_rad), 2.0 * libm::sin(bearing_rad)];
            let sector = Sector::of(&surprises, bound);
            [Goal::At(at_m), Goal::BackTo(at_m)].map(|goal| !sector.excludes(&goal))
        };
        // One unit is half a radian per second: bearings of 0.5 to 3.14, its tail's likewise.
        assert_eq!(within(1.0, 0.49), [false, false]);
        assert_eq!(within(1.0, 0.51), [true, false]);
        assert_eq!(within(1.0, 3.0), [true, false]);
        assert_eq!(within(1.0, -1.0), [false, true]);
        // A tenth of one: 0.842 to 1.158.
        assert_eq!(within(0.1, 0.83), [false, false]);
        assert_eq!(within(0.1, 1.0), [true, false]);
        assert_eq!(within(0.1, 1.17), [false, false]);
        assert_eq!(within(0.1, 1.0 - core::f64::consts::PI), [false, true]);
    }
}
