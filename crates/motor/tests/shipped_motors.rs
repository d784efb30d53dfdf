//! The motor files that come with the project hold what their sources say.
#![cfg(feature = "file")]

use motor::MotorFile;
use motor::motor_file::Connection;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../motors")
}

fn motor(name: &str) -> MotorFile {
    MotorFile::read(folder().join(name)).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_shipped_motor_file_is_valid() {
    let mut count = 0;
    for entry in std::fs::read_dir(folder()).expect("motors/") {
        let path = entry.expect("readable").path();
        MotorFile::read(&path).unwrap_or_else(|error| panic!("{error}"));
        count += 1;
    }
    assert!(count >= 3);
}

/// Published per delta phase, as resistances and as reactances at 50 Hz; a star phase has a third.
#[test]
fn the_18k5_motor_is_the_published_delta_machine() {
    let file = motor("imc-18k5.toml");
    let omega = TAU * 50.0;
    let p = file.parameters;
    let pairs = [
        (3.0 * p.r_s, 0.56),
        (3.0 * p.r_r, 0.42),
        (3.0 * omega * p.l_ls, 1.52),
        (3.0 * omega * p.l_lr, 2.31),
        (3.0 * omega * p.l_m, 66.4),
    ];
    for (ours, published) in pairs {
        assert!((ours / published - 1.0).abs() < 1e-12, "{ours} {published}");
    }
    assert_eq!(file.nameplate.connection, Connection::Delta);
    assert_eq!(file.parameter_temperature_degc, Some(20.0));
}
