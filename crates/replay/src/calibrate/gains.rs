//! Relative gains of the channels of one kind, from the zero sequence that three wires cannot carry.

use motor::MotorFile;
use motor::effect::{Descriptor, Instrument};
use motor::effects::gain_of;
use motor::motor_file::{EffectEntry, EffectValue};
use num_complex::Complex64;

use super::windows::Observed;

/// The two kinds of channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Phase voltages against the star point of the dividers.
    Voltage,
    /// Phase currents.
    Current,
}

impl Kind {
    /// The effect that carries the gains, one parameter for each phase; `None` in a library without it.
    pub fn effect(self) -> Option<&'static Descriptor> {
        let instrument = match self {
            Kind::Voltage => Instrument::Voltages,
            Kind::Current => Instrument::Currents,
        };
        gain_of(instrument).map(|effect| effect.descriptor())
    }
}

/// Gains below this are not worth an entry.
const LEAST: f64 = 2e-4;

/// Gains of the channels a, b, c whose mean is 1: of all that explain the zero sequence the only one.
///
/// `z = (1/3) sum g_k e^{j beta_k}` with real `g_k` of sum 0 has the solution `g_k = 2 Re(z e^{-j beta_k})`.
pub fn from_zero_sequence(zero_ratio: Complex64) -> [f64; 3] {
    let turn = Complex64::from_polar(1.0, std::f64::consts::TAU / 3.0);
    [Complex64::ONE, turn.conj(), turn].map(|axis| 1.0 + 2.0 * (zero_ratio * axis.conj()).re)
}

/// Mean zero over positive sequence of all windows.
pub fn zero_ratio(observed: &[Observed], kind: Kind) -> Complex64 {
    let (mut sum, mut votes) = (Complex64::ZERO, 0.0);
    for o in observed {
        let sequence = match kind {
            Kind::Voltage => &o.window.u_s,
            Kind::Current => &o.window.i_s,
        };
        let ratio = o.window.in_channels(sequence.zero_ratio());
        sum += Complex64::new(f64::from(ratio.re), f64::from(ratio.im)) * o.weight;
        votes += o.weight;
    }
    sum / votes.max(f64::MIN_POSITIVE)
}

/// The motor with these gains on top of those that it has; `None` if they change nothing worth writing.
pub fn with_gains(motor: &MotorFile, kind: Kind, gains: [f64; 3]) -> Option<MotorFile> {
    if gains.iter().all(|gain| (gain - 1.0).abs() < LEAST) {
        return None;
    }
    let effect = kind.effect()?;
    let keys = || effect.parameters.iter().map(|p| p.name);
    let mut motor = motor.clone();
    let known = motor.effects.iter_mut().find(|e| e.name == effect.name);
    match known {
        Some(entry) => {
            for (key, gain) in keys().zip(gains) {
                let old = entry.number(key).unwrap_or(1.0);
                let place = entry.parameters.iter_mut().find(|p| p.key == key);
                if let Some(parameter) = place {
                    parameter.value = EffectValue::Number(old * gain);
                }
            }
        }
        None => motor
            .effects
            .push(EffectEntry::with_numbers(effect.name, keys().zip(gains))),
    }
    Some(motor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_zero_sequence_gives_back_gains_whose_mean_is_one() {
        let gains: [f64; 3] = [1.02, 0.99, 0.99];
        let turn = Complex64::from_polar(1.0, std::f64::consts::TAU / 3.0);
        let axes = [Complex64::ONE, turn.conj(), turn];
        let zero = gains
            .iter()
            .zip(axes)
            .map(|(g, axis)| axis * *g)
            .sum::<Complex64>()
            / 3.0;
        for (found, gain) in from_zero_sequence(zero).iter().zip(gains) {
            assert!((found - gain).abs() < 1e-12);
        }
    }
}
