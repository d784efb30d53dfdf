//! A list of JSON objects as a table: one column per key.

use arrow_array::builder::{Float64Builder, ListBuilder};
use arrow_array::{
    ArrayRef, BooleanArray, Float64Array, RecordBatch, RecordBatchOptions, StringArray,
};
use arrow_schema::{ArrowError, Field, Schema};
use serde_json::Value;
use std::sync::Arc;

/// The table; what a row does not have is null. Keys of nested objects follow their parent's after a point.
pub fn batch(rows: &[Value]) -> Result<RecordBatch, ArrowError> {
    let flat: Vec<Vec<(String, &Value)>> = rows.iter().map(|row| flat("", row)).collect();
    let mut keys: Vec<&str> = Vec::new();
    for (key, _) in flat.iter().flatten() {
        if !keys.contains(&key.as_str()) {
            keys.push(key);
        }
    }
    let cell = |row: &Vec<(String, _)>, key: &str| {
        let found = row.iter().find(|(known, _)| known == key);
        found.map_or(&Value::Null, |(_, value)| *value)
    };
    let columns = keys.iter().map(|key| {
        let cells: Vec<&Value> = flat.iter().map(|row| cell(row, key)).collect();
        column(&cells)
    });
    let columns: Vec<ArrayRef> = columns.collect();
    let fields = keys.iter().zip(&columns);
    let fields: Vec<Field> = fields
        .map(|(key, column)| Field::new(*key, column.data_type().clone(), true))
        .collect();
    let options = RecordBatchOptions::new().with_row_count(Some(rows.len()));
    RecordBatch::try_new_with_options(Arc::new(Schema::new(fields)), columns, &options)
}

/// Keys and values of an object and of the objects inside it.
fn flat<'v>(parent: &str, value: &'v Value) -> Vec<(String, &'v Value)> {
    let Value::Object(object) = value else {
        let name = if parent.is_empty() { "value" } else { parent };
        return vec![(name.to_owned(), value)];
    };
    let inside = object.iter().flat_map(|(key, value)| {
        let key = match parent {
            "" => key.clone(),
            parent => format!("{parent}.{key}"),
        };
        match value {
            Value::Object(_) => flat(&key, value),
            _ => vec![(key, value)],
        }
    });
    inside.collect()
}

fn column(cells: &[&Value]) -> ArrayRef {
    let all = |is: fn(&Value) -> bool| cells.iter().all(|cell| cell.is_null() || is(cell));
    if all(Value::is_number) {
        let numbers = cells.iter().map(|cell| cell.as_f64());
        return Arc::new(numbers.collect::<Float64Array>());
    }
    if all(Value::is_boolean) {
        let truths = cells.iter().map(|cell| cell.as_bool());
        return Arc::new(truths.collect::<BooleanArray>());
    }
    if all(is_numbers) {
        return lists(cells);
    }
    let texts = cells.iter().map(|cell| match cell {
        Value::Null => None,
        Value::String(text) => Some(text.clone()),
        other => Some(other.to_string()),
    });
    Arc::new(texts.collect::<StringArray>())
}

fn is_numbers(cell: &Value) -> bool {
    let list = cell.as_array();
    list.is_some_and(|list| list.iter().all(Value::is_number))
}

fn lists(cells: &[&Value]) -> ArrayRef {
    let mut builder = ListBuilder::new(Float64Builder::new());
    for cell in cells {
        let numbers = cell.as_array();
        for number in numbers.into_iter().flatten() {
            builder.values().append_option(number.as_f64());
        }
        builder.append(numbers.is_some());
    }
    Arc::new(builder.finish())
}
