//! A motor of its own for these tests: fluxes of stator and rotor in coordinates at rest, Runge and Kutta in double precision.

use std::f64::consts::TAU;

use num_complex::{Complex32, Complex64};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use crate::MotionSample;
use monitor::Supply;
use monitor::{Abc, ClippedChannels, Sample, SpeedSample};

/// A motor with its supply, load and instruments.
#[derive(Clone, Copy, Debug)]
pub struct Plant {
    pub r_s: f64,
    pub r_r: f64,
    pub l_ls: f64,
    pub l_lr: f64,
    pub l_m: f64,
    pub n_p: f64,
    pub inertia: f64,
    pub friction: f64,
    pub volt: f64,
    pub hertz: f64,
    /// Amplitude of the supply over time, share of rated; and the load's torque, N m.
    pub supply: fn(f64) -> f64,
    pub load: fn(f64) -> f64,
    /// Field turns backwards from this time on, s.
    pub reverses_s: f64,
    pub gains: [f64; 6],
    pub speed_gain: f64,
    /// Time by which the shaft is seen late, s.
    pub late_s: f64,
    /// Noise and step of voltages, V, and currents, A.
    pub noise: [f64; 2],
    pub step: [f64; 2],
    /// Limit of the currents, A.
    pub rail: f64,
    pub counts: f64,
    /// Angle and frequency of the oscillator against the supply's: rad, share.
    pub wrong: [f64; 2],
}

/// The 2.2 kW motor of the shipped motor file, as an independent copy of its numbers.
pub const MOTOR: Plant = Plant {
    r_s: 3.706,
    r_r: 2.296,
    l_ls: 0.010748,
    l_lr: 0.010748,
    l_m: 0.23412,
    n_p: 2.0,
    inertia: 0.03,
    friction: 0.0325,
    volt: 326.6,
    hertz: 50.0,
    supply: |_| 1.0,
    load: |_| 0.0,
    reverses_s: f64::INFINITY,
    gains: [1.0; 6],
    speed_gain: 1.0,
    late_s: 0.0,
    noise: [0.0; 2],
    step: [0.0; 2],
    rail: f64::INFINITY,
    counts: 4096.0,
    wrong: [0.0; 2],
};

pub const T_SAMPLE: f64 = 1e-4;

/// Fluxes of stator and rotor, speed and angle.
#[derive(Clone, Copy, Debug)]
pub struct State {
    pub psi_s: Complex64,
    pub psi_r: Complex64,
    pub omega: f64,
    pub angle: f64,
}

impl State {
    pub const REST: State = State {
        psi_s: Complex64::ZERO,
        psi_r: Complex64::ZERO,
        omega: 0.0,
        angle: 0.3,
    };

    fn plus(&self, d: &State, h: f64) -> State {
        State {
            psi_s: self.psi_s + d.psi_s * h,
            psi_r: self.psi_r + d.psi_r * h,
            omega: self.omega + d.omega * h,
            angle: self.angle + d.angle * h,
        }
    }
}

/// The load of a press: 12 N m in half of every eighth cycle, never steady for five cycles.
pub fn press_torque(t: f64) -> f64 {
    match t > 0.4 && (t * 6.25).fract() < 0.5 {
        true => 12.0,
        false => 0.0,
    }
}

impl Plant {
    pub fn voltage(&self, t: f64) -> Complex64 {
        let angle = TAU * self.hertz * t + 0.7;
        let direction = if t < self.reverses_s { 1.0 } else { -1.0 };
        Complex64::from_polar(self.volt * (self.supply)(t), direction * angle)
    }

    /// Currents of stator and rotor: the inverse of the inductance matrix.
    pub fn currents(&self, s: &State) -> [Complex64; 2] {
        let (l_s, l_r) = (self.l_ls + self.l_m, self.l_lr + self.l_m);
        let determinant = l_s * l_r - self.l_m * self.l_m;
        [
            (s.psi_s * l_r - s.psi_r * self.l_m) / determinant,
            (s.psi_r * l_s - s.psi_s * self.l_m) / determinant,
        ]
    }

    fn slope(&self, s: &State, t: f64) -> State {
        let [i_s, i_r] = self.currents(s);
        let tau = 1.5 * self.n_p * (s.psi_s.conj() * i_s).im;
        State {
            psi_s: self.voltage(t) - i_s * self.r_s,
            psi_r: -i_r * self.r_r + Complex64::new(0.0, self.n_p * s.omega) * s.psi_r,
            omega: (tau - self.friction * s.omega - (self.load)(t)) / self.inertia,
            angle: s.omega,
        }
    }

    fn step(&self, s: &State, t: f64, h: f64) -> State {
        let k1 = self.slope(s, t);
        let k2 = self.slope(&s.plus(&k1, h / 2.0), t + h / 2.0);
        let k3 = self.slope(&s.plus(&k2, h / 2.0), t + h / 2.0);
        let k4 = self.slope(&s.plus(&k3, h), t + h);
        s.plus(&k1, h / 6.0)
            .plus(&k2, h / 3.0)
            .plus(&k3, h / 3.0)
            .plus(&k4, h / 6.0)
    }

    /// Samples of `seconds` from rest; four steps from one to the next.
    pub fn run(&self, seconds: f64, seed: u64) -> Vec<(MotionSample, State)> {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut state = State::REST;
        let h = T_SAMPLE / 4.0;
        let mut samples = Vec::new();
        for k in 0..(seconds / T_SAMPLE) as usize {
            let t = k as f64 * T_SAMPLE;
            samples.push((self.sample(&state, t, &mut random), state));
            for n in 0..4 {
                state = self.step(&state, t + f64::from(n) * h, h);
            }
        }
        samples
    }

    fn sample(&self, state: &State, t: f64, random: &mut Pcg64) -> MotionSample {
        let [i_s, _] = self.currents(state);
        let [u, i] = [self.voltage(t), i_s].map(phases);
        let mut clipped = ClippedChannels::NONE;
        let mut show = |x: [f64; 3], quantity: usize| {
            let mut shown = [0.0; 3];
            for (phase, (shown, x)) in shown.iter_mut().zip(x).enumerate() {
                let noise: f64 = StandardNormal.sample(random);
                let y = x * self.gains[3 * quantity + phase] + self.noise[quantity] * noise;
                let y = match self.step[quantity] {
                    0.0 => y,
                    step => (y / step).round() * step,
                };
                *shown = y;
                if quantity == 1 && y.abs() >= self.rail {
                    *shown = y.clamp(-self.rail, self.rail);
                    clipped.mark_current(phase);
                }
            }
            Abc::from_array(shown.map(|x| x as f32))
        };
        let (u, i) = (show(u, 0), show(i, 1));
        let seen = state.angle - self.late_s * state.omega;
        let count = (seen * self.speed_gain * self.counts / TAU).floor();
        let [angle, share] = self.wrong;
        let omega = TAU * self.hertz * (1.0 + share);
        let axis = Complex64::cis(omega * t + 0.7 + angle);
        MotionSample {
            sample: Sample {
                u_s_abc: Some(u),
                i_s_abc: Some(i),
                speed: SpeedSample::Count((count as i64 & 0xffff) as u16),
                tau_load: Some((self.load)(t) as f32),
                clipped,
            },
            supply: Some(Supply {
                axis: Complex32::new(axis.re as f32, axis.im as f32),
                omega: omega as f32,
            }),
        }
    }
}

/// Phases of a space vector without zero sequence.
pub fn phases(x: Complex64) -> [f64; 3] {
    [0.0, 1.0, 2.0].map(|k| (x * Complex64::cis(-TAU * k / 3.0)).re)
}
