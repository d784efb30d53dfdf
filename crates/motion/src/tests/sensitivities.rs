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

/// A motor that really is so: name, motor, place of its sensitivity, relative size.
type Departure = (&'static str, Plant, usize, f64);

fn rotor_resistance() -> Departure {
    let r_r = 1.02 * MOTOR.r_r;
    ("Rr", Plant { r_r, ..MOTOR }, place::R_R, 0.02)
}

fn magnetizing_inductance() -> Departure {
    let l_m = 1.01 * MOTOR.l_m;
    ("Lm", Plant { l_m, ..MOTOR }, place::L_M, 0.01)
}

/// Whether the rows `among` move as the sensitivities say, within a share `tolerance` of the move.
fn check((name, plant, k, size): Departure, among: std::ops::Range<usize>, tolerance: f32) {
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
    let voltages = 0..4;
    let r_s = 1.1 * p.r_s;
    check(
        ("Rs", Plant { r_s, ..p }, place::R_S, 0.1),
        voltages.clone(),
        0.05,
    );
    check(rotor_resistance(), voltages.clone(), 0.08);
    check(magnetizing_inductance(), voltages.clone(), 0.08);
    let [l_ls, l_lr] = [p.l_ls, p.l_lr].map(|l| 1.04 * l);
    let leakage = Plant { l_ls, l_lr, ..p };
    check(
        ("leakage", leakage, place::LEAKAGE, 0.04),
        voltages.clone(),
        0.08,
    );
    let speed_gain = 1.001;
    check(
        ("speed", Plant { speed_gain, ..p }, place::SPEED, 0.001),
        voltages.clone(),
        0.1,
    );
    let late_s = 1e-3;
    check(
        ("late speed", Plant { late_s, ..p }, place::SPEED_LAG, 1e-3),
        voltages.clone(),
        0.15,
    );
    for channel in 0..6 {
        let mut gains = [1.0; 6];
        gains[channel] = 1.02;
        let k = place::VOLTAGE + channel;
        check(
            ("gain", Plant { gains, ..p }, k, 0.02),
            voltages.clone(),
            0.08,
        );
    }
}

#[test]
fn what_departs_moves_the_torque_row_as_the_sensitivities_say() {
    let p = MOTOR;
    let torque = 4..5;
    let inertia = 1.02 * p.inertia;
    check(
        ("J", Plant { inertia, ..p }, place::INERTIA, 0.02),
        torque.clone(),
        0.1,
    );
    let friction = 1.05 * p.friction;
    check(
        ("B", Plant { friction, ..p }, place::FRICTION, 0.05),
        torque.clone(),
        0.1,
    );
    // The rate of the acceleration is that of two cycles, one cycle late.
    let late_s = 2e-3;
    check(
        ("late speed", Plant { late_s, ..p }, place::SPEED_LAG, 2e-3),
        torque.clone(),
        0.35,
    );
    check(rotor_resistance(), torque.clone(), 0.25);
    check(magnetizing_inductance(), torque, 0.25);
}
