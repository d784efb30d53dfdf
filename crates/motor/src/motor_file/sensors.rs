//! `[sensors]`: ranges, resolution, noise and corrections of the instrument.

use super::Nameplate;
use document::{Bounds, Section};

/// The instrument at the motor's terminals and shaft.
///
/// Every channel is bipolar: its ADC range spans minus to plus the full scale. Corrected value =
/// `(raw - offset) * gain`, so calibration finds the offset at standstill and then the gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Full scale of the phase voltages, V.
    pub voltage_full_scale_volt: f64,
    /// Full scale of the phase currents, A.
    pub current_full_scale_amp: f64,
    /// Full scale of a recorded speed, mechanical rad/s.
    pub speed_full_scale_rad_s: f64,
    /// Full scale of a recorded shaft torque, N m.
    pub torque_full_scale_nm: f64,
    /// Resolution of the ADC, bit, 6..=16: the core takes 16-bit codes.
    pub adc_bits: u32,
    /// Codes of each channel that are added up to one code of a sample, 1..=16. No key of a motor file: 1 unless somebody adds.
    pub conversions: u32,
    /// Encoder pulses per revolution of one channel, 1..=1000000 (four edges each in quadrature).
    pub encoder_pulses_per_revolution: u32,
    /// Standard deviation of the noise of every analogue channel, as a fraction of its full scale.
    pub noise_sigma_fraction_of_full_scale: f64,
    /// Offset of the voltage channels a, b, c, V.
    pub voltage_offset_volt: [f64; 3],
    /// Offset of the current channels a, b, c, A.
    pub current_offset_amp: [f64; 3],
    /// Correction factor of the voltage channels a, b, c.
    pub voltage_gain: [f64; 3],
    /// Correction factor of the current channels a, b, c.
    pub current_gain: [f64; 3],
    /// By how much the board's voltage channels a, b, c are late, s, -5e-5..=2e-4.
    pub voltage_delay_s: [f64; 3],
    /// By how much the board's current channels a, b, c are late, s, -5e-5..=2e-4.
    pub current_delay_s: [f64; 3],
    /// Time constant `T` of the roll-off `1 - (w T)^2/2` of all of the board's channels, s, 0..=3e-4.
    pub roll_off_s: f64,
    /// Whether the sensors of voltages and of currents follow the converter's supply, so that it does not show in their codes.
    pub ratiometric: [bool; 2],
}

/// A 12-bit ADC is what microcontrollers have.
const ADC_BITS: u32 = 12;
/// The encoder of the published bench (E6B2-CWZ3E).
const ENCODER_PULSES: u32 = 1024;
/// Twice the rated amplitude: 10 % overvoltage, harmonics, and a star point that moves by half.
const VOLTAGE_HEADROOM: f64 = 2.0;
/// Ten times the rated amplitude: the direct-on-line inrush of a 4 kW motor was measured at 7.5.
const CURRENT_HEADROOM: f64 = 10.0;
/// Synchronous speed and half as much again: above it the supply has left its range.
const SPEED_HEADROOM: f64 = 1.5;
/// Breakdown torque is 2 to 3 times rated; more cannot be held at the shaft.
const TORQUE_HEADROOM: f64 = 3.0;

impl Sensors {
    /// The instrument that suits a nameplate, ideal in offset, gain and noise.
    pub fn suited_to(nameplate: &Nameplate) -> Sensors {
        Sensors {
            voltage_full_scale_volt: VOLTAGE_HEADROOM * nameplate.phase_voltage_amplitude(),
            current_full_scale_amp: CURRENT_HEADROOM * nameplate.current_amplitude(),
            speed_full_scale_rad_s: SPEED_HEADROOM * nameplate.synchronous_speed_mech(),
            torque_full_scale_nm: TORQUE_HEADROOM * nameplate.torque_nm,
            adc_bits: ADC_BITS,
            conversions: 1,
            encoder_pulses_per_revolution: ENCODER_PULSES,
            noise_sigma_fraction_of_full_scale: 0.0,
            voltage_offset_volt: [0.0; 3],
            current_offset_amp: [0.0; 3],
            voltage_gain: [1.0; 3],
            current_gain: [1.0; 3],
            voltage_delay_s: [0.0; 3],
            current_delay_s: [0.0; 3],
            roll_off_s: 0.0,
            ratiometric: [false; 2],
        }
    }

    /// The same instrument with channels that are not late: that of a simulation without a chain of its own.
    #[must_use]
    pub fn without_delays(self) -> Sensors {
        Sensors {
            voltage_delay_s: [0.0; 3],
            current_delay_s: [0.0; 3],
            roll_off_s: 0.0,
            ..self
        }
    }

    /// Volts per ADC code.
    pub fn volt_per_code(&self) -> f64 {
        self.voltage_full_scale_volt / self.codes_per_side()
    }

    /// Amperes per ADC code.
    pub fn amp_per_code(&self) -> f64 {
        self.current_full_scale_amp / self.codes_per_side()
    }

    /// Codes from zero to full scale: half the ADC's range.
    fn codes_per_side(&self) -> f64 {
        f64::from(1_u32 << (self.adc_bits - 1))
    }
}

