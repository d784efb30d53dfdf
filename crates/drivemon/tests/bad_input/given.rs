//! The inputs that the command line can be given, and what it prints.

use std::path::Path;
use std::process::{Command, Output};

use crate::common::{PROJECT, scratch, stderr};
use crate::firmware::{elf, program};
use crate::malformed::{bad_motors, bad_recordings};
use crate::{Case, comtrade_cases, files, motor_cases, scenario_cases, sidecars};

/// One input.
pub struct Given {
    /// What it is, in words or as it stands in the file.
    pub what: String,
    /// Name and bytes of the files; the command is given the first.
    pub files: Vec<(String, Vec<u8>)>,
    /// The command before the file, and after it.
    pub command: [&'static [&'static str]; 2],
    /// Words of the error.
    pub words: Vec<String>,
    /// The exit code, where it is one only.
    pub exit_code: Option<u8>,
    /// The test that is about it, `file::name`.
    pub test: &'static str,
}

const MONITOR: [&[&str]; 2] = [&["monitor"], &["--motor", "peer-2k2.toml"]];
const ALONE: [&[&str]; 2] = [&["monitor"], &[]];
const MAPPED: [&[&str]; 2] = [
    &["monitor"],
    &[
        "--column", "va=VA", "--column", "vb=VB", "--column", "ia=IA", "--column", "ib=IB",
    ],
];
const SIMULATE: [&[&str]; 2] = [&["simulate"], &["-o", "out.csv"]];
const MOTOR: [&[&str]; 2] = [&["monitor", "good.csv", "--motor"], &[]];

/// A section of the page: its title and its inputs.
pub fn sections() -> Vec<(&'static str, Vec<Given>)> {
    vec![
        ("Motor files", motors()),
        ("Scenario files", scenarios()),
        ("Recordings: the file", recordings(files::files())),
        ("Recordings: the header", recordings(files::headers())),
        ("Recordings: the rows", recordings(files::rows())),
        ("Recordings: with a motor file", whole_recordings()),
        ("Sidecars", recordings(sidecars::sidecars())),
        ("Load-test tables", recordings(sidecars::tables())),
        ("COMTRADE", comtrade()),
        ("Parquet and MAT", binary()),
        ("Keys and packages", programs()),
    ]
}

