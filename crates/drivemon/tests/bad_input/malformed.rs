//! Malformed motor files and recordings: each is refused with exit code 2 or 3, its place and the remedy.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Output;

use crate::common::{PROJECT, drivemon, scratch, stderr, text};

/// One malformed input: what it is, the file, and words that its error must contain.
pub struct Malformed {
    /// What it is.
    pub what: &'static str,
    /// Its name.
    pub file: &'static str,
    /// Its bytes.
    pub content: Vec<u8>,
    /// Words of its error.
    pub words: &'static [&'static str],
}

fn malformed(
    what: &'static str,
    file: &'static str,
    content: impl Into<Vec<u8>>,
    words: &'static [&'static str],
) -> Malformed {
    Malformed {
        what,
        file,
        content: content.into(),
        words,
    }
}

const GOOD_MOTOR: &str = include_str!("../../../../motors/peer-2k2.toml");

/// The good motor file with one line exchanged.
fn motor_with(key: &str, line: &str) -> String {
    let is_key = |good: &str| {
        good.split('=')
            .next()
            .is_some_and(|name| name.trim() == key)
    };
    assert!(
        GOOD_MOTOR.lines().any(is_key),
        "the motor file has no key {key}"
    );
    let lines = GOOD_MOTOR
        .lines()
        .map(|good| if is_key(good) { line } else { good });
    lines.collect::<Vec<_>>().join("\n")
}

/// Motor files.
pub fn bad_motors() -> Vec<Malformed> {
    let number = |key, line: &str, words| malformed(key, "m.toml", motor_with(key, line), words);
    vec![
        malformed("empty", "m.toml", "", &["m.toml"]),
        malformed("not TOML", "m.toml", "name = \n", &["m.toml:1"]),
        malformed("binary", "m.toml", vec![0_u8, 159, 146, 150], &["m.toml"]),
        malformed("UTF-16", "m.toml", utf16(GOOD_MOTOR), &["m.toml", "UTF-8"]),
        number(
            "stator_resistance_ohm",
            "stator_resistance_ohm = -3.7",
            &["stator_resistance_ohm", "-3.7"],
        ),
        number(
            "stator_resistance_ohm",
            "stator_resistance_ohm = nan",
            &["stator_resistance_ohm"],
        ),
        number(
            "stator_resistance_ohm",
            "stator_resistance_ohm = \"3.7 ohm\"",
            &["stator_resistance_ohm"],
        ),
        number(
            "stator_resistance_ohm",
            "stator_resistence_ohm = 3.7",
            &["stator_resistance_ohm"],
        ),
        number("stator_resistance_ohm", "", &["stator_resistance_ohm"]),
        number(
            "rotor_resistance_ohm",
            "rotor_resistance_ohm = inf",
            &["rotor_resistance_ohm"],
        ),
        number(
            "magnetizing_inductance_henry",
            "magnetizing_inductance_henry = -0.2",
            &["magnetizing_inductance_henry"],
        ),
        number(
            "magnetizing_inductance_henry",
            "magnetizing_inductance_henry = 0",
            &["magnetizing_inductance_henry"],
        ),
        number(
            "stator_leakage_henry",
            "stator_leakage_henry = -0.01",
            &["stator_leakage_henry"],
        ),
        number("inertia_kg_m2", "inertia_kg_m2 = 0", &["inertia_kg_m2"]),
        number("friction_nm_s", "friction_nm_s = -1", &["friction_nm_s"]),
        number("pole_pairs", "pole_pairs = 0", &["pole_pairs"]),
        number("pole_pairs", "pole_pairs = 2.5", &["pole_pairs"]),
        number("frequency_hz", "frequency_hz = 50000", &["frequency_hz"]),
        number(
            "connection",
            "connection = \"triangle\"",
            &["connection", "delta"],
        ),
        number("name", "name = \"x\"\ncolour = \"red\"", &["colour"]),
        number(
            "power_watt",
            "power_watt = 2200.0\npower_watt = 2200.0",
            &["power_watt"],
        ),
    ]
}

fn utf16(text: &str) -> Vec<u8> {
    let mut bytes = vec![0xFF, 0xFE];
    bytes.extend(text.encode_utf16().flat_map(u16::to_le_bytes));
    bytes
}

const HEADER: &str = "t,va,vb,vc,ia,ib,ic,speed\n";

/// Rows of a plausible recording.
fn rows(count: usize) -> String {
    (0..count).fold(HEADER.to_owned(), |mut text, k| {
        let t = k as f64 * 1e-4;
        let wave = |x: f64, shift: f64| x * (314.16 * t + shift).cos();
        let _ = write!(text, "{t:.4}");
        for (amplitude, lag) in [(325.0, 0.0), (7.0, 0.6)] {
            for phase in [0.0, -2.0944, 2.0944] {
                let _ = write!(text, ",{:.4}", wave(amplitude, phase - lag));
            }
        }
        text + ",150.0\n"
    })
}

fn with_row(row: &str) -> String {
    rows(20) + row + "\n" + "0.0022,1,1,1,1,1,1,150\n"
}

