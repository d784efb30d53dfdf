//! Sensitivities against an independently integrated motor that really is so.

use super::plant::{MOTOR, Plant, State};
use super::{Motion, MotionSample, MotionState, believed};
use crate::departures::{UNKNOWNS, place};

/// Rows of a cycle and their sensitivities to departures of size 1.
type Cycle = ([f32; 9], [[f32; UNKNOWNS]; 9]);

/// Runs the samples; what the last closed cycle's rows would be made of is taken from the state before it closes.
fn rows(motion: &Motion, samples: &[(MotionSample, State)]) -> Vec<Cycle> {
    let mut state = MotionState::default();
    let mut all = Vec::new();
    for (sample, _) in samples {
        let mut ahead = state;
        if motion.update(&mut ahead, sample).is_some() {
            // The sums that the cycle ends with: one sample further, but not closed.
            let open = Motion {
                samples: motion.samples + 0.5,
                part: 1.0,
                ..*motion
            };
            let mut summed = state;
            open.update(&mut summed, sample);
            let c = summed.coefficients.expect("running");
            let rows = summed.sums.rows(&motion.circuit, &c, &mut summed.past);
            all.push((rows.rows, rows.sensitivities));
        }
        state = ahead;
    }
    all
}

fn check(
    name: &str,
    plant: Plant,
    k: usize,
    size: f64,
    among: std::ops::Range<usize>,
    tolerance: f32,
) {
    let motion = believed(&MOTOR);
    let departed = rows(&motion, &plant.run(1.0, 1));
    let (mut error, mut length) = (0.0, 0.0);
    for (moved, a) in departed.iter().skip(3) {
        for row in among.clone() {
            let expected = -a[row][k] * size as f32;
            error += (moved[row] - expected).powi(2);
            length += expected.powi(2);
        }
    }
    let (error, length) = (error.sqrt(), length.sqrt());
    assert!(length > 1e-4, "{name} moves nothing");
    assert!(
        error < tolerance * length,
        "{name}: off by {} of {length}",
        error / length
    );
}

/// A start and the run after it with a departure of the size that a linear answer allows; tolerances are what second order and
/// the millisecond's steps leave.
#[test]
fn what_departs_moves_the_rows_as_the_sensitivities_say() {
    let p = MOTOR;
    check(
        "Rs",
        Plant {
            r_s: 1.1 * p.r_s,
            ..p
        },
        place::R_S,
        0.1,
        0..4,
        0.05,
    );
    check(
        "Rr",
        Plant {
            r_r: 1.02 * p.r_r,
            ..p
        },
        place::R_R,
        0.02,
        0..4,
        0.08,
    );
    check(
        "Lm",
        Plant {
            l_m: 1.01 * p.l_m,
            ..p
        },
        place::L_M,
        0.01,
        0..4,
        0.08,
    );
    let leakage = Plant {
        l_ls: 1.04 * p.l_ls,
        l_lr: 1.04 * p.l_lr,
        ..p
    };
    check("leakage", leakage, place::LEAKAGE, 0.04, 0..4, 0.08);
    check(
        "speed",
        Plant {
            speed_gain: 1.001,
            ..p
        },
        place::SPEED,
        0.001,
        0..4,
        0.1,
    );
    for channel in 0..6 {
        let mut gains = [1.0; 6];
        gains[channel] = 1.02;
        let k = place::VOLTAGE + channel;
        check("gain", Plant { gains, ..p }, k, 0.02, 0..4, 0.08);
    }
}

#[test]
fn what_departs_moves_the_torque_row_as_the_sensitivities_say() {
    let p = MOTOR;
    check(
        "J",
        Plant {
            inertia: 1.02 * p.inertia,
            ..p
        },
        place::INERTIA,
        0.02,
        4..5,
        0.1,
    );
    check(
        "B",
        Plant {
            friction: 1.05 * p.friction,
            ..p
        },
        place::FRICTION,
        0.05,
        4..5,
        0.1,
    );
    check(
        "Rr",
        Plant {
            r_r: 1.02 * p.r_r,
            ..p
        },
        place::R_R,
        0.02,
        4..5,
        0.25,
    );
    check(
        "Lm",
        Plant {
            l_m: 1.01 * p.l_m,
            ..p
        },
        place::L_M,
        0.01,
        4..5,
        0.25,
    );
}
