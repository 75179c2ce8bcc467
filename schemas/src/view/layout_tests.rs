//! Contract of the layout: a viewer accepts its form, everything that it names exists, and nothing
//! hides what it is there to show. The form is what Foxglove Studio 1.48 was seen to accept.

use std::collections::{BTreeMap, BTreeSet};

use prost::Message;
use prost_types::FileDescriptorSet;
use prost_types::field_descriptor_proto::Type;
use serde_json::Value;

use super::{LAYOUT, LAYOUT_AB};
use crate::log::{Arm, TOPICS, Topic, schema_data};

fn layouts() -> [Value; 2] {
    [LAYOUT, LAYOUT_AB].map(|layout| serde_json::from_str(layout).expect("JSON"))
}

/// Every string under a key that holds a message path or a topic, but those that are left empty.
fn paths(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                match (key.as_str(), value) {
                    (
                        "value" | "path" | "topicPath" | "diffTopicPath" | "topicToRender",
                        Value::String(path),
                    ) => {
                        found.extend(Some(path).filter(|path| !path.is_empty()).cloned());
                    }
                    ("topics", Value::Object(topics)) => found.extend(topics.keys().cloned()),
                    _ => paths(value, found),
                }
            }
        }
        Value::Array(items) => items.iter().for_each(|item| paths(item, found)),
        _ => {}
    }
}

/// The kind of panel that an identifier like `Plot!v` names.
fn kind_of(id: &str) -> &str {
    id.split('!').next().unwrap_or(id)
}

/// The panels that a tree of the layout shows, those in tabs included.
fn panels(layout: &Value, tree: &Value, found: &mut BTreeSet<String>) {
    match tree {
        Value::String(id) => {
            assert!(found.insert(id.clone()), "{id} stands twice in the tree");
            for tab in layout["configById"][id]["tabs"].as_array().into_iter().flatten() {
                assert!(tab["title"].is_string());
                panels(layout, &tab["layout"], found);
            }
        }
        Value::Object(node) => {
            assert!(matches!(node["direction"].as_str(), Some("row" | "column")));
            assert!(node["splitPercentage"].is_number());
            panels(layout, &node["first"], found);
            panels(layout, &node["second"], found);
        }
        other => panic!("neither a panel nor a split: {other}"),
    }
}

/// Whether a path like `/step.u_h[0]` leads to a field of the topic's message.
fn exists(path: &str) -> bool {
    let mut parts = path.split('.');
    let topic = parts.next().and_then(Arm::split);
    let Some((_, topic)) = topic else { return false };
    let data = schema_data(topic);
    let set = FileDescriptorSet::decode(data.as_slice()).expect("a descriptor set");
    let mut message = format!(".{}", topic.info().schema);
    for part in parts {
        let name = part.split('[').next().unwrap_or(part);
        let definition = set.file.iter().find_map(|file| {
            let package = file.package();
            file.message_type.iter().find(|m| format!(".{package}.{}", m.name()) == message)
        });
        let Some(field) = definition.and_then(|m| m.field.iter().find(|f| f.name() == name)) else {
            return false;
        };
        if field.r#type() == Type::Message {
            message = field.type_name().to_owned();
        }
    }
    true
}

#[test]
fn the_form_is_what_viewers_accept() {
    for layout in layouts() {
        for key in ["configById", "globalVariables", "userNodes", "layout"] {
            assert!(layout.get(key).is_some(), "{key}");
        }
        assert_eq!(layout["playbackConfig"]["speed"], 1);
        assert!(layout.get("version").is_none(), "a version that it does not know blocks a viewer");

        let mut shown = BTreeSet::new();
        panels(&layout, &layout["layout"], &mut shown);
        let configured: BTreeSet<String> =
            layout["configById"].as_object().expect("a map").keys().cloned().collect();
        assert_eq!(shown, configured);
        let kinds = [
            "3D",
            "Gauge",
            "Indicator",
            "Plot",
            "RawMessages",
            "RosOut",
            "StateTransitions",
            "Tab",
        ];
        for kind in kinds {
            assert!(shown.iter().any(|id| id.starts_with(&format!("{kind}!"))), "no {kind} panel");
        }
        for id in &shown {
            assert!(kinds.contains(&kind_of(id)), "{id}: an unknown kind");
        }
    }
}

