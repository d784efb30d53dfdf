//! `drivemon calibrate` as a person uses it: what it writes, what it refuses, exit codes.

use std::path::{Path, PathBuf};

use crate::common::{PROJECT, drivemon, scratch, stderr, stdout, text};

const MOTOR: &str = "motors/peer-2k2.toml";
const HEALTHY: &str = "tests/data/peer/none/recording.csv.gz";

/// Runs `calibrate` and expects a refusal: exit code and words of the reason; nothing may be written.
fn refused(folder: &str, recording: &str, motor: &str, code: i32, words: &[&str]) {
    let out = scratch(folder).join("calibrated.toml");
    let output = drivemon(&["calibrate", recording, "--motor", motor, "-o", text(&out)]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    for word in words {
        assert!(message.contains(word), "{word} is missing in: {message}");
    }
    assert!(!out.exists(), "a refused calibration wrote a file");
}

/// The lines of the healthy recording, its header first.
fn lines() -> Vec<String> {
    let packed = std::fs::File::open(Path::new(PROJECT).join(HEALTHY));
    let packed = packed.expect("part of the source tree");
    let whole = std::io::read_to_string(flate2::read::GzDecoder::new(packed)).expect("UTF-8");
    whole.lines().map(str::to_owned).collect()
}

/// The lines of a recording, changed one by one, beside a copy of its sidecar.
fn altered(folder: &str, change: impl Fn(usize, &str) -> Option<String>) -> PathBuf {
    let all = lines();
    let lines = all.iter().enumerate();
    let kept: Vec<String> = lines.filter_map(|(k, line)| change(k, line)).collect();
    // Beside `scratch` of the output, which is emptied.
    let folder = scratch(&format!("{folder}-source"));
    let sidecar = Path::new(PROJECT)
        .join(HEALTHY)
        .with_file_name("recording.toml");
    std::fs::copy(sidecar, folder.join("altered.toml")).expect("room for a copy");
    let file = folder.join("altered.csv");
    std::fs::write(&file, kept.join("\n")).expect("writable");
    file
}

#[test]
fn a_calibrated_motor_is_written_and_judges_its_recording_healthy() {
    let folder = scratch("calibrate");
    let (out, json) = (
        folder.join("calibrated.toml"),
        folder.join("calibrated.json"),
    );
    let output = drivemon(&[
        "calibrate",
        HEALTHY,
        "--motor",
        MOTOR,
        "-o",
        text(&out),
        "--json",
        text(&json),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("steady windows"),
        "{}",
        stdout(&output)
    );
    let written = std::fs::read_to_string(&out).expect("the motor file was written");
    assert!(written.contains("[healthy]"), "{written}");
    let json = std::fs::read_to_string(&json).expect("the JSON was written");
    let json: serde_json::Value = serde_json::from_str(&json).expect("it is JSON");
    assert_eq!(json["parameters"][0]["name"], "stator_resistance_ohm");
    assert!(
        json["windows"]
            .as_u64()
            .is_some_and(|windows| windows >= 50)
    );
    let output = drivemon(&["monitor", HEALTHY, "--motor", text(&out)]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
}

/// A motor whose load torque is not measured, at these loads for one and a half seconds each, the last at this voltage: what calibrating
/// it says, and how far it leaves the stator resistance open, percent.
fn calibrated_at(folder: &str, loads_percent: [f64; 3], last_volt_percent: f64) -> (String, f64) {
    let folder = scratch(folder);
    let at = |file: &str| folder.join(file);
    let motor = std::fs::read_to_string(Path::new(PROJECT).join(MOTOR)).expect("shipped");
    let free = motor.replace("kind = \"measured\"", "kind = \"free\"");
    assert_ne!(free, motor);
    std::fs::write(at("motor.toml"), free).expect("writable");
    let [first, second, third] = loads_percent;
    let scenario = format!(
        "name = \"Two loads\"\nmotor = \"motor.toml\"\nduration_s = 4.5\nstart = \"running\"\nseed = 5\n\
         [supply]\nsteps = [{{ at_s = 3.0, voltage_percent = {last_volt_percent} }}]\n\
         [load]\nfriction_percent = 0.0\nactive = true\ninterpolation = \"step\"\n\
         profile = [{{ at_s = 0.0, torque_percent = {first} }}, {{ at_s = 1.5, torque_percent = {second} }}, {{ at_s = 3.0, torque_percent = {third} }}]\n\
         [sensors]\nnoise_sigma_fraction_of_full_scale = 0.002\n"
    );
    std::fs::write(at("loads.toml"), scenario).expect("writable");
    let files = [
        "loads.toml",
        "recorded.csv.gz",
        "motor.toml",
        "mine.toml",
        "mine.json",
    ]
    .map(at);
    let [scenario, recording, motor, mine, json] = files.each_ref().map(|file| text(file));
    let simulated = drivemon(&["simulate", scenario, "-o", recording]);
    assert_eq!(simulated.status.code(), Some(0), "{}", stderr(&simulated));
    let output = drivemon(&[
        "calibrate",
        recording,
        "--motor",
        motor,
        "-o",
        mine,
        "--json",
        json,
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let told = std::fs::read_to_string(json).expect("the JSON was written");
    let told: serde_json::Value = serde_json::from_str(&told).expect("it is JSON");
    let open = told["healthy"]["stator_resistance_percent"].as_f64();
    (stdout(&output), open.expect("a number"))
}

/// Stator resistance, magnetizing inductance and leakage are three, and each load gives one equation for them: two loads leave them open,
/// however different they are.
#[test]
fn loads_that_are_too_few_or_too_alike_are_told() {
    for two in [[50.0, 100.0, 100.0], [10.0, 100.0, 100.0]] {
        let (said, open) = calibrated_at("calibrate-two", two, 100.0);
        let told = said.contains("too few or too alike") && said.contains("Record three loads");
        assert!((10.0..20.0).contains(&open) && told, "{open}: {said}");
    }
    let enough = [
        ("calibrate-three", [10.0, 50.0, 100.0], 100.0),
        ("calibrate-volts", [10.0, 100.0, 100.0], 90.0),
    ];
    for (folder, loads, volts) in enough {
        let (said, open) = calibrated_at(folder, loads, volts);
        let told = said.contains("too few or too alike");
        assert!(open < 3.0 && !told, "{open}: {said}");
    }
}

/// Effective values taken for amplitudes: a rotor resistance a third smaller makes the best of it, and what is left would hide every fault.
#[test]
fn what_no_parameter_mends_is_not_calibrated() {
    let recording = altered("calibrate-rms", |k, line| {
        let scaled = |(column, cell): (usize, &str)| match cell.parse::<f64>() {
            Ok(x) if k > 0 && (1..=3).contains(&column) => (x / 2.0_f64.sqrt()).to_string(),
            _ => cell.to_owned(),
        };
        let cells: Vec<String> = line.split(',').enumerate().map(scaled).collect();
        Some(cells.join(","))
    });
    let words = [
        "remain with the parameters that fit best",
        "a scale is wrong",
    ];
    refused("calibrate-rms", text(&recording), MOTOR, 3, &words);
}

#[test]
fn a_load_table_has_no_waveforms() {
    let table = "tests/data/imc_18k5_load_test/load_test.csv";
    refused(
        "calibrate-table",
        table,
        "motors/imc-18k5.toml",
        2,
        &["load table", "no waveforms", "explain"],
    );
}

#[test]
fn a_faulty_motor_is_refused_by_its_recording() {
    let faulty = "tests/data/itsc_075hp/sc_a0_b4_c0_004.csv.gz";
    let words = ["sc_a0_b4_c0_004", "not one healthy state"];
    refused(
        "calibrate-faulty",
        faulty,
        "motors/itsc-075hp.toml",
        3,
        &words,
    );
}

#[test]
fn a_dead_sensor_is_refused_by_its_phase() {
    let header = column("ib");
    let dead = altered("calibrate-dead", |k, line| {
        let mut cells: Vec<&str> = line.split(',').collect();
        if k > 0 {
            cells[header] = "0";
        }
        Some(cells.join(","))
    });
    refused("calibrate-dead", text(&dead), MOTOR, 3, &["dead"]);
}

#[test]
fn too_few_steady_windows_are_refused_with_what_to_record() {
    // 0.5 s at 10 kHz: the start and little more.
    let short = altered("calibrate-short", |k, line| {
        (k < 5000).then(|| line.to_owned())
    });
    let words = ["steady windows", "50 are needed", "constant load"];
    refused("calibrate-short", text(&short), MOTOR, 3, &words);
}

#[test]
fn a_recording_without_speed_is_refused_by_what_is_missing() {
    let speed = column("speed");
    let without = altered("calibrate-speed", |_, line| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells.remove(speed);
        Some(cells.join(","))
    });
    // The sidecar speaks of the column that is gone.
    let sidecar = without.with_extension("toml");
    let old = std::fs::read_to_string(&sidecar).expect("copied");
    let new = old.replace("[columns.speed]\nscale = 0.09765625\n", "");
    assert_ne!(old, new);
    std::fs::write(sidecar, new).expect("writable");
    refused(
        "calibrate-speed",
        text(&without),
        MOTOR,
        3,
        &["speed is not recorded"],
    );
}

#[test]
fn options_out_of_range_are_refused() {
    for (option, value) in [("--false-alarm-rate", "0.5"), ("--winding-kelvin", "300")] {
        let output = drivemon(&[
            "calibrate",
            HEALTHY,
            "--motor",
            MOTOR,
            "-o",
            "never.toml",
            option,
            value,
        ]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("outside"), "{}", stderr(&output));
    }
}

/// Place of a column in the recording.
fn column(name: &str) -> usize {
    let header = lines().swap_remove(0);
    let mut cells = header.split(',');
    cells
        .position(|cell| cell == name)
        .expect("a column of the recording")
}

/// Gains and delays, us, of va, vb, vc, ia, ib, ic on the bench below.
const GAINS: [f64; 6] = [1.004, 0.997, 1.0, 0.992, 1.006, 1.001];
const LATE_US: [f64; 6] = [93.5, 92.3, 91.1, 88.1, 86.9, 85.7];

/// One signal of 230 V and 7 A on all six channels, three seconds at 10 kHz in codes of 0.3 V and 0.01 A; `turns` moves each channel.
fn bench(folder: &str, hertz: f64, turns: [f64; 6]) -> PathBuf {
    use std::fmt::Write;
    let mut text = String::from("t,va,vb,vc,ia,ib,ic\n");
    for k in 0..30_000 {
        let t = f64::from(k) * 1e-4;
        write!(text, "{t:.4}").expect("memory");
        for channel in 0..6 {
            let angle = hertz * (t - LATE_US[channel] * 1e-6) + turns[channel];
            let (size, step) = if channel < 3 {
                (325.0, 0.3)
            } else {
                (10.0, 0.01)
            };
            let x = size * GAINS[channel] * (std::f64::consts::TAU * angle).cos();
            write!(text, ",{:.2}", (x / step).round() * step).expect("memory");
        }
        text.push('\n');
    }
    let path = scratch(&format!("{folder}-source")).join("bench.csv");
    std::fs::write(&path, text).expect("a scratch folder");
    path
}

#[test]
fn channels_are_calibrated_into_a_motor_file_whose_comments_survive() {
    let recording = bench("channels", 50.3, [0.0; 6]);
    let out = scratch("channels").join("board.toml");
    let output = drivemon(&[
        "calibrate",
        "--channels",
        text(&recording),
        "--motor",
        MOTOR,
        "-o",
        text(&out),
        "--json",
        "-",
        "--true-volt",
        "229.8097",
        "--true-amp",
        "7.071068",
    ]);
    assert!(output.status.success(), "{}", stderr(&output));
    let written = std::fs::read_to_string(&out).expect("written");
    let old = std::fs::read_to_string(Path::new(PROJECT).join(MOTOR)).expect("shipped");
    let comments = |text: &str| text.lines().filter(|line| line.starts_with('#')).count();
    assert_eq!(comments(&written), comments(&old), "{written}");
    let motor = motor::MotorFile::parse(&written, "board.toml").expect("a motor file");
    let sensors = motor.sensors;
    let gains = [sensors.voltage_gain, sensors.current_gain].concat();
    for (gain, truth) in gains.iter().zip(GAINS) {
        // Rounding of 30 000 samples to 1/1000 of the amplitude.
        assert!((gain * truth - 1.0).abs() < 5e-5, "{gain} {truth}");
    }
    let delays = [sensors.voltage_delay_s, sensors.current_delay_s].concat();
    let common = LATE_US[3..].iter().sum::<f64>() / 3.0;
    for (delay, late) in delays.iter().zip(LATE_US) {
        assert!(
            (delay * 1e6 - (late - common)).abs() < 0.1,
            "{delay} {late}"
        );
    }
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(result["channels"].as_array().expect("six").len(), 6);
    assert!((result["frequencies_hz"][0].as_f64().expect("a number") - 50.3).abs() < 1e-3);
}

/// The table of a board, for whatever motor stands behind it.
#[test]
fn channels_without_a_motor_file_are_a_table_of_their_own() {
    let recording = bench("channels-table", 50.0, [0.0; 6]);
    let out = scratch("channels-table").join("channels.toml");
    let output = drivemon(&[
        "calibrate",
        "--channels",
        text(&recording),
        "-o",
        text(&out),
    ]);
    assert!(output.status.success(), "{}", stderr(&output));
    let said = stdout(&output);
    for words in ["delay, us", "--true-volt", "one frequency does not tell"] {
        assert!(said.contains(words), "{words} is missing in: {said}");
    }
    let table: toml::Table = std::fs::read_to_string(&out)
        .expect("written")
        .parse()
        .expect("TOML");
    let sensors = table["sensors"].as_table().expect("a table");
    assert_eq!(
        sensors["voltage_delay_us"]
            .as_array()
            .expect("a list")
            .len(),
        3
    );
}

#[test]
fn channels_are_not_calibrated_from_a_running_motor() {
    let third = 1.0 / 3.0;
    let recording = bench(
        "three-phase",
        50.0,
        [0.0, -third, third, 0.0, -third, third],
    );
    let out = scratch("three-phase").join("channels.toml");
    let output = drivemon(&[
        "calibrate",
        "--channels",
        text(&recording),
        "-o",
        text(&out),
    ]);
    assert_eq!(output.status.code(), Some(3));
    let message = stderr(&output);
    assert!(message.contains("these are three phases"), "{message}");
    assert!(!out.exists());
}

#[test]
fn options_of_the_channels_need_channels() {
    let out = scratch("channels-options").join("m.toml");
    let output = drivemon(&[
        "calibrate",
        HEALTHY,
        "--motor",
        MOTOR,
        "--true-volt",
        "230",
        "-o",
        text(&out),
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("--channels"));
    let without = drivemon(&["calibrate", HEALTHY, "-o", text(&out)]);
    assert_eq!(without.status.code(), Some(2));
    assert!(stderr(&without).contains("--motor"));
}
