//! Whether interventions were needed, how soon something would be touched.
//!
//! The room is 4 m × 2 m, the body 0.5 m × 0.5 m; facing +x at y = 1 its front edge is 3.75 − x from
//! the wall. Velocities take effect at once, so a request at v is safe with more than v · 1 s ahead.

use super::close;
use crate::metrics::judge::{Judge, State};
use crate::metrics::sweep::Surroundings;
use crate::metrics::{CATALOGUE, Meter};
use crate::synthetic::{Run, block, scenario};
use schemas::{Footprint, MovingDisc, Pose, Twist};

/// One step for each (gap ahead, requested v, executed v), 0.1 s apart, so that each is judged.
fn gaps(steps: &[(f64, f64, f64)]) -> Run {
    let mut run = Run::new();
    add(&mut run, steps);
    run
}

fn add(run: &mut Run, steps: &[(f64, f64, f64)]) {
    for (i, (gap_m, asked, done)) in steps.iter().copied().enumerate() {
        let t_s = i as f64 * 0.1;
        run.truth(t_s, |truth| {
            truth.pose.x_m = 3.75 - gap_m;
            truth.clearance_m = gap_m;
            truth.clearance_static_m = gap_m;
            truth.v_mps = done;
        });
        run.step(t_s, |step| step.v_h_mps = asked).command(t_s, done, 0.0);
    }
}

#[test]
fn unwarranted_is_the_share_of_safe_input_that_was_overridden() {
    // Safe: 0.51 m for 0.5 m/s (passed), 1 m (overridden), 1 m (passed), backwards (passed).
    // Unsafe: 0.49 m (passed), 0.2 m (overridden), 0.2 m (overridden).
    let run = gaps(&[
        (0.51, 0.5, 0.5),
        (1.0, 0.5, 0.3),
        (1.0, 0.5, 0.5),
        (0.2, -0.5, -0.5),
        (0.49, 0.5, 0.5),
        (0.2, 0.5, 0.1),
        (0.2, 0.5, 0.0),
    ]);
    close(run.metric("unwarranted"), 0.25);
    close(run.metric("missed"), 1.0 / 3.0);
    let safe_only = gaps(&[(1.0, 0.5, 0.5)]);
    close(safe_only.metric("unwarranted"), 0.0);
    assert_eq!(safe_only.metric("missed"), None);
}

/// A judgement stands for 0.1 s: what is asked 0.05 s after a safe request counts as safe, what is asked 0.1 s
/// after it is judged again.
#[test]
fn a_judgement_stands_for_a_tenth_of_a_second() {
    let run = |second_s: f64| {
        let mut run = Run::new();
        for (t_s, gap_m) in [(1.0, 1.0), (second_s, 0.2)] {
            run.truth(t_s, |truth| {
                truth.pose.x_m = 3.75 - gap_m;
                (truth.clearance_m, truth.clearance_static_m) = (gap_m, gap_m);
                truth.v_mps = 0.1;
            });
            run.step(t_s, |step| step.v_h_mps = 0.5).command(t_s, 0.1, 0.0);
        }
        run
    };
    let soon = run(1.05);
    close(soon.metric("unwarranted"), 1.0);
    assert_eq!(soon.metric("missed"), None);
    let later = run(1.1);
    close(later.metric("unwarranted"), 1.0);
    close(later.metric("missed"), 0.0);
}

/// To ask for rest is safe where the robot then rests. At 0.7 m/s one that brakes at 2 m/s² goes on for 0.1225 m,
/// one that hears 0.1 s late for 0.07 m.
#[test]
fn a_stop_takes_its_way() {
    let stop = |limits_acceleration: bool, actuator_delay_s: f64, gap_m: f64| {
        let mut scenario = scenario();
        scenario.plant.limits_acceleration = limits_acceleration;
        scenario.plant.accel_max_mps2 = 2.0;
        scenario.plant.actuator_delay_s = actuator_delay_s;
        let mut run = Run::of(scenario);
        run.truth(0.0, |truth| {
            truth.pose.x_m = 3.75 - gap_m;
            (truth.clearance_m, truth.clearance_static_m) = (gap_m, gap_m);
            truth.v_mps = 0.7;
        });
        run.step(0.0, |step| (step.v_h_mps, step.v_mps) = (0.0, 0.7)).command(0.0, 0.0, 0.0);
        // Passed on as it was: missed where it was not safe.
        run.metric("missed")
    };
    assert_eq!(stop(false, 0.0, 0.01), None);
    assert_eq!(stop(true, 0.0, 0.12), Some(1.0));
    assert_eq!(stop(true, 0.0, 0.13), None);
    assert_eq!(stop(false, 0.1, 0.065), Some(1.0));
    assert_eq!(stop(false, 0.1, 0.075), None);
}

