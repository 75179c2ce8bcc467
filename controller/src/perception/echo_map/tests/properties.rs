//! What holds whatever is heard.

use proptest::prelude::*;

use super::memory::state;
use super::*;

fn any_range() -> impl Strategy<Value = f64> {
    prop_oneof![6 => 0.0..5.2, 1 => proptest::num::f64::ANY]
}

/// Something that happens to a robot.
#[derive(Clone, Debug)]
enum Happening {
    Heard { id: u8, range_m: f64, echo: bool, late_ms: u64 },
    Moved { ms: u64, along_m: f64, turn_rad: f64 },
}

fn any_happening() -> impl Strategy<Value = Happening> {
    prop_oneof![
        3 => (0_u8..20, any_range(), any::<bool>(), 0_u64..100).prop_map(
            |(id, range_m, echo, late_ms)| Happening::Heard { id, range_m, echo, late_ms }
        ),
        1 => (0_u64..10, -0.5..0.5, -1.0..1.0).prop_map(|(steps, along_m, turn_rad)| {
            Happening::Moved { ms: 20 * steps, along_m, turn_rad }
        }),
    ]
}

fn live(rig: &mut Rig, happenings: &[Happening]) {
    for happening in happenings {
        match *happening {
            Happening::Heard { id, range_m, echo, late_ms } => {
                let fired = at(rig.t_ms.saturating_sub(late_ms));
                let echo = SonarEcho { id, range_m, echo, fired };
                let scan = SonarScan { stamp: at(rig.t_ms), echoes: vec![echo] };
                rig.map.observe(&scan, &rig.odometry);
            }
            Happening::Moved { ms, along_m, turn_rad } => {
                rig.go(ms, along_m, turn_rad);
                rig.advance();
            }
        }
    }
    rig.advance();
}

