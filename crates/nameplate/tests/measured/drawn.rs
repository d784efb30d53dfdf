//! Random motors as the prior has them: values of motors of a size, a circuit that has these values, and what no plate tells.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use nameplate::circuit::{PARAMETERS, Place};
use nameplate::fit::{PRIOR_SPREAD, Targets, start};
use nameplate::plate::{VALUES, Values};
use nameplate::prior::Prior;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::machine::{Laws, Machine};

/// A motor with its plate's values and the numbers that per unit is a multiple of.
#[derive(Clone, Debug)]
pub struct Motor {
    pub machine: Machine,
    pub power_kw: f64,
    pub volt: f64,
    pub amp: f64,
    pub pole_pairs: u32,
    pub inertia: f64,
    /// Slip, efficiency, power factor, breakdown and locked-rotor torque, locked-rotor current.
    pub values: [f64; VALUES],
}

const FREQUENCY: f64 = 50.0;
/// As the fit has them; but a leakage that does not saturate at all has no knee to draw.
const BOUNDS: [[f64; 2]; PARAMETERS] = {
    let mut bounds = nameplate::fit::BOUNDS;
    bounds[Place::SaturatedLeakage as usize][1] = 0.999;
    bounds
};
type Unknowns = SVector<f64, 11>;

pub fn normal(rng: &mut Pcg64Mcg) -> f64 {
    StandardNormal.sample(rng)
}

pub fn drawn(rng: &mut Pcg64Mcg, laws: Laws) -> Motor {
    loop {
        if let Some(motor) = tried(rng, laws) {
            return motor;
        }
    }
}

fn tried(rng: &mut Pcg64Mcg, laws: Laws) -> Option<Motor> {
    let power_kw = rng.random_range(0.5f64.ln()..500f64.ln()).exp();
    let population = Prior::REAL_MOTORS.of_size(power_kw);
    let factor = population.covariance.cholesky()?.l();
    let values = population.mean + factor * Values::from_fn(|_, _| normal(rng));
    let targets = targets(power_kw, &values)?;
    let centre = start(&targets).logs();
    let mut logs = Unknowns::zeros();
    for k in 0..11 {
        let mut tries = 0;
        logs[k] = loop {
            let x: f64 = centre[k] + PRIOR_SPREAD[k] * normal(rng);
            tries += 1;
            if (BOUNDS[k][0].ln()..BOUNDS[k][1].ln()).contains(&x) {
                break x;
            }
            if tries > 200 {
                return None;
            }
        };
    }
    let pole_pairs = [1, 2, 2, 2, 3][rng.random_range(0..5)];
    let mut hidden = Hidden {
        laws,
        slip: targets.slip,
        rated_torque: targets.rating().torque(),
        saturation: [
            bounded(rng, [-1.386, 0.6], [0.02, 0.8]),
            bounded(rng, [1.946, 0.35], [2.1, 15.0]),
        ],
        bearings: 1.0 / (1.0 + (0.85 - normal(rng)).exp()),
        warm_degc: 335.0 * (0.04 * normal(rng)).exp() - 235.0,
    };
    let machine = hidden.meets(&mut logs, &targets)?;
    let inertia = Prior::REAL_MOTORS.inertia_kg_m2(power_kw, pole_pairs, FREQUENCY);
    let volt = 400.0;
    let motor = Motor {
        power_kw,
        volt,
        amp: 1000.0 * power_kw / (3f64.sqrt() * volt * targets.rating().power),
        pole_pairs,
        inertia: inertia.value * (inertia.log_spread() * normal(rng)).exp(),
        values: [
            targets.slip,
            targets.efficiency,
            targets.power_factor,
            targets.breakdown_torque_ratio,
            targets.locked_rotor_torque_ratio,
            targets.locked_rotor_current_ratio,
        ],
        machine,
    };
    // What a motor file cannot say.
    let [share, ratio] = [truths(&motor)[5], truths(&motor)[6]];
    ((0.001..0.8).contains(&share) && (0.05..4.0).contains(&ratio)).then_some(motor)
}

