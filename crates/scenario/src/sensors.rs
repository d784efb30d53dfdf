//! `[sensors]`: the instruments, where they differ from those of the motor file.

use crate::chain::{self, SignalChain};
use document::{Bounds, Section};
use motor::MotorFile;
use motor::motor_file::{LoadKind, Sensors};

/// Where a recorded speed comes from. The encoder count is simulated in any case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedSensor {
    /// An analogue tachometer with noise and resolution like every other channel.
    Tachometer,
    /// Encoder counts over the last 10 ms.
    Encoder,
    /// No speed is recorded.
    None,
}

/// The instruments of an experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorSpec {
    /// Ranges, resolution, noise and calibration.
    pub instrument: Sensors,
    /// Whether signals are rounded to the steps of the ADC and limited to its range.
    pub quantise: bool,
    /// Where a recorded speed comes from.
    pub speed: SpeedSensor,
    /// Whether the shaft torque is recorded.
    pub torque: bool,
    /// Filters, delays and errors between sensor and code; none where nothing is said.
    pub chain: Option<SignalChain>,
}

impl SensorSpec {
    /// The instruments of a motor file; torque where the load is measured.
    pub fn of(motor: &MotorFile) -> SensorSpec {
        SensorSpec {
            instrument: motor.sensors,
            quantise: true,
            speed: SpeedSensor::Tachometer,
            torque: motor.load == LoadKind::Measured,
            chain: None,
        }
    }

    /// What the simulated board is told of its motor: without a chain of their own its channels are not late, and its codes are
    /// sums of as many as its chain adds.
    pub fn told(&self, motor: &MotorFile) -> MotorFile {
        let mut told = motor.clone();
        match &self.chain {
            Some(chain) => told.sensors.conversions = chain.conversions,
            None => told.sensors = told.sensors.without_delays(),
        }
        told
    }

    /// Perfect instruments: no noise, no steps, no limits, no chain.
    #[must_use]
    pub fn ideal(mut self) -> SensorSpec {
        self.instrument.noise_sigma_fraction_of_full_scale = 0.0;
        self.quantise = false;
        self.chain = None;
        self
    }
}

const NOISE: Bounds = Bounds::between(0.0, 0.5, "of full scale").hint("0.002 is 0.2 %");
const BITS: Bounds = Bounds::between(6.0, 16.0, "bit");
const PULSES: Bounds = Bounds::between(1.0, 1e6, "pulses");
const VOLTAGE: Bounds = Bounds::above(0.0, 1e6, "V");
const CURRENT: Bounds = Bounds::above(0.0, 1e6, "A");
const SPEEDS: [(&str, SpeedSensor); 3] = [
    ("tachometer", SpeedSensor::Tachometer),
    ("encoder", SpeedSensor::Encoder),
    ("none", SpeedSensor::None),
];

/// `duration_s` is how long a drifting reference drifts.
pub(super) fn read(
    root: &Section<'_>,
    motor: &MotorFile,
    duration_s: Option<f64>,
) -> Option<SensorSpec> {
    let base = SensorSpec::of(motor);
    let Some(section) = root.optional_section("sensors")? else {
        return Some(base);
    };
    let spec = read_values(&section, &base, duration_s);
    section.finish();
    spec
}

fn read_values(
    section: &Section<'_>,
    base: &SensorSpec,
    duration_s: Option<f64>,
) -> Option<SensorSpec> {
    let own = &base.instrument;
    let noise = section.number_or(
        "noise_sigma_fraction_of_full_scale",
        &NOISE,
        own.noise_sigma_fraction_of_full_scale,
    );
    let voltage = section.number_or(
        "voltage_full_scale_volt",
        &VOLTAGE,
        own.voltage_full_scale_volt,
    );
    let current = section.number_or(
        "current_full_scale_amp",
        &CURRENT,
        own.current_full_scale_amp,
    );
    let bits = section.integer_or("adc_bits", &BITS, own.adc_bits);
    let pulses = section.integer_or(
        "encoder_pulses_per_revolution",
        &PULSES,
        own.encoder_pulses_per_revolution,
    );
    let quantise = section.flag_or("quantise", base.quantise);
    let speed = section.choice_or("speed", &SPEEDS, base.speed);
    let torque = section.flag_or("torque", base.torque);
    let chain = chain::read(section, duration_s, bits);
    Some(SensorSpec {
        instrument: Sensors {
            noise_sigma_fraction_of_full_scale: noise?,
            voltage_full_scale_volt: voltage?,
            current_full_scale_amp: current?,
            adc_bits: bits?,
            encoder_pulses_per_revolution: pulses?,
            ..*own
        },
        quantise: quantise?,
        speed: speed?,
        torque: torque?,
        chain: chain?,
    })
}