fn truncated_gz() -> Vec<u8> {
    let whole = std::fs::read(Path::new(PROJECT).join("tests/data/peer/none/recording_b.csv.gz"));
    let whole = whole.expect("it ships");
    whole[..whole.len() / 2].to_vec()
}

/// Recordings.
pub fn bad_recordings() -> Vec<Malformed> {
    let csv = |what, content: String, words| malformed(what, "r.csv", content, words);
    vec![
        csv("empty", String::new(), &["r.csv", "empty"]),
        csv("header only", HEADER.to_owned(), &["r.csv"]),
        csv("one row", rows(1), &["r.csv"]),
        malformed("truncated gz", "r.csv.gz", truncated_gz(), &["r.csv.gz"]),
        malformed(
            "gz that is not gzip",
            "r.csv.gz",
            "hello\n".repeat(9),
            &["r.csv.gz"],
        ),
        malformed("binary", "r.csv", vec![0_u8, 1, 2, 255, 0, 7], &["r.csv"]),
        malformed(
            "WAV without samples",
            "r.wav",
            b"RIFF\x24\0\0\0WAVE".to_vec(),
            &["r.wav", "no sound WAV file"],
        ),
        malformed(
            "workbook cut short",
            "r.xlsx",
            b"PK\x03\x04\x14\0".to_vec(),
            &["r.xlsx", "no sound workbook"],
        ),
        csv(
            "NaN",
            with_row("0.0020,NaN,1,1,1,1,1,150"),
            &["r.csv:22", "va"],
        ),
        csv(
            "infinity",
            with_row("0.0020,1,inf,1,1,1,1,150"),
            &["r.csv:22", "vb"],
        ),
        csv(
            "text in a number",
            with_row("0.0020,1,1,1,x7,1,1,150"),
            &["r.csv:22", "ia", "x7"],
        ),
        csv(
            "empty cell",
            with_row("0.0020,1,1,1,,1,1,150"),
            &["r.csv:22", "ia"],
        ),
        csv("short row", with_row("0.0020,1,1"), &["r.csv:22"]),
        csv(
            "long row",
            with_row("0.0020,1,1,1,1,1,1,150,9,9"),
            &["r.csv:22"],
        ),
        csv(
            "duplicate time",
            with_row("0.0019,1,1,1,1,1,1,150"),
            &["r.csv:22", "t"],
        ),
        csv(
            "time runs back",
            with_row("0.0002,1,1,1,1,1,1,150"),
            &["r.csv:22", "t"],
        ),
        csv(
            "no clock",
            rows(20).replace("t,va", "x,va"),
            &["r.csv", "--sample-rate"],
        ),
        csv(
            "no electrical channel",
            "t,speed\n0,1\n0.1,1\n".to_owned(),
            &["r.csv", "ia ib ic"],
        ),
        csv(
            "duplicate column",
            rows(20).replace("ib,ic", "ia,ic"),
            &["r.csv", "ia"],
        ),
        csv(
            "numbers that could be two",
            "t;ia;ib\n0;1,234;5,678\n1;1,345;5,789\n".to_owned(),
            &["r.csv:2", "ia", "--decimal-comma", "--thousands"],
        ),
        csv(
            "two sets of currents",
            "t,Ia,Ib,I1,I2\n0,1,2,3,4\n1,1,2,3,4\n".to_owned(),
            &["r.csv:1", "could each be ia", "--column ia=Ia"],
        ),
        csv(
            "huge line",
            rows(3) + &"9".repeat(200_000) + "\n",
            &["r.csv"],
        ),
        csv("no header", rows(20).replace(HEADER, ""), &["r.csv"]),
    ]
}

fn assert_refused(case: &Malformed, output: &Output) {
    let said = stderr(output);
    let code = output.status.code();
    assert!(
        matches!(code, Some(2 | 3)),
        "{}: exit {code:?}\n{said}",
        case.what
    );
    assert!(!said.contains("panicked"), "{}: {said}", case.what);
    for word in case.words {
        assert!(
            said.contains(word),
            "{}: {word:?} is not in:\n{said}",
            case.what
        );
    }
}

#[test]
fn malformed_motor_files_are_refused_by_name() {
    let folder = scratch("bad-motors");
    let recording = folder.join("good.csv");
    std::fs::write(&recording, rows(4000)).expect("written");
    for case in bad_motors() {
        let file = folder.join(case.file);
        std::fs::write(&file, &case.content).expect("written");
        assert_refused(
            &case,
            &drivemon(&["monitor", text(&recording), "--motor", text(&file)]),
        );
    }
}

#[test]
fn malformed_recordings_are_refused_by_name() {
    let folder = scratch("bad-recordings");
    for case in bad_recordings() {
        let file = folder.join(case.file);
        std::fs::write(&file, &case.content).expect("written");
        let output = drivemon(&["monitor", text(&file), "--motor", "motors/peer-2k2.toml"]);
        assert_refused(&case, &output);
    }
    let missing = drivemon(&[
        "monitor",
        "no-such-file.csv",
        "--motor",
        "motors/peer-2k2.toml",
    ]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(stderr(&missing).contains("no-such-file.csv"));
}

#[test]
fn the_tables_hold_at_least_forty_inputs() {
    assert!(bad_motors().len() + bad_recordings().len() >= 40);
}
