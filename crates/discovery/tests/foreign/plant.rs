//! The machine: bisection for the flux, a ladder for the cage, Runge-Kutta with its own step.

use super::course::{Course, Source};
use super::laws::Where;
use super::{Hidden, Machine, OMEGA, U};
use num_complex::Complex64;
use std::f64::consts::TAU;

pub const T_SAMPLE: f64 = 1e-4;
/// Integration steps per sample.
const FINE: usize = 2;
/// Layers of a rotor bar.
const LAYERS: usize = 3;

/// What instruments see at one sample: recorded voltage, current, speed, angle, load.
#[derive(Clone, Copy, Debug)]
pub struct Instant {
    pub u: Complex64,
    pub i: Complex64,
    pub speed: f64,
    pub theta: f64,
    pub load: f64,
}

#[derive(Clone, Copy)]
struct State {
    psi_s: Complex64,
    psi_r: [Complex64; LAYERS],
    w: f64,
    theta: f64,
    w_load: f64,
    twist: f64,
}

struct Plant {
    m: Machine,
    h: Hidden,
    end: f64,
    /// Inverse of the leakage matrix of the rotor layers, 1/H; one layer: only the first entry.
    inverse: [[f64; LAYERS]; LAYERS],
    layers: usize,
}

/// Inverse of `l_end + l_between min(row, column)`: a chain of inductances.
fn ladder(l_end: f64, l_between: f64) -> [[f64; LAYERS]; LAYERS] {
    // The inverse of min(i, j) over 1, 2 with an end leakage common to all, written out for three layers.
    let (a, b) = (1.0 / l_end, 1.0 / l_between);
    [[a + b, -b, 0.0], [-b, 2.0 * b, -b], [0.0, -b, b]]
}

impl Plant {
    fn new(m: Machine, h: Hidden, end: f64) -> Self {
        let single = h.cage == 0.0;
        let between = h.cage * m.l_l;
        // At low slip all layers carry a third: mean of min(row, column) over 0, 1, 2 is 5/9.
        let inverse = if single {
            [[1.0 / m.l_l, 0.0, 0.0], [0.0; 3], [0.0; 3]]
        } else {
            ladder(m.l_l - 5.0 / 9.0 * between, between)
        };
        let layers = if single { 1 } else { LAYERS };
        Self {
            m,
            h,
            end,
            inverse,
            layers,
        }
    }

    /// Magnetizing current over its linear value: a rational curve that is 1 at zero flux.
    fn magnetizing(&self, psi: f64) -> f64 {
        let x = (psi / (U / OMEGA)).powi(6);
        let law = self
            .h
            .law
            .map_or(1.0, |law| law.magnetizing(psi / (U / OMEGA)));
        law + self.h.saturation * 2.0 * x / (1.0 + 0.35 * x)
    }

    /// Leakage over its value at small current.
    fn leakage(&self, i: f64) -> f64 {
        let x = i / (6.0 * self.m.current);
        let law = self.h.law.map_or(1.0, |law| law.leakage(&self.m, i));
        law - self.h.leakage * (1.0 - 1.0 / (1.0 + x * x * x).cbrt())
    }

    /// Product of the inverse leakage matrix with the layers' flux over a common flux.
    fn layer_currents(&self, psi: &[Complex64; LAYERS], common: Complex64) -> [Complex64; LAYERS] {
        let mut i = [Complex64::ZERO; LAYERS];
        for (k, i) in i.iter_mut().enumerate().take(self.layers) {
            for (j, psi) in psi.iter().enumerate().take(self.layers) {
                *i += (psi - common) * self.inverse[k][j];
            }
        }
        i
    }

    /// Stator and layer currents; `u` tells whether the stator is connected.
    fn currents(&self, s: &State, connected: bool, guess: f64) -> (Complex64, [Complex64; LAYERS]) {
        let saturated = if connected { self.leakage(guess) } else { 1.0 };
        let stator = if connected {
            1.0 / (self.m.l_l * saturated)
        } else {
            0.0
        };
        let zero = Complex64::ZERO;
        let rotor: Complex64 = self.layer_currents(&s.psi_r, zero).iter().sum();
        let ones = [Complex64::ONE; LAYERS];
        let admittance: Complex64 = self.layer_currents(&ones, zero).iter().sum();
        let sum = s.psi_s * stator + rotor / saturated;
        let total = stator + admittance.re / saturated;
        let psi_m = self.air_gap(sum, total);
        let i_r = self.layer_currents(&s.psi_r, psi_m).map(|i| i / saturated);
        ((s.psi_s - psi_m) * stator, i_r)
    }

