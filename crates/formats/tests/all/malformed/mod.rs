//! Malformed recordings, sidecars and tables: each is refused with file, line, column or key, and the
//! remedy, and none panics.

mod files;
mod sidecars;

use crate::common as recording_common;
use crate::common::{Folder, quiet};
use files::{files, headers, rows};
use formats::read_any;
use recording::{Error, Mapping, Source};
use sidecars::{sidecars, tables};

/// One file that must be refused.
struct Case {
    /// Name of the file.
    name: &'static str,
    /// Its bytes.
    bytes: Vec<u8>,
    /// The sidecar beside it, if any.
    sidecar: Option<&'static str>,
    /// Exit code: 2 bad input, 3 unsupported.
    exit_code: u8,
    /// What the message must contain: place, what is wrong, remedy.
    expected: &'static [&'static str],
}

fn case(bytes: impl Into<Vec<u8>>, expected: &'static [&'static str]) -> Case {
    Case {
        name: "x.csv",
        bytes: bytes.into(),
        sidecar: None,
        exit_code: 2,
        expected,
    }
}

fn named(name: &'static str, bytes: impl Into<Vec<u8>>, expected: &'static [&'static str]) -> Case {
    Case {
        name,
        ..case(bytes, expected)
    }
}

fn with_sidecar(sidecar: &'static str, expected: &'static [&'static str]) -> Case {
    Case {
        sidecar: Some(sidecar),
        ..case("t,ia,ib,ic\n0,1,2,3\n1,1,2,3\n2,1,2,3\n", expected)
    }
}

fn unsupported(bytes: impl Into<Vec<u8>>, expected: &'static [&'static str]) -> Case {
    Case {
        exit_code: 3,
        ..case(bytes, expected)
    }
}

fn refused(case: &Case) -> Error {
    let folder = Folder::new("malformed");
    let path = folder.file(case.name, &case.bytes);
    if let Some(sidecar) = case.sidecar {
        folder.file("x.toml", sidecar.as_bytes());
    }
    match read_any(&path, &Mapping::default(), &mut quiet()) {
        Err(error) => error,
        Ok(source) => panic!("{:?} was read as {source:?}", case.expected),
    }
}

#[test]
fn every_malformed_input_is_refused_with_place_and_remedy() {
    let cases: Vec<Case> = [files(), headers(), rows(), sidecars(), tables()]
        .into_iter()
        .flatten()
        .collect();
    assert!(cases.len() >= 70, "{}", cases.len());
    for case in &cases {
        let error = refused(case);
        let message = error.to_string();
        for expected in case.expected {
            assert!(
                message.contains(expected),
                "`{expected}` is not in: {message}"
            );
        }
        assert_eq!(error.exit_code(), case.exit_code, "{message}");
    }
}

#[test]
fn what_is_not_a_file_is_named() {
    let folder = Folder::new("not_a_file");
    let absent = read_any(
        &folder.path("absent.csv"),
        &Mapping::default(),
        &mut quiet(),
    );
    let message = absent.unwrap_err().to_string();
    assert!(message.contains("absent.csv: cannot be opened") && message.contains("check the name"));
    let directory = read_any(&folder.path(""), &Mapping::default(), &mut quiet());
    let message = directory.unwrap_err().to_string();
    assert!(message.contains("is a folder; name a .csv"), "{message}");
}

#[test]
fn all_problems_of_a_sidecar_are_named_at_once() {
    let case = with_sidecar(
        "voltage = 1\nsupply = \"solar\"\n[sensors]\nadc_bits = -1\n",
        &[],
    );
    let error = refused(&case);
    assert_eq!(error.problems().len(), 3, "{error}");
}

/// What looks odd and is fine.
#[test]
fn unusual_but_sound_files_are_read() {
    let read = |bytes: &[u8], flags: &Mapping| {
        let folder = Folder::new("unusual");
        match read_any(&folder.file("x.csv", bytes), flags, &mut quiet()) {
            Ok(Source::Recording(recording)) => recording,
            other => panic!("{other:?}"),
        }
    };
    let plain = Mapping::default();
    let mark = read(b"\xEF\xBB\xBFt,ia\n0,1\n1,2\n", &plain);
    assert_eq!(mark.len(), 2);
    let windows = read(
        b"# bench 3\r\n\"t\", \"ia\"\r\n0, 1\r\n1, 2\r\n\r\n",
        &plain,
    );
    assert_eq!(windows.len(), 2);
    let mut german = Mapping::default();
    german.set_delimiter(";").unwrap();
    german.decimal_comma = Some(true);
    let comma = read(b"t;ia\n0,0;1,5\n0,1;-2,5\n", &german);
    assert_eq!(comma.channels().next().unwrap().1, [1.5, -2.5]);
    let holes = Mapping {
        skip_missing: Some(true),
        ..Mapping::default()
    };
    let gap = read(b"t,ia\n0,1\n1,\n2,3\n", &holes);
    assert_eq!(gap.t(), [0.0, 2.0]);
    assert!(gap.assumptions[0].contains("1 rows without a number were dropped"));
    // As the error of an overflow says.
    assert_eq!(read(b"t,ia\n0,1\n1,inf\n2,3\n", &holes).t(), [0.0, 2.0]);
    let counted = Mapping {
        sample_rate_hz: Some(10.0),
        skip_missing: Some(true),
        ..Mapping::default()
    };
    assert_eq!(read(b"ia\n1\nnan\n3\n", &counted).t(), [0.0, 0.2]);
}
