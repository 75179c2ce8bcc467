//! What one or two sweeps say.

use super::*;

/// A wall at x = 2: ids 3 and 4 hear 1.755 m. The nearest point of their arcs to the heading is the one
/// along it, at (2, ±0.027); it is drawn nearer by 1 % of the range.
#[test]
fn a_wall_ahead_is_where_it_is() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(3, 1.755), (4, 1.755)]);
    let wanted_m = to_point_m([2.0, 0.027], 0.01755);
    assert!((rig.law(0.0) - wanted_m).abs() < 1e-9, "{} {wanted_m}", rig.law(0.0));
    assert!((rig.safety(0.0) - wanted_m).abs() < 1e-9);
    // 2 − 0.354 by the exact disc; the map is on the near side of it.
    assert!(wanted_m < 2.0 - RADIUS_M && wanted_m > 2.0 - RADIUS_M - 0.02);
}

/// A wall at x = −2, for the rear array (ids 11 and 12 at (−0.241, ∓0.027)), and one at y = 1.5 for
/// the left side (ids 0 and 15 at (±0.147, 0.136), bearing 90°).
#[test]
fn every_side_has_its_sonars() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(11, 1.759), (12, 1.759), (0, 1.364), (15, 1.364)]);
    assert!((rig.law(180.0) - to_point_m([2.0, 0.027], 0.01759)).abs() < 1e-9);
    // Of the side arcs' points those 5° and 10° inwards of their axes are met first.
    let mut wanted_m = f64::INFINITY;
    for (mount_x_m, inwards_deg) in [(0.147, 5.0_f64), (0.144, 5.0), (0.147, 10.0), (0.144, 10.0)] {
        let (sin, cos) = libm::sincos(inwards_deg.to_radians());
        let point_m = [0.136 + 1.364 * cos, mount_x_m - 1.364 * sin];
        wanted_m = wanted_m.min(to_point_m(point_m, 0.01364));
    }
    assert!((rig.law(90.0) - wanted_m).abs() < 1e-9, "{} {wanted_m}", rig.law(90.0));
    // The wall's exact distance, and how far the map may stay below: 1 % of the range and what the arcs
    // bend towards the robot.
    assert!(wanted_m < 1.5 - RADIUS_M && wanted_m > 1.5 - RADIUS_M - 0.03);
    assert_eq!(rig.law(0.0), f64::INFINITY);
}

/// Nothing has fired, then half of the sonars, then all. Ids 0–7 and 8–15 fire in pairs.
#[test]
fn what_has_not_been_looked_at_is_unknown() {
    let mut rig = Rig::new();
    assert!(rig.law(0.0).is_nan());
    assert_eq!(rig.safety(0.0), 0.0);
    assert!(rig.map.dead() && !rig.map.heard_all());
    for id in 0..8 {
        assert!(!rig.map.heard_all());
        rig.say(id, 5.0, false);
        rig.say(8 + id, 5.0, false);
        rig.wait(40);
        rig.advance();
        assert!(!rig.map.dead());
        // Ahead is known once ids 3 and 4 have both fired: 0° is where their cones meet.
        assert_eq!(rig.law(0.0).is_nan(), id < 4, "{id}");
    }
    assert!(rig.map.heard_all());
    for deg in (0..360).step_by(5) {
        assert_eq!(rig.law(f64::from(deg)), f64::INFINITY);
        assert_eq!(rig.safety(f64::from(deg)), f64::INFINITY);
    }
}

/// NaN, zero, negative and impossible ranges blind their cone until its next valid reading; what is
/// remembered does not make it known.
#[test]
fn a_bad_reading_blinds_its_cone() {
    for bad in [f64::NAN, 0.0, -0.3, f64::INFINITY, 9.0] {
        let mut rig = Rig::new();
        rig.sweep_twice(&[(3, 1.755), (4, 1.755)]);
        rig.wait(20);
        rig.say(3, bad, true);
        assert!(rig.law(10.0).is_nan(), "{bad}");
        assert_eq!(rig.safety(10.0), 0.0, "{bad}");
        assert!(rig.law(-10.0).is_finite(), "{bad}");
        rig.wait(20);
        rig.say(3, 1.755, true);
        assert!(rig.law(10.0).is_finite(), "{bad}");
    }
}

