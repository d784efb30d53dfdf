//! Malformed recordings: the file as a whole, its header, its rows.

use super::recording_common::gzip;
use super::{Case, case, named, unsupported};

fn long_table() -> String {
    let rows: Vec<String> = (0..5000)
        .map(|k| format!("{k},{},2,3", k * 7919 % 1013))
        .collect();
    format!("t,ia,ib,ic\n{}\n", rows.join("\n"))
}

fn damaged_gzip() -> Vec<u8> {
    let mut packed = gzip(long_table().as_bytes());
    // RFC 1952: the checksum of the content is in the last eight bytes.
    let checksum = packed.len() - 8;
    packed[checksum] ^= 0xFF;
    packed
}

fn utf16(text: &str, big_endian: bool) -> Vec<u8> {
    let order = |unit: u16| {
        if big_endian {
            unit.to_be_bytes()
        } else {
            unit.to_le_bytes()
        }
    };
    std::iter::once(0xFEFF)
        .chain(text.encode_utf16())
        .flat_map(order)
        .collect()
}

/// Files that are no text, damaged, or of another format.
pub fn files() -> Vec<Case> {
    let half = gzip(long_table().as_bytes());
    let half = half[..half.len() / 2].to_vec();
    vec![
        case("", &["x.csv: is empty", "first line names the columns"]),
        named("x.csv.gz", "", &["x.csv.gz: is empty"]),
        named("x.csv.gz", gzip(b""), &["x.csv.gz: is empty"]),
        case("# only a comment\n", &["holds no header"]),
        case("t,ia,ib,ic\n", &["a header, but no samples", "record"]),
        case("t,ia,ib,ic\n0,1,2,3\n", &["a single sample", "at least 2"]),
        named(
            "x.csv.gz",
            half,
            &["x.csv.gz:", "truncated or damaged", "copy or record"],
        ),
        named(
            "x.csv.gz",
            damaged_gzip(),
            &["x.csv.gz:", "truncated or damaged"],
        ),
        named(
            "x.csv.gz",
            "t,ia\n0,1\n1,2\n",
            &["is not gzip-compressed", "rename it without .gz"],
        ),
        case(
            gzip(b"t,ia\n0,1\n1,2\n"),
            &["name does not end in .gz", "rename it to", "x.csv.gz"],
        ),
        named(
            "x.csv.gz",
            gzip(&gzip(b"t,ia\n0,1\n")),
            &["compressed twice"],
        ),
        case(utf16("t,ia\n", true), &["a header, but no samples"]),
        case(
            b"t\0,\0i\0a\0\n\0\x000,1".to_vec(),
            &["zero byte at offset 1", "export it as text"],
        ),
        case(
            b"t,ia\n0,1\n1,\xC3\x28\n".to_vec(),
            &["x.csv:3: ia", "is not a number"],
        ),
        case(
            b"t,i\xFFa\n0,1\n1,2\n".to_vec(),
            &["x.csv:1", "neither currents nor voltages"],
        ),
        case(
            format!("t,ia\n0,1\n1,{}\n", "9".repeat(100_000)),
            &["x.csv:3", "longer than 65536"],
        ),
        case("x".repeat(300_000), &["x.csv:1", "longer than 65536"]),
        case(
            b"PAR1\x15\x04\x15".to_vec(),
            &["is a Parquet file", "rename it to", "x.parquet"],
        ),
        unsupported(
            b"\x89HDF\r\n\x1A\n".to_vec(),
            &["HDF5", "export it as .csv"],
        ),
        case(
            b"MATLAB 5.0 MAT-file, Platform".to_vec(),
            &["is a MAT-file", "rename it to", "x.mat"],
        ),
        unsupported(b"PK\x03\x04".to_vec(), &["zip archive", "export it"]),
    ]
}

