//! Whether what the person asked for was safe, and the least that would have had to be changed.
//!
//! Judged from the truth: true pose and speeds, the world with its discs as they will move, the
//! footprint, and the plant's limits. The controller's own sets, sensors and estimates do not enter.

use schemas::{Plant, Pose, Twist};

use super::answers::Answers;
use super::sample::Limits;
use super::sweep::{Course, Surroundings};

/// How long an input is held before the robot brakes, seconds. Our choice: about what a person who
/// does not expect it takes to notice and to react (Green, "How long does it take to stop?",
/// Transportation Human Factors 2(3), 2000: 1.25 to 1.5 s behind a wheel, less when alert), and the
/// time in which the paper's sets call a wall dangerous at full speed.
pub(super) const HOLD_S: f64 = 1.0;

/// A judgement stands this long, seconds: that of the paper's control period. Faster controllers are
/// not asked about more often.
const STANDS_S: f64 = 0.1;

/// Radii of the search for the least correction, as a share of full speed.
const RING: f64 = 0.1;

/// Number of rings: together they cover every pair of inputs within the limits, 2√2 apart at most.
const RINGS: u32 = 29;

/// Directions on a ring.
const DIRECTIONS: usize = 16;

/// How often a correction is halved down: to 0.3 % of full speed.
const HALVINGS: u32 = 5;

/// The width at which halving ends.
const FINEST: f64 = RING / (1 << HALVINGS) as f64;

/// What became of asking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Judgement {
    /// Whether the input could be held and braked from without contact.
    pub(super) safe: bool,
    /// u*: the safe input nearest to it; `None` where no input is safe.
    pub(super) nearest_safe: Option<Twist>,
}

/// Judges inputs, not more often than ten times a second.
#[derive(Clone, Debug)]
pub(super) struct Judge {
    surroundings: Surroundings,
    limits: Limits,
    delay_s: f64,
    accel: [f64; 2],
    limits_acceleration: bool,
    last: Option<(f64, Option<Judgement>)>,
    answers: Answers<9, Option<Judgement>>,
}

/// The state in which an input was given.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    /// Seconds from the start of the run.
    pub(super) t_s: f64,
    pub(super) pose: Pose,
    pub(super) twist: Twist,
    /// Whether the law commands accelerations: then speeds never change at once.
    pub(super) accelerates: bool,
}

impl Judge {
    pub(super) fn new(surroundings: Surroundings, plant: &Plant) -> Judge {
        Judge {
            surroundings,
            limits: Limits::new(plant),
            delay_s: plant.actuator_delay_s,
            accel: [plant.accel_max_mps2, plant.alpha_max_radps2],
            limits_acceleration: plant.limits_acceleration,
            last: None,
            answers: Answers::default(),
        }
    }

    /// Answers together with another judge of the same surroundings and plant.
    pub(super) fn ask_with(&mut self, other: &Judge) {
        self.answers = other.answers.clone();
    }

    /// The judgement of an input; `None` where something is not known, where there is nothing to
    /// touch, and where the body is in contact already.
    pub(super) fn judge(&mut self, state: &State, input: Twist) -> Option<Judgement> {
        if let Some((since_s, judgement)) = self.last
            && state.t_s >= since_s
            && state.t_s < since_s + STANDS_S - 1e-9
        {
            return judgement;
        }
        let State { t_s, pose, twist, accelerates } = *state;
        let question = [
            t_s,
            pose.x_m,
            pose.y_m,
            pose.theta_rad,
            twist.v_mps,
            twist.omega_radps,
            f64::from(u8::from(accelerates)),
            input.v_mps,
            input.omega_radps,
        ];
        let judgement = self.answers.of(question, || self.judged(state, input));
        self.last = Some((state.t_s, judgement));
        judgement
    }

    fn judged(&self, state: &State, input: Twist) -> Option<Judgement> {
        let State { t_s, pose, twist, .. } = state;
        let known =
            [input, *twist].iter().all(|t| t.v_mps.is_finite() && t.omega_radps.is_finite());
        if !known || !pose.is_finite() || !t_s.is_finite() || self.surroundings.is_empty() {
            return None;
        }
        let clearance_m = self.surroundings.clearance_m(pose, *t_s);
        if clearance_m <= 0.0 {
            return None;
        }
        let safe = self.is_safe(state, clearance_m, input);
        let nearest_safe =
            if safe { Some(input) } else { self.nearest_safe(state, clearance_m, input) };
        Some(Judgement { safe, nearest_safe })
    }

    /// Whether an input can be held for [`HOLD_S`] and braked from, clear all the way. Standing
    /// still is safe: a disc that walks into a robot at rest is nobody's input.
    fn is_safe(&self, state: &State, clearance_m: f64, input: Twist) -> bool {
        let rest = |twist: Twist| twist.v_mps == 0.0 && twist.omega_radps == 0.0;
        if rest(input) && rest(state.twist) {
            return true;
        }
        let gradual = state.accelerates || self.limits_acceleration;
        let stops = rest(input) && !gradual && self.delay_s == 0.0;
        let course = Course {
            from: state.twist,
            to: input,
            delay_s: self.delay_s,
            hold_s: if rest(input) { 0.0 } else { HOLD_S },
            accel: gradual.then_some(self.accel),
        };
        stops || !self.surroundings.touches(&state.pose, state.t_s, &course, clearance_m)
    }

    /// The safe input with the least ‖S(u − `u_h`)‖: rings about `u_h` until one holds a safe
    /// input, then each safe direction of that ring halved down.
    fn nearest_safe(&self, state: &State, clearance_m: f64, input: Twist) -> Option<Twist> {
        let directions: [(f64, f64); DIRECTIONS] = core::array::from_fn(|direction| {
            libm::sincos(direction as f64 * core::f64::consts::TAU / DIRECTIONS as f64)
        });
        let candidate = |radius: f64, (sin, cos): (f64, f64)| {
            let moved = self.limits.moved(input, [radius * cos, radius * sin]);
            self.limits.allow(moved).then_some(moved)
        };
        let safe = |u: &Twist| self.is_safe(state, clearance_m, *u);
        for ring in 1..=RINGS {
            let outer = f64::from(ring) * RING;
            let mut best: Option<(f64, Twist)> = None;
            for direction in directions {
                let Some(mut found) = candidate(outer, direction).filter(safe) else { continue };
                let (mut low, mut high) = (outer - RING, outer);
                for _ in 0..HALVINGS {
                    // Halving ends at least that far above `low`: no nearer than the best.
                    if best.is_some_and(|(least, _)| low + FINEST >= least) {
                        break;
                    }
                    let middle = 0.5 * (low + high);
                    match candidate(middle, direction).filter(safe) {
                        Some(nearer) => (found, high) = (nearer, middle),
                        None => low = middle,
                    }
                }
                if best.is_none_or(|(least, _)| high < least) {
                    best = Some((high, found));
                }
            }
            if best.is_some() {
                return best.map(|(_, found)| found);
            }
        }
        None
    }
}
