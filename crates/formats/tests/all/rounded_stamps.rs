//! Files of an even clock whose time stamps have few decimals.

use crate::common::{Folder, quiet};
use formats::{read_in_pieces, read_recording};
use recording::{Error, Mapping};
use std::fmt::Write as _;

fn table(rate_hz: f64, decimals: usize, unit_s: f64, rows: usize) -> String {
    let mut text = String::from("t,ia,ib\n");
    for k in 0..rows {
        let t = k as f64 / rate_hz;
        let ia = (314.0 * t).cos();
        let _ = writeln!(text, "{:.decimals$},{ia},{ia}", t / unit_s);
    }
    text
}

#[test]
fn the_rate_is_that_of_all_stamps() {
    let folder = Folder::new("rounded");
    let mut milliseconds = Mapping::default();
    milliseconds.set_unit("t=ms").unwrap();
    let cases = [
        (4000.0, 4, 1.0, "0.1 ms"),
        (12_800.0, 5, 1.0, "10 us"),
        (16_000.0, 4, 1.0, "0.1 ms"),
        (8000.0, 1, 1e-3, "0.1 ms"),
    ];
    for (rate_hz, decimals, unit_s, rounding) in cases {
        let path = folder.file("x.csv", table(rate_hz, decimals, unit_s, 20_000).as_bytes());
        let flags = match unit_s < 1.0 {
            true => milliseconds.clone(),
            false => Mapping::default(),
        };
        let recording = read_recording(&path, &flags, &mut quiet()).unwrap();
        assert!(
            (recording.t_sample() * rate_hz - 1.0).abs() < 1e-5,
            "{rate_hz}"
        );
        let said =
            format!("time stamps are rounded to {rounding}; {rate_hz} Hz from first to last");
        assert!(
            recording.assumptions.contains(&said),
            "{:?}",
            recording.assumptions
        );
    }
}

/// Each piece has a line of its own; where they meet no gap opens.
#[test]
fn pieces_meet_without_a_gap() {
    let folder = Folder::new("rounded-pieces");
    let path = folder.file("x.csv", table(8000.0, 4, 1.0, 40_000).as_bytes());
    let mut last: Option<f64> = None;
    let mut steps = Vec::new();
    let mut take = |piece: &recording::Recording, _| {
        steps.extend(last.map(|last| piece.t()[0] - last));
        last = piece.t().last().copied();
        Ok::<(), Error>(())
    };
    read_in_pieces(&path, &Mapping::default(), 12_000, &mut quiet(), &mut take).unwrap();
    assert_eq!(steps.len(), 3);
    assert!(
        steps.iter().all(|step| (8000.0 * step - 1.0).abs() < 0.1),
        "{steps:?}"
    );
}

#[test]
fn a_time_that_comes_twice_among_exact_ones_is_an_error() {
    let folder = Folder::new("rounded-twice");
    let text = table(10_000.0, 4, 1.0, 20_000);
    let twice = text.replace("\n1.0000,", "\n0.9999,");
    let path = folder.file("x.csv", twice.as_bytes());
    let error = read_recording(&path, &Mapping::default(), &mut quiet()).unwrap_err();
    assert!(error.to_string().contains("appears twice"), "{error}");
}
