//! A calibration from recordings at three loads, each of which had warmed the motor to another temperature.

use crate::common::{in_project, motor};
use motor::motor_file::LoadKind;
use motor::{MotorFile, TParams};
use recording::Recording;
use replay::calibrate::{Calibrated, Surroundings, calibrate};
use scenario::Scenario;
use scenario::simulate::record;

/// Rise of the resistances at rated load, with the square of the load: winding by 31 K, cage by 13 K.
const RISE: [f64; 2] = [0.12, 0.05];

fn machine(kind: LoadKind) -> MotorFile {
    let mut motor = motor("motors/peer-2k2.toml");
    motor.load = kind;
    motor.mechanics.load_friction = 0.0;
    motor
}

/// The resistances at a load, a share of the rated one.
fn warmed(mut parameters: TParams<f64>, load: f64) -> TParams<f64> {
    let [stator, rotor] = RISE.map(|rise| 1.0 + rise * load * load);
    parameters.r_s *= stator;
    parameters.r_r *= rotor;
    parameters
}

fn recorded(load: f64, torque: bool, seed: u32) -> Recording {
    let text = format!(
        "motor = \"motors/peer-2k2.toml\"\nduration_s = 1.6\nstart = \"running\"\nseed = {seed}\nsample_rate_hz = 5000\n\
         [load]\nconstant_percent = {:?}\nfriction_percent = 0\nactive = true\n\
         [sensors]\nnoise_sigma_fraction_of_full_scale = 0.001\ntorque = {torque}\n",
        100.0 * load
    );
    let mut scenario = Scenario::parse(&text, "warm.toml", &in_project(".")).expect("valid");
    scenario.motor.parameters = warmed(scenario.motor.parameters, load);
    record(&scenario, |_| ()).expect("a motor that runs")
}

fn calibrated(kind: LoadKind) -> Calibrated {
    let loads = [(0.1, 1), (0.5, 2), (1.0, 3)];
    let torque = kind == LoadKind::Measured;
    let recordings = loads.map(|(load, seed)| recorded(load, torque, seed));
    let calibrated = calibrate(&machine(kind), &recordings, &Surroundings::default());
    calibrated.expect("healthy")
}

/// The file gets the resistances of the largest load. One temperature for all would leave them off by several of their standard errors.
#[test]
fn parameters_are_right_within_their_errors_whatever_warmed() {
    for kind in [LoadKind::Measured, LoadKind::Free] {
        let calibrated = calibrated(kind);
        let truth = warmed(machine(kind).parameters, 1.0);
        let found = calibrated.motor.parameters;
        let off = [
            found.r_s / truth.r_s,
            found.r_r / truth.r_r,
            found.l_m / truth.l_m,
            (found.l_ls + found.l_lr) / (truth.l_ls + truth.l_lr),
        ];
        for (ratio, (cause, _, error)) in off.into_iter().zip(&calibrated.changes) {
            assert!(
                (ratio - 1.0).abs() < 2.5 * error,
                "{kind:?} {cause:?}: {:+.2} %, +- {:.2} %",
                100.0 * (ratio - 1.0),
                100.0 * error
            );
        }
        let [(_, _, stator), ..] = calibrated.changes[..] else {
            panic!("fitted");
        };
        eprintln!("{kind:?}: stator resistance +- {:.1} %", 100.0 * stator);
        let healthy = calibrated.healthy;
        // Per sample 0.1 % of full scale, hundreds of samples a window; the rest is what the fit leaves.
        assert!(
            healthy.scatter_percent[..3].iter().all(|x| *x < 0.3),
            "{healthy:?}"
        );
    }
}
