//! `drivemon motor new`, `motor tests`, `motor catalogue`, `motor identify` and `check` as a technician uses them: a plate and recordings.

#[path = "../common/mod.rs"]
mod common;
mod does_not_fit;
mod in_motion;
mod standard_tests;

use std::path::{Path, PathBuf};

use common::{PROJECT, drivemon, scratch, stderr, stdout, text};
use motor::MotorFile;

/// The plate of motors/peer-2k2.toml: its T model's own values at 2.2 kW on the shaft, rounded as plates are.
const PLATE: &str = "name = \"Pump 3\"\npower_kw = 2.2\nvoltage_volt = 400\nfrequency_hz = 50\nspeed_rpm = 1438\n\
                     current_amp = 4.78\npower_factor = 0.77\nefficiency_percent = 86.3\n";

/// A folder with the plate.
fn workplace(name: &str) -> PathBuf {
    let folder = scratch(name);
    std::fs::write(folder.join("plate.toml"), PLATE).unwrap();
    std::fs::copy(
        Path::new(PROJECT).join("motors/peer-2k2.toml"),
        folder.join("truth.toml"),
    )
    .unwrap();
    folder
}

/// Simulates the true motor; channels in `without` are taken out of the file.
fn simulated(folder: &Path, name: &str, scenario: &str, without: &[&str]) -> PathBuf {
    let text_of = format!("motor = \"truth.toml\"\n{scenario}");
    let source = folder.join(format!("{name}-scenario.toml"));
    std::fs::write(&source, text_of).unwrap();
    let recording = folder.join(format!("{name}.csv"));
    let output = drivemon(&["simulate", text(&source), "-o", text(&recording)]);
    assert!(output.status.success(), "{}", stderr(&output));
    let whole = std::fs::read_to_string(&recording).unwrap();
    let header: Vec<&str> = whole.lines().next().unwrap().split(',').collect();
    let kept = |line: &str| {
        let cells = line.split(',').zip(&header);
        let kept: Vec<&str> = cells
            .filter(|(_, h)| !without.contains(h))
            .map(|(c, _)| c)
            .collect();
        kept.join(",")
    };
    let lines: Vec<String> = whole.lines().map(kept).collect();
    std::fs::write(&recording, lines.join("\n") + "\n").unwrap();
    recording
}

const STEADY: &str = "start = \"running\"\nduration_s = 4\n[load]\nfriction_percent = 0\nactive = true\nconstant_percent = 70\n\
                      [sensors]\nnoise_sigma_fraction_of_full_scale = 0.001\ntorque = true\n";
const RESISTANCE_B: &str = "[[faults]]\nfault = \"Rsb\"\nchange_percent = 60\nfrom_s = 1.5\n";

fn json(output: &std::process::Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", stderr(output)))
}

