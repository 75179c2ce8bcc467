//! Contract: the functions of the law agree, to 1e-9 relative, with input/output pairs made by an
//! independent program (`fixtures/vectors/controller.jsonl`).
//!
//! The number of pairs per function is asserted, so that an empty or cut file fails.

use std::collections::BTreeMap;
use std::path::Path;

use controller::law::admissible::admissible;
use controller::law::arctangent::continuous_atan2;
use controller::law::dynamic::{self, Speeds};
use controller::law::star::{star, star_rates};
use controller::law::{Axis, BranchSigns, Gains, Side, Situation, kinematic};
use controller::plan::{Past, Scene, plan};
use controller::sharing::{Switch, classify_total, critical_distance_m, select};
use controller::side::{SideDistance, SideRule, choose};
use controller::{Law, Params};
use schemas::Region;
use serde_json::Value;

/// One line of the file.
struct Pair {
    tag: String,
    input: Value,
    output: Value,
}

fn number(value: &Value) -> f64 {
    match value.as_str() {
        Some("NaN") => f64::NAN,
        Some("Infinity") => f64::INFINITY,
        Some("-Infinity") => f64::NEG_INFINITY,
        Some(other) => panic!("not a number: {other}"),
        None => value.as_f64().expect("a number"),
    }
}

impl Pair {
    fn get(&self, key: &str) -> f64 {
        number(&self.input[key])
    }

    fn list(&self, key: &str) -> Vec<f64> {
        self.input[key].as_array().expect("a list").iter().map(number).collect()
    }

    fn get_or(&self, key: &str, default: f64) -> f64 {
        self.input.get(key).map_or(default, number)
    }

    /// Asserts that `actual` is the expected output called `key`.
    fn expect(&self, key: &str, actual: f64) {
        let expected = number(&self.output[key]);
        self.close(key, expected, actual);
    }

    fn close(&self, key: &str, expected: f64, actual: f64) {
        let same = (expected.is_nan() && actual.is_nan())
            || expected == actual
            || (actual - expected).abs() <= 1e-9 * expected.abs() + 1e-13;
        assert!(
            same,
            "{key}: expected {expected:e}, got {actual:e} ({} {:?})",
            self.tag, self.input
        );
    }

    /// The situation that most functions of the law take; absent quantities are 0.
    fn situation(&self) -> Situation {
        Situation {
            ahead: Axis {
                d_m: self.get("d1"),
                d_r_m: self.get("dr1"),
                d_r_rate_mps: self.get_or("drd1", 0.0),
                d_r_accel_mps2: self.get_or("drdd1", 0.0),
            },
            aside: Axis {
                d_m: self.get("d2"),
                d_r_m: self.get("dr2"),
                d_r_rate_mps: self.get_or("drd2", 0.0),
                d_r_accel_mps2: self.get_or("drdd2", 0.0),
            },
            side: side(self.get_or("side", 1.0)).expect("a side"),
            signs: BranchSigns::Sigma,
            theta_e_rad: self.get_or("te", 0.0),
        }
    }

    fn gains(&self) -> Gains {
        Gains {
            gamma1: self.get_or("g1", f64::NAN),
            gamma2: self.get_or("g2", f64::NAN),
            gamma3: self.get_or("g3", f64::NAN),
            gamma4: self.get_or("g4", f64::NAN),
            gamma5: self.get_or("g5", f64::NAN),
            lambda: self.get_or("lam", f64::NAN),
        }
    }

    fn v_star(&self) -> f64 {
        star(&self.situation(), &self.gains(), 0.0).v_mps
    }
}

fn side(sigma: f64) -> Option<Side> {
    if sigma == 1.0 {
        Some(Side::Left)
    } else if sigma == -1.0 {
        Some(Side::Right)
    } else {
        None
    }
}

/// All pairs by function.
fn pairs() -> BTreeMap<String, Vec<Pair>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/vectors/controller.jsonl");
    let text = std::fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut pairs: BTreeMap<String, Vec<Pair>> = BTreeMap::new();
    for line in text.lines() {
        let mut value: Value = serde_json::from_str(line).expect("a line is JSON");
        let name = value["fn"].as_str().expect("a function's name").to_owned();
        pairs.entry(name).or_default().push(Pair {
            tag: value["tag"].as_str().expect("a tag").to_owned(),
            input: value["in"].take(),
            output: value["out"].take(),
        });
    }
    pairs
}

