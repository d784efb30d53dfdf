//! Parquet files of pyarrow, our own, and damaged ones.

use super::{N, assert_notes, assert_refused, assert_signals, bytes, data, mapping, read};
use crate::common::Folder;
use formats::{read_any, write_recording};
use recording::{Channel, Mapping, Recording, Source};

#[test]
fn every_compression_but_brotli_is_read() {
    for codec in ["gzip", "lz4"] {
        let path = data(&format!("pyarrow-{codec}.parquet"));
        let recording = read(&path, &Mapping::default()).unwrap();
        assert_eq!(recording.len(), 20);
        // The doubles are stored as they are; make.py and this test round cosines apart.
        assert_signals(&recording, 1e-10, 1e-11);
    }
    let name = "pyarrow-brotli.parquet";
    let words = ["compressed in a way that is not read", "snappy, zstd, gzip"];
    assert_refused(name, &bytes(name), 3, &words);
}

#[test]
fn a_missing_sample_is_a_gap_on_request_only() {
    let name = "pyarrow-snappy.parquet";
    let words = [
        &format!("{name}:8: ic")[..],
        "holds no number",
        "--skip-missing",
    ];
    assert_refused(name, &bytes(name), 2, &words);
    let flags = Mapping {
        skip_missing: Some(true),
        ..Mapping::default()
    };
    let recording = read(&data(name), &flags).unwrap();
    assert_eq!(recording.len(), N - 1);
    assert_eq!(recording.speed().unwrap()[60], 150.0);
    assert_notes(
        &recording,
        &["column note is not used: it holds text", "1 rows"],
    );
}

#[test]
fn instants_decimals_and_unsigned_integers_are_numbers() {
    let mut flags = Mapping::default();
    flags.set_unit("speed=rpm").unwrap();
    let recording = read(&data("pyarrow-zstd.parquet"), &flags).unwrap();
    assert_signals(&recording, 1e-10, 1e-11);
    assert_eq!(recording.torque().unwrap()[N - 1], 14.625);
    assert!((recording.speed().unwrap()[0] - 50.0 * std::f64::consts::PI).abs() < 1e-9);
}

#[test]
fn what_is_written_reads_back_to_its_bits_and_twice_to_the_same_bytes() {
    let folder = Folder::new("parquet");
    let values = vec![0.1, -2.5e-17, 1e300, f64::MIN_POSITIVE / 3.0, -0.0];
    let t = (0..values.len()).map(|k| k as f64 / 3.0).collect();
    let written = Recording::new("x", t, recording::Metadata::default())
        .and_then(|r| r.with_channel(Channel::CURRENTS[0], values.clone()))
        .and_then(|r| r.with_channel(Channel::SPEED, values.clone()))
        .unwrap();
    let bytes = ["x.parquet", "y.parquet"].map(|name| {
        write_recording(&folder.path(name), &written).unwrap();
        std::fs::read(folder.path(name)).unwrap()
    });
    assert_eq!(bytes[0], bytes[1]);
    let again = read(&folder.path("x.parquet"), &Mapping::default()).unwrap();
    assert_eq!(again.t(), written.t());
    let bits = |r: &Recording| {
        r.speed()
            .unwrap()
            .iter()
            .map(|x| x.to_bits())
            .collect::<Vec<_>>()
    };
    assert_eq!(bits(&again), bits(&written));
    assert_eq!(again.channels().count(), 2);
}

#[test]
fn damaged_files_are_refused() {
    let whole = bytes("pyarrow-gzip.parquet");
    let damaged = [
        "x.parquet: is no Parquet file, or a truncated or damaged one",
        "again",
    ];
    assert_refused("x.parquet", &whole[..whole.len() / 2], 2, &damaged);
    assert_refused("x.parquet", &whole[..10], 2, &damaged);
    assert_refused("x.parquet", b"PAR1", 2, &damaged);
    assert_refused("x.parquet", b"t,ia\n0,1\n1,2\n", 2, &damaged);
    let mut zeroed = whole.clone();
    zeroed[60..160].fill(0);
    assert_refused("x.parquet", &zeroed, 2, &damaged);
}

/// The library believes them: half a minute, and gigabytes of memory.
#[test]
fn what_a_page_declares_is_checked_before_it_is_believed() {
    let findings = [
        ("a-list-longer-than-the-file", "unexpected end of file"),
        ("a-dictionary-larger-than-its-page", "and can hold 20"),
    ];
    for (finding, why) in findings {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/findings/parquet");
        let damaged = std::fs::read(format!("{folder}/{finding}")).unwrap();
        assert_refused("x.parquet", &damaged, 2, &["truncated or damaged", why]);
    }
}

