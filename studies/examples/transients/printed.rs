//! (36) as printed beside its integral form: what a healthy transient shows of each, as multiples of the steady threshold.

use motor::MotorFile;
use motor::motor_file::Frame;
use scenario::simulate::Simulation;

use crate::judge::judge;
use crate::motor;
use studies::drive::{Doubts, Drive, Run, run};

/// Steady threshold of r1, share of the voltage.
const THRESHOLD: f64 = 0.006;
const MOTORS: [&str; 3] = ["assumed-300w-calibrated", "peer-2k2-calibrated", "imc-18k5"];
const SHOWN: [Drive; 6] = [
    Drive::DirectStart,
    Drive::StarDelta,
    Drive::LoadStep,
    Drive::Press,
    Drive::Dip,
    Drive::FrequencyRamp,
];

/// Exact parameters; each cell: row 1 of (36) with true signals, and E+ and E- with the instrument's noise.
pub fn table(draws: u64) {
    let exact = Doubts {
        wrong: 0.0,
        bends: false,
        ..Doubts::USUAL
    };
    println!("| transient | {} |", MOTORS.join(" | "));
    println!("|---|{}", "---|".repeat(MOTORS.len()));
    for drive in SHOWN {
        let cells = MOTORS.map(|name| {
            let believed = motor(name);
            let mut sums = [0.0; 2];
            for k in 0..draws {
                let run = run(&believed, drive, &exact, None, 70_000 + k);
                sums[0] += printed_square(&believed, &run) / draws as f64;
                sums[1] += integral_square(&believed, &run, &exact) / draws as f64;
            }
            let [printed, integral] = sums.map(|sum| sum.sqrt() / THRESHOLD);
            format!("{printed:.1}, {integral:.2}")
        });
        println!("| {} | {} |", drive.name(), cells.join(" | "));
    }
}

/// Mean square of `R_a I_q + Psi w_r + L_a dI_q/dt - V_q` over the voltage, in the rotor flux's frame, once there is flux.
fn printed_square(believed: &MotorFile, run: &Run) -> f64 {
    let p = &believed.parameters;
    let (n_p, volt) = (
        believed.mechanics.n_p,
        believed.nameplate.phase_voltage_amplitude(),
    );
    let simulation = Simulation::new(&run.scenario).expect("it ships");
    let seen = simulation
        .filter(|sample| sample.t > run.on_s + 0.04)
        .map(|sample| {
            let theta = sample.truth.theta(Frame::RotorFlux);
            let turn =
                |x: [f64; 3]| motor::dynamic::clarke(x) * num_complex::Complex64::cis(-theta);
            let (i, u) = (turn(sample.truth.i_s_abc), turn(sample.truth.u_s_abc));
            (i, u.im, n_p * sample.truth.omega_mech)
        });
    let seen: Vec<_> = seen.collect();
    let step = 2.0 * run.scenario.t_sample();
    let rows = seen.windows(3).map(|window| {
        let [(before, _, _), (i, u_q, omega), (after, _, _)] = *window else {
            return 0.0;
        };
        let rate = (after.im - before.im) / step;
        let row = p.r_a() * i.im + p.l_s() * i.re * omega + p.l_a() * rate - u_q;
        (row / volt).powi(2)
    });
    rows.sum::<f64>() / seen.len().max(1) as f64
}

fn integral_square(believed: &MotorFile, run: &Run, doubts: &Doubts) -> f64 {
    let outcome = judge(believed, run, doubts, false).expect("it ships");
    let rows = outcome.rows.iter().filter(|(_, judged)| *judged);
    let (n, sum) = rows.fold((0.0, 0.0), |(n, sum), (rows, _)| {
        let square: f64 = rows[..4].iter().map(|x| f64::from(*x).powi(2)).sum();
        (n + 4.0, sum + square)
    });
    sum / f64::max(n, 1.0)
}
