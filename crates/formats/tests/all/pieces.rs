//! A file in pieces holds what it holds as a whole.

use crate::common::{Folder, gzip, quiet};
use formats::{read_in_pieces, read_recording, write_recording};
use recording::{Error, Follows, Mapping, Recording, Source, StartsFrom};
use std::fmt::Write as _;
use std::path::Path;

/// Rows of the files, and of a piece.
const ROWS: usize = 40_000;
const PIECE: usize = 12_000;

/// What the counts of an encoder, delays, line voltages, spikes and a missing row ask of neighbouring rows.
fn table() -> String {
    let mut text = String::from("t,vab,vbc,ia,ib,counts\n");
    for k in 0..ROWS {
        let t = k as f64 * 1e-4;
        let wave = |phase: f64| (314.159 * t + phase).cos();
        // A counter of 16 bits turns over within the file; a spike stands beside the border of two pieces.
        let counts = (t * 25.0 * 4096.0).floor() % 65536.0;
        let spike = if k == PIECE - 1 { 1e5 } else { 0.0 };
        let ia = 5.0 * wave(0.3) + spike;
        let ib = match k {
            17_000 => "nan".to_owned(),
            _ => format!("{}", 5.0 * wave(-1.7)),
        };
        let _ = writeln!(
            text,
            "{t:.4},{},{},{ia},{ib},{counts}",
            500.0 * wave(0.5),
            500.0 * wave(-1.6)
        );
    }
    text
}

fn flags() -> Mapping {
    let mut flags = Mapping {
        skip_missing: Some(true),
        encoder_pulses_per_revolution: Some(1024),
        ..Mapping::default()
    };
    flags.set_column("speed=counts").unwrap();
    flags.set_unit("speed=counts").unwrap();
    flags.set_delay("ia=23us").unwrap();
    flags.set_delay("ib=-31us").unwrap();
    flags
}

fn pieces(path: &Path, flags: &Mapping) -> Vec<Recording> {
    let (mut pieces, mut ends) = (Vec::new(), 0);
    let table = read_in_pieces(path, flags, PIECE, &mut quiet(), &mut |piece, follows| {
        pieces.push(piece.clone());
        ends += u32::from(follows == Follows::Nothing);
        Ok::<(), Error>(())
    });
    assert!(matches!(table.unwrap(), Source::Recording(last) if Some(&last) == pieces.last()));
    assert_eq!(ends, 1, "the last piece alone says that nothing follows");
    pieces
}

/// Every channel and the clock, bit by bit.
fn assert_same(path: &Path, flags: &Mapping) -> Vec<Recording> {
    let whole = read_recording(path, flags, &mut quiet()).unwrap();
    let pieces = pieces(path, flags);
    assert!(pieces.len() > 2, "{} pieces", pieces.len());
    let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
    let joined =
        |of: &dyn Fn(&Recording) -> Vec<f64>| pieces.iter().flat_map(of).collect::<Vec<f64>>();
    assert_eq!(bits(whole.t()), bits(&joined(&|piece| piece.t().to_vec())));
    for (channel, x) in whole.channels() {
        let in_pieces = joined(&|piece| piece.channel(channel).unwrap().to_vec());
        let differs = (0..x.len()).find(|k| x[*k].to_bits() != in_pieces[*k].to_bits());
        assert_eq!(differs, None, "{channel}");
    }
    let bridged =
        |recording: &Recording| recording.bridged().map(|(_, it)| it.samples).sum::<usize>();
    assert_eq!(bridged(&whole), pieces.iter().map(bridged).sum::<usize>());
    assert_eq!(pieces.last().unwrap().assumptions, whole.assumptions);
    pieces
}

#[test]
fn text_in_pieces_is_the_text_as_a_whole() {
    let folder = Folder::new("pieces-text");
    let text = table();
    let plain = folder.file("x.csv", text.as_bytes());
    let packed = folder.file("y.csv.gz", &gzip(text.as_bytes()));
    let pieces = assert_same(&plain, &flags());
    let lengths: Vec<usize> = pieces.iter().map(Recording::len).collect();
    assert_eq!(lengths, [PIECE, PIECE, PIECE, ROWS - 1 - 3 * PIECE]);
    assert!(pieces[0].bridged().any(|(_, it)| it.samples == 1));
    assert_same(&packed, &flags());
}

/// A later piece, and what is cut out later, begins where the motor runs.
#[test]
fn what_begins_later_claims_no_standstill() {
    let folder = Folder::new("pieces-start");
    let path = folder.file("x.csv", table().as_bytes());
    folder.file("x.toml", b"starts_from = \"standstill\"\n");
    let starts = |recording: &Recording| recording.metadata.starts_from;
    let plain = Mapping {
        skip_missing: Some(true),
        ..Mapping::default()
    };
    for flags in [flags(), plain] {
        let pieces = pieces(&path, &flags);
        let told: Vec<StartsFrom> = pieces.iter().map(starts).collect();
        let mut expected = vec![StartsFrom::Unknown; pieces.len()];
        expected[0] = StartsFrom::Standstill;
        assert_eq!(told, expected);
        let cut = |from: usize| starts(&pieces[0].slice(from..from + 9).unwrap());
        assert_eq!(
            [cut(0), cut(1)],
            [StartsFrom::Standstill, StartsFrom::Unknown]
        );
    }
}

#[test]
fn parquet_in_pieces_is_the_file_as_a_whole() {
    let folder = Folder::new("pieces-parquet");
    let csv = folder.file("x.csv", table().as_bytes());
    let recording = read_recording(&csv, &flags(), &mut quiet()).unwrap();
    let path = folder.path("x.parquet");
    write_recording(&path, &recording).unwrap();
    assert_same(&path, &Mapping::default());
}

#[test]
fn what_is_little_longer_than_a_piece_is_one_and_an_error_ends_the_reading() {
    let folder = Folder::new("pieces-one");
    let text = table();
    let lines: Vec<&str> = text.lines().take(1 + PIECE + PIECE / 40).collect();
    let path = folder.file("x.csv", lines.join("\n").as_bytes());
    assert_eq!(pieces(&path, &flags()).len(), 1);
    let path = folder.file("y.csv", text.as_bytes());
    let mut taken = 0;
    let ended = read_in_pieces(&path, &flags(), PIECE, &mut quiet(), &mut |_, _| {
        taken += 1;
        match taken {
            2 => Err(Error::bad("y.csv", "enough", "")),
            _ => Ok(()),
        }
    });
    assert!(ended.unwrap_err().to_string().contains("enough"));
    assert_eq!(taken, 2);
}
