use super::*;
use crate::InMotion;

pub(super) const SMALLEST: &str = include_str!("smallest.toml");

const FULL: &str = r#"
speed_rpm = 1440
"#;

/// Every number another one, so that none can take another's place unseen.
const HEALTHY: &str = r#"
[healthy]
mean_percent = [0.0, 0.0, 0.0, -0.1, 0.2, 0.3, -0.4, 0.5, 0.6]
scatter_percent = [1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9]
current_unbalance_percent = [2.1, -2.2]
current_unbalance_scatter_percent = 2.3
current_unbalance_at_percent = 71.0
supply_unbalance_percent = 0.7
negative_drop_percent = [0.4, -0.6]
turns_angle_deg = 65.0
stator_resistance_percent = 3.1
rotor_resistance_percent = 3.2
heating_percent = 3.3
magnetizing_inductance_percent = 3.4
leakage_percent = 3.5
friction_percent = 3.6
current_gain_percent = 3.7
voltage_gain_percent = 3.8
speed_percent = 3.9
iron_loss_percent = 4.0
negative_impedance_percent = 4.1
calibrated_current_percent = 102.0
calibrated_volt_per_hertz_percent = [91.0, 96.0]
calibrated_active_percent = -37.0
calibrated_frequency_percent = [80.0, 100.0]
significance = 6.5
rotor_active_percent = [90.0, 40.0]
rotor_sideband_percent = [0.5, 0.3]
rotor_sideband_scatter_percent = 0.04
in_motion = "differs"
"#;

fn smallest() -> MotorFile {
    MotorFile::parse(SMALLEST, "motor.toml").expect("valid")
}

/// The same motor with every optional key, effects with numbers and with formulas.
fn largest_text() -> String {
    let text = SMALLEST
        .replace(
            "connection = \"star\"\n",
            &format!("connection = \"delta\"{FULL}"),
        )
        .replace("inertia", "temperature_degc = 75.0\ninertia");
    format!(
        r#"{text}
[load]
kind = "free"
[sensors]
voltage_full_scale_volt = 600.0
current_full_scale_amp = 60
speed_full_scale_rad_s = 200.0
torque_full_scale_nm = 40.0
noise_sigma_fraction_of_full_scale = 0.002
adc_bits = 14
encoder_pulses_per_revolution = 2048
voltage_offset_volt = [-1.0, 0.5, 1e-3]
current_offset_amp = [0.1, 0.0, -0.1]
voltage_gain = [1.0, 1.01, 0.99]
current_gain = [1.0, -1.0, 1.0]
voltage_delay_us = [88.94, 90.13, 89.0]
current_delay_us = [-50, 0, 85.73]
roll_off_us = 78.5
current_reference = "ratiometric"
[monitor]
frame = "voltage"
field_current = "nominal"
nominal_field_current_amp = 3.25
threshold_percent = [1, 2, 3, 4]
window_cycles = 10
persistence_windows = 4
hysteresis = 0.7
{HEALTHY}
[[effects]]
name = "core-loss"
core_loss_resistance_ohm = 980.0
[[effects]]
name = "expression"
formula = "k * i_d"
adds_to = "voltage_d"
k = -1.5e-7
"#
    )
}

fn without_lines(mut motor: MotorFile) -> MotorFile {
    for effect in &mut motor.effects {
        effect.line = 0;
        effect.parameters.iter_mut().for_each(|p| p.line = 0);
    }
    motor
}

#[test]
fn the_smallest_file_gets_the_documented_defaults() {
    let motor = smallest();
    assert_eq!(motor.mechanics.n_p, 2.0);
    assert_eq!(motor.load, LoadKind::Friction);
    assert_eq!(motor.monitor, MonitorSettings::default());
    assert_eq!(motor.monitor.threshold_percent, [0.6, 5.0, 4.0, 0.3]);
    assert_eq!(motor.sensors.adc_bits, 12);
    assert_eq!(motor.sensors.encoder_pulses_per_revolution, 1024);
    // 2 * 400 V * sqrt(2/3), and 10 * 5 A * sqrt(2).
    assert!((motor.sensors.voltage_full_scale_volt - 653.197_264_742_181).abs() < 1e-9);
    assert!((motor.sensors.current_full_scale_amp - 70.710_678_118_654_76).abs() < 1e-9);
    // 12 bits over +-70.71 A.
    assert!((motor.sensors.amp_per_code() - 70.710_678_118_654_76 / 2048.0).abs() < 1e-12);
    assert!(motor.effects.is_empty());
}

