//! What becomes of it while the robot moves and time goes by.

use super::*;

/// The wall at x = 2 is heard; then the robot turns left by 90° in 0.4 s and no sonar hears it any
/// more. It is still 2 m away along world angle 0, less the drift of the turn: 0.03 · 0.2 · π/2 m.
#[test]
fn an_echo_stays_where_it_was_when_the_robot_turns() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(3, 1.755), (4, 1.755)]);
    rig.go(400, 0.0, 90_f64.to_radians());
    rig.sweep(&[]);
    let drift_m = 0.03 * 0.2 * 90_f64.to_radians();
    let wanted_m = to_point_m([2.0, 0.027], 0.01755 + drift_m);
    assert!((rig.law(0.0) - wanted_m).abs() < 1e-9, "{} {wanted_m}", rig.law(0.0));
    assert_eq!(rig.law(90.0), f64::INFINITY);
    assert!(rig.safety(0.0) == rig.law(0.0));
}

/// After 0.5 m of driving towards it the wall is 0.5 m nearer, and 0.015 m more for the drift.
#[test]
fn an_echo_stays_where_it_was_when_the_robot_drives() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(3, 1.755), (4, 1.755)]);
    rig.go(1_000, 0.5, 0.0);
    rig.sweep(&[]);
    let wanted_m = to_point_m([1.5, 0.027], 0.01755 + 0.015);
    assert!((rig.law(0.0) - wanted_m).abs() < 1e-9, "{} {wanted_m}", rig.law(0.0));
}

/// Drift is reckoned to be no more than 0.12 m: 4 m of driving, in 4.8 s.
#[test]
fn drift_has_a_limit() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(11, 1.759)]);
    rig.go(4_800, 4.8, 0.0);
    rig.sweep(&[]);
    let backwards = rig.law(180.0);
    let wanted_m = to_point_m([2.0 + 4.8, 0.027], 0.01759 + 0.12);
    assert!((backwards - wanted_m).abs() < 1e-9, "{backwards} {wanted_m}");
}

/// A reading is placed where the robot was when the sonar fired, not where it is when the reading
/// comes in: driving at 1 m/s, 0.1 s later.
#[test]
fn an_echo_is_placed_at_its_own_firing() {
    let mut rig = Rig::new();
    rig.sweep(&[]);
    rig.go(320, 0.32, 0.0);
    let fired = at(rig.t_ms);
    rig.go(100, 0.1, 0.0);
    let echo = SonarEcho { id: 3, range_m: 1.755, echo: true, fired };
    let scan = SonarScan { stamp: at(rig.t_ms), echoes: vec![echo] };
    rig.map.observe(&scan, &rig.odometry);
    let wanted_m = to_point_m([1.9, 0.027], 0.01755);
    assert!((rig.safety(0.0) - wanted_m).abs() < 1e-9, "{} {wanted_m}", rig.safety(0.0));
}

/// The reading of an instant may come before the odometry of that instant. Placed at once it would be
/// extrapolated from the speed of before; it waits for the step.
#[test]
fn an_echo_waits_for_its_odometry() {
    let mut rig = Rig::new();
    rig.sweep(&[]);
    rig.wait(300);
    // The robot sets off at 1 m/s; the sonar that fires 20 ms later is heard before the encoders.
    let echo = SonarEcho { id: 3, range_m: 1.755, echo: true, fired: at(320) };
    rig.map.observe(&SonarScan { stamp: at(320), echoes: vec![echo] }, &rig.odometry);
    rig.go(20, 0.02, 0.0);
    let wanted_m = to_point_m([2.0, 0.027], 0.01755 + 0.03 * 0.02);
    assert!((rig.safety(0.0) - wanted_m).abs() < 1e-9, "{} {wanted_m}", rig.safety(0.0));
}

/// Unconfirmed points last 0.4 s, confirmed ones 5 s; what two other firings have heard at the place 20 s while
/// the odometer stands within 0.3 m.
#[test]
fn echoes_are_forgotten() {
    let mut rig = Rig::new();
    rig.sweep(&[(3, 1.755)]);
    rig.wait(400);
    rig.sweep(&[]);
    assert!(rig.safety(0.0).is_finite());
    rig.wait(20);
    assert_eq!(rig.safety(0.0), f64::INFINITY);

    let lives = [(2, 0.0, 5_000), (3, -0.31, 5_000), (3, -0.29, 20_000), (3, 0.0, 20_000)];
    for (firings, along_m, life_ms) in lives {
        let mut rig = Rig::new();
        rig.sweep_twice(&[(3, 1.755)]);
        for _ in 2..firings {
            rig.wait(320);
            rig.sweep(&[(3, 1.755)]);
        }
        rig.go(1_000, along_m, 0.0);
        rig.wait(life_ms - 1_000);
        rig.sweep(&[]);
        assert!(rig.law(0.0).is_finite(), "{firings} {along_m}");
        rig.wait(20);
        assert_eq!(rig.law(0.0), f64::INFINITY, "{firings} {along_m}");
    }
}

