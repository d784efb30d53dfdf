//! A text file with its header, row by row.

use super::blanks::Blanks;
use super::body::Cells;
use super::cells::{Separator, unquoted};
use super::clocks::Clock;
use super::head::peek;
use super::layout::rows::comment;
use super::layout::{Layout, layout};
use super::source::{self, Progress, Source};
use crate::read::header::{DeclaredRate, Header};
use crate::read::table_file::{Row, TableFile};
use csv::ByteRecord;
use recording::{Error, Mapping};
use std::cell::Cell;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::rc::Rc;

/// A text file of which the header has been read.
pub(in crate::read) struct CsvFile {
    header: Header,
    layout: Layout,
    reader: csv::Reader<Box<dyn Read>>,
    bytes_read: Rc<Cell<u64>>,
    bytes_total: u64,
    left_out: LeftOut,
}

/// Rows that are no samples.
#[derive(Clone, Copy, Debug, Default)]
struct LeftOut {
    headers: u64,
    comments: u64,
    empty: u64,
}

/// Rows between two calls of the progress callback: about 10 ms of work.
const ROWS_PER_CALL: u64 = 8192;
/// Bytes by which the layout is found.
const HEAD: u64 = 1 << 16;

impl CsvFile {
    /// Opens a file and reads its header.
    pub fn open(path: &Path, mapping: &Mapping) -> Result<CsvFile, Error> {
        CsvFile::of(path.display().to_string(), source::open(path)?, mapping)
    }

    /// Reads the header of a stream.
    pub fn of_stream(
        name: &str,
        stream: impl Read + 'static,
        mapping: &Mapping,
    ) -> Result<CsvFile, Error> {
        CsvFile::of(name.to_owned(), source::stream(name, stream)?, mapping)
    }

    fn of(name: String, source: Source, mapping: &Mapping) -> Result<CsvFile, Error> {
        let (head, mut whole) = peek(source.reader, HEAD);
        if head.is_empty() {
            let read = whole.read(&mut [0]);
            read.map_err(|error| source::broken(&name, 0, &error))?;
        }
        let mut layout = layout(&name, whole_lines(&head), mapping)?;
        if let Some(order) = mapping.date_order {
            let clocks = layout.clocks.iter_mut().flatten();
            clocks.for_each(|clock| {
                if let Clock::Stamps(stamps) = clock {
                    stamps.ordered(order);
                }
            });
        }
        let mut header = header(&name, &layout, mapping)?;
        if let Some(encoding) = source.encoding {
            header
                .notes
                .insert(0, format!("the text is {}", encoding.name()));
        }
        let body = body(whole, layout.titles.first_sample, &name)?;
        Ok(CsvFile {
            header,
            reader: reader(body, &layout),
            layout,
            bytes_read: source.bytes_read,
            bytes_total: source.bytes_total,
            left_out: LeftOut::default(),
        })
    }

    /// The same with more to be said of the file.
    pub fn with_notes(mut self, notes: Vec<String>) -> CsvFile {
        self.header.notes.splice(0..0, notes);
        self
    }

    fn check_row(&self, line: u64, cells: usize) -> Result<(), Error> {
        let width = self.header.names.len();
        if cells > width || cells < width.min(self.layout.width.max(1)) {
            let message = format!("has {cells} columns, the header has {width}");
            let remedy = if cells == 2 * width {
                "write decimals with a point, not with a comma"
            } else {
                "complete the row or remove it"
            };
            return Err(Error::at(&self.header.file, line, "", message, remedy));
        }
        Ok(())
    }

    fn progress(&self) -> Progress {
        Progress {
            bytes_read: self.bytes_read.get(),
            bytes_total: self.bytes_total,
        }
    }

    /// The line of the record that was just read: the source ends every line by a line feed.
    fn line(&self) -> u64 {
        let before = self.layout.titles.first_sample.saturating_sub(1);
        before + self.reader.position().line().saturating_sub(1)
    }

    /// Whether a record is no row of samples: a comment, the header once more, nothing but separators.
    fn leave_out(&mut self, record: &ByteRecord) -> bool {
        let first = record.get(0).unwrap_or_default();
        let is_end = record.len() == 1 && first.trim_ascii().eq_ignore_ascii_case(b"EOF");
        if is_end || std::str::from_utf8(first).is_ok_and(|text| comment(text).is_some()) {
            self.left_out.comments += 1;
        } else if record.iter().all(|cell| cell.trim_ascii().is_empty()) {
            if record.len() < 2 && self.header.names.len() < 2 {
                return false;
            }
            self.left_out.empty += 1;
        } else if self.is_header(record) {
            self.left_out.headers += 1;
        } else {
            return false;
        }
        true
    }

    fn is_header(&self, record: &ByteRecord) -> bool {
        // Names begin with no digit: a look at one byte spares comparing every row.
        let first = record.get(0).and_then(|cell| cell.trim_ascii().first());
        if first.is_none_or(|byte| byte.is_ascii_digit() || *byte == b'-') {
            return false;
        }
        let text = |cell| std::str::from_utf8(cell).map_or("", unquoted);
        let names = self.layout.titles.names.iter().map(String::as_str);
        let units = self
            .header
            .units
            .iter()
            .map(|unit| unit.as_deref().unwrap_or(""));
        let bare = |cell| text(cell).trim_matches(['[', ']', '(', ')']);
        record.iter().map(text).eq(names.take(record.len()))
            || record.iter().map(bare).eq(units.take(record.len()))
    }
}

