//! Recordings that this project did not make, through the audit and the core.

use crate::common::{in_project, in_shared_data, monitored, motor, read};
use audit::Code;
use monitor::{Lamp, NotJudged};
use recording::Mapping;
use replay::{Timeline, Unjudged, VerdictState};

const PEER_SETS: [&str; 9] = [
    "inertia-plus-40-percent",
    "inverter-dead-time",
    "magnetizing-saturation",
    "none",
    "shaft-compliance",
    "stator-resistance-plus-25-percent",
    "supply-unbalance",
    "voltage-gain-phase-c",
    "windage",
];

fn peer(set: &str, recording: &str) -> Timeline {
    let folder = format!("tests/data/peer/{set}");
    let motor = motor(&format!("{folder}/motor.toml"));
    let file = in_project(&format!("{folder}/{recording}.csv.gz"));
    monitored(&read(&file, &Mapping::default()), &motor).1
}

#[test]
fn every_peer_recording_is_judged_in_its_steady_parts() {
    for set in PEER_SETS {
        let timeline = peer(set, "recording_b");
        assert!(
            timeline.judged > 10,
            "{set}: {} of {} windows",
            timeline.judged,
            timeline.windows
        );
        assert!(
            timeline.judged < timeline.windows,
            "{set}: the start is a transient"
        );
    }
}

#[test]
fn a_healthy_motor_of_another_simulator_lights_nothing() {
    for recording in ["recording", "recording_b"] {
        let timeline = peer("none", recording);
        assert_eq!(timeline.verdict(&[]).state, VerdictState::Healthy);
        let quiet = |lamp| lamp != Lamp::On;
        for lamps in &timeline.lamps {
            let residuals = [lamps.r1, lamps.r2, lamps.r3, lamps.r4];
            let others = [lamps.sensor, lamps.line, lamps.load, lamps.fault];
            assert!(residuals.into_iter().chain(others).all(quiet), "{lamps:?}");
        }
        let (mean, _) = timeline.residual_percent().expect("windows were judged");
        // Means over a hundred windows, each with a scatter of 0.12 % from the recorded noise.
        assert!(mean.iter().all(|r| r.abs() < 0.05), "{mean:?}");
    }
}

#[test]
fn a_changed_resistance_lights_the_fault_lamp_and_a_changed_inertia_does_not() {
    assert_eq!(
        peer("stator-resistance-plus-25-percent", "recording")
            .verdict(&[])
            .state,
        VerdictState::Fault
    );
    assert_eq!(
        peer("inertia-plus-40-percent", "recording")
            .verdict(&[])
            .state,
        VerdictState::Healthy
    );
}

/// Classes of the shorted-turn recordings and the published mean of negative over positive sequence.
const SHORTED_TURNS: [(&str, f64); 9] = [
    ("hlt", 0.029),
    ("a1_b0_c0", 0.060),
    ("a2_b0_c0", 0.132),
    ("a3_b0_c0", 0.162),
    ("a4_b0_c0", 0.192),
    ("a0_b1_c0", 0.056),
    ("a0_b2_c0", 0.102),
    ("a0_b3_c0", 0.160),
    ("a0_b4_c0", 0.181),
];

#[test]
fn three_currents_alone_give_the_published_negative_sequence_and_no_verdict() {
    let motor = motor("motors/assumed-300w.toml");
    for (class, published) in SHORTED_TURNS {
        let mut sum = 0.0;
        for repetition in 1..=5 {
            let name = format!("tests/data/itsc_075hp/sc_{class}_00{repetition}.csv.gz");
            let (audit, timeline) =
                monitored(&read(&in_project(&name), &Mapping::default()), &motor);
            assert!(audit.supported, "{name}");
            assert_eq!(
                timeline.judged, 0,
                "{name}: there is nothing to judge residuals from"
            );
            assert_eq!(
                timeline.verdict(&[]).state,
                VerdictState::NotJudged,
                "{name}"
            );
            let reason = timeline.not_judged[0].reason;
            assert_eq!(reason, Unjudged::ByCore(NotJudged::NoVoltages), "{name}");
            sum += timeline
                .sequence()
                .i2_over_i1
                .expect("currents are recorded");
        }
        let mean = sum / 5.0;
        println!("{class}: {mean:.4}, published {published}");
        assert!(
            (mean / published - 1.0).abs() < 0.1,
            "{class}: {mean:.4} for {published}"
        );
    }
}

#[test]
fn the_load_table_becomes_operating_points() {
    let file = in_project("tests/data/imc_18k5_load_test/load_test.csv");
    let table =
        formats::read_load_table(&file, &Mapping::default(), &mut |_| {}).expect("readable");
    let motor = motor("motors/imc-18k5.toml");
    let points =
        replay::operating_points::OperatingPoints::new(&table, Some(&motor)).operating_points;
    assert_eq!(points.len(), 14);
    let rated = points
        .iter()
        .find(|point| point.power_watt == Some(18_500.0))
        .expect("the rated point");
    // 18.5 kW at 1462 rpm; losses from its own efficiency of 0.9044, to the rounding of its columns.
    assert!(
        (rated.torque_nm.unwrap_or(0.0) - 18_500.0 / (1462.0 / 60.0 * std::f64::consts::TAU)).abs()
            < 1e-9
    );
    let losses = 18_500.0 / 0.9044 - 18_500.0;
    assert!(
        (rated.losses_watt.unwrap_or(0.0) / losses - 1.0).abs() < 0.05,
        "{rated:?}"
    );
}

fn chalmers_mapping(scale: &str, offset: Option<&str>) -> Mapping {
    let mut mapping = Mapping::default();
    mapping.set_column("speed=speed_raw").expect("valid");
    mapping.set_unit("speed=rpm").expect("valid");
    mapping.set_scale(scale).expect("valid");
    if let Some(offset) = offset {
        mapping.set_offset(offset).expect("valid");
    }
    mapping
}

#[test]
fn a_measured_direct_start_names_its_clipped_channels_and_is_judged_where_it_is_steady() {
    let Some(file) = in_shared_data("measured/chalmers_lab_4kw/direct_start.csv.gz") else {
        return;
    };
    let mapping = chalmers_mapping("speed=9.687", Some("speed=-2.11"));
    let recording = read(&file, &mapping);
    let assumed = recording.assumptions.join("\n");
    assert!(
        assumed.contains("9.687 x (speed_raw + 2.11) in rpm, user's assumption"),
        "{assumed}"
    );
    let (audit, timeline) = monitored(&recording, &motor("motors/chalmers-4kw.toml"));
    let clipped: Vec<_> = audit
        .findings
        .iter()
        .filter(|finding| finding.code == Code::Clipping)
        .collect();
    let channels: Vec<_> = clipped
        .iter()
        .map(|finding| finding.channel.as_str())
        .collect();
    assert_eq!(channels, ["ia", "ib", "ic"]);
    assert!(timeline.judged > 20, "{} windows", timeline.judged);
    let inrush = timeline.lamps.iter().filter(|lamps| lamps.t < 0.15);
    assert!(
        inrush.into_iter().all(|lamps| lamps.not_judged.is_some()),
        "the inrush is not judged"
    );
}

#[test]
fn a_measured_no_load_run_is_judged() {
    let Some(file) = in_shared_data("measured/chalmers_lab_4kw/no_load.csv.gz") else {
        return;
    };
    let recording = read(&file, &chalmers_mapping("speed=609.5", None));
    let (audit, timeline) = monitored(&recording, &motor("motors/chalmers-4kw.toml"));
    assert!(audit.supported);
    assert!(timeline.judged > timeline.windows / 2);
}
