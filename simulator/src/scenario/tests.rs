use super::*;
use schemas::{Driver, Footprint, Pose, Scenario, SensorSuite};

fn built_in() -> impl Iterator<Item = Scenario> {
    BUILT_IN.iter().map(|(name, _)| scenario(name).expect("a built-in scenario reads"))
}

/// Every built-in scenario reads, is named as its file, says what it is, survives being written and
/// read, and starts clear of everything.
#[test]
fn built_in_scenarios_are_sound() {
    for (scenario, (name, _)) in built_in().zip(BUILT_IN) {
        assert_eq!(scenario.name, name);
        assert!(!scenario.summary.is_empty());
        let again = Scenario::from_toml(&scenario.to_toml()).expect("what was written reads");
        assert_eq!(again, scenario);
        let clearance_m =
            scenario.world.clearance_m(&scenario.robot.footprint, &scenario.start.pose, 0.0);
        assert!(clearance_m > 0.1, "{name}: {clearance_m}");
    }
}

/// Point robots with exact rays in the paper's simulations, bodies with sonars in its experiments;
/// the same task and person in both.
#[test]
fn simulations_and_experiments_share_task_and_person() {
    for case in ["case1", "case2", "case3"] {
        let simulated = scenario(case).expect("built in");
        let lab = scenario(&format!("{case}-lab")).expect("built in");
        assert_eq!(simulated.robot.footprint, Footprint::POINT);
        assert_eq!(simulated.sensors, SensorSuite::Exact);
        assert_eq!(lab.robot.footprint, Footprint { length_m: 0.5, width_m: 0.5 });
        assert_eq!(lab.sensors, SensorSuite::Sonar);
        assert!(lab.noise.sonar.is_some() && lab.noise.imu.is_some());
        assert!(lab.noise.encoders.is_some() && lab.noise.joystick.is_some());
        assert_eq!(lab.task, simulated.task);
        assert_eq!(lab.person, simulated.person);
        assert_eq!(lab.start, simulated.start);
        assert_eq!(lab.duration_s, simulated.duration_s);
    }
}

/// Specification §11: Case I's target reaches x = 3, y = 1.97 at 44.78 s; Case III's script adds up
/// to 72 s.
#[test]
fn tasks_are_those_of_the_specification() {
    let case1 = scenario("case1").expect("built in");
    let ([x_m, y_m], velocity) = case1.task.expect("Case I has a task").target(60.0);
    assert!((x_m - 3.0).abs() < 1e-12 && (y_m - 0.044 * 3.0 / 0.067).abs() < 1e-12);
    assert_eq!(velocity, [0.0, 0.0]);
    let case3 = scenario("case3").expect("built in");
    let total_s: f64 = case3.person.script.iter().map(|stroke| stroke.duration_s).sum();
    assert_eq!(total_s, case3.duration_s);
}

#[test]
fn unknown_names_are_told_what_there_is() {
    let error = scenario("case1-lap").expect_err("there is no such scenario").to_string();
    assert!(error.contains("did you mean \"case1-lab\"?"), "{error}");
    assert!(error.contains("case3-lab") && error.contains("random:N"), "{error}");
    for (name, part) in [
        ("random:", "\"\""),
        ("random:-1", "\"-1\""),
        ("random:round:goal:1", "\"round\""),
        ("random:rect:script:1", "\"script\""),
        ("random:rect:goal:x", "\"x\""),
        ("random:rect:goal", "\"rect:goal\""),
    ] {
        let error = scenario(name).expect_err("malformed").to_string();
        assert!(error.ends_with(&format!("got {part}")), "{error}");
    }
}

#[test]
fn the_list_names_what_can_be_made() {
    let list = scenarios();
    for (name, summary) in &list {
        assert!(!summary.is_empty());
        assert!(name.starts_with("random:") || scenario(name).is_ok(), "{name}");
    }
    assert_eq!(list.len(), BUILT_IN.len() + 2);
}