#[test]
fn every_optional_key_is_read() {
    let motor = MotorFile::parse(&largest_text(), "motor.toml").expect("valid");
    assert_eq!(motor.nameplate.connection, Connection::Delta);
    assert_eq!(motor.nameplate.speed_rpm, Some(1440.0));
    assert!((motor.nameplate.rated_slip() - 0.04).abs() < 1e-12);
    assert_eq!(motor.parameter_temperature_degc, Some(75.0));
    assert_eq!(motor.load, LoadKind::Free);
    assert_eq!(motor.sensors.current_full_scale_amp, 60.0);
    assert_eq!(motor.sensors.current_gain, [1.0, -1.0, 1.0]);
    assert!((motor.sensors.voltage_delay_s[1] - 90.13e-6).abs() < 1e-18);
    assert!((motor.sensors.current_delay_s[0] + 50e-6).abs() < 1e-18);
    assert!((motor.sensors.roll_off_s - 78.5e-6).abs() < 1e-18);
    assert_eq!(motor.sensors.ratiometric, [false, true]);
    assert_eq!(motor.sensors.conversions, 1, "no key of the file");
    assert_eq!(motor.monitor.frame, Frame::Voltage);
    assert_eq!(motor.monitor.field_current, FieldCurrent::Nominal);
    assert_eq!(motor.monitor.nominal_field_current_amp, Some(3.25));
    assert_eq!(
        motor.effects[0].number("core_loss_resistance_ohm"),
        Some(980.0)
    );
    assert_eq!(motor.effects[1].text("formula"), Some("k * i_d"));
    assert_eq!(motor.effects[1].number("k"), Some(-1.5e-7));
}

#[test]
fn what_is_written_reads_back_the_same() {
    for text in [SMALLEST.to_owned(), largest_text()] {
        let motor = without_lines(MotorFile::parse(&text, "motor.toml").expect("valid"));
        let again = MotorFile::parse(&motor.to_toml(), "written").expect("readable");
        assert_eq!(without_lines(again), motor);
    }
}

#[test]
fn a_healthy_section_is_read_key_by_key() {
    let motor = MotorFile::parse(&largest_text(), "motor.toml").expect("valid");
    let expected = HealthySettings {
        mean_percent: [0.0, 0.0, 0.0, -0.1, 0.2, 0.3, -0.4, 0.5, 0.6],
        scatter_percent: [1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9],
        current_unbalance_percent: [2.1, -2.2],
        current_unbalance_scatter_percent: 2.3,
        current_unbalance_at_percent: 71.0,
        supply_unbalance_percent: 0.7,
        negative_drop_percent: [0.4, -0.6],
        turns_angle_deg: 65.0,
        stator_resistance_percent: 3.1,
        rotor_resistance_percent: 3.2,
        heating_percent: 3.3,
        magnetizing_inductance_percent: 3.4,
        leakage_percent: 3.5,
        friction_percent: 3.6,
        current_gain_percent: 3.7,
        voltage_gain_percent: 3.8,
        speed_percent: 3.9,
        iron_loss_percent: 4.0,
        negative_impedance_percent: 4.1,
        range: Some(CalibratedRange {
            current_percent: 102.0,
            volt_per_hertz_percent: [91.0, 96.0],
            frequency_percent: [80.0, 100.0],
            active_percent: -37.0,
        }),
        significance: 6.5,
        rotor: Some(HealthyRotor {
            active_percent: [40.0, 90.0],
            sideband_percent: [0.3, 0.5],
            scatter_percent: 0.04,
        }),
        in_motion: InMotion::Differs,
    };
    assert_eq!(motor.healthy, Some(expected));
    assert_eq!(
        smallest().healthy,
        None,
        "without the section nothing is calibrated"
    );
}

#[test]
fn a_short_healthy_section_gets_the_documented_defaults() {
    let text = format!("{SMALLEST}[healthy]\n");
    let motor = MotorFile::parse(&text, "motor.toml").expect("valid");
    assert_eq!(motor.healthy, Some(HealthySettings::default()));
}

#[test]
fn a_healthy_section_out_of_range_is_refused_with_its_line() {
    for (key, bad) in [
        ("significance", "0.5"),
        ("heating_percent", "-1.0"),
        ("scatter_percent", "[1.0, 2.0]"),
        ("mean_percent", "[0, 0, 0, 0, 0, 0, 0, 0, 1001]"),
        ("stator_percent", "1.0"),
        ("calibrated_current_percent", "100.0"),
        ("calibrated_frequency_percent", "[100.0, 100.0]"),
    ] {
        let text = format!("{SMALLEST}[healthy]\n{key} = {bad}\n");
        let error = MotorFile::parse(&text, "motor.toml").expect_err(key);
        let line = error.problems().first().map(|problem| problem.line);
        assert_eq!(line, Some(text.lines().count()), "{error}");
        assert!(error.to_string().contains(key), "{error}");
    }
}

#[test]
fn nameplate_quantities_follow_from_the_plate() {
    let plate = smallest().nameplate;
    assert!((plate.phase_voltage_amplitude() - 326.598_632_371_090_5).abs() < 1e-9);
    assert!((plate.current_amplitude() - 7.071_067_811_865_475).abs() < 1e-12);
    assert!((plate.omega_sync() - 314.159_265_358_979_3).abs() < 1e-12);
    assert!((plate.synchronous_speed_mech() - 157.079_632_679_489_66).abs() < 1e-12);
    // 2200 W / 14.6 N m.
    assert!((plate.rated_speed_mech() - 150.684_931_506_849_3).abs() < 1e-9);
}

