//! That certainty is never wrong, and where it begins.

use super::*;
use crate::metrics::sweep::{Course, Surroundings};
use crate::synthetic::{block, scenario};
use proptest::prelude::*;
use schemas::MovingDisc;

/// What going step by step says, without any shortcut.
fn step_by_step(
    world: &World,
    footprint: Footprint,
    pose: &Pose,
    t_s: f64,
    twist: Twist,
    span_s: f64,
) -> bool {
    let fastest_mps = world.discs.iter().map(|disc| disc.speed_mps).fold(0.0, f64::max);
    let closing_mps = twist.v_mps.abs()
        + twist.omega_radps.abs() * footprint.circumscribed_radius_m()
        + fastest_mps;
    let (mut here, mut tau_s) = (*pose, 0.0);
    while tau_s < span_s {
        let free_s = world.clearance_m(&footprint, &here, t_s + tau_s) / closing_mps;
        let step_s = free_s.max(SHORTEST_S).min(span_s - tau_s);
        here = arc(&here, twist, step_s);
        tau_s = if step_s < span_s - tau_s { tau_s + step_s } else { span_s };
        if world.clearance_m(&footprint, &here, t_s + tau_s) <= 0.0 {
            return true;
        }
    }
    false
}

fn worlds() -> impl Strategy<Value = World> {
    let disc = ((0.5..3.5f64, 0.5..1.5f64), (0.5..3.5f64, 0.5..1.5f64), 0.0..1.0f64, any::<bool>());
    let disc = disc.prop_map(|(from, to, speed_mps, to_and_fro)| MovingDisc {
        radius_m: 0.15,
        from_m: [from.0, from.1],
        to_m: [to.0, to.1],
        speed_mps,
        start_s: 0.5,
        to_and_fro,
    });
    let triangle = (0.5..3.5f64, 0.5..1.5f64).prop_map(|(x, y)| schemas::Obstacle {
        corners_m: vec![[x, y], [x + 0.5, y + 0.1], [x + 0.1, y + 0.3]],
    });
    let block = (0.5..3.5f64, 0.5..1.5f64).prop_map(|(x, y)| block(x, y));
    let obstacles = prop::collection::vec(prop_oneof![triangle, block], 0..3);
    (obstacles, prop::collection::vec(disc, 0..3)).prop_map(|(obstacles, discs)| World {
        obstacles,
        discs,
        ..scenario().world
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    /// What is said with certainty is what going step by step finds; short of clearances as small
    /// as these tests can make, that is nearly always.
    #[test]
    fn certainty_is_never_wrong(
        world in worlds(),
        (x_m, y_m, theta_rad) in (0.3..3.7f64, 0.3..1.7f64, -4.0..4.0f64),
        (v_mps, omega_radps) in (-0.7..0.7f64, prop_oneof![Just(0.0), -2.0..2.0f64]),
        t_s in 0.0..4.0f64,
        size in prop_oneof![Just((0.5, 0.5)), Just((0.3, 0.2)), Just((0.0, 0.0))],
    ) {
        let footprint = Footprint { length_m: size.0, width_m: size.1 };
        let pose = Pose { x_m, y_m, theta_rad };
        let twist = Twist { v_mps, omega_radps };
        let clearance_m = world.clearance_m(&footprint, &pose, t_s);
        prop_assume!(clearance_m > 0.0);
        let want = step_by_step(&world, footprint, &pose, t_s, twist, 1.0);
        let said = Certain::new(&world, footprint).touches(&world, &pose, t_s, twist, 1.0);
        if let Some(said) = said {
            prop_assert_eq!(said, want);
        }
        let surroundings = Surroundings::new(world, footprint);
        let course = Course::constant(twist, 1.0);
        prop_assert_eq!(surroundings.touches(&pose, t_s, &course, clearance_m), want);
        prop_assert_eq!(surroundings.first_contact_s(&pose, t_s, &course).is_some(), want);
    }
}

proptest! {
    /// In contact it is what the world says, which goes by other ways; apart it is a bound.
    #[test]
    fn the_deepest_contact_is_the_worlds(
        world in worlds(),
        (x_m, y_m, theta_rad) in (0.0..4.0f64, 0.0..2.0f64, -4.0..4.0f64),
        t_s in 0.0..4.0f64,
        (length_m, width_m) in prop_oneof![Just((0.5, 0.5)), Just((0.3, 0.2)), Just((0.0, 0.0))],
    ) {
        let footprint = Footprint { length_m, width_m };
        let pose = Pose { x_m, y_m, theta_rad };
        let certain = Certain::new(&world, footprint);
        let things = world.room.len() + world.obstacles.len() + world.discs.len();
        let got = certain.deepest_m(&world, &Placed::new(&pose, 0.5), t_s, (1 << things) - 1);
        let want = world.clearance_m(&footprint, &pose, t_s + 0.5);
        let right = if want > 1e-9 { 0.0 < got && got < want + 1e-9 } else { (got - want).abs() < 1e-9 };
        prop_assert!(right, "{got} m instead of {want} m");
    }
}

/// f(t) = 4t² + bt + 1 bends by 8 per second twice: from 1 to 2 in a second b is −3 and the least value
/// 1 − 9/16, from 1 to 1 in half a second b is −2 and it is 3/4. What rises by more than half the bend is
/// least at its lower end.
#[test]
fn a_parabola_has_its_least_value() {
    for (from, to, bend, span_s, want) in [
        (1.0, 1.0, 8.0, 1.0, 0.0),
        (1.0, 2.0, 8.0, 1.0, 0.4375),
        (2.0, 1.0, 8.0, 1.0, 0.4375),
        (1.0, 1.0, 8.0, 0.5, 0.75),
        (1.0, 5.0, 8.0, 1.0, 1.0),
        (6.0, 1.0, 8.0, 1.0, 1.0),
        (3.0, 3.0, 0.0, 1.0, 3.0),
    ] {
        assert_eq!(least(from, to, bend, span_s), want, "{from} to {to} in {span_s} s");
    }
}

/// A body of 2 m × 1 m about (2, 1): a disc of 0.1 m about a point 0.2 m behind its front is 0.3 m deep in it, a
/// square of 0.4 m whose face is 0.1 m behind it is 0.1 m deep, though its middle is farther ahead than the front
/// and it is smaller than the body. The walls are 0.5 m away and more.
#[test]
fn the_depth_of_what_is_in_a_large_body_is_to_its_nearest_side() {
    let footprint = Footprint { length_m: 2.0, width_m: 1.0 };
    let deepest_m = |world: &World| {
        let body = Placed::new(&MIDDLE, 0.0);
        Certain::new(world, footprint).deepest_m(world, &body, 0.0, 0b1_1111)
    };
    let at_m = [2.8, 1.1];
    let disc = MovingDisc {
        radius_m: 0.1,
        from_m: at_m,
        to_m: at_m,
        speed_mps: 0.0,
        start_s: 0.0,
        to_and_fro: false,
    };
    let in_body = deepest_m(&World { discs: vec![disc], ..scenario().world });
    assert!((in_body + 0.3).abs() < 1e-12, "{in_body} m");
    let at_front = deepest_m(&World { obstacles: vec![block(3.1, 1.0)], ..scenario().world });
    assert!((at_front + 0.1).abs() < 1e-12, "{at_front} m");
}

fn room() -> (World, Certain) {
    let scenario = scenario();
    let certain = Certain::new(&scenario.world, scenario.robot.footprint);
    (scenario.world, certain)
}

const MIDDLE: Pose = Pose { x_m: 2.0, y_m: 1.0, theta_rad: 0.0 };

/// 1.75 m ahead, and alongside a wall a millimetre away: both are certain.
#[test]
fn plain_cases_are_certain() {
    let (world, certain) = room();
    let ask = |pose: Pose, v_mps, omega_radps, span_s| {
        certain.touches(&world, &pose, 0.0, Twist { v_mps, omega_radps }, span_s)
    };
    assert_eq!(ask(MIDDLE, 0.7, 0.0, 2.499), Some(false));
    assert_eq!(ask(MIDDLE, 0.7, 0.0, 2.501), Some(true));
    let beside = Pose { y_m: 0.251, x_m: 1.0, ..MIDDLE };
    assert_eq!(ask(beside, 0.7, 0.0, 3.0), Some(false));
    // Turned away from it at once the rear corner goes in.
    assert_eq!(ask(beside, 0.1, 1.0, 0.5), Some(true));
    // Touching in passing, a hair deep: that is for others to say.
    let spin = Pose { y_m: 0.125f64.sqrt() - 1e-5, ..MIDDLE };
    assert_eq!(ask(spin, 0.0, 1.0, 3.0), None);
    // Nor of what is nearer than numbers can be trusted, on either side of the border.
    for gap_m in [-5e-9, 5e-9] {
        let at = Pose { x_m: 3.75 - gap_m, ..MIDDLE };
        assert_eq!(ask(at, 0.0, 0.0, 1.0), None, "{gap_m}");
    }
}

/// A contact that is over within the shortest step is for those to find who go step by step: a corner that
/// turns past a wall, a disc that passes the body at rest, a disc at rest that the body passes. Half as
/// deep as the fastest of their points goes in such a step nothing is said, twice as deep it is certain.
#[test]
fn a_touch_in_passing_is_certain_where_it_is_deep() {
    let footprint = scenario().robot.footprint;
    let reach_m = footprint.circumscribed_radius_m();
    let disc = |from_m, to_m, speed_mps| MovingDisc {
        radius_m: 0.15,
        from_m,
        to_m,
        speed_mps,
        start_s: 0.0,
        to_and_fro: false,
    };
    for (share, said) in [(0.5, None), (2.0, Some(true))] {
        let ask = |discs: Vec<MovingDisc>, pose: Pose, v_mps, omega_radps, span_s| {
            let world = World { discs, ..scenario().world };
            let certain = Certain::new(&world, footprint);
            certain.touches(&world, &pose, 0.0, Twist { v_mps, omega_radps }, span_s)
        };
        // The corner stands across to the wall in the middle of 1 s.
        let deep_m = share * SHORTEST_S * 1.2 * reach_m;
        let y_m = 2.0 - reach_m + deep_m;
        let theta_rad = std::f64::consts::FRAC_PI_4 - 0.6;
        let spin = ask(Vec::new(), Pose { y_m, theta_rad, ..MIDDLE }, 0.0, 1.2, 1.0);
        assert_eq!(spin, said, "spinning, {share}");
        // The disc is beside the body in the middle of 2 s.
        let deep_m = share * SHORTEST_S * 0.8;
        let y_m = 1.0 + 0.25 + 0.15 - deep_m;
        let passing = ask(vec![disc([1.2, y_m], [2.8, y_m], 0.8)], MIDDLE, 0.0, 0.0, 2.0);
        assert_eq!(passing, said, "passed by, {share}");
        let deep_m = share * SHORTEST_S * 0.7;
        let at_m = [2.0, 1.0 + 0.25 + 0.15 - deep_m];
        let beside = Pose { x_m: 1.3, ..MIDDLE };
        let passed = ask(vec![disc(at_m, at_m, 0.0)], beside, 0.7, 0.0, 2.0);
        assert_eq!(passed, said, "passing, {share}");
    }
}

/// What was not thought of is not spoken about.
#[test]
fn nothing_is_said_of_odd_worlds_and_numbers() {
    let (world, certain) = room();
    let slow = Twist { v_mps: 0.1, omega_radps: 0.0 };
    for odd in [f64::NAN, f64::INFINITY, 1e9] {
        let pose = Pose { x_m: odd, ..MIDDLE };
        assert_eq!(certain.touches(&world, &pose, 0.0, slow, 1.0), None);
        assert_eq!(certain.touches(&world, &MIDDLE, odd, slow, 1.0), None);
        let fast = Twist { v_mps: odd, ..slow };
        assert_eq!(certain.touches(&world, &MIDDLE, 0.0, fast, 1.0), None);
    }
    let path =
        schemas::WalkedPath { radius_m: 0.2, points: vec![[0.4, 2.5, 1.0], [0.6, 2.5, 1.0]] };
    let walked = World { paths: vec![path], ..world.clone() };
    let clockwise = schemas::Obstacle { corners_m: vec![[1.0, 1.0], [1.0, 2.0], [2.0, 1.0]] };
    let inverted = World { obstacles: vec![clockwise], ..world };
    assert!(certain.is_sound());
    for world in [walked, inverted] {
        let certain = Certain::new(&world, scenario().robot.footprint);
        assert!(!certain.is_sound());
        assert_eq!(certain.touches(&world, &MIDDLE, 0.0, slow, 1.0), None);
    }
}

/// Facing (0.6, 0.8) what is to the left is a quarter of a turn on, at (−0.8, 0.6).
#[test]
fn left_is_a_quarter_of_a_turn_on() {
    let body = Placed { forward: [0.6, 0.8], ..Placed::default() };
    assert_eq!(body.left(), [-0.8, 0.6]);
}

/// A piece at both ends of which the body is in the same place.
fn piece(centre_m: [f64; 2], forward: [f64; 2], from_s: f64, to_s: f64) -> Piece {
    let [from, to] = [from_s, to_s].map(|at_s| Placed { at_s, centre_m, forward });
    Piece { from, to, near: 0 }
}

/// A body of 0.6 m × 0.8 m reaches 0.5 m. At 0.5 m/s and 2 rad/s its points bend by 2 (0.5 + 2 · 0.5) = 3 m/s²
/// at most, those of a thing seen from it and r away by 2 (0.5 + 2 r). What is as far away at both ends of a
/// piece of s seconds may come nearer by bend · s²/8 in between, a disc of 0.25 m/s by half of the
/// 0.5 + 2 · 0.5 + 0.25 m/s that both do at most. A micrometre more than that is clear, a micrometre less is not
/// certain.
#[test]
fn clear_is_what_cannot_come_near_in_between() {
    const WALL_AHEAD: usize = 2;
    const FIRST_THING: usize = 4;
    let footprint = Footprint { length_m: 0.6, width_m: 0.8 };
    let with = |obstacles: Vec<schemas::Obstacle>, discs: Vec<MovingDisc>| World {
        obstacles,
        discs,
        ..scenario().world
    };
    let clear = |world: &World, piece: &Piece, thing: usize, speeds: [f64; 2]| {
        Certain::new(world, footprint).clear(world, piece, thing, 0.0, speeds)
    };
    let swing = [0.5, 2.0];
    let ahead = [1.0, 0.0];
    let span_s = 0.5;
    for (beyond_m, want) in [(1e-6, true), (-1e-6, false)] {
        // A wall at x = 4.
        let need_m = 3.0 * span_s * span_s / 8.0 + beyond_m;
        let at = piece([4.0 - 0.3 - need_m, 1.0], ahead, 1.25, 1.25 + span_s);
        assert_eq!(clear(&with(vec![], vec![]), &at, WALL_AHEAD, swing), want, "wall, {beyond_m}");

        // A disc of 0.1 m radius that stays ahead, whatever it may do.
        let need_m = 0.5 * 1.75 * span_s + beyond_m;
        let centre_m = [1.0 + 0.3 + need_m + 0.1, 1.0];
        let disc = MovingDisc {
            radius_m: 0.1,
            from_m: centre_m,
            to_m: [centre_m[0], 1.5],
            speed_mps: 0.25,
            start_s: 50.0,
            to_and_fro: false,
        };
        let at = piece([1.0, 1.0], ahead, 1.25, 1.25 + span_s);
        assert_eq!(
            clear(&with(vec![], vec![disc]), &at, FIRST_THING, swing),
            want,
            "disc, {beyond_m}"
        );

        // A square of 0.4 m whose face is ahead.
        let need_m = 3.0 * span_s * span_s / 8.0 + beyond_m;
        let world = with(vec![block(1.0 + 0.3 + need_m + 0.2, 1.0)], vec![]);
        assert_eq!(clear(&world, &at, FIRST_THING, swing), want, "face, {beyond_m}");

        // One that is farther than both can reach, at a turn for which nothing else would tell.
        let moved_m = 0.5 * span_s;
        let apart_m = 0.2 * std::f64::consts::SQRT_2 + 0.5 + moved_m + beyond_m;
        let world = with(vec![block(1.0 + 0.6 * apart_m, 1.0 + 0.8 * apart_m)], vec![]);
        assert_eq!(clear(&world, &at, FIRST_THING, [0.5, 90.0]), want, "far, {beyond_m}");
    }
}

/// The same of a square that stands on its corner, 0.2 m from middle to corner, before the 0.8 m wide front of
/// the body: only that front keeps them apart. Its middle is r = 0.3 + 0.2 m and the gap g away from the body's,
/// its corners 0.2 m more, which the body's 0.5 m/s bring nearer by 0.25 m: g is enough where it is
/// 2 (0.5 + 2 (0.5 + g + 0.2 + 0.25)) · 0.5²/8 = 0.15 + 0.125 g, so from 0.15/0.875 m on.
#[test]
fn a_corner_is_kept_off_by_a_side_of_the_body() {
    let footprint = Footprint { length_m: 0.6, width_m: 0.8 };
    for (beyond_m, want) in [(1e-6, true), (-1e-6, false)] {
        let gap_m = 0.15 / 0.875 + beyond_m;
        let (x_m, y_m) = (1.0 + 0.3 + gap_m + 0.2, 1.0);
        let corners_m =
            vec![[x_m + 0.2, y_m], [x_m, y_m + 0.2], [x_m - 0.2, y_m], [x_m, y_m - 0.2]];
        let world = World { obstacles: vec![schemas::Obstacle { corners_m }], ..scenario().world };
        // From its front, its back, its left and its right.
        for (footprint, forward) in [
            (footprint, [1.0, 0.0]),
            (footprint, [-1.0, 0.0]),
            (Footprint { length_m: 0.8, width_m: 0.6 }, [0.0, -1.0]),
            (Footprint { length_m: 0.8, width_m: 0.6 }, [0.0, 1.0]),
        ] {
            let certain = Certain::new(&world, footprint);
            let at = piece([1.0, 1.0], forward, 1.25, 1.75);
            let said = certain.clear(&world, &at, 4, 0.0, [0.5, 2.0]);
            assert_eq!(said, want, "{forward:?}, {beyond_m}");
        }
    }
}

/// What is as small as rounding is neither.
#[test]
fn what_is_within_the_slack_is_neither_clear_nor_deep() {
    assert_eq!([SLACK_M, 1.01 * SLACK_M].map(is_clear), [false, true]);
    let deep_m = 0.25;
    let border_m = -(deep_m + SLACK_M);
    assert_eq!([border_m, border_m - 1e-10].map(|gap_m| is_deep(gap_m, deep_m)), [false, true]);
}

/// A square of 0.4 m about (2.5, 1.5): its corners are 0.2 √2 m from there.
#[test]
fn a_shape_is_measured_from_its_middle() {
    let shape = Shape::of(&block(2.5, 1.5).corners_m);
    let off_m = length(minus(shape.middle_m, [2.5, 1.5]));
    assert!(off_m < 1e-12, "{:?}", shape.middle_m);
    assert!((shape.radius_m - 0.2 * std::f64::consts::SQRT_2).abs() < 1e-12);
}

/// A quarter of a turn in the middle of which a corner is 2 mm from the wall. Before and after it there are
/// 10.6 cm; the bend of 0.25 √2 · (π/2)² m/s² allows for 10.9 over the second, for a quarter of that over each
/// half.
#[test]
fn what_is_not_certain_at_once_is_in_pieces() {
    let (world, certain) = room();
    let omega_radps = std::f64::consts::FRAC_PI_2;
    for (gap_m, want) in [(0.002, Some(false)), (-0.002, Some(true))] {
        let pose = Pose { y_m: 0.125f64.sqrt() + gap_m, ..MIDDLE };
        let said = certain.touches(&world, &pose, 0.0, Twist { v_mps: 0.0, omega_radps }, 1.0);
        assert_eq!(said, want, "{gap_m}");
    }
}
