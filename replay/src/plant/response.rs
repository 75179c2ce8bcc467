//! One axis: how its speed follows its command.

use super::Estimate;

/// A quantity over time.
#[derive(Clone, Debug, Default)]
pub(super) struct Course {
    t_s: Vec<f64>,
    values: Vec<f64>,
}

impl Course {
    pub(super) fn is_empty(&self) -> bool {
        self.t_s.is_empty()
    }

    /// Adds a value; one that is not a number, or does not come after the last, is left out.
    pub(super) fn push(&mut self, t_s: f64, value: f64) {
        if value.is_finite() && self.t_s.last().is_none_or(|last| t_s > *last) {
            self.t_s.push(t_s);
            self.values.push(value);
        }
    }
}

/// Delays that are tried first, seconds.
const DELAYS_S: [f64; 8] = [0.0, 0.04, 0.08, 0.12, 0.16, 0.2, 0.28, 0.4];

/// Limits that are tried first, m/s² or rad/s²; the last is none.
const LIMITS: [f64; 10] = [0.2, 0.3, 0.5, 0.8, 1.2, 2.0, 3.0, 5.0, 8.0, f64::INFINITY];

/// χ² of one parameter at 95 %.
const CHANCE: f64 = 3.84;

/// A deviation of commands below which nothing is asked for, m/s or rad/s.
const LEAST_EXCITED: f64 = 0.02;

/// The least error that sensors have, squared: 3 mm/s. Without it a noiseless log would be sure of
/// the last digit of the grid.
const LEAST_VARIANCE: f64 = 1e-5;

/// The parameters of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Parameters {
    gain: f64,
    delay_s: f64,
    limit: f64,
}

/// The parameters of least error, with their ranges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    pub(super) gain: Option<Estimate>,
    pub(super) delay_s: Option<Estimate>,
    pub(super) limit: Option<Estimate>,
    /// Root mean square of what these leave unexplained, m/s or rad/s.
    pub(super) rest: f64,
}

/// A command and a response, ready to be explained.
struct Axis<'a> {
    command: &'a Course,
    response: &'a Course,
    accelerations: bool,
}

impl Fit {
    /// Fits an axis; `None` where there is nothing to fit.
    pub(super) fn of(
        command: &Course,
        response: &Course,
        accelerations: bool,
        independent_s: f64,
    ) -> Option<Fit> {
        let (first_s, last_s) = (response.t_s.first()?, response.t_s.last()?);
        if !says_something(command, response) {
            return None;
        }
        let worth = ((last_s - first_s) / independent_s).min(response.t_s.len() as f64);
        let axis = Axis { command, response, accelerations };
        let best = axis.best();
        let error = axis.error(&best);
        let bound = error
            + CHANCE
                * (error / response.t_s.len() as f64).max(LEAST_VARIANCE)
                * (response.t_s.len() as f64 / worth);
        let within = |parameters: &Parameters| axis.error(parameters) <= bound;
        let range = |value: f64, step: f64, with: &dyn Fn(f64) -> Parameters| {
            let walk = |sign: f64| {
                let mut reached = value;
                for far in 1..=200 {
                    let next = value + sign * step * f64::from(far);
                    if next < 0.0 || !within(&with(next)) {
                        break;
                    }
                    reached = next;
                }
                // Half a step of doubt: the end lies between two of those that were tried.
                reached + sign * 0.5 * step
            };
            Estimate { value, low: walk(-1.0).max(0.0), high: walk(1.0) }
        };
        let gain = range(best.gain, 0.005, &|gain| Parameters { gain, ..best });
        let delay_s = range(best.delay_s, 0.005, &|delay_s| Parameters { delay_s, ..best });
        let limit = if best.limit.is_infinite() {
            let felt = |limit: &f64| within(&Parameters { limit: *limit, ..best });
            let low = LIMITS.into_iter().find(felt).unwrap_or(f64::INFINITY);
            Estimate { value: f64::INFINITY, low, high: f64::INFINITY }
        } else {
            let step = 0.02 * best.limit;
            let mut limit = range(best.limit, step, &|limit| Parameters { limit, ..best });
            if within(&Parameters { limit: f64::INFINITY, ..best }) {
                limit.high = f64::INFINITY;
            }
            limit
        };
        let rest = libm::sqrt(error / response.t_s.len() as f64);
        Some(Fit { gain: Some(gain), delay_s: Some(delay_s), limit: Some(limit), rest })
    }
}

/// Root mean square of what a plant of these parameters leaves unexplained, m/s or rad/s; `None` where the
/// log says nothing of it.
pub(super) fn unexplained(
    command: &Course,
    response: &Course,
    accelerations: bool,
    (gain, delay_s, limit): (f64, f64, f64),
) -> Option<f64> {
    let axis = Axis { command, response, accelerations };
    let error = says_something(command, response)
        .then(|| axis.error(&Parameters { gain, delay_s, limit }))?;
    Some(libm::sqrt(error / response.t_s.len() as f64))
}

