//! An explanation in sentences.

use compare::report::{number, with_unit};
use schemas::{Field, LawBranch, Reason, Region, Step, Value};

use super::account::{Asked, EchoMet, Explanation, RayTold};

/// A length.
pub fn metres(x_m: f64) -> String {
    with_unit(&number(Some(x_m)), "m")
}

/// A velocity, or any other pair of numbers with their units.
pub fn pair([a, b]: [f64; 2], [unit_a, unit_b]: [&str; 2]) -> String {
    format!("{} {unit_a}, {} {unit_b}", number(Some(a)), number(Some(b)))
}

/// An angle about the heading or the body's forward axis.
pub fn turned(deg: f64) -> String {
    match deg.round() {
        0.0 => "straight ahead".to_owned(),
        180.0 | -180.0 => "straight behind".to_owned(),
        whole if whole > 0.0 => format!("{whole:.0}° left"),
        whole => format!("{:.0}° right", -whole),
    }
}

/// The selected side.
pub fn side(sigma: i32) -> &'static str {
    match sigma {
        0 => "none",
        s if s > 0 => "left",
        _ => "right",
    }
}

/// A field's value, printed; angles in degrees.
pub fn value(name: &str, value: &Value) -> String {
    match value {
        Value::Number(x) if name.ends_with("_rad") => format!("{:.1}", x.to_degrees()),
        Value::Number(x) => number(Some(*x)),
        Value::Pair([a, b]) => format!("({}, {})", number(Some(*a)), number(Some(*b))),
        Value::Pose(pose) => format!("({}, {})", number(Some(pose.x_m)), number(Some(pose.y_m))),
        Value::Integer(sigma) if name == "side" => side(*sigma as i32).to_owned(),
        Value::Integer(n) => n.to_string(),
        Value::Hash(hash) => format!("{hash:016x}"),
        Value::Flag(flag) => if *flag { "yes" } else { "no" }.to_owned(),
        Value::Name(name) => (*name).to_owned(),
        Value::Absent => "-".to_owned(),
    }
}

/// The unit in which [`value`] prints.
pub fn unit_of(field: &Field) -> &'static str {
    match (field.name, field.unit) {
        (name, "rad") if name.ends_with("_rad") => "°",
        // Which of the two units holds depends on the law.
        (_, unit) if unit.contains(" or ") => "",
        (_, unit) => unit,
    }
}

/// What the law's branch means.
pub fn branch(branch: LawBranch, v_rest_mps: Option<f64>) -> String {
    match branch {
        LawBranch::Left => "d2 = d2l, sigma = +1".into(),
        LawBranch::Right => "d2 = d2r, sigma = -1".into(),
        LawBranch::Rest => format!(
            "v* is below v_rest{}: the law comes to rest",
            v_rest_mps.map_or_else(String::new, |v| format!(" = {} m/s", number(Some(v))))
        ),
        LawBranch::None => "no feedback could be formed".into(),
        LawBranch::Unspecified => "not said".into(),
    }
}

/// Where a ray goes and what ends it.
pub fn ray(ray: &RayTold) -> String {
    let end = if let Some(echo) = &ray.echo {
        format!(", to an echo of {}", echo_met(echo))
    } else if let Some(thing) = &ray.thing {
        format!(", to {thing}")
    } else if !ray.known {
        ": unknown, since a sonar that looks there is silent or gave nonsense".to_owned()
    } else if ray.free_m.is_infinite() {
        ": nothing in reach".to_owned()
    } else {
        ": blocked because it is unknown".to_owned()
    };
    let really = match (ray.truth_free_m, &ray.truth_thing) {
        (Some(free_m), Some(thing)) => format!(" (really {} to {thing})", metres(free_m)),
        _ => String::new(),
    };
    format!("{}{end}{really}", turned(ray.off_heading_deg))
}

fn echo_met(echo: &EchoMet) -> String {
    let sonar = match (echo.sonar, echo.bearing_deg) {
        (Some(id), Some(deg)) => format!("sonar {id} ({})", turned(deg)),
        _ => "a sonar whose message is not in the log".to_owned(),
    };
    format!(
        "{sonar}: {} heard {:.2} s before, {}confirmed{}, taken {} nearer for its uncertainty",
        metres(echo.range_m),
        echo.heard_s_before,
        if echo.confirmed { "" } else { "not " },
        if echo.in_gap { ", standing for the blind gap beside its cone" } else { "" },
        metres(echo.nearer_by_m)
    )
}

/// The whole in sentences.
pub fn summary(told: &Explanation, step: &Step) -> Vec<String> {
    let mut lines = vec![format!("{}: {}.", driver(told), why(told, step))];
    let counted = told.sets.asked.iter().find(|asked| asked.counts);
    if let Some(limit) = counted.and_then(|asked| asked.ray.as_ref())
        && told.sets.distance_m.is_finite()
    {
        lines.push(format!("D = {} {}.", metres(told.sets.distance_m), ray(limit)));
    }
    lines.push(given(told));
    lines.extend(told.safety.words.iter().cloned());
    lines
}

fn driver(told: &Explanation) -> String {
    let since = if told.changed.before_change_s.is_some() {
        format!(" since {:.2} s", told.since_s)
    } else {
        " from the start".to_owned()
    };
    match (told.k, told.reason) {
        (1.0, _) => format!("The person drives (k = 1{since})"),
        (
            0.0,
            "joystick_silent" | "starting" | "pose_invalid" | "odometry_stale" | "sensors_dead",
        ) => {
            format!("The person has no control (k = 0{since})")
        }
        (0.0, _) => format!("The feedback law drives (k = 0{since})"),
        (k, _) => format!("k = {}{since}", number(Some(k))),
    }
}

