//! Which thing of a world an answer comes from: each thing asked as a world of its own.

use schemas::World;

/// Everything in a world by name, each as a world that holds nothing else.
///
/// Discs are named by where they are `t_s` seconds after the start of the session.
fn things(world: &World, t_s: f64) -> impl Iterator<Item = (String, World)> + '_ {
    let walls = world.room.iter().enumerate().map(|(i, wall)| {
        let name = match wall.normal {
            [1.0 | -1.0, 0.0] => format!("the wall at x = {:.2} m", wall.normal[0] * wall.offset_m),
            [0.0, 1.0 | -1.0] => format!("the wall at y = {:.2} m", wall.normal[1] * wall.offset_m),
            [x, y] => {
                format!("wall {} (outwards at {:.0}°)", i + 1, y.atan2(x).to_degrees())
            }
        };
        (name, World { room: vec![*wall], ..World::default() })
    });
    let obstacles = world.obstacles.iter().enumerate().map(|(i, obstacle)| {
        let extent = |axis: usize| {
            let along = obstacle.corners_m.iter().map(|corner| corner[axis]);
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            format!("{low:.2} to {high:.2} m")
        };
        let name = format!("obstacle {} (x {}, y {})", i + 1, extent(0), extent(1));
        (name, World { obstacles: vec![obstacle.clone()], ..World::default() })
    });
    let discs = world.discs.iter().enumerate().map(move |(i, disc)| {
        let [x_m, y_m] = disc.at(t_s).centre_m;
        let name = format!(
            "moving disc {} (radius {:.2} m, now at ({x_m:.2}, {y_m:.2}))",
            i + 1,
            disc.radius_m
        );
        (name, World { discs: vec![*disc], ..World::default() })
    });
    let paths = world.paths.iter().enumerate().map(move |(i, path)| {
        (
            format!("walker {} as seen", i + 1),
            World { paths: vec![path.clone()], ..World::default() },
        )
    });
    walls.chain(obstacles).chain(discs).chain(paths)
}

/// The thing that gives the least answer, and that answer; `None` where no thing gives a finite
/// one. Answers of a whole world are the least of those of its things.
pub fn nearest(
    world: &World,
    t_s: f64,
    distance_m: impl Fn(&World) -> f64,
) -> Option<(String, f64)> {
    things(world, t_s)
        .map(|(name, alone)| (name, distance_m(&alone)))
        .filter(|(_, distance_m)| distance_m.is_finite())
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use schemas::{Footprint, HalfPlane, MovingDisc, Obstacle, Pose};

    use super::*;

    fn world() -> World {
        World {
            room: vec![
                HalfPlane { normal: [1.0, 0.0], offset_m: 4.0 },
                HalfPlane { normal: [0.0, -1.0], offset_m: 1.0 },
                HalfPlane { normal: [0.6, 0.8], offset_m: 9.0 },
            ],
            obstacles: vec![Obstacle {
                corners_m: vec![[1.0, -0.5], [2.0, -0.5], [2.0, 0.5], [1.0, 0.5]],
            }],
            discs: vec![MovingDisc {
                radius_m: 0.2,
                from_m: [0.0, 2.0],
                to_m: [0.0, 1.0],
                speed_mps: 0.5,
                start_s: 0.0,
                to_and_fro: false,
            }],
            paths: Vec::new(),
        }
    }

    /// By hand: from the origin the box is 1 m ahead, the disc 0.8 m to the left at t = 2 s, the
    /// wall y = −1 is 1 m to the right.
    #[test]
    fn the_thing_that_is_met_is_named() {
        let world = world();
        let met = |angle_rad: f64| {
            nearest(&world, 2.0, |alone| alone.ray_m([0.0; 2], angle_rad, 0.0, 2.0)).unwrap()
        };
        let quarter = std::f64::consts::FRAC_PI_2;
        let (name, distance_m) = met(0.0);
        assert_eq!(
            (name.as_str(), distance_m),
            ("obstacle 1 (x 1.00 to 2.00 m, y -0.50 to 0.50 m)", 1.0)
        );
        let (name, distance_m) = met(quarter);
        assert_eq!(name, "moving disc 1 (radius 0.20 m, now at (0.00, 1.00))");
        assert!((distance_m - 0.8).abs() < 1e-12);
        let (name, distance_m) = met(-quarter);
        assert_eq!((name.as_str(), distance_m), ("the wall at y = -1.00 m", 1.0));
        assert_eq!(met(1.3).0, "wall 3 (outwards at 53°)");
        assert_eq!(nearest(&World::default(), 0.0, |w| w.ray_m([0.0; 2], 0.0, 0.0, 0.0)), None);
    }

    /// The least over things is what the whole world says, for rays and for clearance.
    #[test]
    fn the_parts_add_up_to_the_world() {
        let (world, body) = (world(), Footprint { length_m: 0.5, width_m: 0.4 });
        for i in 0..64 {
            let angle_rad = f64::from(i) * 0.1;
            let whole_m = world.ray_m([0.1, 0.2], angle_rad, 0.3, 1.0);
            let part = nearest(&world, 1.0, |w| w.ray_m([0.1, 0.2], angle_rad, 0.3, 1.0));
            assert_eq!(part.map_or(f64::INFINITY, |(_, m)| m), whole_m);
            let pose = Pose { x_m: 0.05 * f64::from(i), y_m: 0.0, theta_rad: angle_rad };
            let part = nearest(&world, 1.0, |w| w.clearance_m(&body, &pose, 1.0)).unwrap();
            assert_eq!(part.1, world.clearance_m(&body, &pose, 1.0));
        }
    }
}
