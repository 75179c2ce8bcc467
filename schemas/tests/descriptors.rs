//! Pins the wire format: every message, field name, number and type, every enum value, every topic.
//!
//! Logs live longer than programs. A field that is renamed, renumbered or changes its type makes old
//! logs unreadable without anybody noticing; this test notices. Adding a field or a value is fine:
//! look at the difference, and if it only adds, accept it (`cargo insta accept`, or
//! `INSTA_UPDATE=always cargo test -p schemas --test descriptors`).

use std::fmt::Write as _;

use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{
    DescriptorProto, EnumDescriptorProto, FieldDescriptorProto, FileDescriptorProto,
    FileDescriptorSet,
};
use schemas::log::{DESCRIPTORS, TOPICS};

fn files() -> Vec<FileDescriptorProto> {
    FileDescriptorSet::decode(DESCRIPTORS).expect("the build wrote a descriptor set").file
}

/// The wire format in a form that shows what changed, one line for each thing that old logs need.
fn wire_format() -> String {
    let mut text = String::new();
    for file in files() {
        let syntax = file.syntax();
        writeln!(text, "{} ({syntax}, package {})", file.name(), file.package()).expect("a string");
        for message in &file.message_type {
            show_message(&mut text, message, file.package());
        }
        for values in &file.enum_type {
            show_enum(&mut text, values, file.package());
        }
        text.push('\n');
    }
    text
}

fn show_message(text: &mut String, message: &DescriptorProto, scope: &str) {
    let name = format!("{scope}.{}", message.name());
    writeln!(text, "  message {name}").expect("a string");
    let mut fields: Vec<&FieldDescriptorProto> = message.field.iter().collect();
    fields.sort_by_key(|field| field.number());
    for field in fields {
        let kind = match field.r#type() {
            Type::Message | Type::Enum => field.type_name().trim_start_matches('.').to_owned(),
            scalar => scalar.as_str_name().trim_start_matches("TYPE_").to_lowercase(),
        };
        let repeated = if field.label() == Label::Repeated { "repeated " } else { "" };
        let optional = if field.proto3_optional() { "optional " } else { "" };
        writeln!(text, "    {:>3} {repeated}{optional}{kind} {}", field.number(), field.name())
            .expect("a string");
    }
    for nested in &message.nested_type {
        show_message(text, nested, &name);
    }
    for values in &message.enum_type {
        show_enum(text, values, &name);
    }
}

fn show_enum(text: &mut String, values: &EnumDescriptorProto, scope: &str) {
    writeln!(text, "  enum {scope}.{}", values.name()).expect("a string");
    for value in &values.value {
        writeln!(text, "    {:>3} {}", value.number(), value.name()).expect("a string");
    }
}

#[test]
fn the_wire_format_is_what_old_logs_have() {
    insta::assert_snapshot!("wire_format", wire_format());
}

#[test]
fn the_topics_are_what_old_logs_have() {
    let rows = TOPICS.iter().map(|info| {
        format!(
            "{} {} compared={} view={}",
            info.name,
            info.schema,
            info.compared.name(),
            info.view
        )
    });
    insta::assert_snapshot!("topics", rows.collect::<Vec<_>>().join("\n"));
}

#[test]
fn every_topic_of_ours_has_its_message() {
    let defined: Vec<String> = files()
        .iter()
        .flat_map(|file| {
            file.message_type.iter().map(|m| format!("{}.{}", file.package(), m.name()))
        })
        .collect();
    for info in TOPICS.iter().filter(|info| !info.view) {
        assert!(defined.iter().any(|name| name == info.schema), "{}", info.name);
    }
}

#[test]
fn numbers_carry_their_unit_in_their_name() {
    // What the vocabulary promises: a quantity says in its name what it is measured in. Symbols of
    // the law without a unit, and those whose unit depends on the law, are listed here.
    let units = ["_m", "_mps", "_mps2", "_rad", "_radps", "_radps2", "_s", "_ns", "_ut"];
    let without = [
        "z1",
        "z2",
        "k",
        "danger",
        "lyapunov",
        "u_f",
        "u_h",
        "u_s",
        "u_s_before_projection",
        "encoder_innovation",
        "gyro_innovation",
    ];
    for file in files() {
        for message in &file.message_type {
            for field in message.field.iter().filter(|field| field.r#type() == Type::Double) {
                let name = field.name();
                assert!(
                    units.iter().any(|unit| name.ends_with(unit)) || without.contains(&name),
                    "{}.{name} names no unit",
                    message.name()
                );
            }
        }
    }
}

#[test]
fn imports_stand_before_their_users() {
    // Readers that take a set file by file need this order.
    let files = files();
    for (index, file) in files.iter().enumerate() {
        for import in &file.dependency {
            let place = files.iter().position(|other| other.name() == import);
            assert!(place.is_some_and(|place| place < index), "{} imports {import}", file.name());
        }
    }
}