#[test]
fn a_plate_is_told_to_be_one() {
    let plate = "name = \"Pump 3\"\npower_kw = 2.2\nvoltage_volt = 400\n";
    let error = MotorFile::parse(plate, "pump.toml").expect_err("no motor file");
    let problems = error.problems();
    assert_eq!(problems.len(), 1, "{error}");
    assert!(error.to_string().contains("--plate"), "{error}");
}

#[test]
fn all_problems_of_a_file_are_reported_together() {
    let text = SMALLEST
        .replace("pole_pairs = 2", "pole_pairs = 0")
        .replace("= 0.015", "= -1.0")
        .replace("name = ", "label = ");
    let error = MotorFile::parse(&text, "motor.toml").expect_err("three problems");
    let lines: Vec<_> = error
        .problems()
        .iter()
        .map(|problem| problem.line)
        .collect();
    assert_eq!(lines, [1, 1, 3, 16], "{error}");
}

/// The motor files of `data/peer`, when they are beside the project.
#[test]
fn the_peers_motor_files_are_valid() {
    let Some(folder) = shared_data().map(|data| data.join("peer")) else {
        eprintln!("skipped: set DRIVE_MONITOR_SHARED_DATA to the folder with `peer`");
        return;
    };
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("readable") {
        let path = entry.expect("readable").path().join("motor.toml");
        MotorFile::read(&path).unwrap_or_else(|error| panic!("{error}"));
        count += 1;
    }
    assert!(count >= 9, "{count} motor files");
}

fn shared_data() -> Option<std::path::PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let path = std::env::var_os("DRIVE_MONITOR_SHARED_DATA").map_or_else(beside, Into::into);
    path.join("peer").is_dir().then_some(path)
}

const INTERVALS: &str = "
[[effects]]
name = \"windage\"
windage_nm_s2 = 1e-5

[uncertainty]
stator_resistance_ohm = [3.0, 4.5]
windage_nm_s2 = [1e-6, 1e-4]

[[uncertainty.correlation]]
first = \"stator_resistance_ohm\"
second = \"windage_nm_s2\"
value = -0.5
";

#[test]
fn intervals_survive_writing_and_reading() {
    let text = format!("{}{INTERVALS}", smallest().to_toml());
    let motor = MotorFile::parse(&text, "m.toml").unwrap();
    let again = MotorFile::parse(&motor.to_toml(), "m.toml").unwrap();
    assert_eq!(without_lines(motor.clone()), without_lines(again));
    let deviation = motor
        .uncertainty
        .unwrap()
        .log_deviation("stator_resistance_ohm");
    // ln(1.5) is 3.92 standard deviations wide.
    assert!((deviation.unwrap() - 1.5f64.ln() / 3.919_928).abs() < 1e-6);
}

#[test]
fn a_value_outside_its_interval_brings_its_own() {
    let text = format!("{}{INTERVALS}", smallest().to_toml());
    let mut known = MotorFile::parse(&text, "m.toml")
        .unwrap()
        .uncertainty
        .unwrap();
    let believed = known.clone();
    known.replace_outside("stator_resistance_ohm", 3.3, 0.01);
    known.replace_outside("no_such_key", 3.3, 0.01);
    assert_eq!(known, believed);
    known.replace_outside("stator_resistance_ohm", 2.0, 0.05);
    let own = known.of("stator_resistance_ohm").unwrap();
    // 1.96 standard deviations of the logarithm to either side.
    assert!((own.log_deviation() - 0.05).abs() < 1e-12);
    assert!((own.low * own.high - 4.0).abs() < 1e-12);
    let keys = ["stator_resistance_ohm", "windage_nm_s2"];
    assert_eq!(known.correlation(keys), 0.0);
}

#[test]
fn wrong_intervals_are_named() {
    let wrong = [
        ("[3.0, 4.5]", "[4.5, 3.0]", "upside down"),
        ("[3.0, 4.5]", "[-3.0, 4.5]", "stator_resistance_ohm"),
        (
            "\nstator_resistance_ohm = [3",
            "\nstator_resistence = [3",
            "no parameter of this motor",
        ),
        (
            "second = \"windage_nm_s2\"",
            "second = \"friction_nm_s\"",
            "has no interval",
        ),
        ("value = -0.5", "value = -1.5", "value"),
    ];
    for (old, new, told) in wrong {
        let text = format!(
            "{}{}",
            smallest().to_toml(),
            INTERVALS.replacen(old, new, 1)
        );
        let error = MotorFile::parse(&text, "m.toml").unwrap_err().to_string();
        assert!(error.contains(told), "{new}: {error}");
    }
}
