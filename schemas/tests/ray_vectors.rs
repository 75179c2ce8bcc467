//! Contract: ray distances in the worlds of the three case studies agree with an independent
//! program's, `fixtures/vectors/controller.jsonl`, to 1e-9 relative; so does which points are
//! admissible.

use schemas::{Footprint, HalfPlane, MovingDisc, Obstacle, Pose, World};
use serde_json::Value;

const VECTORS: &str = include_str!("../../fixtures/vectors/controller.jsonl");

fn walls(bounds: &[([f64; 2], f64)]) -> Vec<HalfPlane> {
    bounds.iter().map(|&(normal, offset_m)| HalfPlane { normal, offset_m }).collect()
}

fn room(x: [f64; 2], y: [f64; 2]) -> Vec<HalfPlane> {
    walls(&[([1.0, 0.0], x[1]), ([-1.0, 0.0], -x[0]), ([0.0, 1.0], y[1]), ([0.0, -1.0], -y[0])])
}

fn table(x: [f64; 2], y: [f64; 2]) -> Vec<Obstacle> {
    vec![Obstacle { corners_m: vec![[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]] }]
}

/// Specification §11: the paper's admissible sets (19) and (22), and (25) shrunk by 0.25 m.
fn world(name: &str) -> World {
    match name {
        "case1" => World {
            room: room([-0.2, 2.9], [-0.25, 1.75]),
            obstacles: table([0.7, 2.4], [0.2, 1.2]),
            discs: Vec::new(),
            paths: Vec::new(),
        },
        "case2" => World {
            room: walls(&[([1.0, 0.0], 3.25), ([0.0, 1.0], 1.65)]),
            obstacles: Vec::new(),
            discs: vec![MovingDisc {
                radius_m: 0.2,
                from_m: [2.4, 1.5],
                to_m: [2.4, 0.3],
                speed_mps: 0.1,
                start_s: 0.0,
                to_and_fro: false,
            }],
            paths: Vec::new(),
        },
        "case3" => World {
            room: room([-0.25, 4.15], [-0.25, 1.75]),
            obstacles: table([0.75, 2.75], [-0.05, 1.05]),
            discs: Vec::new(),
            paths: Vec::new(),
        },
        other => panic!("the vectors name an unknown world {other}"),
    }
}

fn number(value: &Value) -> f64 {
    match value {
        Value::String(name) if name == "Infinity" => f64::INFINITY,
        other => other.as_f64().expect("a number"),
    }
}

#[test]
fn rays_agree_with_the_independent_program() {
    let mut checked = 0;
    for line in VECTORS.lines() {
        let vector: Value = serde_json::from_str(line).expect("a line of JSON");
        if vector["fn"] != "ray" {
            continue;
        }
        let input = &vector["in"];
        let world = world(input["world"].as_str().expect("a name"));
        let (x_m, y_m) = (number(&input["x"]), number(&input["y"]));
        let t_s = number(&input["t"]);

        let wanted_m = number(&vector["out"]["distance"]);
        let distance_m = world.ray_m([x_m, y_m], number(&input["angle"]), 0.0, t_s);
        let agrees =
            distance_m == wanted_m || (distance_m - wanted_m).abs() <= 1e-9 * wanted_m.abs();
        assert!(agrees, "{distance_m} instead of {wanted_m} in {line}");

        let pose = Pose { x_m, y_m, theta_rad: 0.0 };
        let inside = world.clearance_m(&Footprint::POINT, &pose, t_s) >= 0.0;
        assert_eq!(inside, number(&vector["out"]["inside"]) == 1.0, "{line}");
        checked += 1;
    }
    assert_eq!(checked, 150);
}
