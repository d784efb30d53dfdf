//! Parquet, MAT and COMTRADE: files of other people's writers are read to the numbers that went in,
//! and damaged ones are refused with place and remedy.
//!
//! `tests/data/make.py` says what is in them.

mod comtrade;
mod comtrade_cases;
mod comtrade_damaged;
mod mat;
mod parquet;
mod wav;
mod workbook;

use crate::common::quiet;
use formats::read_recording;
use recording::{Channel, Error, Mapping, Recording};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

/// Samples of every file of `make.py`.
const N: usize = 100;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(data(name)).unwrap()
}

fn mapping(columns: &[&str]) -> Mapping {
    let mut mapping = Mapping::default();
    for column in columns {
        mapping.set_column(column).unwrap();
    }
    mapping
}

fn read(path: &Path, flags: &Mapping) -> Result<Recording, Error> {
    read_recording(path, flags, &mut quiet())
}

/// The largest difference of a channel from what `make.py` put in, over its first samples.
fn error(recording: &Recording, channel: Channel, amplitude: f64, angle: f64) -> f64 {
    let values = recording.channel(channel).unwrap();
    let t = recording.t();
    let exact = t.iter().map(|t| amplitude * (100.0 * PI * t - angle).cos());
    let errors = values.iter().zip(exact).map(|(x, y)| (x - y).abs());
    errors.fold(0.0, f64::max)
}

/// Asserts the three voltages and currents of `make.py`, to a resolution in V and A.
fn assert_signals(recording: &Recording, volt: f64, amp: f64) {
    let rising = recording
        .t()
        .windows(2)
        .all(|t| (t[1] - t[0] - 2e-4).abs() < 1e-9);
    assert!(rising && recording.t()[0] == 0.0);
    for k in 0..3 {
        let lag = k as f64 * 2.0 * PI / 3.0;
        let (v, i) = (Channel::VOLTAGES[k], Channel::CURRENTS[k]);
        let off = error(recording, v, 325.0, lag);
        assert!(off <= volt, "{v}: {off}");
        let off = error(recording, i, 7.0, 0.6 + lag);
        assert!(off <= amp, "{i}: {off}");
    }
}

fn assert_notes(recording: &Recording, expected: &[&str]) {
    let notes = &recording.assumptions;
    for note in expected {
        assert!(
            notes.iter().any(|n| n.contains(note)),
            "`{note}` is not in {notes:?}"
        );
    }
}

/// Writes a file of bytes and expects words of the error and its exit code.
fn assert_refused(name: &str, bytes: &[u8], exit_code: u8, expected: &[&str]) {
    let folder = crate::common::Folder::new("formats");
    assert_error(
        &folder.file(name, bytes),
        &Mapping::default(),
        exit_code,
        expected,
    );
}

fn assert_error(path: &Path, flags: &Mapping, exit_code: u8, expected: &[&str]) {
    let error = match read(path, flags) {
        Err(error) => error,
        Ok(recording) => panic!("{expected:?} was read: {:?}", recording.assumptions),
    };
    let message = error.to_string();
    for words in expected {
        assert!(message.contains(words), "`{words}` is not in: {message}");
    }
    assert_eq!(error.exit_code(), exit_code, "{message}");
}

#[test]
fn a_name_that_does_not_fit_the_content_is_named() {
    let parquet = bytes("pyarrow-gzip.parquet");
    assert_refused(
        "x.csv",
        &parquet,
        2,
        &["is a Parquet file", "rename it to", "x.parquet"],
    );
    assert_refused("x.mat", &parquet, 2, &["is a Parquet file", "x.parquet"]);
    let mat = bytes("scipy-v6.mat");
    assert_refused("x.parquet", &mat, 2, &["is a MAT-file", "x.mat"]);
    let cff = bytes("ascii-2013.cff");
    assert_refused("x.txt", &cff, 2, &["is a COMTRADE recording", "x.cff"]);
    for name in ["x.parquet", "x.mat", "x.cff", "x.cfg"] {
        assert_refused(
            name,
            b"",
            2,
            &[name, "is empty", "record or export it again"],
        );
    }
}

#[test]
fn a_table_that_is_called_dat_is_a_table() {
    let folder = crate::common::Folder::new("dat");
    let path = folder.file("x.dat", b"t,ia\n0,1\n1,2\n");
    assert_eq!(read(&path, &Mapping::default()).unwrap().len(), 2);
}
