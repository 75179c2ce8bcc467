//! Which goals a recorded person was after, and when: abduction by the Viterbi algorithm.
//!
//! Time is cut into blocks of a tenth of a second. In each block every candidate goal costs the
//! truncated square of what the bearing law for it asks for less what the person did ask for; a
//! change of goal costs a fixed price. The cheapest sequence is found exactly. What the person asked
//! for counts throughout, also while the controller drove: the way that the robot then took is not
//! what they wanted.

use schemas::{Footprint, Pose, Scenario};

use super::bearing::{Gains, Goal, Habits, ask};
use super::rank::ranked;
use super::surprise::{Block, Sector, Surprises, TRUNCATED};
use super::ways::{Stretch, Ways};
use crate::recording::{Moment, Recording};

/// Ticks of the joystick in a block.
pub(super) const BLOCK: usize = 5;

/// Distance between candidate goals, metres.
pub(super) const GRID_M: f64 = 0.25;

/// At most so many grid points: a hall is searched coarser, not slower.
const MOST_POINTS: usize = 1200;

/// What a change of goal costs.
const SWITCH: f64 = 12.0;

/// More than any rounding of costs.
const SLACK: f64 = 1e-3;

/// A log's person, explained.
#[derive(Clone, Debug)]
pub(super) struct Explained {
    pub(super) habits: Habits,
    /// The goals one after the other, each with the block from which on it holds.
    pub(super) goals: Vec<(usize, Goal)>,
    /// What the explanation costs.
    pub(super) cost: f64,
    /// Root mean square of what it leaves unexplained, [m/s, rad/s].
    pub(super) residual: [f64; 2],
}

impl Explained {
    /// The goal at a tick.
    pub(super) fn goal(&self, tick: usize) -> Goal {
        let begun = self.goals.partition_point(|(from, _)| *from <= tick / BLOCK);
        begun.checked_sub(1).map_or(Goal::Rest, |last| self.goals[last].1)
    }
}

/// Explains the person of a recording by goals on a grid, as far as so many blocks go.
pub(super) fn explain(
    recording: &Recording,
    gains: &Gains,
    grid_m: f64,
    most_blocks: usize,
) -> Explained {
    let habits = habits(recording);
    let candidates = candidates(recording, grid_m);
    let blocks = || blocks(recording, gains.delay_s).take(most_blocks);
    let (stretches, cost) = cheapest(&candidates, blocks(), gains, &habits);
    let goals: Vec<(usize, Goal)> = stretches
        .into_iter()
        .map(|stretch| (stretch.from, candidates[stretch.candidate]))
        .collect();
    let mut explained = Explained { habits, goals, cost, residual: [0.0; 2] };
    let mut squares = [0.0; 2];
    let mut count = 0_u32;
    for (number, block) in blocks().enumerate() {
        let Some(block) = block else { continue };
        let goal = explained.goal(number * BLOCK);
        let model = ask(gains, &habits, &goal, &block.pose, block.t_s);
        for axis in 0..2 {
            let off = block.asked[axis] - model[axis];
            squares[axis] += off * off;
        }
        count += 1;
    }
    explained.residual = squares.map(|sum| libm::sqrt(sum / f64::from(count.max(1))));
    explained
}

/// What the person of a recording usually asks for.
pub(super) fn habits(recording: &Recording) -> Habits {
    recording.explanations().habits(|| usual(recording))
}

/// Shares of what they ask for, each in its order: speed forwards, backwards, and turn rate.
fn usual(recording: &Recording) -> Habits {
    const SHARES: [f64; 3] = [0.7, 0.6, 0.98];
    let asked = |see: &mut dyn FnMut(usize, f64)| {
        for request in recording.look().all().filter_map(|moment| moment.request) {
            let v_mps = request.v_mps;
            for (which, value, counts) in [
                (0, v_mps, v_mps > 0.03),
                (1, -v_mps, v_mps < -0.03),
                (2, request.omega_radps.abs(), true),
            ] {
                if counts && value.is_finite() {
                    see(which, value);
                }
            }
        }
    };
    let rank = |which: usize, count: usize| (count as f64 * SHARES[which]) as usize;
    let [forward, backward, turns] = ranked(asked, rank);
    Habits {
        forward_mps: forward.unwrap_or(0.3),
        backward_mps: backward.unwrap_or(0.2),
        turn_radps: turns.unwrap_or(1.0).max(0.3),
        slow_m: 0.5,
    }
}

