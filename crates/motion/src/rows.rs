//! One cycle's sums, the nine rows that follow from them, and how each departure moves them.
//!
//! ```text
//! E+ = sum d_k e^{-j theta}/(N T U_n)        E- = sum d_k e^{+j theta}/(N T U_n)
//! t  = (S2_1 + S0_2 + 2 S1_2 - 2 S2_2 + S0_3 - 2 S1_3 + S2_3)/2                  quadratic B-spline over three cycles, area 1
//! Q  = (t - B_t (A_3 - A_1)/(2 N T) - J (A_3 - 2 A_2 + A_1)/(N T)^2)/T_n
//! ```
//!
//! `A` is the mean angle of a cycle, `S0 S1 S2` moments of the torque over it. E+ and E- are zero for any angle `theta` and
//! any length of the window: a wrong angle turns a row, but leaves no bias.

use monitor::magnitude;
use num_complex::Complex32;

use crate::circuit::{Circuit, Coefficients, PHASES};
use crate::departures::{FLUX_PLACES, UNKNOWNS, place};
use crate::influence::Moved;
use crate::information::{ROWS, Vector};
use crate::observer::{Instant, Interval};

/// Clarke's transform of one phase alone: two thirds of its axis.
const CLARKE: f32 = 2.0 / 3.0;

/// Places of the rows.
pub const E: usize = 0;
/// The torque's row.
pub const Q: usize = 4;
/// `I_0`, real and imaginary part.
pub const I_0: usize = 5;
/// `V_0`, real and imaginary part.
pub const V_0: usize = 7;

/// Sums over one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sums {
    /// Sampling intervals.
    pub samples: f32,
    /// `sum d e^{-j theta}` and `sum d e^{+j theta}`, V s.
    pub unexplained: [Complex32; 2],
    /// `sum x e^{-j theta}` of voltages a, b, c, then currents a, b, c.
    pub channels: [Complex32; 6],
    /// Sum of the weights, and of the zero sequences of current and voltage.
    weight: Complex32,
    zero: [f32; 2],
    /// Moments of the torque balance, N m.
    moments: [f32; 3],
    /// Sum of the measured torque, N m.
    tau_load: f32,
    /// Angle since the cycle's beginning, mechanical rad, and its sum.
    angle: f32,
    angle_sum: f32,
    /// Sum of the squared current vector, A2.
    pub square: f32,
    /// What the departures of the rotor flux move.
    pub moved: Moved,
}

/// The torque's share of one cycle, with its angles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Turned {
    moments: [f32; 3],
    /// Mean angle since the cycle's beginning, and the angle at its end.
    mean: f32,
    end: f32,
    sensitivities: [f32; UNKNOWNS],
}

/// The two cycles before the latest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Past {
    cycles: [Turned; 2],
    known: u8,
    /// Acceleration of the latest three cycles, mechanical rad/s2.
    acceleration: f32,
}

/// Rows of one cycle with their sensitivities to departures of size 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rows {
    /// Rows.
    pub rows: [f32; ROWS],
    /// What each departure moves.
    pub sensitivities: [Vector; ROWS],
    /// Acceleration, mechanical rad/s2; 0 while it is not known.
    pub acceleration: f32,
    /// Whether the torque's row says something.
    pub has_torque: bool,
}

impl Sums {
    /// Adds one interval.
    #[inline]
    pub fn add(&mut self, circuit: &Circuit, c: &Coefficients, now: &Instant, interval: &Interval) {
        let (d, g) = (interval.unexplained, interval.weight);
        let [forward, backward] = &mut self.unexplained;
        *forward += d * g;
        *backward += d * g.conj();
        for (sum, x) in self.channels.iter_mut().zip(interval.channels) {
            *sum += g * x;
        }
        let [u_a, u_b, u_c, i_a, i_b, i_c] = interval.channels;
        self.weight += g;
        let [current, voltage] = &mut self.zero;
        *current += i_a + i_b + i_c;
        *voltage += u_a + u_b + u_c;
        self.add_torque(circuit, c, now, interval);
        self.square += interval.i.norm_sqr();
        self.samples += 1.0;
    }

    /// `tau = 3/2 p k_r Im(conj(psi_r) i) - tau_load` and the shaft's angle.
    #[inline]
    fn add_torque(
        &mut self,
        circuit: &Circuit,
        c: &Coefficients,
        now: &Instant,
        interval: &Interval,
    ) {
        let n_p = circuit.mechanics.n_p;
        let tau_e = 1.5 * n_p * c.k_r * (interval.psi_r.conj() * interval.i).im;
        let tau = tau_e - now.tau_load;
        let x = self.samples + 0.5;
        let [s0, s1, s2] = &mut self.moments;
        *s0 += tau;
        *s1 += tau * x;
        *s2 += tau * x * x;
        self.tau_load += now.tau_load;
        self.angle += now.turned / n_p;
        self.angle_sum += self.angle;
    }