/// Something false is heard at 0.30 m, and what stands at 0.36 m twice after it: near enough to confirm what is
/// false, but not at its place. After 5 s only what stands there is left.
#[test]
fn who_stands_beside_does_not_keep_a_false_echo() {
    let mut rig = Rig::new();
    for range_m in [0.30, 0.36, 0.36] {
        rig.sweep(&[(3, range_m)]);
        rig.wait(320);
    }
    let nearest_m = |rig: &mut Rig| {
        rig.advance();
        let ahead = |(disc, _): (Disc, bool)| {
            libm::hypot(disc.centre_m[0] - 0.245, disc.centre_m[1] - 0.027)
        };
        rig.map.near_points().map(ahead).fold(f64::INFINITY, f64::min)
    };
    assert!((nearest_m(&mut rig) - 0.30).abs() < 1e-6);
    rig.wait(5_000);
    assert!((nearest_m(&mut rig) - 0.36).abs() < 1e-6);
}

/// What came as near as 0.5 m is remembered for 0.72 s while its sonar is silent, for it may be someone who
/// comes nearer; once that sonar hears something else, or from farther away, for 0.4 s like all else.
#[test]
fn someone_near_is_not_forgotten_for_one_silence() {
    for (range_m, heard_since, life_ms) in
        [(0.4, None, 720), (0.4, Some(3.0), 400), (0.6, None, 400)]
    {
        let mut rig = Rig::new();
        rig.sweep(&[(3, range_m)]);
        let near = |rig: &mut Rig| {
            rig.advance();
            rig.map.near_points().any(|(disc, _)| disc.centre_m[0] < 1.0)
        };
        rig.wait(320);
        match heard_since {
            Some(range_m) => rig.say(3, range_m, true),
            None => rig.say(3, 5.0, false),
        }
        rig.wait(life_ms - 320);
        assert!(near(&mut rig), "{range_m} {heard_since:?}");
        rig.wait(20);
        assert!(!near(&mut rig), "{range_m} {heard_since:?}");
    }
}

/// Something is confirmed, then is gone: the same sonars, ids 3 and 4, hear a wall behind. Their first echo
/// is not confirmed and looks through nothing; of what follows two take away what was heard from farther
/// than 1 m, edges of the cones too, and four what was heard from nearer.
#[test]
fn what_is_looked_through_is_gone() {
    for (near_m, left) in [(1.255, [10, 10, 0, 0, 0]), (0.755, [10, 10, 10, 10, 0])] {
        let mut rig = Rig::new();
        rig.sweep_twice(&[(3, near_m), (4, near_m)]);
        let count = |rig: &Rig| rig.map.points.iter().filter(|p| p.range_m == near_m).count();
        assert!((rig.law(0.0) - to_point_m([near_m + 0.245, 0.027], 0.01 * near_m)).abs() < 1e-9);
        for left in left {
            rig.wait(320);
            rig.sweep(&[(3, 2.755), (4, 2.755)]);
            assert_eq!(count(&rig), left, "{near_m}");
        }
        assert!(rig.law(0.0) > 2.0, "{}", rig.law(0.0));
    }
}

/// Another sonar takes away only what is within 8° of its axis: turned left by 20°, id 4 looks where id 3
/// has, from 3 cm beside, which is 1.4° at 1.25 m. Of five points 5° apart the outer two stay.
#[test]
fn another_sonar_looks_through_the_middle_of_its_cone() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(3, 1.255)]);
    rig.go(320, 0.0, 20_f64.to_radians());
    for _ in 0..3 {
        rig.sweep(&[(4, 2.755)]);
        rig.wait(320);
    }
    assert_eq!(rig.map.points.iter().filter(|point| point.range_m == 1.255).count(), 2);
}

