//! Contract of the picture: ten drawings a second, each complete in itself, nothing but finite
//! numbers, who drives visible in the colour.

use foxglove::messages::{FrameTransforms, Log, PoseInFrame, SceneUpdate};
use prost::Message;

use super::{Picture, Shown, primitives::colour};
use crate::log::tests::session::{events, header};
use crate::log::{Arm, Topic};
use crate::{Event, Header, Stamped, Time};

fn observe(header: &Header, events: &[Stamped<Event>]) -> Vec<Shown> {
    let mut picture = Picture::new(header);
    events.iter().flat_map(|event| picture.observe(event)).collect()
}

fn of<T: Message + Default>(shown: &[Shown], topic: Topic) -> Vec<(Time, T)> {
    let ours = shown.iter().filter(|shown| shown.topic == topic);
    ours.map(|shown| (shown.at, T::decode(shown.bytes.as_slice()).expect("our own bytes")))
        .collect()
}

#[test]
fn ten_drawings_a_second_whatever_the_control_period() {
    // The ten events of a period, spread over it as those of a real session are.
    let mut all = events(100);
    for (index, event) in all.iter_mut().enumerate() {
        event.at = crate::SIMULATION_EPOCH.after_ns(index as u64 * 10_000_000);
    }
    let only = |keep: &dyn Fn(&Event) -> bool| -> Vec<Stamped<Event>> {
        all.iter().filter(|event| keep(&event.value)).cloned().collect()
    };
    let cases = [
        ("all events", all.clone()),
        ("no controller", only(&|event| !matches!(event, Event::Command(_) | Event::Step(_)))),
        ("every third command", {
            let mut count = 0;
            let mut kept = all.clone();
            kept.retain(|event| {
                let command = matches!(event.value, Event::Command(_));
                count += usize::from(command);
                !command || count % 3 == 0
            });
            kept
        }),
    ];
    for (name, events) in cases {
        let shown = observe(&header(), &events);
        for topic in [Topic::Tf, Topic::Scene] {
            let count = shown.iter().filter(|shown| shown.topic == topic).count();
            assert!((95..=100).contains(&count), "{name}: {count} of {topic:?} in 10 s");
        }
    }
}

#[test]
fn every_scene_holds_every_entity() {
    let shown = observe(&header(), &events(30));
    let scenes = of::<SceneUpdate>(&shown, Topic::Scene);
    assert!(scenes.len() >= 25);
    for (at, scene) in &scenes {
        let ids: Vec<&str> = scene.entities.iter().map(|entity| entity.id.as_str()).collect();
        let expected =
            ["room", "discs", "robot", "estimate", "danger", "sonar", "target", "distances"];
        assert_eq!(ids, expected);
        assert!(scene.deletions.is_empty());
        for entity in &scene.entities {
            assert_eq!(entity.timestamp, Some(super::primitives::timestamp(*at)), "{}", entity.id);
        }
    }
    let (_, last) = scenes.last().expect("counted above");
    // Four walls and one obstacle; a person; the sonars of the last second, two at a time.
    assert_eq!(last.entities[0].lines.len(), 2);
    assert_eq!(last.entities[0].lines[0].points.len(), 8);
    assert_eq!(last.entities[1].cylinders.len(), 1);
    assert_eq!(last.entities[2].cubes.len(), 1);
    assert_eq!(last.entities[5].triangles.len(), 16);
    assert_eq!(last.entities[6].cylinders.len(), 1);
    assert_eq!(last.entities[7].lines[0].points.len(), 6);
}

#[test]
fn danger_is_a_bar_as_high_as_it_is() {
    for (danger, share) in [(0.0, 0.0), (0.25, 0.25), (1.0, 1.0), (7.0, 1.0)] {
        let mut events = events(5);
        for event in &mut events {
            if let Event::Step(step) = &mut event.value {
                step.danger = danger;
            }
        }
        let shown = observe(&header(), &events);
        let (_, scene) = of::<SceneUpdate>(&shown, Topic::Scene).pop().expect("drawn");
        let gauge = &scene.entities[4];
        let outline_m = gauge.lines[0].points[1].z - gauge.lines[0].points[0].z;
        let bar_m = gauge.cubes[0].size.expect("set").z;
        assert!((bar_m - share * outline_m).abs() < 1e-12, "danger {danger}: {bar_m} m");
        let middle = gauge.cubes[0].pose.and_then(|pose| pose.position).expect("set");
        assert!((middle.z - 0.5 * bar_m).abs() < 1e-12, "stands on the floor");
    }
}

