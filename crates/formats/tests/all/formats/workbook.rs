//! Excel workbooks, made here part by part as ECMA-376 describes them.

use super::{assert_error, assert_refused};
use crate::common::{Folder, quiet};
use formats::{read_any, with_most_numbers};
use recording::{Channel, Mapping, Source};
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const WORKBOOK: &str = r#"<workbook xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main" xmlns:r="http://schemas.openxmlformats.org/officeDocument/2006/relationships"><sheets><sheet name="Notes" sheetId="1" r:id="rId1"/><sheet name="Data" sheetId="2" r:id="rId2"/></sheets></workbook>"#;
const RELATIONS: &str = r#"<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rId1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet" Target="worksheets/sheet1.xml"/><Relationship Id="rId2" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet" Target="worksheets/sheet2.xml"/><Relationship Id="rId3" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/styles" Target="styles.xml"/></Relationships>"#;
const ROOT: &str = r#"<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rId1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/officeDocument" Target="xl/workbook.xml"/></Relationships>"#;
/// Style 1 is a date with its time of day.
const STYLES: &str = r#"<styleSheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><numFmts count="1"><numFmt numFmtId="164" formatCode="yyyy\-mm\-dd hh:mm:ss.000"/></numFmts><cellXfs count="2"><xf numFmtId="0"/><xf numFmtId="164" applyNumberFormat="1"/></cellXfs></styleSheet>"#;

fn sheet(rows: &str) -> String {
    format!(
        r#"<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>{rows}</sheetData></worksheet>"#
    )
}

