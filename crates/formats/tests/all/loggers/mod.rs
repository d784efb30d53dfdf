//! Files as thirty recorders write them: each is read with at most one flag, gives the samples back within the digits that it
//! prints, and says what was assumed.
//!
//! The files are made here, from one simulated run; each device names where its layout is described. "By memory" says that no
//! description was at hand and that the layout was not compared with a file of the device.

mod instruments;
mod plants;
mod programs;
mod scopes;
mod text;
mod wave;

use crate::common::{Folder, quiet};
use formats::read_any;
use recording::{Channel, Mapping, Recording, Source, sidecar_path};
use wave::{Instant, wave};

/// A recorder and the file that it writes.
struct Device {
    name: &'static str,
    /// Where its layout is described.
    source: &'static str,
    file: &'static str,
    /// Time between two samples, s.
    step_s: f64,
    /// The one flag that it takes, if any.
    flag: Option<&'static str>,
    write: fn(&[Instant]) -> Vec<u8>,
    /// Channels that must be read, with half a digit of what is printed.
    channels: &'static [(Signal, f64)],
    /// Half a digit of the clock, s.
    clock_s: f64,
    /// Parts of sentences that must be among the assumptions.
    said: &'static [&'static str],
}

/// Three channels or one.
#[derive(Clone, Copy, Debug)]
enum Signal {
    Voltages,
    Currents,
    Speed,
    Torque,
}

const COUNT: u32 = 400;

fn devices() -> Vec<Device> {
    let all = [
        scopes::devices(),
        instruments::devices(),
        plants::devices(),
        programs::devices(),
    ];
    all.into_iter().flatten().collect()
}

fn mapping(flag: Option<&str>) -> Mapping {
    let mut mapping = Mapping::default();
    let Some(flag) = flag else { return mapping };
    let (name, value) = flag.split_once(' ').expect("a flag and its value");
    let set = match name {
        "--columns" => mapping.set_columns(value),
        "--column" => mapping.set_column(value),
        "--sensor" => mapping.set_sensor(value),
        "--thousands" => mapping.set_thousands(value),
        "--date-order" => mapping.set_date_order(value),
        other => panic!("{other}"),
    };
    set.expect("a good flag");
    mapping
}

fn read(path: &std::path::Path, flags: &Mapping, name: &str) -> Recording {
    match read_any(path, flags, &mut quiet()) {
        Ok(Source::Recording(recording)) => recording,
        Ok(Source::LoadTable(_)) => panic!("{name} was taken for a load table"),
        Err(error) => panic!("{name}: {error}"),
    }
}

fn truth(signal: Signal, wave: &[Instant]) -> Vec<(Channel, Vec<f64>)> {
    let each = |value: fn(&Instant) -> f64| wave.iter().map(value).collect::<Vec<f64>>();
    let three =
        |channels: [Channel; 3], values: [Vec<f64>; 3]| channels.into_iter().zip(values).collect();
    match signal {
        Signal::Voltages => three(
            Channel::VOLTAGES,
            [each(|x| x.v[0]), each(|x| x.v[1]), each(|x| x.v[2])],
        ),
        Signal::Currents => three(
            Channel::CURRENTS,
            [each(|x| x.i[0]), each(|x| x.i[1]), each(|x| x.i[2])],
        ),
        Signal::Speed => vec![(Channel::SPEED, each(|x| x.speed))],
        Signal::Torque => vec![(Channel::TORQUE, each(|x| x.torque))],
    }
}

fn assert_same(device: &Device, recording: &Recording, wave: &[Instant]) {
    let name = device.name;
    assert_eq!(
        recording.len(),
        wave.len(),
        "{name}: {:?}",
        recording.assumptions
    );
    let since = |x: &Instant| x.t - wave[0].t;
    let late = recording
        .t()
        .iter()
        .zip(wave)
        .map(|(t, x)| (t - recording.t()[0] - since(x)).abs());
    let worst = late.fold(0.0, f64::max);
    assert!(
        worst <= 2.0 * device.clock_s + 1e-12,
        "{name}: the clock is off by {worst} s"
    );
    for (signal, half_digit) in device.channels {
        for (channel, truth) in truth(*signal, wave) {
            let read = recording
                .channel(channel)
                .unwrap_or_else(|| panic!("{name}: no {channel}"));
            let off = read.iter().zip(&truth).map(|(x, y)| (x - y).abs());
            let worst = off.fold(0.0, f64::max);
            assert!(
                worst <= half_digit * (1.0 + 1e-9) + 1e-12,
                "{name}: {channel} is off by {worst}"
            );
        }
    }
}

#[test]
fn there_are_thirty_devices_and_each_names_its_source() {
    let devices = devices();
    assert!(devices.len() >= 30, "{}", devices.len());
    assert!(devices.iter().all(|device| !device.source.is_empty()));
    let mut names: Vec<&str> = devices.iter().map(|device| device.name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), devices.len());
}

#[test]
fn every_file_is_read_with_at_most_one_flag_and_says_what_was_assumed() {
    let mut wrong = Vec::new();
    for device in devices() {
        let outcome = std::panic::catch_unwind(|| check(&device));
        if let Err(panic) = outcome {
            let message = panic.downcast_ref::<String>().cloned();
            wrong.push(message.unwrap_or_else(|| device.name.to_owned()));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} devices:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

fn check(device: &Device) {
    let wave = wave(device.step_s, COUNT);
    let folder = Folder::new("loggers");
    let path = folder.file(device.file, &(device.write)(&wave));
    let recording = read(&path, &mapping(device.flag), device.name);
    assert_same(device, &recording, &wave);
    for part in device.said {
        let said = &recording.assumptions;
        assert!(
            said.iter().any(|one| one.contains(part)),
            "{}: `{part}` is not in {said:#?}",
            device.name
        );
    }
    // Once written down, nothing needs a flag.
    let text = formats::reading_text(&recording);
    std::fs::write(sidecar_path(&path), &text).expect("written");
    let again = read(
        &path,
        &Mapping::default(),
        &format!("{} with\n{text}", device.name),
    );
    assert_same(device, &again, &wave);
}
