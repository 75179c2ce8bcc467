//! The controller stepped over the log again, up to the step in question, and asked what it saw.

use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use anyhow::{Context as _, Result, bail};
use controller::safety::{Limits, clip};
use controller::sharing::Sets;
use controller::travel::DMode;
use controller::{Law, Look, Ray, Shielded, Spec};
use replay::{Mode, Replay};
use schemas::{Event, Plant, Pose, ReferenceSource, Scenario, Step, Value};

use super::moment::Moment;
use crate::arm::{caught, made};
use crate::{interrupt, logs};

/// What the controller saw.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Where all rays start: the pose at which the command takes effect.
    pub from: Pose,
    /// The rays of the law: along ψ, to its left, to its right.
    pub law: [Ray; 3],
    /// The ray that D comes from, for the requested velocity.
    pub requested: Ray,
    /// The same for the present velocity, where the sets are asked about that too.
    pub present: Option<Ray>,
    /// What the safety layer leaves of the input that (14) chose.
    pub chosen: Option<Shielded>,
    /// What it would leave of the person's input.
    pub human: Option<Shielded>,
}

/// The recorded controller and, where it can be had, what it saw; otherwise why not.
pub struct Traced {
    pub spec: Result<Spec, String>,
    pub trace: Result<Trace, String>,
}

/// Steps the recorded controller over the log.
pub fn trace(log: &Path, moment: &Moment) -> Traced {
    let run = &moment.header.run;
    match Spec::from_recorded(&run.controller, &moment.header.params_toml) {
        Err(error) => {
            let why = anyhow::Error::from(error)
                .context("the recorded controller is not part of this build");
            let why = format!("{why:#}");
            Traced { spec: Err(why.clone()), trace: Err(why) }
        }
        Ok(spec) => {
            let trace = again(log, moment, &spec).map_err(|error| format!("{error:#}"));
            Traced { spec: Ok(spec), trace }
        }
    }
}

fn again(log: &Path, moment: &Moment, spec: &Spec) -> Result<Trace> {
    made(&moment.header, spec)?;
    let mut replay = Replay::new(|| logs::open_raw(log), spec, Mode::Open)?;
    while let Some(event) = caught(|| replay.next_event())? {
        interrupt::check()?;
        let Event::Step(step) = event.value else { continue };
        if step.stamp < moment.step.stamp {
            continue;
        }
        if let Some(field) = first_difference(&step, &moment.step) {
            bail!("this build does not make the recorded step again: `{field}` differs");
        }
        let trace = caught(|| {
            let look = replay.runner().look()?;
            Some(Trace::new(&look, &step, spec, &moment.header.scenario))
        })?;
        return trace.context("the controller has not looked");
    }
    bail!("the replay ends before the step")
}

/// The first field in the order of the data flow that differs; NaN equals NaN, and what the recorded step
/// is too old to have differs in nothing.
fn first_difference(again: &Step, recorded: &Step) -> Option<&'static str> {
    let same = |a: &Value, b: &Value| a == b || format!("{a:?}") == format!("{b:?}");
    let mut again = again.clone();
    again.leave_out_as(recorded);
    let (a, b) = (again.values(), recorded.values());
    let differs = Step::FIELDS.iter().zip(a.iter().zip(&b)).find(|(_, (a, b))| !same(a, b));
    differs.map(|(field, _)| field.name)
}

impl Trace {
    /// What is seen from `look` in the step that was just made.
    pub fn new(look: &Look<'_>, step: &Step, spec: &Spec, scenario: &Scenario) -> Trace {
        let (requested, present) = travel_rays(look, step, spec, scenario);
        Trace {
            from: *look.from(),
            law: [0.0, FRAC_PI_2, -FRAC_PI_2].map(|turn| look.law_ray(step.psi_rad + turn)),
            requested,
            present,
            chosen: look.shielded(step.u_s_before_projection, step.k != 1.0),
            human: look.shielded(step.u_h, false),
        }
    }
}

/// The rays that D may come from: that for the requested velocity, and, where the sets are asked about
/// that too, the one for the present velocity.
pub fn travel_rays(
    look: &Look<'_>,
    step: &Step,
    spec: &Spec,
    scenario: &Scenario,
) -> (Ray, Option<Ray>) {
    let params = &spec.params;
    let mode = mode(spec, scenario);
    let ray = |[v_mps, omega_radps]: [f64; 2]| {
        // The printed sets do not look behind.
        let v_mps = if params.sets == Sets::Printed { 0.0 } else { v_mps };
        look.travel_ray(step, mode, [v_mps, omega_radps])
    };
    let both = spec.law == Law::Dynamic && params.sets == Sets::Total;
    let present = both.then(|| ray([step.v_mps, step.omega_radps]));
    (ray(requested(step, &scenario.plant)), present)
}

/// Along which directions D is measured.
pub fn mode(spec: &Spec, scenario: &Scenario) -> DMode {
    let params = &spec.params;
    if scenario.task.is_some() { params.d_mode_task } else { params.d_mode_free }
}

/// The velocities that the sets are asked about: those requested, within the limits; zero where
/// nothing usable is requested.
pub fn requested(step: &Step, plant: &Plant) -> [f64; 2] {
    if step.reference_source == ReferenceSource::Hold {
        [0.0; 2]
    } else {
        clip([step.v_h_mps, step.omega_h_radps], &Limits::of_velocity(plant))
    }
}
