//! The monitor's configuration from a motor file (feature `motor-file`; hosts and build scripts only).

use motor::motor_file::{self, MotorFile, Sensors};
use motor::{Mechanics, TParams};

use crate::config::{LoadKind, MonitorConfig};
use crate::convert::{ChannelScale, Converter};
use crate::frames::Abc;
use crate::operating_point::Frame;
use crate::residuals::FieldCurrent;
use crate::threshold::ComparatorConfig;

/// Quadrature counts per encoder pulse.
const COUNTS_PER_PULSE: f32 = 4.0;

impl MonitorConfig {
    /// For samples every `t_sample` seconds. Still to be checked by [`crate::Monitor::new`].
    pub fn from_motor_file(file: &MotorFile, t_sample: f64) -> Self {
        let plate = &file.nameplate;
        let settings = &file.monitor;
        MonitorConfig {
            t_sample: t_sample as f32,
            converter: converter(&file.sensors),
            encoder_counts_per_revolution: COUNTS_PER_PULSE
                * file.sensors.encoder_pulses_per_revolution as f32,
            params: single(&file.parameters),
            mechanics: single_mechanics(&file.mechanics),
            rated_voltage: plate.phase_voltage_amplitude() as f32,
            rated_current: plate.current_amplitude() as f32,
            rated_omega: plate.omega_sync() as f32,
            rated_torque: plate.torque_nm as f32,
            frame: match settings.frame {
                motor_file::Frame::RotorFlux => Frame::RotorFlux,
                motor_file::Frame::Voltage => Frame::Voltage,
            },
            field: field(file),
            load: load(file),
            thresholds: settings
                .threshold_percent
                .map(|percent| (percent / 100.0) as f32),
            window_cycles: settings.window_cycles as usize,
            comparator: ComparatorConfig {
                persistence: settings.persistence_windows.min(255) as u8,
                hysteresis: settings.hysteresis as f32,
            },
        }
    }
}

/// Rounds the electrical parameters to the board's precision.
pub fn single(p: &TParams<f64>) -> TParams<f32> {
    TParams {
        r_s: p.r_s as f32,
        r_r: p.r_r as f32,
        l_ls: p.l_ls as f32,
        l_lr: p.l_lr as f32,
        l_m: p.l_m as f32,
    }
}

/// Rounds the mechanical parameters to the board's precision.
pub fn single_mechanics(m: &Mechanics<f64>) -> Mechanics<f32> {
    Mechanics {
        n_p: m.n_p as f32,
        inertia: m.inertia as f32,
        friction: m.friction as f32,
        load_friction: m.load_friction as f32,
    }
}

fn converter(sensors: &Sensors) -> Converter {
    let scale = |full_scale: f64, gain: [f64; 3], offset: [f64; 3]| ChannelScale {
        gain: Abc::from_array(gain.map(|x| x as f32)),
        offset: Abc::from_array(offset.map(|x| x as f32)),
        ..ChannelScale::bipolar(full_scale as f32, sensors.adc_bits as u8)
    };
    Converter {
        voltage: scale(
            sensors.voltage_full_scale_volt,
            sensors.voltage_gain,
            sensors.voltage_offset_volt,
        ),
        current: scale(
            sensors.current_full_scale_amp,
            sensors.current_gain,
            sensors.current_offset_amp,
        ),
        ..Converter::bipolar(1.0, 1.0, sensors.adc_bits as u8)
    }
}

/// A friction load of zero friction declares nothing about the load: it is free.
fn load(file: &MotorFile) -> LoadKind {
    match file.load {
        motor_file::LoadKind::Friction if file.mechanics.total_friction() > 0.0 => {
            LoadKind::Friction
        }
        motor_file::LoadKind::Friction | motor_file::LoadKind::Free => LoadKind::Free,
        motor_file::LoadKind::Measured => LoadKind::Measured,
    }
}

fn field(file: &MotorFile) -> FieldCurrent {
    match file.monitor.field_current {
        motor_file::FieldCurrent::Live => FieldCurrent::Live,
        motor_file::FieldCurrent::Nominal => {
            FieldCurrent::Nominal(file.nominal_field_current() as f32)
        }
    }
}