/// Cross-talk at 0.13 m before a wall at 0.28 m: close by, a difference of 0.15 m confirms nothing, as far
/// away one of 0.10 m does. 0.04 m and a fifth of the range are 0.066 m, or 0.096 m at 0.28 m.
#[test]
fn close_by_echoes_have_to_agree_better() {
    for (range_m, confirmed) in [(0.13, false), (0.20, true)] {
        let mut rig = Rig::new();
        rig.sweep_twice(&[(6, 0.28)]);
        rig.wait(320);
        rig.sweep(&[(6, range_m)]);
        let heard = rig.map.points.iter().find(|point| point.range_m == range_m);
        assert_eq!(heard.map(|point| point.confirmed), Some(confirmed), "{range_m}");
    }
}

/// What may move does so at 0.3 m/s until its sonar has heard an echo again, silence left aside, for 0.7 s.
#[test]
fn what_may_have_moved_is_reckoned_to() {
    let settings = EchoMapSettings { inflation_m: RADIUS_M, v_disc_mps: 0.3, lease_s: 0.5 };
    let moving = |rig: &Rig| rig.map.near_points().filter(|(_, may_move)| *may_move).count();
    let mut rig = Rig::with(settings);
    rig.sweep(&[(3, 1.755)]);
    rig.wait(320);
    rig.sweep(&[(3, 2.5)]);
    assert_eq!(moving(&rig), 5, "the last echo alone");
    rig.wait(420);
    rig.sweep(&[]);
    assert_eq!(moving(&rig), 0, "forgotten, unconfirmed as it is");

    let mut rig = Rig::with(settings);
    rig.sweep_twice(&[(3, 1.755)]);
    for (wait_ms, count) in [(320, 5), (360, 5), (20, 0)] {
        rig.wait(wait_ms);
        rig.sweep(&[]);
        assert_eq!(moving(&rig), count, "{wait_ms}");
    }
}

/// Sound that comes back by a detour is heard from farther away each time: nothing confirms it, and it
/// looks through nothing.
#[test]
fn an_unconfirmed_echo_looks_through_nothing() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(3, 0.755)]);
    let heard_m = rig.law(10.0);
    for far_m in [1.5, 2.0, 2.5, 3.0, 3.5, 4.0] {
        rig.wait(320);
        rig.sweep(&[(3, far_m)]);
        assert!((rig.law(10.0) - heard_m).abs() < 1e-12);
    }
}

/// Driving for 1 m along a wall on the left at y = 1.5, heard by ids 0 and 15 at 1.364 m. The points on
/// their axes lie on the wall; its normal is 90°, to within half a cell of the transform.
#[test]
fn a_wall_that_is_driven_along_is_a_face() {
    let mut rig = Rig::new();
    assert_eq!(rig.map.face_direction_rad(&rig.pose()), None);
    rig.sweep(&[(0, 1.364), (15, 1.364)]);
    assert_eq!(rig.map.face_direction_rad(&rig.pose()), None);
    for _ in 0..10 {
        rig.go(320, 0.1, 0.0);
        rig.sweep(&[(0, 1.364), (15, 1.364)]);
    }
    let face_deg = rig.map.face_direction_rad(&rig.pose()).unwrap().to_degrees();
    assert!((face_deg - 90.0).abs() <= 2.5, "{face_deg}");
}

/// Silence carves nothing: a wall at a slant is silent too.
#[test]
fn silence_takes_nothing_away() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(3, 0.755)]);
    let heard_m = rig.law(10.0);
    for _ in 0..5 {
        rig.wait(320);
        rig.sweep(&[]);
    }
    assert!((rig.law(10.0) - heard_m).abs() < 1e-12);
}

/// An echo that is repeated a hundred times at rest stays five points per sonar.
#[test]
fn repeats_take_no_room() {
    let mut rig = Rig::new();
    let echoes: Vec<(u8, f64)> = (0..16).map(|id| (id, 1.5)).collect();
    for _ in 0..100 {
        rig.sweep(&echoes);
        rig.wait(320);
        rig.advance();
    }
    assert!(rig.map.points.iter().count() <= 16 * 5);
}

