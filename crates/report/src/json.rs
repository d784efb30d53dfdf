//! The JSON of an answer: it names its format, and a JSON Schema (draft 2020-12) describes every key.
//!
//! ```
//! # use report::json::{Answer, text};
//! #[derive(serde::Serialize, schemars::JsonSchema)]
//! struct Turns {
//!     /// Speed, rad/s.
//!     speed_rad_s: f64,
//! }
//! impl Answer for Turns {
//!     const FORMAT: &'static str = "turns/1";
//! }
//! let json = text(&Turns { speed_rad_s: 151.8 }).expect("JSON");
//! assert!(json.starts_with("{\n  \"format\": \"turns/1\","));
//! ```

use std::io::Write;

use replay::operating_points::OperatingPoints;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::Serialize;
use serde_json::{Value, json};

use crate::study::{Adopted, Calibration, Checkup, Compared, Explained, Monitored};

/// The key that names the format.
const KEY: &str = "format";

/// What a command answers, as JSON holds it.
pub trait Answer: Serialize + JsonSchema {
    /// `NAME/VERSION`. The version rises where a key goes or changes its meaning; a new key leaves it as it is.
    const FORMAT: &'static str;
}

impl Answer for Monitored {
    const FORMAT: &'static str = "monitor/1";
}

impl Answer for OperatingPoints {
    const FORMAT: &'static str = "load-table/1";
}

impl Answer for Checkup {
    const FORMAT: &'static str = "check/1";
}

impl Answer for Compared {
    const FORMAT: &'static str = "compare/1";
}

impl Answer for Explained {
    const FORMAT: &'static str = "explain/1";
}

impl Answer for Adopted {
    const FORMAT: &'static str = "adopt/1";
}

impl Answer for Calibration {
    const FORMAT: &'static str = "calibrate/1";
}

#[derive(Serialize)]
struct Named<'a, A> {
    format: &'static str,
    #[serde(flatten)]
    answer: &'a A,
}

/// An answer as JSON, in lines.
///
/// # Errors
/// A value that JSON cannot say.
pub fn text<A: Answer>(answer: &A) -> Result<String, serde_json::Error> {
    serde_json::to_string_pretty(&named(answer))
}

/// Writes an answer as JSON, in lines, as it is made: a long one is no text in memory first.
///
/// # Errors
/// A value that JSON cannot say, and what `out` refuses.
pub fn write<A: Answer>(answer: &A, out: impl Write) -> Result<(), serde_json::Error> {
    serde_json::to_writer_pretty(out, &named(answer))
}

/// An answer as a JSON value.
///
/// # Errors
/// A value that JSON cannot say.
pub fn value<A: Answer>(answer: &A) -> Result<Value, serde_json::Error> {
    serde_json::to_value(named(answer))
}

fn named<A: Answer>(answer: &A) -> Named<'_, A> {
    Named {
        format: A::FORMAT,
        answer,
    }
}

/// A format and its JSON Schema.
#[derive(Clone, Debug)]
pub struct Format {
    /// `NAME/VERSION`.
    pub name: &'static str,
    /// Its schema.
    pub schema: Schema,
}

impl Format {
    /// The format of an answer.
    pub fn of<A: Answer>() -> Format {
        Format {
            name: A::FORMAT,
            schema: schema::<A>(),
        }
    }
}

/// The formats of this crate's answers.
pub fn formats() -> Vec<Format> {
    vec![
        Format::of::<Monitored>(),
        Format::of::<OperatingPoints>(),
        Format::of::<Checkup>(),
        Format::of::<Compared>(),
        Format::of::<Explained>(),
        Format::of::<Adopted>(),
        Format::of::<Calibration>(),
    ]
}

fn schema<A: Answer>() -> Schema {
    let generator = SchemaSettings::draft2020_12()
        .for_serialize()
        .into_generator();
    let mut schema = generator.into_root_schema_for::<A>();
    schema.insert("$id".to_owned(), json!(A::FORMAT));
    let name = json!({ "const": A::FORMAT, "description": "Name and version of this format." });
    entry(&mut schema, "properties", json!({}))[KEY] = name;
    if let Value::Array(required) = entry(&mut schema, "required", json!([])) {
        required.insert(0, json!(KEY));
    }
    schema
}

fn entry<'a>(schema: &'a mut Schema, key: &str, otherwise: Value) -> &'a mut Value {
    let object = schema.ensure_object();
    object.entry(key.to_owned()).or_insert(otherwise)
}
