//! One steady operating point as the channels of a board show it.

use monitor::CHANNELS;
use motor::MotorFile;
use motor::dynamic::Harmonic;
use motor::steady_state::{NoOperatingPoint, SteadyState};
use motor::temperature::copper_resistance_at;
use num_complex::Complex64;

use super::instrument::Instrument;

/// Temperature at which the true circuit's resistances hold, degC.
const REFERENCE_DEGC: f64 = 20.0;

/// What a motor is exposed to.
#[derive(Clone, Copy, Debug)]
pub struct Conditions {
    /// Positive sequence of the supply, V, amplitude.
    pub volt: f64,
    /// Its frequency, Hz.
    pub hertz: f64,
    /// Negative over positive sequence.
    pub unbalance: Complex64,
    /// Torque beside the frictions, N m.
    pub torque: f64,
    /// Factor on the frictions of the motor file.
    pub friction: f64,
    /// Temperatures of winding and cage, degC.
    pub degc: [f64; 2],
    /// Temperature of the cabinet, degC.
    pub cabinet_degc: f64,
}

/// What the channels show of it, seen from the voltage's positive sequence.
#[derive(Clone, Copy, Debug)]
pub struct Shows {
    /// Phasors of voltages a, b, c, then currents a, b, c, V and A.
    pub phasors: [Complex64; CHANNELS],
    /// Mean squares beside the fundamentals and offsets, without noise, V2 and A2.
    pub beside: [f64; 2],
    /// Shaft speed, rad/s.
    pub omega_mech: f64,
    /// Frequency of the supply, Hz.
    pub hertz: f64,
    /// Lengths of the stator's current and of the rotor's, A.
    pub amps: [f64; 2],
}

/// The motor with its resistances at these temperatures, degC.
pub fn warmed(motor: &MotorFile, [winding, cage]: [f64; 2]) -> MotorFile {
    let mut warm = motor.clone();
    let p = &mut warm.parameters;
    p.r_s = copper_resistance_at(p.r_s, REFERENCE_DEGC, winding);
    p.r_r = copper_resistance_at(p.r_r, REFERENCE_DEGC, cage);
    warm
}

/// What is shown at these conditions.
///
/// # Errors
/// A load that the motor does not carry.
pub fn shows(
    motor: &MotorFile,
    instrument: &Instrument,
    harmonics: &[Harmonic],
    at: &Conditions,
) -> Result<Shows, NoOperatingPoint> {
    let warm = warmed(motor, at.degc);
    let omega = std::f64::consts::TAU * at.hertz;
    let n_p = warm.mechanics.n_p;
    let u = Complex64::from(at.volt);
    let friction = warm.mechanics.friction + at.friction * warm.mechanics.load_friction;
    let positive = SteadyState::new(&warm.parameters, n_p, u, omega);
    let point = positive.at_load(|speed| at.torque + friction * speed)?;
    // The negative sequence turns the other way: the mirror's slip speed.
    let u_negative = u * at.unbalance;
    let mirror = SteadyState::new(&warm.parameters, n_p, u_negative.conj(), omega);
    let i_negative = mirror.at_slip_speed(omega + point.omega_el).i_s.conj();
    let factors = instrument.factors(at.cabinet_degc, at.hertz);
    let pairs = [(u, u_negative), (point.i_s, i_negative)];
    let phasors = std::array::from_fn(|k| {
        let (positive, negative) = pairs[k / 3];
        phase(positive, negative, k % 3) * factors[k]
    });
    Ok(Shows {
        phasors,
        beside: distortion(harmonics, at.volt, omega * warm.parameters.l_a()),
        omega_mech: point.omega_mech,
        hertz: at.hertz,
        amps: [point.i_s.norm(), point.i_r.norm()],
    })
}

/// Phasor of a phase of two space vectors, one turning forwards and one backwards.
fn phase(positive: Complex64, negative: Complex64, phase: usize) -> Complex64 {
    let third = Complex64::from_polar(1.0, -std::f64::consts::TAU / 3.0 * phase as f64);
    positive * third + negative.conj() * third.conj()
}

/// Mean squares of the harmonics in voltage and current: at their frequencies a motor is its leakage.
fn distortion(harmonics: &[Harmonic], volt: f64, leakage_ohm: f64) -> [f64; 2] {
    let mut squares = [0.0; 2];
    for harmonic in harmonics {
        let u = volt * harmonic.amplitude.norm();
        let i = u / (harmonic.order.abs() * leakage_ohm);
        squares[0] += 0.5 * u * u;
        squares[1] += 0.5 * i * i;
    }
    squares
}
