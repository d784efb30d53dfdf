//! Writing recordings: CSV, CSV.gz or Parquet with the sidecar beside it, whole or not at all.

mod pages;
mod parquet;
mod sidecar;
mod whole;

use flate2::{Compression, GzBuilder};
use recording::names::{ends_in, sidecar_path};
use recording::{Channel, Error, Recording};
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

pub use sidecar::{reading_text, sidecar_text};
pub use whole::write_whole;

/// How the name of a recording ends, and what is written then.
const FORMATS: [(&str, Writer); 3] = [(".csv", plain), (".csv.gz", packed), (".parquet", columnar)];

type Writer = fn(&Recording, &mut BufWriter<File>) -> io::Result<()>;

/// Writes a recording to `path`, `.csv`, `.csv.gz` or `.parquet`, and its sidecar beside it.
///
/// Numbers of a CSV file are the shortest that read back to the same bits, and neither time nor name
/// of a file stands in it: the same recording gives the same bytes. Each file appears whole or not
/// at all.
///
/// # Errors
/// Another file name, or a file that cannot be written.
pub fn write_recording(path: &Path, recording: &Recording) -> Result<(), Error> {
    let name = path.display().to_string();
    let Some((_, write)) = FORMATS.iter().find(|(end, _)| ends_in(path, end)) else {
        let remedy = "choose a name that ends in .csv, .csv.gz or .parquet";
        return Err(Error::bad(&name, "is not the name of a recording", remedy));
    };
    whole(path, |file| write(recording, file))?;
    let text = sidecar_text(&recording.metadata) + &sidecar::scale_text(recording);
    whole(&sidecar_path(path), |file| file.write_all(text.as_bytes()))
}

fn plain(recording: &Recording, file: &mut BufWriter<File>) -> io::Result<()> {
    write_csv(recording, file)
}

fn columnar(recording: &Recording, file: &mut BufWriter<File>) -> io::Result<()> {
    write_parquet(recording, file)
}

fn packed(recording: &Recording, file: &mut BufWriter<File>) -> io::Result<()> {
    let gzip = GzBuilder::new().mtime(0).write(file, Compression::new(6));
    table(recording, BufWriter::new(gzip))?
        .into_inner()?
        .finish()?
        .flush()
}

/// Writes the samples of a recording as CSV text, header first; the same bytes as [`write_recording`] puts into a file.
///
/// # Errors
/// Whatever `out` refuses.
pub fn write_csv<W: Write>(recording: &Recording, out: W) -> io::Result<()> {
    table(recording, out).and_then(|mut out| out.flush())
}

/// Writes a recording as Parquet; the same bytes as [`write_recording`] puts into a file.
///
/// # Errors
/// Whatever `out` refuses.
pub fn write_parquet<W: Write + Send>(recording: &Recording, out: W) -> io::Result<()> {
    parquet::write(recording, out)
}

fn whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), Error> {
    write_whole(path, write).map_err(|error| {
        let message = format!("cannot be written: {error}");
        Error::bad(
            &path.display().to_string(),
            message,
            "check the folder and the disk",
        )
    })
}

/// The channels that are written: all but a third current that a reader computes again.
fn columns(recording: &Recording) -> Vec<(Channel, &[f64])> {
    let kept = |(channel, _): &(Channel, _)| !is_implied(recording, *channel);
    recording.channels().filter(kept).collect()
}

fn table<W: Write>(recording: &Recording, mut out: W) -> io::Result<W> {
    let columns = columns(recording);
    let mut line = String::from("t");
    for (channel, _) in &columns {
        let _ = write!(line, ",{channel}");
    }
    writeln!(out, "{line}")?;
    for (k, t) in recording.t().iter().enumerate() {
        line.clear();
        let _ = write!(line, "{t}");
        for (_, values) in &columns {
            let _ = write!(line, ",{}", values[k]);
        }
        writeln!(out, "{line}")?;
    }
    Ok(out)
}

/// A third current that a reader computes again from the other two.
fn is_implied(recording: &Recording, channel: Channel) -> bool {
    let measured =
        |other: &Channel| recording.channel(*other).is_some() && !recording.is_derived(*other);
    Channel::CURRENTS.contains(&channel)
        && recording.is_derived(channel)
        && Channel::CURRENTS
            .iter()
            .filter(|other| measured(other))
            .count()
            == 2
}
