//! Bad input: every one is refused by the program with a place and a remedy, and docs/bad-input.md says what is printed.
//!
//! `UPDATE_DOCS=1 cargo test -p drivemon --test bad_input` writes the page.

#[path = "../common/mod.rs"]
mod common;

mod board;
#[path = "../../../../crates/formats/tests/all/formats/comtrade_cases.rs"]
mod comtrade_cases;
#[path = "../../../../crates/formats/tests/all/malformed/files.rs"]
mod files;
#[path = "../commands/programs/firmware.rs"]
mod firmware;
mod given;
mod malformed;
#[path = "../../../../crates/motor/src/motor_file/malformed_cases.rs"]
mod motor_cases;
mod page;
#[path = "../../../../crates/formats/tests/all/common.rs"]
mod recording_common;
#[path = "../../../scenario/src/malformed_cases.rs"]
mod scenario_cases;
#[path = "../../../../crates/formats/tests/all/malformed/sidecars.rs"]
mod sidecars;

/// A malformed recording as `crates/formats/tests/all/malformed` describes it.
struct Case {
    name: &'static str,
    bytes: Vec<u8>,
    sidecar: Option<&'static str>,
    exit_code: u8,
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
