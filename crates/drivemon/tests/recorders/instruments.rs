//! Recordings by other people's instruments: what they do to a healthy motor is named or mended, never called a fault.

use std::path::Path;

use audit::{Audit, Code, Expectation, audit};
use formats::read_recording;
use monitor::Monitor;
use motor::MotorFile;
use recording::{Channel, Mapping, Recording};
use replay::{self, Samples, Timeline, VerdictState};
use scenario::Scenario;
use scenario::simulate::record;

const MOTORS: [&str; 5] = [
    "assumed-300w",
    "peer-2k2",
    "chalmers-4kw",
    "imc-18k5",
    "peer-2k2-saturating",
];

fn project(path: &str) -> std::path::PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join(path)
}

fn motor(name: &str) -> MotorFile {
    MotorFile::read(project(&format!("motors/{name}.toml"))).expect("it ships")
}

/// A scenario of a shipped motor; `text` is everything but its motor.
fn scenario(motor: &str, text: &str) -> Scenario {
    let text = format!("motor = \"{motor}.toml\"\n{text}");
    Scenario::parse(&text, "scenario.toml", &project("motors")).expect("a scenario")
}

fn recorded(scenario: &Scenario) -> Recording {
    record(scenario, |_| {}).expect("it runs")
}

/// What `drivemon monitor` makes of a recording.
fn monitored(recording: &Recording, motor: &MotorFile) -> (Audit, Timeline) {
    let audit = audit(recording, &Expectation::from(motor));
    let config = replay::config_for(motor, recording).expect("effects of the library");
    let monitor = Monitor::new(config).expect("a sound configuration");
    let timeline = replay::replay(&monitor, &Samples::new(recording, &audit), &mut |_| {});
    (audit, timeline)
}

fn codes(audit: &Audit) -> Vec<Code> {
    audit.findings.iter().map(|finding| finding.code).collect()
}

/// A load that drives the shaft: from hardly anything to rated torque.
#[test]
fn a_generator_starts_running_and_is_healthy() {
    for name in MOTORS {
        for percent in [-2, -5, -20, -60, -100] {
            let text = format!(
                "start = \"running\"\nduration_s = 0.8\n[load]\nfriction_percent = 0\nconstant_percent = {percent}\n\
                 [sensors]\ntorque = true\nnoise_sigma_fraction_of_full_scale = 0.0005"
            );
            let recording = recorded(&scenario(name, &text));
            let (audit, timeline) = monitored(&recording, &motor(name));
            assert_eq!(codes(&audit), [], "{name} {percent}: {:#?}", audit.findings);
            let state = timeline.verdict(&[]).state;
            assert_eq!(state, VerdictState::Healthy, "{name} {percent}");
            assert!(
                10 * timeline.judged > 8 * timeline.windows,
                "{name} {percent}"
            );
        }
    }
}

/// One converter, one channel after the other in steps of 11.55 us: the samples of a simulation at the converter's own rate.
fn in_turn(name: &str, order: [Channel; 6]) -> Recording {
    const STEP_S: f64 = 11.55e-6;
    const ROW: usize = 9;
    let text = format!(
        "start = \"running\"\nduration_s = 0.6\nsample_rate_hz = {}\n[load]\nfriction_percent = 0\nconstant_percent = 60\n\
         [sensors]\nquantise = false\nnoise_sigma_fraction_of_full_scale = 0.0002",
        1.0 / STEP_S
    );
    let fine = recorded(&scenario(name, &text));
    let rows = fine.len() / ROW;
    let t = (0..rows).map(|k| (k * ROW) as f64 * STEP_S).collect();
    let mut coarse = Recording::new("in-turn.csv", t, fine.metadata.clone()).expect("a clock");
    for (channel, x) in fine.channels() {
        let late = order
            .iter()
            .position(|other| *other == channel)
            .unwrap_or(0);
        let values = (0..rows).map(|k| x[k * ROW + late]).collect();
        coarse = coarse.with_channel(channel, values).expect("as long");
    }
    coarse
}

fn reread(recording: &Recording, name: &str, flags: &Mapping) -> Recording {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("recording.csv");
    formats::write_recording(&path, recording).expect("room");
    read_recording(&path, flags, &mut |_| {}).expect("readable")
}

#[test]
fn channels_sampled_one_after_the_other_are_healthy_once_their_delays_are_known() {
    let [va, vb, vc] = Channel::VOLTAGES;
    let [ia, ib, ic] = Channel::CURRENTS;
    for (k, order) in [[va, vb, vc, ia, ib, ic], [va, ia, vb, ib, vc, ic]]
        .into_iter()
        .enumerate()
    {
        for name in MOTORS {
            let recording = in_turn(name, order);
            let (_, timeline) = monitored(&recording, &motor(name));
            if k == 0 {
                // Currents three steps behind the voltages: what happens where nobody says so.
                assert_eq!(timeline.verdict(&[]).state, VerdictState::Fault, "{name}");
            }
            let mut flags = Mapping::default();
            for (late, channel) in order.into_iter().enumerate() {
                let flag = format!("{channel}={}us", 11.55 * late as f64);
                flags.set_delay(&flag).expect("a delay");
            }
            let mended = reread(&recording, &format!("in-turn-{k}-{name}"), &flags);
            let (audit, timeline) = monitored(&mended, &motor(name));
            assert_eq!(codes(&audit), [], "{name} {k}: {:#?}", audit.findings);
            assert_eq!(
                timeline.verdict(&[]).state,
                VerdictState::Healthy,
                "{name} {k}"
            );
            let ([r1, .., r4], _) = timeline.residual_percent().expect("judged windows");
            // A step of 11.55 us that were left over would show 0.2 % and more in r4.
            assert!(
                r1.abs() < 0.05 && (name != "peer-2k2" || r4.abs() < 0.02),
                "{name} {k}: {r1} {r4}"
            );
        }
    }
}

/// A speed 1 % too high contradicts the power of a motor, wherever its slip says that it generates.
#[test]
fn a_speed_that_makes_a_generator_of_a_motor_is_named() {
    for name in MOTORS {
        for (scale, named) in [(1.0, false), (1.01, true)] {
            let text = "start = \"running\"\nduration_s = 0.6\n[load]\nfriction_percent = 0\n[sensors]\n\
                        noise_sigma_fraction_of_full_scale = 0.0005";
            let recording = recorded(&scenario(name, text));
            let speed = recording
                .speed()
                .expect("a speed")
                .iter()
                .map(|w| scale * w);
            let speed = speed.collect();
            let recording = recording
                .with_channel(Channel::SPEED, speed)
                .expect("as long");
            let (audit, _) = monitored(&recording, &motor(name));
            let implausible = codes(&audit).contains(&Code::SpeedImplausible);
            assert_eq!(implausible, named, "{name} {scale}: {:#?}", audit.findings);
        }
    }
}