/// Headers that do not say what the columns are.
pub fn headers() -> Vec<Case> {
    vec![
        case(
            "0,1,2\n1,2,3\n",
            &[
                "x.csv:1",
                "numbers, not column names",
                "put a line such as",
                "--columns t,va",
            ],
        ),
        case(
            "t;ia;ib\n0;1,234;5,678\n1;1,345;5,789\n",
            &[
                "x.csv:2: ia: `1,234` is 1234 or 1.234",
                "--thousands ','",
                "--decimal-comma",
            ],
        ),
        case(
            "t;ia\n0;1.234\n1;-2.345\n",
            &["x.csv:2: ia: `1.234` is 1234 or 1.234", "--thousands none"],
        ),
        case(
            "t;ia\n0,5;1,5\n1,5;1.234\n2,5;0.5\n",
            &["x.csv:3: ia: `1.234` is not a number", "--thousands ."],
        ),
        case(
            "time;ia\n3/4/2024 23:59:59.9;1\n3/4/2024 23:59:59.95;2\n4/4/2024 00:00:00;3\n",
            &["x.csv:4: time", "day or month first", "--date-order dmy"],
        ),
        case(
            "time;ia\n12:00:00;1\n12:00:01;2\nnoon;3\n",
            &["x.csv:4: time", "`noon` is not a date or time of day"],
        ),
        case(
            "t,Ia,Ib,I1,I2\n0,1,2,3,4\n1,1,2,3,4\n",
            &[
                "x.csv:1: ia",
                "Ia Ib I1 I2 could each be ia",
                "--column ia=Ia",
            ],
        ),
        case(
            "t,ia [V]\n0,1\n1,2\n",
            &["x.csv:1: ia [V]", "declares `V`", "--sensor ia=100mV/A"],
        ),
        case(
            "t,ia,ia\n0,1,2\n",
            &["x.csv:1", "`ia` appears twice", "rename or remove"],
        ),
        case(
            "t,ia,\n0,1,2\n",
            &["x.csv:2", "has 3 columns, the header has 2"],
        ),
        case(
            "t,ia,spead\n0,1,2\n",
            &[
                "x.csv:1: spead",
                "did you mean `speed`",
                "--column speed=spead",
            ],
        ),
        case("Tt,ia\n0,1\n1,2\n", &["x.csv:1: t", "no clock"]),
        case(
            "ia,ib,ic\n1,2,3\n",
            &["x.csv:1: t", "no clock", "--sample-rate"],
        ),
        case(
            "t,speed\n0,1\n1,2\n",
            &[
                "x.csv:1",
                "neither currents nor voltages",
                "--column ia=NAME",
            ],
        ),
        case("t,vab\n0,1\n1,2\n", &["neither currents nor voltages"]),
        case(
            "t,ia,power_watt\n0,1,2\n",
            &["belongs to a load table", "two files"],
        ),
    ]
}

/// Rows that hold no numbers, or a clock that does not rise.
pub fn rows() -> Vec<Case> {
    vec![
        case(
            "t,ia\n0,1\n1,NaN\n",
            &["x.csv:3: ia", "no number (empty or NaN)", "--skip-missing"],
        ),
        case(
            "t,ia\n0,1\n1,\n",
            &["x.csv:3: ia", "no number", "--skip-missing"],
        ),
        case(
            "t,ia\n0,1\n1,inf\n",
            &["x.csv:3: ia", "`inf` is inf", "overflow"],
        ),
        case(
            "t,ia\n0,1\n1e-300,2\n2e-300,3\n",
            &[
                "x.csv: t: the samples are 1e-300 s apart",
                "--sample-rate HZ",
            ],
        ),
        case("t,ia\n0,1\n1,1e999\n", &["x.csv:3: ia", "`1e999` is inf"]),
        case(
            "t,ia\n0,1\n1,off\n",
            &[
                "x.csv:3: ia",
                "`off` is not a number",
                "one number per cell",
            ],
        ),
        case(
            "t,ia\n0,1\n1,3.7 A\n",
            &[
                "x.csv:3: ia",
                "`3.7 A` is not a number",
                "unit only in the header",
            ],
        ),
        case(
            "t,ia\n0,1\n1\n",
            &[
                "x.csv:3",
                "has 1 columns, the header has 2",
                "complete the row",
            ],
        ),
        case(
            "t,ia\n0,0,1,5\n",
            &["x.csv:2", "has 4 columns", "with a point"],
        ),
        case("t,ia\r\n0,1\r\n1,x\r\n", &["x.csv:3: ia"]),
        case("# one\nt,ia\r\r# two\r0,1\r1,x", &["x.csv:6: ia"]),
        case(
            "t,ia\n0,1\n\n0,2\n",
            &["x.csv:4: t", "0 s appears twice", "--sample-rate"],
        ),
        case(
            "t,ia\n0,1\n2,2\n1,3\n",
            &["x.csv:4: t", "falls from 2 s to 1 s", "sort"],
        ),
    ]
}