/// The goals that a person in that room might have: free points of a grid, each also backwards, the
/// task's target, and staying.
fn candidates(recording: &Recording, grid_m: f64) -> Vec<Goal> {
    let scenario = &recording.header().scenario;
    let mut goals = vec![Goal::Rest];
    goals.extend(scenario.task.map(Goal::Follow));
    let points = points(scenario, recording.look().all(), grid_m);
    goals.extend(points.iter().map(|at_m| Goal::At(*at_m)));
    goals.extend(points.iter().map(|at_m| Goal::BackTo(*at_m)));
    goals
}

/// Free points on a grid about everywhere that the robot was.
fn points(
    scenario: &Scenario,
    moments: impl Iterator<Item = Moment>,
    grid_m: f64,
) -> Vec<[f64; 2]> {
    // What lies beyond a person's reach in a few seconds differs in its bearing alone.
    const MARGIN_M: f64 = 3.0;
    let mut low = scenario.start.pose.position_m();
    let mut high = low;
    for state in moments.filter_map(|moment| moment.state) {
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

/// The blocks of a recording; `None` where something is missing.
fn blocks(recording: &Recording, delay_s: f64) -> impl Iterator<Item = Option<Block>> {
    let mut look = recording.look();
    let back = delay_ticks(delay_s);
    (0..look.len().div_ceil(BLOCK)).map(move |block| {
        let first = block * BLOCK;
        let ticks = first..(first + BLOCK).min(look.len());
        let mut asked = [0.0; 2];
        let mut count = 0.0;
        for request in ticks.clone().filter_map(|tick| look.at(tick)?.request) {
            if request.v_mps.is_finite() && request.omega_radps.is_finite() {
                asked[0] += request.v_mps;
                asked[1] += request.omega_radps;
                count += 1.0;
            }
        }
        let middle = usize::midpoint(ticks.start, ticks.end);
        let state = look.at(middle.saturating_sub(back))?.state?;
        (count > 0.0).then(|| Block {
            pose: state.pose,
            t_s: Recording::tick_s(middle),
            asked: asked.map(|sum| sum / count),
        })
    })
}

/// A reaction time in ticks.
pub(super) fn delay_ticks(delay_s: f64) -> usize {
    libm::round(delay_s / simulator::JOYSTICK_PERIOD.seconds()) as usize
}

/// The cheapest sequence of candidates, and its cost.
///
/// A candidate that has just been changed to, and explains the block worse than the best one does, is changed
/// to again in the next: by how much worse does not matter, and most are seen to be without asking the law.
fn cheapest(
    candidates: &[Goal],
    blocks: impl Iterator<Item = Option<Block>>,
    gains: &Gains,
    habits: &Habits,
) -> (Vec<Stretch>, f64) {
    let mut ways = Ways::new(candidates.len());
    let mut costs = vec![0.0; candidates.len()];
    let mut surprises = Surprises::new(candidates, gains, habits);
    let mut changed = Vec::with_capacity(candidates.len());
    let mut any = false;
    for (number, block) in blocks.enumerate() {
        any = true;
        // Where a candidate's cheapest way into a block is a change, it comes from the same for all.
        let (best, least) = least(&costs);
        let mut changes = ways.changes(best, number);
        changed.clear();
        for (index, cost) in costs.iter_mut().enumerate() {
            if least + SWITCH < *cost {
                *cost = least + SWITCH;
                changes.to(index);
                changed.push(index);
            }
        }
        let Some(block) = block else { continue };
        surprises.begin(block);
        let mut next = f64::INFINITY;
        let mut again = changed.iter().copied().peekable();
        for (index, cost) in costs.iter_mut().enumerate() {
            if again.next_if_eq(&index).is_none() {
                *cost += surprises.of(index);
                next = next.min(*cost);
            }
        }
        // No candidate that was just changed to is the best: that costs more than any surprise.
        let matters = next - least + SLACK;
        if matters < TRUNCATED {
            let sector = Sector::of(&surprises, matters);
            for index in &changed {
                costs[*index] = if sector.excludes(&candidates[*index]) {
                    f64::INFINITY
                } else {
                    costs[*index] + surprises.of(*index)
                };
            }
        } else {
            for index in &changed {
                costs[*index] += surprises.of(*index);
            }
        }
    }
    let (best, cost) = least(&costs);
    (if any { ways.to(best) } else { Vec::new() }, cost)
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

    /// The cheapest sequence and its cost by the book: every cost of every block.
    fn by_the_book(
        candidates: &[Goal],
        blocks: &[Option<Block>],
        gains: &Gains,
        habits: &Habits,
    ) -> (Vec<usize>, f64) {
        let mut surprises = Surprises::new(candidates, gains, habits);
        let mut costs = vec![0.0; candidates.len()];
        let mut from: Vec<Vec<usize>> = Vec::new();
        for block in blocks {
            let (best, least) = least(&costs);
            from.push((0..candidates.len()).collect());
            for (index, cost) in costs.iter_mut().enumerate() {
                if least + SWITCH < *cost {
                    *cost = least + SWITCH;
                    from.last_mut().expect("just pushed")[index] = best;
                }
                if let Some(block) = block {
                    surprises.begin(*block);
                    *cost += surprises.of(index);
                }
            }
        }
        let (mut index, cost) = least(&costs);
        let mut path = vec![0; blocks.len()];
        for (place, from) in path.iter_mut().zip(&from).rev() {
            *place = index;
            index = from[index];
        }
        (path, cost)
    }

    fn a_block() -> impl Strategy<Value = Option<Block>> {
        let at = || prop_oneof![Just(0.0), Just(1.0), -2.0..2.0f64];
        let block = (at(), at(), -4.0..4.0f64, prop::array::uniform2(-1.0..1.0f64));
        prop::option::weighted(0.9, block).prop_map(|block| {
            block.map(|(x_m, y_m, theta_rad, asked)| Block {
                pose: Pose { x_m, y_m, theta_rad },
                t_s: 1.0,
                asked,
            })
        })
    }

    proptest! {
        /// What is left out changes neither the cheapest sequence nor the last bit of its cost.
        #[test]
        fn the_cheapest_sequence_is_found(
            points in prop::collection::vec(prop::array::uniform2(-3.0..3.0f64), 1..8),
            blocks in prop::collection::vec((a_block(), 1..12_usize), 1..12),
            turn_radps in 0.3..2.0f64,
        ) {
            let mut candidates = vec![Goal::Rest];
            candidates.extend(points.iter().map(|at_m| Goal::At(*at_m)));
            candidates.extend(points.iter().map(|at_m| Goal::BackTo(*at_m)));
            // People are after something for a while.
            let blocks: Vec<Option<Block>> = blocks
                .into_iter()
                .flat_map(|(block, times)| std::iter::repeat_n(block, times))
                .collect();
            let habits = Habits { forward_mps: 0.4, backward_mps: 0.2, turn_radps, slow_m: 0.5 };
            let gains = &Gains::PRIOR;
            let (stretches, cost) =
                cheapest(&candidates, blocks.iter().copied(), gains, &habits);
            let (path, wanted) = by_the_book(&candidates, &blocks, gains, &habits);
            prop_assert_eq!(cost.to_bits(), wanted.to_bits());
            for (block, candidate) in path.into_iter().enumerate() {
                let holds = stretches.iter().rfind(|stretch| stretch.from <= block);
                prop_assert_eq!(holds.map(|stretch| stretch.candidate), Some(candidate));
            }
        }
    }
}
