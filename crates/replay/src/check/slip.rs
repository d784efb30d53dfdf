//! The speed of a motor without an encoder: from the slip that the circuit needs for the measured voltages and currents.

use std::f64::consts::TAU;

use motor::MotorFile;
use motor::effect::{EffectConfig, SteadyPoint, from_motor_file, rated};
use num_complex::Complex64;
use recording::{Channel, Recording};
use serde::Serialize;

/// A speed that nobody measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EstimatedSpeed {
    /// Mean over the recording, rpm.
    pub mean_rpm: f64,
    /// Mean slip, percent of synchronous speed.
    pub slip_percent: f64,
    /// Half of the slip's 95 % interval, percent of synchronous speed: that of the rotor resistance.
    pub slip_half_width_percent: f64,
}

/// Cycles of the supply in one block.
const CYCLES: f64 = 5.0;
/// Currents below this share of the rated one belong to a motor that does not run.
const RUNNING: f64 = 0.05;
/// Slips beyond are no running motor.
const GREATEST_SLIP: f64 = 0.3;
/// Without an interval the rotor resistance is known to 10 % for its temperature alone.
const WARM: f64 = 0.1;

/// The recording with an estimated speed; `None` where it has a speed, lacks voltages or currents, or the motor does not run.
pub fn with_estimated_speed(
    recording: &Recording,
    motor: &MotorFile,
) -> Option<(Recording, EstimatedSpeed)> {
    if recording.speed().is_some() {
        return None;
    }
    let (voltages, currents) = (recording.voltages()?, recording.currents()?);
    let [u, i] = [voltages, currents].map(space_vectors);
    let step = recording.t_sample();
    let omega = supply(&u, step, motor.nameplate.omega_sync())?;
    let block = (CYCLES * TAU / omega.abs() / step).round() as usize;
    let effects = from_motor_file(motor, &motor.name).ok()?;
    let slips: Vec<Option<f64>> = u
        .chunks(block)
        .zip(i.chunks(block))
        .map(|(u, i)| {
            slip(
                motor,
                &effects,
                omega,
                [phasor(u, omega, step), phasor(i, omega, step)],
            )
        })
        .collect();
    let known: Vec<f64> = slips.iter().flatten().copied().collect();
    if known.is_empty() || 2 * known.len() < slips.len() {
        return None;
    }
    let mean = known.iter().sum::<f64>() / known.len() as f64;
    let synchronous = omega / f64::from(motor.nameplate.pole_pairs);
    let slips = held(&slips, mean);
    let samples =
        (0..u.len()).map(|k| synchronous * (1.0 - between(&slips, k as f64 / block as f64)));
    let estimated = EstimatedSpeed {
        mean_rpm: synchronous * (1.0 - mean) * 60.0 / TAU,
        slip_percent: 100.0 * mean,
        slip_half_width_percent: 100.0 * mean.abs() * relative_half_width(motor),
    };
    let with_speed = recording
        .clone()
        .with_channel(Channel::SPEED, samples.collect())
        .ok()?;
    Some((with_speed, estimated))
}

/// Slip is proportional to the rotor resistance.
fn relative_half_width(motor: &MotorFile) -> f64 {
    let uncertainty = motor.uncertainty.as_ref();
    let deviation = uncertainty.and_then(|u| u.log_deviation("rotor_resistance_ohm"));
    deviation
        .map_or(WARM, |sd| (1.96 * sd).exp() - 1.0)
        .max(WARM)
}

/// Between the middles of two blocks, linearly; `place` in blocks from the start of the first.
fn between(slips: &[f64], place: f64) -> f64 {
    let at = (place - 0.5).clamp(0.0, (slips.len() - 1) as f64);
    let first = at.floor() as usize;
    let second = (first + 1).min(slips.len() - 1);
    slips[first] + (at - first as f64) * (slips[second] - slips[first])
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
fn phasor(x: &[Complex64], omega: f64, step: f64) -> Complex64 {
    let turned = x.iter().enumerate();
    let sum: Complex64 = turned
        .map(|(k, x)| x * Complex64::from_polar(1.0, -omega * k as f64 * step))
        .sum();
    sum / x.len() as f64
}

/// `E / I_r = R_r/s + j w L_lr` of the T circuit behind the effects.
fn slip(
    motor: &MotorFile,
    effects: &[EffectConfig],
    omega: f64,
    [u, i]: [Complex64; 2],
) -> Option<f64> {
    // The circuit knows one order of phases: the other is its mirror image.
    let [u, i] = [u, i].map(|x| if omega < 0.0 { x.conj() } else { x });
    if i.norm() < RUNNING * motor.nameplate.current_amplitude() {
        return None;
    }
    let omega = omega.abs();
    let mut point = SteadyPoint {
        rated: rated(motor),
        omega_sync: omega,
        omega_mech: omega / f64::from(motor.nameplate.pole_pairs)
            * (1.0 - motor.nameplate.rated_slip()),
        u_s: u,
        i_s: i,
        motor: motor.parameters,
        tau_extra: 0.0,
    };
    effects
        .iter()
        .for_each(|c| c.effect.correct_f64(&c.values, &mut point));
    let m = &point.motor;
    let air_gap = point.u_s - point.i_s * Complex64::new(m.r_s, omega * m.l_ls);
    let rotor = point.i_s - air_gap / Complex64::new(0.0, omega * m.l_m);
    let slip = m.r_r / (air_gap / rotor).re;
    (slip.is_finite() && slip.abs() < GREATEST_SLIP).then_some(slip)
}
