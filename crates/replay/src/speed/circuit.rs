//! The slip that the circuit needs for the measured voltages and currents.

use std::f64::consts::TAU;

use motor::effect::{EffectConfig, SteadyPoint, from_motor_file, rated};
use motor::motor_file::Uncertainty;
use motor::{MotorFile, TParams};
use num_complex::Complex64;
use recording::Recording;

/// Cycles of the supply in one block.
const CYCLES: f64 = 5.0;
/// Currents below this share of the rated one belong to a motor that does not run.
const RUNNING: f64 = 0.05;
/// Slips beyond are no running motor.
const GREATEST_SLIP: f64 = 0.3;
/// The cage is within 45 K of the temperature that its resistance is given for, in 95 of 100 recordings: 0.39 % per kelvin.
const WARM: f64 = 0.18;
/// 95 % of a normal distribution lie within so many standard deviations.
const TWO_SIDED_95: f64 = 1.96;

/// A recording's slip by the circuit.
pub(super) struct CircuitSlip {
    /// Slip at every sample.
    pub slip: Vec<f64>,
    /// Half of the 95 % interval of its mean.
    pub half_width: f64,
    /// Angular frequency of the supply, rad/s, negative for the other order of phases.
    pub omega: f64,
    /// Space vectors of voltages and currents, V and A, mirrored to the positive order of phases.
    pub vectors: [Vec<Complex64>; 2],
    /// Sampling time, s.
    pub step: f64,
}

impl CircuitSlip {
    /// `None` where voltages or currents are missing or the motor does not run.
    pub fn of(recording: &Recording, motor: &MotorFile) -> Option<CircuitSlip> {
        let (voltages, currents) = (recording.voltages()?, recording.currents()?);
        let mut vectors = [voltages, currents].map(space_vectors);
        let step = recording.t_sample();
        let omega = supply(&vectors[0], step, motor.nameplate.omega_sync())?;
        if omega < 0.0 {
            // The circuit knows one order of phases: the other is its mirror image.
            vectors.iter_mut().flatten().for_each(|x| *x = x.conj());
        }
        let [u, i] = &vectors;
        let block = (CYCLES * TAU / omega.abs() / step).round() as usize;
        let effects = from_motor_file(motor, &motor.name).ok()?;
        let phasors: Vec<[Complex64; 2]> = u
            .chunks(block)
            .zip(i.chunks(block))
            .map(|pair| [pair.0, pair.1].map(|x| phasor(x, omega.abs(), step)))
            .collect();
        let circuit = Circuit {
            motor,
            effects: &effects,
            omega: omega.abs(),
        };
        let slips: Vec<Option<f64>> = phasors
            .iter()
            .map(|ui| circuit.slip(&motor.parameters, *ui))
            .collect();
        let known: Vec<f64> = slips.iter().flatten().copied().collect();
        if known.is_empty() || 2 * known.len() < slips.len() {
            return None;
        }
        let mean = known.iter().sum::<f64>() / known.len() as f64;
        let held = held(&slips, mean);
        let slip = (0..u.len()).map(|k| between(&held, k as f64 / block as f64));
        Some(CircuitSlip {
            slip: slip.collect(),
            half_width: circuit.half_width(&phasors),
            omega,
            vectors,
            step,
        })
    }

    /// Mean slip of the recording.
    pub fn mean(&self) -> f64 {
        self.slip.iter().sum::<f64>() / self.slip.len() as f64
    }
}

/// The circuit at one frequency.
struct Circuit<'m> {
    motor: &'m MotorFile,
    effects: &'m [EffectConfig],
    omega: f64,
}

/// Parameters of the circuit that may be uncertain.
const KEYS: [&str; 5] = [
    "stator_resistance_ohm",
    "rotor_resistance_ohm",
    "stator_leakage_henry",
    "rotor_leakage_henry",
    "magnetizing_inductance_henry",
];

