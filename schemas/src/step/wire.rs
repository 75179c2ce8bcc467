//! The types that fields can have, and how they go to and from protobuf.

use super::Value;
use crate::{Pose, proto};

/// What a field's type can be.
pub(super) trait FieldType {
    /// Not known.
    const UNKNOWN: Self;
    /// What a reader sees of it.
    fn value(&self) -> Value;
    /// Leaves out what may be left out, where `other` does.
    fn leave_out_as(&mut self, _other: &Self) {}
}

/// How a field goes to and from a protobuf field of type `W`.
pub(super) trait Wire<W>: Sized {
    fn to_wire(&self) -> W;
    fn from_wire(wire: W) -> Self;
}

/// The number as a log holds it: one NaN, no negative zero (proto3 leaves out zeros of either sign),
/// so that equal logs have equal bytes.
pub(crate) fn canonical(x: f64) -> f64 {
    // Adding zero takes −0 to +0 and leaves every other number as it is.
    if x.is_nan() { f64::NAN } else { x + 0.0 }
}

impl FieldType for f64 {
    const UNKNOWN: f64 = f64::NAN;

    fn value(&self) -> Value {
        Value::Number(*self)
    }
}

impl Wire<f64> for f64 {
    fn to_wire(&self) -> f64 {
        canonical(*self)
    }
    fn from_wire(wire: f64) -> Self {
        wire
    }
}

/// Of a number that came to the schema later: a log from before has none, and it is unknown.
impl Wire<Option<f64>> for f64 {
    fn to_wire(&self) -> Option<f64> {
        (!self.is_nan()).then(|| canonical(*self))
    }
    fn from_wire(wire: Option<f64>) -> Self {
        wire.unwrap_or(f64::NAN)
    }
}

impl FieldType for [f64; 2] {
    const UNKNOWN: [f64; 2] = [f64::NAN; 2];

    fn value(&self) -> Value {
        Value::Pair(*self)
    }
}

impl Wire<Vec<f64>> for [f64; 2] {
    fn to_wire(&self) -> Vec<f64> {
        vec![canonical(self[0]), canonical(self[1])]
    }
    fn from_wire(wire: Vec<f64>) -> Self {
        [wire.first().copied().unwrap_or(f64::NAN), wire.get(1).copied().unwrap_or(f64::NAN)]
    }
}

impl FieldType for Pose {
    const UNKNOWN: Pose = Pose { x_m: f64::NAN, y_m: f64::NAN, theta_rad: f64::NAN };

    fn value(&self) -> Value {
        Value::Pose(*self)
    }
}

impl Wire<Option<proto::Pose>> for Pose {
    fn to_wire(&self) -> Option<proto::Pose> {
        Some((*self).into())
    }
    fn from_wire(wire: Option<proto::Pose>) -> Self {
        wire.map_or(Self::UNKNOWN, Pose::from)
    }
}

impl FieldType for u64 {
    const UNKNOWN: u64 = 0;

    fn value(&self) -> Value {
        Value::Hash(*self)
    }
}

impl FieldType for i32 {
    const UNKNOWN: i32 = 0;

    fn value(&self) -> Value {
        Value::Integer(i64::from(*self))
    }
}

impl FieldType for bool {
    const UNKNOWN: bool = false;

    fn value(&self) -> Value {
        Value::Flag(*self)
    }
}

/// A field that a step may do without.
impl<T: FieldType> FieldType for Option<T> {
    const UNKNOWN: Option<T> = None;

    fn value(&self) -> Value {
        self.as_ref().map_or(Value::Absent, FieldType::value)
    }

    fn leave_out_as(&mut self, other: &Self) {
        if other.is_none() {
            *self = None;
        }
    }
}

impl<T: Wire<T>> Wire<Option<T>> for Option<T> {
    fn to_wire(&self) -> Option<T> {
        self.as_ref().map(Wire::to_wire)
    }
    fn from_wire(wire: Option<T>) -> Self {
        wire.map(Wire::from_wire)
    }
}

/// Types that are the same on the wire.
macro_rules! plain {
    ($($type:ty),*) => {
        $(impl Wire<$type> for $type {
            fn to_wire(&self) -> $type {
                *self
            }
            fn from_wire(wire: $type) -> Self {
                wire
            }
        })*
    };
}

plain!(u64, i32, bool);
