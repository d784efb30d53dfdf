//! COMTRADE recordings of every kind and revision, and the damage that readers meet.

use super::{N, assert_notes, assert_signals, bytes, data, mapping, read};
use crate::common::Folder;
use recording::{Channel, Mapping, Recording};

/// The channels of `make.py` by our names.
pub fn names() -> Mapping {
    mapping(&["va=VA", "vb=VB", "vc=VC", "ia=IA", "ib=IB", "ic=IC"])
}

/// A `.cfg` of `make.py` after a replacement, and a `.dat`, in a folder.
pub fn pair(folder: &Folder, cfg: &str, data: &[u8]) -> std::path::PathBuf {
    folder.file("x.dat", data);
    folder.file("x.cfg", cfg.as_bytes())
}

pub fn text(name: &str) -> String {
    String::from_utf8(bytes(name)).unwrap()
}

fn changed(name: &str, from: &str, to: &str) -> String {
    let text = text(name);
    assert!(text.contains(from), "{from} is not in {name}");
    text.replace(from, to)
}

fn of_pair(cfg: &str, data: &[u8], flags: &Mapping) -> Recording {
    let folder = Folder::new("comtrade");
    read(&pair(&folder, cfg, data), flags).unwrap()
}

#[test]
fn every_kind_and_revision_is_read() {
    let files = [
        "ascii-1991.cfg",
        "ascii-1999.cfg",
        "binary-1999.cfg",
        "binary32-2013.cfg",
        "float32-2013.cfg",
        "ascii-2013.cff",
        "binary-2013.cff",
    ];
    for name in files {
        let recording = read(&data(name), &names()).unwrap();
        assert_eq!(recording.len(), N, "{name}");
        // Half a step: 20 mV, 0.5 mA; a float has 24 bits.
        assert_signals(&recording, 0.0101, 0.000_251);
        assert_notes(
            &recording,
            &[
                "va = VA in kV",
                "ic = IC in mA",
                "1 status channels are not used",
            ],
        );
    }
}

#[test]
fn the_data_file_may_be_named_and_the_extensions_may_be_upper_case() {
    let folder = Folder::new("comtrade-names");
    let dat = folder.file("X.DAT", &bytes("binary-1999.dat"));
    let cfg = folder.file("X.CFG", &bytes("binary-1999.cfg"));
    for path in [dat, cfg] {
        assert_eq!(read(&path, &names()).unwrap().len(), N);
    }
}

#[test]
fn padding_and_a_wrong_count_are_read_and_said() {
    let (cfg, dat) = (text("binary-1999.cfg"), bytes("binary-1999.dat"));
    let padded = [&dat[..], &[0x1A; 5]].concat();
    let recording = of_pair(&cfg, &padded, &names());
    assert_eq!(recording.len(), N);
    assert!(
        !recording
            .assumptions
            .iter()
            .any(|note| note.contains("behind the last"))
    );
    let block = [&dat[..], &[0x1A; 512]].concat();
    assert_eq!(of_pair(&cfg, &block, &names()).len(), N);
    let torn = &dat[..dat.len() - 9];
    let recording = of_pair(&cfg, torn, &names());
    assert_eq!(recording.len(), N - 1);
    let notes = [
        "declares 100 samples, the data hold 99",
        "13 bytes behind the last whole sample",
    ];
    assert_notes(&recording, &notes);
    let more = changed("binary-1999.cfg", "5000,100", "5000,40");
    let recording = of_pair(&more, &dat, &names());
    assert_eq!(recording.len(), N);
    assert_notes(&recording, &["declares 40 samples, the data hold 100"]);
    let text = [&bytes("ascii-1999.dat")[..], b"\x1A\x1A\r\n\r\n"].concat();
    assert_eq!(
        of_pair(&self::text("ascii-1999.cfg"), &text, &names()).len(),
        N
    );
}

#[test]
fn empty_fields_old_letters_and_float_ranges_are_read() {
    let dat = bytes("binary-1999.dat");
    let cfg = changed(
        "binary-1999.cfg",
        ",0,0,-32767,32767",
        ",,,-3.4028235E+38,3.4028235E+38",
    );
    assert_signals(&of_pair(&cfg, &dat, &names()), 0.0101, 0.000_251);
    let folder = Folder::new("latin");
    let latin = text("binary-1999.cfg").into_bytes();
    let latin: Vec<u8> = [b"Pr\xFCfstand", &latin[b"Pruefstand".len()..]].concat();
    folder.file("x.dat", &dat);
    assert_eq!(
        read(&folder.file("x.cfg", &latin), &names()).unwrap().len(),
        N
    );
}

#[test]
fn secondary_values_become_primary_ones() {
    let cfg = changed("binary-1999.cfg", "1,1,P", "100,5,S");
    let recording = of_pair(&cfg, &bytes("binary-1999.dat"), &names());
    let amplitude = recording.channel(Channel::CURRENTS[0]).unwrap()[0];
    assert!((amplitude - 20.0 * 7.0 * 0.6f64.cos()).abs() < 20.0 * 0.000_251);
    assert_notes(&recording, &["IA holds secondary values: times 20"]);
    let primary = changed("binary-1999.cfg", "1,1,P", "100,5,P");
    assert_signals(
        &of_pair(&primary, &bytes("binary-1999.dat"), &names()),
        0.0101,
        0.000_251,
    );
}

