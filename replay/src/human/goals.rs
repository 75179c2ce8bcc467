//! Which goals a recorded person was after, and when: abduction by the Viterbi algorithm.
//!
//! Time is cut into blocks of a tenth of a second. In each block every candidate goal costs the
//! truncated square of what the bearing law for it asks for less what the person did ask for; a
//! change of goal costs a fixed price. The cheapest sequence is found exactly. What the person asked
//! for counts throughout, also while the controller drove: the way that the robot then took is not
//! what they wanted.

use schemas::{Footprint, Pose, Scenario};

use super::bearing::{Gains, Goal, Habits, ask, ask_both};
use crate::recording::{Moment, Recording, State};

/// Ticks of the joystick in a block.
pub(super) const BLOCK: usize = 5;

/// Distance between candidate goals, metres.
pub(super) const GRID_M: f64 = 0.25;

/// At most so many grid points: a hall is searched coarser, not slower.
const MOST_POINTS: usize = 1200;

/// What counts as one unit of surprise: m/s and rad/s.
const SIGMA: [f64; 2] = [0.15, 0.5];

/// Surprise beyond which a block no longer counts against a goal (its square).
const TRUNCATED: f64 = 6.0;

/// What a change of goal costs.
const SWITCH: f64 = 12.0;

/// A log's person, explained.
#[derive(Clone, Debug)]
pub(super) struct Explained {
    pub(super) habits: Habits,
    /// The goal of each block.
    pub(super) goals: Vec<Goal>,
    /// What the explanation costs.
    pub(super) cost: f64,
    /// Root mean square of what it leaves unexplained, [m/s, rad/s].
    pub(super) residual: [f64; 2],
}

impl Explained {
    /// The goal at a tick.
    pub(super) fn goal(&self, tick: usize) -> Goal {
        self.goals.get(tick / BLOCK).or(self.goals.last()).copied().unwrap_or(Goal::Rest)
    }
}

/// Explains the person of a recording by goals on a grid, as far as so many blocks go.
pub(super) fn explain(
    recording: &Recording,
    gains: &Gains,
    grid_m: f64,
    most_blocks: usize,
) -> Explained {
    let habits = habits(recording.moments());
    let candidates = candidates(recording, grid_m);
    let mut blocks = blocks(recording, gains.delay_s);
    blocks.truncate(most_blocks);
    let (path, cost) = cheapest(&candidates, &blocks, gains, &habits);
    let goals: Vec<Goal> = path.into_iter().map(|index| candidates[index]).collect();
    let mut squares = [0.0; 2];
    let mut count = 0_u32;
    for (block, goal) in blocks.iter().zip(&goals) {
        let Some(block) = block else { continue };
        let model = ask(gains, &habits, goal, &block.pose, block.t_s);
        for axis in 0..2 {
            let off = block.asked[axis] - model[axis];
            squares[axis] += off * off;
        }
        count += 1;
    }
    let residual = squares.map(|sum| libm::sqrt(sum / f64::from(count.max(1))));
    Explained { habits, goals, cost, residual }
}