#[test]
fn of_two_runs_the_first_is_drawn_fainter() {
    // The opacity of everything that moves with the robot.
    let opacities = |arm: Option<Arm>| -> Vec<f64> {
        let mut picture = Picture::of(&header(), arm);
        let mut events = events(30);
        for event in &mut events {
            if let Event::Step(step) = &mut event.value {
                step.danger = 0.5;
            }
        }
        let shown: Vec<_> = events.iter().flat_map(|event| picture.observe(event)).collect();
        let (_, scene) = of::<SceneUpdate>(&shown, Topic::Scene).pop().expect("drawn");
        let [robot, danger, sonar] = [2, 4, 5].map(|index| &scene.entities[index]);
        let cubes = [robot, danger].into_iter().flat_map(|entity| &entity.cubes);
        let colours = cubes.map(|cube| cube.color).chain(sonar.triangles.iter().map(|t| t.color));
        colours.map(|colour| colour.expect("coloured").a).collect()
    };
    let [alone, a, b] = [None, Some(Arm::A), Some(Arm::B)].map(opacities);
    assert_eq!((alone.len(), a.len()), (18, 18));
    assert_eq!(alone, b);
    assert!(a.iter().zip(&b).all(|(a, b)| 0.0 < *a && *a < 0.5 * b), "{a:?} {b:?}");
}

#[test]
fn the_body_shows_who_drives() {
    // Ten periods each: the person, then the feedback law.
    let scenes = of::<SceneUpdate>(&observe(&header(), &events(20)), Topic::Scene);
    for (index, (_, scene)) in scenes.iter().enumerate() {
        let body = scene.entities[2].cubes[0].color.expect("coloured");
        let expected = if index < 10 { colour::HUMAN } else { colour::FEEDBACK };
        assert_eq!((body.r, body.g, body.b), (expected.r, expected.g, expected.b), "{index}");
    }
}

#[test]
fn every_frame_that_is_used_hangs_in_the_world() {
    let shown = observe(&header(), &events(5));
    for (_, message) in of::<FrameTransforms>(&shown, Topic::Tf) {
        let frames: Vec<(&str, &str)> = message
            .transforms
            .iter()
            .map(|t| (t.parent_frame_id.as_str(), t.child_frame_id.as_str()))
            .collect();
        assert_eq!(
            frames,
            [("world", "odom"), ("world", "base_link"), ("odom", "base_link_estimate")]
        );
    }
    let poses = of::<PoseInFrame>(&shown, Topic::Pose);
    assert!(!poses.is_empty() && poses.iter().all(|(_, pose)| pose.frame_id == "odom"));
    let truths = of::<PoseInFrame>(&shown, Topic::PoseTruth);
    assert!(!truths.is_empty() && truths.iter().all(|(_, pose)| pose.frame_id == "world"));
    let position = truths[3].1.pose.and_then(|pose| pose.position).expect("set");
    // The session moves 0.03 m a period, from 0.5.
    assert!((position.x - 0.59).abs() < 1e-12 && (position.y + 0.5).abs() < 1e-12);
}

#[test]
fn without_a_truth_the_robot_stands_where_it_believes_to_be() {
    let mut events = events(5);
    events.retain(|event| !matches!(event.value, Event::Truth(_)));
    let shown = observe(&header(), &events);
    assert!(of::<PoseInFrame>(&shown, Topic::PoseTruth).is_empty());
    for (_, message) in of::<FrameTransforms>(&shown, Topic::Tf) {
        assert_eq!(message.transforms[1].child_frame_id, "base_link");
        assert_eq!(message.transforms[1].translation, message.transforms[2].translation);
    }
    let (_, scene) = of::<SceneUpdate>(&shown, Topic::Scene).pop().expect("drawn");
    assert!(scene.entities[3].lines.is_empty(), "no outline where the body stands");
}

#[test]
fn only_finite_numbers_are_drawn() {
    // The text form of a message shows every number that it holds.
    let mut events = events(12);
    for event in &mut events {
        match &mut event.value {
            Event::Step(step) => {
                step.pose.x_m = f64::NAN;
                step.d1_m = f64::INFINITY;
                step.target_y_m = f64::NAN;
            }
            Event::Truth(truth) => truth.discs[0].radius_m = f64::NAN,
            Event::Sample(crate::Sample::Sonar(scan)) => scan.echoes[0].range_m = f64::NAN,
            _ => {}
        }
    }
    let shown = observe(&header(), &events);
    for (_, scene) in of::<SceneUpdate>(&shown, Topic::Scene) {
        let text = format!("{scene:?}");
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
    for (_, message) in of::<FrameTransforms>(&shown, Topic::Tf) {
        assert!(!format!("{message:?}").contains("NaN"));
        assert_eq!(message.transforms.len(), 2, "no frame for an estimate that is not known");
    }
    assert!(of::<PoseInFrame>(&shown, Topic::Pose).is_empty());
}

#[test]
fn the_log_tells_each_change_of_driver() {
    let mut events = events(40);
    events.retain(|event| !matches!(event.value, Event::Gap(_)));
    let lines = of::<Log>(&observe(&header(), &events), Topic::Log);
    let drivers: Vec<&str> = lines.iter().map(|(_, log)| &log.message[..5]).collect();
    assert_eq!(drivers, ["k = 1", "k = 0", "k = 1", "k = 0"]);
}