    /// Flux whose magnetizing current balances the windings: `psi (total + f(psi)/L_m) = drive`.
    fn air_gap(&self, drive: Complex64, total: f64) -> Complex64 {
        if self.h.saturation == 0.0 && self.h.law.is_none() {
            return drive / (total + 1.0 / self.m.l_m);
        }
        let (size, mut low, mut high) = (drive.norm(), 0.0, 3.0 * U / OMEGA);
        for _ in 0..45 {
            let x: f64 = 0.5 * (low + high);
            if x * (total + self.magnetizing(x) / self.m.l_m) < size {
                low = x;
            } else {
                high = x;
            }
        }
        drive * (low / size.max(1e-12))
    }

    fn friction(&self, w: f64) -> f64 {
        let (m, h) = (&self.m, &self.h);
        let stribeck = 1.0 + 0.4 * (-(w / (0.04 * m.speed())).powi(2)).exp();
        let windage = h.windage * m.torque * (w.abs() / m.speed()).powf(1.9) * w.signum();
        m.b * w + h.coulomb * m.torque * stribeck * (w / (0.004 * m.speed())).tanh() + windage
    }

    /// Voltage at the terminals for what an inverter commands.
    fn delivered(&self, commanded: Complex64, i: Complex64) -> Complex64 {
        let knee = 0.02 * self.m.current;
        let lost = phases(i).map(|i| self.h.dead_time * U * (i / knee).clamp(-1.0, 1.0));
        let power = 1.5 * (commanded * i.conj()).re / self.m.power;
        commanded * (1.0 - self.h.droop * power) - clarke(lost)
    }

    /// Rates, terminal current and terminal voltage.
    fn rates(
        &self,
        s: &State,
        supply: Option<(Complex64, bool)>,
        load: f64,
        [t, hertz]: [f64; 2],
        guess: f64,
    ) -> (State, Complex64, Complex64) {
        let (m, h) = (&self.m, &self.h);
        let spin = Complex64::new(0.0, m.n_p * s.w);
        let (i_s, i_r) = self.currents(s, supply.is_some(), guess);
        let slip = hertz - m.n_p * s.w / TAU;
        let r_r = self.layers as f64
            * m.r_r
            * (1.0 + h.rotor_rise * t / self.end)
            * h.law.map_or(1.0, |law| law.rotor(slip));
        let bar = Complex64::from_polar(h.rotor_bar * m.r_r, 2.0 * m.n_p * s.theta + 0.7);
        let mut psi_r = [Complex64::ZERO; LAYERS];
        for k in 0..self.layers {
            psi_r[k] = -i_r[k] * r_r - bar * i_r[k].conj() + spin * s.psi_r[k];
        }
        // Open terminals: the air gap follows the rotor alone, unsaturated.
        let follows: Complex64 = self.layer_currents(&psi_r, Complex64::ZERO).iter().sum();
        let ones = [Complex64::ONE; LAYERS];
        let admittance: Complex64 = self.layer_currents(&ones, Complex64::ZERO).iter().sum();
        let open = follows / (admittance.re + 1.0 / m.l_m);
        let g = h.core * m.power / (1.5 * U * U);
        let r_s = m.r_s
            * (1.0 + h.stator_rise * t / self.end)
            * h.law.map_or(1.0, |law| law.stator(hertz));
        let (v, i_t, i_s) = match supply {
            // Off the supply the winding feeds its own iron.
            None => (open, Complex64::ZERO, -open * g),
            Some((u, driven)) => {
                let v = if driven { self.delivered(u, i_s) } else { u };
                (v, (i_s + v * g) / (1.0 + g * r_s), i_s)
            }
        };
        let connected = supply.is_some();
        let psi_s = if connected {
            let of_law = h.law.map(|law| clarke(law.drops(m, phases(i_t), t)));
            v - self.drop(i_t, r_s) - of_law.unwrap_or_default()
        } else {
            open
        };
        let shaft = 1.5 * m.n_p * (s.psi_s.conj() * i_s).im
            - self.friction(s.w)
            - h.pulsation * m.torque * (s.theta + 0.4).cos()
            - h.law.map_or(0.0, |law| {
                law.torque(
                    m,
                    Where {
                        t,
                        speed: s.w,
                        theta: s.theta,
                        load,
                    },
                )
            });
        let d = self.turning(s, shaft, load);
        (State { psi_s, psi_r, ..d }, i_t, v)
    }

