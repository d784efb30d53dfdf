//! Slips in COMTRADE files. `crates/drivemon/tests/bad_input` reads this file too.

/// What is replaced in the configuration, by what, the exit code, and words of the message.
pub type Row = (&'static str, &'static str, u8, &'static [&'static str]);

/// Slips in a configuration.
pub const CONFIGURATIONS: [Row; 20] = [
    (
        "1,1,P",
        "0,0,S",
        2,
        &[
            "x.cfg: VA: cannot be read",
            "primary/secondary is 0/0",
            "or P",
        ],
    ),
    (
        "5000,100",
        "10000,100",
        2,
        &[
            "x.cfg: t: cannot be read",
            "declares 10000 Hz",
            "--sample-rate",
        ],
    ),
    (
        "BINARY\r\n1\r\n",
        "BINARY\r\n2\r\n",
        2,
        &[
            "x.cfg: t: cannot be read",
            "its time stamp says",
            "timemult",
        ],
    ),
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

/// Rows of text that replace the eighth one.
pub const ROWS: [(&str, &[&str]); 4] = [
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
