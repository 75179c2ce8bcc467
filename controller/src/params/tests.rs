//! Contract: the table of parameters is complete and consistent, reading refuses what is not
//! allowed and says so, and what is written reads back bit for bit.

use proptest::prelude::*;
use schemas::SensorSuite;

use super::*;
use crate::spec::{Law, Spec};
use crate::version::versions;

fn table(text: &str) -> toml::Table {
    text.parse().expect("TOML")
}

fn message(name: &str, overrides: &str) -> String {
    Spec::resolve(name, &[&table(overrides)]).expect_err(overrides).to_string()
}

#[test]
fn every_row_is_documented_and_its_default_allowed() {
    let defaults = Params::default().settings();
    for (row, default) in Params::table().iter().zip(defaults) {
        assert_eq!(row.default, default, "{}", row.key);
        assert!(row.meaning.ends_with('.') && row.meaning.len() > 10, "{}", row.key);
        assert!(!row.source.is_empty(), "{}", row.key);
        Params::default().set(row.key, &default.into()).expect(row.key);
        let number = matches!(row.allowed, Allowed::Range { .. });
        assert_eq!(number, matches!(default, Setting::Number(_)), "{}", row.key);
    }
}

/// The key's unit is its suffix.
#[test]
fn keys_carry_their_units() {
    for row in Params::table() {
        for (suffix, unit) in [("_s", "s"), ("_m", "m"), ("_mps", "m/s"), ("_rad", "rad")] {
            assert_eq!(row.key.ends_with(suffix), row.unit == unit, "{} {}", row.key, row.unit);
        }
    }
}

/// Specification §8, kinematic column.
#[test]
fn the_defaults_are_those_of_the_specification() {
    let Params { gamma1, gamma2, gamma3, epsilon_m, r_m, cap_m, .. } = Params::default();
    assert_eq!([gamma1, gamma2, gamma3], [0.2, 0.2, 2.0]);
    assert_eq!([epsilon_m, r_m, cap_m], [0.05, 0.5, 1.0]);
    let Params { b1_task_m, b2_task_m, b1_free_m, b2_free_m, .. } = Params::default();
    assert_eq!([b1_task_m, b2_task_m, b1_free_m, b2_free_m], [2.45, 2.6, 1.0, 1.3]);
    let Params { v_rest_mps, control_period_s, guard_m, v_disc_mps, .. } = Params::default();
    assert_eq!([v_rest_mps, control_period_s, guard_m, v_disc_mps], [0.004, 0.1, 0.02, 0.3]);
}

/// The table at the head of the specification, row by row.
#[test]
fn the_versions_differ_as_specified() {
    let of = |name: &str| Spec::resolve(name, &[]).expect(name).params;
    let (paper, tandem) = (of("paper-kinematic"), of("tandem-kinematic"));
    assert_eq!((paper.frame, tandem.frame), (Frame::Reference, Frame::Wall));
    assert_eq!((paper.side_rule, tandem.side_rule), (SideRule::Printed, SideRule::Near));
    assert_eq!(paper.branch_signs, BranchSigns::Left);
    assert_eq!(tandem.branch_signs, BranchSigns::Sigma);
    assert_eq!((paper.sets, tandem.sets), (Sets::Printed, Sets::Total));
    assert_eq!((paper.d_mode_task, tandem.d_mode_task), (DMode::Heading, DMode::Both));
    assert_eq!((paper.d_mode_free, tandem.d_mode_free), (DMode::Heading, DMode::Sweep));
    assert_eq!((paper.margin, tandem.margin), (Precaution::Never, Precaution::Never));
    assert_eq!((paper.d_body, tandem.d_body), (DBody::Disc, DBody::Footprint));
    assert_eq!((paper.law_body, tandem.law_body), (LawBody::Disc, LawBody::Lane));
    assert_eq!((paper.wait, tandem.wait), (Precaution::Never, Precaution::Always));
    assert_eq!(paper.reverse_law, ReverseLaw::Same);
    assert_eq!(tandem.reverse_law, ReverseLaw::Mirrored);
    assert_eq!((paper.v_rest_mps, tandem.v_rest_mps), (0.0, 0.004));
    assert_eq!((paper.saturation, tandem.saturation), (Saturation::Clip, Saturation::Scale));
    assert_eq!((paper.projection, tandem.projection), (Projection::None, Projection::Both));
    assert_eq!((paper.sonar_shortfall_m, tandem.sonar_shortfall_m), (0.0, 0.08));
    // Everything else is alike.
    let tandem_as_paper = Params {
        frame: paper.frame,
        side_rule: paper.side_rule,
        branch_signs: paper.branch_signs,
        sets: paper.sets,
        d_mode_task: paper.d_mode_task,
        d_mode_free: paper.d_mode_free,
        d_body: paper.d_body,
        law_body: paper.law_body,
        wait: paper.wait,
        reverse_law: paper.reverse_law,
        sonar_shortfall_m: paper.sonar_shortfall_m,
        v_rest_mps: paper.v_rest_mps,
        saturation: paper.saturation,
        projection: paper.projection,
        ..tandem
    };
    assert_eq!(tandem_as_paper, paper);
    let law = |name: &str| Spec::resolve(name, &[]).expect(name).law;
    assert_eq!(law("paper-kinematic"), Law::Kinematic);
    assert_eq!(law("tandem-kinematic"), Law::Kinematic);
    assert_eq!(law("human"), Law::Human);
}

