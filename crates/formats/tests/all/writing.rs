//! What is written reads back to the same bits, and twice to the same bytes.

use crate::common::{Folder, quiet};
use formats::{read_recording, write_in_pieces, write_recording};
use proptest::prelude::*;
use recording::{
    Channel, Error, LoadTorque, Mapping, Metadata, Recording, Sensors, Signal, StartsFrom, Supply,
    VoltageKind,
};

fn metadata() -> Metadata {
    Metadata {
        voltage: VoltageKind::Hold,
        supply: Supply::Inverter,
        supply_belief: "ideal \"inverter\"\nwith a second line".to_owned(),
        load_torque: LoadTorque::Measured,
        starts_from: StartsFrom::Standstill,
        sensors: Sensors {
            voltage_full_scale_volt: Some(600.0),
            noise_sigma_fraction_of_full_scale: Some(0.002),
            adc_bits: Some(12),
            encoder_pulses_per_revolution: Some(1024),
            ..Sensors::default()
        },
    }
}

fn small(values: &[f64]) -> Recording {
    let t = (0..values.len()).map(|k| k as f64 / 3.0).collect();
    Recording::new("x.csv", t, metadata())
        .and_then(|r| r.with_channel(Channel::CURRENTS[0], values.to_vec()))
        .and_then(|r| r.with_channel(Channel::second(Signal::Ic), values.to_vec()))
        .and_then(|r| r.with_channel(Channel::TEMPERATURE, values.to_vec()))
        .unwrap()
}

fn assert_same(read: &Recording, written: &Recording) {
    assert_eq!(read.t(), written.t());
    assert!(read.channels().eq(written.channels()));
    assert_eq!(read.metadata, written.metadata);
}

#[test]
fn packed_and_plain_files_read_back() {
    let folder = Folder::new("packed_and_plain");
    let written = small(&[0.1, -2.5e-17, 1e300, 5.0]);
    for name in ["x.csv", "x.csv.gz"] {
        let path = folder.path(name);
        write_recording(&path, &written).unwrap();
        let read = read_recording(&path, &Mapping::default(), &mut quiet()).unwrap();
        assert_same(&read, &written);
    }
    // Two recordings and one sidecar that they share; no part files.
    assert_eq!(std::fs::read_dir(folder.path("")).unwrap().count(), 3);
}

#[test]
fn an_unknown_scale_stays_unknown() {
    let folder = Folder::new("unknown_scale");
    for (k, offset) in [None, Some(-2.11)].into_iter().enumerate() {
        let path = folder.path(&format!("{k}.csv"));
        let mut written = small(&[1.0, 2.0, 3.0])
            .with_channel(Channel::SPEED, vec![4.0, 5.0, 6.0])
            .unwrap();
        let unit = recording::UNITS[10];
        written.unknown_speed_scale = Some(Box::new(recording::UnknownScale { unit, offset }));
        write_recording(&path, &written).unwrap();
        let read = read_recording(&path, &Mapping::default(), &mut quiet()).unwrap();
        assert_same(&read, &written);
        // The written column is free of the offset.
        let offset = offset.map(|_| 0.0);
        let expected = recording::UnknownScale { unit, offset };
        assert_eq!(read.unknown_speed_scale.as_deref(), Some(&expected));
    }
}

#[test]
fn the_same_recording_gives_the_same_bytes() {
    let folder = Folder::new("same_bytes");
    let written = small(&[1.0, 2.0, 3.0]);
    let bytes = |name: &str| {
        let path = folder.path(name);
        write_recording(&path, &written).unwrap();
        std::fs::read(path).unwrap()
    };
    let (first, second) = (bytes("first.csv.gz"), bytes("second.csv.gz"));
    assert_eq!(first, second);
    // RFC 1952: bytes 4..8 are the time of modification.
    assert_eq!(first[4..8], [0; 4]);
}

#[test]
fn two_measured_currents_stay_two_measured_currents() {
    let folder = Folder::new("two_currents");
    let path = folder.file("x.csv", b"t,ia,ib\n0,1,2\n1,3,4\n");
    let first = read_recording(&path, &Mapping::default(), &mut quiet()).unwrap();
    assert_eq!(first.channel(Channel::CURRENTS[2]), Some(&[-3.0, -7.0][..]));
    let again = folder.path("y.csv");
    write_recording(&again, &first).unwrap();
    assert!(
        std::fs::read_to_string(&again)
            .unwrap()
            .starts_with("t,ia,ib\n")
    );
    let second = read_recording(&again, &Mapping::default(), &mut quiet()).unwrap();
    assert!(second.is_derived(Channel::CURRENTS[2]));
    assert!(second.assumptions[0].contains("ic = -(ia + ib)"));
}

#[test]
fn a_folder_that_is_not_there_and_a_wrong_name_are_named() {
    let folder = Folder::new("not_there");
    let written = small(&[1.0, 2.0]);
    let absent = write_recording(&folder.path("no/x.csv"), &written).unwrap_err();
    assert!(absent.to_string().contains("check the folder"), "{absent}");
    let name = write_recording(&folder.path("x.txt"), &written).unwrap_err();
    assert!(name.to_string().contains(".csv.gz"), "{name}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn every_finite_number_reads_back_to_its_bits(
        values in prop::collection::vec(prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO, 2..40)
    ) {
        let folder = Folder::new("bits");
        let path = folder.path("x.csv.gz");
        let written = small(&values);
        write_recording(&path, &written).unwrap();
        let read = read_recording(&path, &Mapping::default(), &mut quiet()).unwrap();
        let bits = |r: &Recording| -> Vec<u64> {
            r.channel(Channel::CURRENTS[0]).unwrap().iter().map(|x| x.to_bits()).collect()
        };
        prop_assert_eq!(bits(&read), bits(&written));
    }
}

/// Text has the bytes of the whole; Parquet has a group of rows for each piece, and reads back to the same bits. A piece that fails
/// leaves no file.
#[test]
fn what_comes_in_pieces_is_the_whole() {
    let folder = Folder::new("writing-pieces");
    let csv = "t,va,ia\n0,1.5,2\n0.001,-0.25,3\n0.002,1e-9,4\n0.003,7,5\n0.004,8,6\n";
    let whole = read_recording(
        &folder.file("x.csv", csv.as_bytes()),
        &Mapping::default(),
        &mut |_| {},
    )
    .unwrap();
    let pieces = || [0..2, 2..5].map(|range| whole.slice(range));
    for extension in ["csv", "csv.gz"] {
        let [once, again] =
            ["once", "again"].map(|name| folder.path(&format!("{name}.{extension}")));
        write_recording(&once, &whole).unwrap();
        write_in_pieces(&again, &mut pieces().into_iter()).unwrap();
        assert_eq!(
            std::fs::read(&once).unwrap(),
            std::fs::read(&again).unwrap(),
            "{extension}"
        );
    }
    let path = folder.path("y.parquet");
    write_in_pieces(&path, &mut pieces().into_iter()).unwrap();
    let back = read_recording(&path, &Mapping::default(), &mut |_| {}).unwrap();
    assert_eq!(back.t(), whole.t());
    assert!(back.channels().eq(whole.channels()));
    let path = folder.path("z.parquet");
    let failing = [whole.slice(0..2), Err(Error::bad("z", "enough", ""))];
    let failed = write_in_pieces(&path, &mut failing.into_iter());
    assert!(failed.unwrap_err().to_string().contains("enough"));
    assert!(!path.exists());
}