/// The library panics on the first, and on what `fuzz/findings/parquet` holds.
#[test]
fn lengths_that_lie_are_a_damaged_file() {
    let whole = bytes("pyarrow-gzip.parquet");
    let words = [
        "x.parquet: is no Parquet file, or a truncated or damaged one",
        "copy or export",
    ];
    let finding = data("../../../../fuzz/findings/parquet/byte-stream-split");
    assert_refused("x.parquet", &std::fs::read(finding).unwrap(), 2, &words);
    // The footer stays, 40 bytes of the data go: the last column stands beyond the file.
    let shorter = [&whole[..100], &whole[140..]].concat();
    assert_refused("x.parquet", &shorter, 2, &words);
}

/// Whatever single byte is wrong: an error or a recording, never a panic.
#[test]
fn no_wrong_byte_panics() {
    let folder = Folder::new("parquet-bytes");
    let whole = bytes("pyarrow-gzip.parquet");
    for at in (0..whole.len()).step_by(7) {
        let mut wrong = whole.clone();
        wrong[at] ^= 1 << (at % 8);
        let path = folder.file("x.parquet", &wrong);
        let _ = read_any(&path, &Mapping::default(), &mut crate::common::quiet());
    }
}

#[test]
fn clocks_of_every_kind_are_read_in_their_units() {
    for clock in ["int96", "time64", "duration"] {
        let recording = read(
            &data(&format!("pyarrow-{clock}.parquet")),
            &Mapping::default(),
        );
        let recording = recording.unwrap_or_else(|error| panic!("{clock}: {error}"));
        assert_eq!(recording.len(), 20);
        assert_signals(&recording, 1e-10, 1e-11);
    }
}

#[test]
fn a_phase_that_cannot_be_read_is_no_absent_one() {
    for (kind, what) in [
        ("decimal", "decimals in bytes"),
        ("text", "text"),
        ("bool", "truth values"),
        ("list", "lists"),
    ] {
        let name = format!("pyarrow-{kind}.parquet");
        let why = format!("ic: cannot be read: it holds {what}");
        let words = [&name[..], &why, "--column"];
        assert_refused(&name, &bytes(&name), 2, &words);
        // Not asked for, it is named and left out.
        let flags = mapping(&["ic=ia", "ia=speed"]);
        let recording = read(&data(&name), &flags).unwrap();
        let note = format!("column ic is not used: it holds {what}");
        assert_notes(&recording, &[&note]);
    }
}

/// The channels of a recording with their bits, the clock first.
fn bits(recording: &Recording) -> Vec<(String, Vec<u64>)> {
    let clock = ("t".to_owned(), recording.t());
    let channels = recording
        .channels()
        .map(|(channel, x)| (channel.to_string(), x));
    let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect();
    std::iter::once(clock)
        .chain(channels)
        .map(|(name, x)| (name, bits(x)))
        .collect()
}

/// Bytes of a file that change what is read from it, unnoticed, when one bit of them is wrong.
fn unnoticed(whole: &[u8]) -> Vec<usize> {
    let folder = Folder::new("parquet-flips");
    let read = |bytes: &[u8]| {
        let path = folder.file("x.parquet", bytes);
        let read = read_any(&path, &Mapping::default(), &mut crate::common::quiet());
        read.ok().map(|source| match source {
            Source::Recording(recording) => bits(&recording),
            Source::LoadTable(table) => panic!("{table:?}"),
        })
    };
    let right = read(whole).expect("it is whole");
    let changes = |at: &usize| {
        let mut wrong = whole.to_vec();
        wrong[*at] ^= 1 << (at % 8);
        read(&wrong).is_some_and(|other| other != right)
    };
    (0..whole.len()).filter(changes).collect()
}

/// Of the 3.2 kB of pyarrow's file the pages, which carry checksums, take the first 1.6; the rest is the footer.
#[test]
fn the_checksums_of_pages_are_verified() {
    let whole = bytes("pyarrow-checked.parquet");
    let pages = whole.len() - 8 - footer_length(&whole);
    let found = unnoticed(&whole);
    assert!(found.iter().all(|at| *at >= pages), "{found:?} of {pages}");
}

/// The length that stands before the last mark.
fn footer_length(whole: &[u8]) -> usize {
    let at = whole.len() - 8;
    u32::from_le_bytes(whole[at..at + 4].try_into().unwrap()) as usize
}

#[test]
fn a_wrong_byte_in_a_file_of_ours_is_noticed_wherever_it_is() {
    let folder = Folder::new("parquet-own");
    let source = read(&data("pyarrow-gzip.parquet"), &Mapping::default()).unwrap();
    let path = folder.path("own.parquet");
    write_recording(&path, &source).unwrap();
    let found = unnoticed(&std::fs::read(&path).unwrap());
    assert!(found.is_empty(), "{found:?}");
}