/// What sonars keep from the safety layer.
fn unknown(step: &Step) -> String {
    match step.sonars_unknown {
        None | Some(0) => String::new(),
        Some(1) => "; what one sonar looks at is unknown, and counts as blocked".to_owned(),
        Some(n) => format!("; what {n} sonars look at is unknown, and counts as blocked"),
    }
}

/// Why k is what it is.
fn why(told: &Explanation, step: &Step) -> String {
    let worst = told.sets.asked.iter().find(|asked| asked.counts);
    let at_speed = |asked: Option<&Asked>| {
        asked.map_or_else(String::new, |asked| {
            format!(" at the {} {} m/s", asked.about, number(Some(asked.v_mps)))
        })
    };
    let effective = metres(told.sets.effective_m);
    let of = |critical: fn(&Asked) -> f64| {
        worst.map_or_else(|| "unknown".to_owned(), |asked| metres(critical(asked)))
    };
    let (dc1, dc2) = (of(|asked| asked.critical1_m), of(|asked| asked.critical2_m));
    let speed = at_speed(worst);
    match step.reason {
        Reason::Human if told.law_kind == "human" => {
            "the version `human` applies the person's request whatever the sets and the law say"
                .into()
        }
        Reason::Human => match step.region {
            Region::Safe if step.v_h_mps < 0.0 && told.sets.form == Some("printed") => {
                "the printed sets call every request to drive backwards safe".into()
            }
            Region::Safe => {
                format!("safe set{speed}, D as compared = {effective} is at least Dc(b2) = {dc2}")
            }
            _ => format!(
                "hysteresis set{speed}, D as compared = {effective} is between Dc(b1) = {dc1} and \
                 Dc(b2) = {dc2}, and the person drove before"
            ),
        },
        Reason::Danger => format!(
            "dangerous set{speed}, D as compared = {effective} is not more than Dc(b1) = {dc1}"
        ),
        Reason::Hysteresis => format!(
            "hysteresis set{speed}, D as compared = {effective} is between Dc(b1) = {dc1} and \
             Dc(b2) = {dc2}, and the person did not drive before"
        ),
        Reason::NotYetSafe => format!(
            "hysteresis set{speed}, D as compared = {effective} is below Dc(b2) = {dc2}, and no \
             state has been seen in the safe set yet"
        ),
        Reason::Contact => {
            format!("contact, D = {} is not above 0", metres(told.sets.distance_m))
        }
        Reason::WouldBeProjected => format!(
            "the sets would let the person drive{speed} (D as compared = {effective}, Dc(b1) = \
             {dc1}), but the safety layer would have had to alter what they ask for{}",
            unknown(step)
        ),
        Reason::DistanceUnknown => "a distance that is needed is unknown".into(),
        Reason::JoystickSilent => format!(
            "no usable joystick: its last sample is {} old, or its dead-man button is released",
            with_unit(&number(Some(step.joystick_age_s)), "s")
        ),
        Reason::JoystickInvalid => "what the joystick says is not a number".into(),
        Reason::PoseInvalid => "the pose, or a speed that the law needs, is not a number".into(),
        Reason::OdometryStale => format!(
            "the newest odometry is {} old",
            with_unit(&number(Some(step.odometry_age_s)), "s")
        ),
        Reason::SensorsDead => "no sonar has given a reading that still counts".into(),
        Reason::FeedbackInvalid => "the feedback law's value is not a number".into(),
        Reason::Starting => {
            "a robot with sonars stands still at the start, until all have fired".into()
        }
        Reason::Unspecified => "the step does not say why".into(),
    }
}

/// What was asked for and what was given.
fn given(told: &Explanation) -> String {
    let request = &told.request;
    let units = ["m/s", "rad/s"];
    let asked = pair([request.v_h_mps, request.omega_h_radps], units);
    let Some(given) = request.v_mps.zip(request.omega_radps) else {
        return format!("The person asked for {asked}; the log has no command for this step.");
    };
    let given = [given.0, given.1];
    if given == [request.v_h_mps, request.omega_h_radps] {
        return format!("The person asked for {asked}, and got just that.");
    }
    format!("The person asked for {asked}; commanded was {}.", pair(given, units))
}

/// What S1 and the projection did, in sentences; empty where they did nothing.
pub fn safety(told: &Explanation, step: &Step) -> Vec<String> {
    let (safety, units) = (&told.safety, told.request.units);
    let mut lines = Vec::new();
    if safety.saturated {
        lines.push(format!(
            "S1 brought the feedback from {} down to {}.",
            pair(step.u_f, units),
            pair(safety.before_projection, units)
        ));
    } else if told.k == 0.0 && safety.before_projection != step.u_f {
        lines.push(format!(
            "A stop, {}, takes the place of the feedback.",
            pair(safety.before_projection, units)
        ));
    }
    let along = |lead: &str| {
        safety.ray.as_ref().map_or_else(String::new, |limit| {
            format!("{lead}{} free {}", metres(limit.free_m), ray(limit))
        })
    };
    if safety.projected {
        let who = if safety.layer { "The safety layer" } else { "The rule for contact" };
        lines.push(format!(
            "{who} took away {}: {} became {}{}.",
            pair(safety.taken, units),
            pair(safety.before_projection, units),
            pair(safety.after_projection, units),
            along(", with ")
        ));
    }
    if step.reason == Reason::WouldBeProjected
        && let Some(left) = safety.person_would_get
    {
        lines.push(format!(
            "Of the person's input {} the safety layer would have left {}{}.",
            pair(step.u_h, units),
            pair(left, units),
            if safety.projected { String::new() } else { along(", with ") }
        ));
    }
    lines
}
