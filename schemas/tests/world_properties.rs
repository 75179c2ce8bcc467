//! Contracts of the world's geometry that tie its questions to each other, over random worlds:
//! where a ray ends a point robot touches; a grown ray ends where a disc touches; a body is as near
//! as its nearest point; and nothing depends on where the axes are drawn.

use proptest::prelude::*;
use schemas::{Footprint, HalfPlane, MovingDisc, Obstacle, Pose, World};
use std::f64::consts::{PI, TAU};

const TIME_S: f64 = 3.0;

/// Points on half a side of a body's outline.
const SAMPLES: i32 = 100;

fn point(at_m: [f64; 2]) -> Pose {
    Pose { x_m: at_m[0], y_m: at_m[1], theta_rad: 0.0 }
}

fn along(from_m: [f64; 2], angle_rad: f64, distance_m: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle_rad);
    [from_m[0] + distance_m * cos, from_m[1] + distance_m * sin]
}

fn to_point_m(world: &World, at_m: [f64; 2]) -> f64 {
    world.clearance_m(&Footprint::POINT, &point(at_m), TIME_S)
}

/// A convex polygon inscribed in a circle, its corners in order.
fn obstacle() -> impl Strategy<Value = Obstacle> {
    let place = (-3.0..3.0, -3.0..3.0, 0.2..1.2);
    (place, 3..7_usize, prop::collection::vec(-0.3..0.3, 7), 0.0..TAU).prop_map(
        |((x, y, radius_m), corners, jitter, turned_rad)| Obstacle {
            corners_m: (0..corners)
                .map(|i| {
                    let share = (i as f64 + jitter[i]) / corners as f64;
                    along([x, y], turned_rad + TAU * share, radius_m)
                })
                .collect(),
        },
    )
}

fn disc() -> impl Strategy<Value = MovingDisc> {
    ((-3.0..3.0, -3.0..3.0), (-3.0..3.0, -3.0..3.0), 0.05..0.5, 0.0..1.0, any::<bool>()).prop_map(
        |(from, to, radius_m, speed_mps, to_and_fro)| MovingDisc {
            radius_m,
            from_m: [from.0, from.1],
            to_m: [to.0, to.1],
            speed_mps,
            start_s: 0.5,
            to_and_fro,
        },
    )
}

fn wall(turned_rad: f64, offset_m: f64) -> HalfPlane {
    let (sin, cos) = libm::sincos(turned_rad);
    HalfPlane { normal: [cos, sin], offset_m }
}

/// A turned room of up to four walls with up to three obstacles and two discs.
fn world() -> impl Strategy<Value = World> {
    (
        0.0..TAU,
        prop::collection::vec(1.5..5.0, 0..5),
        prop::collection::vec(obstacle(), 0..4),
        prop::collection::vec(disc(), 0..3),
    )
        .prop_map(|(turned_rad, offsets_m, obstacles, discs)| World {
            room: offsets_m
                .iter()
                .enumerate()
                .map(|(i, &offset_m)| wall(turned_rad + i as f64 * PI / 2.0, offset_m))
                .collect(),
            obstacles,
            discs,
            paths: Vec::new(),
        })
}

fn place() -> impl Strategy<Value = [f64; 2]> {
    (-4.0..4.0, -4.0..4.0).prop_map(|(x, y)| [x, y])
}

fn body() -> impl Strategy<Value = Footprint> {
    (0.1..1.0, 0.1..1.0).prop_map(|(length_m, width_m)| Footprint { length_m, width_m })
}

/// The distance to touching a world with a disc, found by marching: going on by the clearance can
/// never jump over anything.
fn march_m(world: &World, from_m: [f64; 2], angle_rad: f64, radius_m: f64, reach_m: f64) -> f64 {
    let mut gone_m = 0.0;
    for _ in 0..100_000 {
        let clearance_m = to_point_m(world, along(from_m, angle_rad, gone_m)) - radius_m;
        if clearance_m < 1e-9 || gone_m > reach_m {
            break;
        }
        gone_m += clearance_m;
    }
    gone_m
}

