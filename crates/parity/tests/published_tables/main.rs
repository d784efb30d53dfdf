//! The residual tables of the theory (sections 4 to 6), recomputed to their printed digits.
//!
//! Formulas (37) are written out here, independently of the monitor core.

mod full_motor;
mod linear_plant;

use motor::{MotorFile, TParams};
use num_complex::Complex64;
use std::path::Path;

/// The tables were computed with the rated 220 V, 179.629 V of phase amplitude, rounded to this.
const TABLE_VOLT: f64 = 179.6;

/// Half a unit of the second printed digit; the little more is for values printed from a tie.
const TWO_DIGITS: f64 = 0.005_2;
/// Half a unit of the first printed digit.
const ONE_DIGIT: f64 = 0.051;

/// The set of the theory, and the motor file's default: each must give the published patterns.
fn threshold_sets() -> [[f64; 4]; 2] {
    [[0.6, 3.0, 4.0, 0.3], motor().monitor.threshold_percent]
}

fn motor() -> MotorFile {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../motors/assumed-300w.toml");
    MotorFile::read(path).expect("shipped")
}

/// What the monitor measures, as numbers in its d-q frame.
#[derive(Clone, Copy)]
struct Measured {
    u: Complex64,
    i: Complex64,
    omega_el: f64,
    omega_sync: f64,
}

/// (37) in percent of `|V|`, `B_t w_s`, `B_t |V|` and `K_f N_p |V|`, with field current `i_f`.
fn residuals(p: &TParams<f64>, n_p: f64, b_t: f64, i_f: f64, m: Measured) -> [f64; 4] {
    let psi = p.l_s() * i_f;
    let k_f = 1.5 * n_p * p.l_m * p.l_m / p.l_r() * i_f;
    let (v_q, i_q, w_r) = (m.u.im, m.i.im, m.omega_el);
    let sum = psi * k_f * n_p + p.r_a() * b_t;
    let r = [
        p.r_a() * i_q + psi * w_r - v_q, // (37)
        -k_f * n_p * i_q + b_t * w_r,    // (37)
        sum * i_q - b_t * v_q,           // (37)
        sum * w_r - k_f * n_p * v_q,     // (37)
    ];
    let v = m.u.norm();
    let scale = [v, b_t * m.omega_sync, b_t * v, k_f * n_p * v];
    std::array::from_fn(|k| 100.0 * r[k] / scale[k])
}

fn lamps(r: [f64; 4], thresholds: [f64; 4]) -> String {
    r.iter()
        .zip(thresholds)
        .map(|(r, limit)| if r.abs() > limit { '1' } else { '0' })
        .collect()
}

fn assert_row(name: &str, ours: [f64; 4], printed: [(f64, f64); 4]) {
    for (k, (value, tolerance)) in printed.into_iter().enumerate() {
        assert!(
            (ours[k] - value).abs() <= tolerance,
            "{name} r{}: computed {:.4}, printed {value}",
            k + 1,
            ours[k]
        );
    }
}

/// Table 1 of the paper: r1 r2 r3 r4 of each fault, the same for +50 % and -50 %.
const TABLE_1: [(&str, &str); 9] = [
    ("Rs", "1001"),
    ("Rr", "1001"),
    ("Ls", "1011"),
    ("Lr", "1111"),
    ("B", "0111"),
    ("Bl", "0111"),
    ("Iq", "1110"),
    ("Vq", "1011"),
    ("wr", "1101"),
];
