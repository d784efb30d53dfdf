//! A motor written a second time, in other forms than the library's, with its own integration and instruments.
//!
//! Flux is solved by bisection, saturation is a rational function, friction has a Stribeck bump, windage another
//! exponent, heating is a straight line, leakage saturation another curve: a fit cannot be exact.

use motor::MotorFile;
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use recording::{Channel, LoadTorque, Metadata, Recording, Sensors, StartsFrom};
use std::f64::consts::TAU;

/// What is hidden in a recording. Zero everywhere: nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hidden {
    /// Extra magnetizing current at rated flux, share.
    pub saturation: f64,
    /// Drop of the leakages at high current, share.
    pub leakage: f64,
    /// Loss conductance, S.
    pub core: f64,
    /// Rise of the rotor resistance at the end of the recording, share.
    pub rotor_rise: f64,
    /// Coulomb friction, N m.
    pub coulomb: f64,
    /// Windage torque at synchronous speed, N m.
    pub windage: f64,
    /// Torque once per turn, N m.
    pub pulsation: f64,
    /// Torsional frequency, Hz; 0: stiff.
    pub torsion_hz: f64,
    /// Extra resistance in phase b, share of the stator resistance.
    pub phase_b: f64,
    /// Rotor asymmetry, share of the rotor resistance.
    pub rotor_bar: f64,
    /// Gain error of the voltage channel c.
    pub gain_vc: f64,
    /// Gain error of the current channel a.
    pub gain_ia: f64,
    /// Offset of the current channel b, A.
    pub offset_ib: f64,
    /// Delay of the currents, s.
    pub delay: f64,
    /// Scale error of the speed channel.
    pub speed_scale: f64,
    /// Ripple of the speed channel once per turn, rad/s.
    pub speed_ripple: f64,
}

/// A 2.2 kW machine.
#[derive(Clone, Copy, Debug)]
pub struct Machine {
    pub r_s: f64,
    pub r_r: f64,
    pub l_l: f64,
    pub l_m: f64,
    pub j: f64,
    pub b: f64,
}

pub const TRUE: Machine = Machine {
    r_s: 3.4,
    r_r: 2.4,
    l_l: 0.0115,
    l_m: 0.225,
    j: 0.016,
    b: 0.002,
};
const N_P: f64 = 2.0;
const OMEGA: f64 = TAU * 50.0;
const U: f64 = 326.6;
const T_SAMPLE: f64 = 1e-4;
/// Integration steps per sample.
const FINE: usize = 2;
const RATED_FLUX: f64 = U / OMEGA;

/// Load, voltage and switch as functions of time.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// (time, load in share of 14.6 N m, voltage in share of rated), each until the next.
    pub steps: &'static [(f64, f64, f64)],
    /// Time at which the supply is cut, s.
    pub cut: f64,
    /// Duration, s.
    pub end: f64,
}

/// Start, loads and voltages.
pub const LOADS: Course = Course {
    steps: &[
        (0.0, 0.0, 1.0),
        (0.6, 0.5, 1.0),
        (1.1, 1.0, 1.0),
        (1.6, 0.2, 1.1),
        (2.1, 0.5, 0.85),
        (2.6, 0.8, 1.0),
    ],
    cut: 99.0,
    end: 3.2,
};
/// Another order, and a coast-down.
pub const COAST: Course = Course {
    steps: &[
        (0.0, 0.3, 1.0),
        (0.7, 0.0, 0.9),
        (1.2, 0.7, 1.1),
        (1.7, 1.0, 0.95),
        (2.2, 0.0, 1.0),
    ],
    cut: 2.5,
    end: 3.5,
};

#[derive(Clone, Copy)]
struct State {
    psi_s: Complex64,
    psi_r: Complex64,
    w: f64,
    theta: f64,
    w_load: f64,
    twist: f64,
}

struct Plant {
    m: Machine,
    h: Hidden,
    end: f64,
}

impl Plant {
    /// Magnetizing current over its linear value: a rational curve that is 1 at zero flux.
    fn magnetizing(&self, psi: f64) -> f64 {
        let x = (psi / RATED_FLUX).powi(6);
        1.0 + self.h.saturation * 2.0 * x / (1.0 + 0.35 * x)
    }

    fn leakage(&self, i: f64) -> f64 {
        let x = i / 30.0;
        self.m.l_l * (1.0 - self.h.leakage * (1.0 - 1.0 / (1.0 + x * x * x).cbrt()))
    }

    /// Winding currents by bisection on the air-gap flux.
    fn currents(&self, s: &State, guess: f64) -> (Complex64, Complex64) {
        let l = self.leakage(guess);
        let sum = (s.psi_s + s.psi_r) / l;
        let (drive, mut low, mut high) = (sum.norm(), 0.0, 3.0);
        for _ in 0..45 {
            let x: f64 = 0.5 * (low + high);
            if x * (2.0 / l + self.magnetizing(x) / self.m.l_m) < drive {
                low = x;
            } else {
                high = x;
            }
        }
        let psi_m = sum * (low / drive.max(1e-12));
        ((s.psi_s - psi_m) / l, (s.psi_r - psi_m) / l)
    }