#[test]
fn a_healthy_motor_known_by_its_plate_is_in_good_order() {
    let folder = workplace("check-healthy");
    let today = simulated(&folder, "today", STEADY, &[]);
    let plate = folder.join("plate.toml");
    let output = drivemon(&["check", text(&today), "--plate", text(&plate)]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for words in ["in good order", "--healthy", "what cannot be seen"] {
        assert!(
            stdout(&output).contains(words),
            "{words}: {}",
            stdout(&output)
        );
    }
}

/// With and without an encoder: plate, one healthy recording, and the phase is named.
#[test]
fn a_phase_is_named_from_a_plate_and_one_healthy_recording() {
    for without in [&[][..], &["speed", "torque"][..]] {
        let folder = workplace(&format!("check-phase-{}", without.len()));
        let healthy = simulated(&folder, "healthy", STEADY, without);
        let today = simulated(
            &folder,
            "today",
            &format!("seed = 8\n{STEADY}{RESISTANCE_B}"),
            without,
        );
        let plate = folder.join("plate.toml");
        let known = folder.join("known.toml");
        let arguments = [
            "check",
            text(&today),
            "--plate",
            text(&plate),
            "--healthy",
            text(&healthy),
            "-o",
            text(&known),
        ];
        let output = drivemon(&[&arguments[..], &["--json", "-"]].concat());
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        let answer = json(&output);
        assert_eq!(answer["knowledge"], "calibrated");
        let first = &answer["recordings"][0]["verdict"]["candidates"][0];
        assert_eq!(
            (&first["fault"], &first["phase"]),
            (&"Rs".into(), &"b".into()),
            "{first}"
        );
        assert!(first["probability"].as_f64().unwrap() > 0.5);
        assert_eq!(answer["recordings"][0]["severity"], "large");
        let again = drivemon(&["check", text(&healthy), "--motor", text(&known)]);
        assert_eq!(again.status.code(), Some(0), "{}", stdout(&again));
        if !without.is_empty() {
            let speed = &answer["recordings"][0]["speed"];
            // The true slip at 70 % of rated torque is 2.64 % of synchronous speed.
            let miss = speed["slip_percent"].as_f64().unwrap() - 2.64;
            assert!(
                miss.abs() < speed["slip_half_width_percent"].as_f64().unwrap(),
                "{speed}"
            );
        }
    }
}

/// The true parameters are in the plate's intervals, and within 3 % (leakage 8 %) after a start and two loads.
#[test]
fn a_start_and_two_loads_teach_the_parameters() {
    let folder = workplace("identify");
    let start = "duration_s = 6\n[load]\nfriction_percent = 0\nactive = true\nprofile = [{at_s = 0, torque_percent = 0}, \
                 {at_s = 2, torque_percent = 50}, {at_s = 4, torque_percent = 100}]\n[sensors]\n\
                 noise_sigma_fraction_of_full_scale = 0.001\ntorque = true\n";
    let recording = simulated(&folder, "start", start, &[]);
    let [plate, new, known] =
        ["plate.toml", "new.toml", "known.toml"].map(|name| folder.join(name));
    let made = drivemon(&["motor", "new", "--plate", text(&plate), "-o", text(&new)]);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    let output = drivemon(&[
        "motor",
        "identify",
        text(&recording),
        "--motor",
        text(&new),
        "-o",
        text(&known),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let truth = MotorFile::read(folder.join("truth.toml")).unwrap();
    let (plate, found) = (
        MotorFile::read(&new).unwrap(),
        MotorFile::read(&known).unwrap(),
    );
    let of = |m: &MotorFile| {
        let p = &m.parameters;
        [
            ("stator_resistance_ohm", p.r_s, 0.03),
            ("rotor_resistance_ohm", p.r_r, 0.03),
            ("stator_leakage_henry", p.l_ls, 0.08),
            ("rotor_leakage_henry", p.l_lr, 0.08),
            ("magnetizing_inductance_henry", p.l_m, 0.03),
            ("inertia_kg_m2", m.mechanics.inertia, 0.03),
        ]
    };
    let intervals = plate.uncertainty.unwrap();
    for ((key, true_value, tolerance), (_, value, _)) in of(&truth).into_iter().zip(of(&found)) {
        let interval = intervals.of(key).unwrap();
        assert!(
            (interval.low..=interval.high).contains(&true_value),
            "{key} {true_value} {interval:?}"
        );
        println!("{key}: {:+.2} %", 100.0 * (value / true_value - 1.0));
        assert!(
            (value / true_value - 1.0).abs() < tolerance,
            "{key} {true_value} {value}"
        );
    }
}

#[test]
fn contradictions_of_a_plate_are_named() {
    let folder = workplace("contradictions");
    let out = folder.join("m.toml");
    let odd = drivemon(&[
        "motor",
        "new",
        "--power-kw",
        "5.5",
        "--voltage-volt",
        "400",
        "--frequency-hz",
        "50",
        "--speed-rpm",
        "1455",
        "--current-amp",
        "16",
        "--power-factor",
        "0.85",
        "--efficiency-percent",
        "89.2",
        "-o",
        text(&out),
    ]);
    assert_eq!(odd.status.code(), Some(1));
    assert!(
        stdout(&odd).contains("current 16.0000 A does not go with"),
        "{}",
        stdout(&odd)
    );
    let lossless = drivemon(&[
        "motor",
        "new",
        "--power-kw",
        "5.5",
        "--voltage-volt",
        "400",
        "--frequency-hz",
        "50",
        "--speed-rpm",
        "1320",
        "--power-factor",
        "0.85",
        "--efficiency-percent",
        "92",
        "-o",
        text(&out),
    ]);
    assert_eq!(lossless.status.code(), Some(1));
    assert!(
        stdout(&lossless).contains("slip and efficiency contradict"),
        "{}",
        stdout(&lossless)
    );
}

#[test]
fn a_plate_that_says_too_little_or_nonsense_is_refused() {
    let folder = workplace("refused-plates");
    let out = folder.join("m.toml");
    let refused = [
        (
            &["--power-kw", "5.5", "--frequency-hz", "50"][..],
            "the voltage is missing",
        ),
        (
            &["--voltage-volt", "400", "--frequency-hz", "50"],
            "the power is missing",
        ),
        (
            &["--power-kw", "5.5", "--voltage-volt", "400"],
            "the frequency is missing",
        ),
        (
            &[
                "--power-kw",
                "5.5",
                "--voltage-volt",
                "400",
                "--frequency-hz",
                "50",
                "--speed-rpm",
                "1500",
            ],
            "no slip",
        ),
        (
            &["--power-kw", "5,5"],
            "--power-kw: \"5,5\" is not a number",
        ),
        (
            &[
                "--power-kw",
                "5.5",
                "--voltage-volt",
                "400",
                "--speed-rpm",
                "1455",
                "--power-factor",
                "1.4",
            ],
            "power_factor = 1.4 is outside",
        ),
    ];
    for (flags, told) in refused {
        let output = drivemon(&[&["motor", "new", "-o", text(&out)], flags].concat());
        assert_eq!(output.status.code(), Some(2), "{flags:?}");
        assert!(stderr(&output).contains(told), "{}", stderr(&output));
        assert!(!out.exists());
    }
}

#[test]
fn a_table_of_motors_keeps_its_columns_and_says_what_is_wrong_with_a_row() {
    let folder = scratch("catalogue");
    let [table, out] = ["in.csv", "out.csv"].map(|name| folder.join(name));
    let rows = "tag,power_kw,voltage_volt,frequency_hz,speed_rpm,efficiency_percent,power_factor,current_amp,breakdown_torque_ratio,locked_rotor_torque_ratio,locked_rotor_current_ratio\n\
                P1,5.5,400,50,1455,89.2,0.85,10.5,3.1,2.3,7.2\n\
                P2,5.5,400,50,1455,,,,,,\n\
                P3,x,400,50,1455,89.2,0.85,,,,\n";
    std::fs::write(&table, rows).unwrap();
    let output = drivemon(&["motor", "catalogue", text(&table), "-o", text(&out)]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let written = std::fs::read_to_string(&out).unwrap();
    let lines: Vec<Vec<&str>> = written
        .lines()
        .map(|line| line.split(',').collect())
        .collect();
    let column = |name: &str| {
        lines[0]
            .iter()
            .position(|h| *h == name)
            .unwrap_or_else(|| panic!("{name}"))
    };
    assert_eq!([lines[1][0], lines[2][0], lines[3][0]], ["P1", "P2", "P3"]);
    let number = |row: usize, name: &str| lines[row][column(name)].parse::<f64>().unwrap();
    assert!(number(1, "worst_error_percent") < 1.0);
    for key in ["stator_resistance_ohm", "breakdown_torque_ratio"] {
        let [low, high] = ["_low", "_high"].map(|end| number(2, &format!("{key}{end}")));
        assert!(low < high && low > 0.0);
    }
    assert!(
        lines[3][column("problem")].contains("line 4: power_kw"),
        "{}",
        lines[3][column("problem")]
    );
}

/// One clamp: frequency and size, and what the rest needs; nothing invented.
#[test]
fn one_clamp_says_what_it_can() {
    let folder = workplace("check-clamp");
    let others = ["va", "vb", "vc", "ib", "ic", "speed", "torque"];
    let today = simulated(&folder, "today", STEADY, &others);
    let plate = folder.join("plate.toml");
    let arguments = ["check", text(&today), "--plate", text(&plate)];
    let output = drivemon(&[&arguments[..], &["--json", "-"]].concat());
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let answer = json(&output);
    let checked = &answer["recordings"][0];
    let hz = checked["clamps"][0]["frequency_hz"].as_f64().unwrap();
    assert!((hz - 50.0).abs() < 0.05, "{hz}");
    let codes = checked["audit"]["findings"].as_array().unwrap();
    assert!(
        codes.iter().all(|finding| finding["code"] != "not-locked"),
        "{codes:?}"
    );
    let shown = drivemon(&arguments);
    assert!(
        stdout(&shown).contains("three voltages or three currents are needed"),
        "{}",
        stdout(&shown)
    );
    assert!(checked["clamps"][0]["beside_supply"]["line"].is_null());
}

/// Bars leave a pair of lines at twice the slip frequency; one current shows the pair and calls nothing broken.
#[test]
fn one_clamp_shows_the_lines_of_broken_bars_and_names_what_else_leaves_them() {
    let folder = workplace("check-clamp-bars");
    let asymmetry =
        "[[effects]]\nname = \"rotor-asymmetry\"\nasymmetry_re = 0.04\nasymmetry_im = 0.0\n";
    let scenario = STEADY.replace("duration_s = 4", "duration_s = 10");
    let others = ["va", "vb", "vc", "ib", "ic", "torque"];
    let with_speed = simulated(&folder, "today", &(scenario + asymmetry), &others);
    let whole = std::fs::read_to_string(&with_speed).unwrap();
    let last = whole
        .lines()
        .last()
        .unwrap()
        .split(',')
        .next_back()
        .unwrap();
    let slip_hz = 50.0 - 2.0 * last.parse::<f64>().unwrap() / std::f64::consts::TAU;
    let bare: Vec<String> = whole
        .lines()
        .map(|line| line.split(',').take(2).collect::<Vec<_>>().join(","))
        .collect();
    std::fs::write(folder.join("clamp.csv"), bare.join("\n") + "\n").unwrap();
    let (recording, plate) = (folder.join("clamp.csv"), folder.join("plate.toml"));
    let arguments = ["check", text(&recording), "--plate", text(&plate)];
    let answer = json(&drivemon(&[&arguments[..], &["--json", "-"]].concat()));
    let clamp = &answer["recordings"][0]["clamps"][0];
    let line = &clamp["beside_supply"]["line"];
    let distance = line["distance_hz"]
        .as_f64()
        .unwrap_or_else(|| panic!("{clamp}"));
    // Lines of ten seconds are 0.1 Hz apart; the speed swings by less.
    assert!(
        (distance - 2.0 * slip_hz).abs() < 0.15,
        "{distance} {slip_hz}"
    );
    assert!(line["lower_percent"].as_f64().unwrap() > 0.5, "{line}");
    let words = clamp["rotor"].as_str().unwrap();
    assert!(
        words.contains("cannot be told") && words.contains("swings"),
        "{words}"
    );
    assert_eq!(drivemon(&arguments).status.code(), Some(3));
}

/// A load table whose model misses an effect: the parameters would stand for it (the stator's resistance three times too
/// high), so nothing is written.
#[test]
fn parameters_that_stand_for_a_missing_effect_are_not_taken() {
    let folder = workplace("identify-misfit");
    let out = folder.join("m.toml");
    let arguments = [
        "motor",
        "identify",
        "tests/data/imc_18k5_load_test/load_test.csv",
        "--motor",
        "motors/imc-18k5.toml",
        "-o",
        text(&out),
    ];
    let refused = drivemon(&arguments);
    assert_eq!(refused.status.code(), Some(3), "{}", stderr(&refused));
    assert!(
        stdout(&refused).contains("drivemon explain"),
        "{}",
        stdout(&refused)
    );
    assert!(!out.exists());
    let anyway = drivemon(&[&arguments[..], &["--anyway"]].concat());
    assert_eq!(anyway.status.code(), Some(1));
    assert!(out.exists());
}

/// The plate's rounded speed leaves the rotor resistance a narrow interval that the recording contradicts: no value is shown outside the
/// interval beside it.
#[test]
fn values_that_a_plate_does_not_foresee_have_intervals_of_their_own() {
    let folder = workplace("check-contradicted");
    let motor = Path::new(PROJECT).join("motors/imc-18k5.toml");
    std::fs::copy(motor, folder.join("truth.toml")).unwrap();
    let plate = "name = \"m\"\npower_kw = 18.5\nvoltage_volt = 400\nfrequency_hz = 50\nspeed_rpm = 1462.5\ncurrent_amp = 32.85\n\
                 connection = \"delta\"\n";
    let file = folder.join("plate.toml");
    std::fs::write(&file, plate).unwrap();
    let healthy = simulated(&folder, "healthy", STEADY, &[]);
    let arguments = [
        "check",
        text(&healthy),
        "--plate",
        text(&file),
        "--healthy",
        text(&healthy),
        "--json",
        "-",
    ];
    let answer = json(&drivemon(&arguments));
    let shown = answer["parameters"].as_array().expect("listed");
    assert!(answer["calibrated"].as_bool().unwrap() && !shown.is_empty());
    for one in shown {
        let [low, value, high] = ["low", "value", "high"].map(|key| one[key].as_f64().unwrap());
        assert!(low <= value && value <= high, "{one}");
    }
}

/// A plate beside a motor file would be ignored: it is refused, by name.
#[test]
fn a_plate_beside_a_motor_file_is_refused() {
    let folder = workplace("check-both");
    let (truth, plate) = (folder.join("truth.toml"), folder.join("plate.toml"));
    let both = ["check", "none.csv", "--motor", text(&truth)];
    for (more, named) in [
        (&["--power-kw", "2.2"][..], "--power-kw"),
        (&["--name", "Pump"], "--name"),
        (&["--plate", text(&plate)], "--plate"),
        (&["--dc-resistance-ohm", "3"], "--dc-resistance-ohm"),
    ] {
        let output = drivemon(&[&both[..], more].concat());
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(named), "{}", stderr(&output));
    }
}
