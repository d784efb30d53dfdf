//! Noise of the samples as they show it themselves, and what it and the model's known weaknesses do to the rows.

use num_complex::Complex32;

use crate::circuit::Circuit;
use crate::departures::{Priors, place};
use crate::influence::SKIN_SLIP;
use crate::information::{ROWS, White};
use crate::rows::{Q, Rows};

/// Third differences of a signal: those of a sinusoid sampled 200 times a cycle are 3e-5 of its amplitude, those of white noise
/// have 20 times its variance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Roughness {
    last: [Complex32; 3],
    sum: f32,
}

/// Variance of third differences of white noise: 1 + 9 + 9 + 1.
const THIRD_DIFFERENCES: f32 = 20.0;

impl Roughness {
    #[inline]
    fn add(&mut self, x: Complex32) {
        let [value, first, second] = self.last;
        let (d1, d2) = (x - value, x - value - first);
        let d3 = d2 - second;
        self.last = [x, d1, d2];
        self.sum += d3.norm_sqr();
    }

    /// Variance of one component of the space vector; forgets the sum.
    fn take(&mut self, samples: f32) -> f32 {
        let sum = core::mem::take(&mut self.sum);
        sum / (2.0 * THIRD_DIFFERENCES * samples.max(1.0))
    }
}

/// Noise of voltage and current over a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scatter {
    voltage: Roughness,
    current: Roughness,
    /// Current of the cycle before, share of rated.
    before: f32,
    /// Skin effect and bent leakage that the rotor flux still remembers, shares of what they can be.
    skin: f32,
    high: f32,
}

/// What the scatter of one cycle's rows depends on besides noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circumstances {
    /// Samples in the cycle.
    pub samples: f32,
    /// Slip, share of rated supply frequency, and share of the present one.
    pub slip: [f32; 2],
    /// Length of the current vector, A.
    pub current: f32,
    /// Rotor flux at the end of the cycle, V s.
    pub flux: f32,
    /// How far the resistances' common rise may be from the one that the rows are taken at, or was lately, squared.
    pub heating_square: f32,
    /// By how much the speed may be late, s.
    pub late_s: f32,
}

/// Scatter that stays of E+ and E- without any noise: the encoder's steps.
const VOLTAGE_FLOOR: f32 = 5e-4;
/// The same of `I_0` and `V_0`, shares of rated.
const ZERO_FLOOR: f32 = 2e-4;
/// Share of a step from one cycle to the next that lies in no row as the model has it.
const STEP_SHARE: f32 = 3e-3;
/// Share of the leakage's drop at high current that no shape explains.
const HIGH_CURRENT_SHARE: f32 = 0.03;
/// Squared current, share of rated, that counts as high.
const HIGH_CURRENT: f32 = 9.0;
/// Share of the rotor's resistance at high slip that no shape explains, where all of the skin effect has come.
const SKIN_SHARE: f32 = 0.07;
/// Share of the inertia's torque that a step within a cycle leaves open.
const ACCELERATION_SHARE: f32 = 0.02;
/// Share of a late speed that no delay explains.
const LATE_SHARE: f32 = 0.5;
/// Standard deviation of a row that says nothing.
const SILENT: f32 = 1e6;

impl Scatter {
    /// Adds one instant.
    #[inline]
    pub fn add(&mut self, u: Complex32, i: Complex32) {
        self.voltage.add(u);
        self.current.add(i);
    }

    /// The rows in units of their noise, departures in units of their priors.
    #[inline(never)]
    pub fn whiten(
        &mut self,
        circuit: &Circuit,
        priors: &Priors,
        rows: &Rows,
        now: &Circumstances,
    ) -> White {
        let deviations = self.deviations(circuit, rows, now);
        let mut white = White::default();
        let places = white.sensitivities.iter_mut().zip(&mut white.rows);
        let given = rows.sensitivities.iter().zip(rows.rows).zip(deviations);
        for ((place, row), ((sensitivities, x), s)) in places.zip(given) {
            *row = x / s;
            for ((a, x), prior) in place.iter_mut().zip(sensitivities).zip(priors.0) {
                *a = x * prior / s;
            }
        }
        white
    }

    /// Standard deviations of the rows.
    fn deviations(&mut self, circuit: &Circuit, rows: &Rows, now: &Circumstances) -> [f32; ROWS] {
        let n = now.samples.max(1.0);
        let noise = [self.voltage.take(n), self.current.take(n)];
        let current = now.current / circuit.rated.current;
        let step = current - core::mem::replace(&mut self.before, current);
        self.remember(circuit, now, current);
        let e = self.of_voltages(circuit, rows, now, noise, [current, step]);
        let q = self.of_torque(circuit, rows, now, noise, current);
        // A component of the space vector has two thirds of a channel's variance, a zero sequence a third, and the
        // demodulated one half of that.
        let zero =
            |variance: f32, scale: f32| processor::sqrtf(0.25 * variance / n) / scale + ZERO_FLOOR;
        let [of_u, of_i] = noise;
        let i_0 = zero(of_i, circuit.rated.current);
        let v_0 = zero(of_u, circuit.rated.voltage);
        [e, e, e, e, q, i_0, i_0, v_0, v_0]
    }

