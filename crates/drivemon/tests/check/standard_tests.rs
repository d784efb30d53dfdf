//! `drivemon motor tests`: a table of standard tests becomes a motor file.

use std::path::Path;

use motor::MotorFile;

use crate::common::{drivemon, stderr, stdout, text};
use crate::{json, simulated, workplace};

/// Standard tests of the pump: the template holds the readings of one motor.
fn tested(folder: &Path, table: &Path, out: &str, more: &[&str]) -> std::process::Output {
    let (plate, out) = (folder.join("plate.toml"), folder.join(out));
    let arguments = [
        "motor",
        "tests",
        "--plate",
        text(&plate),
        "--tests",
        text(table),
        "-o",
        text(&out),
    ];
    drivemon(&[&arguments[..], more].concat())
}

fn template() -> String {
    stdout(&drivemon(&["motor", "tests", "--template"]))
}

/// An Excel workbook with the cells of a table: numbers as numbers, texts as texts (ECMA-376).
fn workbook(table: &str) -> Vec<u8> {
    use std::io::Write as _;
    const SPREADSHEET: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006/relationships";
    const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let cell = |(k, cell): (usize, &str), row: usize| {
        let place = format!("{}{row}", char::from(b'A' + k as u8));
        match (cell.is_empty(), cell.parse::<f64>()) {
            (true, _) => String::new(),
            (false, Ok(number)) => format!("<c r=\"{place}\"><v>{number}</v></c>"),
            (false, Err(_)) => {
                format!("<c r=\"{place}\" t=\"inlineStr\"><is><t>{cell}</t></is></c>")
            }
        }
    };
    let row = |(number, line): (usize, &str)| {
        let number = number + 1;
        let cells = line.split(',').enumerate().map(|part| cell(part, number));
        format!("<row r=\"{number}\">{}</row>", cells.collect::<String>())
    };
    let rows: String = table.lines().enumerate().map(row).collect();
    let relation = |kind: &str, target: &str| {
        format!(
            "<Relationships xmlns=\"{PACKAGE}\"><Relationship Id=\"rId1\" Type=\"{OFFICE}/{kind}\" Target=\"{target}\"/></Relationships>"
        )
    };
    let parts = [
        ("_rels/.rels", relation("officeDocument", "xl/workbook.xml")),
        (
            "xl/workbook.xml",
            format!(
                "<workbook xmlns=\"{SPREADSHEET}\" xmlns:r=\"{OFFICE}\"><sheets><sheet name=\"Tests\" sheetId=\"1\" r:id=\"rId1\"/></sheets></workbook>"
            ),
        ),
        (
            "xl/_rels/workbook.xml.rels",
            relation("worksheet", "worksheets/sheet1.xml"),
        ),
        (
            "xl/worksheets/sheet1.xml",
            format!("<worksheet xmlns=\"{SPREADSHEET}\"><sheetData>{rows}</sheetData></worksheet>"),
        ),
    ];
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, content) in parts {
        archive
            .start_file(name, zip::write::SimpleFileOptions::default())
            .unwrap();
        archive.write_all(content.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

#[test]
fn standard_tests_from_csv_and_from_a_workbook_give_the_same_bytes() {
    let folder = workplace("tests-formats");
    let table: String = template()
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| format!("{line}\n"))
        .collect();
    std::fs::write(folder.join("tests.csv"), &table).unwrap();
    std::fs::write(folder.join("tests.xlsx"), workbook(&table)).unwrap();
    let mut answers = Vec::new();
    for (name, out) in [("tests.csv", "a.toml"), ("tests.xlsx", "b.toml")] {
        let output = tested(&folder, &folder.join(name), out, &["--json", "-"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let mut answer = json(&output);
        answer["motor_file"].take();
        answers.push((std::fs::read(folder.join(out)).unwrap(), answer));
    }
    assert_eq!(answers[0], answers[1]);
    let answer = &answers[0].1;
    let after: Vec<&str> = answer["steps"]
        .as_array()
        .unwrap()
        .iter()
        .map(|step| step["after"].as_str().unwrap())
        .collect();
    assert_eq!(
        after,
        [
            "plate",
            "dc-resistance",
            "no-load",
            "locked-rotor",
            "load",
            "coast-down"
        ]
    );
    let width = |step: usize, name: &str| {
        let parameters = answer["steps"][step]["parameters"].as_array().unwrap();
        let found = parameters.iter().find(|p| p["name"] == name).unwrap();
        found["high"].as_f64().unwrap() / found["value"].as_f64().unwrap()
    };
    for (name, step) in [
        ("stator_resistance_ohm", 1),
        ("core_loss_resistance_ohm", 2),
        ("stator_leakage_henry", 3),
        ("inertia_kg_m2", 5),
    ] {
        assert!(
            width(step, name).ln() < 0.5 * width(step - 1, name).ln(),
            "{name}"
        );
    }
    assert!(answer["contradictions"].as_array().unwrap().is_empty());
    assert!(
        answer["still_wide"]
            .as_array()
            .unwrap()
            .iter()
            .all(|help| help["factor_now"].as_f64().unwrap() > 1.1)
    );
}

/// Power and current of the last half second of a simulated recording, W and A.
fn power_and_current(recording: &Path) -> [f64; 2] {
    let whole = std::fs::read_to_string(recording).unwrap();
    let mut lines = whole.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
    let at = |name: &str, row: &[f64]| row[column(name)];
    let last = &rows[rows.len() - 5000..];
    let mean = |of: &dyn Fn(&[f64]) -> f64| {
        last.iter().map(|row| of(row)).sum::<f64>() / last.len() as f64
    };
    let power = mean(&|row| {
        ["a", "b", "c"]
            .iter()
            .map(|p| at(&format!("v{p}"), row) * at(&format!("i{p}"), row))
            .sum()
    });
    let square = mean(&|row| {
        ["ia", "ib", "ic"]
            .iter()
            .map(|i| at(i, row).powi(2))
            .sum::<f64>()
            / 3.0
    });
    [power, square.sqrt()]
}

/// The motor file that is written runs as the motor of the table does: two programs that share no equation meet.
#[test]
fn a_motor_of_standard_tests_runs_as_it_was_measured() {
    let folder = workplace("tests-run");
    std::fs::write(folder.join("tests.csv"), template()).unwrap();
    let output = tested(&folder, &folder.join("tests.csv"), "truth.toml", &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let ohm = MotorFile::read(folder.join("truth.toml"))
        .unwrap()
        .parameters
        .r_s;
    // Volt, load in percent (12.45 N m), watt, ampere and degC of three rows.
    for [voltage, load, watt, amp, degc] in [
        [400.6, 0.0, 127.2, 2.813, 39.0],
        [441.7, 0.0, 187.3, 3.808, 40.0],
        [400.6, 85.2, 2183.2, 4.326, 87.0],
    ] {
        // The simulated windings are as warm as at rated load, 100 degC (copper, IEC 60034-1).
        let watt = watt + 3.0 * amp * amp * ohm * (1.0 - (235.0 + degc) / 335.0);
        let scenario = format!(
            "start = \"running\"\nduration_s = 3\n[supply]\nvoltage_line_rms_volt = {voltage}\n[load]\nfriction_percent = 0\nactive = true\nconstant_percent = {load}\n"
        );
        let recording = simulated(&folder, &format!("run-{voltage}-{load}"), &scenario, &[]);
        let [power, current] = power_and_current(&recording);
        assert!(
            (power / watt - 1.0).abs() < 0.03,
            "{voltage} {load}: {power} W, {watt} W"
        );
        assert!(
            (current / amp - 1.0).abs() < 0.015,
            "{voltage} {load}: {current} A, {amp} A"
        );
    }
}

#[test]
fn standard_tests_name_what_contradicts_and_what_one_voltage_leaves_open() {
    let folder = workplace("tests-told");
    let table = folder.join("tests.csv");
    let header = "test,voltage_volt,current_amp,power_watt,resistance_ohm,temperature_degc\n";
    std::fs::write(
        &table,
        format!(
            "{header}dc-resistance,,,,3.6,20\ndc-resistance,,,,4.5,20\nno-load,400,2.81,127,,40\n"
        ),
    )
    .unwrap();
    let output = tested(&folder, &table, "out.toml", &[]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    for words in [
        "tests.csv:2",
        "tests.csv:3",
        "resistance_ohm",
        "no-load at one voltage",
        "still wide",
        "after",
    ] {
        assert!(
            stdout(&output).contains(words),
            "{words}: {}",
            stdout(&output)
        );
    }
    MotorFile::read(folder.join("out.toml")).unwrap();
}

#[test]
fn standard_tests_take_the_plate_of_a_motor_file() {
    let folder = workplace("tests-motor");
    let table = folder.join("tests.csv");
    std::fs::write(&table, template()).unwrap();
    let [motor, out] = ["truth.toml", "out.toml"].map(|name| folder.join(name));
    let output = drivemon(&[
        "motor",
        "tests",
        "--motor",
        text(&motor),
        "--tests",
        text(&table),
        "-o",
        text(&out),
    ]);
    assert!(
        matches!(output.status.code(), Some(0 | 1)),
        "{}",
        stderr(&output)
    );
    assert_eq!(
        MotorFile::read(&out)
            .unwrap()
            .nameplate
            .voltage_line_rms_volt,
        400.0
    );
}

#[test]
fn wrong_test_tables_and_instruments_end_with_the_place_and_write_nothing() {
    let folder = workplace("tests-wrong");
    let table = folder.join("tests.csv");
    std::fs::write(
        &table,
        "test,voltage_volt,current_amp,power_kw\nno-load,400,2.81,127\n",
    )
    .unwrap();
    let output = tested(&folder, &table, "out.toml", &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("tests.csv:2: no-load: column power_watt"),
        "{}",
        stderr(&output)
    );
    std::fs::write(&table, template()).unwrap();
    for (more, words) in [
        (["--class", "0"], "--class 0"),
        (["--speed-error-rpm", "90"], "--speed-error-rpm 90"),
    ] {
        let output = tested(&folder, &table, "out.toml", &more);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    }
    std::fs::write(folder.join("broken.xlsx"), b"PK\x03\x04").unwrap();
    let output = tested(&folder, &folder.join("broken.xlsx"), "out.toml", &[]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("no sound workbook"),
        "{}",
        stderr(&output)
    );
    let output = tested(&folder, &folder.join("none.csv"), "out.toml", &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(!folder.join("out.toml").exists());
}
