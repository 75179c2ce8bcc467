//! Small runs made by hand, for tests.

use schemas::{
    Command, Driver, Event, Footprint, HalfPlane, Header, Obstacle, Pose, Robot, RunInfo,
    SIMULATION_EPOCH, Scenario, SensorSuite, Span, Stamped, Start, Step, Task, Time, Truth, Twist,
    World,
};

use crate::metrics::{Measured, Meter};

/// The control period of every synthetic run, seconds.
pub(crate) const PERIOD_S: f64 = 0.1;

/// A run being written.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) header: Header,
    pub(crate) events: Vec<Stamped<Event>>,
}

/// The instant that many seconds after the start.
pub(crate) fn at(t_s: f64) -> Time {
    SIMULATION_EPOCH + Span::from_seconds(t_s)
}

/// A 4 m × 2 m room with its lower left corner at the origin, a body of 0.5 m × 0.5 m, limits of
/// 0.7 m/s and 2 rad/s, and no task.
pub(crate) fn scenario() -> Scenario {
    let face = |normal, offset_m| HalfPlane { normal, offset_m };
    Scenario {
        name: "synthetic".to_owned(),
        summary: String::new(),
        duration_s: 10.0,
        sensors: SensorSuite::Exact,
        driver: Driver::Joystick,
        start: Start { pose: Pose::default(), v_mps: 0.0, omega_radps: 0.0 },
        task: None,
        robot: Robot { footprint: Footprint { length_m: 0.5, width_m: 0.5 }, ..Robot::default() },
        plant: schemas::Plant::default(),
        noise: schemas::Noise::default(),
        person: schemas::Person::default(),
        controller: schemas::Overrides::default(),
        world: World {
            room: vec![
                face([-1.0, 0.0], 0.0),
                face([0.0, -1.0], 0.0),
                face([1.0, 0.0], 4.0),
                face([0.0, 1.0], 2.0),
            ],
            ..World::default()
        },
        explored: None,
    }
}

/// A square of 0.4 m about a point.
pub(crate) fn block(x_m: f64, y_m: f64) -> Obstacle {
    let corner = |dx, dy| [x_m + dx, y_m + dy];
    Obstacle {
        corners_m: vec![corner(-0.2, -0.2), corner(0.2, -0.2), corner(0.2, 0.2), corner(-0.2, 0.2)],
    }
}

/// A task from (1, 1) to (3, 1) at 0.5 m/s.
pub(crate) fn task() -> Task {
    Task { from_m: [1.0, 1.0], velocity_mps: [0.5, 0.0], until_s: 4.0 }
}

impl Run {
    /// An empty run of [`scenario`].
    pub(crate) fn new() -> Run {
        Run::of(scenario())
    }

    pub(crate) fn of(scenario: Scenario) -> Run {
        let run = RunInfo { start: SIMULATION_EPOCH, ..RunInfo::default() };
        Run { header: Header { run, params_toml: String::new(), scenario }, events: Vec::new() }
    }

    fn push(&mut self, t_s: f64, rank: u64, event: Event) {
        self.events.push(Stamped { at: at(t_s).after_ns(rank), value: event });
    }

    /// Adds a step in the middle of the room with k = 1 and a request of (0.5, 0), after `change`.
    pub(crate) fn step(&mut self, t_s: f64, change: impl FnOnce(&mut Step)) -> &mut Run {
        let index = self.events.iter().filter(|e| matches!(e.value, Event::Step(_))).count();
        let mut step = Step::unknown(at(t_s), index as u64);
        step.control_period_s = PERIOD_S;
        step.pose = Pose { x_m: 2.0, y_m: 1.0, theta_rad: 0.0 };
        step.v_mps = 0.5;
        step.omega_radps = 0.0;
        step.v_h_mps = 0.5;
        step.omega_h_radps = 0.0;
        step.k = 1.0;
        step.reason = schemas::Reason::Human;
        change(&mut step);
        self.push(t_s, 6, Event::Step(Box::new(step)));
        self
    }

    /// Adds a command.
    pub(crate) fn command(&mut self, t_s: f64, v_mps: f64, omega_radps: f64) -> &mut Run {
        let command = Command { stamp: at(t_s), twist: Twist { v_mps, omega_radps }, accel: None };
        self.push(t_s, 7, Event::Command(command));
        self
    }

    /// Adds the truth: in the middle of the room at 0.5 m/s, 1 m clear of everything, after
    /// `change`.
    pub(crate) fn truth(&mut self, t_s: f64, change: impl FnOnce(&mut Truth)) -> &mut Run {
        let mut truth = Truth {
            stamp: at(t_s),
            pose: Pose { x_m: 2.0, y_m: 1.0, theta_rad: 0.0 },
            v_mps: 0.5,
            omega_radps: 0.0,
            clearance_m: 1.0,
            clearance_static_m: 1.0,
            discs: Vec::new(),
        };
        change(&mut truth);
        self.push(t_s, 5, Event::Truth(truth));
        self
    }

    /// Truths every 0.1 s with these clearances from everything, static alike.
    pub(crate) fn clearances(clearances_m: &[f64]) -> Run {
        let mut run = Run::new();
        for (i, clearance_m) in clearances_m.iter().enumerate() {
            run.truth(i as f64 * PERIOD_S, |truth| {
                truth.clearance_m = *clearance_m;
                truth.clearance_static_m = *clearance_m;
            });
        }
        run.step(0.0, |_| {});
        run
    }

    /// A step and its command every 0.1 s: k, and what is commanded for a request of (0.5, 0).
    pub(crate) fn decisions(decisions: &[(f64, [f64; 2])]) -> Run {
        let mut run = Run::new();
        for (i, (k, [v_mps, omega_radps])) in decisions.iter().enumerate() {
            let t_s = i as f64 * PERIOD_S;
            run.step(t_s, |step| step.k = *k).command(t_s, *v_mps, *omega_radps);
        }
        run
    }

    /// What a meter says of it.
    pub(crate) fn measured(&self) -> Measured {
        let mut meter = Meter::new(&self.header);
        self.events.iter().for_each(|event| meter.observe(event));
        meter.finish().expect("the run has a step")
    }

    /// One metric of it.
    pub(crate) fn metric(&self, name: &str) -> Option<f64> {
        self.measured().metrics.get(name)
    }
}

/// Old against new, closed loop.
pub(crate) fn question() -> crate::Question {
    crate::Question {
        a: "old".to_owned(),
        b: "new".to_owned(),
        mode: "closed".to_owned(),
        human: Vec::new(),
        ..crate::Question::default()
    }
}

/// Both arms of a log, measured and compared.
pub(crate) fn pair(log: &str, a: &Run, b: &Run) -> crate::LogPair {
    let (mut next_a, mut next_b) = (a.events.iter().cloned(), b.events.iter().cloned());
    let diff = crate::diff::<crate::CompareError, _>(
        &crate::Tolerances::exact(),
        (a.header.run.start, || Ok(next_a.next())),
        (b.header.run.start, || Ok(next_b.next())),
    );
    crate::LogPair {
        plant_doubt: None,
        plant_untold: None,
        unmet_faults: Vec::new(),
        log: log.to_owned(),
        operator: String::new(),
        hash: String::new(),
        scenario: Some(a.header.scenario.clone()),
        recorded: None,
        levels: vec![crate::LevelPair {
            human: String::new(),
            estimates: true,
            horizon_s: None,
            a: Ok(a.measured()),
            b: Ok(b.measured()),
            diff: Some(diff.map_err(|error| error.to_string())),
        }],
    }
}
