//! COMTRADE recordings that cannot be read: one row each.

use super::comtrade::{names, pair, text};
use super::{assert_error, bytes};
use crate::common::Folder;
use recording::Mapping;

/// What is replaced in the configuration, by what, the exit code, and words of the message.
type Row = (&'static str, &'static str, u8, &'static [&'static str]);

const CONFIGURATIONS: [Row; 17] = [
    (
        "7,6A,1D",
        "7,6,1D",
        2,
        &["x.cfg:2: ##A", "`6` is not a count such as 6A"],
    ),
    ("7,6A,1D", "7,xA,1D", 2, &["x.cfg:2: ##A", "`xA`"]),
    (
        "7,6A,1D",
        "7,999999999A,1D",
        2,
        &["x.cfg:2: TT", "up to 10000"],
    ),
    (
        "7,6A,1D",
        "7,8A,1D",
        2,
        &["x.cfg:9", "`1` is not a channel: An,ch_id"],
    ),
    (
        ",kV,2e-05,",
        ",kV,,",
        2,
        &["x.cfg:3: a", "`` is not a number", "IEEE C37.111"],
    ),
    (
        ",kV,2e-05,",
        ",kV,inf,",
        2,
        &["x.cfg:3: a", "`inf` is not a number"],
    ),
    (
        "A,0.0005,0,",
        "A,0.0005,zero,",
        2,
        &["x.cfg:6: b", "`zero`"],
    ),
    (
        ",kV,",
        ",MW,",
        2,
        &[
            "VA: the file declares `MW`, which is not a unit of va",
            "--unit va=UNIT",
        ],
    ),
    (
        "\r\n1\r\n5000",
        "\r\nmany\r\n5000",
        2,
        &["x.cfg:11: nrates", "`many`"],
    ),
    (
        "\r\n1\r\n5000",
        "\r\n99999\r\n5000",
        2,
        &["x.cfg:11: nrates", "up to 1000"],
    ),
    ("5000,100", "fast,100", 2, &["x.cfg:12: samp", "`fast`"]),
    (
        "5000,100",
        "-5000,100",
        2,
        &["x.cfg:12: samp", "a rate in Hz"],
    ),
    ("5000,100", "5000,end", 2, &["x.cfg:12: endsamp", "`end`"]),
    (
        "1\r\n5000,100",
        "2\r\n5000,50\r\n1000,100",
        3,
        &[
            "rate changes: 5000 Hz to sample 50, then 1000 Hz",
            "at one rate",
        ],
    ),
    (
        "BINARY\r\n1",
        "HEX\r\n1",
        2,
        &[
            "x.cfg:15: ft",
            "`HEX` is not ASCII, BINARY, BINARY32 or FLOAT32",
        ],
    ),
    (
        "BINARY\r\n1",
        "BINARY\r\n0",
        2,
        &["x.cfg:16: timemult", "a factor above 0"],
    ),
    (
        "\r\nBINARY\r\n1\r\n",
        "",
        2,
        &["x.cfg:14", "the configuration ends before the kind of data"],
    ),
];

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

/// Rows of text that replace the eighth one.
const ROWS: [(&str, &[&str]); 4] = [
    (
        "8,1400,1,2,3",
        &[
            "x.dat:8: has 5 fields, the configuration has 9",
            "complete or remove",
        ],
    ),
    ("8,1400,1,2,3,4,5,6,0,9,9", &["x.dat:8: has 11 fields"]),
    (
        "8,1400,1,two,3,4,5,6,0",
        &["x.dat:8: VB: `two` is not a number"],
    ),
    (
        "eight,1400,1,2,3,4,5,6,0",
        &["x.dat:8: n: `eight` is not a number"],
    ),
];

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
fn the_recorders_names_are_no_channels_until_they_are_mapped() {
    let folder = Folder::new("unmapped");
    let path = pair(&folder, &text("binary-1999.cfg"), &bytes("binary-1999.dat"));
    let words = [
        "VA: is not a known column; did you mean `va`?",
        "--column va=VA",
        "--column ic=IC",
    ];
    assert_error(&path, &Mapping::default(), 2, &words);
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
            let _ = recording::read_any(&path, &names(), &mut crate::common::quiet());
        }
    }
}