fn owned(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

fn motors() -> Vec<Given> {
    let smallest = include_str!("../../../../crates/motor/src/motor_file/smallest.toml");
    let slips = motor_cases::CASES.iter().map(|case| Given {
        what: case.what.to_owned(),
        files: vec![("m.toml".to_owned(), smallest.replace(case.edit.0, case.edit.1).into_bytes())],
        command: MOTOR,
        words: vec![format!("m.toml:{}: {}: ", case.line, case.key), case.remedy.to_owned()],
        exit_code: Some(2),
        test: "crates/motor/src/motor_file/malformed.rs::each_malformed_file_is_refused_with_file_line_key_and_remedy",
    });
    let whole = bad_motors().into_iter().map(|bad| Given {
        what: bad.what.to_owned(),
        files: vec![(bad.file.to_owned(), bad.content)],
        command: MOTOR,
        words: owned(bad.words),
        exit_code: None,
        test: "crates/drivemon/tests/bad_input/malformed.rs::malformed_motor_files_are_refused_by_name",
    });
    slips.chain(whole).collect()
}

fn scenarios() -> Vec<Given> {
    let slip = |(text, line, key, remedy): &(&str, usize, &str, &str)| Given {
        what: excerpt(text.as_bytes()),
        files: vec![(
            "s.toml".to_owned(),
            format!("motor = \"assumed-300w.toml\"\n{text}\n").into_bytes(),
        )],
        command: SIMULATE,
        words: vec![format!("s.toml:{line}: {key}: "), (*remedy).to_owned()],
        exit_code: Some(2),
        test: "crates/scenario/src/malformed.rs::each_malformed_scenario_is_refused_with_file_line_key_and_remedy",
    };
    scenario_cases::CASES.iter().map(slip).collect()
}

fn recordings(cases: Vec<Case>) -> Vec<Given> {
    let given = |case: Case| Given {
        what: match case.sidecar {
            Some(text) => excerpt(text.as_bytes()),
            None => excerpt(&case.bytes),
        },
        files: std::iter::once((case.name.to_owned(), case.bytes))
            .chain(
                case.sidecar
                    .map(|text| ("x.toml".to_owned(), text.as_bytes().to_vec())),
            )
            .collect(),
        command: ALONE,
        words: owned(case.expected),
        exit_code: Some(case.exit_code),
        test: "crates/formats/tests/all/malformed/mod.rs::every_malformed_input_is_refused_with_place_and_remedy",
    };
    cases.into_iter().map(given).collect()
}

fn whole_recordings() -> Vec<Given> {
    let given = bad_recordings().into_iter().map(|bad| Given {
        what: bad.what.to_owned(),
        files: vec![(bad.file.to_owned(), bad.content)],
        command: MONITOR,
        words: owned(bad.words),
        exit_code: None,
        test: "crates/drivemon/tests/bad_input/malformed.rs::malformed_recordings_are_refused_by_name",
    });
    given.collect()
}

fn data(name: &str) -> Vec<u8> {
    let path = Path::new(PROJECT)
        .join("crates/formats/tests/data")
        .join(name);
    std::fs::read(path).expect("it ships")
}

fn comtrade() -> Vec<Given> {
    let text = |name: &str| String::from_utf8(data(name)).expect("ASCII");
    let slip = |(from, to, exit_code, words): &comtrade_cases::Row| Given {
        what: format!(
            "{} for {}",
            excerpt(to.as_bytes()),
            excerpt(from.as_bytes())
        ),
        files: vec![
            (
                "x.cfg".to_owned(),
                text("binary-1999.cfg").replacen(from, to, 1).into_bytes(),
            ),
            ("x.dat".to_owned(), data("binary-1999.dat")),
        ],
        command: MAPPED,
        words: owned(words),
        exit_code: Some(*exit_code),
        test: "crates/formats/tests/all/formats/comtrade_damaged.rs::a_wrong_configuration_is_named_by_line_and_field",
    };
    let row = |(row, words): &(&'static str, &'static [&'static str])| {
        let all = text("ascii-1999.dat");
        let mut rows: Vec<&str> = all.lines().collect();
        rows[7] = row;
        Given {
            what: excerpt(row.as_bytes()),
            files: vec![
                ("x.cfg".to_owned(), data("ascii-1999.cfg")),
                ("x.dat".to_owned(), rows.join("\n").into_bytes()),
            ],
            command: MAPPED,
            words: owned(words),
            exit_code: Some(2),
            test: "crates/formats/tests/all/formats/comtrade_damaged.rs::a_wrong_row_of_text_is_named_by_line_and_channel",
        }
    };
    let configurations = comtrade_cases::CONFIGURATIONS.iter().map(slip);
    configurations
        .chain(comtrade_cases::ROWS.iter().map(row))
        .collect()
}

fn binary() -> Vec<Given> {
    let given = |what: &str, file: &str, bytes: Vec<u8>, exit_code, words: &[&str], test| Given {
        what: what.to_owned(),
        files: vec![(file.to_owned(), bytes)],
        command: ALONE,
        words: owned(words),
        exit_code: Some(exit_code),
        test,
    };
    const PARQUET: &str = "crates/formats/tests/all/formats/parquet.rs::damaged_files_are_refused";
    const LIES: &str =
        "crates/formats/tests/all/formats/parquet.rs::lengths_that_lie_are_a_damaged_file";
    const BROTLI: &str =
        "crates/formats/tests/all/formats/parquet.rs::every_compression_but_brotli_is_read";
    const MAT: &str =
        "crates/formats/tests/all/formats/mat.rs::damaged_and_foreign_files_are_refused";
    const PARQUET_PHASE: &str =
        "crates/formats/tests/all/formats/parquet.rs::a_phase_that_cannot_be_read_is_no_absent_one";
    const MAT_PHASE: &str =
        "crates/formats/tests/all/formats/mat.rs::a_phase_that_cannot_be_read_is_no_absent_one";
    const NAME: &str =
        "crates/formats/tests/all/formats/mod.rs::a_name_that_does_not_fit_the_content_is_named";
    let (parquet, mat) = (data("pyarrow-gzip.parquet"), data("scipy-v6.mat"));
    let lie = Path::new(PROJECT).join("fuzz/findings/parquet/byte-stream-split");
    let lie = std::fs::read(lie).expect("it ships");
    let new = [&b"MATLAB 7.3 MAT-file, Platform: GLNXA64"[..], &[b' '; 400]].concat();
    let damaged = ["x.parquet: is no Parquet file, or a truncated or damaged one"];
    vec![
        given(
            "half a Parquet file",
            "x.parquet",
            parquet[..900].to_vec(),
            2,
            &damaged,
            PARQUET,
        ),
        given(
            "text that is called .parquet",
            "x.parquet",
            b"t,ia\n0,1\n".to_vec(),
            2,
            &damaged,
            PARQUET,
        ),
        given(
            "lengths that lie in a page",
            "x.parquet",
            lie,
            2,
            &damaged,
            LIES,
        ),
        given(
            "Parquet with brotli",
            "x.parquet",
            data("pyarrow-brotli.parquet"),
            3,
            &["snappy, zstd"],
            BROTLI,
        ),
        given(
            "Parquet that is called .mat",
            "x.mat",
            parquet,
            2,
            &["x.parquet"],
            NAME,
        ),
        given(
            "half a MAT-file",
            "x.mat",
            mat[..1500].to_vec(),
            2,
            &["truncated or damaged"],
            MAT,
        ),
        given(
            "MAT-file without variables",
            "x.mat",
            mat[..128].to_vec(),
            2,
            &["no vector"],
            MAT,
        ),
        given("MAT-file of version 7.3", "x.mat", new, 3, &["-v7"], MAT),
        given(
            "Parquet with ic as text",
            "x.parquet",
            data("pyarrow-text.parquet"),
            2,
            &["ic: cannot be read"],
            PARQUET_PHASE,
        ),
        given(
            "Parquet with ic as decimals of 20 digits",
            "x.parquet",
            data("pyarrow-decimal.parquet"),
            2,
            &["ic: cannot be read"],
            PARQUET_PHASE,
        ),
        given(
            "MAT-file with ic as cells",
            "x.mat",
            data("scipy-cell-phase.mat"),
            2,
            &["ic: cannot be read"],
            MAT_PHASE,
        ),
        given(
            "text that is called .mat",
            "x.mat",
            b"t,ia\n0,1\n".to_vec(),
            2,
            &["version 5"],
            MAT,
        ),
    ]
}

fn programs() -> Vec<Given> {
    const PACKAGE: [&[&str]; 2] = [&["board", "package"], &["--demo-key", "-o", "new.dmu"]];
    const KEY: [&[&str]; 2] = [
        &["board", "package", "firmware", "-o", "new.dmu", "--key"],
        &[],
    ];
    const UPDATE: [&[&str]; 2] = [&["board", "update"], &["--serial", "/dev/no-such-port"]];
    const TEST: &str = "crates/drivemon/tests/commands/programs/mod.rs::what_is_no_program_or_no_key_is_told_with_what_helps";
    const DAMAGED: &str = "crates/program/src/package/tests.rs::damage_at_any_place_is_told_and_so_is_what_is_no_package";
    const KEYS: &str = "crates/program/src/key_file/tests.rs::the_other_half_damaged_text_and_strange_names_are_told";
    let key = |half: &str| {
        let path = Path::new(PROJECT).join("keys").join(half);
        std::fs::read_to_string(path).expect("it ships")
    };
    let given = |what: &str, file: &str, content: &str, command, words: &[&str], test| Given {
        what: what.to_owned(),
        files: vec![
            (file.to_owned(), content.as_bytes().to_vec()),
            ("firmware".to_owned(), elf(&program("1.3.0"))),
        ],
        command,
        words: owned(words),
        exit_code: Some(2),
        test,
    };
    let cut = key("demo.key")
        .trim_end()
        .trim_end_matches(|c: char| c != '\n')
        .to_owned();
    vec![
        given(
            "program that is no ELF file",
            "x",
            "MZ",
            PACKAGE,
            &["x: is no ELF file"],
            TEST,
        ),
        given(
            "public half of a key where the secret one is asked for",
            "own.pub",
            &key("demo.pub"),
            KEY,
            &["own.pub: is the public half"],
            TEST,
        ),
        given(
            "text that is called .key",
            "own.key",
            "hello\n",
            KEY,
            &["own.key: "],
            KEYS,
        ),
        given(
            "key without its last line",
            "own.key",
            &cut,
            KEY,
            &["own.key: "],
            KEYS,
        ),
        given(
            "text that is called .dmu",
            "x.dmu",
            "hello\n",
            UPDATE,
            &["x.dmu: is no package"],
            DAMAGED,
        ),
        given(
            "empty package",
            "x.dmu",
            "",
            UPDATE,
            &["x.dmu: is no package"],
            DAMAGED,
        ),
    ]
}

/// The beginning of a file, as far as it can be shown.
fn excerpt(bytes: &[u8]) -> String {
    let text: String = String::from_utf8_lossy(bytes).chars().take(60).collect();
    let shown = |c: char| match c {
        '\n' => '⏎',
        c if c.is_control() || c == '\u{FFFD}' => '·',
        c => c,
    };
    let text: String = text.replace("\r\n", "\n").chars().map(shown).collect();
    let rest = if bytes.len() > 60 { ".." } else { "" };
    format!("{}{rest}", text.trim_end_matches('⏎'))
}

impl Given {
    /// Runs the command in a folder of its own and returns the first line that it prints as an error.
    pub fn printed(&self) -> (String, u8) {
        let folder = scratch("bad-input");
        for motor in ["peer-2k2.toml", "assumed-300w.toml"] {
            let shipped = Path::new(PROJECT).join("motors").join(motor);
            std::fs::copy(shipped, folder.join(motor)).expect("written");
        }
        std::fs::write(folder.join("good.csv"), "t,ia,ib\n0,1,2\n1,2,3\n").expect("written");
        for (name, bytes) in &self.files {
            std::fs::write(folder.join(name), bytes).expect("written");
        }
        let [before, after] = self.command;
        let output = Command::new(env!("CARGO_BIN_EXE_drivemon"))
            .args([before, &[self.files[0].0.as_str()], after].concat())
            .current_dir(&folder)
            .env("NO_COLOR", "1")
            .output()
            .expect("the binary runs");
        self.check(&output);
        let said = stderr(&output);
        let code = output
            .status
            .code()
            .and_then(|code| u8::try_from(code).ok());
        (
            said.lines().next().unwrap_or_default().to_owned(),
            code.expect("a code"),
        )
    }

    fn check(&self, output: &Output) {
        let (said, what) = (stderr(output), &self.what);
        assert!(!said.contains("panicked"), "{what}: {said}");
        for word in &self.words {
            assert!(said.contains(word), "{what}: `{word}` is not in:\n{said}");
        }
        let code = output.status.code();
        match self.exit_code {
            Some(expected) => assert_eq!(code, Some(expected.into()), "{what}: {said}"),
            None => assert!(matches!(code, Some(2 | 3)), "{what}: exit {code:?}\n{said}"),
        }
    }
}
