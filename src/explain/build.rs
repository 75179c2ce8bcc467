//! From a moment and its trace to an explanation.

use std::path::Path;

use controller::safety::Projection;
use controller::sharing::{classify_printed, classify_total, critical_distance_m};
use controller::{Law, Ray, Spec};
use schemas::{Region, SensorSuite, Step, Value};

use super::account::{
    Asked, Changed, ChangedRow, Distances, Echo, Explanation, LawTold, Request, Safety, Sets, Side,
    TruthTold,
};
use super::instant::{Instant, iso};
use super::moment::Moment;
use super::trace::{Traced, mode, requested};
use super::{ray, thing, words};

/// Quantities of a step that are told when they changed.
const TOLD: &[&str] = &[
    "v_h_mps",
    "omega_h_radps",
    "v_mps",
    "omega_radps",
    "frame_source",
    "psi_rad",
    "d1_m",
    "d2l_m",
    "d2r_m",
    "distance_human_m",
    "distance_effective_m",
    "sonars_unknown",
    "reference_source",
    "side",
    "law_branch",
    "v_star_mps",
    "theta_star_rad",
    "lyapunov",
    "u_f",
    "region",
    "k",
    "danger",
    "reason",
    "u_s",
    "saturated",
    "projected",
];

/// The explanation of the step of `moment`.
pub fn explanation(log: &Path, at: Instant, moment: &Moment, traced: &Traced) -> Explanation {
    let (run, step) = (&moment.header.run, &*moment.step);
    let spec = traced.spec.as_ref().ok();
    let trace = traced.trace.as_ref().ok();
    let from = trace.map_or(step.pose, |trace| trace.from);
    let teller = ray::Teller { moment, from };
    let told = |ray: Option<&Ray>| ray.map(|ray| teller.tell(ray));
    let distances = distances(spec, step, |i| told(trace.map(|trace| &trace.law[i])));
    let sets = sets(spec, moment, |about| {
        let trace = trace?;
        let ray = if about == "present" { trace.present.as_ref() } else { Some(&trace.requested) };
        Some((ray?.free_m, teller.tell(ray?)))
    });
    let law = law(spec, step);
    let request = request(spec, moment);
    let mut safety = safety(spec, step);
    if let Some(trace) = trace {
        // While the law drives, what matters is what was taken from it; where the person was kept
        // from driving by the layer itself, what it would have taken from them.
        let kept_back = step.reason == schemas::Reason::WouldBeProjected;
        let shown = if kept_back { &trace.human } else { &trace.chosen };
        safety.ray = told(shown.as_ref().and_then(|shown| shown.ray.as_ref()));
        safety.person_would_get =
            trace.human.as_ref().map(|human| human.u).filter(|left| *left != step.u_h);
    }
    let mut explanation = Explanation {
        log: log.display().to_string(),
        asked_s: at.seconds(run.start),
        t_s: step.stamp.seconds_since(run.start),
        at: iso(step.stamp),
        step_index: step.step_index,
        controller: run.controller.clone(),
        law_kind: spec.map_or("unknown", |spec| spec.law.name()),
        scenario: run.scenario.clone(),
        sensors: run.sensors.clone(),
        control_period_s: step.control_period_s,
        k: step.k,
        since_s: moment.since.seconds_since(run.start),
        reason: step.reason.name(),
        summary: Vec::new(),
        request,
        sets,
        distances,
        law,
        safety,
        changed: changed(moment),
        echoes: echoes(moment),
        truth: truth(moment),
        untraced: traced.trace.as_ref().err().cloned(),
    };
    explanation.safety.words = words::safety(&explanation, step);
    explanation.summary = words::summary(&explanation, step);
    explanation
}

fn request(spec: Option<&Spec>, moment: &Moment) -> Request {
    let step = &*moment.step;
    let dynamic = spec.is_some_and(|spec| spec.law == Law::Dynamic);
    let twist = moment.command.map(|command| command.twist);
    Request {
        joystick_age_s: step.joystick_age_s,
        v_h_mps: step.v_h_mps,
        omega_h_radps: step.omega_h_radps,
        u_h: step.u_h,
        u_s: step.u_s,
        units: if dynamic { ["m/s²", "rad/s²"] } else { ["m/s", "rad/s"] },
        v_mps: twist.map(|twist| twist.v_mps),
        omega_radps: twist.map(|twist| twist.omega_radps),
        withheld_v_mps: twist.map(|twist| step.v_h_mps - twist.v_mps),
        withheld_omega_radps: twist.map(|twist| step.omega_h_radps - twist.omega_radps),
    }
}

