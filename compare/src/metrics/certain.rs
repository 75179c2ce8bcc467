//! Whether a body at constant speeds certainly touches something, or certainly touches nothing.
//!
//! A quick answer for most of what [`super::sweep`] would find out step by step, and never another
//! one: where the two might differ, here nothing is said. On a stretch of constant speeds every
//! point of the body moves on a circle, so its distance along a fixed direction bends by no more than
//! the point's centripetal acceleration; between two instants it stays above the parabola through both
//! values that bends as much. The same holds for a corner of an obstacle seen from the body. Two
//! convex shapes that some direction keeps apart all the while do not touch.

use schemas::{Disc, Footprint, Pose, Twist, World};

use super::sweep::{SHORTEST_S, arc};

/// What a distance may be wrong by, metres: far above rounding in rooms of up to [`FARTHEST_M`].
const SLACK_M: f64 = 1e-8;

/// Largest coordinate, metres, for which rounding was thought of.
const FARTHEST_M: f64 = 1e3;

/// Largest speeds, m/s and rad/s, for which rounding was thought of.
const FASTEST: f64 = 1e2;

/// Largest heading, radians, for which rounding was thought of.
const MOST_TURNED_RAD: f64 = 1e4;

/// Latest instant, seconds, for which rounding was thought of.
const LATEST_S: f64 = 1e5;

/// How often a stretch is halved.
const HALVINGS: u32 = 7;

/// Most stretches that are looked at side by side.
const MOST_STRETCHES: usize = 24;

/// Most things that can be told apart in a set.
const MOST_THINGS: usize = 64;

/// A convex polygon, prepared.
#[derive(Clone, Debug)]
struct Shape {
    middle_m: [f64; 2],
    radius_m: f64,
    /// Outward unit normal of each face, and how far out the face lies along it, metres.
    faces: Vec<([f64; 2], f64)>,
    corners_m: Vec<[f64; 2]>,
}

/// The surroundings, prepared; what cannot be spoken of with certainty is left out, and said nothing
/// about.
#[derive(Clone, Debug)]
pub(super) struct Certain {
    /// Whether anything can be said at all.
    sound: bool,
    walls: Vec<([f64; 2], f64)>,
    shapes: Vec<Shape>,
    half_m: [f64; 2],
    reach_m: f64,
}

/// A body at an instant.
#[derive(Clone, Copy, Debug, Default)]
struct Placed {
    at_s: f64,
    centre_m: [f64; 2],
    forward: [f64; 2],
}

/// A piece of the stretch, and which things may be touched in it.
#[derive(Clone, Copy, Debug, Default)]
struct Piece {
    from: Placed,
    to: Placed,
    near: u64,
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn length(a: [f64; 2]) -> f64 {
    dot(a, a).sqrt()
}

/// Whether a distance is one, whatever the rounding.
fn is_clear(gap_m: f64) -> bool {
    gap_m > SLACK_M
}

/// Whether a distance is a contact deeper than that, whatever the rounding.
fn is_deep(gap_m: f64, deep_m: f64) -> bool {
    gap_m < -(deep_m + SLACK_M)
}

/// Least value over a span of what is `from` at its start and `to` at its end and bends by at most
/// `bend` per second twice.
fn least(from: f64, to: f64, bend: f64, span_s: f64) -> f64 {
    let (bend, rise) = (bend * span_s * span_s, to - from);
    if rise.abs() >= 0.5 * bend {
        from.min(to)
    } else {
        0.5 * (from + to) - 0.125 * bend - rise * rise / (2.0 * bend)
    }
}

impl Shape {
    fn of(corners_m: &[[f64; 2]]) -> Shape {
        let count = corners_m.len() as f64;
        let sum = corners_m.iter().fold([0.0, 0.0], |sum, c| [sum[0] + c[0], sum[1] + c[1]]);
        let middle_m = [sum[0] / count, sum[1] / count];
        let radius_m = corners_m.iter().map(|c| length(minus(*c, middle_m))).fold(0.0, f64::max);
        let faces = corners_m.iter().enumerate().map(|(i, from_m)| {
            let along_m = minus(corners_m[(i + 1) % corners_m.len()], *from_m);
            let long_m = length(along_m);
            let normal = [along_m[1] / long_m, -along_m[0] / long_m];
            (normal, dot(normal, *from_m))
        });
        Shape { middle_m, radius_m, faces: faces.collect(), corners_m: corners_m.to_vec() }
    }
}

impl Placed {
    fn new(pose: &Pose, at_s: f64) -> Placed {
        let (sin, cos) = libm::sincos(pose.theta_rad);
        Placed { at_s, centre_m: pose.position_m(), forward: [cos, sin] }
    }