    fn friction(&self, w: f64) -> f64 {
        let stribeck = 1.0 + 0.4 * (-(w / 6.0).powi(2)).exp();
        let windage = self.h.windage * (w.abs() / (OMEGA / N_P)).powf(1.9) * w.signum();
        self.m.b * w + self.h.coulomb * stribeck * (w / 0.6).tanh() + windage
    }

    /// Rates, terminal current and terminal voltage.
    fn rates(
        &self,
        s: &State,
        u: Option<Complex64>,
        tau_load: f64,
        t: f64,
        guess: f64,
    ) -> (State, Complex64, Complex64) {
        let w_el = N_P * s.w;
        let (i_s, i_r) = match u {
            Some(_) => self.currents(s, guess),
            None => (Complex64::ZERO, s.psi_r / (self.m.l_l + self.m.l_m)),
        };
        let r_r = self.m.r_r * (1.0 + self.h.rotor_rise * t / self.end);
        let bar = Complex64::from_polar(self.h.rotor_bar * r_r, 2.0 * N_P * s.theta + 0.7);
        let d_r = -i_r * r_r - bar * i_r.conj() + Complex64::new(0.0, w_el) * s.psi_r;
        let open = d_r * (self.m.l_m / (self.m.l_m + self.m.l_l));
        let v = u.unwrap_or(open);
        let i_t = (i_s + v * self.h.core) / (1.0 + self.h.core * self.m.r_s);
        // Extra resistance in phase b only, without zero-sequence current.
        let b = Complex64::from_polar(1.0, TAU / 3.0);
        let i_b = (i_t * b.conj()).re;
        let drop = i_t * self.m.r_s + b * (2.0 / 3.0 * self.h.phase_b * self.m.r_s * i_b);
        let d_s = if u.is_some() { v - drop } else { open };
        let tau = 1.5 * N_P * (s.psi_s.conj() * i_s).im
            - self.friction(s.w)
            - self.h.pulsation * (s.theta + 0.4).cos();
        let mut d = State {
            psi_s: d_s,
            psi_r: d_r,
            w: (tau - tau_load) / self.m.j,
            theta: s.w,
            w_load: 0.0,
            twist: 0.0,
        };
        if self.h.torsion_hz > 0.0 {
            let (j_m, j_l) = (0.45 * self.m.j, 0.55 * self.m.j);
            let k = (TAU * self.h.torsion_hz).powi(2) * j_m * j_l / self.m.j;
            let shaft = k * s.twist + 0.03 * (s.w - s.w_load);
            d.w = (tau - shaft) / j_m;
            d.w_load = (shaft - tau_load) / j_l;
            d.twist = s.w - s.w_load;
        }
        (d, i_t, v)
    }
}

fn moved(s: &State, h: f64, d: &State) -> State {
    State {
        psi_s: s.psi_s + d.psi_s * h,
        psi_r: s.psi_r + d.psi_r * h,
        w: s.w + d.w * h,
        theta: s.theta + d.theta * h,
        w_load: s.w_load + d.w_load * h,
        twist: s.twist + d.twist * h,
    }
}

/// Truth at every sample: voltage, current, speed, angle, load.
type Truth = Vec<(Complex64, Complex64, f64, f64, f64)>;

fn truth(plant: &Plant, course: &Course) -> Truth {
    let zero = Complex64::ZERO;
    let mut s = State {
        psi_s: zero,
        psi_r: zero,
        w: 0.0,
        theta: 0.0,
        w_load: 0.0,
        twist: 0.0,
    };
    let h = T_SAMPLE / FINE as f64;
    let level = |t: f64| course.steps.iter().rev().find(|x| x.0 <= t + 1e-9).unwrap();
    let mut out = Vec::new();
    let mut i_last = 0.0;
    for k in 0..(course.end / T_SAMPLE) as usize {
        for sub in 0..FINE {
            let t = (k * FINE + sub) as f64 * h;
            let &(_, load, voltage) = level(t);
            let on = t < course.cut;
            let tau = if on { 14.6 * load } else { 0.0 };
            let u = |t: f64| on.then(|| Complex64::from_polar(U * voltage, OMEGA * t + 0.3));
            let (k1, i, v) = plant.rates(&s, u(t), tau, t, i_last);
            i_last = i.norm();
            if sub == 0 {
                out.push((v, i, s.w, s.theta, tau));
            }
            let (k2, ..) = plant.rates(&moved(&s, 0.5 * h, &k1), u(t + 0.5 * h), tau, t, i_last);
            let (k3, ..) = plant.rates(&moved(&s, 0.5 * h, &k2), u(t + 0.5 * h), tau, t, i_last);
            let (k4, ..) = plant.rates(&moved(&s, h, &k3), u(t + h), tau, t, i_last);
            let sum = moved(&moved(&moved(&k1, 2.0, &k2), 2.0, &k3), 1.0, &k4);
            s = moved(&s, h / 6.0, &sum);
        }
    }
    out
}

