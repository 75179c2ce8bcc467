//! A recording in the making: samples become moments, one every tick of the joystick.

use schemas::{Event, Gap, JoystickSample, Pose, Sample, Span, Time, Truth, wrap};
use simulator::{JOYSTICK_PERIOD, Request};

use super::moments::Moments;
use super::{Coverage, State};

/// Longest gap between two states across which one in between is taken from a straight line.
const LONGEST_GAP: Span = Span(500_000_000);

/// The longest recording whose person can be brought back, ticks (six hours): a damaged time stamp
/// must not ask for the memory of a century.
const MOST_TICKS: u64 = 6 * 3600 * 50;

/// What a recording is made of while its log is read.
pub(super) struct Builder {
    start: Time,
    pub(super) moments: Moments,
    pub(super) coverage: Option<Coverage>,
    pub(super) gaps: Vec<Gap>,
    /// Whether there was any sample of the joystick.
    pub(super) asked: bool,
    /// The newest state, with its instant.
    last: Option<(Time, State)>,
    /// Whether states come from `/truth`; from the controller's estimate otherwise.
    truth: bool,
}

impl Builder {
    /// Of a session that started at `start`; so many moments stay in memory.
    pub(super) fn new(start: Time, kept: usize) -> Builder {
        let (moments, gaps) = (Moments::new(kept), Vec::new());
        Builder { start, moments, coverage: None, gaps, asked: false, last: None, truth: false }
    }

    pub(super) fn observe(&mut self, event: &Event) {
        match event {
            Event::Sample(Sample::Joystick(sample)) => self.joystick(sample),
            Event::Sample(Sample::Sonar(scan)) => {
                let coverage = self.coverage.get_or_insert_default();
                if let Some((_, state)) = &self.last {
                    coverage.see(&state.pose, scan);
                }
            }
            Event::Truth(truth) => self.truth(truth),
            Event::Gap(gap) => self.gaps.push(gap.clone()),
            // The person looks at the robot themselves; the estimate is the next best.
            Event::Step(step) if !self.truth => {
                let (v_mps, omega_radps) = (step.v_mps, step.omega_radps);
                self.state(step.stamp, State { pose: step.pose, v_mps, omega_radps });
            }
            _ => {}
        }
    }

    fn truth(&mut self, truth: &Truth) {
        if !self.truth {
            self.truth = true;
            self.last = None;
            self.moments.forget_states();
        }
        let (v_mps, omega_radps) = (truth.v_mps, truth.omega_radps);
        self.state(truth.stamp, State { pose: truth.pose, v_mps, omega_radps });
    }

    /// The first tick at or after an instant; `None` beyond what can be kept.
    fn tick(&self, stamp: Time) -> Option<usize> {
        let after_ns = stamp.0.saturating_sub(self.start.0);
        let tick = after_ns.div_ceil(JOYSTICK_PERIOD.0);
        (tick < MOST_TICKS).then_some(tick as usize)
    }

    fn joystick(&mut self, sample: &JoystickSample) {
        if let Some(tick) = self.tick(sample.stamp) {
            self.asked = true;
            let JoystickSample { v_mps, omega_radps, dead_man, .. } = *sample;
            let request = Request { v_mps, omega_radps, dead_man };
            self.moments.change(tick, |moment| moment.request = Some(request));
        }
    }

    /// Takes in a state: every tick since the one before gets its share of the way between.
    fn state(&mut self, stamp: Time, state: State) {
        if !state.is_finite() || stamp < self.start {
            return;
        }
        let Some(tick) = self.tick(stamp) else { return };
        let before = self.last.replace((stamp, state));
        if let Some((earlier, from)) = before
            && earlier < stamp
            && stamp.0 - earlier.0 <= LONGEST_GAP.0
        {
            let first = self.tick(earlier).unwrap_or(tick);
            for between in first..tick {
                let at = self.start.after_ns(between as u64 * JOYSTICK_PERIOD.0);
                if at > earlier {
                    let share = at.seconds_since(earlier) / stamp.seconds_since(earlier);
                    let state = part_way(&from, &state, share);
                    self.moments.change(between, |moment| moment.state = Some(state));
                }
            }
        }
        if self.start.after_ns(tick as u64 * JOYSTICK_PERIOD.0) == stamp {
            self.moments.change(tick, |moment| moment.state = Some(state));
        }
    }
}

/// The state that share of the way from one to the other, the short way round.
fn part_way(from: &State, to: &State, share: f64) -> State {
    let mix = |a: f64, b: f64| a + share * (b - a);
    let turned_rad = wrap(to.pose.theta_rad - from.pose.theta_rad);
    State {
        pose: Pose {
            x_m: mix(from.pose.x_m, to.pose.x_m),
            y_m: mix(from.pose.y_m, to.pose.y_m),
            theta_rad: from.pose.theta_rad + share * turned_rad,
        },
        v_mps: mix(from.v_mps, to.v_mps),
        omega_radps: mix(from.omega_radps, to.omega_radps),
    }
}