/// The world turned about the origin, then shifted.
fn moved(world: &World, turn_rad: f64, shift_m: [f64; 2]) -> World {
    let (sin, cos) = libm::sincos(turn_rad);
    let turn = |p: [f64; 2]| [p[0] * cos - p[1] * sin, p[0] * sin + p[1] * cos];
    let shift = |p: [f64; 2]| [p[0] + shift_m[0], p[1] + shift_m[1]];
    World {
        room: world
            .room
            .iter()
            .map(|wall| {
                let normal = turn(wall.normal);
                let ahead_m = normal[0] * shift_m[0] + normal[1] * shift_m[1];
                HalfPlane { normal, offset_m: wall.offset_m + ahead_m }
            })
            .collect(),
        obstacles: world
            .obstacles
            .iter()
            .map(|it| Obstacle {
                corners_m: it.corners_m.iter().map(|&corner| shift(turn(corner))).collect(),
            })
            .collect(),
        discs: world
            .discs
            .iter()
            .map(|it| MovingDisc {
                from_m: shift(turn(it.from_m)),
                to_m: shift(turn(it.to_m)),
                ..*it
            })
            .collect(),
        paths: Vec::new(),
    }
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    a == b || (a - b).abs() <= tolerance
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1000,
        max_global_rejects: 100_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// What is left out on the way to the nearest thing changes nothing, to the bit.
    #[test]
    fn the_clearance_is_the_least_of_each_thing_alone(
        world in world(), at_m in place(), theta_rad in -9.0..9.0, body in body(),
    ) {
        let pose = Pose { theta_rad, ..point(at_m) };
        let alone = |world: World| world.clearance_static_m(&body, &pose);
        let walls = world.room.iter().map(|wall| {
            alone(World { room: vec![*wall], ..World::default() })
        });
        let obstacles = world.obstacles.iter().map(|obstacle| {
            alone(World { obstacles: vec![obstacle.clone()], ..World::default() })
        });
        let want = walls.chain(obstacles).fold(f64::INFINITY, f64::min);
        prop_assert_eq!(world.clearance_static_m(&body, &pose), want);
    }

    /// From an admissible point a ray, grown by a radius or not, is free for a disc of that radius
    /// up to its end, and there the disc touches. An infinite ray is free for ever.
    #[test]
    fn a_ray_ends_where_a_disc_touches(
        world in world(), from_m in place(), angle_rad in -9.0..9.0, radius_m in 0.0..0.6,
        grown in any::<bool>(),
    ) {
        let radius_m = if grown { radius_m } else { 0.0 };
        prop_assume!(to_point_m(&world, from_m) > radius_m);
        let ray_m = world.ray_m(from_m, angle_rad, radius_m, TIME_S);
        prop_assert!(ray_m > 0.0);
        let length_m = if ray_m.is_finite() { ray_m } else { 20.0 };
        for share in [0.1, 0.3, 0.5, 0.7, 0.9, 0.99] {
            let clearance_m = to_point_m(&world, along(from_m, angle_rad, share * length_m));
            prop_assert!(clearance_m > radius_m - 1e-9, "{clearance_m} at {share}");
        }
        if ray_m.is_finite() {
            let end_m = along(from_m, angle_rad, ray_m);
            prop_assert!(close(to_point_m(&world, end_m), radius_m, 1e-9));
        }
    }

    /// Marching arrives where the ray does, also at grazing angles.
    #[test]
    fn a_ray_is_as_long_as_a_march(
        world in world(), from_m in place(), angle_rad in -9.0..9.0, radius_m in 0.0..0.6,
    ) {
        prop_assume!(to_point_m(&world, from_m) > radius_m);
        let ray_m = world.ray_m(from_m, angle_rad, radius_m, TIME_S);
        let marched_m = march_m(&world, from_m, angle_rad, radius_m, 10.0);
        if ray_m <= 10.0 {
            // A march stops short of a surface that it grazes at a small angle, and of one that it
            // passes within 1e-9 m.
            prop_assert!(marched_m <= ray_m + 1e-9, "{marched_m} > {ray_m}");
            let left_m = to_point_m(&world, along(from_m, angle_rad, marched_m)) - radius_m;
            prop_assert!(left_m < 1e-6);
            prop_assert!(close(marched_m, ray_m, 1e-3), "{marched_m} {ray_m}");
        } else {
            prop_assert!(marched_m > 10.0 - 1e-3, "{marched_m} {ray_m}");
        }
    }

    /// Inside an obstacle or a disc the ray is minus the way back to where it came in; growth only
    /// lengthens that way.
    #[test]
    fn inside_a_ray_tells_the_way_back(
        obstacle in obstacle(), walker in disc(), use_disc in any::<bool>(),
        from_m in place(), angle_rad in -9.0..9.0, radius_m in 0.0..0.5,
    ) {
        let world = if use_disc {
            World { discs: vec![walker], ..World::default() }
        } else {
            World { obstacles: vec![obstacle], ..World::default() }
        };
        // Pull the point in, so that a fair share of the cases is inside.
        let centre_m = if use_disc {
            walker.at(TIME_S).centre_m
        } else {
            world.obstacles[0].corners_m[0]
        };
        let from_m = [0, 1].map(|i| centre_m[i] + 0.1 * from_m[i]);
        prop_assume!(to_point_m(&world, from_m) < radius_m - 1e-6);
        let ray_m = world.ray_m(from_m, angle_rad, radius_m, TIME_S);
        prop_assert!(ray_m < 0.0, "{ray_m}");
        let entry_m = along(from_m, angle_rad, ray_m);
        prop_assert!(close(to_point_m(&world, entry_m), radius_m, 1e-9));
        prop_assert!(world.ray_m(from_m, angle_rad, radius_m + 0.1, TIME_S) <= ray_m);
    }

    /// A body is as near as the nearest of its points: samples on its outline come as near as the
    /// clearance up to their spacing, and never nearer.
    #[test]
    fn a_body_is_as_near_as_its_nearest_point(
        world in world(), at_m in place(), theta_rad in -9.0..9.0, body in body(),
    ) {
        let pose = Pose { theta_rad, ..point(at_m) };
        let clearance_m = world.clearance_m(&body, &pose, TIME_S);
        prop_assume!(clearance_m > 0.0);
        let mut nearest_m = f64::INFINITY;
        for i in -SAMPLES..=SAMPLES {
            let share = f64::from(i) / f64::from(SAMPLES);
            for (ahead, aside) in [(share, 1.0), (share, -1.0), (1.0, share), (-1.0, share)] {
                let on_m = pose.transform(
                    0.5 * ahead * body.length_m,
                    0.5 * aside * body.width_m,
                );
                nearest_m = nearest_m.min(to_point_m(&world, on_m));
            }
        }
        prop_assert!(nearest_m >= clearance_m - 1e-9, "{nearest_m} {clearance_m}");
        // Half the spacing along a side of at most 1 m.
        prop_assert!(
            nearest_m <= clearance_m + 0.25 / f64::from(SAMPLES) + 1e-9
                || nearest_m == clearance_m
        );
    }

    /// A rectangle is the same turned by half a turn, and by a quarter with length and width
    /// exchanged.
    #[test]
    fn a_body_looks_the_same_from_behind(
        world in world(), at_m in place(), theta_rad in -9.0..9.0, body in body(),
    ) {
        let clearance = |body: &Footprint, turn_rad: f64| {
            let pose = Pose { theta_rad: theta_rad + turn_rad, ..point(at_m) };
            world.clearance_m(body, &pose, TIME_S)
        };
        let wanted_m = clearance(&body, 0.0);
        let across = Footprint { length_m: body.width_m, width_m: body.length_m };
        prop_assert!(close(clearance(&body, PI), wanted_m, 1e-9));
        prop_assert!(close(clearance(&across, PI / 2.0), wanted_m, 1e-9));
    }

    /// The depth of a contact is the shortest shift that undoes it: no shorter one does, and one of
    /// that length does.
    #[test]
    fn a_depth_is_the_shortest_way_out(
        obstacle in obstacle(), offset_m in place(), theta_rad in -9.0..9.0, body in body(),
    ) {
        let near_m = obstacle.corners_m[0];
        let at_m = [0, 1].map(|i| near_m[i] + 0.1 * offset_m[i]);
        let world = World { obstacles: vec![obstacle], ..World::default() };
        let pose = Pose { theta_rad, ..point(at_m) };
        let depth_m = -world.clearance_static_m(&body, &pose);
        prop_assume!(depth_m > 1e-3);
        let mut best_m = f64::NEG_INFINITY;
        for step in 0..720 {
            let angle_rad = f64::from(step) * TAU / 720.0;
            let after = |shift_m: f64| {
                let there_m = along(at_m, angle_rad, shift_m);
                let pose = Pose { theta_rad, ..point(there_m) };
                world.clearance_static_m(&body, &pose)
            };
            prop_assert!(after(0.999 * depth_m) < 0.0);
            best_m = best_m.max(after(depth_m));
        }
        // A quarter of a degree off the best direction costs depth × (1 - cos).
        prop_assert!(best_m > -1e-5 * depth_m - 1e-12, "{best_m}");
    }

    /// The nearest face is as near as the point's clearance says, and straight into it the
    /// clearance shrinks as fast as one goes, as long as it is a face and not a corner.
    #[test]
    fn the_nearest_face_is_the_nearest(world in world(), from_m in place()) {
        let clearance_m = to_point_m(&world, from_m);
        let Some(face) = world.nearest_face(from_m, TIME_S) else {
            prop_assert_eq!(clearance_m, f64::INFINITY);
            return Ok(());
        };
        prop_assert!(close(face.distance_m, clearance_m, 1e-12));
        let step_m = 1e-6;
        let nearer_m = to_point_m(&world, along(from_m, face.direction_rad, step_m));
        let gain_m = clearance_m - nearer_m;
        prop_assert!(gain_m <= step_m + 1e-9);
        // Off a corner, at worst a right angle between the nearer face's normal and the corner: it
        // may bring nothing, but it never leads away.
        prop_assert!(gain_m > -1e-9, "{gain_m}");
    }

    /// Nothing depends on where the axes are drawn.
    #[test]
    fn turning_and_shifting_everything_changes_nothing(
        world in world(), from_m in place(), angle_rad in -9.0..9.0, radius_m in 0.0..0.6,
        body in body(), turn_rad in -PI..PI, shift_m in place(),
    ) {
        let other = moved(&world, turn_rad, shift_m);
        let (sin, cos) = libm::sincos(turn_rad);
        let there_m = [
            from_m[0] * cos - from_m[1] * sin + shift_m[0],
            from_m[0] * sin + from_m[1] * cos + shift_m[1],
        ];
        let here = Pose { theta_rad: angle_rad, ..point(from_m) };
        let there = Pose { theta_rad: angle_rad + turn_rad, ..point(there_m) };
        prop_assert!(close(
            world.clearance_m(&body, &here, TIME_S),
            other.clearance_m(&body, &there, TIME_S),
            1e-9
        ));
        prop_assert!(close(
            world.clearance_static_m(&body, &here),
            other.clearance_static_m(&body, &there),
            1e-9
        ));
        // A ray that grazes something within rounding may meet it here and miss it there, but
        // then it is a tangent, along which a slightly thinner ray and a slightly thicker one
        // bracket the answer.
        let a_m = world.ray_m(from_m, angle_rad, radius_m, TIME_S);
        let b_m = other.ray_m(there_m, angle_rad + turn_rad, radius_m, TIME_S);
        if !close(a_m, b_m, 1e-6 * (1.0 + a_m.abs())) {
            let thick_m = world.ray_m(from_m, angle_rad, radius_m + 1e-9, TIME_S);
            let thin_m = world.ray_m(from_m, angle_rad, (radius_m - 1e-9).max(0.0), TIME_S);
            prop_assert!(thick_m - 1e-3 <= b_m && b_m <= thin_m + 1e-3, "{a_m} {b_m}");
        }
        let (near, far) = (world.nearest_face(from_m, TIME_S), other.nearest_face(there_m, TIME_S));
        prop_assert_eq!(near.is_some(), far.is_some());
        if let (Some(near), Some(far)) = (near, far) {
            prop_assert!(close(near.distance_m, far.distance_m, 1e-9));
        }
    }
}