/// The lines of the head that are whole, as text.
fn whole_lines(head: &[u8]) -> &str {
    let end = match (head.len() as u64) < HEAD {
        true => head.len(),
        false => head
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(head.len(), |at| at + 1),
    };
    let lines = &head[..end];
    // A byte that is no text ends what the layout is found by; reading meets it again.
    let sound = std::str::from_utf8(lines).map_or_else(|error| error.valid_up_to(), str::len);
    std::str::from_utf8(&lines[..sound]).unwrap_or_default()
}

/// The stream from the first row of samples on.
fn body(
    whole: Box<dyn Read>,
    first_sample: u64,
    name: &str,
) -> Result<BufReader<Box<dyn Read>>, Error> {
    let mut body = BufReader::with_capacity(HEAD as usize, whole);
    for line in 1..first_sample {
        let mut skipped = Vec::new();
        let read = body.read_until(b'\n', &mut skipped);
        read.map_err(|error| source::broken(name, line, &error))?;
    }
    Ok(body)
}

fn reader(body: BufReader<Box<dyn Read>>, layout: &Layout) -> csv::Reader<Box<dyn Read>> {
    let (body, delimiter): (Box<dyn Read>, u8) = match layout.separator {
        Separator::Byte(byte) => (Box::new(body), byte),
        Separator::Blanks => (Box::new(Blanks::new(body)), b'\t'),
    };
    csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .quoting(layout.is_quoted)
        .comment(Some(b'#'))
        .delimiter(delimiter)
        .from_reader(body)
}

fn header(name: &str, layout: &Layout, mapping: &Mapping) -> Result<Header, Error> {
    let titles = &layout.titles;
    let named_by_flag =
        mapping.names.is_some() || mapping.columns.values().any(|map| map.name.is_some());
    if titles.line == 0 && !named_by_flag {
        let numbers = vec!["0".to_owned(); layout.width];
        return Header::new(name.to_owned(), titles.first_sample, numbers);
    }
    let mut header = Header::new(name.to_owned(), titles.line.max(1), titles.names.clone())?;
    let declared = titles.units.iter().zip(&mut header.units);
    declared.for_each(|(unit, slot)| *slot = unit.clone().or(slot.take()));
    for (k, clock) in layout.clocks.iter().enumerate().take(header.names.len()) {
        if let Some(clock) = clock {
            header.units[k] = Some(clock.unit().to_owned());
            header.remarks[k] = Some(clock.remark(&header.names[k]));
        }
    }
    header.rate = layout.rate.as_ref().map(|rate| DeclaredRate {
        hz: rate.hz,
        note: format!(
            "{} samples a second, as `{}` in line {} says",
            rate.hz, rate.label, rate.line
        ),
    });
    header.notes.splice(0..0, layout.notes.iter().cloned());
    Ok(header)
}

impl TableFile for CsvFile {
    fn header(&self) -> &Header {
        &self.header
    }

    fn for_each_row(
        &mut self,
        progress: &mut dyn FnMut(Progress),
        row: &mut dyn FnMut(&dyn Row) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let mut record = ByteRecord::new();
        let mut line = self.header.line;
        for k in 0u64.. {
            let more = self.reader.read_byte_record(&mut record);
            if !more.map_err(|error| csv_error(&self.header.file, line + 1, &error))? {
                break;
            }
            line = self.line();
            if self.leave_out(&record) {
                continue;
            }
            trim(&mut record, self.header.names.len());
            self.check_row(line, record.len())?;
            row(&Cells {
                file: &self.header.file,
                line,
                record: &record,
                layout: &self.layout,
            })?;
            if k % ROWS_PER_CALL == 0 {
                progress(self.progress());
            }
        }
        progress(self.progress());
        Ok(())
    }

    fn layout(&self) -> Mapping {
        let numbers = self.layout.numbers;
        Mapping {
            delimiter: Some(self.layout.separator.byte()),
            decimal_comma: Some(numbers.decimal_comma),
            thousands: Some(numbers.thousands),
            ..Mapping::default()
        }
    }

    fn notes(&self) -> Vec<String> {
        let LeftOut {
            headers,
            comments,
            empty,
        } = self.left_out;
        let counts = [
            (headers, "repeat the header"),
            (comments, "are comments or say EOF"),
            (empty, "have empty cells only"),
        ];
        let told = counts.iter().filter(|(count, _)| *count > 0);
        told.map(|(count, what)| format!("{count} lines among the samples {what} and are left out"))
            .collect()
    }
}

/// Drops empty cells behind the last column.
fn trim(record: &mut ByteRecord, width: usize) {
    let is_empty = |cell: &[u8]| cell.trim_ascii().is_empty();
    let mut kept = record.len();
    while kept > width && record.get(kept - 1).is_some_and(is_empty) {
        kept -= 1;
    }
    record.truncate(kept);
}

fn csv_error(file: &str, line: u64, error: &csv::Error) -> Error {
    match error.kind() {
        csv::ErrorKind::Io(inner) => source::broken(file, line, inner),
        _ => Error::at(
            file,
            line,
            "",
            format!("is not a table ({error})"),
            "export it again as CSV",
        ),
    }
}
