//! `drivemon export`: what leaves the program does the same as the simulation, and what cannot leave is said.
#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Arc;

use motor::MotorFile;
use motor::dynamic::clarke;
use motor::effect::{
    Between, Inputs, Plant, Run, SpeedSource, Timeline, from_motor_file, rated, simulate,
};

use crate::common::{PROJECT, scratch, stderr, stdout};

/// Step and number of steps of a start.
const STEP_S: f64 = 100e-6;
const STEPS: usize = 1200;
/// Largest difference over the largest value of a signal.
const MOST: f64 = 1e-6;

/// One effect of each kind: in the iron, in the cage, on the shaft, a law, a formula, an instrument.
const ADOPTED: &str = r#"
[[effects]]
name = "magnetizing-saturation"
saturation = 0.28
saturation_exponent = 7.0
flux_location = 0.5

[[effects]]
name = "deep-bar"
form = "double-cage"
second_cage_share = 0.3
second_cage_leakage_ratio = 0.5

[[effects]]
name = "inverter-dead-time"
dead_time_voltage_volt = 6.0
smoothing_current_amp = 0.3

[[effects]]
name = "curve"
place = "torque"
coordinate = "angle"
knots_rad = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
values_nm = [0.2, 0.9, 0.4, -0.3, -0.7, -0.2]

[[effects]]
name = "expression"
formula = "2 * brake_nm * (omega / 40) / (1 + (omega / 40)^2)"
adds_to = "torque"
brake_nm = 0.6

[[effects]]
name = "speed-scale"
speed_scale = 1.01
"#;

const LATE: &str = "\n[[effects]]\nname = \"sample-delay\"\ndelay_s = 1e-4\n";

/// A folder with a motor file `motor.toml`: the peer's motor with effects.
fn bench(name: &str, effects: &str) -> PathBuf {
    let folder = scratch(name);
    let motor = fs::read_to_string(Path::new(PROJECT).join("motors/peer-2k2.toml"));
    fs::write(
        folder.join("motor.toml"),
        motor.expect("it ships") + effects,
    )
    .expect("written");
    folder
}

fn export(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(["export", "motor.toml", "--to"])
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the binary runs")
}

