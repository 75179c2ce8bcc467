use super::*;
use schemas::{HalfPlane, MovingDisc, NS_PER_S, Obstacle, SIMULATION_EPOCH};

const HOME: Pose = Pose { x_m: 0.0, y_m: 0.0, theta_rad: 0.0 };

/// Faces only at what is met squarely enough; nothing at random.
const HARD_OF_HEARING: SonarNoise = SonarNoise {
    half_cone_deg: 10.0,
    range_fraction: 0.0,
    dropout: 0.0,
    cross_talk: 0.0,
    incidence_limit_deg: 35.0,
    corner_echo: 0.0,
    long_echo: 0.0,
};

fn wall(normal: [f64; 2], offset_m: f64) -> World {
    World { room: vec![HalfPlane { normal, offset_m }], ..World::default() }
}

fn wall_at(angle_deg: f64, offset_m: f64) -> World {
    let (sin, cos) = libm::sincos(angle_deg.to_radians());
    wall([cos, sin], offset_m)
}

/// One full sweep of all sixteen from one pose.
fn sweep(world: &World, noise: Option<SonarNoise>, pose: &Pose) -> [SonarEcho; 16] {
    let mut sonars = Sonars::new(world, noise, 5);
    let mut echoes: Vec<SonarEcho> = (0..8)
        .flat_map(|slot| sonars.scan(slot, SIMULATION_EPOCH, 0.0, pose, world).echoes)
        .collect();
    echoes.sort_by_key(|echo| echo.id);
    echoes.try_into().expect("eight slots of two sonars")
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// One sonar of each array fires in turn; after eight slots all have, and it starts over. The
/// firing stamp is the slot's instant.
#[test]
fn arrays_fire_in_turn() {
    let world = wall([1.0, 0.0], 2.0);
    let mut sonars = Sonars::new(&world, None, 0);
    for slot in 0..20 {
        let stamp = SIMULATION_EPOCH.after_ns(slot * NS_PER_S / 25);
        let scan = sonars.scan(slot, stamp, 0.0, &HOME, &world);
        let ids: Vec<u8> = scan.echoes.iter().map(|echo| echo.id).collect();
        let first = (slot % 8) as u8;
        assert_eq!(ids, [first, 8 + first]);
        assert_eq!(scan.stamp, stamp);
        assert!(scan.echoes.iter().all(|echo| echo.fired == stamp));
    }
}

/// Hand-computed, a perfect sonar before a wall 2 m ahead of the robot's centre: ids 3 and 4 (±10°,
/// mounted 0.245 m ahead) have the wall's foot on their cone's edge; ids 2 and 5 (±30°, 0.227 m)
/// meet it 20° off; ids 0 and 7 (±90°) look past it at 80° and beyond 5 m; the rear hears nothing.
#[test]
fn flat_wall_ahead() {
    let echoes = sweep(&wall([1.0, 0.0], 2.0), None, &HOME);
    let cos20 = libm::cos(20_f64.to_radians());
    assert!(close(echoes[3].range_m, 2.0 - 0.245) && close(echoes[4].range_m, 2.0 - 0.245));
    assert!(close(echoes[2].range_m, (2.0 - 0.227) / cos20));
    assert!(close(echoes[5].range_m, (2.0 - 0.227) / cos20));
    for silent in [0, 7, 8, 9, 10, 11, 12, 13, 14, 15] {
        assert!(!echoes[silent].echo && echoes[silent].range_m == SONAR_REACH_M, "{silent}");
    }
}

/// The robot turned and moved: only its place relative to the wall counts.
#[test]
fn mounts_turn_with_the_robot() {
    let angle_deg = 70.0;
    let pose = Pose { x_m: 0.4, y_m: -0.3, theta_rad: f64::to_radians(angle_deg) };
    let (sin, cos) = libm::sincos(pose.theta_rad);
    let there = sweep(&wall_at(angle_deg, 2.0 + 0.4 * cos - 0.3 * sin), None, &pose);
    let here = sweep(&wall([1.0, 0.0], 2.0), None, &HOME);
    for (a, b) in here.iter().zip(&there) {
        assert!(close(a.range_m, b.range_m) && a.echo == b.echo);
    }
}

/// Beyond the incidence limit a face is silent. The cone of id 3 spans 0° to 20°; a wall whose
/// normal stands at 54° from the heading is met at 34° by its nearest edge and heard there, at
/// 56° by no ray within 35°. The ray at 20° is one of the fan, so the range is exact.
#[test]
fn incidence_limit() {
    let heard = |angle_deg: f64| {
        let echoes = sweep(&wall_at(angle_deg, 2.0), Some(HARD_OF_HEARING), &HOME);
        echoes[3].echo.then_some(echoes[3].range_m)
    };
    let (sin, cos) = libm::sincos(54_f64.to_radians());
    let height_m = 2.0 - (0.245 * cos + 0.027 * sin);
    let range_m = heard(54.0).expect("34° off the normal");
    assert!(close(range_m, height_m / libm::cos(34_f64.to_radians())));
    assert_eq!(heard(56.0), None);
    assert!(sweep(&wall_at(56.0, 2.0), None, &HOME)[3].echo, "a perfect sonar hears it");
}

/// A box corner straight ahead of id 3, both of its faces at 45°: silent, unless the corner echoes,
/// and then at the corner's distance; not beyond 1.2 m, and not when something stands before it.
#[test]
fn convex_corner() {
    let (sin, cos) = libm::sincos(10_f64.to_radians());
    let ahead = |metres: f64| [0.245 + metres * cos, 0.027 + metres * sin];
    // A square standing on its corner, seen along its diagonal.
    let corner_at = |metres: f64| {
        let [x, y] = ahead(metres);
        let half = 0.3;
        Obstacle {
            corners_m: vec![
                [x, y],
                [x + half * (cos + sin), y + half * (sin - cos)],
                [x + 2.0 * half * cos, y + 2.0 * half * sin],
                [x + half * (cos - sin), y + half * (sin + cos)],
            ],
        }
    };
    let hear = |obstacles: Vec<Obstacle>, corner_echo: f64| {
        let world = World { obstacles, ..World::default() };
        let noise = SonarNoise { corner_echo, ..HARD_OF_HEARING };
        let echoes = sweep(&world, Some(noise), &HOME);
        echoes[3].echo.then_some(echoes[3].range_m)
    };
    assert_eq!(hear(vec![corner_at(1.0)], 0.0), None);
    assert!(hear(vec![corner_at(1.0)], 1.0).is_some_and(|range_m| close(range_m, 1.0)));
    assert_eq!(hear(vec![corner_at(1.25)], 1.0), None);
    // Within reach but 15° off the axis: outside the cone.
    let (sin25, cos25) = libm::sincos(25_f64.to_radians());
    let aside = Obstacle {
        corners_m: [[0.8, 0.0], [1.2, 0.1], [1.2, 0.6]]
            .map(|[far, left]| {
                [0.245 + far * cos25 - left * sin25, 0.027 + far * sin25 + left * cos25]
            })
            .to_vec(),
    };
    assert_eq!(hear(vec![aside], 1.0), None);
    // Behind a wall that is met at 50° to 70°, and so is silent itself.
    let (sin70, cos70) = libm::sincos(70_f64.to_radians());
    let [x, y] = ahead(0.6);
    let hidden = World {
        room: vec![HalfPlane { normal: [cos70, sin70], offset_m: x * cos70 + y * sin70 }],
        obstacles: vec![corner_at(1.0)],
        discs: Vec::new(),
        paths: Vec::new(),
    };
    let noise = SonarNoise { corner_echo: 1.0, ..HARD_OF_HEARING };
    assert!(!sweep(&hidden, Some(noise), &HOME)[3].echo);
}

/// What is behind a sonar, or beside its cone, is not heard: boxes and discs alike.
#[test]
fn only_what_is_in_the_cone() {
    let square = |x_m: f64, y_m: f64| Obstacle {
        corners_m: vec![[x_m, y_m], [x_m + 0.4, y_m], [x_m + 0.4, y_m + 0.4], [x_m, y_m + 0.4]],
    };
    let disc = |x_m: f64, y_m: f64| MovingDisc {
        radius_m: 0.2,
        from_m: [x_m, y_m],
        to_m: [x_m, y_m],
        speed_mps: 0.0,
        start_s: 0.0,
        to_and_fro: false,
    };
    // The cone of id 3 opens from (0.245, 0.027), between 0° and 20°: at x = 1 between 0.03 and 0.3.
    for world in [
        World { obstacles: vec![square(-1.4, -0.2)], ..World::default() },
        World { obstacles: vec![square(1.0, 0.6)], ..World::default() },
        World { obstacles: vec![square(1.0, -0.6)], ..World::default() },
        World { discs: vec![disc(-1.0, 0.0)], ..World::default() },
        World { discs: vec![disc(1.0, 0.6)], ..World::default() },
    ] {
        for noise in [None, Some(HARD_OF_HEARING)] {
            assert!(!sweep(&world, noise, &HOME)[3].echo, "{world:?}");
        }
    }
}

/// A disc that the cone only grazes is silent to a sonar with an incidence limit. The left edge of
/// the cone of id 3 stands at 20°; the disc's centre is off it by R sin 50°, outwards.
#[test]
fn grazed_disc() {
    let (sin, cos) = libm::sincos(20_f64.to_radians());
    let off_m = 0.2 * libm::sin(50_f64.to_radians());
    let centre_m = [0.245 + cos - off_m * sin, 0.027 + sin + off_m * cos];
    let world = World {
        discs: vec![MovingDisc {
            radius_m: 0.2,
            from_m: centre_m,
            to_m: centre_m,
            speed_mps: 0.0,
            start_s: 0.0,
            to_and_fro: false,
        }],
        ..World::default()
    };
    let wanted_m = 1.0 - 0.2 * libm::cos(50_f64.to_radians());
    assert!(close(sweep(&world, None, &HOME)[3].range_m, wanted_m));
    assert!(!sweep(&world, Some(HARD_OF_HEARING), &HOME)[3].echo);
    let sharp = SonarNoise { incidence_limit_deg: 51.0, ..HARD_OF_HEARING };
    assert!(close(sweep(&world, Some(sharp), &HOME)[3].range_m, wanted_m));
}

/// A walking disc is heard where it is at the time, at its nearest point.
#[test]
fn moving_disc() {
    let world = World {
        discs: vec![MovingDisc {
            radius_m: 0.2,
            from_m: [2.245, 0.027],
            to_m: [1.245, 0.027],
            speed_mps: 0.5,
            start_s: 0.0,
            to_and_fro: true,
        }],
        ..World::default()
    };
    for noise in [None, Some(HARD_OF_HEARING)] {
        let mut sonars = Sonars::new(&world, noise, 0);
        for (t_s, wanted_m) in [(0.0, 1.8), (1.0, 1.3), (2.0, 0.8), (3.0, 1.3)] {
            let echo = sonars.scan(3, SIMULATION_EPOCH, t_s, &HOME, &world).echoes[0];
            assert!(echo.echo && close(echo.range_m, wanted_m), "{echo:?}");
        }
    }
}

/// Nearer than the ring of the sonar, and inside something, it reads the blind distance.
#[test]
fn blind_range() {
    for offset_m in [0.245 + 0.05, 0.245, 0.1, -1.0] {
        for noise in [
            None,
            Some(HARD_OF_HEARING),
            Some(SonarNoise { dropout: 0.0, cross_talk: 0.0, ..SonarNoise::default() }),
        ] {
            let echo = sweep(&wall([1.0, 0.0], offset_m), noise, &HOME)[3];
            assert!(echo.echo);
            assert_eq!(echo.range_m, SONAR_BLIND_M);
        }
    }
}

/// The readings of id 3 before a wall at 2 m, over many firings of a default sonar.
fn readings(noise: SonarNoise, world: &World, count: u64) -> Vec<SonarEcho> {
    let mut sonars = Sonars::new(world, Some(noise), 21);
    (0..count)
        .map(|i| sonars.scan(3 + 8 * i, SIMULATION_EPOCH, 0.0, &HOME, world).echoes[0])
        .collect()
}

/// Each fault happens as often as asked for, within five deviations of a binomial, and has the size
/// asked for.
#[test]
fn faults_have_their_rates() {
    let count = 20_000;
    let n = count as f64;
    let world = wall([1.0, 0.0], 2.0);
    let bound = |p: f64| 5.0 * libm::sqrt(p * (1.0 - p) / n);
    let share = |echoes: &[SonarEcho], of: &dyn Fn(&SonarEcho) -> bool| {
        echoes.iter().filter(|echo| of(echo)).count() as f64 / n
    };

    let dropping = readings(SonarNoise { dropout: 0.05, ..HARD_OF_HEARING }, &world, count);
    assert!((share(&dropping, &|echo| !echo.echo) - 0.05).abs() < bound(0.05));
    assert!(dropping.iter().all(|echo| echo.echo || echo.range_m == SONAR_REACH_M));

    // Of the fan's rays the one along the wall's normal is the cone's right edge: exactly 1.755 m.
    let talking = readings(SonarNoise { cross_talk: 0.03, ..HARD_OF_HEARING }, &world, count);
    assert!((share(&talking, &|echo| echo.range_m < 1.75) - 0.03).abs() < bound(0.03));
    assert!(talking.iter().all(|echo| echo.range_m >= SONAR_BLIND_M && echo.range_m < 1.756));

    let wobbling = readings(SonarNoise { range_fraction: 0.01, ..HARD_OF_HEARING }, &world, count);
    let errors: Vec<f64> = wobbling.iter().map(|echo| echo.range_m / 1.755 - 1.0).collect();
    let mean = errors.iter().sum::<f64>() / n;
    let variance = errors.iter().map(|error| error * error).sum::<f64>() / n;
    assert!(mean.abs() < 5.0 * 0.01 / libm::sqrt(n));
    assert!((libm::sqrt(variance) / 0.01 - 1.0).abs() < 5.0 / libm::sqrt(2.0 * n));

    // A wall at 60° from the axis of id 3's cone: all rays graze it.
    let slanted = wall_at(70.0, 0.6);
    let grazing = readings(SonarNoise { long_echo: 0.3, ..HARD_OF_HEARING }, &slanted, count);
    assert!((share(&grazing, &|echo| echo.echo) - 0.3).abs() < bound(0.3));
    let nearest_m = sweep(&slanted, None, &HOME)[3].range_m;
    assert!(grazing.iter().all(|echo| !echo.echo || echo.range_m > nearest_m));
}

/// A reading's faults depend on seed, sonar and firing alone: not on where the robot is, nor on
/// what the others heard.
#[test]
fn faults_do_not_depend_on_the_robot() {
    let world = wall([1.0, 0.0], 2.0);
    let noise = SonarNoise { dropout: 0.3, cross_talk: 0.0, ..SonarNoise::default() };
    let dropped = |pose: &Pose, seed: u64| -> Vec<bool> {
        let mut sonars = Sonars::new(&world, Some(noise), seed);
        (0..400)
            .map(|slot| sonars.scan(slot, SIMULATION_EPOCH, 0.0, pose, &world))
            .filter(|scan| scan.echoes[0].id == 3)
            .map(|scan| scan.echoes[0].echo)
            .collect()
    };
    let nearer = Pose { x_m: 0.5, y_m: 1.0, theta_rad: 0.1 };
    assert_eq!(dropped(&HOME, 1), dropped(&nearer, 1));
    assert_ne!(dropped(&HOME, 1), dropped(&HOME, 2));
}
