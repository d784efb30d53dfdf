//! A file's bytes as text, unpacked, with everything that is not a table named for what it is.

use super::encoding::other_than_utf8;
use super::head::peek;
use encoding_rs::{Encoding, WINDOWS_1252};
use encoding_rs_io::DecodeReaderBytesBuilder;
use flate2::read::MultiGzDecoder;
use recording::Error;
use recording::names::ends_in;
use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;
use std::rc::Rc;

/// How far reading has come, in bytes of the file as it lies on the disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Bytes read so far.
    pub bytes_read: u64,
    /// Bytes in all; 0 when unknown (a pipe).
    pub bytes_total: u64,
}

/// An opened file, ready to be parsed as text.
pub(crate) struct Source {
    pub reader: Box<dyn Read>,
    /// The alphabet, where it is not UTF-8.
    pub encoding: Option<&'static Encoding>,
    pub bytes_read: Rc<Cell<u64>>,
    pub bytes_total: u64,
}

/// A line of a table has a few hundred bytes; this is some other file.
const LONGEST_LINE: usize = 1 << 16;
const BUFFER: usize = 1 << 16;
const GZIP: [u8; 2] = [0x1F, 0x8B];

/// Opens a file, unpacks it if it is gzip, and refuses what is not text.
pub(crate) fn open(path: &Path) -> Result<Source, Error> {
    let name = path.display().to_string();
    let metadata = std::fs::metadata(path).map_err(|error| Error::io(path, &error))?;
    if metadata.is_dir() {
        return Err(Error::bad(
            &name,
            "is a folder",
            "name a .csv, .csv.gz, .xlsx, .parquet, .mat, .wav, .cfg or .cff file in it",
        ));
    }
    let file = File::open(path).map_err(|error| Error::io(path, &error))?;
    let (packed, bytes_read) = counted(file);
    let (reader, encoding) = text(packed, &name, Some(ends_in(path, ".gz")))?;
    Ok(Source {
        reader,
        encoding,
        bytes_read,
        bytes_total: if metadata.is_file() {
            metadata.len()
        } else {
            0
        },
    })
}

/// The same of a stream, which is unpacked if it is gzip, whatever it is called.
pub(crate) fn stream(name: &str, stream: impl Read + 'static) -> Result<Source, Error> {
    let (packed, bytes_read) = counted(stream);
    let (reader, encoding) = text(packed, name, None)?;
    Ok(Source {
        reader,
        encoding,
        bytes_read,
        bytes_total: 0,
    })
}

fn counted<R: Read>(input: R) -> (BufReader<Counted<R>>, Rc<Cell<u64>>) {
    let bytes_read = Rc::new(Cell::new(0));
    let counted = Counted {
        input,
        bytes_read: Rc::clone(&bytes_read),
    };
    (BufReader::with_capacity(BUFFER, counted), bytes_read)
}

/// Text, unpacked; `is_named_gzip` is `None` where the name says nothing.
fn text<R: Read + 'static>(
    mut packed: BufReader<R>,
    name: &str,
    is_named_gzip: Option<bool>,
) -> Result<Decoded, Error> {
    let head = packed.fill_buf().map_err(|error| broken(name, 0, &error))?;
    let is_gzip = head.starts_with(&GZIP);
    match (is_gzip, is_named_gzip.unwrap_or(is_gzip)) {
        (true, true) => plain(Box::new(MultiGzDecoder::new(packed)), name),
        (false, false) => plain(Box::new(packed), name),
        (true, false) => {
            let remedy = format!("rename it to {name}.gz");
            Err(Error::bad(
                name,
                "is gzip-compressed, but its name does not end in .gz",
                remedy,
            ))
        }
        (false, true) if head.is_empty() => Err(empty(name)),
        (false, true) => {
            let remedy = "rename it without .gz, or compress it";
            Err(Error::bad(
                name,
                "is named .gz, but is not gzip-compressed",
                remedy,
            ))
        }
    }
}