fn bounded(rng: &mut Pcg64Mcg, [mean, deviation]: [f64; 2], [low, high]: [f64; 2]) -> f64 {
    loop {
        let x = (mean + deviation * normal(rng)).exp();
        if (low..high).contains(&x) {
            return x;
        }
    }
}

/// The values as a plate has them; `None` where nobody would sell the motor.
fn targets(power_kw: f64, values: &Values) -> Option<Targets> {
    let targets = Targets {
        power_kw,
        slip: 0.0,
        slip_half_step: 0.0,
        efficiency: 0.0,
        power_factor: 0.0,
        breakdown_torque_ratio: 0.0,
        locked_rotor_torque_ratio: 0.0,
        locked_rotor_current_ratio: 0.0,
        stator_resistance: None,
        current_ratio: 1.0,
    }
    .with_values(values);
    let sold = (0.45..0.985).contains(&targets.efficiency)
        && (0.45..0.95).contains(&targets.power_factor)
        && targets.slip < 0.8 * (1.0 - targets.efficiency)
        && (0.002..0.12).contains(&targets.slip)
        && targets.breakdown_torque_ratio > 1.4;
    sold.then_some(targets)
}

/// What is no logarithm of the circuit's.
struct Hidden {
    laws: Laws,
    slip: f64,
    rated_torque: f64,
    saturation: [f64; 2],
    bearings: f64,
    warm_degc: f64,
}

impl Hidden {
    fn machine(&self, logs: &Unknowns, rated_air_gap: f64, laws: Laws) -> Machine {
        let p = logs.map(f64::exp);
        Machine {
            laws,
            stator_resistance: p[0],
            leakage: p[1],
            magnetizing: p[2],
            inner_resistance: p[3],
            outer_resistance: p[3] + p[4],
            inner_leakage: p[5],
            core_conductance: p[6],
            windage: p[7],
            stray: p[8],
            saturated_leakage: p[9],
            saturation: self.saturation,
            rated_air_gap,
            bearings: self.bearings,
            warm_degc: self.warm_degc,
            slip: self.slip,
            rated_torque: self.rated_torque,
        }
    }

    /// The machine whose saturation counts from its own rated load.
    fn settled(&self, logs: &Unknowns) -> Machine {
        let mut straight = self.machine(logs, 1.0, Laws::Fitted);
        straight.saturation[0] = 0.0;
        let air_gap = straight.at(1.0, self.slip, 1.0, self.warm_degc).air_gap;
        self.machine(logs, air_gap, self.laws)
    }

    /// Moves the circuit as little as its prior allows until it has the values.
    fn meets(&mut self, logs: &mut Unknowns, targets: &Targets) -> Option<Machine> {
        let wanted = DVector::from_row_slice(&[
            targets.rating().power.ln(),
            targets.reactive().ln(),
            0.0,
            targets.breakdown_torque_ratio.ln(),
            targets.locked_rotor_torque_ratio.ln(),
            targets.locked_rotor_current_ratio.ln(),
        ]);
        let spread = DVector::from_row_slice(&PRIOR_SPREAD[..11]);
        for _ in 0..30 {
            let (here, breakdown) = self.shown(logs, None);
            let error = &wanted - &here;
            if error.amax() < 1e-6 {
                let inside =
                    (0..11).all(|k| (BOUNDS[k][0].ln()..=BOUNDS[k][1].ln()).contains(&logs[k]));
                return inside.then(|| self.settled(logs));
            }
            let mut jacobian = DMatrix::zeros(6, 11);
            for k in 0..11 {
                let mut moved = *logs;
                moved[k] += 1e-5;
                jacobian.set_column(
                    k,
                    &((self.shown(&moved, Some(breakdown)).0 - &here) * (spread[k] / 1e-5)),
                );
            }
            let square: DMatrix<f64> = &jacobian * jacobian.transpose();
            let step = jacobian.transpose() * square.cholesky()?.solve(&error);
            for k in 0..11 {
                logs[k] += (spread[k] * step[k]).clamp(-0.7, 0.7);
            }
        }
        None
    }

