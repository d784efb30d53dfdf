//! WAV files, written by `hound`.

use super::assert_refused;
use crate::common::{Folder, quiet};
use formats::read_any;
use hound::{SampleFormat, WavSpec, WavWriter};
use recording::{Channel, Mapping, Source};
use std::io::Cursor;

fn spec(bits_per_sample: u16, sample_format: SampleFormat) -> WavSpec {
    WavSpec {
        channels: 3,
        sample_rate: 8000,
        bits_per_sample,
        sample_format,
    }
}

fn currents(k: i32) -> [f64; 3] {
    let angle = f64::from(k) * std::f64::consts::TAU * 50.0 / 8000.0;
    [0.0, -2.1, 2.1].map(|shift| 0.5 * (angle + shift).cos())
}

fn written(bits: u16, format: SampleFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = WavWriter::new(&mut bytes, spec(bits, format)).unwrap();
    for x in (0..400).flat_map(currents) {
        match format {
            SampleFormat::Float => writer.write_sample(x as f32).unwrap(),
            SampleFormat::Int => writer
                .write_sample((x * 2f64.powi(i32::from(bits) - 1)).round() as i32)
                .unwrap(),
        }
    }
    writer.finalize().unwrap();
    bytes.into_inner()
}

#[test]
fn every_kind_of_sample_is_read_as_a_share_of_full_scale() {
    let folder = Folder::new("wav");
    let mut mapping = Mapping::default();
    mapping.set_columns("ia,ib,ic").unwrap();
    for (bits, format, half) in [
        (16, SampleFormat::Int, 0.5 / 32_768.0),
        (24, SampleFormat::Int, 0.5 / 8_388_608.0),
        (32, SampleFormat::Float, 1e-7),
    ] {
        let path = folder.file("x.wav", &written(bits, format));
        let Ok(Source::Recording(recording)) = read_any(&path, &mapping, &mut quiet()) else {
            panic!("{:?}", read_any(&path, &mapping, &mut quiet()));
        };
        assert!((recording.t_sample() - 1.25e-4).abs() < 1e-12);
        let ib = recording.channel(Channel::CURRENTS[1]).unwrap();
        let off = ib.iter().zip(0..).map(|(x, k)| (x - currents(k)[1]).abs());
        assert!(off.fold(0.0, f64::max) <= half * 1.001);
        assert!(
            recording
                .assumptions
                .iter()
                .any(|said| said.contains("full scale"))
        );
        assert!(
            recording
                .assumptions
                .iter()
                .any(|said| said.contains("8000 samples a second"))
        );
    }
}

#[test]
fn damaged_files_are_refused() {
    let whole = written(16, SampleFormat::Int);
    assert_refused(
        "x.wav",
        &whole[..whole.len() - 5],
        2,
        &["is no sound WAV file", "record or export"],
    );
    assert_refused("x.wav", &whole[..20], 2, &["is no sound WAV file"]);
    assert_refused("x.wav", b"t,ia\n0,1\n", 2, &["is no sound WAV file"]);
}

/// A head that promises four gigabytes of samples and has none.
#[test]
fn a_head_that_lies_takes_no_memory() {
    let mut lies = written(16, SampleFormat::Int);
    let at = lies.windows(4).position(|four| four == b"data").unwrap();
    lies[at + 4..at + 8].copy_from_slice(&0xFFFF_FF00_u32.to_le_bytes());
    assert_refused("x.wav", &lies[..at + 8], 3, &["holds more than"]);
}

/// Whatever single byte is wrong: an error or a recording, never a panic.
#[test]
fn no_wrong_byte_panics() {
    let whole = written(16, SampleFormat::Int);
    let folder = Folder::new("wav-bytes");
    for at in (0..100).chain((100..whole.len()).step_by(97)) {
        for bit in 0..8 {
            let mut wrong = whole.clone();
            wrong[at] ^= 1 << bit;
            let path = folder.file("x.wav", &wrong);
            let _ = read_any(&path, &Mapping::default(), &mut quiet());
        }
    }
}