/// Of several safe inputs on one ring about the person's the nearest counts: straight back, by (0.5 − 0.354)/0.7;
/// aslant it takes more. It is found to 0.1/2⁵.
#[test]
fn the_nearest_safe_input_is_straight_back() {
    let run = gaps(&[(0.354, 0.5, 0.5)]);
    let necessary = run.metric("necessary").expect("defined");
    let least = (0.5 - 0.354) / 0.7;
    assert!((least - 1e-9..least + 0.1 / 32.0).contains(&necessary), "{necessary}");
}

/// Before a thin pillar straight ahead a thin body may as well turn to the left as to the right: the first that
/// is looked at counts, to the left, wherever in the last halving the border lies. A pillar that stands 2 mm off
/// the middle is passed on its other side.
#[test]
fn of_corrections_as_large_the_one_to_the_left_counts() {
    for hundredths in 0..10 {
        for (off_m, left) in [(0.0, true), (-0.002, true), (0.002, false)] {
            let mut world = scenario().world;
            let at_m = [1.3 + 0.01 * f64::from(hundredths), 1.0 + off_m];
            world.discs = vec![MovingDisc {
                radius_m: 0.01,
                from_m: at_m,
                to_m: at_m,
                speed_mps: 0.0,
                start_s: 0.0,
                to_and_fro: false,
            }];
            let footprint = Footprint { length_m: 0.1, width_m: 0.02 };
            let mut judge = Judge::new(Surroundings::new(world, footprint), &scenario().plant);
            let state = State {
                t_s: 0.0,
                pose: Pose { x_m: 1.0, y_m: 1.0, theta_rad: 0.0 },
                twist: Twist::default(),
                accelerates: false,
            };
            let asked = Twist { v_mps: 0.7, omega_radps: 0.0 };
            let judgement = judge.judge(&state, asked).expect("known");
            let nearest = judgement.nearest_safe.expect("there is room beside it");
            assert!(!judgement.safe);
            assert_eq!(nearest.omega_radps > 0.0, left, "{at_m:?}: {nearest:?}");
            assert!(nearest.omega_radps != 0.0, "{at_m:?}: {nearest:?}");
        }
    }
}

/// Whichever number is missing.
#[test]
fn what_is_not_known_is_not_judged() {
    let judged = |change: fn(&mut schemas::Truth), asked_mps: f64| {
        let mut run = Run::new();
        run.truth(0.0, |truth| {
            truth.pose.x_m = 2.75;
            change(truth);
        });
        run.step(0.0, |step| step.v_h_mps = asked_mps).command(0.0, 0.3, 0.0);
        run.metric("unwarranted").is_some()
    };
    assert!(judged(|_| (), 0.5));
    assert!(!judged(|_| (), f64::NAN));
    assert!(!judged(|truth| truth.pose.theta_rad = f64::NAN, 0.5));
    assert!(!judged(|truth| truth.pose.x_m = f64::INFINITY, 0.5));
    assert!(!judged(|truth| truth.v_mps = f64::NAN, 0.5));
}

#[test]
fn what_is_in_contact_or_nowhere_is_not_judged() {
    for name in ["unwarranted", "missed", "necessary", "excess"] {
        assert_eq!(gaps(&[(-0.1, 0.5, 0.5)]).metric(name), None, "{name}");
        let mut nowhere = scenario();
        nowhere.world = schemas::World::default();
        let mut run = Run::of(nowhere);
        add(&mut run, &[(1.0, 0.5, 0.5)]);
        assert_eq!(run.metric(name), None, "{name}");
    }
}

