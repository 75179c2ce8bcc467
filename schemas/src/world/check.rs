//! Whether a world's numbers describe a world.

use super::{HalfPlane, MovingDisc, Obstacle, WalkedPath, World, cross};

/// How far the length of a wall's normal may be from 1.
const UNIT_TOLERANCE: f64 = 1e-9;

impl World {
    /// Checks that every number is finite, normals are unit vectors, and obstacles are convex with
    /// their corners counter-clockwise.
    ///
    /// # Errors
    /// What is wrong, with the place and the value.
    pub fn check(&self) -> Result<(), String> {
        for (i, wall) in self.room.iter().enumerate() {
            wall.check().map_err(|what| format!("world.room[{i}] {what}"))?;
        }
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            obstacle.check().map_err(|what| format!("world.obstacles[{i}] {what}"))?;
        }
        for (i, disc) in self.discs.iter().enumerate() {
            disc.check().map_err(|what| format!("world.discs[{i}] {what}"))?;
        }
        for (i, path) in self.paths.iter().enumerate() {
            path.check().map_err(|what| format!("world.paths[{i}] {what}"))?;
        }
        Ok(())
    }
}

fn finite(numbers: &[f64]) -> Result<(), String> {
    match numbers.iter().find(|number| !number.is_finite()) {
        None => Ok(()),
        Some(number) => Err(format!("must hold finite numbers, not {number}")),
    }
}

impl HalfPlane {
    fn check(&self) -> Result<(), String> {
        finite(&[self.normal[0], self.normal[1], self.offset_m])?;
        let length = libm::hypot(self.normal[0], self.normal[1]);
        if (length - 1.0).abs() > UNIT_TOLERANCE {
            return Err(format!("normal must have length 1, not {length}"));
        }
        Ok(())
    }
}

impl Obstacle {
    fn check(&self) -> Result<(), String> {
        for corner_m in &self.corners_m {
            finite(corner_m)?;
        }
        let count = self.corners_m.len();
        if count < 3 {
            return Err(format!("needs at least three corners, not {count}"));
        }
        let mut turned = 0.0;
        for i in 0..count {
            let sides = [i, i + 1].map(|k| {
                let (from, to) = (self.corners_m[k % count], self.corners_m[(k + 1) % count]);
                [to[0] - from[0], to[1] - from[1]]
            });
            let bend = cross(sides[0], sides[1]);
            if bend <= 0.0 {
                let corner_m = self.corners_m[(i + 1) % count];
                return Err(format!(
                    "must be convex with its corners counter-clockwise; it is not at {corner_m:?}"
                ));
            }
            turned += libm::atan2(bend, sides[0][0] * sides[1][0] + sides[0][1] * sides[1][1]);
        }
        // All bends to the left, but more than once round: a star.
        if turned > 3.0 * core::f64::consts::PI {
            return Err("must not cross itself".to_owned());
        }
        Ok(())
    }
}

impl MovingDisc {
    fn check(&self) -> Result<(), String> {
        finite(&self.from_m)?;
        finite(&self.to_m)?;
        finite(&[self.radius_m, self.speed_mps, self.start_s])?;
        if self.radius_m <= 0.0 {
            return Err(format!("radius_m must be positive, not {}", self.radius_m));
        }
        if self.speed_mps < 0.0 {
            return Err(format!("speed_mps must not be negative, not {}", self.speed_mps));
        }
        Ok(())
    }
}

impl WalkedPath {
    fn check(&self) -> Result<(), String> {
        finite(&[self.radius_m])?;
        if self.radius_m <= 0.0 {
            return Err(format!("radius_m must be positive, not {}", self.radius_m));
        }
        for point in &self.points {
            finite(point)?;
        }
        if let Some(pair) = self.points.windows(2).find(|pair| pair[0][0] >= pair[1][0]) {
            return Err(format!("must go on in time; {} s follows {} s", pair[1][0], pair[0][0]));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_corners(corners_m: &[[f64; 2]]) -> Result<(), String> {
        World { obstacles: vec![Obstacle { corners_m: corners_m.to_vec() }], ..World::default() }
            .check()
    }

    #[test]
    fn obstacles_are_convex_and_counter_clockwise() {
        assert_eq!(with_corners(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), Ok(()));
        for bad in [
            vec![[0.0, 0.0], [1.0, 0.0]],
            vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0]],
            vec![[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]],
            vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0]],
            vec![[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0]],
            // A pentagram turns left at every corner, twice round.
            vec![[0.0, 1.0], [-0.59, -0.81], [0.95, 0.31], [-0.95, 0.31], [0.59, -0.81]],
        ] {
            assert!(with_corners(&bad).is_err(), "{bad:?}");
        }
    }

    #[test]
    fn walls_and_discs_name_the_bad_number() {
        let mut world = World::default();
        world.room.push(HalfPlane { normal: [1.0, 1.0], offset_m: 0.0 });
        assert!(world.check().is_err_and(|what| what.starts_with("world.room[0] normal")));
        let disc = MovingDisc {
            radius_m: -0.1,
            from_m: [0.0, 0.0],
            to_m: [1.0, 0.0],
            speed_mps: 0.1,
            start_s: 0.0,
            to_and_fro: false,
        };
        let world = World { discs: vec![disc], ..World::default() };
        assert!(world.check().is_err_and(|what| what.contains("-0.1")));
        let points = vec![[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let world = World { paths: vec![WalkedPath { radius_m: 0.1, points }], ..World::default() };
        assert!(world.check().is_err_and(|what| what.contains("1 s follows 1 s")));
    }
}