/// Whether there is enough of both, and something was asked for.
fn says_something(command: &Course, response: &Course) -> bool {
    !too_short(command, response) && deviation(command) >= LEAST_EXCITED
}

/// Whether there is too little of either to say anything.
pub(super) fn too_short(command: &Course, response: &Course) -> bool {
    command.t_s.len() < 10 || response.t_s.len() < 50
}

impl Axis<'_> {
    /// Least squares: the grid, then ever smaller steps about its best.
    fn best(&self) -> Parameters {
        let mut best = Parameters { gain: 1.0, delay_s: 0.0, limit: f64::INFINITY };
        let mut least = f64::INFINITY;
        // A sharper limit must earn its place: from the absent one down.
        for limit in LIMITS.into_iter().rev() {
            for delay_s in DELAYS_S {
                self.improve(&mut best, &mut least, Parameters { gain: 1.0, delay_s, limit });
            }
        }
        let (mut delay_step_s, mut limit_step, mut gain_step) = (0.02, 1.25, 0.05);
        for _ in 0..7 {
            for _ in 0..2 {
                let at = best;
                for delay_s in [at.delay_s - delay_step_s, at.delay_s + delay_step_s] {
                    let delay_s = delay_s.max(0.0);
                    let tried = Parameters { delay_s, ..best };
                    self.improve(&mut best, &mut least, tried);
                }
                for limit in [at.limit / limit_step, at.limit * limit_step] {
                    let tried = Parameters { limit, ..best };
                    self.improve(&mut best, &mut least, tried);
                }
                for gain in [at.gain - gain_step, at.gain + gain_step] {
                    let tried = Parameters { gain, ..best };
                    self.improve(&mut best, &mut least, tried);
                }
            }
            delay_step_s *= 0.5;
            gain_step *= 0.5;
            limit_step = libm::sqrt(limit_step);
        }
        best
    }

    fn improve(&self, best: &mut Parameters, least: &mut f64, tried: Parameters) {
        let error = self.error(&tried);
        // By more than rounding, so that what makes no difference stays as it was.
        if error < *least * (1.0 - 1e-9) {
            (*best, *least) = (tried, error);
        }
    }

    /// The sum of squares that is left.
    fn error(&self, with: &Parameters) -> f64 {
        let (command, response) = (self.command, self.response);
        let mut speed = response.values[0];
        let mut t_s = response.t_s[0];
        let mut input = 0.0;
        // What was commanded before the first look counts once its delay is over.
        let mut next = 0;
        if !self.accelerations {
            input = speed;
        }
        let mut sum = 0.0;
        for (at_s, measured) in response.t_s.iter().zip(&response.values) {
            while next < command.t_s.len() && command.t_s[next] + with.delay_s < *at_s {
                let from_s = command.t_s[next] + with.delay_s;
                if from_s > t_s {
                    speed = self.follow(speed, input, from_s - t_s, with);
                    t_s = from_s;
                }
                input = with.gain * command.values[next];
                next += 1;
            }
            speed = self.follow(speed, input, at_s - t_s, with);
            t_s = *at_s;
            let off = measured - speed;
            sum += off * off;
        }
        sum
    }

    fn follow(&self, speed: f64, input: f64, span_s: f64, with: &Parameters) -> f64 {
        if self.accelerations {
            return speed + input.clamp(-with.limit, with.limit) * span_s;
        }
        if with.limit.is_infinite() {
            return if span_s > 0.0 { input } else { speed };
        }
        speed + (input - speed).clamp(-with.limit * span_s, with.limit * span_s)
    }
}

fn deviation(course: &Course) -> f64 {
    let n = course.values.len() as f64;
    let mean = course.values.iter().sum::<f64>() / n;
    let squares: f64 = course.values.iter().map(|value| (value - mean) * (value - mean)).sum();
    libm::sqrt(squares / n)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Accelerations of a saw tooth, followed late and within a limit that they exceed: both are
    /// found from the speeds, integrated here in steps of a millisecond.
    #[test]
    fn a_limit_is_felt_under_accelerations() {
        let asked = |step: i32| f64::from(step * 37 % 41 - 20) / 10.0;
        let (mut command, mut response) = (Course::default(), Course::default());
        let mut speed = 0.0;
        for ms in 0..20_000 {
            let t_s = f64::from(ms) / 1000.0;
            if ms % 100 == 0 {
                command.push(t_s, asked(ms / 100));
            }
            if ms % 20 == 0 {
                response.push(t_s, speed);
            }
            if ms >= 60 {
                speed += 0.001 * asked((ms - 60) / 100).clamp(-0.5, 0.5);
            }
        }
        let fit = Fit::of(&command, &response, true, 0.2).expect("enough to fit");
        let near = |estimate: Option<Estimate>, truth: f64| {
            let estimate = estimate.expect("fitted");
            (estimate.value - truth).abs() < 0.05 && estimate.low <= estimate.high
        };
        assert!(near(fit.limit, 0.5) && near(fit.delay_s, 0.06), "{fit:?}");
    }
}
