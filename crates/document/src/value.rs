//! The tree of a TOML file, every key with its line.

use super::{FileError, Problem};
use toml::de::{DeTable, DeValue};

/// A value of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number; TOML's integers are numbers too.
    Number(f64),
    /// A string.
    Text(String),
    /// `true` or `false`.
    Bool(bool),
    /// A list.
    Array(Array),
    /// A table, inline or under its own header.
    Table(Table),
    /// A date or a time, as written; no key of this project takes one.
    Date(String),
}

/// The elements of a list, each with its line.
pub type Array = Vec<(usize, Value)>;

/// A key of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The key as written.
    pub key: String,
    /// Line of the key, counted from 1.
    pub line: usize,
    /// Its value.
    pub value: Value,
}

/// The keys of a table in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The entries, in the order of the file.
    pub entries: Vec<Entry>,
}

impl Value {
    /// What the value is, for an error message.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Number(_) => "a number",
            Value::Text(_) => "text",
            Value::Bool(_) => "true or false",
            Value::Array(_) => "a list",
            Value::Table(_) => "a table",
            Value::Date(_) => "a date",
        }
    }
}

pub(super) fn parse(text: &str, file: &str) -> Result<Table, FileError> {
    if text.trim().is_empty() {
        return Err(FileError::whole(
            file,
            "is empty: start from one of the files in motors/",
        ));
    }
    let lines = Lines::of(text);
    match DeTable::parse(text) {
        Ok(root) => Ok(lines.table(root.get_ref())),
        Err(error) => Err(lines.syntax_error(&error, text, file)),
    }
}

/// Byte offsets at which the lines begin.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Lines {
        let begins = text.match_indices('\n').map(|(offset, _)| offset + 1);
        Lines(std::iter::once(0).chain(begins).collect())
    }

    fn line(&self, offset: usize) -> usize {
        self.0.partition_point(|&begin| begin <= offset)
    }

    fn table(&self, table: &DeTable<'_>) -> Table {
        let mut entries: Vec<(usize, Entry)> = table
            .iter()
            .map(|(key, value)| {
                let offset = key.span().start;
                let entry = Entry {
                    key: key.get_ref().to_string(),
                    line: self.line(offset),
                    value: self.value(value.get_ref()),
                };
                (offset, entry)
            })
            .collect();
        entries.sort_by_key(|(offset, _)| *offset);
        Table {
            entries: entries.into_iter().map(|(_, entry)| entry).collect(),
        }
    }

    fn value(&self, value: &DeValue<'_>) -> Value {
        match value {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(integer) => {
                Value::Number(integer_value(integer.as_str(), integer.radix()))
            }
            // The parser has checked the syntax; Rust reads the same floats, `nan` and `inf` included.
            DeValue::Float(float) => Value::Number(float.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(flag) => Value::Bool(*flag),
            DeValue::Datetime(date) => Value::Date(date.to_string()),
            DeValue::Array(items) => Value::Array(
                items
                    .iter()
                    .map(|item| (self.line(item.span().start), self.value(item.get_ref())))
                    .collect(),
            ),
            DeValue::Table(table) => Value::Table(self.table(table)),
        }
    }

    fn syntax_error(&self, error: &toml::de::Error, text: &str, file: &str) -> FileError {
        let span = error.span().unwrap_or(0..0);
        let line = self.line(span.start);
        let begin = self.0[line - 1];
        let source = text[begin..].lines().next().unwrap_or("").trim();
        let found = text.get(span).unwrap_or("").trim();
        let (key, remedy) = if error.message().starts_with("duplicate key") {
            (
                found,
                "it appears twice in its section; remove one of the two".to_owned(),
            )
        } else {
            let key = source.split(['=', ' ', '\t']).next().unwrap_or("");
            (key, format!("cannot read `{source}`: {}", advice(source)))
        };
        FileError::new(vec![Problem {
            file: file.to_owned(),
            line,
            key: key.to_owned(),
            message: format!("{}; {remedy}", error.message()),
        }])
    }
}

/// Integers beyond 64 bits become floats; their range check refuses them with their value.
fn integer_value(digits: &str, radix: u32) -> f64 {
    match i64::from_str_radix(digits, radix) {
        #[allow(clippy::cast_precision_loss)]
        Ok(value) => value as f64,
        Err(_) => digits.parse().unwrap_or(f64::INFINITY),
    }
}

/// The remedy for a line that is not TOML, from what it looks like.
fn advice(source: &str) -> &'static str {
    let value = source.split_once('=').map(|(_, value)| value.trim());
    match value {
        None if source.starts_with('[') => "a section header is `[name]`, alone on its line",
        None => "write `key = value`, with text in double quotes",
        Some("") => "the value is missing; write `key = value`",
        Some(value) if value.contains(',') && !value.contains(['[', '"']) => {
            "write decimals with a point, `3.7`, and lists in brackets, `[1.0, 2.0]`"
        }
        Some(value) if value.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) => {
            "write the number alone, as `3.7`; its unit is in the key's name"
        }
        Some(_) => "write text in double quotes and numbers without",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_keep_the_order_and_the_lines_of_the_file() {
        let text = "zeta = 1\n\n[b]\n# a comment\ny = 2\nx = [\n 1,\n 2]\n[a]\n";
        let table = parse(text, "f").expect("valid");
        let order: Vec<_> = table
            .entries
            .iter()
            .map(|entry| (entry.key.as_str(), entry.line))
            .collect();
        assert_eq!(order, [("zeta", 1), ("b", 3), ("a", 9)]);
        let Value::Table(b) = &table.entries[1].value else {
            panic!("a table")
        };
        assert_eq!((b.entries[0].line, b.entries[1].line), (5, 6));
        assert_eq!(
            b.entries[1].value,
            Value::Array(vec![(7, Value::Number(1.0)), (8, Value::Number(2.0))])
        );
    }

    #[test]
    fn numbers_of_every_form_are_read() {
        let table = parse(
            "a=0x10\nb=1_000\nc=1e3\nd=-inf\ne=99999999999999999999",
            "f",
        );
        let values: Vec<f64> = table
            .expect("valid")
            .entries
            .iter()
            .map(|entry| match entry.value {
                Value::Number(number) => number,
                _ => f64::NAN,
            })
            .collect();
        assert_eq!(values, [16.0, 1000.0, 1000.0, f64::NEG_INFINITY, 1e20]);
    }

    #[test]
    fn a_decimal_comma_and_a_unit_get_their_remedy() {
        for (text, remedy) in [
            ("[p]\nr = 3,7", "decimals with a point"),
            ("[p]\nr = 3.7 ohm", "number alone"),
            ("[p]\nr =", "value is missing"),
            ("[p]\nr = star", "double quotes"),
            ("[p\nr = 1", "section header"),
        ] {
            let error = parse(text, "f").expect_err(text).to_string();
            assert!(error.contains(remedy), "{error}");
        }
    }
}
