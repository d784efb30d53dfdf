//! COMTRADE recordings that cannot be read: one row each.

use super::comtrade::{names, pair, text};
use super::comtrade_cases::{CONFIGURATIONS, ROWS};
use super::{assert_error, bytes};
use crate::common::Folder;
use recording::Mapping;

#[test]
fn a_wrong_configuration_is_named_by_line_and_field() {
    let good = text("binary-1999.cfg");
    for (from, to, exit_code, words) in CONFIGURATIONS {
        assert!(good.contains(from), "{from}");
        let folder = Folder::new("bad-cfg");
        let path = pair(
            &folder,
            &good.replacen(from, to, 1),
            &bytes("binary-1999.dat"),
        );
        assert_error(&path, &names(), exit_code, words);
    }
}

#[test]
fn a_wrong_row_of_text_is_named_by_line_and_channel() {
    let good = text("ascii-1999.dat");
    for (row, words) in ROWS {
        let mut rows: Vec<&str> = good.lines().collect();
        rows[7] = row;
        let folder = Folder::new("bad-dat");
        let path = pair(&folder, &text("ascii-1999.cfg"), rows.join("\n").as_bytes());
        assert_error(&path, &names(), 2, words);
    }
}

#[test]
fn a_missing_half_is_named() {
    let folder = Folder::new("half");
    let path = folder.file("x.cfg", &bytes("binary-1999.cfg"));
    let words = ["x.cfg: has no .dat of the same name beside it", "copy both"];
    assert_error(&path, &names(), 2, &words);
    let none = folder.file("x.dat", b"");
    assert_error(&path, &names(), 2, &["x.dat: holds no sample"]);
    assert_error(&none, &names(), 2, &["x.dat: is empty"]);
    let cff = folder.file("y.cff", b"--- file type: CFG ---\r\nx\r\n");
    assert_error(
        &cff,
        &names(),
        2,
        &["y.cff: has no section `--- file type: DAT ASCII ---`"],
    );
}

#[test]
fn a_clock_without_rate_and_stamps_is_no_clock() {
    let folder = Folder::new("no-clock");
    let mut codes = bytes("binary-1999.dat");
    let record = 8 + 6 * 2 + 2;
    codes[3 * record + 4..][..4].copy_from_slice(&u32::MAX.to_le_bytes());
    let cfg = text("binary-1999.cfg").replace("1\r\n5000,100", "0\r\n0,100");
    let words = [
        "declares no sampling rate, and sample 4 has no time stamp",
        "set the rate",
    ];
    assert_error(&pair(&folder, &cfg, &codes), &names(), 2, &words);
}

#[test]
fn the_recorders_names_are_taken_for_what_they_mean_and_it_is_said() {
    let folder = Folder::new("unmapped");
    let path = pair(&folder, &text("binary-1999.cfg"), &bytes("binary-1999.dat"));
    let recording =
        formats::read_recording(&path, &Mapping::default(), &mut crate::common::quiet()).unwrap();
    for note in [
        "column VA is va, by its name",
        "column IC is ic, by its name",
    ] {
        assert!(
            recording.assumptions.iter().any(|said| said == note),
            "{note}"
        );
    }
    assert!(recording.voltages().is_some() && recording.currents().is_some());
}

/// Whatever single byte is wrong: an error or a recording, never a panic.
#[test]
fn no_wrong_byte_panics() {
    let folder = Folder::new("comtrade-bytes");
    for name in ["ascii-2013.cff", "binary-2013.cff"] {
        let whole = bytes(name);
        for at in (0..whole.len()).step_by(3) {
            let mut wrong = whole.clone();
            wrong[at] ^= 1 << (at % 8);
            let path = folder.file("x.cff", &wrong);
            let _ = formats::read_any(&path, &names(), &mut crate::common::quiet());
        }
    }
}
