//! Values of metrics, and what a metric is.

use super::payload::{Metric, PropertySet, PropertyValue, Wire};

/// Data types of Sparkplug B that are used here; the value is the number on the wire (Sparkplug 3.0, section 6.4.16).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Datatype {
    /// Signed, 64 bits: of `bdSeq` alone, for which the specification asks for it.
    Int64 = 4,
    /// Unsigned, 8 bits.
    UInt8 = 5,
    /// Unsigned, 16 bits.
    UInt16 = 6,
    /// Unsigned, 64 bits; numbers of 32 bits too: decoders disagree about the field in which `UInt32` travels.
    UInt64 = 8,
    /// Single precision.
    Float = 9,
    /// Truth value.
    Boolean = 11,
    /// Text.
    Text = 12,
    /// Unix time, ms.
    DateTime = 13,
}

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// [`Datatype::UInt8`] and [`Datatype::UInt16`].
    Small(u16),
    /// [`Datatype::UInt64`], [`Datatype::DateTime`] and, not negative, [`Datatype::Int64`].
    Large(u64),
    /// [`Datatype::Float`]; never NaN: a missing number is no value.
    Float(f32),
    /// [`Datatype::Boolean`].
    Boolean(bool),
    /// [`Datatype::Text`].
    Text(String),
}

impl Value {
    /// A number; `None` where it is not finite.
    pub fn number(value: f32) -> Option<Value> {
        value.is_finite().then_some(Value::Float(value))
    }

    fn wire(&self) -> Wire {
        match self {
            Value::Small(x) => Wire::Int(u32::from(*x)),
            Value::Large(x) => Wire::Long(*x),
            Value::Float(x) => Wire::Float(*x),
            Value::Boolean(x) => Wire::Boolean(*x),
            Value::Text(x) => Wire::Text(x.clone()),
        }
    }
}

/// What a metric is.
#[derive(Clone, Copy, Debug)]
pub struct Definition {
    /// Its name; `/` makes folders.
    pub name: &'static str,
    /// Its type.
    pub datatype: Datatype,
    /// Engineering unit; empty: none.
    pub unit: &'static str,
    /// What it says.
    pub meaning: &'static str,
}

impl Definition {
    /// The metric in a birth: name, alias, type and unit, with its present value.
    pub(super) fn born(&self, alias: Option<u64>, at_ms: u64, value: Option<&Value>) -> Metric {
        Metric {
            name: Some(self.name.to_owned()),
            datatype: Some(self.datatype as u32),
            properties: (!self.unit.is_empty()).then(|| unit(self.unit)),
            ..metric(alias, at_ms, value)
        }
    }
}

/// The metric in a data message.
pub(super) fn metric(alias: Option<u64>, at_ms: u64, value: Option<&Value>) -> Metric {
    Metric {
        alias,
        timestamp: Some(at_ms),
        is_null: value.is_none().then_some(true),
        value: value.map(Value::wire),
        ..Metric::default()
    }
}

/// The property by which hosts know an engineering unit.
fn unit(unit: &str) -> PropertySet {
    let value = PropertyValue {
        datatype: Some(Datatype::Text as u32),
        is_null: None,
        text: Some(unit.to_owned()),
    };
    PropertySet {
        keys: vec!["engUnit".to_owned()],
        values: vec![value],
    }
}
