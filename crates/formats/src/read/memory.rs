//! Tables that are in memory already: frames of other libraries, arrays.

use super::columns::Columns;
use super::convert::finish;
use super::header::{Header, Unreadable};
use super::opened::plan_is_sufficient;
use super::plan::Plan;
use super::samples::{Kept, Raw, Rows};
use super::sidecar_named;
use super::table::{self, Kind};
use super::table_file::{missing, not_finite};
use recording::{Column, Error, Mapping, Source, Target};
use std::collections::BTreeMap;

/// A table in memory.
#[derive(Clone, Debug, Default)]
pub struct MemoryTable {
    /// What errors and results call it.
    pub name: String,
    /// Its columns of numbers by name, all of one length; NaN where a number is missing.
    pub columns: Vec<(String, Column)>,
    /// Its other columns: the name, and what it holds ("text").
    pub others: Vec<(String, &'static str)>,
}

/// Reads a table that is in memory as a file with the same columns would be read. Columns of numbers in SI are lent to the
/// recording, not copied; what has to be computed (units, spikes, rows without a number) is.
///
/// # Errors
/// Whatever is wrong with the columns or the sidecar that `flags` name, with column, row and remedy.
pub fn read_table(table: MemoryTable, flags: &Mapping) -> Result<Source, Error> {
    let sidecar = sidecar_named(flags)?;
    let mapping = flags.clone().over(sidecar.mapping);
    let (names, columns): (Vec<String>, Vec<Column>) = table.columns.into_iter().unzip();
    if names.is_empty() {
        let remedy = "give each signal a column of numbers: t, va, vb, vc, ia, ib, ic, speed";
        return Err(Error::bad(
            &table.name,
            "holds no column of numbers",
            remedy,
        ));
    }
    let mut header = Header::new(table.name, 0, names)?;
    let others = table.others.iter();
    header.unreadable = others
        .map(|(name, what)| Unreadable::holds(name, what))
        .collect();
    let rows = rows(&header, &columns)?;
    if table::kind(&header, &mapping)? == Kind::LoadTable {
        let values = columns.iter().map(|column| column.to_vec()).collect();
        let mut file = Columns::new(header, values, 0)?;
        return table::load_table(&mut file, &mut |_| {}).map(Source::LoadTable);
    }
    let plan = Plan::new(&header, &mapping)?;
    plan_is_sufficient(&header, &plan)?;
    let raw = raw(&header, &columns, rows, &plan)?;
    let all = 0..raw.rows.len();
    finish::recording(&header.file, raw, plan, sidecar.metadata, all).map(Source::Recording)
}

/// The rows of all columns.
fn rows(header: &Header, columns: &[Column]) -> Result<usize, Error> {
    let rows = columns.first().map_or(0, |column| column.len());
    let Some(k) = columns.iter().position(|column| column.len() != rows) else {
        return Ok(rows);
    };
    let (name, first) = (&header.names[k], &header.names[0]);
    let message = format!("holds {} values, {first} holds {rows}", columns[k].len());
    Err(header.error(name, message, "give every column one value per sample"))
}

/// The used columns, whole or without the rows that lack a number.
fn raw(header: &Header, columns: &[Column], rows: usize, plan: &Plan) -> Result<Raw, Error> {
    let used: Vec<(Target, usize)> = plan.columns.iter().map(|(t, k)| (*t, *k)).collect();
    let gap = used.iter().filter_map(|(_, k)| {
        let at = columns[*k].iter().position(|x| !x.is_finite())?;
        Some((at, *k))
    });
    let Some((at, k)) = gap.min() else {
        let columns = used
            .iter()
            .map(|(target, k)| (*target, columns[*k].clone()));
        return Ok(Raw {
            columns: columns.collect(),
            rows: Rows::All(rows),
            skipped: 0,
        });
    };
    if plan.mapping.skip_missing != Some(true) {
        return Err(no_number(header, k, at, columns[k][at]));
    }
    Ok(kept(columns, rows, &used))
}

fn no_number(header: &Header, k: usize, at: usize, x: f64) -> Error {
    let (file, name, line) = (&header.file, &header.names[k], at as u64 + 1);
    match x.is_nan() {
        true => missing(file, line, name),
        false => not_finite(file, line, name, &x.to_string(), x),
    }
}

/// The rows in which every used column has a number.
fn kept(columns: &[Column], rows: usize, used: &[(Target, usize)]) -> Raw {
    let whole = |row: &usize| used.iter().all(|(_, k)| columns[*k][*row].is_finite());
    let kept: Vec<usize> = (0..rows).filter(whole).collect();
    let of = |(target, k): &(Target, usize)| {
        let values: Vec<f64> = kept.iter().map(|row| columns[*k][*row]).collect();
        (*target, Column::from(values))
    };
    let mut numbered = Kept::default();
    kept.iter()
        .for_each(|row| numbered.push(1, *row as u64 + 1, *row as u64));
    Raw {
        columns: used.iter().map(of).collect::<BTreeMap<_, _>>(),
        rows: Rows::Kept(numbered),
        skipped: (rows - kept.len()) as u64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use recording::{Channel, Lent};
    use std::sync::Arc;

    fn lent(values: Vec<f64>) -> Column {
        let kept: Lent = Arc::new(values);
        Column::Lent(kept)
    }

    fn named(columns: [(&str, Vec<f64>); 3]) -> MemoryTable {
        let columns = columns.map(|(name, values)| (name.to_owned(), lent(values)));
        MemoryTable {
            name: "frame".to_owned(),
            columns: columns.into(),
            others: Vec::new(),
        }
    }

    fn recording(table: MemoryTable, flags: &Mapping) -> recording::Recording {
        match read_table(table, flags) {
            Ok(Source::Recording(recording)) => recording,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn numbers_in_si_stay_where_they_are() {
        let table = named([
            ("t", vec![0.0, 0.1]),
            ("I1", vec![1.0, 2.0]),
            ("vb", vec![3.0, 4.0]),
        ]);
        let [t, ia] = [0, 1].map(|k| table.columns[k].1.as_ptr());
        let mut flags = Mapping::default();
        flags.set_column("ia=I1").expect("a column");
        let recording = recording(table, &flags);
        assert_eq!(recording.t().as_ptr(), t);
        let current = recording.channel(Channel::CURRENTS[0]).map(<[f64]>::as_ptr);
        assert_eq!(current, Some(ia));
    }

    #[test]
    fn other_units_are_computed_into_numbers_of_their_own() {
        let table = named([
            ("t", vec![0.0, 0.1]),
            ("ia", vec![1.0, 2.0]),
            ("ib", vec![3.0, 4.0]),
        ]);
        let mut flags = Mapping::default();
        flags.set_unit("ia=mA").expect("a unit");
        let recording = recording(table, &flags);
        assert_eq!(
            recording.channel(Channel::CURRENTS[0]),
            Some(&[1e-3, 2e-3][..])
        );
        assert!(
            recording
                .column(Channel::CURRENTS[1])
                .is_some_and(Column::is_lent)
        );
        assert!(recording.is_derived(Channel::CURRENTS[2]));
    }

    #[test]
    fn a_missing_number_is_named_by_column_and_row_or_its_row_left_out() {
        let columns = [
            ("t", vec![0.0, 0.1, 0.2]),
            ("ia", vec![1.0, f64::NAN, 2.0]),
            ("ib", vec![0.0; 3]),
        ];
        let told = read_table(named(columns.clone()), &Mapping::default()).expect_err("a gap");
        assert!(told.to_string().starts_with("frame:2: ia: "), "{told}");
        let flags = Mapping {
            skip_missing: Some(true),
            ..Mapping::default()
        };
        let recording = recording(named(columns), &flags);
        assert_eq!(recording.t(), [0.0, 0.2]);
        assert!(
            recording
                .assumptions
                .iter()
                .any(|note| note.starts_with("1 rows"))
        );
    }

    #[test]
    fn unequal_columns_and_text_are_refused_by_name() {
        let table = named([
            ("t", vec![0.0, 0.1]),
            ("ia", vec![1.0]),
            ("ib", vec![0.0; 2]),
        ]);
        let told = read_table(table, &Mapping::default()).expect_err("a short column");
        assert!(
            told.to_string().contains("ia: holds 1 values, t holds 2"),
            "{told}"
        );
        let mut table = named([
            ("t", vec![0.0, 0.1]),
            ("ib", vec![1.0; 2]),
            ("ic", vec![0.0; 2]),
        ]);
        table.others.push(("ia".to_owned(), "text"));
        let told = read_table(table, &Mapping::default()).expect_err("text");
        assert!(
            told.to_string()
                .contains("ia: cannot be read: it holds text"),
            "{told}"
        );
    }

    #[test]
    fn operating_points_are_told_by_their_names() {
        let table = named([
            ("current_rms_amp", vec![3.0, 5.0]),
            ("speed_rpm", vec![1499.0, 1450.0]),
            ("power_watt", vec![0.0, 2200.0]),
        ]);
        let source = read_table(table, &Mapping::default()).expect("a load table");
        assert!(matches!(source, Source::LoadTable(table) if table.len() == 2));
    }
}
