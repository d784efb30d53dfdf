//! One second of a healthy 2.2 kW motor at rated torque on 50 Hz, sampled at 10 kHz: what the core lives on.

use monitor::{Converter, MonitorConfig, RawSample, Sample, SpeedSample};
use motor::MotorFile;
use motor::dynamic::phases;
use motor::steady_state::{OperatingPoint, SteadyState};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Sampling time, s.
pub const T_SAMPLE_S: f64 = 1e-4;
/// Samples of one supply cycle: a whole number, so that a sliding DFT of one cycle has no leakage either.
pub const CYCLE_SAMPLES: usize = 200;
/// Length of the signal in samples.
pub const SAMPLES: usize = 10_000;

/// The same second as codes and in SI units, and the configuration that reads it.
#[derive(Clone, Debug)]
pub struct Signals {
    /// The core's configuration.
    pub config: MonitorConfig,
    /// As the board's converters deliver it.
    pub raw: Vec<RawSample>,
    /// In SI units.
    pub samples: Vec<Sample>,
    /// The operating point that the signals show.
    pub point: OperatingPoint<f64>,
}

impl Signals {
    /// Signals of the shipped motor file `peer-2k2.toml`.
    ///
    /// # Panics
    /// When that file, part of the source tree, cannot be read.
    pub fn rated() -> Signals {
        let path = format!("{}/../motors/peer-2k2.toml", crate::FOLDER);
        let motor = MotorFile::read(path).expect("shipped");
        let plate = &motor.nameplate;
        let u_s = Complex64::new(plate.phase_voltage_amplitude(), 0.0);
        let curve = SteadyState::new(
            &motor.parameters,
            motor.mechanics.n_p,
            u_s,
            plate.omega_sync(),
        );
        let point = curve.at_torque(plate.torque_nm).expect("below breakdown");
        let config = MonitorConfig::from_motor_file(&motor, T_SAMPLE_S).expect("shipped");
        let raw: Vec<_> = (0..SAMPLES).map(|k| codes(&config, &point, k)).collect();
        Signals {
            samples: raw
                .iter()
                .map(|raw| in_si(&config.converter, raw))
                .collect(),
            config,
            raw,
            point,
        }
    }
}

fn codes(config: &MonitorConfig, point: &OperatingPoint<f64>, k: usize) -> RawSample {
    let t = k as f64 * T_SAMPLE_S;
    let turn = Complex64::from_polar(1.0, point.omega_sync * t);
    let Converter {
        voltage, current, ..
    } = &config.converter;
    let code =
        |x: f64, unit: f32, zero: f32| (x / f64::from(unit) + f64::from(zero)).round() as u16;
    let counts = point.omega_mech * t / TAU * f64::from(config.encoder_counts_per_revolution);
    RawSample {
        voltage_codes: phases(point.u_s * turn)
            .map(|x| code(x, voltage.unit_per_code, voltage.zero_code)),
        current_codes: phases(point.i_s * turn)
            .map(|x| code(x, current.unit_per_code, current.zero_code)),
        encoder_count: (counts as u64 % 65_536) as u16,
        ..RawSample::default()
    }
}

fn in_si(converter: &Converter, raw: &RawSample) -> Sample {
    Sample {
        speed: SpeedSample::Count(raw.encoder_count),
        ..converter.convert(raw)
    }
}
