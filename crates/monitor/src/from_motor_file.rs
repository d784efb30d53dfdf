//! The monitor's configuration from a motor file (feature `motor-file`; hosts and build scripts only).

use motor::effects::{self, EffectConfig, SteadyEffect};
use motor::motor_file::{self, HealthySettings, MotorFile, Sensors};
use motor::{Mechanics, TParams};

use crate::config::{LoadKind, MonitorConfig};
use crate::convert::{ChannelScale, Converter};
use crate::effects::{ActiveEffect, ActiveEffects, MAX_EFFECT_PARAMETERS, MAX_EFFECTS};
use crate::frames::Abc;
use crate::isolation::{Healthy, Uncertainty};
use crate::operating_point::Frame;
use crate::phasor::CHANNELS;
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
            effects: active_effects(file),
            channel_gain: channel_gain(file),
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
            healthy: file.healthy.as_ref().map(healthy),
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

/// The motor file's effects; whoever reads the file checks them with [`effects::from_motor_file`] and their number.
fn effects_of(file: &MotorFile) -> impl Iterator<Item = EffectConfig> {
    let configs = effects::from_motor_file(file, &file.name);
    configs.unwrap_or_default().into_iter()
}

fn active_effects(file: &MotorFile) -> ActiveEffects {
    let mut active = [None; MAX_EFFECTS];
    for (slot, config) in active.iter_mut().zip(effects_of(file)) {
        let mut parameters = [0.0; MAX_EFFECT_PARAMETERS];
        for (parameter, value) in parameters.iter_mut().zip(&config.values) {
            *parameter = *value as f32;
        }
        let effect: &'static dyn SteadyEffect = config.effect;
        *slot = Some(ActiveEffect { effect, parameters });
    }
    active
}

/// Effects that name single channels leave the positive sequence to the channel itself.
const CHANNEL_EFFECTS: [(&str, usize); 2] = [("phase-voltage-gain", 0), ("phase-current-gain", 3)];

/// What brings each channel back to the truth: one over the gain that a channel effect found.
fn channel_gain(file: &MotorFile) -> [f32; CHANNELS] {
    let mut gains = [1.0; CHANNELS];
    for config in effects_of(file) {
        let name = config.effect.descriptor().name;
        let first = CHANNEL_EFFECTS.iter().find(|(known, _)| *known == name);
        if let Some((_, first)) = first {
            for (gain, value) in gains.iter_mut().skip(*first).zip(&config.values) {
                *gain = (1.0 / (1.0 + value)) as f32;
            }
        }
    }
    gains
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

fn healthy(settings: &HealthySettings) -> Healthy {
    let share = |percent: f64| (percent / 100.0) as f32;
    Healthy {
        mean: settings.mean_percent.map(share),
        scatter: settings.scatter_percent.map(share),
        current_unbalance: settings.current_unbalance_percent.map(share),
        current_unbalance_scatter: share(settings.current_unbalance_scatter_percent),
        turns_axis: {
            let (im, re) = settings.turns_angle_deg.to_radians().sin_cos();
            [re as f32, im as f32]
        },
        uncertainty: Uncertainty {
            stator_resistance: share(settings.stator_resistance_percent),
            rotor_resistance: share(settings.rotor_resistance_percent),
            heating: share(settings.heating_percent),
            magnetizing_inductance: share(settings.magnetizing_inductance_percent),
            leakage: share(settings.leakage_percent),
            friction: share(settings.friction_percent),
            current_gain: share(settings.current_gain_percent),
            voltage_gain: share(settings.voltage_gain_percent),
            speed: share(settings.speed_percent),
            negative_impedance: share(settings.negative_impedance_percent),
        },
        significance: settings.significance as f32,
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
