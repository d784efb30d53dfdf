//! A board's channels with what is left of their errors, and the samples that it shows.

use std::f64::consts::TAU;

use monitor::{Abc, CHANNELS, ClippedChannels, Converter, RawSample, Sample};
use motor::motor_file::Sensors;
use num_complex::Complex64;
use rand::Rng;
use rand_pcg::Pcg64;
use scenario::simulate::{SimSample, Simulation};

use super::weather::{normal, signed};
use crate::runs::run::T_SAMPLE_S;

/// What a calibration of the channels leaves, share: docs/wiring.md.
const GAIN_LEFT: f64 = 0.001;
/// Amplifiers 45 ppm/K, transducers 40 ppm/K, resistors 25 ppm/K: the largest of a channel, 1/K.
const DRIFT_PER_KELVIN: f64 = 70e-6;
/// All channels alike, through the reference that they are measured with, 1/K.
const REFERENCE_PER_KELVIN: f64 = 10e-6;
/// Standard deviation of what is left of a channel's delay, s: 500 boards within 2.2 us between voltage and current.
const DELAY_LEFT_S: f64 = 0.5e-6;
/// Largest offset, share of full scale: it is taken off at standstill and drifts.
const OFFSET_LEFT: f64 = 0.002;

/// Errors of the six channels: voltages a, b, c, then currents a, b, c.
#[derive(Clone, Debug)]
pub struct Instrument {
    gain_error: [f64; CHANNELS],
    drift_per_kelvin: [f64; CHANNELS],
    delay_s: [f64; CHANNELS],
    offset_share: [f64; CHANNELS],
    /// Temperature of the cabinet when the channels were calibrated, degC.
    calibrated_degc: f64,
    /// Ranges, resolution, noise and encoder as the board is told.
    pub sensors: Sensors,
}

impl Instrument {
    /// A board within the tolerances of docs/wiring.md, its channels calibrated and its delays known, in a cabinet.
    pub fn draw(sensors: Sensors, random: &mut Pcg64) -> Instrument {
        let reference = REFERENCE_PER_KELVIN * signed(random);
        Instrument {
            gain_error: std::array::from_fn(|_| GAIN_LEFT * signed(random)),
            drift_per_kelvin: std::array::from_fn(|_| {
                reference + DRIFT_PER_KELVIN * signed(random)
            }),
            delay_s: std::array::from_fn(|_| DELAY_LEFT_S * normal(random)),
            offset_share: std::array::from_fn(|_| OFFSET_LEFT * signed(random)),
            calibrated_degc: random.random_range(18.0..28.0),
            sensors,
        }
    }

    /// Gains by which the true values are shown, with the cabinet at this temperature, degC.
    fn gains(&self, cabinet_degc: f64) -> [f64; CHANNELS] {
        let kelvin = cabinet_degc - self.calibrated_degc;
        std::array::from_fn(|k| 1.0 + self.gain_error[k] + self.drift_per_kelvin[k] * kelvin)
    }

    /// What becomes of the phasor of each channel at a supply frequency, Hz.
    pub fn factors(&self, cabinet_degc: f64, hertz: f64) -> [Complex64; CHANNELS] {
        let gains = self.gains(cabinet_degc);
        std::array::from_fn(|k| Complex64::from_polar(gains[k], -TAU * hertz * self.delay_s[k]))
    }

    /// What the channels show at zero, V and A.
    pub fn offsets(&self) -> [f64; CHANNELS] {
        std::array::from_fn(|k| self.offset_share[k] * self.full_scale(k))
    }

    /// Standard deviation of a sample's noise, that of its resolution included, V and A.
    pub fn sigmas(&self) -> [f64; CHANNELS] {
        let step = 2.0 / 2f64.powi(self.sensors.adc_bits as i32);
        let noise = self.sensors.noise_sigma_fraction_of_full_scale;
        let share = (noise * noise + step * step / 12.0).sqrt();
        std::array::from_fn(|k| share * self.full_scale(k))
    }

    fn full_scale(&self, channel: usize) -> f64 {
        match channel {
            0..3 => self.sensors.voltage_full_scale_volt,
            _ => self.sensors.current_full_scale_amp,
        }
    }

    /// The instrument of a simulation: gains and offsets as the simulator's sensors take them.
    pub fn simulated(&self, cabinet_degc: f64) -> Sensors {
        let gains = self.gains(cabinet_degc);
        let offsets = self.offsets();
        let of = |x: [f64; CHANNELS], first: usize| -> [f64; 3] {
            std::array::from_fn(|k| x[first + k])
        };
        let corrections = gains.map(|gain| 1.0 / gain);
        Sensors {
            voltage_gain: of(corrections, 0),
            current_gain: of(corrections, 3),
            voltage_offset_volt: of(offsets, 0),
            current_offset_amp: of(offsets, 3),
            ..self.sensors
        }
    }
}

/// Samples of a simulation as the board's core sees them, from ADC codes; delays by straight lines between samples.
#[derive(Debug)]
pub struct Shown {
    simulation: Simulation,
    converter: Converter,
    delay_samples: [f32; CHANNELS],
    before: Option<[f32; CHANNELS]>,
    backwards: bool,
}

impl Shown {
    /// What `instrument` shows of a simulation, in the mirror where the motor runs backwards.
    pub fn new(
        simulation: Simulation,
        converter: Converter,
        instrument: &Instrument,
        backwards: bool,
    ) -> Shown {
        let delay_samples = instrument.delay_s.map(|s| (s / T_SAMPLE_S) as f32);
        Shown {
            simulation,
            converter,
            delay_samples,
            before: None,
            backwards,
        }
    }

    fn late(&mut self, sample: Sample) -> Sample {
        let [u, i] = [sample.u_s_abc, sample.i_s_abc].map(|x| x.unwrap_or_default().to_array());
        let now: [f32; CHANNELS] = std::array::from_fn(|k| if k < 3 { u[k] } else { i[k - 3] });
        let before = self.before.replace(now).unwrap_or(now);
        let late: [f32; CHANNELS] =
            std::array::from_fn(|k| now[k] - self.delay_samples[k] * (now[k] - before[k]));
        let abc = |first: usize| {
            Some(Abc {
                a: late[first],
                b: late[first + 1],
                c: late[first + 2],
            })
        };
        Sample {
            u_s_abc: abc(0),
            i_s_abc: abc(3),
            ..sample
        }
    }
}

impl Iterator for Shown {
    type Item = (SimSample, Sample);

    fn next(&mut self) -> Option<Self::Item> {
        let sample = self.simulation.next()?;
        let measured = &sample.measured;
        let mut raw = RawSample {
            voltage_codes: measured.voltage_codes,
            current_codes: measured.current_codes,
            encoder_count: measured.encoder_count,
            clipped: ClippedChannels::of(measured.clipped),
        };
        if self.backwards {
            raw.encoder_count = raw.encoder_count.wrapping_neg();
        }
        let shown = self.converter.convert(&raw);
        let shown = self.late(shown);
        Some((
            sample,
            if self.backwards {
                mirrored(shown)
            } else {
                shown
            },
        ))
    }
}

/// Phases b and c exchanged.
fn mirrored(sample: Sample) -> Sample {
    let swap = |x: Option<Abc>| {
        x.map(|x| Abc {
            b: x.c,
            c: x.b,
            ..x
        })
    };
    Sample {
        u_s_abc: swap(sample.u_s_abc),
        i_s_abc: swap(sample.i_s_abc),
        ..sample
    }
}
