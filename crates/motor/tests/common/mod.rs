//! The motor that tests of simulated plants share.

use motor::effect::{Plant, Rated};
use motor::{Mechanics, TParams};
use std::f64::consts::TAU;

/// Supply, rad/s.
pub const OMEGA: f64 = TAU * 50.0;
/// Sampling time, s.
pub const T_SAMPLE: f64 = 1e-4;

/// A 2.2 kW motor of four poles without effects.
pub fn plant() -> Plant {
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
        rated: Rated {
            voltage: 326.6,
            current: 7.07,
            omega_sync: OMEGA,
            n_p: 2.0,
            torque: 14.6,
        },
        effects: Vec::new(),
    }
}
