//! Malformed recordings, sidecars and tables: each is refused with file, line, column or key, and the
//! remedy, and none panics.

mod common;

use common::{Folder, gzip, quiet};
use recording::{Error, Mapping, Source, read_any};

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

fn files() -> Vec<Case> {
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
        case(
            utf16("t,ia\n0,1\n1,2\n", false),
            &["UTF-16", "save it as UTF-8"],
        ),
        case(
            utf16("t,ia\n0,1\n1,2\n", true),
            &["UTF-16", "save it as UTF-8"],
        ),
        case(
            b"t\0,\0i\0a\0".to_vec(),
            &["zero byte at offset 1", "UTF-8"],
        ),
        case(
            b"t,ia\n0,1\n1,\xC3\x28\n".to_vec(),
            &["x.csv:3: ia", "not UTF-8"],
        ),
        case(
            b"t,i\xFFa\n0,1\n1,2\n".to_vec(),
            &["x.csv:1", "header is not UTF-8"],
        ),
        case(
            format!("t,ia\n0,1\n1,{}\n", "9".repeat(100_000)),
            &["x.csv:3", "longer than 65536"],
        ),
        case("x".repeat(300_000), &["x.csv:1", "longer than 65536"]),
        unsupported(
            b"PAR1\x15\x04\x15".to_vec(),
            &["Parquet", "export it as .csv"],
        ),
        unsupported(
            b"\x89HDF\r\n\x1A\n".to_vec(),
            &["HDF5", "export it as .csv"],
        ),
        unsupported(
            b"MATLAB 5.0 MAT-file, Platform".to_vec(),
            &["MAT-file", "export it"],
        ),
        unsupported(b"PK\x03\x04".to_vec(), &["zip archive", "export it"]),
    ]
}

fn headers() -> Vec<Case> {
    vec![
        case(
            "0,1,2\n1,2,3\n",
            &["x.csv:1", "numbers, not column names", "put a line such as"],
        ),
        case(
            "t;ia;ib\n0;1;2\n",
            &["x.csv:1", "separated by ';'", "--delimiter ';'"],
        ),
        case(
            "t\tia\tib\n0\t1\t2\n",
            &["x.csv:1", "separated by '\\t'", "--delimiter 'tab'"],
        ),
        case(
            "t,ia,ia\n0,1,2\n",
            &["x.csv:1", "`ia` stands there twice", "rename or remove"],
        ),
        case("t,ia,\n0,1,2\n", &["x.csv:1", "column 3 has no name"]),
        case(
            "t,ia,spead\n0,1,2\n",
            &[
                "x.csv:1: spead",
                "did you mean `speed`",
                "--column speed=spead",
            ],
        ),
        case("T,Ia\n0,1\n1,2\n", &["x.csv:1: T", "did you mean `t`"]),
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

fn rows() -> Vec<Case> {
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
            &["x.csv:4: t", "0 s stands there twice", "--sample-rate"],
        ),
        case(
            "t,ia\n0,1\n2,2\n1,3\n",
            &["x.csv:4: t", "falls from 2 s to 1 s", "sort"],
        ),
    ]
}