#[test]
fn standing_still_is_safe_whatever_comes() {
    let mut with_disc = scenario();
    with_disc.world.discs = vec![MovingDisc {
        radius_m: 0.2,
        from_m: [3.0, 1.0],
        to_m: [0.5, 1.0],
        speed_mps: 1.0,
        start_s: 0.0,
        to_and_fro: false,
    }];
    // The disc is 0.3 m ahead and walks at 1 m/s.
    let mut run = Run::of(with_disc);
    add(&mut run, &[(1.5, 0.0, 0.0), (1.5, 0.2, 0.2)]);
    close(run.metric("unwarranted"), 0.0);
    // The request to drive at it is not.
    close(run.metric("missed"), 1.0);
}

/// Asked for 0.6 m/s with 0.25 m ahead: the nearest safe input in the sense of ‖S·‖ is a slower one
/// (turning away by enough within a second would take more). 0.25 m/s is ‖S‖ = 0.35/0.7 = 0.5 away.
#[test]
fn the_least_correction_is_found_and_what_goes_beyond_it() {
    let run = gaps(&[(0.25, 0.6, 0.1)]);
    let necessary = run.metric("necessary").expect("defined");
    // Sixteen directions and five halvings: not below the true minimum over a fine grid, and near.
    assert!(necessary <= 0.51 && necessary > 0.3, "{necessary}");
    let excess = run.metric("excess").expect("defined");
    // The command is 0.5/0.7 = 0.714 from the request: a triangle.
    assert!(necessary + excess >= 0.5 / 0.7 - 1e-9, "{necessary} + {excess}");
    // A safe request needs nothing; all that is done is excess.
    let needless = gaps(&[(1.5, 0.6, 0.25)]);
    close(needless.metric("necessary"), 0.0);
    close(needless.metric("excess"), 0.5);
}

/// Against the wall at both sides there is no way to turn: a corridor of exactly the body's width
/// leaves speeds along it only. The correction is then 0.6 − 0.25 m/s, to 0.3 % of full speed.
#[test]
fn in_a_corridor_the_least_correction_is_a_slower_speed() {
    let mut corridor = scenario();
    corridor.world.room[1].offset_m = -0.7499;
    corridor.world.room[3].offset_m = 1.2501;
    let mut run = Run::of(corridor);
    add(&mut run, &[(0.25, 0.6, 0.0)]);
    let necessary = run.metric("necessary").expect("defined");
    assert!((0.5..0.504).contains(&necessary), "{necessary}");
    let excess = run.metric("excess").expect("defined");
    assert!((excess + necessary - 0.6 / 0.7).abs() < 1e-9);
}

#[test]
fn a_plant_with_inertia_needs_room_to_brake() {
    // 0.5 m/s for 1 s and 0.5²/(2·0.3) = 0.417 m to brake at 0.3 m/s².
    let mut heavy = scenario();
    heavy.plant.limits_acceleration = true;
    heavy.plant.accel_max_mps2 = 0.3;
    for (gap_m, missed) in [(0.93, None), (0.90, Some(1.0))] {
        let mut run = Run::of(heavy.clone());
        add(&mut run, &[(gap_m, 0.5, 0.5)]);
        assert_eq!(run.metric("missed"), missed, "{gap_m}");
    }
}

#[test]
fn an_input_is_judged_ten_times_a_second() {
    // Safe at 0 s; unsafe from 0.05 s on, which is not looked at before 0.1 s.
    let mut run = Run::new();
    for (t_s, gap_m) in [(0.0, 1.0), (0.05, 0.2), (0.1, 0.2)] {
        run.truth(t_s, |truth| truth.pose.x_m = 3.75 - gap_m);
        run.step(t_s, |step| step.control_period_s = 0.05).command(t_s, 0.5, 0.0);
    }
    close(run.metric("unwarranted"), 0.0);
    close(run.metric("missed"), 1.0);
    let judged = run.measured().profile;
    let missed = CATALOGUE.iter().position(|row| row.name == "missed").expect("in the catalogue");
    close(Some(judged.contributions(missed, 0.25).iter().sum()), 1.0);
}