fn abc(x: Complex64) -> [f64; 3] {
    [0.0, 1.0, 2.0].map(|k| (x * Complex64::from_polar(1.0, -k * TAU / 3.0)).re)
}

/// One channel's instrument: noise of 0.2 % of full scale, twelve bits.
fn instrument(x: f64, full: f64, rng: &mut Pcg64) -> f64 {
    let noise = Normal::new(0.0, 0.002 * full).unwrap().sample(rng);
    let step = 2.0 * full / 4096.0;
    ((x + noise) / step).round() * step
}

/// A recording of the machine with what is hidden in it.
pub fn record(hidden: &Hidden, course: &Course, seed: u64) -> Recording {
    let plant = Plant {
        m: TRUE,
        h: *hidden,
        end: course.end,
    };
    let rows = truth(&plant, course);
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut columns: [Vec<f64>; 8] = Default::default();
    let shift = hidden.delay / T_SAMPLE;
    for (k, &(v, _, w, theta, tau)) in rows.iter().enumerate() {
        let at = (k as f64 - shift).max(0.0);
        let (j, share) = (at as usize, at.fract());
        let i = rows[j].1 * (1.0 - share) + rows[(j + 1).min(rows.len() - 1)].1 * share;
        let (mut u, mut i) = (abc(v), abc(i));
        u[2] *= 1.0 + hidden.gain_vc;
        i[0] *= 1.0 + hidden.gain_ia;
        i[1] += hidden.offset_ib;
        let w = w * (1.0 + hidden.speed_scale) + hidden.speed_ripple * (theta + 1.1).sin();
        for p in 0..3 {
            columns[p].push(instrument(u[p], 600.0, &mut rng));
            columns[3 + p].push(instrument(i[p], 80.0, &mut rng));
        }
        columns[6].push(instrument(w, 200.0, &mut rng));
        columns[7].push(instrument(tau, 40.0, &mut rng));
    }
    assemble(columns)
}

fn assemble(columns: [Vec<f64>; 8]) -> Recording {
    let metadata = Metadata {
        load_torque: LoadTorque::Measured,
        starts_from: StartsFrom::Standstill,
        sensors: Sensors {
            voltage_full_scale_volt: Some(600.0),
            current_full_scale_amp: Some(80.0),
            speed_full_scale_rad_s: Some(200.0),
            torque_full_scale_nm: Some(40.0),
            noise_sigma_fraction_of_full_scale: Some(0.002),
            adc_bits: Some(12),
            ..Sensors::default()
        },
        ..Metadata::default()
    };
    let t = (0..columns[0].len()).map(|k| k as f64 * T_SAMPLE).collect();
    let mut recording = Recording::new("foreign", t, metadata).unwrap();
    let channels = Channel::VOLTAGES
        .into_iter()
        .chain(Channel::CURRENTS)
        .chain([Channel::SPEED, Channel::TORQUE]);
    for (channel, values) in channels.zip(columns) {
        recording = recording.with_channel(channel, values).unwrap();
    }
    recording
}

/// A motor file whose parameters are wrong by about 5 % (friction 30 %).
pub fn beliefs(seed: u64) -> MotorFile {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut wrong = |x: f64, by: f64| x * (1.0 + by * rng.random_range(-1.0..1.0f64));
    let text = format!(
        "name = \"foreign\"\n[nameplate]\npole_pairs = 2\npower_watt = 2200.0\nvoltage_line_rms_volt = 400.0\n\
         current_rms_amp = 5.0\nfrequency_hz = 50.0\ntorque_nm = 14.6\nconnection = \"star\"\n[parameters]\n\
         stator_resistance_ohm = {}\nrotor_resistance_ohm = {}\nstator_leakage_henry = {l}\nrotor_leakage_henry = {l}\n\
         magnetizing_inductance_henry = {}\ninertia_kg_m2 = {}\nfriction_nm_s = {}\nload_friction_nm_s = 0.0\n",
        wrong(TRUE.r_s, 0.05),
        wrong(TRUE.r_r, 0.05),
        wrong(TRUE.l_m, 0.05),
        wrong(TRUE.j, 0.05),
        wrong(TRUE.b, 0.3),
        l = wrong(TRUE.l_l, 0.05),
    );
    MotorFile::parse(&text, "foreign.toml").unwrap()
}