/// The dynamic versions: Case II's column of specification §8; γ5 and λ of the paper where the law
/// is as printed; all else as in the kinematic version of the same family.
#[test]
fn the_dynamic_versions_differ_as_specified() {
    let of = |name: &str| Spec::resolve(name, &[]).expect(name).params;
    for family in ["paper", "tandem"] {
        let kinematic = of(&format!("{family}-kinematic"));
        let dynamic = of(&format!("{family}-dynamic"));
        let printed = family == "paper";
        let expected = Params {
            gamma1: 0.3,
            gamma2: 0.3,
            gamma3: 4.0,
            gamma4: 6.0,
            gamma5: if printed { 0.0 } else { 1.0 },
            lambda: if printed { 1.0 } else { 0.3 },
            control_period_s: 0.01,
            v_rest_mps: if printed { 0.0 } else { 0.01 },
            ..kinematic
        };
        assert_eq!(dynamic, expected);
        assert_eq!(
            Spec::resolve(&format!("{family}-dynamic"), &[]).expect("listed").law,
            Law::Dynamic
        );
    }
}

#[test]
fn version_names_are_unique_and_said_in_a_sentence() {
    for (i, version) in versions().iter().enumerate() {
        assert!(versions()[..i].iter().all(|other| other.name != version.name));
        assert!(version.summary.len() > 20, "{}", version.name);
        Spec::resolve(version.name, &[]).expect(version.name);
    }
}

#[test]
fn later_overrides_win() {
    let (first, second) = (table("gamma1 = 0.3\ngamma2 = 0.4"), table("gamma1 = 0.5"));
    let spec = Spec::resolve("tandem-kinematic", &[&first, &second]).expect("in range");
    assert_eq!((spec.params.gamma1, spec.params.gamma2), (0.5, 0.4));
}

#[test]
fn refusals_name_key_value_and_what_is_allowed() {
    let with = |overrides: &str| message("tandem-kinematic", overrides);
    assert_eq!(with("gama1 = 1"), "unknown parameter `gama1`; did you mean `gamma1`?");
    assert_eq!(
        with("gamma1 = -1.5"),
        "parameter `gamma1` = -1.5: expected a number from 0.000001 to 100"
    );
    assert_eq!(
        with("gamma1 = nan"),
        "parameter `gamma1` = nan: expected a number from 0.000001 to 100"
    );
    assert_eq!(
        with("gamma1 = \"big\""),
        "parameter `gamma1` = \"big\": expected a number from 0.000001 to 100"
    );
    assert_eq!(
        with("frame = \"floor\""),
        "parameter `frame` = \"floor\": expected one of ref, wall"
    );
    assert_eq!(
        with("b1_task_m = 2.7"),
        "parameter `b2_task_m` = 2.6: expected more than 2.7, which is `b1_task_m`"
    );
    assert_eq!(
        message("tandem", ""),
        "unknown controller `tandem`; did you mean `tandem-dynamic`? there are: paper-kinematic, \
         tandem-kinematic, paper-dynamic, tandem-dynamic, human"
    );
    let no_toml = Spec::from_recorded("human", "gamma1 = ").expect_err("no value");
    // Whoever tells an error with its causes tells this one once.
    let cause = std::error::Error::source(&no_toml).expect("what is wrong with it").to_string();
    assert!(!no_toml.to_string().contains(&cause), "{no_toml}");
}

