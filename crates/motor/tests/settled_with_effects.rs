//! A motor that runs when a recording begins has settled with its effects: its first cycles are those of seconds later.

use motor::effect::{
    Between, EffectConfig, Inputs, Outputs, Plant, Rated, Run, SpeedSource, Timeline, simulate,
};
use motor::effects::ALL;
use motor::{Mechanics, TParams};
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::sync::Arc;

const OMEGA: f64 = TAU * 50.0;
const T_SAMPLE: f64 = 1e-4;
/// Samples of a cycle.
const CYCLE: usize = 200;
/// Shaft speed, rad/s.
const SPEED: f64 = 0.97 * OMEGA / 2.0;

fn rated() -> Rated<f64> {
    Rated {
        voltage: 326.6,
        current: 7.07,
        omega_sync: OMEGA,
        n_p: 2.0,
        torque: 14.6,
    }
}

fn plant(effects: Vec<EffectConfig>) -> Plant {
    Plant {
        motor: TParams {
            r_s: 3.7,
            r_r: 2.3,
            l_ls: 0.0107,
            l_lr: 0.0107,
            l_m: 0.234,
        },
        mechanics: Mechanics {
            n_p: 2.0,
            inertia: 0.015,
            friction: 0.001,
            load_friction: 0.0,
        },
        rated: rated(),
        effects,
    }
}

/// Three seconds on mains with 2 % negative sequence and 3 % of the fifth harmonic, at a given speed.
fn run(plant: &Plant) -> Outputs {
    let n = 150 * CYCLE + 1;
    let turn =
        |order: f64, k: usize| Complex64::from_polar(1.0, order * OMEGA * T_SAMPLE * k as f64);
    let u = |k: usize| 326.6 * (turn(1.0, k) + 0.02 * turn(-1.0, k) + 0.03 * turn(-5.0, k));
    let inputs = Inputs {
        t_sample: T_SAMPLE,
        u_s: (0..n).map(u).collect(),
        tau_load: vec![0.0; n],
    };
    simulate(
        plant,
        &Run {
            inputs: &inputs,
            between: Between::Smooth,
            speed: SpeedSource::Imposed(&vec![SPEED; n]),
            timeline: &Arc::new(Timeline::constant(OMEGA)),
            running_at: Some(SPEED),
            running_at_cuts: &[],
            open: &[],
        },
    )
}

/// Largest difference between the second cycle and the last, A.
fn unsettled(outputs: &Outputs) -> f64 {
    let cycle = CYCLE / 2;
    let (early, late) = (
        &outputs.i_s_abc[cycle..],
        &outputs.i_s_abc[outputs.i_s_abc.len() - 1 - cycle..],
    );
    let apart = |(a, b): (&[f64; 3], &[f64; 3])| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
    early
        .iter()
        .zip(late)
        .take(cycle)
        .map(apart)
        .fold(0.0, f64::max)
}

#[test]
fn a_running_motor_has_settled_with_each_effect() {
    // Of a current of 7 A: a step of 0.2 ms integrates the fifth harmonic to this.
    let linear = unsettled(&run(&plant(Vec::new())));
    assert!(linear < 0.02, "{linear}");
    let other = [
        // Goes on for seconds, or is no matter of a supply's cycle.
        "stator-heating",
        "rotor-heating",
        "load-pulsation",
        "shaft-compliance",
        "rotor-asymmetry",
    ];
    for effect in ALL {
        let d = effect.descriptor();
        // The second cage has a flux of its own, which the few cycles do not settle.
        if other.contains(&d.name) || d.form == "double-cage" {
            continue;
        }
        let left = unsettled(&run(&plant(vec![EffectConfig::typical(*effect, &rated())])));
        assert!(left < 0.02, "{} {}: {left} A", d.name, d.form);
    }
}
