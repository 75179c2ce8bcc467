//! Contract: the safety layer with the body swept (specification §9). What is harmless comes back bit
//! for bit; whatever is asked for, a body that starts clear stays clear in a world that stands still,
//! and the stop is always a way out; a body that starts too near comes no nearer.

use controller::safety::{Drive, Keep, Moving, Near, Sweep};
use proptest::prelude::*;
use schemas::{Disc, Footprint, HalfPlane, Obstacle, Plant, Pose, World};

const BODY: Footprint = Footprint { length_m: 0.5, width_m: 0.5 };
const GUARD_M: f64 = 0.03;

/// A room of 3 m × 3 m with a box in it whose corners point at what drives about.
fn world() -> World {
    let walls = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    World {
        room: walls.map(|normal| HalfPlane { normal, offset_m: 1.5 }).to_vec(),
        obstacles: vec![Obstacle {
            corners_m: vec![[0.6, 0.2], [1.0, 0.6], [0.6, 1.0], [0.2, 0.6]],
        }],
        discs: Vec::new(),
        paths: Vec::new(),
    }
}

fn near(world: &World, sweep: &Sweep, pose: &Pose, circle: bool) -> Near {
    let mut near = Near::new(BODY, &world.obstacles, world.room.len());
    near.clear(pose, sweep.reach(), circle.then_some(GUARD_M));
    for wall in &world.room {
        near.wall(wall);
    }
    near.obstacles();
    near
}

/// The kinds of plant: velocities at once, velocities at no more than an acceleration, accelerations.
fn sweep(kind: u8, accel_mps2: f64, period_s: f64) -> Sweep {
    let plant =
        Plant { limits_acceleration: kind == 1, accel_max_mps2: accel_mps2, ..Plant::default() };
    let (guard_m, speeds) = (GUARD_M, [0.0; 2]);
    let turn_most_radps = f64::INFINITY;
    Sweep {
        plant,
        accelerations: kind == 2,
        period_s,
        guard_m,
        later_s: 0.0,
        speeds,
        turn_most_radps,
    }
}