/// "5.0 m, no echo" is free; the same range as an echo is something 5 m away.
#[test]
fn silence_is_free_only_if_the_device_says_so() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[]);
    assert_eq!(rig.law(10.0), f64::INFINITY);
    rig.sweep_twice(&[(3, 5.0)]);
    rig.wait(20);
    rig.sweep_twice(&[(3, 5.0)]);
    assert!(rig.law(10.0) < 5.0);
}

/// Below 0.12 m the sonar's face itself is where the obstacle is, which is inside the body's disc. One
/// reading stops the safety layer, the second reaches the law.
#[test]
fn too_near_to_tell_is_contact() {
    let mut rig = Rig::new();
    rig.sweep(&[(3, 0.11)]);
    assert!(rig.safety(0.0) < 0.0);
    assert_eq!(rig.law(0.0), f64::INFINITY);
    rig.wait(320);
    rig.sweep(&[(3, 0.10)]);
    // Free travel is counted from where the disc would first touch the point (0.245, 0.027), which lies
    // inside it: from −x that is half a chord before. Backwards leads away from it.
    let half_chord_m = libm::sqrt(RADIUS_M * RADIUS_M - 0.027 * 0.027);
    assert!((rig.law(0.0) - (0.245 - half_chord_m)).abs() < 1e-9, "{}", rig.law(0.0));
    assert_eq!(rig.law(180.0), f64::INFINITY);
}

/// At 70° no sonar looks. The one at 50° (id 1, mount (0.193, 0.119)) hears 1.5 m, so the gap holds
/// a point in that direction, 1.5 m beyond the mount's reach along it: 0.193 cos 70° + 0.119 sin 70° +
/// 1.5. The point itself lies on the ray, so the disc meets it 0.354 m and 1 % of 1.5 m before.
#[test]
fn the_gaps_go_by_their_neighbours() {
    for (id, deg) in [(1, 70.0_f64), (6, -70.0), (14, 110.0), (9, -110.0)] {
        let mut rig = Rig::new();
        rig.sweep_twice(&[(id, 1.5)]);
        let (sin, cos) = libm::sincos(70_f64.to_radians());
        let mount_m = if deg.abs() < 90.0 { [0.193, 0.119] } else { [0.189, 0.119] };
        let wanted_m = mount_m[0] * cos + mount_m[1] * sin + 1.5 - RADIUS_M - 0.015;
        assert!((rig.law(deg) - wanted_m).abs() < 0.005, "{} {wanted_m}", rig.law(deg));
        assert!(rig.law(deg) <= wanted_m + 1e-9, "the arc beside it may be met a little earlier");
        // On the other side nothing was heard.
        assert_eq!(rig.law(-deg), f64::INFINITY);
    }
}

/// A gap that only an unconfirmed echo fills is open for the law and filled for the safety layer; after
/// 0.5 s it is open again.
#[test]
fn a_gap_needs_a_confirmed_echo_for_the_law() {
    let mut rig = Rig::new();
    rig.sweep(&[(1, 1.5)]);
    assert_eq!(rig.law(70.0), f64::INFINITY);
    assert!(rig.safety(70.0) < 1.5);
    rig.wait(320);
    rig.sweep(&[]);
    rig.wait(200);
    assert_eq!(rig.safety(70.0), f64::INFINITY);
}

/// Ids 3 and 4 fire 40 ms apart, which is too near to be told from cross-talk; their next firing
/// 0.32 s later confirms them.
#[test]
fn confirmation_takes_another_firing() {
    let mut rig = Rig::new();
    rig.sweep(&[]);
    rig.wait(40);
    rig.say(3, 1.755, true);
    rig.wait(40);
    rig.say(4, 1.755, true);
    assert_eq!(rig.law(0.0), f64::INFINITY);
    assert!(rig.safety(0.0) < 1.65);
    rig.wait(20);
    // 60 ms after id 3, 20 ms after id 4.
    rig.say(4, 1.755, true);
    assert!(rig.law(0.0) < 1.65);
}