impl Circuit<'_> {
    /// `E / I_r = R_r/s + j w L_lr` of the T circuit behind the effects.
    fn slip(&self, parameters: &TParams<f64>, [u, i]: [Complex64; 2]) -> Option<f64> {
        let (motor, omega) = (self.motor, self.omega);
        if i.norm() < RUNNING * motor.nameplate.current_amplitude() {
            return None;
        }
        let mut point = SteadyPoint {
            rated: rated(motor),
            omega_sync: omega,
            omega_mech: omega / f64::from(motor.nameplate.pole_pairs)
                * (1.0 - motor.nameplate.rated_slip()),
            u_s: u,
            i_s: i,
            motor: *parameters,
            tau_extra: 0.0,
        };
        self.effects
            .iter()
            .for_each(|c| c.effect.correct_f64(&c.values, &mut point));
        let m = &point.motor;
        let air_gap = point.u_s - point.i_s * Complex64::new(m.r_s, omega * m.l_ls);
        let rotor = point.i_s - air_gap / Complex64::new(0.0, omega * m.l_m);
        let slip = m.r_r / (air_gap / rotor).re;
        (slip.is_finite() && slip.abs() < GREATEST_SLIP).then_some(slip)
    }

    /// Of the mean slip: what the intervals of the parameters and the cage's temperature leave open.
    fn half_width(&self, phasors: &[[Complex64; 2]]) -> f64 {
        let mean = |parameters: &TParams<f64>| {
            let slips: Vec<f64> = phasors
                .iter()
                .filter_map(|ui| self.slip(parameters, *ui))
                .collect();
            slips.iter().sum::<f64>() / slips.len().max(1) as f64
        };
        let centre = mean(&self.motor.parameters);
        let temperature = WARM * centre.abs();
        let Some(uncertainty) = &self.motor.uncertainty else {
            return temperature;
        };
        let changes: Vec<f64> = (0..KEYS.len())
            .map(|k| {
                let deviation = uncertainty.log_deviation(KEYS[k]).unwrap_or(0.0);
                mean(&moved(&self.motor.parameters, k, deviation)) - centre
            })
            .collect();
        (TWO_SIDED_95 * combined(&changes, uncertainty)).hypot(temperature)
    }
}

/// One parameter changed by a logarithm.
fn moved(parameters: &TParams<f64>, which: usize, logarithm: f64) -> TParams<f64> {
    let mut moved = *parameters;
    let place = [
        &mut moved.r_s,
        &mut moved.r_r,
        &mut moved.l_ls,
        &mut moved.l_lr,
        &mut moved.l_m,
    ];
    if let Some(parameter) = place.into_iter().nth(which) {
        *parameter *= logarithm.exp();
    }
    moved
}

/// Standard deviation of a sum whose parts hang together as the parameters do.
fn combined(changes: &[f64], uncertainty: &Uncertainty) -> f64 {
    let mut square: f64 = 0.0;
    for (a, x) in KEYS.iter().zip(changes) {
        for (b, y) in KEYS.iter().zip(changes) {
            let correlation = if a == b {
                1.0
            } else {
                uncertainty.correlation([a, b])
            };
            square += correlation * x * y;
        }
    }
    square.max(0.0).sqrt()
}

/// Between the middles of two blocks, linearly; `place` in blocks from the start of the first.
pub(super) fn between(values: &[f64], place: f64) -> f64 {
    let at = (place - 0.5).clamp(0.0, (values.len() - 1) as f64);
    let first = at.floor() as usize;
    let second = (first + 1).min(values.len() - 1);
    values[first] + (at - first as f64) * (values[second] - values[first])
}

/// A block without a slip takes that of the block before.
fn held(slips: &[Option<f64>], first: f64) -> Vec<f64> {
    let mut last = first;
    let each = slips.iter().map(|slip| {
        last = slip.unwrap_or(last);
        last
    });
    each.collect()
}

/// Amplitude-invariant space vectors (Clarke).
fn space_vectors([a, b, c]: [&[f64]; 3]) -> Vec<Complex64> {
    let one = |k: usize| {
        Complex64::new(
            (2.0 * a[k] - b[k] - c[k]) / 3.0,
            (b[k] - c[k]) / 3f64.sqrt(),
        )
    };
    (0..a.len()).map(one).collect()
}

/// Angular frequency of the supply, rad/s, negative for the other order of phases: from the turn of the voltage over the
/// recording, by means over one nominal cycle that remove harmonics and the negative sequence.
fn supply(u: &[Complex64], step: f64, nominal: f64) -> Option<f64> {
    let cycle = (TAU / nominal / step).round() as usize;
    if cycle < 10 || u.len() < 4 * cycle {
        return None;
    }
    let direction = u
        .windows(2)
        .map(|pair| (pair[0].conj() * pair[1]).im)
        .sum::<f64>()
        .signum();
    let carrier = direction * nominal;
    let phasors: Vec<Complex64> = u
        .chunks_exact(cycle)
        .enumerate()
        .map(|(k, chunk)| {
            phasor(chunk, carrier, step)
                * Complex64::from_polar(1.0, -carrier * (k * cycle) as f64 * step)
        })
        .collect();
    let turn: Complex64 = phasors
        .windows(2)
        .map(|pair| pair[0].conj() * pair[1])
        .sum();
    let omega = carrier + turn.arg() / (cycle as f64 * step);
    (omega.is_finite() && turn.norm() > 0.0).then_some(omega)
}

/// The phasor of a block that turns with `omega`; its angle refers to the block's first sample.
pub(super) fn phasor(x: &[Complex64], omega: f64, step: f64) -> Complex64 {
    let turned = x.iter().enumerate();
    let sum: Complex64 = turned
        .map(|(k, x)| x * Complex64::from_polar(1.0, -omega * k as f64 * step))
        .sum();
    sum / x.len() as f64
}