/// Over 300 rooms of every kind and driver: the scenario survives being written and read, holds to
/// the sizes of specification §6, and its footprint has 0.25 m of clearance at every heading.
#[test]
fn random_scenarios_keep_the_rule_of_the_specification() {
    for kind in ["rect", "slant", "disc"] {
        let mut walls = [0; 8];
        let mut boxes = [0; 4];
        let mut triangles = 0;
        for n in 0..100 {
            for driver in ["goal", "joystick"] {
                let name = format!("random:{kind}:{driver}:{n}");
                let made = scenario(&name).expect("well-formed");
                let again = Scenario::from_toml(&made.to_toml()).expect("what was written reads");
                assert_eq!(again, made);
                assert_eq!(made.name, name);
                assert_eq!(made.duration_s, 15.0);
                assert_eq!(made.task.is_some(), driver == "goal");
                assert_eq!(made.driver == Driver::Goal, driver == "goal");
                assert_eq!(made.sensors, SensorSuite::Sonar);

                let start = made.start.pose;
                for step in 0..36 {
                    let pose = Pose { theta_rad: f64::from(step) * 10_f64.to_radians(), ..start };
                    let clearance_m = made.world.clearance_m(&made.robot.footprint, &pose, 0.0);
                    assert!(clearance_m >= 0.25 - 1e-9, "{name}: {clearance_m}");
                }
                if let Some(task) = made.task {
                    assert_eq!(task.from_m, start.position_m());
                    let [vx, vy] = task.velocity_mps;
                    let speed = libm::hypot(vx, vy);
                    assert!((0.1..=0.5).contains(&speed));
                    let along = libm::sincos(start.theta_rad);
                    assert!((vx - speed * along.1).abs() < 1e-12);
                    assert!((vy - speed * along.0).abs() < 1e-12);
                }
                walls[made.world.room.len()] += 1;
                boxes[made.world.obstacles.len()] += 1;
                for obstacle in &made.world.obstacles {
                    triangles += usize::from(obstacle.corners_m.len() == 3);
                }
                assert_eq!(kind == "disc", !made.world.discs.is_empty());
                assert!(made.world.discs.len() <= 2);
                for disc in &made.world.discs {
                    assert!((0.05..=0.3).contains(&disc.radius_m));
                    assert!((0.1..=0.3).contains(&disc.speed_mps) && disc.to_and_fro);
                }
            }
        }
        // Every number of walls and boxes that the rule allows does occur, and no other.
        let occurring: Vec<usize> = (0..8).filter(|&count| walls[count] > 0).collect();
        assert_eq!(occurring, if kind == "slant" { vec![4, 5, 6, 7] } else { vec![4] });
        assert!(boxes.iter().all(|&count| count > 10), "{boxes:?}");
        assert_eq!(kind == "slant", triangles > 0);
    }
}

/// The walls of a room enclose its width and depth of 3 to 6 m: seen from the middle of it, the
/// opposite walls are that far apart, at most.
#[test]
fn random_rooms_have_the_size_of_the_specification() {
    for kind in ["rect", "slant"] {
        for n in 0..100 {
            let made = scenario(&format!("random:{kind}:joystick:{n}")).expect("well-formed");
            let empty = schemas::World { room: made.world.room, ..schemas::World::default() };
            for quarter in 0..2 {
                let across = f64::from(quarter) * core::f64::consts::FRAC_PI_2;
                let behind = across + core::f64::consts::PI;
                // The widest chord of 400 parallel ones is the extent, but for the grid.
                let mut widest_m: f64 = 0.0;
                for i in -200..=200 {
                    let (sin, cos) = libm::sincos(across);
                    let aside_m = f64::from(i) * 0.015;
                    let from_m = [-aside_m * sin, aside_m * cos];
                    let ahead_m = empty.ray_m(from_m, across, 0.0, 0.0);
                    let back_m = empty.ray_m(from_m, behind, 0.0, 0.0);
                    widest_m = widest_m.max(ahead_m + back_m);
                }
                assert!(widest_m <= 6.0 + 1e-9, "{kind} {n}: {widest_m}");
                assert!(kind == "slant" || widest_m >= 3.0 - 1e-9, "{kind} {n}: {widest_m}");
            }
        }
    }
}

/// A name always makes the same scenario, other numbers make others, and the short form covers
/// every kind and driver.
#[test]
fn random_scenarios_are_made_by_their_number_alone() {
    assert_eq!(scenario("random:17").expect("ok"), scenario("random:17").expect("ok"));
    let (a, b) = (scenario("random:17").expect("ok"), scenario("random:18").expect("ok"));
    assert_ne!(a.world, b.world);
    let mut summaries: Vec<String> =
        (0..60).map(|n| scenario(&format!("random:{n}")).expect("ok").summary).collect();
    summaries.sort();
    summaries.dedup();
    assert_eq!(summaries.len(), 6);
    assert!(
        scenario("random:18446744073709551615").expect("the largest number").to_toml().len() > 9
    );
}

/// `:key=value,…` sets keys of the plant, nothing else; what the plant does not have is refused.
#[test]
fn a_name_may_set_the_plant() {
    let plain = scenario("random:slant:goal:7").expect("ok");
    let name =
        "random:slant:goal:7:actuator_delay_s=0.1,limits_acceleration=true,accel_max_mps2=0.3";
    let slow = scenario(name).expect("ok");
    assert_eq!(slow.name, name);
    let plant = Plant {
        actuator_delay_s: 0.1,
        limits_acceleration: true,
        accel_max_mps2: 0.3,
        ..plain.plant
    };
    assert_eq!(slow, Scenario { name: name.to_owned(), plant, ..plain });
    assert_eq!(scenario("case1-lab:slip=0").expect("an integer is a number").plant.slip, 0.0);
    for bad in ["case1-lab:delay=0.1", "case1-lab:slip=2", "case1-lab:slip=", "case9:slip=0"] {
        assert!(scenario(bad).is_err(), "{bad}");
    }
}
