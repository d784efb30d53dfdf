//! WAV files of sound cards and vibration recorders: channels without names, a rate without a clock.

use super::columns::{Columns, check_size};
use super::header::{DeclaredRate, Header};
use super::table_file::TableFile;
use crate::contained::contained;
use hound::{SampleFormat, WavReader};
use recording::Error;
use std::io::Cursor;
use std::path::Path;

/// Most channels of any recorder.
const MOST_CHANNELS: u16 = 256;

/// Whether a file begins as WAV files do.
pub(super) fn is(head: &[u8]) -> bool {
    head.starts_with(b"RIFF") && head.get(8..12) == Some(b"WAVE")
}

/// Reads the channels of a file.
pub(super) fn open(path: &Path) -> Result<Box<dyn TableFile>, Error> {
    let bytes = std::fs::read(path).map_err(|error| Error::io(path, &error))?;
    of_bytes(&path.display().to_string(), bytes)
}

/// The same of a file that is in memory.
pub(super) fn of_bytes(name: &str, bytes: Vec<u8>) -> Result<Box<dyn TableFile>, Error> {
    let size = bytes.len() as u64;
    let read = contained(|| channels(name, bytes));
    let (rate_hz, values) =
        read.unwrap_or_else(|| Err(damaged(name, "its head contradicts itself")))?;
    let names = (1..=values.len()).map(|k| format!("channel {k}")).collect();
    let mut header = Header::new(name.to_owned(), 0, names)?;
    header.rate = Some(DeclaredRate {
        hz: f64::from(rate_hz),
        note: format!("{rate_hz} samples a second, as the file says"),
    });
    header.notes.push("1 is the full scale of the recorder: --scale or --sensor says how many volts or amperes that are".to_owned());
    Ok(Box::new(Columns::new(header, values, size)?))
}

fn channels(name: &str, bytes: Vec<u8>) -> Result<(u32, Vec<Vec<f64>>), Error> {
    let wrong = |error: hound::Error| damaged(name, &error.to_string());
    let mut reader = WavReader::new(Cursor::new(bytes)).map_err(wrong)?;
    let spec = reader.spec();
    if !(1..=MOST_CHANNELS).contains(&spec.channels) {
        return Err(damaged(name, &format!("{} channels", spec.channels)));
    }
    check_size(
        name,
        u64::from(reader.duration()),
        usize::from(spec.channels),
    )?;
    let full_scale = 2f64.powi(i32::from(spec.bits_per_sample) - 1);
    let values = match spec.sample_format {
        SampleFormat::Float => apart(
            reader.samples::<f32>().map(|x| x.map(f64::from)),
            spec.channels,
        ),
        SampleFormat::Int => apart(
            reader
                .samples::<i32>()
                .map(|x| x.map(|x| f64::from(x) / full_scale)),
            spec.channels,
        ),
    };
    Ok((spec.sample_rate, values.map_err(wrong)?))
}

/// Samples that stand one after the other, by channel.
fn apart(
    samples: impl Iterator<Item = hound::Result<f64>>,
    channels: u16,
) -> hound::Result<Vec<Vec<f64>>> {
    let mut values = vec![Vec::new(); usize::from(channels)];
    for (k, sample) in samples.enumerate() {
        values[k % usize::from(channels)].push(sample?);
    }
    Ok(values)
}

fn damaged(name: &str, why: &str) -> Error {
    let remedy = "record or export it again, as PCM or 32 bit float";
    Error::bad(name, format!("is no sound WAV file ({why})"), remedy)
}