/// The pairs of one function, of which there must be `count`.
fn pairs_of(name: &str, count: usize) -> Vec<Pair> {
    let pairs = pairs().remove(name).unwrap_or_default();
    assert_eq!(pairs.len(), count, "pairs of {name}");
    pairs
}

#[test]
fn d_r() {
    for pair in pairs_of("d_r", 150) {
        let d_r = admissible(pair.get("dd"), pair.get("r"), pair.get("eps"));
        pair.expect("dr", d_r.d_r_m);
        pair.expect("slope", d_r.slope);
        pair.expect("curv", d_r.curvature);
        pair.expect("dr_dot", d_r.rate(pair.get("dd_dot")));
        pair.expect("dr_ddot", d_r.accel(pair.get("dd_dot"), pair.get("dd_ddot")));
    }
}

#[test]
fn atg_seq() {
    for pair in pairs_of("atg_seq", 150) {
        let mut angle = pair.get("prev");
        let expected = pair.output["value"].as_array().expect("a list");
        let (x, y) = (pair.list("x"), pair.list("y"));
        assert_eq!(expected.len(), x.len());
        for ((x, y), expected) in x.into_iter().zip(y).zip(expected) {
            angle = continuous_atan2(y, x, angle, pair.get("tol"));
            pair.close("value", number(expected), angle);
        }
    }
}

fn sides(pair: &Pair) -> [SideDistance; 2] {
    [
        SideDistance { d_m: pair.get("d2l"), d_r_m: pair.get("dr2l") },
        SideDistance { d_m: pair.get("d2r"), d_r_m: pair.get("dr2r") },
    ]
}

#[test]
fn choose_d2() {
    for pair in pairs_of("choose_d2", 150) {
        let [left, right] = sides(&pair);
        pair.expect("side", choose(SideRule::Printed, &left, &right, None, 1.0).sigma());
    }
}

#[test]
fn choose_d2_near() {
    for pair in pairs_of("choose_d2_near", 150) {
        let [left, right] = sides(&pair);
        let (previous, favour) = (side(pair.get("prev")), 1.0 - pair.get("hyst"));
        pair.expect("side", choose(SideRule::Near, &left, &right, previous, favour).sigma());
    }
}

#[test]
fn theta_e_star() {
    for pair in pairs_of("theta_e_star", 150) {
        let star = star(&pair.situation(), &pair.gains(), pair.get("prev"));
        pair.expect("theta_star", star.theta_rad);
        pair.expect("v_star", star.v_mps);
    }
}

#[test]
fn rates_of_star() {
    for pair in pairs_of("star_rates", 150) {
        let (situation, gains) = (pair.situation(), pair.gains());
        let star = star(&situation, &gains, 0.0);
        let rates = star_rates(&situation, &gains, &star, pair.get("v"));
        pair.expect("theta_star_dot", rates.theta_radps);
        pair.expect("v_star_dot", rates.v_mps2);
    }
}

#[test]
fn u_f_kinematic() {
    for pair in pairs_of("u_f_kinematic", 150) {
        let [v, omega] = kinematic::feedback(
            &pair.situation(),
            &pair.gains(),
            pair.get("ts"),
            pair.get("ts_dot"),
            pair.v_star(),
            pair.get("wr"),
        );
        pair.expect("v", v);
        pair.expect("omega", omega);
    }
}

#[test]
fn lyap_kinematic() {
    for pair in pairs_of("lyap_kinematic", 150) {
        pair.expect("L", kinematic::lyapunov(&pair.situation(), pair.get("ts")));
    }
}

#[test]
fn omega_e_star() {
    for pair in pairs_of("omega_e_star", 150) {
        let omega_e_star = dynamic::omega_e_star(
            &pair.situation(),
            &pair.gains(),
            pair.get("ts"),
            pair.get("ts_dot"),
            pair.v_star(),
        );
        pair.expect("omega_star", omega_e_star);
    }
}