fn exported(folder: &Path, arguments: &[&str]) -> String {
    let output = export(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    stdout(&output)
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = export(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{}", stdout(&output));
    stderr(&output)
}

/// Writes the inputs of a start as a table; gives the simulation's currents, speed and angle.
fn start(folder: &Path) -> Vec<[f64; 5]> {
    let file = MotorFile::read(folder.join("motor.toml")).expect("a motor file");
    let rated = rated(&file);
    let mut table = "t,u_a,u_b,u_c,tau_load,omega_sync\n".to_owned();
    let mut inputs = Inputs {
        t_sample: STEP_S,
        ..Inputs::default()
    };
    for k in 0..=STEPS {
        let t = STEP_S * k as f64;
        let third = std::f64::consts::TAU / 3.0;
        let u =
            [0.0, -third, third].map(|turn| rated.voltage * (rated.omega_sync * t + turn).cos());
        let load = if k > STEPS / 2 { 5.0 } else { 0.0 };
        let omega = rated.omega_sync;
        table += &format!(
            "{t:?},{:?},{:?},{:?},{load:?},{omega:?}\n",
            u[0], u[1], u[2]
        );
        inputs.u_s.push(clarke(u));
        inputs.tau_load.push(load);
    }
    fs::write(folder.join("inputs.csv"), table).expect("written");
    let plant = Plant {
        motor: file.parameters,
        mechanics: file.mechanics,
        rated,
        effects: from_motor_file(&file, "motor.toml").expect("effects"),
    };
    let timeline = Arc::new(Timeline::constant(rated.omega_sync));
    let run = Run {
        inputs: &inputs,
        between: Between::Held,
        speed: SpeedSource::Free,
        timeline: &timeline,
        running_at: None,
        running_at_cuts: &[],
        offsets: &[],
        open: &[],
    };
    let shown = simulate(&plant, &run);
    let signals = shown
        .i_s_abc
        .iter()
        .zip(&shown.omega_mech)
        .zip(&shown.theta_mech);
    signals
        .map(|((i, w), angle)| [i[0], i[1], i[2], *w, *angle])
        .collect()
}

/// What a program makes of the inputs.
fn answer(folder: &Path, program: &mut Command) -> Vec<[f64; 5]> {
    let inputs = fs::File::open(folder.join("inputs.csv")).expect("inputs");
    let done = program
        .current_dir(folder)
        .stdin(Stdio::from(inputs))
        .output()
        .expect("it runs");
    assert!(done.status.success(), "{}", stderr(&done));
    let row = |line: &str| {
        let numbers: Vec<f64> = line
            .split(',')
            .map(|x| x.parse().expect("a number"))
            .collect();
        [1, 2, 3, 4, 5].map(|k| numbers[k])
    };
    stdout(&done).lines().skip(1).map(row).collect()
}

fn hold(ours: &[[f64; 5]], theirs: &[[f64; 5]]) {
    assert_eq!(ours.len(), STEPS + 1);
    for signal in 0..5 {
        let size = theirs
            .iter()
            .map(|row| row[signal].abs())
            .fold(0.0, f64::max);
        assert!(size > 0.1, "signal {signal} never moves");
        for (k, (a, b)) in ours.iter().zip(theirs).enumerate() {
            let apart = (a[signal] - b[signal]).abs() / size;
            assert!(apart < MOST, "signal {signal}, step {k}: {apart:e}");
        }
    }
}

fn is_here(program: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok();
    if !found {
        println!("skipped: no {program}");
    }
    found
}

#[test]
fn python_does_what_the_simulation_does() {
    let folder = bench("export-python", ADOPTED);
    let said = exported(&folder, &["python"]);
    assert!(said.starts_with("motor.py: written\n"), "{said}");
    assert!(
        said.contains("Effects: magnetizing-saturation, deep-bar (double-cage), "),
        "{said}"
    );
    if is_here("python3") {
        let simulated = start(&folder);
        hold(
            &answer(&folder, Command::new("python3").arg("motor.py")),
            &simulated,
        );
        // The effects matter: without one of them it is another motor.
        exported(&folder, &["python", "--without", "curve", "-o", "bare.py"]);
        let bare = answer(&folder, Command::new("python3").arg("bare.py"));
        let apart = |(a, b): (&[f64; 5], &[f64; 5])| (a[3] - b[3]).abs();
        assert!(bare.iter().zip(&simulated).map(apart).fold(0.0, f64::max) > 0.1);
    }
}

#[test]
fn c_does_what_the_simulation_does() {
    let folder = bench("export-c", ADOPTED);
    let said = exported(&folder, &["c", "-o", "peer.c"]);
    assert!(said.starts_with("peer.c, peer.h: written\n"), "{said}");
    if is_here("cc") {
        let arguments = [
            "-O1",
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-Dpeer_MAIN",
            "peer.c",
            "-lm",
            "-o",
            "peer",
        ];
        let made = Command::new("cc")
            .args(arguments)
            .current_dir(&folder)
            .output()
            .expect("cc");
        assert!(made.status.success(), "{}", stderr(&made));
        let simulated = start(&folder);
        hold(
            &answer(&folder, &mut Command::new(folder.join("peer"))),
            &simulated,
        );
    }
}

#[test]
fn an_fmu_has_its_description_and_sources_with_and_without_a_compiler() {
    let folder = bench("export-fmu", ADOPTED);
    let entries = || {
        let file = fs::File::open(folder.join("motor.fmu")).expect("an archive");
        let archive = zip::ZipArchive::new(file).expect("an archive");
        let names = archive
            .file_names()
            .map(|name| name.expect("a name").into_owned());
        names.collect::<Vec<String>>()
    };
    let sources = [
        "modelDescription.xml",
        "sources/motor.c",
        "sources/motor.h",
        "sources/fmi2.c",
    ];
    let without = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(["export", "motor.toml", "--to", "fmu"])
        .env("CC", "no-such-compiler")
        .current_dir(&folder)
        .output()
        .expect("the binary runs");
    assert!(without.status.success(), "{}", stderr(&without));
    assert!(
        stdout(&without).contains("No library is in it, only its sources (no-such-compiler"),
        "{}",
        stdout(&without)
    );
    assert!(
        sources
            .iter()
            .all(|name| entries().iter().any(|entry| entry == name))
    );
    assert_eq!(entries().len(), sources.len());
    if is_here("cc") {
        let said = exported(&folder, &["fmu"]);
        assert!(
            said.contains("Library for this computer: binaries/"),
            "{said}"
        );
        assert_eq!(entries().len(), sources.len() + 1);
    }
}

#[test]
fn what_cannot_leave_is_said_with_what_can_be_done() {
    let folder = bench("export-refused", &format!("{ADOPTED}{LATE}"));
    let cases: [(&[&str], &str); 7] = [
        (&["python"], "`sample-delay` cannot be exported"),
        (&["python"], "--without sample-delay"),
        (
            &["python", "--without", "windage"],
            "--without windage: the motor file has no such effect; it has: curve, ",
        ),
        (
            &["modelica", "--without", "sample-delay"],
            "`inverter-dead-time` cannot be written for Modelica",
        ),
        (&["c", "-o", "motor.py"], "ends with .c"),
        (&["matlab", "-o", "my-motor.m"], "call it my_motor.m"),
        (&["python", "-o", "import.py"], "call it motor_import.py"),
    ];
    for (arguments, wanted) in cases {
        let said = refused(&folder, arguments);
        assert!(said.contains(wanted), "{arguments:?}: {said}");
    }
    let left: Vec<_> = fs::read_dir(&folder).expect("a folder").collect();
    assert_eq!(left.len(), 1, "nothing but the motor file is there");
    let said = exported(
        &folder,
        &[
            "modelica",
            "--without",
            "sample-delay",
            "--without",
            "inverter-dead-time",
        ],
    );
    assert!(
        said.contains("left out: inverter-dead-time, sample-delay"),
        "{said}"
    );
}

/// Three Python files of one motor, none of which takes another's place.
#[test]
fn python_files_of_one_motor_have_names_of_their_own() {
    let folder = bench("export-names", "");
    for to in ["python", "motulator", "gym-electric-motor"] {
        exported(&folder, &[to]);
    }
    for name in [
        "motor.py",
        "motor_motulator.py",
        "motor_gym_electric_motor.py",
    ] {
        assert!(folder.join(name).exists(), "{name}");
    }
}

#[test]
fn parameters_for_other_libraries_say_what_is_lost() {
    let windage = "\n[[effects]]\nname = \"windage\"\nwindage_nm_s2 = 4e-5\n";
    let folder = bench("export-libraries", &format!("{windage}{ADOPTED}"));
    let said = exported(&folder, &["motulator", "-o", "for_motulator.py"]);
    assert!(said.contains("Held: windage\n"), "{said}");
    assert!(
        said.contains("Lost: magnetizing-saturation, deep-bar (double-cage), "),
        "{said}"
    );
    let text = fs::read_to_string(folder.join("for_motulator.py")).expect("written");
    // L_s of the Gamma model is stator leakage and magnetizing inductance of the motor file.
    assert!(text.contains("L_s=0.245"), "{text}");
    assert!(text.contains("+ 4e-5 * abs(omega)"), "{text}");
    exported(&folder, &["gym-electric-motor", "-o", "for_gem.py"]);
    let text = fs::read_to_string(folder.join("for_gem.py")).expect("written");
    assert!(text.contains("l_sigs=0.010735192570458851"), "{text}");
    assert!(text.contains("Lost: magnetizing-saturation"), "{text}");
}