/// Lines of UTF-8 text, and what they were before.
type Decoded = (Box<dyn Read>, Option<&'static Encoding>);

fn plain(stream: Box<dyn Read>, name: &str) -> Result<Decoded, Error> {
    let (head, mut whole) = peek(stream, BUFFER as u64);
    if head.is_empty() {
        let mut first = [0];
        let read = whole.read(&mut first);
        return Err(read.map_or_else(|error| broken(name, 0, &error), |_| empty(name)));
    }
    refuse_foreign(&head, name)?;
    let encoding = other_than_utf8(&head);
    if encoding.is_none_or(|encoding| encoding == WINDOWS_1252) {
        refuse_binary(&head, name)?;
    }
    Ok((Box::new(Lines::new(decoded(whole, encoding))), encoding))
}

/// The stream as UTF-8 without a byte order mark.
fn decoded(stream: Box<dyn Read>, encoding: Option<&'static Encoding>) -> Box<dyn Read> {
    match encoding {
        None => Box::new(WithoutMark {
            stream,
            began: false,
        }),
        some => Box::new(
            DecodeReaderBytesBuilder::new()
                .encoding(some)
                .strip_bom(true)
                .build(stream),
        ),
    }
}

/// UTF-8 text, of which a byte order mark at the beginning is dropped.
struct WithoutMark {
    stream: Box<dyn Read>,
    began: bool,
}

const MARK: [u8; 3] = *b"\xEF\xBB\xBF";

impl Read for WithoutMark {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.stream.read(buffer)?;
        if std::mem::replace(&mut self.began, true) || !buffer[..n].starts_with(&MARK) {
            return Ok(n);
        }
        buffer.copy_within(MARK.len()..n, 0);
        match n - MARK.len() {
            0 => self.stream.read(buffer),
            rest => Ok(rest),
        }
    }
}

fn empty(name: &str) -> Error {
    let remedy =
        "record again; the first line names the columns, for example t,va,vb,vc,ia,ib,ic,speed";
    Error::bad(name, "is empty", remedy)
}

/// Beginnings of formats that are measurements, but not in text.
const FORMATS: [(&[u8], &str); 5] = [
    (b"PAR1", "a Parquet file"),
    (b"MATLAB 5.0", "a MAT-file, version 5"),
    (
        b"\x89HDF\r\n\x1A\n",
        "an HDF5 file (also MAT-file, version 7.3)",
    ),
    (b"TDSm", "a TDMS file"),
    (b"PK\x03\x04", "a zip archive (also a spreadsheet)"),
];

fn refuse_foreign(head: &[u8], name: &str) -> Result<(), Error> {
    if let Some((_, format)) = FORMATS.iter().find(|(magic, _)| head.starts_with(magic)) {
        let message = format!("is {format}");
        return Err(Error::unsupported(
            name,
            message,
            "export it as .csv, .xlsx, .parquet, or .mat of version 7",
        ));
    }
    if head.starts_with(&GZIP) {
        return Err(Error::bad(
            name,
            "is gzip-compressed twice",
            "unpack it once",
        ));
    }
    Ok(())
}

fn refuse_binary(head: &[u8], name: &str) -> Result<(), Error> {
    match head.iter().position(|&byte| byte == 0) {
        Some(at) => {
            let message = format!("holds a zero byte at offset {at}: it is binary");
            Err(Error::bad(
                name,
                message,
                "export it as text, .parquet, or .mat of version 7",
            ))
        }
        None => Ok(()),
    }
}

/// Counts the bytes that come off the disk.
struct Counted<R> {
    input: R,
    bytes_read: Rc<Cell<u64>>,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.input.read(buffer)?;
        self.bytes_read.set(self.bytes_read.get() + n as u64);
        Ok(n)
    }
}

/// Lines as this crate wants them: ended by one line feed each, none so long that it fills the memory,
/// no binary content behind a textual beginning.
///
/// The even line ends make the reader's line count exact, which the CSV parser's own is not.
struct Lines<R> {
    reader: R,
    line: u64,
    length: usize,
    after_return: bool,
    ended: bool,
}

