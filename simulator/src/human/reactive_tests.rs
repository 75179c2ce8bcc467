//! The contract of the people who react: the same person is the same again, they get where they want
//! to be, they react to where the robot is, and they back off from what they push against.

use super::*;
use crate::{scenario, simulation::JOYSTICK_PERIOD};

const PEOPLE: [&str; 4] = ["hesitant", "flowing", "explorer", "tracker"];

/// A robot that does what is asked for, or turns on the spot and gets nowhere.
fn ride(name: &str, seconds: u32, stuck: bool) -> Vec<(Pose, Request)> {
    let scenario = scenario(name).expect("a known scenario");
    let mut person = driver(&scenario, scenario.driver, 0).expect("needs nothing but a room");
    let dt_s = JOYSTICK_PERIOD.seconds();
    let mut pose = scenario.start.pose;
    (0..50 * seconds)
        .map(|i| {
            let seen = HumanView { index: u64::from(i), ..view(f64::from(i) * dt_s, pose) };
            let request = person.joystick(&seen).expect("holds the stick");
            let before = pose;
            let (sin, cos) = libm::sincos(pose.theta_rad);
            let way_m = if stuck { 0.0 } else { request.v_mps * dt_s };
            pose = Pose {
                x_m: pose.x_m + way_m * cos,
                y_m: pose.y_m + way_m * sin,
                theta_rad: pose.theta_rad + request.omega_radps * dt_s,
            };
            (before, request)
        })
        .collect()
}

#[test]
fn the_same_person_is_the_same_again_and_another_is_not() {
    for person in PEOPLE {
        let name = |n: u32| format!("random:rect:{person}:{n}");
        assert_eq!(ride(&name(3), 10, false), ride(&name(3), 10, false), "{person}");
        assert_ne!(ride(&name(3), 10, false), ride(&name(4), 10, false), "{person}");
    }
}

/// Requests are finite, and within what a stick can say.
#[test]
fn requests_are_what_a_stick_can_say() {
    for person in PEOPLE {
        for n in 0..6 {
            for (_, request) in ride(&format!("random:slant:{person}:{n}"), 30, n % 2 == 1) {
                assert!(
                    request.v_mps.abs() <= 0.8 && request.omega_radps.abs() <= 2.0,
                    "{request:?}"
                );
                assert!(request.dead_man);
            }
        }
    }
}

/// A robot that gets nowhere is pushed for a while, and then backed off.
#[test]
fn who_pushes_in_vain_backs_off() {
    for person in PEOPLE {
        let ride = ride(&format!("random:rect:{person}:2"), 30, true);
        let back = ride.iter().filter(|(_, request)| request.v_mps < -0.2).count();
        assert!(back > 25, "{person} backs off for {back} ticks");
        assert!(ride[..40].iter().all(|(_, request)| request.v_mps > -0.2), "{person}: too soon");
    }
}

/// What is asked for depends on where the robot is: the same person asks for something else when the
/// robot stands still.
#[test]
fn people_react() {
    for person in PEOPLE {
        let name = format!("random:rect:{person}:5");
        let asked = |stuck| -> Vec<Request> {
            ride(&name, 15, stuck).into_iter().map(|(_, request)| request).collect()
        };
        assert_ne!(asked(true), asked(false), "{person}");
    }
}

/// People with places to be come within half a metre of one after the other.
#[test]
fn people_with_places_to_be_get_there() {
    for person in ["hesitant", "flowing"] {
        let name = format!("random:rect:{person}:1");
        let scenario = scenario(&name).expect("a known scenario");
        let mut wishes = mood::Wishes::new(&scenario);
        let first_m = wishes.at_m();
        wishes.change();
        assert_ne!(wishes.at_m(), first_m);
        let nearest_m = ride(&name, 40, false)
            .iter()
            .map(|(pose, _)| libm::hypot(pose.x_m - first_m[0], pose.y_m - first_m[1]))
            .fold(f64::INFINITY, f64::min);
        let from = scenario.start.pose;
        let way_m = libm::hypot(from.x_m - first_m[0], from.y_m - first_m[1]);
        assert!(nearest_m < 0.5_f64.max(0.5 * way_m), "{person}: {nearest_m} of {way_m}");
    }
}
