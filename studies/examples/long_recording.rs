//! Writes a recording of any length, as a logger of a plant does: a minute of a simulated motor, over and over, with a clock that
//! goes on. Parquet has groups of a minute, instants in microseconds and a dictionary for each channel.
//!
//! `cargo run --release -p studies --example long_recording -- SCENARIO SECONDS FILE`, FILE ending in .parquet or .csv;
//! `tools/measure-memory` calls it.

use parquet::basic::{
    Compression, ConvertedType, Encoding, Repetition, Type as Physical, ZstdLevel,
};
use parquet::data_type::{DoubleType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnPath, Type};
use recording::Recording;
use scenario::{Scenario, simulate};
use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::sync::Arc;

type Outcome = Result<(), Box<dyn Error>>;

const USAGE: &str = "usage: long_recording SCENARIO SECONDS FILE.parquet|FILE.csv";

fn main() -> Outcome {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [scenario, seconds, file] = &words[..] else {
        return Err(USAGE.into());
    };
    let minute = simulate::record(&Scenario::read(Path::new(scenario))?, |_| ())?;
    let rows = (seconds.parse::<f64>()? / minute.t_sample()).round() as u64;
    let out = BufWriter::new(File::create(file)?);
    match file.ends_with(".parquet") {
        true => columns(&minute, rows, out),
        false => lines(&minute, rows, out),
    }
}

/// The rows of each repetition: number of its first row, and how many are written.
fn repetitions(minute: &Recording, rows: u64) -> impl Iterator<Item = (u64, usize)> {
    // The last sample of the minute is the first of the next one.
    let length = minute.len() as u64 - 1;
    let first = (0..rows).step_by(length as usize);
    first.map(move |first| (first, length.min(rows - first) as usize))
}

fn lines(minute: &Recording, rows: u64, mut out: impl Write) -> Outcome {
    let names: Vec<String> = minute.channels().map(|(c, _)| c.to_string()).collect();
    writeln!(out, "t,{}", names.join(","))?;
    let cells: Vec<String> = (0..minute.len())
        .map(|k| {
            minute
                .channels()
                .fold(String::new(), |line, (_, x)| format!("{line},{}", x[k]))
        })
        .collect();
    for (first, count) in repetitions(minute, rows) {
        for (k, cells) in cells.iter().take(count).enumerate() {
            let t = (first + k as u64) as f64 * minute.t_sample();
            writeln!(out, "{t:.6}{cells}")?;
        }
    }
    Ok(out.flush()?)
}

fn columns(minute: &Recording, rows: u64, out: impl Write + Send) -> Outcome {
    let clock = ColumnPath::from("t");
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_column_dictionary_enabled(clock.clone(), false)
        .set_column_encoding(clock, Encoding::DELTA_BINARY_PACKED)
        .build();
    let mut writer = SerializedFileWriter::new(out, schema(minute)?, Arc::new(properties))?;
    let step_us = (1e6 * minute.t_sample()).round() as i64;
    for (first, count) in repetitions(minute, rows) {
        let mut group = writer.next_row_group()?;
        let t: Vec<i64> = (0..count as i64)
            .map(|k| (first as i64 + k) * step_us)
            .collect();
        let mut column = group.next_column()?.ok_or("a column for the clock")?;
        column.typed::<Int64Type>().write_batch(&t, None, None)?;
        column.close()?;
        for (_, values) in minute.channels() {
            let mut column = group.next_column()?.ok_or("a column for a channel")?;
            column
                .typed::<DoubleType>()
                .write_batch(&values[..count], None, None)?;
            column.close()?;
        }
        group.close()?;
    }
    writer.into_inner()?.flush()?;
    Ok(())
}

fn schema(minute: &Recording) -> Result<Arc<Type>, Box<dyn Error>> {
    let column = |name: &str, physical, converted| {
        let column = Type::primitive_type_builder(name, physical);
        let column = column.with_repetition(Repetition::REQUIRED);
        column.with_converted_type(converted).build().map(Arc::new)
    };
    let clock = column("t", Physical::INT64, ConvertedType::TIMESTAMP_MICROS)?;
    let mut fields = vec![clock];
    for (channel, _) in minute.channels() {
        fields.push(column(
            &channel.to_string(),
            Physical::DOUBLE,
            ConvertedType::NONE,
        )?);
    }
    Ok(Arc::new(
        Type::group_type_builder("recording")
            .with_fields(fields)
            .build()?,
    ))
}