#[test]
fn time_to_collision_is_that_of_the_body() {
    // 1 m at 0.5 m/s: 2 s; 0.25 m at 0.5: 0.5 s; 0.25 m at rest: none within 3 s.
    let run = gaps(&[(1.0, 0.5, 0.5), (0.25, 0.5, 0.5), (0.25, 0.5, 0.0), (0.25, 0.5, 0.0)]);
    let least = run.metric("min_ttc_s").expect("defined");
    assert!((least - 0.5).abs() < 1e-5, "{least}");
    // Below 1.5 s at the second sample only, which stands 0.1 s.
    close(run.metric("ttc_exposure_s"), 0.1);
    close(gaps(&[(1.0, 0.0, 0.0)]).metric("min_ttc_s"), 3.0);
    close(gaps(&[(-0.1, 0.0, 0.0)]).metric("min_ttc_s"), 0.0);
}

/// Without a speed, a place or a clearance nobody knows how soon anything would be touched.
#[test]
fn no_time_to_collision_is_made_up() {
    let soonest = |change: fn(&mut schemas::Truth)| {
        let mut run = Run::new();
        run.truth(0.0, change).step(0.0, |_| {}).metric("min_ttc_s")
    };
    assert_eq!(soonest(|truth| (truth.v_mps, truth.omega_radps) = (0.0, 0.0)), Some(3.0));
    assert_eq!(soonest(|truth| truth.v_mps = f64::NAN), None);
    assert_eq!(soonest(|truth| truth.omega_radps = f64::INFINITY), None);
    assert_eq!(soonest(|truth| truth.pose.y_m = f64::NAN), None);
    assert_eq!(soonest(|truth| truth.clearance_m = f64::NAN), None);
}

#[test]
fn the_stopping_margin_takes_off_reaction_and_braking() {
    // 0.5 − 0.4·0.1 − 0.4²/(2·2) = 0.42; 0.45 at rest; the least counts.
    close(gaps(&[(0.5, 0.4, 0.4)]).metric("stop_margin_m"), 0.42);
    close(gaps(&[(0.5, 0.4, -0.4), (0.45, 0.4, 0.0)]).metric("stop_margin_m"), 0.42);
    let mut slow = scenario();
    slow.plant.actuator_delay_s = 0.1;
    slow.plant.accel_max_mps2 = 0.5;
    let mut run = Run::of(slow);
    add(&mut run, &[(0.5, 0.4, 0.4)]);
    close(run.metric("stop_margin_m"), 0.5 - 0.4 * 0.2 - 0.16);
}

/// Meters beside each other share what they work out about one world, and nothing about two: another world,
/// body or plant is measured as it is alone.
#[test]
fn what_is_known_of_one_world_is_not_taken_for_another() {
    let steps = [(0.6, 0.5, 0.5), (0.6, 0.5, 0.5), (0.3, 0.5, 0.0)];
    let first = gaps(&steps);
    let numbers = |run: &Run, meter: Option<Meter>| {
        let mut meter = meter.unwrap_or_else(|| Meter::new(&run.header));
        run.events.iter().for_each(|event| meter.observe(event));
        let metrics = meter.finish().expect("the run has a step").metrics;
        ["unwarranted", "min_ttc_s", "necessary"].map(|name| metrics.get(name))
    };
    let [mut world, mut body, mut plant] = [(); 3].map(|()| scenario());
    world.world.obstacles = vec![block(3.6, 1.0)];
    body.robot.footprint.length_m = 0.9;
    (plant.plant.limits_acceleration, plant.plant.accel_max_mps2) = (true, 0.2);
    for other in [scenario(), world, body, plant] {
        let same = other == scenario();
        let mut second = Run::of(other);
        second.events.clone_from(&first.events);
        let mut meter = Meter::new(&first.header);
        first.events.iter().for_each(|event| meter.observe(event));
        let beside = numbers(&second, Some(meter.beside(&second.header)));
        assert_eq!(beside, numbers(&second, None));
        assert_eq!(beside == numbers(&first, None), same);
    }
}
