//! Writing recordings: CSV, CSV.gz or Parquet with the sidecar beside it, whole or not at all.

mod pages;
mod parquet;
mod sidecar;
mod whole;

use flate2::{Compression, GzBuilder};
use recording::names::{ends_in, sidecar_path};
use recording::{Channel, Error, Recording};
use std::borrow::Cow;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

pub use sidecar::{reading_text, sidecar_text};
pub use whole::write_whole;

/// How the name of a recording ends, and what is written then.
const FORMATS: [(&str, Writer); 3] = [(".csv", plain), (".csv.gz", packed), (".parquet", columnar)];

type Writer = fn(&mut Next<'_, '_>, &mut BufWriter<File>) -> io::Result<()>;

/// Gives the next piece of a recording; none behind the last.
type Next<'n, 'r> = dyn FnMut() -> io::Result<Option<Cow<'r, Recording>>> + 'n;

/// Writes a recording to `path`, `.csv`, `.csv.gz` or `.parquet`, and its sidecar beside it.
///
/// Numbers of a CSV file are the shortest that read back to the same bits, and neither time nor name
/// of a file stands in it: the same recording gives the same bytes. Each file appears whole or not
/// at all.
///
/// # Errors
/// Another file name, or a file that cannot be written.
pub fn write_recording(path: &Path, recording: &Recording) -> Result<(), Error> {
    let write = writer(path)?;
    whole(path, |file| write(&mut once(recording), file))?;
    write_sidecar(path, recording)
}

/// The same of a recording that comes in consecutive pieces, of which one is in memory at a time. The bytes of a text do not depend on
/// how it is cut; a Parquet file has a group of rows for each piece.
///
/// # Errors
/// As [`write_recording`], and the first error among the pieces; nothing is written then.
pub fn write_in_pieces<E: From<Error>>(
    path: &Path,
    pieces: &mut dyn Iterator<Item = Result<Recording, E>>,
) -> Result<(), E> {
    let write = writer(path)?;
    let (mut first, mut failed) = (None, None);
    let mut next = || match pieces.next().transpose() {
        Ok(None) => Ok(None),
        Ok(Some(piece)) => {
            // A sidecar says what is known of the whole.
            let head = || piece.slice(0..2).map_err(io::Error::other);
            first = Some(first.take().map_or_else(head, Ok)?);
            Ok(Some(Cow::Owned(piece)))
        }
        Err(error) => {
            failed = Some(error);
            // Ends the writing; `failed` is what is told.
            Err(io::Error::other("a piece failed"))
        }
    };
    let written = whole(path, |file| write(&mut next, file));
    if let Some(error) = failed {
        return Err(error);
    }
    written?;
    match first {
        Some(first) => Ok(write_sidecar(path, &first)?),
        None => Ok(()),
    }
}

fn writer(path: &Path) -> Result<Writer, Error> {
    let found = FORMATS.iter().find(|(end, _)| ends_in(path, end));
    found.map(|(_, write)| *write).ok_or_else(|| {
        let remedy = "choose a name that ends in .csv, .csv.gz or .parquet";
        let name = path.display().to_string();
        Error::bad(&name, "is not the name of a recording", remedy)
    })
}

fn write_sidecar(path: &Path, recording: &Recording) -> Result<(), Error> {
    let text = sidecar_text(&recording.metadata) + &sidecar::scale_text(recording);
    whole(&sidecar_path(path), |file| file.write_all(text.as_bytes()))
}

/// A recording as its only piece.
fn once<'r>(recording: &'r Recording) -> impl FnMut() -> io::Result<Option<Cow<'r, Recording>>> {
    let mut left = Some(recording);
    move || Ok(left.take().map(Cow::Borrowed))
}

fn plain(next: &mut Next<'_, '_>, file: &mut BufWriter<File>) -> io::Result<()> {
    table(next, file).and_then(|out| out.flush())
}

fn columnar(next: &mut Next<'_, '_>, file: &mut BufWriter<File>) -> io::Result<()> {
    parquet::write(next, file)
}

fn packed(next: &mut Next<'_, '_>, file: &mut BufWriter<File>) -> io::Result<()> {
    let gzip = GzBuilder::new().mtime(0).write(file, Compression::new(6));
    table(next, BufWriter::new(gzip))?
        .into_inner()?
        .finish()?
        .flush()
}

/// Writes the samples of a recording as CSV text, header first; the same bytes as [`write_recording`] puts into a file.
///
/// # Errors
/// Whatever `out` refuses.
pub fn write_csv<W: Write>(recording: &Recording, out: W) -> io::Result<()> {
    table(&mut once(recording), out).and_then(|mut out| out.flush())
}

/// Writes a recording as Parquet; the same bytes as [`write_recording`] puts into a file.
///
/// # Errors
/// Whatever `out` refuses.
pub fn write_parquet<W: Write + Send>(recording: &Recording, out: W) -> io::Result<()> {
    parquet::write(&mut once(recording), out)
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

fn table<W: Write>(next: &mut Next<'_, '_>, mut out: W) -> io::Result<W> {
    let mut has_header = false;
    while let Some(piece) = next()? {
        if !has_header {
            writeln!(out, "{}", header(&piece))?;
        }
        has_header = true;
        lines(&piece, &mut out)?;
    }
    Ok(out)
}

fn header(recording: &Recording) -> String {
    let mut line = String::from("t");
    for (channel, _) in columns(recording) {
        let _ = write!(line, ",{channel}");
    }
    line
}

fn lines(recording: &Recording, out: &mut impl Write) -> io::Result<()> {
    let columns = columns(recording);
    let mut line = String::new();
    for (k, t) in recording.t().iter().enumerate() {
        line.clear();
        let _ = write!(line, "{t}");
        for (_, values) in &columns {
            let _ = write!(line, ",{}", values[k]);
        }
        writeln!(out, "{line}")?;
    }
    Ok(())
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