    fn left(&self) -> [f64; 2] {
        [-self.forward[1], self.forward[0]]
    }
}

impl Certain {
    pub(super) fn new(world: &World, footprint: Footprint) -> Certain {
        let far = |m: &[f64; 2]| m[0].abs() > FARTHEST_M || m[1].abs() > FARTHEST_M;
        let things = world.room.len() + world.obstacles.len() + world.discs.len();
        let half_m = [0.5 * footprint.length_m, 0.5 * footprint.width_m];
        let sound = world.check().is_ok()
            // Who comes and goes may do so between two looks.
            && world.paths.is_empty()
            && things <= MOST_THINGS
            && half_m.iter().all(|half_m| *half_m >= 0.0 && *half_m <= FARTHEST_M)
            && !world.room.iter().any(|wall| wall.offset_m.abs() > FARTHEST_M)
            && !world.obstacles.iter().any(|o| o.corners_m.iter().any(far))
            && !world.discs.iter().any(|disc| {
                far(&disc.from_m)
                    || far(&disc.to_m)
                    || disc.speed_mps > FASTEST
                    || disc.start_s.abs() > LATEST_S
            });
        let shapes = if sound { &world.obstacles[..] } else { &[] };
        Certain {
            sound,
            walls: world.room.iter().map(|wall| (wall.normal, wall.offset_m)).collect(),
            shapes: shapes.iter().map(|obstacle| Shape::of(&obstacle.corners_m)).collect(),
            half_m,
            reach_m: length(half_m),
        }
    }

    /// Whether the surroundings are such that nothing comes nearer than speeds allow.
    pub(super) fn is_sound(&self) -> bool {
        self.sound
    }

    /// Whether a body that is clear at `pose` and time `t_s` touches something while it moves on for
    /// `span_s` seconds; `None` where that is not certain.
    pub(super) fn touches(
        &self,
        world: &World,
        pose: &Pose,
        t_s: f64,
        twist: Twist,
        span_s: f64,
    ) -> Option<bool> {
        let speeds = [twist.v_mps.abs(), twist.omega_radps.abs()];
        let known = self.sound
            && pose.x_m.abs() <= FARTHEST_M
            && pose.y_m.abs() <= FARTHEST_M
            && pose.theta_rad.abs() <= MOST_TURNED_RAD
            && t_s.abs() <= LATEST_S
            && speeds.iter().all(|speed| *speed <= FASTEST);
        if !known {
            return None;
        }
        let things = self.walls.len() + self.shapes.len() + world.discs.len();
        let all = if things == MOST_THINGS { u64::MAX } else { (1 << things) - 1 };
        let from = Placed::new(pose, 0.0);
        let to = Placed::new(&arc(pose, twist, span_s), span_s);
        // Whoever goes step by step looks at the very end too.
        if is_deep(self.deepest_m(world, &to, t_s, all), 0.0) {
            return Some(true);
        }
        // What lasts longer than the shortest step is not stepped over.
        let fastest_disc_mps = world.discs.iter().fold(0.0, |fast, d| d.speed_mps.max(fast));
        let deep_m = SHORTEST_S * (speeds[0] + speeds[1] * self.reach_m + fastest_disc_mps);
        let mut pieces = [Piece::default(); MOST_STRETCHES];
        pieces[0] = Piece { from, to, near: all };
        let mut count = 1;
        for _ in 0..HALVINGS {
            let mut next = [Piece::default(); MOST_STRETCHES];
            let mut found = 0;
            for piece in &pieces[..count] {
                let near = self.still_near(world, piece, t_s, speeds);
                if near == 0 {
                    continue;
                }
                let middle_s = 0.5 * (piece.from.at_s + piece.to.at_s);
                let middle = Placed::new(&arc(pose, twist, middle_s), middle_s);
                if is_deep(self.deepest_m(world, &middle, t_s, near), deep_m) {
                    return Some(true);
                }
                let piece = Piece { near, ..*piece };
                next.get_mut(found..found + 2)?.copy_from_slice(&[
                    Piece { to: middle, ..piece },
                    Piece { from: middle, ..piece },
                ]);
                found += 2;
            }
            if found == 0 {
                return Some(false);
            }
            (pieces, count) = (next, found);
        }
        None
    }

    /// Which of the things that may be touched in a piece are not certainly clear all through it.
    fn still_near(&self, world: &World, piece: &Piece, t_s: f64, speeds: [f64; 2]) -> u64 {
        let mut near = piece.near;
        let mut rest = piece.near;
        while rest != 0 {
            let thing = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            if self.clear(world, piece, thing, t_s, speeds) {
                near &= !(1 << thing);
            }
        }
        near
    }