    /// Zero sequence of currents or voltages at the supply's frequency, free of offsets.
    fn zero(&self, [a, b, c]: [Complex32; 3], sum: f32) -> Complex32 {
        let n = self.samples.max(1.0);
        (a + b + c - self.weight * (sum / n)) / (3.0 * n)
    }

    /// Space vectors of voltages (0) or currents (3) turned by `e^{-j theta}` and by `e^{+j theta}`, means.
    pub fn sequences(&self, first: usize) -> [Complex32; 2] {
        let phases = self.channels.iter().skip(first).take(3);
        let mut sums = [Complex32::ZERO; 2];
        for (x, axis) in phases.zip(PHASES) {
            let [forward, backward] = &mut sums;
            *forward += x * axis * CLARKE;
            *backward += x.conj() * axis * CLARKE;
        }
        sums.map(|sum| sum / self.samples.max(1.0))
    }

    /// Amplitudes of the six channels.
    pub fn amplitudes(&self) -> [f32; 6] {
        let scale = 2.0 / self.samples.max(1.0);
        self.channels.map(|x| scale * magnitude(x))
    }

    /// Length of the current vector, root mean square, A.
    pub fn current(&self) -> f32 {
        processor::sqrtf(self.square / self.samples.max(1.0))
    }

    /// Angle that the rotor turned, electrical rad.
    pub fn turned(&self, n_p: f32) -> f32 {
        self.angle * n_p
    }

    /// The rows of this cycle.
    #[inline(never)]
    pub fn rows(&self, circuit: &Circuit, c: &Coefficients, past: &mut Past) -> Rows {
        let mut rows = Rows {
            rows: [0.0; ROWS],
            sensitivities: [[0.0; UNKNOWNS]; ROWS],
            acceleration: 0.0,
            has_torque: false,
        };
        self.voltage_rows(circuit, c, &mut rows);
        self.zero_rows(circuit, &mut rows);
        self.torque_row(circuit, past, &mut rows);
        for row in &mut rows.sensitivities {
            let together = row.first().unwrap_or(&0.0) + row.get(place::R_R).unwrap_or(&0.0);
            set(row, place::HEATING, together);
        }
        rows
    }

    fn voltage_rows(&self, circuit: &Circuit, c: &Coefficients, rows: &mut Rows) {
        let n = self.samples.max(1.0);
        let per_flux = 1.0 / (n * circuit.t_sample * circuit.rated.voltage);
        let per_voltage = 1.0 / (n * circuit.rated.voltage);
        for side in 0..2 {
            let first = E + 2 * side;
            let of = |pair: &[Complex32; 2]| pair.get(side).copied().unwrap_or_default();
            put(&mut rows.rows, first, of(&self.unexplained) * per_flux);
            let currents = of(&self.sequences(3)) * n;
            put_column(rows, first, place::R_S, currents * (-c.r_s * per_voltage));
            for (moved, k) in self.moved.linkage.iter().zip(FLUX_PLACES) {
                put_column(rows, first, k, -of(moved) * per_flux);
            }
            for (phase, axis) in PHASES.into_iter().enumerate() {
                let turned = |x: &Complex32| if side == 0 { *x } else { x.conj() };
                let channel = |k: usize| self.channels.get(k).map(turned).unwrap_or_default();
                let u = channel(phase) * axis * (CLARKE * per_voltage);
                let drop = channel(3 + phase) * axis * (CLARKE * c.r_s * per_voltage);
                put_column(rows, first, place::VOLTAGE + phase, -u);
                put_column(rows, first, place::SERIES + phase, -drop);
                add_column(rows, first, place::CURRENT + phase, drop);
            }
        }
    }

    fn zero_rows(&self, circuit: &Circuit, rows: &mut Rows) {
        let [a, b, c, d, e, f] = self.channels;
        let [of_currents, of_voltages] = self.zero;
        let quantities = [
            (
                I_0,
                [d, e, f],
                of_currents,
                circuit.rated.current,
                place::CURRENT,
            ),
            (
                V_0,
                [a, b, c],
                of_voltages,
                circuit.rated.voltage,
                place::VOLTAGE,
            ),
        ];
        for (row, phases, sum, scale, first) in quantities {
            put(&mut rows.rows, row, self.zero(phases, sum) / scale);
            let per = -1.0 / (3.0 * self.samples.max(1.0) * scale);
            for (k, x) in phases.into_iter().enumerate() {
                put_column(rows, row, first + k, x * per);
            }
        }
    }

