//! The feedback step, whole: from distances and the displacement to the target to the input (11) or
//! (17), with every quantity on the way.
//!
//! In: [`Scene`], the rays and the target in the distance frame, and [`Past`], what the previous
//! step chose. Out: [`Plan`].

use schemas::{LawBranch, Reason};

use crate::law::arctangent::nearest_branch;
use crate::law::dynamic::{self, Speeds};
use crate::law::star::{Star, StarRates, star, star_rates};
use crate::law::{Gains, Side, Situation, kinematic};
use crate::params::Params;
use crate::side::{SideDistance, choose};
use crate::spec::Law;
use crate::wanted::{Wanted, capped_m};

/// What is around the robot, in the distance frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    /// Distance to the edge of the admissible set along e1, metres; NaN if unknown.
    pub d1_m: f64,
    /// The same along +e2.
    pub d2l_m: f64,
    /// The same along −e2.
    pub d2r_m: f64,
    /// (Δ1, Δ2): displacement to the target, metres.
    pub delta_m: [f64; 2],
    /// (q1, q2): velocity of the target, m/s.
    pub q_mps: [f64; 2],
    /// θe: heading relative to e1, radians.
    pub theta_e_rad: f64,
    /// `ω_r`, rad/s.
    pub omega_r_radps: f64,
    /// Whether the frame jumped since the previous step.
    pub jumped: bool,
    /// Present forward speed, m/s (dynamic law).
    pub v_mps: f64,
    /// Present turn rate, rad/s (dynamic law).
    pub omega_radps: f64,
}

/// What the previous step chose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Past {
    /// The selected side.
    pub side: Option<Side>,
    /// θ*, radians; `None` where it is to start afresh.
    pub theta_star_rad: Option<f64>,
}

/// The feedback input and all that led to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// d1, d2l, d2r as the law sees them: capped, metres.
    pub capped_m: [f64; 3],
    /// Wanted distances ahead and on the selected side.
    pub wanted: [Wanted; 2],
    /// What the law saw; its distances are NaN where unknown.
    pub situation: Situation,
    /// What the law made of it, where the distances are known.
    pub outcome: Option<LawOutcome>,
    /// The feedback input: [m/s, rad/s] (11), or [m/s², rad/s²] (17). What comes to rest where the
    /// law rests; zero where none could be formed.
    pub u: [f64; 2],
    /// Which part of the law spoke.
    pub branch: LawBranch,
    /// Why none could be formed.
    pub trouble: Option<Reason>,
}

/// The quantities of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawOutcome {
    /// θ* and v*.
    pub star: Star,
    /// Their rates: at v* in the kinematic law, at the present speed in the dynamic one.
    pub rates: StarRates,
    /// Wanted turn rate relative to the frame, rad/s: ωe*; in the kinematic law `ω_f` − `ω_r`.
    pub omega_star_radps: f64,
    /// Lyapunov function (10) or (16).
    pub lyapunov: f64,
    /// The input, whether or not the law rests.
    pub u: [f64; 2],
}

impl Plan {
    /// What the next step is to know.
    pub fn past(&self) -> Past {
        let known = self.outcome.filter(|_| self.trouble.is_none());
        Past {
            side: Some(self.situation.side),
            theta_star_rad: known.map(|outcome| outcome.star.theta_rad),
        }
    }
}

/// The feedback step. Where the person drives alone it is that of the kinematic law.
pub fn plan(law: Law, params: &Params, scene: &Scene, past: &Past) -> Plan {
    let capped = [scene.d1_m, scene.d2l_m, scene.d2r_m].map(|d_m| capped_m(d_m, params.cap_m));
    let [d1_m, d2l_m, d2r_m] = capped;
    let ([delta1_m, delta2_m], [q1_mps, q2_mps]) = (scene.delta_m, scene.q_mps);
    let wanted = |d_m: f64, delta_m: f64, q_mps: f64| {
        Wanted::new(d_m, delta_m, q_mps, params.r_m, params.epsilon_m)
    };
    let ahead = wanted(d1_m, delta1_m, q1_mps);
    let left = wanted(d2l_m, delta2_m, q2_mps);
    let right = wanted(d2r_m, -delta2_m, -q2_mps);
    let side = choose(
        params.side_rule,
        &SideDistance { d_m: d2l_m, d_r_m: left.admissible.d_r_m },
        &SideDistance { d_m: d2r_m, d_r_m: right.admissible.d_r_m },
        past.side,
        params.side_favour,
    );
    let (d2_m, aside) = match side {
        Side::Left => (d2l_m, left),
        Side::Right => (d2r_m, right),
    };
    let situation = Situation {
        ahead: ahead.axis(d1_m),
        aside: aside.axis(d2_m),
        side,
        signs: params.branch_signs,
        theta_e_rad: scene.theta_e_rad,
    };
    let mut plan = Plan {
        capped_m: capped,
        wanted: [ahead, aside],
        situation,
        outcome: None,
        u: [0.0; 2],
        branch: LawBranch::None,
        trouble: None,
    };
    if d1_m.is_nan() || d2_m.is_nan() {
        plan.trouble = Some(Reason::DistanceUnknown);
        return plan;
    }

    let gains = Gains::from(params);
    let fresh = scene.jumped || past.side != Some(side);
    let previous_rad = if fresh { None } else { past.theta_star_rad };
    let mut star = star(&situation, &gains, previous_rad.unwrap_or(scene.theta_e_rad));
    star.theta_rad = nearest_branch(star.theta_rad, scene.theta_e_rad);
    let outcome = match law {
        Law::Kinematic | Law::Human => kinematic_outcome(&situation, &gains, star, scene),
        Law::Dynamic => dynamic_outcome(&situation, &gains, star, scene),
    };
    plan.outcome = Some(outcome);
    if !outcome.u.iter().all(|x| x.is_finite()) {
        plan.trouble = Some(Reason::FeedbackInvalid);
    } else if star.v_mps < params.v_rest_mps {
        plan.branch = LawBranch::Rest;
        if law == Law::Dynamic {
            plan.u = [-params.gamma3 * scene.v_mps, -params.gamma4 * scene.omega_radps];
        }
    } else {
        plan.u = outcome.u;
        plan.branch = match side {
            Side::Left => LawBranch::Left,
            Side::Right => LawBranch::Right,
        };
    }
    plan
}

fn kinematic_outcome(
    situation: &Situation,
    gains: &Gains,
    star: Star,
    scene: &Scene,
) -> LawOutcome {
    let (theta_rad, v_mps, omega_r_radps) = (star.theta_rad, star.v_mps, scene.omega_r_radps);
    let rates = star_rates(situation, gains, &star, v_mps);
    let rate_radps = rates.theta_radps;
    let u = kinematic::feedback(situation, gains, theta_rad, rate_radps, v_mps, omega_r_radps);
    LawOutcome {
        star,
        rates,
        omega_star_radps: u[1] - omega_r_radps,
        lyapunov: kinematic::lyapunov(situation, theta_rad),
        u,
    }
}

fn dynamic_outcome(situation: &Situation, gains: &Gains, star: Star, scene: &Scene) -> LawOutcome {
    let speeds =
        Speeds { v_mps: scene.v_mps, omega_e_radps: scene.omega_radps - scene.omega_r_radps };
    // The rate of ω_r is taken as 0 (specification §6).
    let feedback = dynamic::feedback(situation, gains, &star, &speeds, 0.0);
    LawOutcome {
        star,
        rates: feedback.rates,
        omega_star_radps: feedback.omega_e_star_radps,
        lyapunov: feedback.lyapunov,
        u: feedback.u,
    }
}