impl<R: Read> Lines<R> {
    fn new(reader: R) -> Lines<R> {
        Lines {
            reader,
            line: 1,
            length: 0,
            after_return: false,
            ended: false,
        }
    }

    /// What becomes of one byte; `None` for the line feed behind a carriage return.
    fn pass(&mut self, byte: u8) -> io::Result<Option<u8>> {
        let follows = std::mem::replace(&mut self.after_return, byte == b'\r');
        match byte {
            b'\n' if follows => return Ok(None),
            b'\n' | b'\r' => {
                self.length = 0;
                self.line += 1;
                return Ok(Some(b'\n'));
            }
            0 => return Err(self.refuse("holds a zero byte: the file is binary or damaged")),
            _ => self.length += 1,
        }
        if self.length > LONGEST_LINE {
            return Err(self.refuse("is longer than 65536 bytes: this is not a table"));
        }
        Ok(Some(byte))
    }

    /// Takes bytes that stay as they are; `false` where they may not, or a line is too long: nothing is taken then.
    fn pass_all(&mut self, bytes: &[u8]) -> bool {
        // Without a way out of the loop it goes over many bytes at once.
        let changes = |found: bool, byte: &u8| found | (*byte == 0) | (*byte == b'\r');
        if self.after_return || bytes.iter().fold(false, changes) {
            return false;
        }
        let is_end = |byte: &u8| *byte == b'\n';
        let Some(first) = bytes.iter().position(is_end) else {
            let fits = self.length + bytes.len() <= LONGEST_LINE;
            self.length += if fits { bytes.len() } else { 0 };
            return fits;
        };
        if self.length + first > LONGEST_LINE || bytes.len() > LONGEST_LINE {
            return false;
        }
        let last = bytes.iter().rposition(is_end).unwrap_or(first);
        self.line += bytes.iter().filter(|byte| is_end(byte)).count() as u64;
        self.length = bytes.len() - 1 - last;
        true
    }

    /// The line feed that the last line may lack.
    fn end(&mut self, buffer: &mut [u8]) -> usize {
        let lacks = !self.ended && self.length > 0;
        self.ended = true;
        match buffer.first_mut() {
            Some(first) if lacks => {
                *first = b'\n';
                1
            }
            _ => 0,
        }
    }

    fn refuse(&self, message: &'static str) -> io::Error {
        io::Error::other(BadLine {
            line: self.line,
            message,
        })
    }
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let n = self.reader.read(buffer)?;
            if n == 0 {
                return Ok(self.end(buffer));
            }
            if self.pass_all(&buffer[..n]) {
                return Ok(n);
            }
            let mut kept = 0;
            for k in 0..n {
                if let Some(byte) = self.pass(buffer[k])? {
                    buffer[kept] = byte;
                    kept += 1;
                }
            }
            if kept > 0 {
                return Ok(kept);
            }
        }
    }
}

#[derive(Debug)]
struct BadLine {
    line: u64,
    message: &'static str,
}

impl std::fmt::Display for BadLine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.message)
    }
}

impl std::error::Error for BadLine {}

/// An error while reading, at the line that was reached.
pub(crate) fn broken(name: &str, line: u64, error: &io::Error) -> Error {
    if let Some(bad) = error
        .get_ref()
        .and_then(|inner| inner.downcast_ref::<BadLine>())
    {
        let remedy = "export it as text, one sample per line, columns separated by commas";
        return Error::at(
            name,
            bad.line,
            "",
            format!("the line {}", bad.message),
            remedy,
        );
    }
    let damaged = matches!(
        error.kind(),
        io::ErrorKind::UnexpectedEof | io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData
    );
    let (message, remedy) = if damaged {
        (
            "the gzip stream is truncated or damaged",
            "copy or record the file again",
        )
    } else {
        ("cannot be read", "check the file and the disk")
    };
    Error::at(name, line, "", format!("{message} ({error})"), remedy)
}