    fn torque_row(&self, circuit: &Circuit, past: &mut Past, rows: &mut Rows) {
        let now = self.turned_cycle();
        let [first, second] = past.cycles;
        if past.known >= 2 {
            let period = self.samples * circuit.t_sample;
            let spline = Spline::new([&first, &second, &now], period);
            let jerk = (spline.acceleration - past.acceleration) / period;
            past.acceleration = spline.acceleration;
            rows.acceleration = spline.acceleration;
            rows.has_torque = true;
            let row = spline.balance(circuit);
            set(&mut rows.rows, Q, row);
            if let Some(place) = rows.sensitivities.get_mut(Q) {
                *place = spline.sensitivities(circuit, [&first, &second, &now], jerk);
            }
        }
        past.cycles = [second, now];
        past.known = past.known.saturating_add(1);
    }

    fn turned_cycle(&self) -> Turned {
        let n = self.samples.max(1.0);
        let [s0, s1, s2] = self.moments;
        let mut sensitivities = [0.0; UNKNOWNS];
        for (x, k) in self.moved.torque.iter().zip(FLUX_PLACES) {
            set(&mut sensitivities, k, x / n);
        }
        set(&mut sensitivities, place::TORQUE, self.tau_load / n);
        Turned {
            moments: [s0 / n, s1 / (n * n), s2 / (n * n * n)],
            mean: self.angle_sum / n,
            end: self.angle,
            sensitivities,
        }
    }
}

/// Torque balance of three cycles under a quadratic B-spline.
struct Spline {
    torque: f32,
    speed: f32,
    acceleration: f32,
}

impl Spline {
    fn new([first, second, third]: [&Turned; 3], period: f32) -> Spline {
        let [[_, _, c1], [a2, b2, c2], [a3, b3, c3]] =
            [first.moments, second.moments, third.moments];
        let (a_1, a_2) = (first.mean, first.end + second.mean);
        let a_3 = first.end + second.end + third.mean;
        Spline {
            torque: 0.5 * (c1 + a2 + 2.0 * b2 - 2.0 * c2 + a3 - 2.0 * b3 + c3),
            speed: (a_3 - a_1) / (2.0 * period),
            acceleration: (a_3 - 2.0 * a_2 + a_1) / (period * period),
        }
    }

    /// `Q`.
    fn balance(&self, circuit: &Circuit) -> f32 {
        let m = &circuit.mechanics;
        let left = self.torque - circuit.friction * self.speed - m.inertia * self.acceleration;
        left / circuit.rated.torque
    }

    /// `jerk` is the rate of the acceleration, rad/s3.
    fn sensitivities(&self, circuit: &Circuit, cycles: [&Turned; 3], jerk: f32) -> Vector {
        /// Areas of the spline over its three cycles.
        const AREAS: [f32; 3] = [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0];
        let per = 1.0 / circuit.rated.torque;
        let mut row = [0.0; UNKNOWNS];
        for (cycle, area) in cycles.into_iter().zip(AREAS) {
            for (x, y) in row.iter_mut().zip(cycle.sensitivities) {
                *x += area * per * y;
            }
        }
        let inertia = circuit.mechanics.inertia * self.acceleration * per;
        let friction = circuit.friction * self.speed * per;
        set(&mut row, place::INERTIA, -inertia);
        set(&mut row, place::FRICTION, -friction);
        let speed = row.get(place::SPEED).copied().unwrap_or_default();
        set(&mut row, place::SPEED, speed + inertia + friction);
        let of_lag = circuit.friction * self.acceleration + circuit.mechanics.inertia * jerk;
        let lag = row.get(place::SPEED_LAG).copied().unwrap_or_default();
        set(&mut row, place::SPEED_LAG, lag - of_lag * per);
        row
    }
}

fn set(row: &mut [f32], k: usize, x: f32) {
    if let Some(place) = row.get_mut(k) {
        *place = x;
    }
}

fn put(rows: &mut [f32; ROWS], first: usize, x: Complex32) {
    set(rows, first, x.re);
    set(rows, first + 1, x.im);
}

fn put_column(rows: &mut Rows, first: usize, k: usize, x: Complex32) {
    for (row, x) in rows.sensitivities.iter_mut().skip(first).zip([x.re, x.im]) {
        set(row, k, x);
    }
}

fn add_column(rows: &mut Rows, first: usize, k: usize, x: Complex32) {
    for (row, x) in rows.sensitivities.iter_mut().skip(first).zip([x.re, x.im]) {
        if let Some(place) = row.get_mut(k) {
            *place += x;
        }
    }
}
