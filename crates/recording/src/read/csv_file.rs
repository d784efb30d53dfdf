//! A CSV file with its header, row by row.

use crate::error::Error;
use crate::mapping::Mapping;
use crate::source::{self, Progress, Source};
use csv::ByteRecord;
use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;

/// A CSV file of which the header has been read.
pub(crate) struct CsvFile {
    /// The file as the user named it.
    pub name: String,
    /// The column names, trimmed and without quotes.
    pub header: Vec<String>,
    /// Line of the header, counted from 1.
    pub header_line: u64,
    decimal_comma: bool,
    reader: csv::Reader<Box<dyn std::io::Read>>,
    bytes_read: Rc<Cell<u64>>,
    bytes_total: u64,
}

/// Rows between two calls of the progress callback: about 10 ms of work.
const ROWS_PER_CALL: u64 = 8192;
/// Numbers of one file: 1.6 GB in memory. A gzip bomb stops here.
const MOST_NUMBERS: u64 = 200_000_000;

impl CsvFile {
    /// Opens a file and reads its header.
    pub fn open(path: &Path, mapping: &Mapping) -> Result<CsvFile, Error> {
        let name = path.display().to_string();
        let Source {
            reader,
            bytes_read,
            bytes_total,
        } = source::open(path)?;
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
        let header = header(&name, header_line, &first)?;
        check_header(&name, header_line, &header, delimiter)?;
        Ok(CsvFile {
            name,
            header,
            header_line,
            decimal_comma: mapping.decimal_comma.unwrap_or(false),
            reader,
            bytes_read,
            bytes_total,
        })
    }

    /// Calls `row` with the line and the cells of every row; all have as many cells as the header.
    pub fn for_each_row(
        &mut self,
        progress: &mut dyn FnMut(Progress),
        mut row: impl FnMut(&Cells<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let mut record = ByteRecord::new();
        let mut line = self.header_line;
        for k in 0u64.. {
            let more = self.reader.read_byte_record(&mut record);
            if !more.map_err(|error| csv_error(&self.name, line + 1, &error))? {
                break;
            }
            line = line_before(&self.reader);
            self.check_row(k, line, &record)?;
            row(&Cells {
                file: &self.name,
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

    fn check_row(&self, k: u64, line: u64, record: &ByteRecord) -> Result<(), Error> {
        let width = self.header.len();
        if record.len() != width {
            let message = format!("has {} columns, the header has {width}", record.len());
            let remedy = if record.len() == 2 * width {
                "write decimals with a point, not with a comma"
            } else {
                "complete the row or remove it"
            };
            return Err(Error::at(&self.name, line, "", message, remedy));
        }
        if k * width as u64 > MOST_NUMBERS {
            let message = format!("holds more than {MOST_NUMBERS} numbers");
            let remedy = "cut the recording; a few seconds with load steps are enough";
            return Err(Error::unsupported(&self.name, message, remedy));
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

/// The cells of one row.
pub(crate) struct Cells<'r> {
    /// The file as the user named it.
    pub file: &'r str,
    /// Line, counted from 1.
    pub line: u64,
    record: &'r ByteRecord,
    decimal_comma: bool,
}

impl Cells<'_> {
    /// The finite number in a column; `None` for an empty or not-a-number cell.
    pub fn number(&self, column: usize, name: &str) -> Result<Option<f64>, Error> {
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
            Ok(x) if x.is_finite() => Ok(Some(x)),
            Ok(x) => {
                let remedy = "an overflow of the instrument: remove the row, or use --skip-missing";
                Err(Error::at(
                    self.file,
                    self.line,
                    name,
                    format!("`{text}` is {x}"),
                    remedy,
                ))
            }
            Err(_) => Err(self.not_a_number(name, text)),
        }
    }

    /// The error for an empty or not-a-number cell.
    pub fn missing(&self, name: &str) -> Error {
        let remedy = "fill the cell, remove the row, or let --skip-missing drop such rows";
        Error::at(
            self.file,
            self.line,
            name,
            "the cell holds no number (empty or NaN)",
            remedy,
        )
    }

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

fn header(file: &str, line: u64, record: &ByteRecord) -> Result<Vec<String>, Error> {
    let cells = record.iter().map(std::str::from_utf8);
    let names = cells.map(|cell| cell.map(|text| unquoted(text).to_owned()));
    names.collect::<Result<_, _>>().map_err(|_| {
        let remedy = "save the file as UTF-8 text";
        Error::at(file, line, "", "the header is not UTF-8 text", remedy)
    })
}

fn check_header(file: &str, line: u64, header: &[String], delimiter: u8) -> Result<(), Error> {
    let bad = |message: String, remedy: &str| Err(Error::at(file, line, "", message, remedy));
    if header.len() == 1 {
        let others = [(';', ";"), ('\t', "tab"), ('|', "|"), (',', ",")];
        if let Some((found, name)) = others.iter().find(|(c, _)| header[0].contains(*c)) {
            let message = format!(
                "the columns are separated by {found:?}, not {:?}",
                char::from(delimiter)
            );
            let remedy =
                format!("add --delimiter '{name}', and --decimal-comma if numbers are written 3,7");
            return bad(message, &remedy);
        }
    }
    if header.iter().all(|name| name.parse::<f64>().is_ok()) {
        let message = "the first line holds numbers, not column names".to_owned();
        return bad(
            message,
            "put a line such as t,va,vb,vc,ia,ib,ic,speed before it",
        );
    }
    for (k, name) in header.iter().enumerate() {
        if name.is_empty() {
            return bad(
                format!("column {} has no name", k + 1),
                "name it, or remove it",
            );
        }
        if header[..k].contains(name) {
            let message = format!("column `{}` stands there twice", shown(name));
            return bad(message, "rename or remove one of the two");
        }
    }
    Ok(())
}

/// A name from a file, cut to what fits a message.
pub(crate) fn shown(name: &str) -> String {
    name.chars().take(40).filter(|c| !c.is_control()).collect()
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