    fn clear(
        &self,
        world: &World,
        piece: &Piece,
        thing: usize,
        t_s: f64,
        [v_mps, omega_radps]: [f64; 2],
    ) -> bool {
        let Piece { from, to, .. } = piece;
        let span_s = to.at_s - from.at_s;
        let bend = omega_radps * (v_mps + omega_radps * self.reach_m);
        if let Some(wall) = self.walls.get(thing) {
            let gaps_m = [from, to].map(|body| self.to_wall_m(body, *wall));
            return is_clear(least(gaps_m[0], gaps_m[1], bend, span_s));
        }
        let moved_m = v_mps * span_s;
        let Some(shape) = self.shapes.get(thing - self.walls.len()) else {
            let disc = world.discs[thing - self.walls.len() - self.shapes.len()];
            let gaps_m = [from, to].map(|body| self.to_disc_m(body, &disc.at(t_s + body.at_s)));
            let closing_mps = v_mps + omega_radps * self.reach_m + disc.speed_mps;
            // Half of that is left in between.
            return is_clear(gaps_m[0] + gaps_m[1] - closing_mps * span_s);
        };
        let apart_m = length(minus(shape.middle_m, from.centre_m));
        if is_clear(apart_m - shape.radius_m - self.reach_m - moved_m) {
            return true;
        }
        let kept_apart =
            |gaps_m: [f64; 2], bend| is_clear(least(gaps_m[0], gaps_m[1], bend, span_s));
        let by_face = shape
            .faces
            .iter()
            .any(|face| kept_apart([from, to].map(|body| self.to_face_m(body, *face)), bend));
        let bend = omega_radps * (v_mps + omega_radps * (apart_m + shape.radius_m + moved_m));
        by_face || {
            let (from, to) = (self.to_sides_m(from, shape), self.to_sides_m(to, shape));
            (0..4).any(|side| kept_apart([from[side], to[side]], bend))
        }
    }

    /// How far the body reaches from its centre along a direction, metres.
    fn reach_along_m(&self, body: &Placed, direction: [f64; 2]) -> f64 {
        self.half_m[0] * dot(body.forward, direction).abs()
            + self.half_m[1] * dot(body.left(), direction).abs()
    }

    /// Signed distance to the edge of a half-plane, metres.
    fn to_wall_m(&self, body: &Placed, (normal, offset_m): ([f64; 2], f64)) -> f64 {
        offset_m - dot(normal, body.centre_m) - self.reach_along_m(body, normal)
    }

    /// How far beyond a face the body begins, metres.
    fn to_face_m(&self, body: &Placed, (normal, offset_m): ([f64; 2], f64)) -> f64 {
        dot(normal, body.centre_m) - offset_m - self.reach_along_m(body, normal)
    }

    /// How far beyond each side of the body a shape begins, metres.
    fn to_sides_m(&self, body: &Placed, shape: &Shape) -> [f64; 4] {
        let mut sides_m = [0.0; 4];
        for (i, axis) in [body.forward, body.left()].into_iter().enumerate() {
            let (mut low_m, mut high_m) = (f64::INFINITY, f64::NEG_INFINITY);
            for corner_m in &shape.corners_m {
                let along_m = dot(axis, minus(*corner_m, body.centre_m));
                (low_m, high_m) = (low_m.min(along_m), high_m.max(along_m));
            }
            sides_m[2 * i] = low_m - self.half_m[i];
            sides_m[2 * i + 1] = -self.half_m[i] - high_m;
        }
        sides_m
    }

    fn to_disc_m(&self, body: &Placed, disc: &Disc) -> f64 {
        let offset_m = minus(disc.centre_m, body.centre_m);
        let beyond_m = [
            dot(body.forward, offset_m).abs() - self.half_m[0],
            dot(body.left(), offset_m).abs() - self.half_m[1],
        ];
        let outside_m = length(beyond_m.map(|beyond_m| beyond_m.max(0.0)));
        outside_m + beyond_m[0].max(beyond_m[1]).min(0.0) - disc.radius_m
    }

    /// The least of the signed distances to some of the things, metres; apart it may be less than
    /// the distance, in contact it is minus the penetration depth.
    fn deepest_m(&self, world: &World, body: &Placed, t_s: f64, among: u64) -> f64 {
        let mut deepest_m = f64::INFINITY;
        let mut rest = among;
        while rest != 0 {
            let thing = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let gap_m = if let Some(wall) = self.walls.get(thing) {
                self.to_wall_m(body, *wall)
            } else if let Some(shape) = self.shapes.get(thing - self.walls.len()) {
                self.separation_m(body, shape)
            } else {
                let disc = world.discs[thing - self.walls.len() - self.shapes.len()];
                self.to_disc_m(body, &disc.at(t_s + body.at_s))
            };
            deepest_m = deepest_m.min(gap_m);
        }
        deepest_m
    }

    /// The widest gap along the axes of body and shape, metres.
    fn separation_m(&self, body: &Placed, shape: &Shape) -> f64 {
        let apart_m = length(minus(shape.middle_m, body.centre_m)) - shape.radius_m - self.reach_m;
        if apart_m > 0.0 {
            return apart_m;
        }
        let faces = shape.faces.iter().map(|face| self.to_face_m(body, *face));
        self.to_sides_m(body, shape).into_iter().chain(faces).fold(f64::NEG_INFINITY, f64::max)
    }
}

#[cfg(test)]
mod tests;
