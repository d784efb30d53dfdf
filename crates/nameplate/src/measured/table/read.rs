//! From the cells of a table to rows, with errors that name file, line, column and the remedy.

use super::columns::{NAMES, Name};
use super::{COLUMNS, Row, Test};

/// The cells of one line.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Number of the line, from 1.
    pub number: usize,
    /// Its cells as text.
    pub cells: Vec<String>,
}

/// Separators that spreadsheets write.
const SEPARATORS: [char; 3] = [';', '\t', ','];
/// What people call the lines.
const PHASES: [&str; 12] = ["a", "b", "c", "u", "v", "w", "1", "2", "3", "r", "s", "t"];
/// Columns that are no quantity.
const TEST: &str = "test";
const REMARK: &str = "remark";

/// Rows of a text with separators; `label` is the name that errors print.
///
/// # Errors
/// As [`read`].
pub fn read_csv(text: &str, label: &str) -> Result<Vec<Row>, String> {
    let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
    let header = text.lines().find(|line| !is_empty(line)).unwrap_or("");
    let most = |a: &char, b: &char| header.matches(*a).count().cmp(&header.matches(*b).count());
    let separator = SEPARATORS.into_iter().max_by(most).unwrap_or(',');
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator as u8)
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut lines = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| format!("{label}: {error}"))?;
        let number = record.position().map_or(0, |p| p.line() as usize);
        let decimal = |cell: &str| match separator {
            ',' => cell.to_owned(),
            _ => cell.replace(',', "."),
        };
        let cells = record.iter().map(decimal).collect();
        lines.push(Line { number, cells });
    }
    read(&lines, label)
}

fn is_empty(line: &str) -> bool {
    let line = line.trim();
    line.is_empty() || line.starts_with('#')
}

/// Rows of lines of cells, the header first; empty lines and those that begin with `#` are passed over.
///
/// # Errors
/// An unknown column or test, a cell that is no number or out of range, a missing header, each with its place and remedy.
pub fn read(lines: &[Line], label: &str) -> Result<Vec<Row>, String> {
    let filled = |line: &&Line| {
        let first = line.cells.iter().find(|cell| !cell.trim().is_empty());
        first.is_some_and(|cell| !cell.trim().starts_with('#'))
    };
    let lines: Vec<&Line> = lines.iter().filter(filled).collect();
    // A sheet may have a title above its header.
    let is_header = |line: &&Line| {
        line.cells
            .iter()
            .any(|cell| cell.trim().eq_ignore_ascii_case(TEST))
    };
    let first = lines.iter().position(is_header).unwrap_or(0);
    let header = lines.get(first).ok_or_else(|| {
        format!("{label}: is empty; `drivemon motor tests --template` prints a table to fill in")
    })?;
    let header = Header::of(header, label)?;
    let rows: Vec<Row> = lines[first + 1..]
        .iter()
        .map(|line| header.row(line, label))
        .collect::<Result<_, _>>()?;
    if rows.is_empty() {
        return Err(format!(
            "{label}: has no row below the header; one test point a row"
        ));
    }
    Ok(rows)
}

enum Place {
    Test,
    Remark,
    Quantity(&'static Name),
}

struct Header(Vec<Place>);

impl Header {
    fn of(line: &Line, label: &str) -> Result<Header, String> {
        let mut places = Vec::new();
        for (k, cell) in line.cells.iter().enumerate() {
            let name = cell.trim().to_lowercase();
            let twice = line.cells[..k]
                .iter()
                .any(|c| c.trim().to_lowercase() == name);
            if twice && !name.is_empty() {
                return Err(format!(
                    "{label}:{}: column {name} appears twice; keep one",
                    line.number
                ));
            }
            let place = place(&name).map_err(|problem| {
                format!("{label}:{}: column {}: {problem}", line.number, k + 1)
            })?;
            places.push(place);
        }
        if !places.iter().any(|place| matches!(place, Place::Test)) {
            return Err(format!(
                "{label}:{}: has no column test; it says of each row which test it is: {}",
                line.number,
                names()
            ));
        }
        Ok(Header(places))
    }

    fn row(&self, line: &Line, label: &str) -> Result<Row, String> {
        let at = |column: &str| format!("{label}:{}: column {column}", line.number);
        if line.cells.len() > self.0.len() {
            return Err(format!(
                "{label}:{}: has {} cells, the header has {}; a decimal comma needs a semicolon between the columns",
                line.number,
                line.cells.len(),
                self.0.len()
            ));
        }
        let (mut test, mut values) = (None, [None; COLUMNS]);
        for (place, cell) in self.0.iter().zip(&line.cells) {
            let cell = cell.trim();
            match place {
                Place::Remark => {}
                Place::Test if cell.is_empty() => {}
                Place::Test => {
                    test = Some(test_of(cell).map_err(|p| format!("{}: {p}", at(TEST)))?);
                }
                Place::Quantity(_) if cell.is_empty() || cell == "-" => {}
                Place::Quantity(name) => {
                    let number = number(cell, name)
                        .map_err(|problem| format!("{}: {problem}", at(name.name)))?;
                    let slot = &mut values[name.column as usize];
                    if slot.is_some() {
                        return Err(format!("{}: given in two units; keep one", at(name.name)));
                    }
                    *slot = Some(number * name.factor);
                }
            }
        }
        let test = test.ok_or_else(|| format!("{}: is empty; write {}", at(TEST), names()))?;
        Ok(Row {
            table: label.to_owned(),
            line: line.number,
            test,
            values,
        })
    }
}

fn names() -> String {
    Test::ALL.map(Test::name).join(", ")
}

fn place(name: &str) -> Result<Place, String> {
    if name.is_empty() || name == REMARK {
        return Ok(Place::Remark);
    }
    if name == TEST {
        return Ok(Place::Test);
    }
    if let Some(known) = NAMES.iter().find(|known| known.name == name) {
        return Ok(Place::Quantity(known));
    }
    let stem = name.strip_suffix("_amp").unwrap_or(name);
    let of_phase = ["i", "i_", "current_"].iter().any(|quantity| {
        let phase = stem.strip_prefix(quantity);
        phase.is_some_and(|phase| PHASES.contains(&phase))
    });
    if of_phase {
        return Err(format!(
            "\"{name}\" looks like the current of one line; write the mean of the three into current_amp"
        ));
    }
    let known: Vec<&str> = NAMES.iter().map(|known| known.name).collect();
    Err(format!(
        "\"{name}\" is unknown; a table has {TEST}, {}, {REMARK}",
        known.join(", ")
    ))
}

fn test_of(cell: &str) -> Result<Test, String> {
    let name = cell.to_lowercase().replace([' ', '_'], "-");
    let found = Test::ALL.into_iter().find(|test| test.name() == name);
    found.ok_or_else(|| format!("\"{cell}\" is no test; write {}", names()))
}

fn number(cell: &str, name: &Name) -> Result<f64, String> {
    let Ok(value) = cell.parse::<f64>() else {
        let remedy = match cell.contains(',') {
            true => "write a decimal point",
            false => "write the number alone, without its unit",
        };
        return Err(format!("\"{cell}\" is not a number; {remedy}"));
    };
    let [low, high] = name.range;
    if value < 0.0 && low >= 0.0 {
        return Err(format!(
            "{cell} is negative; a negative power or current is a reversed probe: turn it, or write the magnitude"
        ));
    }
    match (low..=high).contains(&value) {
        true => Ok(value),
        false => Err(format!(
            "{cell} is outside {low}..{high}; look at the unit in the column's name"
        )),
    }
}