fn sidecars() -> Vec<Case> {
    vec![
        with_sidecar("", &["x.toml", "sidecar is empty", "remove it"]),
        with_sidecar(
            "volt = \"hold\"",
            &["x.toml:1: volt", "did you mean `voltage`"],
        ),
        with_sidecar(
            "voltage = \"rms\"",
            &["x.toml:1: voltage", "\"instantaneous\", \"hold\""],
        ),
        with_sidecar("voltage = 3", &["x.toml:1: voltage", "is a number"]),
        with_sidecar("voltage = hold", &["x.toml:1", "double quotes"]),
        with_sidecar(
            "\n[sensor]\nadc_bits = 12",
            &["x.toml:2: sensor", "did you mean `sensors`"],
        ),
        with_sidecar(
            "[sensors]\nadc_bit = 12",
            &["x.toml:2: sensors.adc_bit", "did you mean `adc_bits`"],
        ),
        with_sidecar(
            "[sensors]\nadc_bits = 12.5",
            &["x.toml:2: sensors.adc_bits", "whole number"],
        ),
        with_sidecar(
            "[sensors]\nadc_bits = 99",
            &["x.toml:2", "at least 4 and at most 32"],
        ),
        with_sidecar(
            "[sensors]\nvoltage_full_scale_volt = -600",
            &[
                "x.toml:2: sensors.voltage_full_scale_volt",
                "-600 is out of range",
            ],
        ),
        with_sidecar(
            "[sensors]\nnoise_sigma_fraction_of_full_scale = nan",
            &["x.toml:2", "not a finite number"],
        ),
        with_sidecar(
            "[sensors]\nencoder_edges_per_pulse = 3",
            &[
                "x.toml:2: sensors.encoder_edges_per_pulse",
                "write 1, 2 or 4",
            ],
        ),
        with_sidecar(
            "[columns]\nspead = \"n\"",
            &["x.toml:2: columns.spead", "did you mean `speed`"],
        ),
        with_sidecar(
            "[columns]\nia = \"i1\"",
            &["x.csv:1: i1", "does not have", "t ia ib ic"],
        ),
        with_sidecar(
            "[columns]\nia = { name = \"ia\", unit = \"rpm\" }",
            &[
                "x.toml:2: columns.ia.unit",
                "\"rpm\" is not a unit of ia",
                "A, mA, kA",
            ],
        ),
        with_sidecar(
            "[columns]\nia = { scale = 0 }",
            &["x.toml:2: columns.ia.scale", "other than 0"],
        ),
        with_sidecar(
            "[columns]\nia = { scal = 2 }",
            &["x.toml:2: columns.ia.scal", "did you mean `scale`"],
        ),
        with_sidecar(
            "[columns]\nia = 3",
            &["x.toml:2: columns.ia", "is a number"],
        ),
        with_sidecar(
            "[columns]\nspeed = { unit = \"rpm\" }",
            &[
                "x.csv:1: speed",
                "which the file does not have",
                "--column speed=NAME",
            ],
        ),
        with_sidecar(
            "[columns]\nia = \"ic\"\nib = \"ic\"",
            &["x.csv:1: ic", "mapped to two channels"],
        ),
        with_sidecar(
            "[columns]\nspeed = { name = \"ib\", unit = \"counts\" }",
            &[
                "speed",
                "encoder is not declared",
                "encoder_pulses_per_revolution",
            ],
        ),
        with_sidecar("delimiter = \"x\"", &["x.toml:1: delimiter", "`tab`"]),
        with_sidecar(
            "sample_rate_hz = 0",
            &["x.toml:1: sample_rate_hz", "out of range"],
        ),
        with_sidecar(
            "skip_missing = \"yes\"",
            &["x.toml:1: skip_missing", "true or false"],
        ),
        with_sidecar(
            "[nameplate]\npole_pairs = 2",
            &["x.toml:1: nameplate", "this is a motor file", "rename"],
        ),
    ]
}

fn tables() -> Vec<Case> {
    vec![
        case(
            "power_watt,current_rms_amp\n",
            &["0 operating point", "at least 2"],
        ),
        case(
            "power_watt,current_rms_amp\n1,2\n",
            &["1 operating point", "at least 2"],
        ),
        case(
            "power_watt,speed_rpm\n1,2\n3,4\n",
            &[
                "x.csv:1: current_rms_amp",
                "missing",
                "add the line current",
            ],
        ),
        case(
            "current_rms_amp,efficiency\n1,0.5\n",
            &["how the motor was loaded", "torque_nm"],
        ),
        case(
            "power_watt,current_rms_amp,efficiency\n1,2,90.4\n3,4,91\n",
            &["x.csv:2: efficiency", "90.4 is above 1", "0.9 for 90 %"],
        ),
        case(
            "power_watt,current_rms_amp\n1,2\n-3,4\n",
            &["x.csv:3: power_watt", "-3", "loads are positive"],
        ),
        case(
            "power_watt,current_rms_amp\n1,2\n3,x\n",
            &["x.csv:3: current_rms_amp", "`x` is not a number"],
        ),
        case(
            "power_watt,current_rms_amp\n1,2\n3,\n",
            &["x.csv:3: current_rms_amp", "no number"],
        ),
        case(
            "power_watts,current_rms_amp\n1,2\n3,4\n",
            &["x.csv:1: power_watts", "did you mean `power_watt`"],
        ),
    ]
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
    let counted = Mapping {
        sample_rate_hz: Some(10.0),
        skip_missing: Some(true),
        ..Mapping::default()
    };
    assert_eq!(read(b"ia\n1\nnan\n3\n", &counted).t(), [0.0, 0.2]);
}
