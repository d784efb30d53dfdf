//! What is known about a recording beside its samples.

use crate::data::channel::{Channel, Quantity};

/// How a voltage sample relates to the terminal voltage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VoltageKind {
    /// The terminal voltage at the instant of the sample.
    #[default]
    Instantaneous,
    /// A commanded voltage, held from the sample to the next one.
    Hold,
}

/// What feeds the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Supply {
    /// The mains.
    #[default]
    Grid,
    /// A frequency converter.
    Inverter,
}

/// What is known about the load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoadTorque {
    /// The `torque` column is the brake torque at the shaft, without friction and windage.
    Measured,
    /// Friction is the only load.
    Friction,
    /// Declared to be unknown.
    Free,
    /// Not declared: what the motor file says holds.
    #[default]
    Undeclared,
}

/// The state in which the recording begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StartsFrom {
    /// Shaft at rest, no flux in the machine.
    Standstill,
    /// Already turning.
    Running,
    /// Not declared.
    #[default]
    Unknown,
}

/// The instrument, as far as it is declared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sensors {
    /// Largest voltage magnitude that the instrument can show, V.
    pub voltage_full_scale_volt: Option<f64>,
    /// Largest current magnitude that the instrument can show, A.
    pub current_full_scale_amp: Option<f64>,
    /// Largest speed magnitude that the instrument can show, rad/s.
    pub speed_full_scale_rad_s: Option<f64>,
    /// Largest torque magnitude that the instrument can show, N m.
    pub torque_full_scale_nm: Option<f64>,
    /// Standard deviation of the noise over the full scale, the same for every channel.
    pub noise_sigma_fraction_of_full_scale: Option<f64>,
    /// Bits of the converter, whose codes span minus to plus full scale.
    pub adc_bits: Option<u32>,
    /// Pulses of the encoder in one turn of the shaft, of one track.
    pub encoder_pulses_per_revolution: Option<u32>,
    /// Edges counted per pulse: 1, 2 or 4.
    pub encoder_edges_per_pulse: Option<u32>,
    /// Bits after which the counter wraps; without it the counter is taken never to wrap.
    pub encoder_counter_bits: Option<u32>,
}

impl Sensors {
    /// The declared full scale of a channel, in its SI unit.
    pub fn full_scale(&self, channel: Channel) -> Option<f64> {
        match channel.quantity() {
            Quantity::Voltage => self.voltage_full_scale_volt,
            Quantity::Current => self.current_full_scale_amp,
            Quantity::Speed => self.speed_full_scale_rad_s,
            Quantity::Torque => self.torque_full_scale_nm,
            Quantity::Time | Quantity::Temperature => None,
        }
    }

    /// One step of the converter, in the channel's SI unit: `2 full scale / 2^bits`.
    pub fn step(&self, channel: Channel) -> Option<f64> {
        let bits = i32::try_from(self.adc_bits?).ok()?;
        Some(2.0 * self.full_scale(channel)? / 2f64.powi(bits))
    }

    /// Standard deviation of one sample: noise and the rounding of the converter (step / sqrt 12).
    ///
    /// `None` when neither is declared.
    pub fn sigma(&self, channel: Channel) -> Option<f64> {
        let noise = self
            .noise_sigma_fraction_of_full_scale
            .zip(self.full_scale(channel))
            .map(|(fraction, full_scale)| fraction * full_scale);
        let rounding = self.step(channel).map(|step| step / 12f64.sqrt());
        match (noise, rounding) {
            (None, None) => None,
            (noise, rounding) => Some(noise.unwrap_or(0.0).hypot(rounding.unwrap_or(0.0))),
        }
    }
}

/// The sidecar of a recording, without its column mapping.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// How a voltage sample relates to the terminal voltage.
    pub voltage: VoltageKind,
    /// What feeds the motor.
    pub supply: Supply,
    /// What the user believes the supply to be, in words.
    pub supply_belief: String,
    /// What is known about the load.
    pub load_torque: LoadTorque,
    /// The state in which the recording begins.
    pub starts_from: StartsFrom,
    /// The instrument.
    pub sensors: Sensors,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_of_a_twelve_bit_converter_spans_both_signs() {
        let sensors = Sensors {
            voltage_full_scale_volt: Some(600.0),
            adc_bits: Some(12),
            noise_sigma_fraction_of_full_scale: Some(0.002),
            ..Sensors::default()
        };
        let va = Channel::VOLTAGES[0];
        // 1200 V over 4096 codes.
        assert!((sensors.step(va).unwrap() - 0.292_968_75).abs() < 1e-12);
        let sigma = (1.2f64 * 1.2 + 0.292_968_75f64.powi(2) / 12.0).sqrt();
        assert!((sensors.sigma(va).unwrap() - sigma).abs() < 1e-12);
        assert_eq!(sensors.sigma(Channel::SPEED), None);
    }
}
