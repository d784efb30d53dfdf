//! The page of the JSON's keys is written from the schemas that the program prints.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use serde_json::Value;

use crate::root;

const INTRODUCTION: &str = "\
# The JSON of every command

`--json FILE` (`-` for standard output) writes the whole answer of a command; a [Python](python.md) object's `json()` holds the same bytes. This page is
written from the schemas that `drivemon schema NAME` prints ([JSON Schema](https://json-schema.org), draft 2020-12), by the test
`crates/drivemon/tests/docs`; `tools/check-json` holds answers about shipped recordings against them with an independent validator.

Each answer names its format in the key `format`, as `monitor/1`. The number rises where a key goes or changes its meaning. A new key leaves it as it
is: read the keys that you know, ignore the others. Of several recordings the JSON is a list of answers, in their order. A key's unit is the end of its
name, or the description says it. A number that could not be told is `null`.
";

#[test]
fn the_page_of_the_json_says_what_the_schemas_say() {
    let path = root().join("docs/json.md");
    let fresh = page();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, &fresh).expect("writable");
    }
    let page = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        page == fresh,
        "docs/json.md is stale: run with UPDATE_DOCS=1"
    );
}

fn schema(arguments: &[&str]) -> String {
    let run = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .arg("schema")
        .args(arguments)
        .env("NO_COLOR", "1")
        .output()
        .expect("runs");
    assert!(run.status.success());
    String::from_utf8(run.stdout).expect("text")
}

fn page() -> String {
    let mut page = INTRODUCTION.to_owned();
    let mut objects = BTreeMap::new();
    let listed = schema(&[]);
    let names = listed.lines().filter_map(|line| line.split_once(' '));
    for (name, _) in names {
        let schema: Value = serde_json::from_str(&schema(&[name])).expect("JSON");
        page += &format!("\n## `{name}`\n\n{}\n", described(&schema, name));
        page += &content(&schema, name);
        for (object, schema) in schema["$defs"].as_object().into_iter().flatten() {
            let known = objects.insert(object.clone(), schema.clone());
            assert!(
                known.is_none_or(|known| known == *schema),
                "two objects have the name {object}: the second one in {name}"
            );
        }
    }
    page += "\n# What they hold\n";
    for (name, schema) in &objects {
        page += &format!("\n### {name}\n\n{}\n", described(schema, name));
        page += &content(schema, name);
    }
    page
}

/// Every key and every object says what it is.
fn described(schema: &Value, name: &str) -> String {
    let text = schema["description"].as_str();
    let text = text.unwrap_or_else(|| panic!("{name} has no description"));
    text.replace("\n\n", " ").replace('\n', " ")
}

/// The keys of an object, or the words of an enumeration.
fn content(schema: &Value, name: &str) -> String {
    if let Some(keys) = schema["properties"].as_object() {
        let required = schema["required"].as_array();
        let always = |key: &str| required.is_some_and(|keys| keys.iter().any(|k| k == key));
        let rows = keys.iter().map(|(key, about)| {
            let text = described(about, &format!("{name}.{key}"));
            let absent = if always(key) { "" } else { "; may be absent" };
            format!("| `{key}` | {}{absent} | {text} |\n", kind(about))
        });
        return format!(
            "\n| key | type | |\n|---|---|---|\n{}",
            rows.collect::<String>()
        );
    }
    let words = schema["oneOf"].as_array().into_iter().flatten();
    let rows: String = words
        .flat_map(|word| match word["enum"].as_array() {
            Some(bare) => bare.iter().map(|word| panicking(word, name)).collect(),
            None => vec![format!(
                "- `{}`: {}\n",
                text_of(&word["const"]),
                described(word, name)
            )],
        })
        .collect();
    if rows.is_empty() {
        rows
    } else {
        format!("\n{rows}")
    }
}

fn panicking(word: &Value, name: &str) -> String {
    panic!("{name}: {word} has no description")
}

fn text_of(value: &Value) -> &str {
    value.as_str().expect("a word")
}

/// The type of a value, in words.
fn kind(schema: &Value) -> String {
    if let Some(object) = schema["$ref"].as_str() {
        let name = object.trim_start_matches("#/$defs/");
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(either) = schema["anyOf"].as_array() {
        return either.iter().map(kind).collect::<Vec<_>>().join(" or ");
    }
    if let Some(word) = schema["const"].as_str() {
        return format!("`{word}`");
    }
    match &schema["type"] {
        Value::String(one) => of_type(one, schema),
        Value::Array(several) => {
            let all = several.iter().map(|one| of_type(text_of(one), schema));
            all.collect::<Vec<_>>().join(" or ")
        }
        _ => "any value".to_owned(),
    }
}

fn of_type(name: &str, schema: &Value) -> String {
    match name {
        "array" => list(schema),
        "object" => format!("{} by name", kind(&schema["additionalProperties"])),
        "null" => "`null`".to_owned(),
        "string" => "text".to_owned(),
        "boolean" => "true or false".to_owned(),
        "integer" => "whole number".to_owned(),
        other => other.to_owned(),
    }
}

fn list(schema: &Value) -> String {
    if let Some(items) = schema["prefixItems"].as_array() {
        let kinds = items.iter().map(kind).collect::<Vec<_>>();
        return format!("[{}]", kinds.join(", "));
    }
    let of = kind(&schema["items"]);
    match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
        (Some(low), Some(high)) if low == high => format!("{low} × {of}"),
        _ => format!("list of {of}"),
    }
}