/// What a person usually asks for.
pub(super) fn habits(moments: &[Moment]) -> Habits {
    let asked = |of: &dyn Fn(f64, f64) -> Option<f64>| {
        let mut values: Vec<f64> = moments
            .iter()
            .filter_map(|moment| moment.request)
            .filter_map(|request| of(request.v_mps, request.omega_radps))
            .filter(|value| value.is_finite())
            .collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let share = |values: &[f64], share: f64, otherwise: f64| {
        values.get((values.len() as f64 * share) as usize).copied().unwrap_or(otherwise)
    };
    let forward = asked(&|v, _| (v > 0.03).then_some(v));
    let backward = asked(&|v, _| (v < -0.03).then_some(-v));
    let turns = asked(&|_, omega| Some(omega.abs()));
    let forward_mps = share(&forward, 0.7, 0.3);
    Habits {
        forward_mps,
        backward_mps: share(&backward, 0.6, 0.2),
        turn_radps: share(&turns, 0.98, 1.0).max(0.3),
        slow_m: 0.5,
    }
}

/// The goals that a person in that room might have: free points of a grid, each also backwards, the
/// task's target, and staying.
fn candidates(recording: &Recording, grid_m: f64) -> Vec<Goal> {
    let scenario = &recording.header().scenario;
    let mut goals = vec![Goal::Rest];
    goals.extend(scenario.task.map(Goal::Follow));
    let points = points(scenario, recording.moments(), grid_m);
    goals.extend(points.iter().map(|at_m| Goal::At(*at_m)));
    goals.extend(points.iter().map(|at_m| Goal::BackTo(*at_m)));
    goals
}

/// Free points on a grid about everywhere that the robot was.
fn points(scenario: &Scenario, moments: &[Moment], grid_m: f64) -> Vec<[f64; 2]> {
    // What lies beyond a person's reach in a few seconds differs in its bearing alone.
    const MARGIN_M: f64 = 3.0;
    let mut low = scenario.start.pose.position_m();
    let mut high = low;
    for state in moments.iter().filter_map(|moment| moment.state) {
        for (axis, at) in state.pose.position_m().into_iter().enumerate() {
            low[axis] = low[axis].min(at);
            high[axis] = high[axis].max(at);
        }
    }
    let extent = |axis: usize| high[axis] - low[axis] + 2.0 * MARGIN_M;
    let area = extent(0) * extent(1);
    let grid_m = grid_m.max(libm::sqrt(area / MOST_POINTS as f64));
    if !grid_m.is_finite() {
        return Vec::new();
    }
    // The area alone does not bound a strip: one pose that is far off must not ask for billions.
    let cells =
        [0, 1].map(|axis| (libm::floor(extent(axis) / grid_m) as u32).min(MOST_POINTS as u32));
    let mut points = Vec::new();
    for row in 0..=cells[1] {
        for column in 0..=cells[0] {
            let at_m = [
                low[0] - MARGIN_M + f64::from(column) * grid_m,
                low[1] - MARGIN_M + f64::from(row) * grid_m,
            ];
            let pose = Pose { x_m: at_m[0], y_m: at_m[1], theta_rad: 0.0 };
            // People stand beside things, not in them; +∞ in a log without a world.
            if scenario.world.clearance_static_m(&Footprint::POINT, &pose) > 0.0 {
                points.push(at_m);
            }
        }
    }
    points
}

/// A block of time: what was seen and what was asked for.
struct Block {
    pose: Pose,
    t_s: f64,
    asked: [f64; 2],
}

/// The blocks of a recording; `None` where something is missing.
fn blocks(recording: &Recording, delay_s: f64) -> Vec<Option<Block>> {
    let moments = recording.moments();
    let back = delay_ticks(delay_s);
    (0..moments.len().div_ceil(BLOCK))
        .map(|block| {
            let first = block * BLOCK;
            let ticks = first..(first + BLOCK).min(moments.len());
            let mut asked = [0.0; 2];
            let mut count = 0.0;
            for request in moments[ticks.clone()].iter().filter_map(|moment| moment.request) {
                if request.v_mps.is_finite() && request.omega_radps.is_finite() {
                    asked[0] += request.v_mps;
                    asked[1] += request.omega_radps;
                    count += 1.0;
                }
            }
            let middle = usize::midpoint(ticks.start, ticks.end);
            let state: State = moments[middle.saturating_sub(back)].state?;
            (count > 0.0).then(|| Block {
                pose: state.pose,
                t_s: Recording::tick_s(middle),
                asked: asked.map(|sum| sum / count),
            })
        })
        .collect()
}

/// A reaction time in ticks.
pub(super) fn delay_ticks(delay_s: f64) -> usize {
    libm::round(delay_s / simulator::JOYSTICK_PERIOD.seconds()) as usize
}

/// The cheapest sequence of candidates, and its cost.
fn cheapest(
    candidates: &[Goal],
    blocks: &[Option<Block>],
    gains: &Gains,
    habits: &Habits,
) -> (Vec<usize>, f64) {
    let words = candidates.len().div_ceil(64);
    // Whether a candidate's cheapest way into a block is a change; from which one is the same for all.
    let mut changed: Vec<u64> = Vec::with_capacity(words * blocks.len());
    let mut from = Vec::with_capacity(blocks.len());
    let mut costs = vec![0.0; candidates.len()];
    let mut surprises = vec![0.0; candidates.len()];
    for block in blocks {
        if let Some(block) = block {
            surprise_all(candidates, block, gains, habits, &mut surprises);
        }
        let (best, least) = least(&costs);
        from.push(best);
        let row = changed.len();
        changed.resize(row + words, 0);
        for (index, cost) in costs.iter_mut().enumerate() {
            if least + SWITCH < *cost {
                *cost = least + SWITCH;
                changed[row + index / 64] |= 1 << (index % 64);
            }
            if block.is_some() {
                *cost += surprises[index];
            }
        }
    }
    let (mut index, cost) = least(&costs);
    let mut path = vec![0; blocks.len()];
    for block in (0..blocks.len()).rev() {
        path[block] = index;
        if changed[block * words + index / 64] >> (index % 64) & 1 == 1 {
            index = from[block];
        }
    }
    (path, cost)
}

/// What each candidate costs in a block.
fn surprise_all(
    candidates: &[Goal],
    block: &Block,
    gains: &Gains,
    habits: &Habits,
    surprises: &mut [f64],
) {
    let alone =
        |goal: &Goal| surprise(block.asked, ask(gains, habits, goal, &block.pose, block.t_s));
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
    let ahead = candidates.iter().position(|goal| matches!(goal, Goal::At(_)));
    let ahead = ahead.unwrap_or(candidates.len());
    let points = (candidates.len() - ahead) / 2;
    for (index, goal) in candidates.iter().enumerate() {
        match *goal {
            // Done together with going there.
            Goal::BackTo(at_m)
                if index >= points && candidates[index - points] == Goal::At(at_m) => {}
            Goal::At(at_m) if candidates.get(index + points) == Some(&Goal::BackTo(at_m)) => {
                let both = ask_both(gains, habits, at_m, &block.pose, by_turn);
                let both =
                    both.unwrap_or_else(|| [*goal, Goal::BackTo(at_m)].map(|goal| alone(&goal)));
                [surprises[index], surprises[index + points]] = both;
            }
            _ => surprises[index] = alone(goal),
        }
    }
}

fn surprise(asked: [f64; 2], model: [f64; 2]) -> f64 {
    let [v, omega] = [0, 1].map(|axis| (asked[axis] - model[axis]) / SIGMA[axis]);
    (v * v + omega * omega).min(TRUNCATED)
}

/// The least of some numbers, and the first place where it stands.
fn least(costs: &[f64]) -> (usize, f64) {
    let mut found = (0, f64::INFINITY);
    for (index, cost) in costs.iter().enumerate() {
        if *cost < found.1 {
            found = (index, *cost);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use schemas::Task;

    proptest! {
        /// Shortcuts change no candidate's cost, whatever the order of the candidates.
        #[test]
        fn each_candidate_costs_what_the_law_says(
            points in prop::collection::vec(prop::array::uniform2(-3.0..3.0f64), 0..6),
            (x_m, y_m, theta_rad) in (-3.0..3.0f64, -3.0..3.0f64, -7.0..7.0f64),
            asked in prop::array::uniform2(prop_oneof![-1.5..1.5f64, Just(f64::NAN)]),
            turned in any::<bool>(),
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
            let habits = Habits { forward_mps: 0.4, backward_mps: 0.2, turn_radps: 1.2, slow_m: 0.5 };
            let mut costs = vec![f64::NAN; candidates.len()];
            surprise_all(&candidates, &block, &Gains::PRIOR, &habits, &mut costs);
            for (goal, cost) in candidates.iter().zip(costs) {
                let model = ask(&Gains::PRIOR, &habits, goal, &pose, 1.0);
                prop_assert_eq!(cost.to_bits(), surprise(asked, model).to_bits());
            }
        }
    }
}
