use super::*;
use crate::Load;
use motor::motor_file::Frame;

pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../sim-host/scenarios")
}

pub(crate) fn parse(text: &str) -> Scenario {
    let text = format!("motor = \"../../motors/assumed-300w.toml\"\n{text}");
    Scenario::parse(&text, "scenario.toml", &folder()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_shortest_scenario_is_the_rated_motor_from_rest() {
    let scenario = parse("duration_s = 0.3");
    assert_eq!(scenario.samples(), 3001);
    assert_eq!(scenario.start, Start::Standstill);
    assert_eq!(scenario.plant, PlantKind::Full);
    assert!((scenario.supply.amplitude_volt.at(0.1) - 179.629).abs() < 1e-3);
    assert_eq!(scenario.supply.frequency_hz.at(0.1), 60.0);
    assert_eq!(scenario.load, LoadSpec::default());
    assert_eq!(scenario.sensors, SensorSpec::of(&scenario.motor));
}

#[test]
fn every_shipped_scenario_is_valid() {
    let mut count = 0;
    for entry in std::fs::read_dir(folder()).expect("scenarios/") {
        let path = entry.expect("readable").path();
        Scenario::read(&path).unwrap_or_else(|error| panic!("{error}"));
        count += 1;
    }
    assert!(count >= 5);
}

#[test]
fn the_published_experiment_has_the_published_times() {
    let scenario = Scenario::read(folder().join("paper-experiment.toml")).expect("shipped");
    assert_eq!(scenario.record_from_s, 0.5);
    assert_eq!(scenario.data_interval_s, 0.02);
    let fault = &scenario.faults[0];
    assert_eq!(
        (fault.target, fault.change),
        (Target::Parameter(Parameter::Rs), Change::Factor(1.5))
    );
    assert_eq!(
        [1.9999, 2.0, 3.4999, 3.5].map(|t| fault.is_active(t)),
        [false, true, true, false]
    );
}

#[test]
fn all_kinds_of_faults_are_read() {
    let scenario = parse(
        r#"duration_s = 1
        faults = [
            { fault = "Iq", change_percent = -50, frame = "rotor-flux" },
            { fault = "vb", gain = 0.9, from_s = 0.2 },
            { fault = "ic", offset = -0.3 },
            { fault = "speed", dead = true },
            { fault = "Vq", change_percent = 50 },
        ]"#,
    );
    let read: Vec<_> = scenario
        .faults
        .iter()
        .map(|f| (f.target, f.change))
        .collect();
    let dq = Target::Dq;
    let probe = Target::Probe;
    assert_eq!(
        read,
        [
            (dq(DqSignal::Iq, Frame::RotorFlux), Change::Factor(0.5)),
            (probe(Probe::Voltage(1)), Change::Factor(0.9)),
            (probe(Probe::Current(2)), Change::Offset(-0.3)),
            (probe(Probe::Speed), Change::Factor(0.0)),
            (dq(DqSignal::Vq, Frame::Voltage), Change::Factor(1.5)),
        ]
    );
}

#[test]
fn loads_add_up() {
    let scenario = parse(
        "duration_s = 1\n[load]\nfriction_percent = 50\nconstant_percent = 10\nquadratic_nm_s2 = 1e-6\n",
    );
    assert_eq!(scenario.load.friction_factor, 0.5);
    // 10 % of 1.707 N m and 1e-6 (150 rad/s)^2.
    let torque = scenario.load.other.torque(0.0, 150.0);
    assert!((torque - (0.1707 + 0.0225)).abs() < 1e-12, "{torque}");
    assert!(matches!(scenario.load.other, Load::Sum(_)));
}

#[test]
fn ramps_join_and_keep_the_phase() {
    let mut hertz = Piecewise::constant(50.0);
    hertz.change(1.0, 40.0, 2.0);
    hertz.change(4.0, 60.0, 0.0);
    let expected = [
        (0.5, 50.0),
        (1.0, 50.0),
        (2.0, 45.0),
        (3.0, 40.0),
        (3.9, 40.0),
        (4.0, 60.0),
    ];
    for (t, value) in expected {
        assert!((hertz.at(t) - value).abs() < 1e-12, "{t}");
    }
    // 50 + (50 + 40)/2 * 2 + 40 turns up to 4 s; then 60 a second.
    assert!((hertz.integral(4.0) - 180.0).abs() < 1e-12);
    assert!((hertz.integral(4.5) - 210.0).abs() < 1e-12);
    assert_eq!(hertz.largest(), 60.0);
}

#[test]
fn a_fault_by_name_for_programs() {
    let fault = Fault::percent("Vq", -50.0, Frame::RotorFlux).expect("known");
    assert_eq!(fault.target, Target::Dq(DqSignal::Vq, Frame::RotorFlux));
    assert_eq!(fault.apply(10.0), 5.0);
    assert!(Fault::percent("Xx", 1.0, Frame::Voltage).is_none());
}

#[test]
fn a_signal_chain_is_read_in_si() {
    let scenario = parse(
        "duration_s = 1\n[sensors.chain]\nvoltage_filter_us = [78, 7]\nvoltage_delay_us = 1.6\ncurrent_filter_hz = [1000, 2000, 4000]\n\
         current_gain_error_percent = [0.5, 0, -0.5]\ncrosstalk_percent = 0.01\ninl_lsb = 2\ninl_shape = \"bits\"\nvoltage_reference = \"ratiometric\"",
    );
    let chain = scenario.sensors.chain.expect("a chain");
    let near = |x: f64, y: f64| assert!((x - y).abs() < 1e-12, "{x} {y}");
    let [va, _, _, ia, _, ic] = chain.channels;
    near(va.time_constants_s[0], 78e-6);
    near(va.time_constants_s[1], 7e-6);
    near(va.delay_s, 1.6e-6);
    near(
        ic.time_constants_s[0],
        1.0 / (std::f64::consts::TAU * 4000.0),
    );
    near(ia.gain_error, 0.005);
    near(ic.gain_error, -0.005);
    near(chain.crosstalk, 1e-4);
    assert_eq!((va.ratiometric, ia.ratiometric), (true, false));
    assert_eq!(
        chain.inl,
        Inl {
            lsb: 2.0,
            shape: InlShape::Bits
        }
    );
    assert_eq!(parse("duration_s = 1\n[sensors]").sensors.chain, None);
}
