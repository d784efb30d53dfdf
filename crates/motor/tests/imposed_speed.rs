//! A measured speed that drives the model: an instrument's lateness is undone before it does.

use motor::effect::{
    Between, Cut, EffectConfig, Inputs, Outputs, Plant, Rated, Run, SpeedSource, Timeline, simulate,
};
use motor::{Mechanics, TParams};
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::sync::Arc;

const OMEGA: f64 = TAU * 50.0;
const T_SAMPLE: f64 = 1e-4;
/// Lateness of the instrument, s: half the window of an encoder's counts.
const DELAY: f64 = 0.005;

fn plant(delay_s: Option<f64>) -> Plant {
    let rated = Rated {
        voltage: 326.6,
        current: 7.07,
        omega_sync: OMEGA,
        n_p: 2.0,
        torque: 14.6,
    };
    let late = |delay_s: f64| {
        let effect = motor::effects::find("speed-delay", "").expect("in the library");
        let mut config = EffectConfig::absent(effect, &rated);
        config.values[0] = delay_s;
        config
    };
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
        effects: delay_s.map(late).into_iter().collect(),
        rated,
    }
}

/// A start and two steps of the load, 0.8 s.
fn inputs() -> Inputs {
    let n = 8001;
    let u = |k: usize| Complex64::from_polar(326.6, OMEGA * T_SAMPLE * k as f64);
    let load = |k: usize| if (4000..6000).contains(&k) { 15.0 } else { 2.0 };
    Inputs {
        t_sample: T_SAMPLE,
        u_s: (0..n).map(u).collect(),
        tau_load: (0..n).map(load).collect(),
    }
}

fn run(plant: &Plant, speed: SpeedSource<'_>, timeline: Timeline) -> Outputs {
    let cuts = vec![Some(0.0); timeline.cuts.len()];
    simulate(
        plant,
        &Run {
            inputs: &inputs(),
            between: Between::Held,
            speed,
            timeline: &Arc::new(timeline),
            running_at: None,
            running_at_cuts: &cuts,
            open: &[],
        },
    )
}

/// Largest difference of a phase current, A, from `from` on.
fn apart(a: &Outputs, b: &Outputs, from: usize) -> f64 {
    let rows = a.i_s_abc.iter().zip(&b.i_s_abc).skip(from);
    rows.map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f64::max)
}

#[test]
fn a_late_speed_drives_the_motor_as_the_true_one_does() {
    let steady = || Timeline::constant(OMEGA);
    let free = run(&plant(None), SpeedSource::Free, steady());
    let samples = (DELAY / T_SAMPLE) as usize;
    let late: Vec<f64> = std::iter::repeat_n(0.0, samples)
        .chain(free.omega_mech.iter().copied())
        .take(free.omega_mech.len())
        .collect();
    let believed = run(&plant(None), SpeedSource::Imposed(&late), steady());
    let undone = run(&plant(Some(DELAY)), SpeedSource::Imposed(&late), steady());
    // Currents of a start of 60 A: the last 5 ms are not known and held, and no start is there.
    assert!(apart(&free, &believed, 0) > 5.0);
    assert!(
        apart(&free, &undone, 0) < 0.05,
        "{}",
        apart(&free, &undone, 0)
    );
}

/// The end of a stretch does not see the beginning of the next one.
#[test]
fn a_cut_is_not_looked_across() {
    let cut = |sample| Timeline {
        cuts: vec![Cut {
            sample,
            t: 0.0,
            is_new: false,
        }],
        omega_sync: vec![OMEGA; 8001],
        ..Timeline::constant(OMEGA)
    };
    let speed: Vec<f64> = (0..8001)
        .map(|k| if k < 4000 { 150.0 } else { 0.0 })
        .collect();
    let imposed = |plant: &Plant| run(plant, SpeedSource::Imposed(&speed), cut(4000));
    assert_eq!(
        imposed(&plant(Some(DELAY))).i_s_abc,
        imposed(&plant(None)).i_s_abc
    );
}
