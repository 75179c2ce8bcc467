//! What a figure is drawn from: one run, thinned to a bounded number of points.

use schemas::{Event, Header, Pose, Stamped, Step, Time};

use crate::thinning::Thinning;

/// Most points that are kept. When a run outgrows them, every second one goes.
const MOST_POINTS: usize = 8192;

/// Most changes of k that are kept; a run that chatters more than that shows its first ones.
const MOST_SWITCHES: usize = 4096;

/// One step of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// Seconds from the start of the run.
    pub(super) t_s: f64,
    /// Where the robot really was, where that is known; else where it believed to be.
    pub(super) pose: Pose,
    /// Clearance of the footprint, metres; NaN where it is not known.
    pub(super) clearance_m: f64,
    pub(super) danger: f64,
    /// Requested velocities, as the joystick gave them.
    pub(super) v_h_mps: f64,
    pub(super) omega_h_radps: f64,
    /// Commanded ones.
    pub(super) v_s_mps: f64,
    pub(super) omega_s_radps: f64,
    pub(super) distance_m: f64,
    pub(super) effective_m: f64,
    /// Dc(b1) and Dc(b2) at the speed that the sets are asked about.
    pub(super) critical1_m: f64,
    pub(super) critical2_m: f64,
    pub(super) d1_m: f64,
    pub(super) d2l_m: f64,
    pub(super) d2r_m: f64,
    pub(super) d_r1_m: f64,
    /// Of the selected side.
    pub(super) d_r2_m: f64,
    pub(super) lyapunov: f64,
}

/// One run, to be drawn.
#[derive(Clone, Debug)]
pub struct Recording {
    pub(super) header: Header,
    pub(super) points: Vec<Point>,
    /// (time, k) of the first step and of each with another k than the one before.
    pub(super) switches: Vec<(f64, f64)>,
    pub(super) end_s: f64,
    /// Whether it ends before its run did.
    pub(super) cut_short: bool,
    b1_m: f64,
    b2_m: f64,
    truth: Option<(Pose, f64)>,
    /// The last step, until its command is known, and its stamp.
    pending: Option<(Time, Point)>,
    thinning: Thinning,
}

impl Recording {
    /// A recording of a run that says this about itself.
    pub fn new(header: &Header) -> Recording {
        // Parameters that cannot be read make thresholds that are not drawn.
        let params: toml::Table = header.params_toml.parse().unwrap_or_default();
        let of = |key: &str| params.get(key).and_then(toml::Value::as_float).unwrap_or(f64::NAN);
        let (b1, b2) = if header.scenario.task.is_some() {
            ("b1_task_m", "b2_task_m")
        } else {
            ("b1_free_m", "b2_free_m")
        };
        Recording {
            header: header.clone(),
            points: Vec::new(),
            switches: Vec::new(),
            end_s: 0.0,
            cut_short: false,
            b1_m: of(b1),
            b2_m: of(b2),
            truth: None,
            pending: None,
            thinning: Thinning::to(MOST_POINTS),
        }
    }

    /// Notes that the run went on where the events end, which the figure is to say.
    pub fn cut_short(&mut self) {
        self.cut_short = true;
    }

    /// Takes the next event of the run.
    pub fn observe(&mut self, event: &Stamped<Event>) {
        match &event.value {
            Event::Truth(truth) => self.truth = Some((truth.pose, truth.clearance_m)),
            Event::Step(step) => self.step(step),
            Event::Command(command) => {
                if let Some((stamp, point)) = &mut self.pending
                    && *stamp == command.stamp
                {
                    point.v_s_mps = command.twist.v_mps;
                    point.omega_s_radps = command.twist.omega_radps;
                    if command.accel.is_some() {
                        // A law of accelerations is asked about the present speed as well; the
                        // greater one has the greater critical distances.
                        let speed = libm::fabs(point.v_h_mps).max(libm::fabs(command.twist.v_mps));
                        point.critical1_m = critical_distance_m(speed, self.b1_m);
                        point.critical2_m = critical_distance_m(speed, self.b2_m);
                    }
                }
            }
            Event::Sample(_) | Event::Gap(_) | Event::Timing(_) => {}
        }
    }

    /// Ends the recording; `None` when it held no step.
    pub(super) fn finished(mut self) -> Option<Recording> {
        self.keep_pending(true);
        (!self.points.is_empty()).then_some(self)
    }

    fn step(&mut self, step: &Step) {
        self.keep_pending(false);
        let t_s = step.stamp.seconds_since(self.header.run.start);
        self.end_s = self.end_s.max(t_s + step.control_period_s.max(0.0));
        if self.switches.last().is_none_or(|(_, k)| *k != step.k)
            && self.switches.len() < MOST_SWITCHES
        {
            self.switches.push((t_s, step.k));
        }
        let (pose, clearance_m) = self.truth.unwrap_or((step.pose, f64::NAN));
        let v_max_mps = self.header.scenario.plant.v_max_mps;
        let speed = libm::fabs(step.v_h_mps).min(v_max_mps);
        let point = Point {
            t_s,
            pose,
            clearance_m,
            danger: step.danger,
            v_h_mps: step.v_h_mps,
            omega_h_radps: step.omega_h_radps,
            v_s_mps: f64::NAN,
            omega_s_radps: f64::NAN,
            distance_m: step.distance_human_m,
            effective_m: step.distance_effective_m,
            critical1_m: critical_distance_m(speed, self.b1_m),
            critical2_m: critical_distance_m(speed, self.b2_m),
            d1_m: step.d1_m,
            d2l_m: step.d2l_m,
            d2r_m: step.d2r_m,
            d_r1_m: step.d_r1_m,
            d_r2_m: step.d_r2_m,
            lyapunov: step.lyapunov,
        };
        self.pending = Some((step.stamp, point));
    }

    fn keep_pending(&mut self, last: bool) {
        let Some((_, point)) = self.pending.take() else { return };
        self.thinning.push(&mut self.points, point, last);
    }

    /// Stretches in which the feedback law drives: from, until, seconds.
    pub(super) fn feedback_s(&self) -> Vec<[f64; 2]> {
        let ends = self.switches.iter().skip(1).map(|(t_s, _)| *t_s).chain([self.end_s]);
        self.switches
            .iter()
            .zip(ends)
            .filter(|((_, k), _)| *k == 0.0)
            .map(|((from_s, _), until_s)| [*from_s, until_s])
            .collect()
    }
}

/// Dc(v, b), metres (specification §5): at most this far from the edge, a state is dangerous for b1,
/// not yet safe for b2.
fn critical_distance_m(speed_mps: f64, b_m: f64) -> f64 {
    b_m * b_m * speed_mps / (1.0 + b_m * speed_mps)
}