/// Ranges that differ by more than 0.10 m + 3 % do not confirm each other: 1.755 allows 0.153.
#[test]
fn confirmation_takes_a_like_range() {
    for (second_m, like) in [(1.9, true), (1.92, false), (1.61, true), (1.59, false)] {
        let mut rig = Rig::new();
        rig.sweep(&[(3, second_m)]);
        rig.wait(320);
        rig.sweep(&[(3, 1.755)]);
        assert_eq!(rig.law(0.0).is_finite(), like, "{second_m}");
    }
}

/// Obstacles may come nearer by 0.3 m/s times the age until they are looked at again, for the safety
/// layer: 0.3 m/s · 0.4 s = 0.12 m. The law goes by where they were heard.
#[test]
fn young_echoes_may_be_moving() {
    let mut rig =
        Rig::with(EchoMapSettings { inflation_m: RADIUS_M, v_disc_mps: 0.3, lease_s: 0.5 });
    rig.sweep_twice(&[(3, 1.755), (4, 1.755)]);
    let still_m = to_point_m([2.0, 0.027], 0.01755);
    assert!((rig.safety(0.0) - still_m).abs() < 1e-9);
    rig.wait(400);
    let wanted_m = to_point_m([2.0, 0.027], 0.01755 + 0.12);
    assert!((rig.safety(0.0) - wanted_m).abs() < 1e-9);
    assert!((rig.law(0.0) - still_m).abs() < 1e-9);
}

/// What has echoed from one place for a second stands there, also for the safety layer; a second of
/// echoes from nearer and nearer does not say so. 0.055 m per sweep is more than the 0.03 m + 2 % within
/// which a range of 1 m is repeated.
#[test]
fn what_has_stood_for_a_second_is_not_on_its_way() {
    let moved_m = |per_sweep_m: f64| {
        let settings = EchoMapSettings { inflation_m: RADIUS_M, v_disc_mps: 0.3, lease_s: 0.5 };
        let mut rig = Rig::with(settings);
        let mut range_m = 1.0 + 5.0 * per_sweep_m;
        for _ in 0..5 {
            range_m -= per_sweep_m;
            rig.sweep(&[(3, range_m), (4, range_m)]);
            rig.wait(320);
        }
        rig.law(0.0) - rig.safety(0.0)
    };
    assert!(moved_m(0.0).abs() < 1e-9, "{}", moved_m(0.0));
    // 0.3 m/s · 0.32 s, straight ahead but for the 0.027 m by which the sonars stand aside.
    assert!((moved_m(0.055) - 0.096).abs() < 1e-3, "{}", moved_m(0.055));
}

/// Sonar 3 hears the wall at 1.755 m, and a sweep later something at 0.3 m: the sound of another sonar, or
/// someone. While nothing else says so it is passed over; said again it blocks, for law and safety layer.
#[test]
fn an_echo_out_of_nowhere_waits_for_another() {
    let mut rig = Rig::new();
    rig.sweep_twice(&[(3, 1.755), (4, 1.755)]);
    let free_m = rig.safety(10.0);
    rig.wait(320);
    rig.sweep(&[(3, 0.3), (4, 1.755)]);
    assert_eq!(rig.safety(10.0), free_m);
    assert!(rig.map.near_points().all(|(point, _)| point.centre_m[0] > 1.0));
    rig.wait(320);
    rig.sweep(&[(3, 0.3), (4, 1.755)]);
    assert!(rig.safety(10.0) < 0.25 && rig.law(10.0) < 0.25);
}