fn text(cell: &str, text: &str) -> String {
    format!(r#"<c r="{cell}" t="inlineStr"><is><t>{text}</t></is></c>"#)
}

fn packed(parts: &[(&str, &str)]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in parts {
        archive
            .start_file(*name, SimpleFileOptions::default())
            .unwrap();
        archive.write_all(content.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn book(rows: &str) -> Vec<u8> {
    packed(&[
        ("_rels/.rels", ROOT),
        ("xl/workbook.xml", WORKBOOK),
        ("xl/_rels/workbook.xml.rels", RELATIONS),
        ("xl/styles.xml", STYLES),
        ("xl/worksheets/sheet1.xml", &sheet("")),
        ("xl/worksheets/sheet2.xml", &sheet(rows)),
    ])
}

/// A title in row 1, names with units in row 3, samples from row 4 on.
fn rows(first: impl Fn(u32) -> String, style: u32) -> String {
    let mut rows = format!(r#"<row r="1">{}</row>"#, text("A1", "Bench 3"));
    let names = ["Time (s)", "I1 [mA]", "I2 [mA]", "I3 [mA]"];
    let cells = names
        .iter()
        .zip('A'..)
        .map(|(name, column)| text(&format!("{column}3"), name));
    let _ = write!(rows, r#"<row r="3">{}</row>"#, cells.collect::<String>());
    for k in 0..50 {
        let row = k + 4;
        let _ = write!(
            rows,
            r#"<row r="{row}"><c r="A{row}" s="{style}"><v>{}</v></c>"#,
            first(k)
        );
        for (column, x) in ('B'..).zip([1.5, -0.25, -1.25]) {
            let _ = write!(
                rows,
                r#"<c r="{column}{row}"><v>{}</v></c>"#,
                x * f64::from(k)
            );
        }
        rows += "</row>";
    }
    rows
}

#[test]
fn a_sheet_is_read_as_the_table_that_it_shows() {
    let folder = Folder::new("workbook");
    let seconds = book(&rows(|k| format!("{}", f64::from(k) * 1e-3), 0));
    let stamps = book(&rows(
        |k| format!("{}", 45352.5 + f64::from(k) * 1e-3 / 86_400.0),
        1,
    ));
    for (bytes, half) in [(seconds, 1e-12), (stamps, 2e-6)] {
        let path = folder.file("x.xlsx", &bytes);
        let Ok(Source::Recording(recording)) = read_any(&path, &Mapping::default(), &mut quiet())
        else {
            panic!("{:?}", read_any(&path, &Mapping::default(), &mut quiet()));
        };
        assert_eq!(recording.len(), 50);
        let late = recording
            .t()
            .iter()
            .zip(0..)
            .map(|(t, k)| (t - recording.t()[0] - f64::from(k) * 1e-3).abs());
        assert!(late.fold(0.0, f64::max) < half, "{:?}", recording.t());
        let ib = recording.channel(Channel::CURRENTS[1]).unwrap();
        assert!((ib[40] + 0.01).abs() < 1e-12, "{}", ib[40]);
        for note in [
            "sheet Data is read, 1 others are not",
            "line 3 names the columns",
            "ib = I2 [mA] in mA",
        ] {
            assert!(
                recording.assumptions.iter().any(|said| said.contains(note)),
                "{:?}",
                recording.assumptions
            );
        }
    }
}

#[test]
fn damaged_workbooks_are_refused() {
    let whole = book(&rows(|k| k.to_string(), 0));
    assert_refused(
        "x.xlsx",
        &whole[..whole.len() / 2],
        2,
        &["is no sound workbook", "save it again"],
    );
    assert_refused("x.xlsx", b"PK\x03\x04", 2, &["is no sound workbook"]);
    assert_refused("x.xlsx", b"t,ia\n0,1\n", 2, &["is no sound workbook"]);
    assert_refused("x.xlsx", b"", 2, &["is empty"]);
    assert_refused("x.csv", &whole, 2, &["is an Excel workbook", "x.xlsx"]);
    let archive = packed(&[("readme.txt", "hello")]);
    assert_refused("x.xlsx", &archive, 3, &["no Excel workbook", ".ods"]);
    assert_refused("x.xlsx", &book(""), 2, &["has no sheet with cells"]);
    let far = r#"<row r="1"><c r="XFD1"><v>1</v></c></row>"#;
    assert_refused(
        "x.xlsx",
        &book(far),
        2,
        &["x.xlsx:1", "column 16384", "first 1024"],
    );
    let bad = rows(
        |k| {
            if k == 7 {
                "x".to_owned()
            } else {
                k.to_string()
            }
        },
        0,
    );
    assert_refused(
        "x.xlsx",
        &book(&bad),
        2,
        &["x.xlsx:11: Time (s): `x` is not a number"],
    );
}

/// 64 MiB of blanks pack into 64 KiB.
#[test]
fn a_small_workbook_does_not_unpack_to_gigabytes() {
    let text = "<a/>".repeat(20 << 20);
    let parts = [
        ("xl/workbook.xml", WORKBOOK),
        ("xl/sharedStrings.xml", &text),
    ];
    assert_refused("x.xlsx", &packed(&parts), 3, &["unpacks to more than"]);
    let long = " ".repeat(2 << 20);
    let parts = [
        ("xl/workbook.xml", WORKBOOK),
        ("xl/worksheets/sheet1.xml", &long),
    ];
    assert_refused("x.xlsx", &packed(&parts), 2, &["longer than 1 MiB"]);
    let folder = Folder::new("bounded");
    let path = folder.file("x.xlsx", &book(&rows(|k| k.to_string(), 0)));
    with_most_numbers(20, || {
        assert_error(
            &path,
            &Mapping::default(),
            3,
            &["holds more than 20 numbers"],
        )
    });
}

/// Whatever single byte is wrong: an error or a recording, never a panic.
#[test]
fn no_wrong_byte_panics() {
    let whole = book(&rows(|k| k.to_string(), 0));
    let folder = Folder::new("workbook-bytes");
    for at in (0..whole.len()).step_by(11) {
        let mut wrong = whole.clone();
        wrong[at] ^= 1 << (at % 8);
        let path = folder.file("x.xlsx", &wrong);
        let _ = read_any(&path, &Mapping::default(), &mut quiet());
    }
}
