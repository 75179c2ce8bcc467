//! An explanation as data. Numbers are in the units of their names; `null` where not known, where
//! nothing is met, or where the controller has no such part.

use serde::Serialize;

/// Why the controller did what it did.
#[derive(Clone, Debug, Serialize)]
pub struct Explanation {
    pub log: String,
    /// What was asked for, seconds from the start of the log.
    pub asked_s: f64,
    /// The step in force then.
    pub t_s: f64,
    pub at: String,
    pub step_index: u64,
    pub controller: String,
    pub law_kind: &'static str,
    pub scenario: String,
    pub sensors: String,
    pub control_period_s: f64,
    pub k: f64,
    /// Since when k has had this value.
    pub since_s: f64,
    pub reason: &'static str,
    /// The whole in sentences: who drives and why; what was asked for and given.
    pub summary: Vec<String>,
    pub request: Request,
    pub sets: Sets,
    pub distances: Distances,
    pub law: LawTold,
    pub safety: Safety,
    pub changed: Changed,
    /// The newest reading of each sonar, nearest first; empty without sonars.
    pub echoes: Vec<Echo>,
    pub truth: Option<TruthTold>,
    /// Why rays and echoes are not named, where they are not.
    pub untraced: Option<String>,
}

/// What the person asked for, and what became of it.
#[derive(Clone, Debug, Serialize)]
pub struct Request {
    pub joystick_age_s: f64,
    pub v_h_mps: f64,
    pub omega_h_radps: f64,
    /// The person's input: those, or the accelerations that they become.
    pub u_h: [f64; 2],
    /// The input applied.
    pub u_s: [f64; 2],
    /// Units of inputs.
    pub units: [&'static str; 2],
    /// What went to the actuators.
    pub v_mps: Option<f64>,
    pub omega_radps: Option<f64>,
    /// What was withheld of the request.
    pub withheld_v_mps: Option<f64>,
    pub withheld_omega_radps: Option<f64>,
}

/// D and the sets (12).
#[derive(Clone, Debug, Serialize)]
pub struct Sets {
    /// As the step says; `danger` too where the safety layer would have altered the request.
    pub region: &'static str,
    pub danger: f64,
    pub distance_m: f64,
    pub effective_m: f64,
    pub form: Option<&'static str>,
    pub d_mode: Option<&'static str>,
    pub b1_m: Option<f64>,
    pub b2_m: Option<f64>,
    /// What the sets were asked about: the requested velocity, in the dynamic law the present one
    /// too.
    pub asked: Vec<Asked>,
}

/// One velocity that the sets were asked about.
#[derive(Clone, Debug, Serialize)]
pub struct Asked {
    /// `requested` or `present`.
    pub about: &'static str,
    /// Whether the step's D is this one.
    pub counts: bool,
    pub v_mps: f64,
    pub omega_radps: f64,
    pub distance_m: Option<f64>,
    pub effective_m: Option<f64>,
    /// Dc(b1) at that speed.
    pub critical1_m: f64,
    /// Dc(b2) at that speed.
    pub critical2_m: f64,
    pub region: Option<&'static str>,
    pub ray: Option<RayTold>,
}

/// A ray and what ends it.
#[derive(Clone, Debug, Serialize)]
pub struct RayTold {
    /// From the heading, counter-clockwise.
    pub off_heading_deg: f64,
    /// Free travel of the body's circle; `null` where nothing is met or known.
    pub free_m: f64,
    pub known: bool,
    pub echo: Option<EchoMet>,
    /// What the exact ray meets.
    pub thing: Option<String>,
    /// With sonars and a recorded truth: free travel that way, really, and up to what.
    pub truth_free_m: Option<f64>,
    pub truth_thing: Option<String>,
}

/// The echo that ends a ray.
#[derive(Clone, Debug, Serialize)]
pub struct EchoMet {
    /// `null` where the log does not hold it any more.
    pub sonar: Option<u8>,
    pub bearing_deg: Option<f64>,
    pub range_m: f64,
    /// How long before the step it was heard.
    pub heard_s_before: f64,
    pub at_m: [f64; 2],
    pub nearer_by_m: f64,
    pub confirmed: bool,
    pub in_gap: bool,
}

/// The frame and the law's distances.
#[derive(Clone, Debug, Serialize)]
pub struct Distances {
    pub frame: &'static str,
    pub psi_deg: f64,
    pub omega_r_radps: f64,
    pub side: &'static str,
    /// Cap B.
    pub cap_m: Option<f64>,
    pub ahead: Side,
    pub left: Side,
    pub right: Side,
}

/// One of d1, d2l, d2r.
#[derive(Clone, Debug, Serialize)]
pub struct Side {
    pub d_m: f64,
    /// Whether the law looks at it.
    pub selected: bool,
    /// `d_d`, where the law looks at it.
    pub wanted_m: Option<f64>,
    /// `d_r`, likewise.
    pub admissible_m: Option<f64>,
    /// z, likewise.
    pub z: Option<f64>,
    pub ray: Option<RayTold>,
}

/// The feedback law.
#[derive(Clone, Debug, Serialize)]
pub struct LawTold {
    pub branch: &'static str,
    pub reference: &'static str,
    pub target_m: [f64; 2],
    pub target_mps: [f64; 2],
    pub v_star_mps: f64,
    pub theta_e_deg: f64,
    pub theta_star_deg: f64,
    pub error_deg: f64,
    pub omega_star_radps: f64,
    pub lyapunov: f64,
    pub u_f: [f64; 2],
    pub words: String,
}

/// What the safety layer did.
#[derive(Clone, Debug, Serialize)]
pub struct Safety {
    /// Whether the version has a projection at all.
    pub layer: bool,
    /// Whether S1 brought the feedback within the limits, from `u_f` to `before_projection`.
    pub saturated: bool,
    pub before_projection: [f64; 2],
    pub projected: bool,
    pub after_projection: [f64; 2],
    /// What the projection took away.
    pub taken: [f64; 2],
    /// What it would leave of the person's input, where that is not all.
    pub person_would_get: Option<[f64; 2]>,
    /// The shortest ray that it looked along.
    pub ray: Option<RayTold>,
    pub words: Vec<String>,
}

/// What is different from before.
#[derive(Clone, Debug, Serialize)]
pub struct Changed {
    /// When the step before was.
    pub before_s: Option<f64>,
    /// When the last step was that had another k.
    pub before_change_s: Option<f64>,
    pub rows: Vec<ChangedRow>,
}

/// One quantity that is different.
#[derive(Clone, Debug, Serialize)]
pub struct ChangedRow {
    pub field: &'static str,
    pub unit: &'static str,
    /// Before k changed.
    pub before_change: Option<String>,
    /// In the step before.
    pub before: Option<String>,
    pub now: String,
}

/// The newest reading of one sonar.
#[derive(Clone, Debug, Serialize)]
pub struct Echo {
    pub sonar: u8,
    pub bearing_deg: f64,
    /// `null`: nothing came back.
    pub range_m: Option<f64>,
    pub heard_s_before: f64,
}

/// What really was.
#[derive(Clone, Debug, Serialize)]
pub struct TruthTold {
    pub clearance_m: f64,
    pub nearest: Option<String>,
    pub x_m: f64,
    pub y_m: f64,
    pub theta_deg: f64,
    pub v_mps: f64,
    pub omega_radps: f64,
    /// How far the estimated position is off.
    pub estimate_off_m: f64,
    pub estimate_off_deg: f64,
}