/// A period of the plant in short steps by the midpoint rule: an integrator of its own.
fn drive(sweep: &Sweep, robot: &mut Moving, u: [f64; 2], mut look: impl FnMut(&Pose)) {
    let (steps, plant) = (50, &sweep.plant);
    let dt = sweep.period_s / f64::from(steps);
    for _ in 0..steps {
        let limits = [plant.v_max_mps, plant.omega_max_radps];
        let most = [plant.accel_max_mps2, plant.alpha_max_radps2];
        let before = robot.speeds;
        for axis in 0..2 {
            robot.speeds[axis] = if sweep.accelerations {
                (before[axis] + u[axis] * dt).clamp(-limits[axis], limits[axis])
            } else if plant.limits_acceleration {
                before[axis] + (u[axis] - before[axis]).clamp(-most[axis] * dt, most[axis] * dt)
            } else {
                u[axis]
            };
        }
        let mean = [0, 1].map(|axis| {
            if sweep.accelerations || plant.limits_acceleration {
                0.5 * (before[axis] + robot.speeds[axis])
            } else {
                u[axis]
            }
        });
        let heading = robot.pose.theta_rad + 0.5 * mean[1] * dt;
        robot.pose.x_m += mean[0] * libm::cos(heading) * dt;
        robot.pose.y_m += mean[0] * libm::sin(heading) * dt;
        robot.pose.theta_rad += mean[1] * dt;
        look(&robot.pose);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Recursive feasibility: after any harmless input the stop is harmless, step after step, and the
    /// body keeps the guard, for every plant.
    #[test]
    fn there_always_is_a_way_out(
        kind in 0..3_u8, accel_mps2 in prop_oneof![Just(0.3), Just(2.0)],
        period_s in prop_oneof![Just(0.1), Just(0.02)],
        circle in any::<bool>(), heading in -3.2..3.2f64,
        asked in prop::collection::vec(([-1.0..1.0f64, -1.0..1.0f64], 1..8_usize), 5..25),
    ) {
        let world = world();
        let mut sweep = sweep(kind, accel_mps2, period_s);
        let full = match kind {
            2 => [sweep.plant.accel_max_mps2, sweep.plant.alpha_max_radps2],
            _ => [sweep.plant.v_max_mps, sweep.plant.omega_max_radps],
        };
        let pose = Pose { x_m: -0.5, y_m: -0.5, theta_rad: heading };
        let mut robot = Moving { pose, speeds: [0.0; 2] };
        for (shares, periods) in asked {
            for _ in 0..periods {
                let near = near(&world, &sweep, &robot.pose, circle);
                // What was foreseen in other steps differs by less than half a millimetre.
                let lax = Sweep { guard_m: GUARD_M - 5e-4, ..sweep };
                prop_assert!(lax.allows(lax.stop(lax.speeds), &near), "no way out");
                let wanted = [shares[0] * full[0], shares[1] * full[1]];
                let u = sweep.project(wanted, &near);
                prop_assert_eq!(sweep.allows(wanted, &near), u == wanted);
                let mut least_m = f64::INFINITY;
                drive(&sweep, &mut robot, u, |pose| {
                    least_m = least_m.min(world.clearance_static_m(&BODY, pose));
                });
                prop_assert!(least_m >= GUARD_M - 5e-4, "{least_m}");
                // The layer is told how fast the plant really is.
                sweep.speeds = robot.speeds;
                for axis in 0..2 {
                    if libm::fabs(sweep.speeds[axis]) < 1e-9 {
                        sweep.speeds[axis] = 0.0;
                    }
                }
            }
        }
    }

    /// From too near, or from within: nothing comes nearer than it was, whatever is asked for.
    #[test]
    fn too_near_comes_no_nearer(
        x_m in 1.19..1.4f64, y_m in -1.0..-0.5f64, heading in -3.2..3.2f64, circle in any::<bool>(),
        asked in prop::collection::vec([-0.7..0.7f64, -2.0..2.0f64], 1..30),
    ) {
        let world = World { obstacles: Vec::new(), ..world() };
        let sweep = sweep(0, 2.0, 0.1);
        let pose = Pose { x_m, y_m, theta_rad: heading };
        let mut robot = Moving { pose, speeds: [0.0; 2] };
        let mut kept_m = world.clearance_static_m(&BODY, &pose).min(GUARD_M);
        for wanted in asked {
            let near = near(&world, &sweep, &robot.pose, circle);
            let u = sweep.project(wanted, &near);
            drive(&sweep, &mut robot, u, |pose| {
                let clearance_m = world.clearance_static_m(&BODY, pose);
                // Between two places that are looked at: half of 4 mm.
                assert!(clearance_m >= kept_m - 2.1e-3, "{clearance_m} of {kept_m}");
            });
            kept_m = kept_m.max(world.clearance_static_m(&BODY, &robot.pose).min(GUARD_M));
        }
    }

    /// Whoever can matter is gathered: with one person anywhere, an input is harmless with those within
    /// reach if and only if it is with everyone, however far away.
    #[test]
    fn nobody_who_matters_is_out_of_reach(
        kind in 0..3_u8, accel_mps2 in prop_oneof![Just(0.3), Just(2.0)],
        period_s in prop_oneof![Just(0.1), Just(0.02)],
        later_s in prop_oneof![Just(0.0), Just(0.1), 0.0..0.5f64],
        doubt_m in prop_oneof![Just(0.0), 0.0..0.2f64], circle in any::<bool>(),
        shares in prop::array::uniform4(prop_oneof![Just(-1.0), Just(1.0), -1.0..1.0f64]),
        // Where: about where reach ends, mostly on the way.
        off_m in -0.3..0.1f64, aside_rad in prop_oneof![-0.8..0.8f64, -3.2..3.2f64],
        speed_mps in prop_oneof![Just(0.0), 0.0..2.0f64], radius_m in 0.0..0.4f64,
    ) {
        let mut sweep = Sweep { later_s, ..sweep(kind, accel_mps2, period_s) };
        if kind > 0 {
            sweep.speeds = [0.7 * shares[2], 2.0 * shares[3]];
        }
        let full = if kind == 2 { [accel_mps2, 6.0] } else { [0.7, 2.0] };
        let u = [shares[0] * full[0], shares[1] * full[1]];
        let (reach_m, horizon_s) = sweep.reach();
        let circle_m = BODY.circumscribed_radius_m();
        let centre_m = reach_m + circle_m + radius_m + speed_mps * horizon_s + off_m;
        let way_rad = if sweep.speeds[0] + u[0] < 0.0 { std::f64::consts::PI } else { 0.0 };
        let (sin, cos) = libm::sincos(way_rad + aside_rad);
        let person = Disc { centre_m: [centre_m * cos, centre_m * sin], radius_m };
        let verdict = |reach| {
            let mut near = Near::new(BODY, &[], 1);
            near.clear(&Pose::default(), reach, circle.then_some(GUARD_M));
            near.disc(person, speed_mps, doubt_m);
            (sweep.allows(u, &near), sweep.project(u, &near))
        };
        let all = verdict((1e6, 1e6));
        prop_assert_eq!(verdict(sweep.reach()), all);
    }

    /// What no robot does ends all the same, as harmful or as what it is.
    #[test]
    fn nonsense_ends(
        kind in 0..3_u8, numbers in prop::array::uniform4(prop_oneof![
            Just(f64::NAN), Just(f64::INFINITY), Just(1e300), Just(-1e9), -3.0..3.0f64,
        ]),
    ) {
        let sweep = Sweep { speeds: [numbers[0], numbers[1]], ..sweep(kind, 2.0, 0.1) };
        let near = near(&world(), &sweep, &Pose::default(), true);
        let _ = sweep.project([numbers[2], numbers[3]], &near);
    }
}

/// Pushed at a wall at full speed a body ends at rest before it: no nearer than the guard, and no
/// farther than a tenth of a period's travel and the 2 mm more that are kept at places looked at.
#[test]
fn a_wall_is_reached_and_not_touched() {
    let world = World { obstacles: Vec::new(), ..world() };
    for kind in 0..3 {
        let mut sweep = sweep(kind, 2.0, 0.1);
        let mut robot = Moving { pose: Pose::default(), speeds: [0.0; 2] };
        for _ in 0..80 {
            let near = near(&world, &sweep, &robot.pose, false);
            let u = sweep.project(if kind == 2 { [2.0, 0.0] } else { [0.7, 0.0] }, &near);
            drive(&sweep, &mut robot, u, |_| {});
            sweep.speeds = robot.speeds;
        }
        let left_m = world.clearance_static_m(&BODY, &robot.pose);
        assert!((GUARD_M..GUARD_M + 0.012).contains(&left_m), "{kind}: {left_m}");
    }
}

/// Beside a wall, by hand: a body 2 cm off may drive along it and turn so that no corner swings out;
/// a square whose side lies along the wall swings a corner out whichever way it turns.
#[test]
fn turning_sweeps_the_corners() {
    let world = World { obstacles: Vec::new(), ..world() };
    let sweep = sweep(0, 2.0, 0.1);
    let pose = Pose { x_m: 0.0, y_m: 1.5 - 0.25 - 0.02, theta_rad: 0.0 };
    let near = near(&world, &sweep, &pose, false);
    for harmless in [[0.0, 0.0], [0.7, 0.0], [-0.7, 0.0]] {
        assert_eq!(sweep.project(harmless, &near), harmless);
    }
    for harmful in [[0.0, 1.0], [0.0, -1.0], [0.5, 1.0]] {
        assert!(!sweep.allows(harmful, &near), "{harmful:?}");
    }
    // The driving is kept, the turning is not.
    let [v, omega] = sweep.project([0.5, 1.0], &near);
    assert!(v > 0.0 && omega == 0.0, "{v} {omega}");
}

/// Someone beside the front may step in: then the way ahead is not harmless, but standing, turning away
/// and backing off are. What stands there instead may be driven past.
#[test]
fn people_are_left_room() {
    let sweep = sweep(0, 2.0, 0.1);
    for (speed_mps, passes) in [(0.3, false), (0.0, true)] {
        let mut near = Near::new(BODY, &[], 1);
        near.clear(&Pose::default(), sweep.reach(), None);
        near.disc(Disc { centre_m: [0.1, 0.25 + 0.035 + 0.2], radius_m: 0.2 }, speed_mps, 0.0);
        assert_eq!(sweep.allows([0.3, 0.0], &near), passes);
        assert!(sweep.allows([0.0, 0.0], &near) && sweep.allows([-0.3, 0.0], &near));
    }
}

/// Someone just behind the line across the robot's way, abeam, may walk along with it and come before that
/// line: then going on is not harmless. From farther behind than they can walk meanwhile it is.
#[test]
fn people_abeam_are_left_room_too() {
    let sweep = sweep(0, 2.0, 0.1);
    for (behind_m, passes) in [(0.0, false), (0.04, true)] {
        let mut near = Near::new(BODY, &[], 1);
        near.clear(&Pose::default(), sweep.reach(), None);
        let centre_m = [-behind_m, 0.25 + 0.035 + 0.2];
        near.disc(Disc { centre_m, radius_m: 0.2 }, 0.3, 0.0);
        assert_eq!(sweep.allows([0.29, 0.0], &near), passes, "{behind_m}");
    }
}

/// Where the robot is to turn slowly, faster turning is brought down and slower left alone; what turns faster
/// already may slow down, however little, if it cannot do better.
#[test]
fn turning_can_be_slowed() {
    let sweep = Sweep { turn_most_radps: 1.0, ..sweep(0, 2.0, 0.1) };
    let near = Near::new(BODY, &[], 0);
    assert_eq!(sweep.project([0.3, 1.0], &near), [0.3, 1.0]);
    assert!(sweep.project([0.3, 2.0], &near)[1] <= 1.0);
    let gradual = Sweep { speeds: [0.0, 2.0], ..self::sweep(2, 2.0, 0.1) };
    let gradual = Sweep { turn_most_radps: 1.0, ..gradual };
    assert!(gradual.allows([0.0, -1.0], &near));
    assert!(!gradual.allows([0.0, 0.0], &near));
}

/// 0.3 m/s² needs 0.7²/0.6 = 0.817 m from 0.7 m/s, and 0.07 m for a period of holding: 0.887 m and the
/// guard in front of the body must be free, and no more than the places' 2 mm beyond that.
#[test]
fn a_slow_plant_needs_the_room_that_it_needs() {
    let world = World { obstacles: Vec::new(), ..world() };
    for (kind, u) in [(1, [0.7, 0.0]), (2, [0.0, 0.0])] {
        let sweep = Sweep { speeds: [0.7, 0.0], ..sweep(kind, 0.3, 0.1) };
        for (spare_m, allowed) in [(-0.001, false), (0.004, true)] {
            // The dynamic stop eases off within its last period: less than a·Ts²/8 more.
            let eased_m = if kind == 2 { 0.3 * 0.01 / 8.0 } else { 0.0 };
            let needed_m = 0.7 * 0.1 + 0.7 * 0.7 / 0.6 + GUARD_M + eased_m;
            let x_m = 1.5 - 0.25 - needed_m - spare_m;
            let pose = Pose { x_m, y_m: 0.0, theta_rad: 0.0 };
            let near = near(&world, &sweep, &pose, false);
            assert_eq!(sweep.allows(u, &near), allowed, "{kind} {spare_m}");
        }
    }
}

/// What the foreseen motion is, against the closed form: a ramp from 0.7 m/s at −2 m/s² and straight on.
#[test]
fn motions_are_foreseen() {
    let plant = Plant { limits_acceleration: true, ..Plant::default() };
    let drive = Drive::Velocities([0.0, 0.0]);
    let mut robot = Moving { pose: Pose::default(), speeds: [0.7, 0.0] };
    robot.advance(&plant, drive, 0.2);
    assert!(
        (robot.pose.x_m - (0.7 * 0.2 - 0.04)).abs() < 1e-12
            && (robot.speeds[0] - 0.3).abs() < 1e-12
    );
    robot.advance(&plant, drive, 1.0);
    assert!((robot.pose.x_m - 0.49 / 4.0).abs() < 1e-12 && robot.speeds[0] == 0.0);
}

proptest! {
    /// What is near is passed over only where something else is nearer: all together leave the room that the one
    /// leaves that leaves least, by itself.
    #[test]
    fn things_leave_the_room_that_each_leaves(
        things in prop::collection::vec(
            ([-2.0..2.0_f64, -2.0..2.0_f64], 0.0..0.3_f64, prop_oneof![Just(0.0), Just(0.4)]),
            1..30,
        ),
        (x_m, y_m, theta_rad) in (-0.5..0.5_f64, -0.5..0.5_f64, -3.0..3.0_f64),
        (later_s, v_mps) in (0.0..1.0_f64, prop_oneof![Just(0.0), -0.7..0.7_f64]),
        circle in any::<bool>(),
    ) {
        let keep = Keep { guard_m: GUARD_M, later_s, doubt_share: 0.2, v_mps };
        let near = |things: &[([f64; 2], f64, f64)]| {
            let mut near = Near::new(BODY, &[], things.len());
            near.clear(&Pose::default(), (5.0, 1.0), circle.then_some(GUARD_M));
            for (centre_m, radius_m, speed_mps) in things {
                near.disc(Disc { centre_m: *centre_m, radius_m: *radius_m }, *speed_mps, *radius_m);
            }
            near
        };
        let pose = Pose { x_m, y_m, theta_rad };
        let alone = things.iter().map(|thing| near(&[*thing]).slack_m(&pose, &keep));
        prop_assert_eq!(near(&things).slack_m(&pose, &keep), alone.fold(f64::INFINITY, f64::min));
    }
}