/// More readings at once than may wait are placed as they come; nothing grows.
#[test]
fn a_scan_may_be_of_any_length() {
    let mut rig = Rig::new();
    let room = rig.map.pending.capacity();
    let echo = |i: u8| SonarEcho { id: i % 16, range_m: 1.5, echo: true, fired: at(0) };
    let scan = SonarScan { stamp: at(0), echoes: (0..200).map(echo).collect() };
    rig.map.observe(&scan, &rig.odometry);
    assert_eq!(rig.map.pending.capacity(), room);
    rig.advance();
    assert!(rig.map.heard_all());
    assert_eq!(rig.map.points.iter().count(), 16 * 5, "each sonar fires once at a time");
}

/// A reading that comes twice, or late, changes nothing; nor does one of a sonar that does not exist.
#[test]
fn late_readings_are_ignored() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(3, 1.755)]);
    rig.advance();
    let before = state(&rig.map);
    for (id, fired) in [(3, at(320)), (3, at(300)), (16, at(320)), (255, at(320))] {
        let echo = SonarEcho { id, range_m: 0.5, echo: true, fired };
        rig.map.observe(&SonarScan { stamp: at(320), echoes: vec![echo] }, &rig.odometry);
    }
    rig.advance();
    assert_eq!(state(&rig.map), before);
}

/// A clock that is set back makes every age meaningless: the map starts again.
#[test]
fn a_clock_set_back_forgets_the_map() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(3, 1.755)]);
    rig.advance();
    let about = rig.pose();
    rig.map.advance(Time(at(0).0 - 3_600_000_000_000), &rig.odometry, &about);
    assert!(rig.map.dead() && rig.map.law_points().is_empty());
}

/// An echo whose pose is not known is nowhere: its cone is unknown.
#[test]
fn without_odometry_nothing_is_known() {
    let mut map =
        EchoMap::new(EchoMapSettings { inflation_m: RADIUS_M, v_disc_mps: 0.3, lease_s: 0.5 });
    let odometry = Odometry::new(Pose::default(), 0.5);
    let echoes = (0..16).map(|id| SonarEcho { id, range_m: 5.0, echo: false, fired: at(0) });
    map.observe(&SonarScan { stamp: at(0), echoes: echoes.collect() }, &odometry);
    map.advance(at(0), &odometry, &Pose::default());
    assert!(map.dead() && !map.heard_all());
}

/// A pose that is no number gives no distance.
#[test]
fn from_nowhere_nothing_is_known() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(3, 1.755)]);
    let nowhere = Pose { x_m: f64::NAN, ..Pose::default() };
    rig.map.advance(at(rig.t_ms), &rig.odometry, &nowhere);
    assert!(rig.map.law_ray_m(&nowhere, 0.0).is_nan());
    assert_eq!(rig.map.safety_ray_m(&nowhere, 0.0), 0.0);
    assert_eq!(rig.map.safety_ray_m(&Pose::default(), f64::NAN), 0.0);
}

pub(super) fn state(map: &EchoMap) -> u64 {
    let mut digest = Digest::default();
    map.fold(&mut digest, SIMULATION_EPOCH);
    digest.value()
}

/// Sonar 3 hears 1 m: an arc from (1.245, 0.027) to (1.185, 0.369), each drawn 0.01 m nearer to the
/// origin. The corner of a square of 0.5 m, (0.25, 0.25), is nearest to the last one, (1.175, 0.366).
/// At x = 1.1 the square covers the arc's second point, (1.231, 0.113), to within 0.119 m of its front
/// edge, and none deeper.
#[test]
fn the_clearance_is_that_of_the_footprint() {
    let mut rig = Rig::new();
    rig.sweep(&[(3, 1.0)]);
    let square = Footprint { length_m: 0.5, width_m: 0.5 };
    let clearance_m = |x_m: f64, theta_rad: f64| {
        rig.map.safety_clearance_m(&square, &Pose { x_m, y_m: 0.0, theta_rad })
    };
    assert!((clearance_m(0.0, 0.0) - libm::hypot(0.925, 0.116)).abs() < 2e-3);
    assert!((clearance_m(1.1, 0.0) + 0.119).abs() < 2e-3);
    // A quarter turn changes nothing about a square; half of that brings its corner forward.
    let quarter = std::f64::consts::FRAC_PI_2;
    assert!((clearance_m(0.0, quarter) - clearance_m(0.0, 0.0)).abs() < 1e-12);
    assert!(clearance_m(0.0, 0.5 * quarter) < clearance_m(0.0, 0.0));
    assert!(clearance_m(f64::NAN, 0.0).is_nan());
    let empty = Rig::new();
    assert_eq!(empty.map.safety_clearance_m(&square, &Pose::default()), f64::INFINITY);
}