fn sets(
    spec: Option<&Spec>,
    moment: &Moment,
    ray_about: impl Fn(&'static str) -> Option<(f64, super::account::RayTold)>,
) -> Sets {
    let step = &*moment.step;
    let mut sets = Sets {
        region: step.region.name(),
        danger: step.danger,
        distance_m: step.distance_human_m,
        effective_m: step.distance_effective_m,
        form: None,
        d_mode: None,
        b1_m: None,
        b2_m: None,
        asked: Vec::new(),
    };
    let Some(spec) = spec else { return sets };
    let (params, scenario) = (&spec.params, &moment.header.scenario);
    let (b1_m, b2_m) = if scenario.task.is_some() {
        (params.b1_task_m, params.b2_task_m)
    } else {
        (params.b1_free_m, params.b2_free_m)
    };
    (sets.form, sets.d_mode) = (Some(params.sets.name()), Some(mode(spec, scenario).name()));
    (sets.b1_m, sets.b2_m) = (Some(b1_m), Some(b2_m));
    let printed = params.sets == controller::sharing::Sets::Printed;
    let by_sonar = moment.header.run.sensors == SensorSuite::Sonar.name();
    let sensors = if by_sonar { SensorSuite::Sonar } else { SensorSuite::Exact };
    let ask = |about: &'static str, [v_mps, omega_radps]: [f64; 2], alone: bool| {
        let (distance_m, ray) = match ray_about(about) {
            Some((free_m, told)) => (Some(free_m), Some(told)),
            None => (alone.then_some(step.distance_human_m), None),
        };
        let effective_m = distance_m.map(|d_m| params.effective_m(d_m, v_mps, sensors));
        let region = distance_m.zip(effective_m).map(|(d_m, effective_m)| {
            if printed {
                classify_printed(effective_m, v_mps, b1_m, b2_m)
            } else {
                classify_total(d_m, effective_m, v_mps, b1_m, b2_m)
            }
        });
        let counts = distance_m.is_some_and(|d_m| same(d_m, step.distance_human_m));
        Asked {
            about,
            counts,
            v_mps,
            omega_radps,
            distance_m,
            effective_m,
            critical1_m: critical_distance_m(v_mps, b1_m),
            critical2_m: critical_distance_m(v_mps, b2_m),
            region: region.map(Region::name),
            ray,
        }
    };
    let both = spec.law == Law::Dynamic && !printed;
    sets.asked.push(ask("requested", requested(step, &scenario.plant), !both));
    if both {
        sets.asked.push(ask("present", [step.v_mps, step.omega_radps], false));
    }
    sets
}

/// Equal, or both unknown.
fn same(a: f64, b: f64) -> bool {
    a == b || (a.is_nan() && b.is_nan())
}

fn distances(
    spec: Option<&Spec>,
    step: &Step,
    ray: impl Fn(usize) -> Option<super::account::RayTold>,
) -> Distances {
    let aside = |d_m: f64, selected: bool, i: usize| Side {
        d_m,
        selected,
        wanted_m: selected.then_some(step.d_d2_m),
        admissible_m: selected.then_some(step.d_r2_m),
        z: selected.then_some(step.z2),
        ray: ray(i),
    };
    Distances {
        frame: step.frame_source.name(),
        psi_deg: step.psi_rad.to_degrees(),
        omega_r_radps: step.omega_r_radps,
        side: words::side(step.side),
        cap_m: spec.map(|spec| spec.params.cap_m),
        ahead: Side {
            d_m: step.d1_m,
            selected: true,
            wanted_m: Some(step.d_d1_m),
            admissible_m: Some(step.d_r1_m),
            z: Some(step.z1),
            ray: ray(0),
        },
        left: aside(step.d2l_m, step.side > 0, 1),
        right: aside(step.d2r_m, step.side < 0, 2),
    }
}