    /// Logarithms of power, reactive power, current, and the three ratios; and the breakdown slip, where torque is flat.
    fn shown(&self, logs: &Unknowns, breakdown: Option<f64>) -> (DVector<f64>, f64) {
        let machine = self.settled(logs);
        let rated = machine.at(1.0, self.slip, 1.0, self.warm_degc);
        let cold_degc = logs[10].exp();
        // Both resistances of the cold tests by one factor: the temperature of a copper winding that has it.
        let cold = Machine {
            stator_resistance: machine.stator_resistance * cold_degc,
            inner_resistance: machine.inner_resistance * cold_degc,
            outer_resistance: machine.outer_resistance * cold_degc,
            ..machine.clone()
        };
        let locked = cold.at(1.0, 1.0, 1.0, self.warm_degc);
        let torque = rated.torque.max(1e-6);
        let slip = breakdown.unwrap_or_else(|| cold.breakdown_slip(self.warm_degc));
        let greatest = cold.at(1.0, slip, 1.0, self.warm_degc).torque.max(1e-6);
        let shown = DVector::from_row_slice(&[
            (torque * (1.0 - self.slip)).ln(),
            rated.reactive.ln(),
            rated.current.ln(),
            (greatest / self.rated_torque).ln(),
            (locked.torque / self.rated_torque).ln(),
            (locked.current / rated.current).ln(),
        ]);
        (shown, slip)
    }
}

/// Parameters as a motor file has them, in its order, from the equations and not from the crate.
pub fn truths(motor: &Motor) -> [f64; 15] {
    let m = &motor.machine;
    let ohm = motor.volt / 3f64.sqrt() / motor.amp;
    let omega = std::f64::consts::TAU * FREQUENCY;
    let (r_1, r_2) = (m.inner_resistance, m.outer_resistance);
    let share = r_2 / (r_1 + r_2);
    let lost = 0.1;
    let drop = (1.0 - m.saturated_leakage) / (1.0 - m.saturated_leakage * lost);
    let henry = match m.laws {
        Laws::Fitted => ohm / omega / (1.0 - drop * lost),
        Laws::Others => ohm / omega,
    };
    let rotor_leakage = m.leakage + m.inner_leakage * share * share;
    let [second_resistance, second_leakage] = second_cage(m);
    let [k, n] = m.saturation;
    let grown = k * m.rated_air_gap.powf(-n);
    let speed = omega / f64::from(motor.pole_pairs) * (1.0 - m.slip);
    let torque = 1000.0 * motor.power_kw / speed;
    [
        m.stator_resistance * ohm,
        r_1 * share * ohm,
        m.leakage * henry,
        rotor_leakage * henry,
        ohm / omega / m.susceptance(1.0, 1.0),
        r_1 * share / second_resistance,
        second_leakage / rotor_leakage,
        drop,
        ohm / m.core_conductance,
        m.windage * (1.0 - m.bearings) * torque / (speed * speed),
        m.stray * torque,
        motor.inertia,
        grown / (1.0 - k + grown),
        n,
        m.windage * m.bearings * torque,
    ]
}

/// Resistance and leakage of the faster of two parallel branches with the rotor's impedance, by partial fractions of its admittance.
fn second_cage(m: &Machine) -> [f64; 2] {
    let (x, x_1, r_1, r_2) = (
        m.leakage,
        m.inner_leakage,
        m.inner_resistance,
        m.outer_resistance,
    );
    // Y(p) = (r_1 + r_2 + x_1 p) / (x x_1 p^2 + (x (r_1 + r_2) + r_2 x_1) p + r_1 r_2)
    let matrix = SMatrix::<f64, 2, 2>::new(
        0.0,
        1.0,
        -r_1 * r_2 / (x * x_1),
        -(x * (r_1 + r_2) + r_2 * x_1) / (x * x_1),
    );
    let poles = matrix.eigenvalues().unwrap();
    let [slow, fast] = [poles.max(), poles.min()];
    let residue = (r_1 + r_2 + x_1 * fast) / (x * x_1 * (fast - slow));
    let other = (r_1 + r_2 + x_1 * slow) / (x * x_1 * (slow - fast));
    let branch = |residue: f64, pole: f64| [-pole / residue, 1.0 / residue];
    let both = [branch(residue, fast), branch(other, slow)];
    both[usize::from(both[1][0] > both[0][0])]
}