#[test]
fn whole_numbers_are_numbers() {
    let spec = Spec::resolve("human", &[&table("gamma1 = 1")]).expect("in range");
    assert_eq!(spec.params.gamma1, 1.0);
}

#[test]
fn every_version_round_trips() {
    for version in versions() {
        let spec = Spec::resolve(version.name, &[]).expect(version.name);
        assert_eq!(Spec::from_recorded(version.name, &spec.params_toml()), Ok(spec));
    }
}

/// A parameter that is newer than a log takes the version's own default.
#[test]
fn what_a_log_lacks_is_the_versions_default() {
    let spec = Spec::from_recorded("paper-kinematic", "gamma1 = 0.7\n").expect("in range");
    assert_eq!((spec.params.gamma1, spec.params.v_rest_mps), (0.7, 0.0));
}

proptest! {
    /// Any allowed number survives writing and reading, bit for bit.
    #[test]
    fn numbers_round_trip_bit_for_bit(
        row in 0..Params::COUNT,
        share in 0.0..=1.0f64,
        mantissa in any::<u32>(),
    ) {
        let row = Params::table()[row];
        if let Allowed::Range { min, max } = row.allowed {
            let exact = min + (max - min) * share;
            // Odd low bits, so that a short decimal form would not do.
            let number = f64::from_bits(exact.to_bits() ^ u64::from(mantissa >> 8)).clamp(min, max);
            let mut spec = Spec::resolve("human", &[]).expect("it is listed");
            spec.params.set(row.key, &toml::Value::Float(number)).expect("in range");
            // b1 < b2 is another contract.
            spec.params.b2_task_m = spec.params.b2_task_m.max(spec.params.b1_task_m + 1.0).min(1000.0);
            spec.params.b2_free_m = spec.params.b2_free_m.max(spec.params.b1_free_m + 1.0).min(1000.0);
            prop_assume!(spec.params.b2_task_m > spec.params.b1_task_m);
            prop_assume!(spec.params.b2_free_m > spec.params.b1_free_m);
            let back = Spec::from_recorded("human", &spec.params_toml()).expect("what was written");
            let bits = |spec: &Spec| spec.params.settings().map(|setting| match setting {
                Setting::Number(number) => number.to_bits(),
                Setting::Name(name) => name.len() as u64,
            });
            prop_assert_eq!(bits(&back), bits(&spec));
        }
    }
}

/// Specification §5: with sonars D counts as 0.08 m longer than measured; with the margin the guard of 0.02 m
/// and 0.3 m/s for 0.1 s are taken off.
#[test]
fn what_the_sets_compare_is_not_what_is_measured() {
    let tandem = Spec::resolve("tandem-kinematic", &[]).expect("listed").params;
    let guarded = Params { margin: Precaution::Always, ..tandem };
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    close(tandem.effective_m(0.5, -0.3, SensorSuite::Exact), 0.5);
    close(tandem.effective_m(0.5, -0.3, SensorSuite::Sonar), 0.58);
    close(guarded.effective_m(0.5, -0.3, SensorSuite::Exact), 0.45);
    close(guarded.effective_m(0.5, -0.3, SensorSuite::Sonar), 0.53);
    assert!(tandem.effective_m(f64::NAN, 0.3, SensorSuite::Sonar).is_nan());
}