/// The same counts at once if a sonar beside hears something there, if it came nearer by no more than what
/// can approach in a sweep, if the sonar heard nothing before, and if nobody knows what is beside.
#[test]
fn an_echo_that_may_be_something_counts_at_once() {
    let after = |before: &[(u8, f64)], now: &[(u8, f64)], deaf: Option<u8>| {
        let mut rig = Rig::new();
        rig.sweep_twice(before);
        rig.wait(320);
        if let Some(id) = deaf {
            rig.say(id, f64::NAN, true);
        }
        for (id, range_m) in now {
            rig.wait(20);
            rig.say(*id, *range_m, true);
        }
        rig.advance();
        // The middle of the arc of sonar 3 at 0.6 m.
        let (sin, cos) = libm::sincos(10_f64.to_radians());
        let [x, y] = [0.245 + 0.6 * cos, 0.027 + 0.6 * sin];
        let there = |[a, b]: [f64; 2]| libm::hypot(a - x, b - y) < 1e-6;
        rig.map.near_points().any(|(point, _)| there(point.centre_m))
    };
    // From 1.5 m to 0.6 m, alone: passed over.
    let far = [(3, 1.5)];
    assert!(!after(&far, &[(3, 0.6)], None));
    // One of the two sonars on either side heard as much, or nearer; in 0.02 s nothing moves by 0.05 m.
    for beside in [1, 2, 4, 5] {
        let before = [(3, 1.5), (beside, 1.5)];
        assert!(after(&before, &[(beside, 0.85), (3, 0.6)], None), "{beside}");
        assert!(after(&before, &[(beside, 0.4), (3, 0.6)], None), "{beside}");
    }
    assert!(!after(&[(3, 1.5), (2, 1.5)], &[(2, 0.95), (3, 0.6)], None));
    for beside in [0, 6] {
        assert!(!after(&[(3, 1.5), (beside, 0.6)], &[(beside, 0.6), (3, 0.6)], None), "{beside}");
    }
    // By 0.5 m in 0.34 s: it may be what was heard, 0.3 m nearer for its width.
    assert!(after(&[(3, 1.1)], &[(3, 0.6)], None));
    assert!(!after(&[(3, 1.2)], &[(3, 0.6)], None));
    // After silence.
    assert!(after(&[], &[(3, 0.6)], None));
    // Nobody knows what is to its right, or its left.
    assert!(after(&far, &[(3, 0.6)], Some(4)));
    assert!(after(&far, &[(3, 0.6)], Some(2)));
}

/// What was heard 0.7 s ago or longer is not contradicted.
#[test]
fn an_echo_after_a_silence_counts_at_once() {
    let counts_after = |ms: u64| {
        let mut rig = Rig::new();
        rig.sweep_twice(&[(3, 1.5)]);
        rig.wait(ms);
        rig.say(3, 0.6, true);
        rig.advance();
        rig.map.near_points().any(|(point, _)| point.centre_m[0] < 1.0)
    };
    assert!(!counts_after(680));
    assert!(counts_after(720));
}

/// Someone is heard at 0.4 m by the sonar at 50°, goes through the blind gap while that hears the wall again,
/// and is then heard by the one at 90°. That counts at once, up to 1.5 s later.
#[test]
fn who_comes_out_of_a_blind_gap_counts_at_once() {
    let heard_after = |ms: u64| {
        let mut rig = Rig::new();
        let wall = [(0, 2.0), (1, 2.0), (2, 2.0), (14, 2.0), (15, 2.0)];
        rig.sweep_twice(&wall);
        rig.wait(320);
        rig.say(1, 0.4, true);
        // Every 0.3 s, so that what was said last is recent.
        for _ in 0..ms / 300 {
            rig.wait(300);
            rig.sweep(&wall);
        }
        rig.wait(20);
        rig.say(0, 0.35, true);
        rig.advance();
        // What the sonar at 50° heard is farther ahead.
        let beside = |[x, y]: [f64; 2]| x < 0.3 && y < 1.0;
        rig.map.near_points().any(|(point, _)| beside(point.centre_m))
    };
    assert!(heard_after(300) && heard_after(1200));
    assert!(!heard_after(1500));
}