fn law(spec: Option<&Spec>, step: &Step) -> LawTold {
    LawTold {
        branch: step.law_branch.name(),
        reference: step.reference_source.name(),
        target_m: [step.target_x_m, step.target_y_m],
        target_mps: [step.target_vx_mps, step.target_vy_mps],
        v_star_mps: step.v_star_mps,
        theta_e_deg: step.theta_e_rad.to_degrees(),
        theta_star_deg: step.theta_star_rad.to_degrees(),
        error_deg: (step.theta_e_rad - step.theta_star_rad).to_degrees(),
        omega_star_radps: step.omega_star_radps,
        lyapunov: step.lyapunov,
        u_f: step.u_f,
        words: words::branch(step.law_branch, spec.map(|spec| spec.params.v_rest_mps)),
    }
}

fn safety(spec: Option<&Spec>, step: &Step) -> Safety {
    let (before, after) = (step.u_s_before_projection, step.u_s);
    let layer = spec.is_none_or(|spec| spec.params.projection != Projection::None);
    Safety {
        saturated: step.saturated,
        before_projection: before,
        projected: step.projected,
        after_projection: after,
        taken: [before[0] - after[0], before[1] - after[1]],
        layer,
        person_would_get: None,
        ray: None,
        words: Vec::new(),
    }
}

fn changed(moment: &Moment) -> Changed {
    let start = moment.header.run.start;
    let (before, other) = (moment.before.as_deref(), moment.before_change.as_deref());
    let now = moment.step.values();
    let (before_values, other_values) = (before.map(Step::values), other.map(Step::values));
    let rows = Step::FIELDS
        .iter()
        .enumerate()
        .filter(|(_, field)| TOLD.contains(&field.name))
        .filter_map(|(i, field)| {
            let print = |value: &Value| words::value(field.name, value);
            let now = print(&now[i]);
            let before = before_values.as_ref().map(|values| print(&values[i]));
            let before_change = other_values.as_ref().map(|values| print(&values[i]));
            let differs = |then: &Option<String>| then.as_ref().is_some_and(|then| *then != now);
            (differs(&before) || differs(&before_change)).then_some(ChangedRow {
                field: field.name,
                unit: words::unit_of(field),
                before_change,
                before,
                now,
            })
        })
        .collect();
    Changed {
        before_s: before.map(|step| step.stamp.seconds_since(start)),
        before_change_s: other.map(|step| step.stamp.seconds_since(start)),
        rows,
    }
}

fn echoes(moment: &Moment) -> Vec<Echo> {
    let mut newest: Vec<Echo> = Vec::new();
    for echo in moment.echoes.iter().rev() {
        let Some(mount) = schemas::SONARS.get(usize::from(echo.id)) else { continue };
        if newest.iter().all(|known| known.sonar != echo.id) {
            newest.push(Echo {
                sonar: echo.id,
                bearing_deg: mount.bearing_deg,
                range_m: echo.echo.then_some(echo.range_m),
                heard_s_before: moment.step.stamp.seconds_since(echo.fired),
            });
        }
    }
    let range_m = |echo: &Echo| echo.range_m.unwrap_or(f64::INFINITY);
    newest.sort_by(|a, b| range_m(a).total_cmp(&range_m(b)).then(a.sonar.cmp(&b.sonar)));
    newest
}

fn truth(moment: &Moment) -> Option<TruthTold> {
    let truth = moment.truth.as_ref()?;
    let (scenario, step) = (&moment.header.scenario, &moment.step);
    let t_s = truth.stamp.seconds_since(moment.header.run.start);
    let body = scenario.robot.footprint;
    let nearest =
        thing::nearest(&scenario.world, t_s, |alone| alone.clearance_m(&body, &truth.pose, t_s));
    let off_rad = (step.pose.theta_rad - truth.pose.theta_rad).rem_euclid(std::f64::consts::TAU);
    let off_deg = off_rad.to_degrees();
    Some(TruthTold {
        clearance_m: truth.clearance_m,
        nearest: nearest.map(|(name, _)| name),
        x_m: truth.pose.x_m,
        y_m: truth.pose.y_m,
        theta_deg: truth.pose.theta_rad.to_degrees(),
        v_mps: truth.v_mps,
        omega_radps: truth.omega_radps,
        estimate_off_m: (step.pose.x_m - truth.pose.x_m).hypot(step.pose.y_m - truth.pose.y_m),
        estimate_off_deg: if off_deg > 180.0 { off_deg - 360.0 } else { off_deg },
    })
}