#[test]
fn every_path_leads_somewhere() {
    for (layout, arms) in layouts().into_iter().zip([&[""][..], &["/A", "/B"]]) {
        let mut found = Vec::new();
        paths(&layout["configById"], &mut found);
        assert!(found.len() > 20, "{}", found.len());
        for path in &found {
            assert!(exists(path), "{path} leads nowhere");
            // A topic of one run is none of a log of two, and the other way about.
            let topic = path.split_once('.').map_or(path.as_str(), |(topic, _)| topic);
            let (arm, _) = Arm::split(topic).expect("it exists");
            let prefix = arm.map_or(String::new(), |arm| format!("/{}", arm.name()));
            assert!(arms.contains(&prefix.as_str()), "{path}");
        }
    }
    // The walk can tell.
    for wrong in ["/nosuch", "/step.nosuch", "/step.pose.nosuch", "step.k", "/C/step.k"] {
        assert!(!exists(wrong), "{wrong}");
    }
    assert!(exists("/step.pose.x_m") && exists("/step.u_h[0]") && exists("/A/step.u_h[0]"));
}

#[test]
fn two_runs_are_shown_alike() {
    let [_, layout] = layouts();
    // What a panel can show of one run only stands beside its like for the other.
    let mut groups: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (id, panel) in layout["configById"].as_object().expect("a map") {
        let alone = matches!(kind_of(id), "Gauge" | "Indicator" | "RosOut");
        let group = if alone { kind_of(id) } else { id.as_str() };
        paths(panel, groups.entry(group).or_default());
    }
    for (group, found) in groups {
        let of = |arm: &str| {
            let stripped = found.iter().filter_map(|path| path.strip_prefix(arm));
            stripped.map(str::to_owned).collect::<BTreeSet<_>>()
        };
        assert_eq!(of("/A"), of("/B"), "{group}");
    }
}

#[test]
fn the_legend_of_a_plot_lies_beside_the_curves() {
    for layout in layouts() {
        for (id, panel) in layout["configById"].as_object().expect("a map") {
            if kind_of(id) == "Plot" {
                let curves = panel["paths"].as_array().map_or(0, Vec::len);
                let wanted = if curves == 1 { "none" } else { "left" };
                assert_eq!(panel["legendDisplay"], wanted, "{id}");
                // A value would push the label out of a legend this narrow.
                assert_eq!(panel["showPlotValuesInLegend"], false, "{id}");
                assert_eq!(panel["foxglovePanelTitle"], panel["title"], "{id}");
            }
        }
    }
}

#[test]
fn gauge_and_indicator_know_every_value_that_means_something() {
    for layout in layouts() {
        for (id, panel) in layout["configById"].as_object().expect("a map") {
            let path = panel["path"].as_str().unwrap_or_default();
            match kind_of(id) {
                // The graded signal to the person lies between 0 and 1.
                "Gauge" => {
                    assert!(path.ends_with("/step.danger"), "{path}");
                    assert_eq!([&panel["minValue"], &panel["maxValue"]], [0, 1], "{id}");
                }
                // The sharing function (13) is 1 for the person and 0 for the feedback law.
                "Indicator" => {
                    assert!(path.ends_with("/step.k"), "{path}");
                    let rules = panel["rules"].as_array().expect("rules");
                    let said = rules.iter().map(|rule| {
                        assert_eq!(rule["operator"], "=", "{id}");
                        [&rule["rawValue"], &rule["label"]]
                    });
                    let said: Vec<_> = said.collect();
                    assert_eq!(said, [["1", "person"], ["0", "controller"]], "{id}");
                }
                _ => {}
            }
        }
    }
}

#[test]
fn what_viewers_need_is_visible_in_the_scene() {
    for (layout, arms) in layouts().iter().zip([&[""][..], &["/A", "/B"]]) {
        let topics = &layout["configById"]["3D!scene"]["topics"];
        for topic in [Topic::Scene, Topic::Tf] {
            for arm in arms {
                let name = format!("{arm}{}", topic.name());
                assert_eq!(topics[&name]["visible"], true, "{name}");
            }
        }
    }
    assert!(TOPICS.iter().filter(|info| info.view).count() >= 5);
}