    /// What the rotor flux remembers of high current and high slip.
    fn remember(&mut self, circuit: &Circuit, now: &Circumstances, current: f32) {
        let keep = libm::expf(-now.samples * circuit.t_sample / circuit.rotor_time());
        let square = current * current;
        self.high = (square / (square + HIGH_CURRENT)).max(keep * self.high);
        let [rated, present] = now.slip.map(skin_of);
        self.skin = rated.max(present).max(keep * self.skin);
    }

    /// Of each component of E+ and E-.
    fn of_voltages(
        &self,
        circuit: &Circuit,
        rows: &Rows,
        now: &Circumstances,
        [of_u, of_i]: [f32; 2],
        [current, step]: [f32; 2],
    ) -> f32 {
        let n = now.samples.max(1.0);
        let rated = &circuit.rated;
        let [slip, _] = now.slip;
        let z = circuit.impedance(if slip > 0.0 { slip.min(2.0) } else { 0.0 });
        let end = processor::sqrtf(2.0 * of_i) * circuit.params.l_a() / (n * circuit.t_sample);
        let turn = rows.acceleration * n * circuit.t_sample * circuit.mechanics.n_p / rated.omega;
        let length = |k: usize| {
            let squares = (0..Q).map(|row| sensitivity(rows, row, k));
            processor::sqrtf(0.5 * squares.map(|x| x * x).sum::<f32>())
        };
        norm(&[
            processor::sqrtf((of_u + z * z * of_i) / n) / rated.voltage,
            // What the ends of the cycle leave of the current's noise.
            end / rated.voltage,
            VOLTAGE_FLOOR,
            STEP_SHARE * step,
            STEP_SHARE * turn,
            STEP_SHARE * current * self.high,
            HIGH_CURRENT_SHARE * self.high * length(place::LEAKAGE),
            SKIN_SHARE * self.skin * length(place::R_R),
            // What is of second order in a temperature that is not known yet.
            now.heating_square * length(place::HEATING),
            // A filter is no pure delay, and a long one no first order.
            LATE_SHARE * now.late_s * length(place::SPEED_LAG),
        ])
    }

    /// Of Q.
    fn of_torque(
        &self,
        circuit: &Circuit,
        rows: &Rows,
        now: &Circumstances,
        [_, of_i]: [f32; 2],
        current: f32,
    ) -> f32 {
        if !rows.has_torque {
            return SILENT;
        }
        let rated = &circuit.rated;
        let column = |k: usize| sensitivity(rows, Q, k);
        let lever = 1.5 * circuit.mechanics.n_p * now.flux / rated.torque;
        let inertia = circuit.mechanics.inertia * rows.acceleration / rated.torque;
        let leakage = column(place::LEAKAGE).abs() + column(place::R_R).abs() + 0.1;
        // The three cycles of the torque's row are shared with two others.
        SQRT_3
            * norm(&[
                STEP_SHARE,
                lever * processor::sqrtf(of_i / now.samples.max(1.0)),
                ACCELERATION_SHARE * inertia,
                HIGH_CURRENT_SHARE * self.high * current,
                HIGH_CURRENT_SHARE * self.high * leakage,
                SKIN_SHARE * self.skin * column(place::R_R),
                now.heating_square * column(place::HEATING),
                LATE_SHARE * now.late_s * column(place::SPEED_LAG),
            ])
    }
}

const SQRT_3: f32 = 1.732_050_8;

fn sensitivity(rows: &Rows, row: usize, k: usize) -> f32 {
    let row = rows.sensitivities.get(row);
    row.and_then(|row| row.get(k)).copied().unwrap_or_default()
}

/// Skin effect beyond which resistances tell the cage's depth and not its temperature, share of what it can be.
const DEEP: f32 = 0.3;

impl Scatter {
    /// Whether the rotor flux still remembers a high slip.
    pub fn remembers_slip(&self) -> bool {
        self.skin > DEEP
    }
}

/// Share of the skin effect at a slip, as the shape has it.
fn skin_of(slip: f32) -> f32 {
    slip * slip / (slip * slip + SKIN_SLIP)
}

fn norm(parts: &[f32]) -> f32 {
    processor::sqrtf(parts.iter().map(|x| x * x).sum())
}