proptest! {
    /// Nothing panics; the safety layer's ray is never NaN and never longer than the law's; the unknown
    /// is 0 for the one and NaN for the other; what is remembered is bounded.
    #[test]
    fn rays_are_always_usable(
        happenings in prop::collection::vec(any_happening(), 0..300),
        angle_rad in -10.0..10.0,
    ) {
        let mut rig = Rig::with(EchoMapSettings { inflation_m: RADIUS_M, v_disc_mps: 0.3, lease_s: 0.5 });
        live(&mut rig, &happenings);
        let from = rig.pose();
        let law_m = rig.map.law_ray_m(&from, angle_rad);
        let safety_m = rig.map.safety_ray_m(&from, angle_rad);
        prop_assert!(!safety_m.is_nan());
        prop_assert!(law_m.is_nan() || safety_m <= law_m);
        prop_assert_eq!(law_m.is_nan(), !rig.map.known(angle_rad - from.theta_rad));
        prop_assert!(!law_m.is_nan() || safety_m == 0.0);
        prop_assert!(rig.map.points.iter().count() <= 1024);
        prop_assert!(rig.map.law_points().len() <= 240 && rig.map.safety_points().len() <= 240);
    }

    /// The echo that is named is the one that ends the ray, bit for bit; where the ray ends nowhere, or
    /// nothing is known, none is named.
    #[test]
    fn the_echo_that_is_named_ends_the_ray(
        happenings in prop::collection::vec(any_happening(), 0..300),
        angle_rad in -10.0..10.0,
    ) {
        let mut rig = Rig::with(EchoMapSettings { inflation_m: RADIUS_M, v_disc_mps: 0.3, lease_s: 0.5 });
        live(&mut rig, &happenings);
        let from = rig.pose();
        let Rig { map, odometry, .. } = &rig;
        let finite = |ray_m: f64| Some(ray_m).filter(|ray_m| ray_m.is_finite());
        let law = map.law_limit(odometry, &from, angle_rad);
        prop_assert_eq!(law.map(|echo| echo.free_m), finite(map.law_ray_m(&from, angle_rad)));
        prop_assert!(law.is_none_or(|echo| echo.confirmed));
        let body = Footprint { length_m: 0.5, width_m: 0.4 };
        let travel = map.law_travel_limit(&body, odometry, &from, angle_rad);
        let travel_m = map.law_travel_m(&body, &from, angle_rad);
        prop_assert_eq!(travel.map(|echo| echo.free_m), finite(travel_m));
        let safety = map.safety_limit(odometry, &from, angle_rad);
        if map.known(angle_rad - from.theta_rad) {
            let safety_m = map.safety_ray_m(&from, angle_rad);
            prop_assert_eq!(safety.map(|echo| echo.free_m), finite(safety_m));
        } else {
            prop_assert!(law.is_none() && safety.is_none());
        }
    }

    /// Whatever came before, an echo that is heard twice blocks the way to each point of its arc; for the
    /// safety layer it does so at once, unless it contradicts what its sonar has just heard.
    #[test]
    fn an_echo_blocks_its_arc(
        happenings in prop::collection::vec(any_happening(), 0..60),
        id in 0_u8..16,
        range_m in 0.15..4.9,
        off_axis_deg in -10.0..10.0_f64,
        later in any::<bool>(),
    ) {
        let mut rig = Rig::with(EchoMapSettings { inflation_m: RADIUS_M, v_disc_mps: 0.3, lease_s: 0.5 });
        live(&mut rig, &happenings);
        // What was heard so long ago contradicts nothing.
        rig.go(if later { 720 } else { 20 }, 0.0, 0.0);
        rig.sweep(&[(id, range_m)]);
        rig.advance();
        let from = rig.pose();
        let mount = SONARS[usize::from(id)];
        let [x, y] = unit(from.theta_rad + (mount.bearing_deg + off_axis_deg).to_radians());
        let [mount_x_m, mount_y_m] = from.transform(mount.x_m, mount.y_m);
        let [dx, dy] =
            [mount_x_m + range_m * x - from.x_m, mount_y_m + range_m * y - from.y_m];
        let (angle_rad, distance_m) = (libm::atan2(dy, dx), libm::hypot(dx, dy));
        // Half-way between two of the arc's points, 2.5° off each, the disc dips by R − √(R² − c²).
        let aside_m = range_m * libm::sin(2.5_f64.to_radians()) + 0.01;
        let blocked_m = distance_m - libm::sqrt(RADIUS_M * RADIUS_M - aside_m * aside_m);
        // Seen from the centre the arc turns by a little: the mount is up to 0.25 m away from it.
        let allowed_m = blocked_m + 0.05;
        let safety_m = rig.map.safety_ray_m(&from, angle_rad);
        prop_assert!(safety_m <= allowed_m || !later, "{} {}", safety_m, allowed_m);

        rig.wait(320);
        rig.sweep(&[(id, range_m)]);
        rig.advance();
        for ray_m in [rig.map.law_ray_m(&from, angle_rad), rig.map.safety_ray_m(&from, angle_rad)] {
            prop_assert!(ray_m <= allowed_m, "{} {}", ray_m, allowed_m);
        }
    }

    /// One more echo never makes a way longer, but for what repeating a point moves it, which is no
    /// more than 0.03 m + 2 %, and the margin of its age.
    #[test]
    fn one_more_echo_makes_no_way_longer(
        first in prop::collection::vec((0_u8..16, 0.15..4.9), 1..16),
        second_id in 0_u8..16,
        second_m in 0.15..4.9,
        angle_deg in -180.0..180.0_f64,
    ) {
        // Both the way to a point and its edge beside the ray may move; the latter counts the more the
        // more the disc only grazes the point, so a disc that is smaller by as much is asked too.
        let moved_m = 0.03 + 0.02 * 5.0 + 0.05;
        let ways_m = |inflation_m: f64| {
            let mut rig = Rig::with(EchoMapSettings { inflation_m, v_disc_mps: 0.0, lease_s: 0.5 });
            rig.sweep_twice(&first);
            let before_m = [rig.law(angle_deg), rig.safety(angle_deg)];
            rig.wait(60);
            rig.say(second_id, second_m, true);
            [before_m, [rig.law(angle_deg), rig.safety(angle_deg)]]
        };
        let [before_m, after_m] = ways_m(RADIUS_M);
        let [_, smaller_m] = ways_m(RADIUS_M - moved_m);
        for i in 0..2 {
            prop_assert!(after_m[i] <= before_m[i] + moved_m || after_m[i] <= smaller_m[i]);
        }
    }

    /// The same happenings leave the same state, bit for bit.
    #[test]
    fn the_map_is_a_function_of_what_happened(
        happenings in prop::collection::vec(any_happening(), 0..100),
    ) {
        let (mut a, mut b) = (Rig::new(), Rig::new());
        live(&mut a, &happenings);
        live(&mut b, &happenings);
        prop_assert_eq!(state(&a.map), state(&b.map));
    }
}
