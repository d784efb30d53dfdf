//! A CSV file with its header, row by row.

use crate::error::Error;
use crate::mapping::Mapping;
use crate::read::budget::{most_numbers, too_large};
use crate::read::header::Header;
use crate::read::table_file::{Row, TableFile, missing, not_finite};
use crate::read::text::source::{self, Progress, Source};
use csv::ByteRecord;
use std::cell::Cell;
use std::io::Read;
use std::path::Path;
use std::rc::Rc;

/// A CSV file of which the header has been read.
pub(in crate::read) struct CsvFile {
    header: Header,
    decimal_comma: bool,
    reader: csv::Reader<Box<dyn std::io::Read>>,
    bytes_read: Rc<Cell<u64>>,
    bytes_total: u64,
}

/// Rows between two calls of the progress callback: about 10 ms of work.
const ROWS_PER_CALL: u64 = 8192;

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
        let Source {
            reader,
            bytes_read,
            bytes_total,
        } = source;
        let delimiter = mapping.delimiter.unwrap_or(b',');
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .quoting(false)
            .comment(Some(b'#'))
            .delimiter(delimiter)
            .from_reader(reader);
        let mut first = ByteRecord::new();
        let found = reader
            .read_byte_record(&mut first)
            .map_err(|error| csv_error(&name, 1, &error))?;
        if !found {
            let remedy = "the first line names the columns, for example t,va,vb,vc,ia,ib,ic,speed";
            return Err(Error::bad(&name, "holds no header", remedy));
        }
        let header_line = line_before(&reader);
        let names = names(&name, header_line, &first)?;
        check_delimiter(&name, header_line, &names, delimiter)?;
        Ok(CsvFile {
            header: Header::new(name, header_line, names)?,
            decimal_comma: mapping.decimal_comma.unwrap_or(false),
            reader,
            bytes_read,
            bytes_total,
        })
    }

    fn check_row(&self, k: u64, line: u64, record: &ByteRecord) -> Result<(), Error> {
        let width = self.header.names.len();
        if record.len() != width {
            let message = format!("has {} columns, the header has {width}", record.len());
            let remedy = if record.len() == 2 * width {
                "write decimals with a point, not with a comma"
            } else {
                "complete the row or remove it"
            };
            return Err(Error::at(&self.header.file, line, "", message, remedy));
        }
        if k * width as u64 > most_numbers() {
            return Err(too_large(&self.header.file));
        }
        Ok(())
    }

    fn progress(&self) -> Progress {
        Progress {
            bytes_read: self.bytes_read.get(),
            bytes_total: self.bytes_total,
        }
    }
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
            line = line_before(&self.reader);
            self.check_row(k, line, &record)?;
            row(&Cells {
                file: &self.header.file,
                line,
                record: &record,
                decimal_comma: self.decimal_comma,
            })?;
            if k % ROWS_PER_CALL == 0 {
                progress(self.progress());
            }
        }
        progress(self.progress());
        Ok(())
    }
}

/// The cells of one row.
struct Cells<'r> {
    file: &'r str,
    line: u64,
    record: &'r ByteRecord,
    decimal_comma: bool,
}

impl Row for Cells<'_> {
    fn line(&self) -> u64 {
        self.line
    }

    fn number(&self, column: usize, name: &str) -> Result<Option<f64>, Error> {
        let text = self.text(column, name)?;
        if is_missing(text) {
            return Ok(None);
        }
        let parsed = if self.decimal_comma && text.contains(',') {
            text.replacen(',', ".", 1).parse()
        } else {
            text.parse::<f64>()
        };
        match parsed {
            Ok(x) => Ok(Some(x)),
            Err(_) => Err(self.not_a_number(name, text)),
        }
    }

    fn missing(&self, name: &str) -> Error {
        missing(self.file, self.line, name)
    }

    fn not_finite(&self, column: usize, name: &str, x: f64) -> Error {
        let text = self.text(column, name).unwrap_or_default();
        not_finite(self.file, self.line, name, text, x)
    }
}

impl Cells<'_> {
    fn text(&self, column: usize, name: &str) -> Result<&str, Error> {
        let bytes = self.record.get(column).unwrap_or_default();
        match std::str::from_utf8(bytes) {
            Ok(text) => Ok(unquoted(text)),
            Err(_) => {
                let message = "the cell is not UTF-8 text";
                Err(Error::at(
                    self.file,
                    self.line,
                    name,
                    message,
                    "save the file as UTF-8",
                ))
            }
        }
    }

    fn not_a_number(&self, name: &str, text: &str) -> Error {
        let shown: String = text.chars().take(40).collect();
        let remedy = if text.contains(',') {
            "write decimals with a point, or read the file with --decimal-comma"
        } else {
            "write one number per cell, the unit only in the header or the mapping"
        };
        Error::at(
            self.file,
            self.line,
            name,
            format!("`{shown}` is not a number"),
            remedy,
        )
    }
}

fn is_missing(text: &str) -> bool {
    text.is_empty()
        || ["nan", "-nan", "+nan", "na", "n/a", "null"]
            .iter()
            .any(|word| text.eq_ignore_ascii_case(word))
}

fn unquoted(text: &str) -> &str {
    let text = text.trim();
    text.strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'))
        .unwrap_or(text)
        .trim()
}

fn names(file: &str, line: u64, record: &ByteRecord) -> Result<Vec<String>, Error> {
    let cells = record.iter().map(std::str::from_utf8);
    let names = cells.map(|cell| cell.map(|text| unquoted(text).to_owned()));
    names.collect::<Result<_, _>>().map_err(|_| {
        let remedy = "save the file as UTF-8 text";
        Error::at(file, line, "", "the header is not UTF-8 text", remedy)
    })
}

fn check_delimiter(file: &str, line: u64, names: &[String], delimiter: u8) -> Result<(), Error> {
    let [name] = names else { return Ok(()) };
    let others = [(';', ";"), ('\t', "tab"), ('|', "|"), (',', ",")];
    let Some((found, other)) = others.iter().find(|(c, _)| name.contains(*c)) else {
        return Ok(());
    };
    let delimiter = char::from(delimiter);
    let message = format!("the columns are separated by {found:?}, not {delimiter:?}");
    let remedy =
        format!("add --delimiter '{other}', and --decimal-comma if numbers are written 3,7");
    Err(Error::at(file, line, "", message, remedy))
}

/// The line of the record that was just read: the source ends every line by a line feed.
fn line_before<R: std::io::Read>(reader: &csv::Reader<R>) -> u64 {
    reader.position().line().saturating_sub(1)
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