const VOLTAGE: Bounds = Bounds::above(0.0, 1e6, "V");
const CURRENT: Bounds = Bounds::above(0.0, 1e6, "A");
const SPEED: Bounds = Bounds::above(0.0, 1e5, "rad/s").hint("rad/s, not rpm");
const TORQUE: Bounds = Bounds::above(0.0, 1e8, "N m");
const BITS: Bounds = Bounds::between(6.0, 16.0, "bit");
const PULSES: Bounds = Bounds::between(1.0, 1e6, "pulses");
const NOISE: Bounds = Bounds::between(0.0, 0.5, "of full scale").hint("0.002 is 0.2 %");
const VOLTAGE_OFFSET: Bounds = Bounds::between(-1e5, 1e5, "V");
const CURRENT_OFFSET: Bounds = Bounds::between(-1e5, 1e5, "A");
const GAIN: Bounds =
    Bounds::between(-10.0, 10.0, "").hint("a factor near 1; negative turns polarity");

const DELAY: Bounds =
    Bounds::between(-50.0, 200.0, "us").hint("the documented front end has 90 us");
const ROLL_OFF: Bounds =
    Bounds::between(0.0, 300.0, "us").hint("the documented front end has 78.5 us");
pub(super) const REFERENCES: [(&str, bool); 2] = [("absolute", false), ("ratiometric", true)];
pub(super) const MICROSECOND: f64 = 1e-6;

pub(super) fn read(root: &Section<'_>, nameplate: Option<&Nameplate>) -> Option<Sensors> {
    let section = root.optional_section("sensors")?;
    let base = Sensors::suited_to(nameplate?);
    let Some(section) = section else {
        return Some(base);
    };
    let sensors = read_values(&section, &base);
    if let Some(sensors) = &sensors {
        check_gains(&section, sensors);
        check_ranges(&section, sensors, &base);
    }
    section.finish();
    sensors
}

fn read_values(section: &Section<'_>, base: &Sensors) -> Option<Sensors> {
    let number = |key, bounds: &Bounds, default| section.number_or(key, bounds, default);
    let triple = |key, bounds: &Bounds, default| {
        let read = section.optional_numbers::<3>(key, bounds)?;
        Some(read.unwrap_or(default))
    };
    let voltage = number(
        "voltage_full_scale_volt",
        &VOLTAGE,
        base.voltage_full_scale_volt,
    );
    let current = number(
        "current_full_scale_amp",
        &CURRENT,
        base.current_full_scale_amp,
    );
    let speed = number(
        "speed_full_scale_rad_s",
        &SPEED,
        base.speed_full_scale_rad_s,
    );
    let torque = number("torque_full_scale_nm", &TORQUE, base.torque_full_scale_nm);
    let noise = number("noise_sigma_fraction_of_full_scale", &NOISE, 0.0);
    let bits = section.integer_or("adc_bits", &BITS, base.adc_bits);
    let pulses = section.integer_or("encoder_pulses_per_revolution", &PULSES, ENCODER_PULSES);
    let voltage_offset = triple("voltage_offset_volt", &VOLTAGE_OFFSET, [0.0; 3]);
    let current_offset = triple("current_offset_amp", &CURRENT_OFFSET, [0.0; 3]);
    let voltage_gain = triple("voltage_gain", &GAIN, [1.0; 3]);
    let current_gain = triple("current_gain", &GAIN, [1.0; 3]);
    let voltage_delay = triple("voltage_delay_us", &DELAY, [0.0; 3]);
    let current_delay = triple("current_delay_us", &DELAY, [0.0; 3]);
    let roll_off = number("roll_off_us", &ROLL_OFF, 0.0);
    let voltage_reference = section.choice_or("voltage_reference", &REFERENCES, false);
    let current_reference = section.choice_or("current_reference", &REFERENCES, false);
    Some(Sensors {
        voltage_full_scale_volt: voltage?,
        current_full_scale_amp: current?,
        speed_full_scale_rad_s: speed?,
        torque_full_scale_nm: torque?,
        adc_bits: bits?,
        conversions: base.conversions,
        encoder_pulses_per_revolution: pulses?,
        noise_sigma_fraction_of_full_scale: noise?,
        voltage_offset_volt: voltage_offset?,
        current_offset_amp: current_offset?,
        voltage_gain: voltage_gain?,
        current_gain: current_gain?,
        voltage_delay_s: voltage_delay?.map(|us| us * MICROSECOND),
        current_delay_s: current_delay?.map(|us| us * MICROSECOND),
        roll_off_s: roll_off? * MICROSECOND,
        ratiometric: [voltage_reference?, current_reference?],
    })
}

fn check_gains(section: &Section<'_>, sensors: &Sensors) {
    let gains = [
        ("voltage_gain", sensors.voltage_gain),
        ("current_gain", sensors.current_gain),
    ];
    for (key, gain) in gains {
        if gain.contains(&0.0) {
            section.report(
                key,
                "0 would silence a channel: write a factor near 1 for each of a, b, c",
            );
        }
    }
}

/// A range that the rated amplitude does not fit in clips in normal service.
fn check_ranges(section: &Section<'_>, sensors: &Sensors, base: &Sensors) {
    let ranges = [
        (
            "voltage_full_scale_volt",
            sensors.voltage_full_scale_volt,
            base.voltage_full_scale_volt / VOLTAGE_HEADROOM,
            "V",
        ),
        (
            "current_full_scale_amp",
            sensors.current_full_scale_amp,
            base.current_full_scale_amp / CURRENT_HEADROOM,
            "A",
        ),
    ];
    for (key, full_scale, amplitude, unit) in ranges {
        if full_scale < amplitude {
            section.report(
                key,
                format!(
                    "{full_scale} {unit} is below the rated amplitude {amplitude:.4} {unit}: the channel would clip; \
                     write the range of the sensor, an amplitude and not an rms value"
                ),
            );
        }
    }
}