    /// Resistive drop with more resistance in phase b, without zero-sequence current.
    fn drop(&self, i: Complex64, r_s: f64) -> Complex64 {
        let b = Complex64::from_polar(1.0, TAU / 3.0);
        i * r_s + b * (2.0 / 3.0 * self.h.phase_b * r_s * (i * b.conj()).re)
    }

    /// Rates of the mechanical states for the torque on the rotor.
    fn turning(&self, s: &State, torque: f64, load: f64) -> State {
        let (j, zero) = (self.m.j, Complex64::ZERO);
        let mut d = State {
            psi_s: zero,
            psi_r: [zero; LAYERS],
            w: (torque - load) / j,
            theta: s.w,
            w_load: 0.0,
            twist: 0.0,
        };
        if self.h.torsion_hz > 0.0 {
            let (j_m, j_l) = (0.45 * j, 0.55 * j);
            let k = (TAU * self.h.torsion_hz).powi(2) * j_m * j_l / j;
            // 1.5 % of critical damping at the torsional frequency.
            let damping = 0.03 * TAU * self.h.torsion_hz * j_m * j_l / j;
            let through = k * s.twist + damping * (s.w - s.w_load);
            d.w = (torque - through) / j_m;
            d.w_load = (through - load) / j_l;
            d.twist = s.w - s.w_load;
        }
        d
    }
}

fn moved(s: &State, h: f64, d: &State) -> State {
    let mut psi_r = s.psi_r;
    psi_r
        .iter_mut()
        .zip(&d.psi_r)
        .for_each(|(x, d)| *x += d * h);
    State {
        psi_s: s.psi_s + d.psi_s * h,
        psi_r,
        w: s.w + d.w * h,
        theta: s.theta + d.theta * h,
        w_load: s.w_load + d.w_load * h,
        twist: s.twist + d.twist * h,
    }
}

/// The three phase values of a vector without zero sequence.
pub fn phases(x: Complex64) -> [f64; 3] {
    let beside = 0.5 * 3f64.sqrt() * x.im;
    [x.re, beside - 0.5 * x.re, -beside - 0.5 * x.re]
}

fn clarke(x: [f64; 3]) -> Complex64 {
    let [a, b, c] = x;
    Complex64::new((2.0 * a - b - c) / 3.0, (b - c) / 3f64.sqrt())
}

/// What really happens over a course.
pub fn truth(machine: &Machine, hidden: &Hidden, course: &Course) -> Vec<Instant> {
    let plant = Plant::new(*machine, *hidden, course.end);
    let zero = Complex64::ZERO;
    let mut s = State {
        psi_s: zero,
        psi_r: [zero; LAYERS],
        w: 0.0,
        theta: 0.0,
        w_load: 0.0,
        twist: 0.0,
    };
    let h = T_SAMPLE / FINE as f64;
    let (mut source, mut out, mut i_last) = (Source::new(), Vec::new(), 0.0);
    for k in 0..(course.end / T_SAMPLE) as usize {
        let held =
            (course.ramp > 0.0).then(|| source.commanded(course, k as f64 * T_SAMPLE, T_SAMPLE));
        let hertz = source.hertz(course);
        for sub in 0..FINE {
            let t = (k * FINE + sub) as f64 * h;
            let load = course.load(t, machine);
            let on = course.is_on(t);
            let u = |t: f64| {
                on.then(|| held.map_or_else(|| (Source::grid(course, t), false), |u| (u, true)))
            };
            let (k1, i, v) = plant.rates(&s, u(t), load, [t, hertz], i_last);
            i_last = i.norm();
            if sub == 0 {
                let (speed, theta) = (s.w, s.theta);
                let u = held.unwrap_or(v);
                out.push(Instant {
                    u,
                    i,
                    speed,
                    theta,
                    load,
                });
            }
            let mid = t + 0.5 * h;
            let (k2, ..) = plant.rates(&moved(&s, 0.5 * h, &k1), u(mid), load, [t, hertz], i_last);
            let (k3, ..) = plant.rates(&moved(&s, 0.5 * h, &k2), u(mid), load, [t, hertz], i_last);
            let (k4, ..) = plant.rates(&moved(&s, h, &k3), u(t + h), load, [t, hertz], i_last);
            let sum = moved(&moved(&moved(&k1, 2.0, &k2), 2.0, &k3), 1.0, &k4);
            s = moved(&s, h / 6.0, &sum);
        }
    }
    out
}
