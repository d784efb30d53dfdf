//! Motors written a second time, in other forms than the library's, with their own integration and instruments.
//!
//! Flux is solved by bisection, saturation is a rational function, the cage is a ladder of three bar layers, friction
//! has a Stribeck bump, windage another exponent, heating is a straight line, leakage saturation another curve, dead
//! time a clipped line: a fit cannot be exact.

pub mod cases;
mod course;
pub mod evidence;
mod instruments;
pub mod laws;
mod plant;

pub use course::{COAST, Course, DRIVE, DRIVE_B, INVERTER, INVERTER_B, LOADS, STEADY, STEPS};
pub use instruments::record;

use motor::MotorFile;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// What is hidden in a recording. Zero everywhere: nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hidden {
    /// Extra magnetizing current at rated flux, share.
    pub saturation: f64,
    /// Drop of the leakages at high current, share.
    pub leakage: f64,
    /// Leakage between the layers of the rotor bars, share of the rotor leakage; 0: a single layer.
    pub cage: f64,
    /// Loss at rated voltage, share of rated power.
    pub core: f64,
    /// Rise of the stator resistance at the end of the recording, share.
    pub stator_rise: f64,
    /// Rise of the rotor resistance at the end of the recording, share.
    pub rotor_rise: f64,
    /// Coulomb friction, share of rated torque.
    pub coulomb: f64,
    /// Windage at synchronous speed, share of rated torque.
    pub windage: f64,
    /// Torque once per turn, share of rated torque.
    pub pulsation: f64,
    /// Torsional frequency, Hz; 0: stiff.
    pub torsion_hz: f64,
    /// Extra resistance in phase b, share of the stator resistance.
    pub phase_b: f64,
    /// Rotor asymmetry, share of the rotor resistance.
    pub rotor_bar: f64,
    /// Dead-time voltage of the inverter, share of rated voltage.
    pub dead_time: f64,
    /// Drop of the inverter's amplitude at rated power, share.
    pub droop: f64,
    /// Gain error of the voltage channel c.
    pub gain_vc: f64,
    /// Gain error of the current channel a.
    pub gain_ia: f64,
    /// Gain error of all current channels.
    pub gain_i: f64,
    /// Gain error of the torque channel.
    pub gain_torque: f64,
    /// Offset of the current channel b, share of rated current.
    pub offset_ib: f64,
    /// Delay of the currents, s.
    pub delay: f64,
    /// Scale error of the speed channel.
    pub speed_scale: f64,
    /// Ripple of the speed channel once per turn, share of synchronous speed.
    pub speed_ripple: f64,
    /// Delay of the speed channel, s.
    pub speed_delay: f64,
    /// Delay of the torque channel, s.
    pub load_delay: f64,
    /// A law that no library holds.
    pub law: Option<laws::Law>,
}

/// A machine and its nameplate, 50 Hz, 400 V between lines.
#[derive(Clone, Copy, Debug)]
pub struct Machine {
    pub power: f64,
    pub torque: f64,
    pub current: f64,
    pub n_p: f64,
    pub r_s: f64,
    pub r_r: f64,
    pub l_l: f64,
    pub l_m: f64,
    pub j: f64,
    pub b: f64,
}

/// Rated supply, rad/s.
pub const OMEGA: f64 = TAU * 50.0;
/// Crest of the rated phase voltage, V.
pub const U: f64 = 326.6;

/// Four machines of different size and pole number, with typical data of their class.
pub const MACHINES: [Machine; 4] = [
    Machine {
        power: 2200.0,
        torque: 14.6,
        current: 5.0,
        n_p: 2.0,
        r_s: 3.4,
        r_r: 2.4,
        l_l: 0.0115,
        l_m: 0.225,
        j: 0.016,
        b: 0.002,
    },
    Machine {
        power: 750.0,
        torque: 5.0,
        current: 1.9,
        n_p: 2.0,
        r_s: 10.5,
        r_r: 7.6,
        l_l: 0.032,
        l_m: 0.48,
        j: 0.0035,
        b: 0.0007,
    },
    Machine {
        power: 7500.0,
        torque: 24.6,
        current: 14.5,
        n_p: 1.0,
        r_s: 0.72,
        r_r: 0.52,
        l_l: 0.0036,
        l_m: 0.145,
        j: 0.024,
        b: 0.001,
    },
    Machine {
        power: 11_000.0,
        torque: 109.0,
        current: 23.0,
        n_p: 3.0,
        r_s: 0.48,
        r_r: 0.38,
        l_l: 0.0024,
        l_m: 0.055,
        j: 0.11,
        b: 0.012,
    },
];

/// The ends of the range.
pub const SMALLEST_AND_LARGEST: [Machine; 2] = [
    Machine {
        power: 370.0,
        torque: 2.6,
        current: 1.15,
        n_p: 2.0,
        r_s: 24.0,
        r_r: 18.0,
        l_l: 0.062,
        l_m: 0.78,
        j: 0.0009,
        b: 0.0002,
    },
    Machine {
        power: 45_000.0,
        torque: 291.0,
        current: 81.0,
        n_p: 2.0,
        r_s: 0.068,
        r_r: 0.05,
        l_l: 0.00085,
        l_m: 0.0245,
        j: 0.42,
        b: 0.03,
    },
];

impl Machine {
    /// The machine of a seed.
    pub fn of(seed: u64) -> Self {
        MACHINES[(seed % 4) as usize]
    }

    /// Synchronous speed, rad/s mechanical.
    pub fn speed(&self) -> f64 {
        OMEGA / self.n_p
    }
}

/// A motor file whose parameters are wrong by up to 5 % (friction 30 %).
pub fn priors(machine: &Machine, seed: u64) -> MotorFile {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut wrong = |x: f64, by: f64| x * (1.0 + by * rng.random_range(-1.0..1.0f64));
    let m = machine;
    let text = format!(
        "name = \"foreign\"\n[nameplate]\npole_pairs = {}\npower_watt = {:?}\nvoltage_line_rms_volt = 400.0\n\
         current_rms_amp = {:?}\nfrequency_hz = 50.0\ntorque_nm = {:?}\nconnection = \"star\"\n[parameters]\n\
         stator_resistance_ohm = {}\nrotor_resistance_ohm = {}\nstator_leakage_henry = {l}\nrotor_leakage_henry = {l}\n\
         magnetizing_inductance_henry = {}\ninertia_kg_m2 = {}\nfriction_nm_s = {}\nload_friction_nm_s = 0.0\n",
        m.n_p as u32,
        m.power,
        m.current,
        m.torque,
        wrong(m.r_s, 0.05),
        wrong(m.r_r, 0.05),
        wrong(m.l_m, 0.05),
        wrong(m.j, 0.05),
        wrong(m.b, 0.3),
        l = wrong(m.l_l, 0.05),
    );
    MotorFile::parse(&text, "foreign.toml").unwrap()
}