#[test]
fn missing_codes_are_gaps() {
    let holes = Mapping {
        skip_missing: Some(true),
        ..names()
    };
    let record = 8 + 6 * 2 + 2;
    let mut codes = bytes("binary-1999.dat");
    codes[7 * record + 8..][..2].copy_from_slice(&i16::MIN.to_le_bytes());
    let recording = of_pair(&text("binary-1999.cfg"), &codes, &holes);
    assert_eq!(recording.len(), N - 1);
    assert!((recording.t()[7] - 8.0 / 5000.0).abs() < 1e-12);
    let record = 8 + 6 * 4 + 2;
    for (name, code) in [
        ("binary32-2013", i32::MIN.to_le_bytes()),
        ("float32-2013", f32::MAX.to_le_bytes()),
        ("float32-2013", f32::NAN.to_le_bytes()),
    ] {
        let mut codes = bytes(&format!("{name}.dat"));
        codes[7 * record + 8..][..4].copy_from_slice(&code);
        let recording = of_pair(&text(&format!("{name}.cfg")), &codes, &holes);
        assert_eq!(recording.len(), N - 1, "{name}");
    }
    for hole in ["99999", ""] {
        let rows = text("ascii-1999.dat");
        let mut rows: Vec<String> = rows.lines().map(str::to_owned).collect();
        let cells: Vec<&str> = rows[7].split(',').collect();
        rows[7] = [&cells[..2], &[hole], &cells[3..]].concat().join(",");
        let recording = of_pair(
            &text("ascii-1999.cfg"),
            rows.join("\r\n").as_bytes(),
            &holes,
        );
        assert_eq!(recording.len(), N - 1, "{hole}");
    }
}

#[test]
fn names_that_stand_there_twice_or_not_at_all_get_a_number() {
    let twice = changed("binary-1999.cfg", ",VB,", ",VA,").replace(",VC,", ",,");
    let flags = mapping(&[
        "va=VA",
        "vb=VA_2",
        "vc=channel_3",
        "ia=IA",
        "ib=IB",
        "ic=IC",
    ]);
    let recording = of_pair(&twice, &bytes("binary-1999.dat"), &flags);
    assert_signals(&recording, 0.0101, 0.000_251);
}

#[test]
fn equal_rates_are_one_rate_and_stamps_count_without_a_rate() {
    let dat = bytes("binary-1999.dat");
    let two = changed(
        "binary-1999.cfg",
        "1\r\n5000,100",
        "2\r\n5000,50\r\n5000,100",
    );
    assert_signals(&of_pair(&two, &dat, &names()), 0.0101, 0.000_251);
    let slow = text("ascii-1999.cfg").trim_end().to_owned() + "0\r\n";
    let recording = of_pair(&slow, &bytes("ascii-1999.dat"), &names());
    // timemult 10: the stamps count tens of microseconds.
    assert!((recording.t()[1] - 2e-3).abs() < 1e-12);
}

#[test]
fn a_unit_flag_wins_over_the_file() {
    let mut flags = names();
    flags.set_unit("va=V").unwrap();
    let recording = read(&data("binary-1999.cfg"), &flags).unwrap();
    assert!((recording.channel(Channel::VOLTAGES[0]).unwrap()[0] - 0.325).abs() < 1e-4);
}

#[test]
fn where_rate_and_stamps_differ_the_user_says_which_it_is() {
    let folder = Folder::new("rate");
    folder.file("x.dat", &bytes("binary-1999.dat"));
    let wrong = changed("binary-1999.cfg", "5000,100", "10000,100");
    let path = folder.file("x.cfg", wrong.as_bytes());
    let mut flags = names();
    flags.set_sample_rate(5000.0).unwrap();
    let recording = read(&path, &flags).unwrap();
    assert_signals(&recording, 0.0101, 0.000_251);
    assert_notes(
        &recording,
        &[
            "column t is not used: the .cfg declares 10000 Hz",
            "1/5000 s",
        ],
    );
    // Rates are rounded, and stamps that never change say nothing.
    folder.file(
        "x.cfg",
        changed("binary-1999.cfg", "5000,100", "5004,100").as_bytes(),
    );
    assert_eq!(read(&path, &names()).unwrap().len(), N);
    let mut dat = bytes("binary-1999.dat");
    dat.chunks_exact_mut(22)
        .for_each(|record| record[4..8].fill(0));
    folder.file("x.dat", &dat);
    folder.file("x.cfg", wrong.as_bytes());
    assert_eq!(read(&path, &names()).unwrap().len(), N);
}

/// A record of more than 71 minutes: stamps of 32 bits, in steps of a microsecond, begin again.
#[test]
fn stamps_that_begin_again_go_on() {
    let folder = Folder::new("wrap");
    let mut dat = bytes("binary-1999.dat");
    for (k, record) in dat.chunks_exact_mut(22).enumerate() {
        let stamp = (u32::MAX - 9_950).wrapping_add(200 * k as u32);
        record[4..8].copy_from_slice(&stamp.to_le_bytes());
    }
    folder.file("x.dat", &dat);
    for cfg in [
        text("binary-1999.cfg"),
        changed("binary-1999.cfg", "5000,100", "0,100"),
    ] {
        let path = folder.file("x.cfg", cfg.as_bytes());
        assert_signals(&read(&path, &names()).unwrap(), 0.0101, 0.000_251);
    }
}
