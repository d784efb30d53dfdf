//! Sparkplug B payloads as bytes: the messages of `sparkplug_b.proto` (Sparkplug 3.0, section 6.4.1) that an edge node needs.
//!
//! Data sets, templates and extensions stay bytes: this node sends none, and of a command it only wants to know that it has
//! a value of another kind.

use prost::Message as _;
use thiserror::Error;

/// Largest payload that is decoded, bytes. A command has a handful of metrics.
pub const MAX_COMMAND_BYTES: usize = 64 * 1024;

/// A payload.
#[derive(Clone, PartialEq, prost::Message)]
pub struct Payload {
    /// When it was sent, Unix ms.
    #[prost(uint64, optional, tag = "1")]
    pub timestamp: Option<u64>,
    /// Its metrics.
    #[prost(message, repeated, tag = "2")]
    pub metrics: Vec<Metric>,
    /// Sequence number, 0 to 255.
    #[prost(uint64, optional, tag = "3")]
    pub seq: Option<u64>,
    /// Of a schema; not used here.
    #[prost(string, optional, tag = "4")]
    pub uuid: Option<String>,
    /// Bytes of the application; not used here.
    #[prost(bytes = "vec", optional, tag = "5")]
    pub body: Option<Vec<u8>>,
}

/// One value of a metric.
#[derive(Clone, PartialEq, prost::Message)]
pub struct Metric {
    /// Its name: in births, and where it has no alias.
    #[prost(string, optional, tag = "1")]
    pub name: Option<String>,
    /// Its alias, unique within the edge node.
    #[prost(uint64, optional, tag = "2")]
    pub alias: Option<u64>,
    /// When the value was measured, Unix ms.
    #[prost(uint64, optional, tag = "3")]
    pub timestamp: Option<u64>,
    /// Number of a [`Datatype`](super::value::Datatype): in births.
    #[prost(uint32, optional, tag = "4")]
    pub datatype: Option<u32>,
    /// A value of the past: not the present one.
    #[prost(bool, optional, tag = "5")]
    pub is_historical: Option<bool>,
    /// A value that is not to be kept.
    #[prost(bool, optional, tag = "6")]
    pub is_transient: Option<bool>,
    /// There is no value.
    #[prost(bool, optional, tag = "7")]
    pub is_null: Option<bool>,
    /// Not used here.
    #[prost(bytes = "vec", optional, tag = "8")]
    pub metadata: Option<Vec<u8>>,
    /// Its properties: in births.
    #[prost(message, optional, tag = "9")]
    pub properties: Option<PropertySet>,
    /// The value.
    #[prost(oneof = "Wire", tags = "10, 11, 12, 13, 14, 15, 16, 17, 18, 19")]
    pub value: Option<Wire>,
}

/// A value as it travels.
#[derive(Clone, PartialEq, prost::Oneof)]
pub enum Wire {
    /// Integers of up to 32 bits.
    #[prost(uint32, tag = "10")]
    Int(u32),
    /// Integers of 64 bits; signed ones in two's complement.
    #[prost(uint64, tag = "11")]
    Long(u64),
    /// Single precision.
    #[prost(float, tag = "12")]
    Float(f32),
    /// Double precision.
    #[prost(double, tag = "13")]
    Double(f64),
    /// Truth value.
    #[prost(bool, tag = "14")]
    Boolean(bool),
    /// Text.
    #[prost(string, tag = "15")]
    Text(String),
    /// Bytes.
    #[prost(bytes, tag = "16")]
    Bytes(Vec<u8>),
    /// A data set, not decoded.
    #[prost(bytes, tag = "17")]
    Dataset(Vec<u8>),
    /// A template, not decoded.
    #[prost(bytes, tag = "18")]
    Template(Vec<u8>),
    /// An extension, not decoded.
    #[prost(bytes, tag = "19")]
    Extension(Vec<u8>),
}

/// Properties of a metric: as many keys as values.
#[derive(Clone, PartialEq, prost::Message)]
pub struct PropertySet {
    /// Names.
    #[prost(string, repeated, tag = "1")]
    pub keys: Vec<String>,
    /// Values, in the order of the names.
    #[prost(message, repeated, tag = "2")]
    pub values: Vec<PropertyValue>,
}

/// Value of a property; this node only has texts.
#[derive(Clone, PartialEq, prost::Message)]
pub struct PropertyValue {
    /// Number of a [`Datatype`](super::value::Datatype).
    #[prost(uint32, optional, tag = "1")]
    pub datatype: Option<u32>,
    /// There is no value.
    #[prost(bool, optional, tag = "2")]
    pub is_null: Option<bool>,
    /// The text.
    #[prost(string, optional, tag = "8")]
    pub text: Option<String>,
}

/// Why bytes are no payload.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PayloadError {
    /// Too long to be a command.
    #[error("a payload of {0} bytes; at most {MAX_COMMAND_BYTES} are read")]
    Length(usize),
    /// Not protobuf, or another message.
    #[error("no Sparkplug B payload: {0}")]
    Decode(#[from] prost::DecodeError),
}

impl Payload {
    /// The payload as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.encode_to_vec()
    }

    /// Reads a payload that somebody sent.
    ///
    /// # Errors
    /// More than [`MAX_COMMAND_BYTES`], or no payload.
    pub fn from_bytes(bytes: &[u8]) -> Result<Payload, PayloadError> {
        if bytes.len() > MAX_COMMAND_BYTES {
            return Err(PayloadError::Length(bytes.len()));
        }
        Ok(Payload::decode(bytes)?)
    }
}
