//! Reading files as instruments and other people's simulators write them.

use crate::common::{committed, peer, quiet, shared};
use formats::{read_any, read_load_table, read_recording};
use recording::{
    Channel, LoadTorque, Mapping, Source, StartsFrom, Supply, TableColumn, VoltageKind,
};

#[test]
fn the_peer_recordings_and_their_sidecars_are_read() {
    let Some(path) = shared("peer/none/recording.csv.gz") else {
        return;
    };
    let recording = read_recording(&path, &Mapping::default(), &mut quiet()).unwrap();
    assert_eq!(recording.len(), 60_000);
    assert!((recording.t_sample() - 1e-4).abs() < 1e-9);
    assert_eq!(recording.channels().count(), 8);
    assert_eq!(recording.metadata.voltage, VoltageKind::Instantaneous);
    assert_eq!(recording.metadata.supply, Supply::Grid);
    assert_eq!(recording.metadata.load_torque, LoadTorque::Measured);
    assert_eq!(recording.metadata.starts_from, StartsFrom::Standstill);
    assert_eq!(
        recording.metadata.sensors.full_scale(Channel::CURRENTS[0]),
        Some(60.0)
    );
    // The first data row of the file.
    assert_eq!(
        recording.voltages().unwrap().map(|v| v[0]),
        [313.184, -72.949, -242.285]
    );
    assert!(
        recording.assumptions.is_empty(),
        "{:?}",
        recording.assumptions
    );
}

#[test]
fn the_inverter_recording_says_that_its_voltages_are_held() {
    let Some(path) = shared("peer/inverter-dead-time/recording_b.csv.gz") else {
        return;
    };
    let recording = read_recording(&path, &Mapping::default(), &mut quiet()).unwrap();
    assert_eq!(recording.metadata.voltage, VoltageKind::Hold);
    assert_eq!(recording.metadata.supply, Supply::Inverter);
}

#[test]
fn the_tachometer_of_the_laboratory_motor_is_mapped_and_said_so() {
    let Some(path) = shared("measured/chalmers_lab_4kw/direct_start.csv.gz") else {
        return;
    };
    let mut flags = Mapping::default();
    flags.set_column("ic=ic2").unwrap();
    flags.set_column("speed=speed_raw").unwrap();
    flags.set_scale("speed=1.0144").unwrap();
    flags.set_offset("speed=-2.11").unwrap();
    let recording = read_recording(&path, &flags, &mut quiet()).unwrap();
    let says = |sentence: &str| recording.assumptions.iter().any(|note| note == sentence);
    assert!(says(
        "speed = 1.0144 x (speed_raw + 2.11) in rad/s, user's assumption"
    ));
    assert!(
        says("ic = ic2 in A, user's assumption"),
        "{:?}",
        recording.assumptions
    );
    assert!(says("column ic is not used"));
    assert!(says("column dc_field_amp is not used"));
    // Rest, and 152.9812 raw in the last row.
    let speed = recording.speed().unwrap();
    assert!(speed[0].abs() < 0.5);
    assert!((speed[speed.len() - 1] - 1.0144 * (152.9812 + 2.11)).abs() < 1e-9);
    assert_eq!(recording.channel(Channel::CURRENTS[2]).unwrap()[3], -0.1367);
}

#[test]
fn a_recording_of_currents_alone_is_a_recording() {
    let path = committed("itsc_075hp/sc_hlt_001.csv.gz");
    let recording = read_recording(&path, &Mapping::default(), &mut quiet()).unwrap();
    assert_eq!(recording.len(), 5000);
    assert!(recording.voltages().is_none() && recording.speed().is_none());
    assert_eq!(
        recording.currents().unwrap().map(|i| i[0]),
        [-2.1648, 6.6020, -6.7485]
    );
}

#[test]
fn the_load_table_of_the_18k5_motor_is_read() {
    let path = committed("imc_18k5_load_test/load_test.csv");
    let table = read_load_table(&path, &Mapping::default(), &mut quiet()).unwrap();
    assert_eq!(table.len(), 14);
    assert_eq!(table.column(TableColumn::Current).unwrap()[10], 32.85);
    assert_eq!(table.column(TableColumn::Torque), None);
    let rated = table.points()[10];
    assert!(
        (rated.torque_nm.unwrap() - 120.84).abs() < 0.01,
        "{rated:?}"
    );
}

#[test]
fn the_kind_of_a_file_is_told_by_its_columns() {
    let table = read_any(
        &committed("imc_18k5_load_test/load_test.csv"),
        &Mapping::default(),
        &mut quiet(),
    );
    assert!(matches!(table, Ok(Source::LoadTable(_))));
    let refused = read_recording(
        &committed("imc_18k5_load_test/load_test.csv"),
        &Mapping::default(),
        &mut quiet(),
    );
    assert_eq!(refused.unwrap_err().exit_code(), 3);
}

#[test]
fn progress_ends_at_the_size_of_the_file() {
    let path = committed("itsc_075hp/sc_hlt_001.csv.gz");
    let mut seen = Vec::new();
    read_recording(&path, &Mapping::default(), &mut |progress| {
        seen.push(progress)
    })
    .unwrap();
    let size = std::fs::metadata(&path).unwrap().len();
    let last = seen.last().unwrap();
    assert_eq!((last.bytes_read, last.bytes_total), (size, size));
    assert!(
        seen.windows(2)
            .all(|pair| pair[0].bytes_read <= pair[1].bytes_read)
    );
}

/// The committed copies hold converter codes; the originals, where present, are the same to half of
/// their last printed digit (three decimals of a volt, four of an ampere).
#[test]
fn the_committed_peer_recordings_are_the_originals() {
    let path = peer("none", "recording");
    let recording = read_recording(&path, &Mapping::default(), &mut quiet()).unwrap();
    assert_eq!(recording.len(), 60_000);
    assert!(
        recording
            .assumptions
            .iter()
            .all(|note| note.ends_with("as the sidecar declares"))
    );
    let Some(original) = shared("peer/none/recording.csv.gz") else {
        return;
    };
    let original = read_recording(&original, &Mapping::default(), &mut quiet()).unwrap();
    assert_eq!(recording.metadata, original.metadata);
    for (channel, values) in recording.channels() {
        let digit = if Channel::VOLTAGES.contains(&channel) {
            5e-4
        } else {
            5e-5
        };
        let pairs = values.iter().zip(original.channel(channel).unwrap());
        let worst = pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
        assert!(worst < 1.01 * digit, "{channel}: {worst}");
    }
}