#[test]
fn u_f_dynamic() {
    for pair in pairs_of("u_f_dynamic", 150) {
        let (situation, gains) = (pair.situation(), pair.gains());
        let (v_star, v_star_rate) = (pair.get("vs"), pair.get("vs_dot"));
        let u1 = dynamic::acceleration(&situation, &gains, v_star, v_star_rate, pair.get("v"));
        let u2 = dynamic::angular_acceleration(
            pair.get("te") - pair.get("ts"),
            &gains,
            pair.get("we"),
            pair.get("ws"),
            pair.get("ws_dot"),
            pair.get("wr_dot"),
        );
        pair.expect("u1", u1);
        pair.expect("u2", u2);
    }
}

#[test]
fn lyap_dynamic() {
    for pair in pairs_of("lyap_dynamic", 150) {
        let speeds = Speeds { v_mps: pair.get("v"), omega_e_radps: pair.get("we") };
        let (theta_star, v_star) = (pair.get("ts"), pair.get("vs"));
        let situation = pair.situation();
        let value = dynamic::lyapunov(&situation, &speeds, theta_star, v_star, pair.get("ws"));
        pair.expect("L", value);
    }
}

#[test]
fn share() {
    for pair in pairs_of("share", 300) {
        let (d, v) = (pair.get("D"), pair.get("v"));
        let (b1, b2) = (pair.get("b1"), pair.get("b2"));
        pair.expect("dc1", critical_distance_m(v, b1));
        pair.expect("dc2", critical_distance_m(v, b2));
        let region = classify_total(d, d, v, b1, b2);
        let class = pair.output["cls"].as_str().expect("a class");
        let expected = match class {
            "safe" => Region::Safe,
            "danger" => Region::Danger,
            "hyst" | "hysteresis" => Region::Hysteresis,
            other => panic!("unknown class {other}"),
        };
        assert_eq!(region, expected, "{} {:?}", pair.tag, pair.input);
        let switch = Switch { human: pair.get("k_prev") == 1.0, seen_safe: true };
        pair.expect("k", switch.next(region).k());
    }
}

#[test]
fn u_s() {
    for pair in pairs_of("u_s", 150) {
        let (u_f, u_h) = ([pair.get("uf"); 2], [pair.get("uh"); 2]);
        let [u, _] = select(pair.get("k") == 1.0, u_f, u_h);
        assert_eq!(u.to_bits(), number(&pair.output["u"]).to_bits(), "{:?}", pair.input);
    }
}

/// The whole feedback step: capping, wanted distances, side, star, rest rule, law.
#[test]
fn f_step() {
    for pair in pairs_of("f_step", 150) {
        let params = Params {
            cap_m: pair.get("B"),
            r_m: pair.get("r"),
            epsilon_m: pair.get("eps"),
            gamma1: pair.get("g1"),
            gamma2: pair.get("g2"),
            gamma3: pair.get("g3"),
            v_rest_mps: pair.get("vdead"),
            side_rule: SideRule::Near,
            side_favour: 0.9,
            branch_signs: BranchSigns::Sigma,
            ..Params::default()
        };
        let scene = Scene {
            d1_m: pair.get("d1"),
            d2l_m: pair.get("d2l"),
            d2r_m: pair.get("d2r"),
            delta_m: [pair.get("D1"), pair.get("D2")],
            q_mps: [pair.get("q1"), pair.get("q2")],
            theta_e_rad: pair.get("te"),
            omega_r_radps: pair.get("wr"),
            jumped: pair.get("reset") == 1.0,
            v_mps: f64::NAN,
            omega_radps: f64::NAN,
        };
        let past =
            Past { side: side(pair.get("side_prev")), theta_star_rad: Some(pair.get("ts_prev")) };
        let plan = plan(Law::Kinematic, &params, &scene, &past);
        let star = plan.outcome.expect("every distance is known").star;
        pair.expect("side", plan.situation.sigma());
        pair.expect("dr1", plan.situation.ahead.d_r_m);
        pair.expect("dr2", plan.situation.aside.d_r_m);
        pair.expect("theta_star", star.theta_rad);
        pair.expect("v", plan.u[0]);
        pair.expect("omega", plan.u[1]);
    }
}
