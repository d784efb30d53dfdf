//! The monitor's configuration from a motor file (feature `motor-file`; hosts and build scripts only).

use std::format;
use std::vec::Vec;

use motor::FileError;
use motor::effect;
use motor::effect::curve::{SteadyCurve, knots_and_values};
use motor::effect::{EffectConfig, Instrument, SteadyEffect};
use motor::motor_file::{self, HealthySettings, MotorFile, Sensors};
use motor::{Mechanics, TParams};

use crate::checks::cage::{Cage, HealthySidebands};
use crate::config::{LoadKind, MonitorConfig};
use crate::input::chain::AnalogueChain;
use crate::input::converter::{ChannelScale, Converter};
use crate::input::sample::CHANNELS;
use crate::isolation::{CalibratedRange, Healthy, Uncertainty};
use crate::lamps::threshold::ComparatorConfig;
use crate::model::doubt::{CIRCUIT, DEVIATIONS, ParameterDoubt};
use crate::model::effects::{
    ActiveEffect, ActiveEffects, ActiveLaws, MAX_EFFECT_PARAMETERS, MAX_EFFECTS, MAX_LAWS,
};
use crate::model::operating_point::Frame;
use crate::model::residuals::FieldCurrent;
use frames::Abc;

/// Quadrature counts per encoder pulse.
const COUNTS_PER_PULSE: f32 = 4.0;

/// Keys of the T model's parameters, in the order of [`ParameterDoubt::circuit`].
const CIRCUIT_KEYS: [&str; CIRCUIT] = [
    "stator_resistance_ohm",
    "rotor_resistance_ohm",
    "stator_leakage_henry",
    "rotor_leakage_henry",
    "magnetizing_inductance_henry",
];

impl MonitorConfig {
    /// For samples every `t_sample` seconds. Still to be checked by [`crate::Monitor::new`].
    ///
    /// # Errors
    /// Effects that the library refuses, or more than [`MAX_EFFECTS`]: in a motor made by a program only, since a file is
    /// checked when it is read.
    pub fn from_motor_file(file: &MotorFile, t_sample: f64) -> Result<Self, FileError> {
        let (laws, effects) = effects_of(file)?;
        let laws = active_laws(file, &laws)?;
        let plate = &file.nameplate;
        let settings = &file.monitor;
        Ok(MonitorConfig {
            t_sample: t_sample as f32,
            converter: converter(&file.sensors),
            encoder_counts_per_revolution: COUNTS_PER_PULSE
                * file.sensors.encoder_pulses_per_revolution as f32,
            params: single(&file.parameters),
            effects: active_effects(&effects),
            laws,
            channel_gain: channel_gain(&effects),
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
            cage: cage(file),
            doubt: doubt(file, &effects),
        })
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

/// Laws and effects of a motor file.
fn effects_of(file: &MotorFile) -> Result<(Vec<EffectConfig>, Vec<EffectConfig>), FileError> {
    let all = effect::from_motor_file(file, &file.name)?;
    let (laws, effects): (Vec<_>, Vec<_>) = all.into_iter().partition(|e| e.effect.law().is_some());
    let count = effects.len();
    match effects.get(MAX_EFFECTS) {
        None => Ok((laws, effects)),
        Some(_) => Err(FileError::whole(
            &file.name,
            format!(
                "has {count} effects, but the core takes at most {MAX_EFFECTS}: remove the smallest"
            ),
        )),
    }
}

fn active_laws(file: &MotorFile, laws: &[EffectConfig]) -> Result<ActiveLaws, FileError> {
    let mut active = [None; MAX_LAWS];
    if laws.len() > MAX_LAWS {
        let (count, name) = (laws.len(), &file.name);
        let message =
            format!("has {count} curves, but the core takes at most {MAX_LAWS}: remove one");
        return Err(FileError::whole(name, message));
    }
    for (slot, config) in active.iter_mut().zip(laws) {
        *slot = knots_and_values(config)
            .and_then(|(action, knots, values)| SteadyCurve::new(action, knots, values));
    }
    Ok(active)
}

fn active_effects(effects: &[EffectConfig]) -> ActiveEffects {
    let mut active = [None; MAX_EFFECTS];
    for (slot, config) in active.iter_mut().zip(effects) {
        let mut parameters = [0.0; MAX_EFFECT_PARAMETERS];
        for (parameter, value) in parameters.iter_mut().zip(&config.values) {
            *parameter = *value as f32;
        }
        let effect: &'static dyn SteadyEffect = config.effect;
        *slot = Some(ActiveEffect { effect, parameters });
    }
    active
}

/// Standard deviations of the logarithms of the parameters that have an interval.
fn doubt(file: &MotorFile, effects: &[EffectConfig]) -> ParameterDoubt {
    // A calibrated motor was measured: its statistics say what is in doubt.
    let (Some(uncertainty), None) = (&file.uncertainty, &file.healthy) else {
        return ParameterDoubt::default();
    };
    let deviation = |key: &str| uncertainty.log_deviation(key).unwrap_or(0.0) as f32;
    let mut doubt = ParameterDoubt {
        circuit: CIRCUIT_KEYS.map(deviation),
        ..ParameterDoubt::default()
    };
    let rated = effect::rated(file);
    for (sigmas, config) in doubt.effects.iter_mut().zip(effects) {
        let parameters = config.effect.descriptor().parameters.iter();
        for ((sigma, parameter), value) in sigmas.iter_mut().zip(parameters).zip(&config.values) {
            // Beyond its range an effect's law says nothing.
            let highest = parameter.range[1] * parameter.scale.of(&rated);
            let room = (highest / value.abs().max(f64::MIN_POSITIVE)).ln().max(0.0) as f32;
            *sigma = deviation(parameter.name).min(room / DEVIATIONS);
        }
    }
    doubt
}

/// What brings each channel back to the truth: one over the gain that an effect found in it. Such effects leave the positive
/// sequence to the channel itself.
fn channel_gain(effects: &[EffectConfig]) -> [f32; CHANNELS] {
    let mut gains = [1.0; CHANNELS];
    for config in effects {
        let first = match config.effect.gain_of() {
            Some(Instrument::Voltages) => 0,
            Some(Instrument::Currents) => 3,
            Some(Instrument::Speed | Instrument::Torque) | None => continue,
        };
        for (gain, value) in gains.iter_mut().skip(first).zip(&config.values) {
            *gain = (1.0 / (1.0 + value)) as f32;
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
        chain: chain(sensors),
        ratiometric: sensors.ratiometric,
        ..Converter::bipolar(1.0, 1.0, sensors.adc_bits as u8)
    }
    .summed(sensors.conversions as u16)
}

fn chain(sensors: &Sensors) -> AnalogueChain {
    let [a, b, c] = sensors.voltage_delay_s.map(|delay| delay as f32);
    let [d, e, f] = sensors.current_delay_s.map(|delay| delay as f32);
    AnalogueChain {
        delay: [a, b, c, d, e, f],
        roll_off: sensors.roll_off_s as f32,
    }
}

fn healthy(settings: &HealthySettings) -> Healthy {
    let share = |percent: f64| (percent / 100.0) as f32;
    Healthy {
        mean: settings.mean_percent.map(share),
        scatter: settings.scatter_percent.map(share),
        current_unbalance: settings.current_unbalance_percent.map(share),
        current_unbalance_scatter: share(settings.current_unbalance_scatter_percent),
        current_unbalance_at: share(settings.current_unbalance_at_percent),
        negative_drop: settings.negative_drop_percent.map(share),
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
            iron_loss: share(settings.iron_loss_percent),
            supply_unbalance: share(settings.supply_unbalance_percent),
            negative_impedance: share(settings.negative_impedance_percent),
        },
        range: settings.range.as_ref().map(|range| CalibratedRange {
            current: share(range.current_percent),
            volt_per_hertz: range.volt_per_hertz_percent.map(share),
            frequency: range.frequency_percent.map(share),
            active: share(range.active_percent),
        }),
        significance: settings.significance as f32,
        in_motion: settings.in_motion,
    }
}

fn cage(file: &MotorFile) -> Cage {
    let shares = |percent: [f64; 2]| percent.map(|x| (x / 100.0) as f32);
    let healthy = file.healthy.as_ref().and_then(|healthy| healthy.rotor);
    Cage {
        bars: file.nameplate.rotor_bars.unwrap_or(0) as f32,
        healthy: healthy.map(|rotor| HealthySidebands {
            at: shares(rotor.active_percent),
            lower: shares(rotor.sideband_percent),
            scatter: (rotor.scatter_percent / 100.0) as f32,
        }),
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

#[cfg(test)]
mod tests {
    use super::*;
    use motor::motor_file::EffectEntry;

    const MOTOR: &str = r#"
name = "test"
[nameplate]
pole_pairs = 2
power_watt = 300.0
voltage_line_rms_volt = 220.0
current_rms_amp = 1.3
frequency_hz = 60.0
torque_nm = 1.7
connection = "star"
[parameters]
stator_resistance_ohm = 8.0
rotor_resistance_ohm = 7.0
stator_leakage_henry = 0.028
rotor_leakage_henry = 0.035
magnetizing_inductance_henry = 0.42
inertia_kg_m2 = 0.002
friction_nm_s = 0.0008
load_friction_nm_s = 0.0035
"#;

    fn config(rest: &str) -> MonitorConfig {
        let file = MotorFile::parse(&format!("{MOTOR}{rest}"), "test.toml").expect("a valid file");
        MonitorConfig::from_motor_file(&file, 1e-4).expect("effects of the library")
    }

    /// Amplitudes of the star phase: line to line over the root of 3, rms times the root of 2.
    #[test]
    fn the_nameplate_becomes_amplitudes_per_star_phase() {
        let config = config("");
        assert_eq!(config.t_sample, 1e-4);
        assert!((config.rated_voltage - 220.0 * (2.0_f32 / 3.0).sqrt()).abs() < 1e-4);
        assert!((config.rated_current - 1.3 * 2.0_f32.sqrt()).abs() < 1e-6);
        assert!((config.rated_omega - 60.0 * core::f32::consts::TAU).abs() < 1e-4);
        assert_eq!(config.rated_torque, 1.7);
        assert_eq!(config.mechanics.n_p, 2.0);
        assert_eq!(
            (config.mechanics.inertia, config.mechanics.friction),
            (0.002, 0.0008)
        );
        assert_eq!(config.mechanics.load_friction, 0.0035);
        let p = config.params;
        assert_eq!((p.r_s, p.r_r, p.l_m), (8.0, 7.0, 0.42));
        assert_eq!((p.l_ls, p.l_lr), (0.028, 0.035));
        assert!(config.validate().is_ok());
    }

    #[test]
    fn sensors_become_codes_counts_and_corrections() {
        let config = config(
            "[sensors]\nvoltage_full_scale_volt = 400.0\ncurrent_full_scale_amp = 15.0\nadc_bits = 12\n\
             encoder_pulses_per_revolution = 1024\nvoltage_gain = [1.0, 1.1, 1.2]\ncurrent_offset_amp = [0.1, 0.2, 0.3]\n",
        );
        assert_eq!(
            config.encoder_counts_per_revolution, 4096.0,
            "four counts per pulse"
        );
        let (voltage, current) = (config.converter.voltage, config.converter.current);
        assert_eq!(config.converter.max_code, 4095);
        assert!((voltage.unit_per_code - 800.0 / 4096.0).abs() < 1e-6);
        assert!((current.unit_per_code - 30.0 / 4096.0).abs() < 1e-7);
        assert_eq!((voltage.zero_code, current.zero_code), (2048.0, 2048.0));
        assert_eq!(voltage.gain.to_array(), [1.0, 1.1, 1.2]);
        assert_eq!(current.offset.to_array(), [0.1, 0.2, 0.3]);
        assert_eq!(voltage.offset, Abc::default());
        assert_eq!(current.gain, Abc::splat(1.0));
    }

    #[test]
    fn percent_become_shares_and_settings_are_taken_over() {
        let voltage = config(
            "[monitor]\nthreshold_percent = [1.0, 2.0, 3.0, 4.0]\nwindow_cycles = 6\npersistence_windows = 4\n\
             hysteresis = 0.7\nframe = \"voltage\"\nfield_current = \"nominal\"\nnominal_field_current_amp = 1.05\n",
        );
        assert_eq!(voltage.thresholds, [0.01, 0.02, 0.03, 0.04]);
        assert_eq!(voltage.window_cycles, 6);
        assert_eq!(
            (
                voltage.comparator.persistence,
                voltage.comparator.hysteresis
            ),
            (4, 0.7)
        );
        assert_eq!(voltage.frame, Frame::Voltage);
        assert_eq!(voltage.field, FieldCurrent::Nominal(1.05));
        assert_eq!(voltage.healthy, None);
        assert_eq!(config("").frame, Frame::RotorFlux);
        assert_eq!(config("").field, FieldCurrent::Live);
    }

    #[test]
    fn friction_is_a_declared_load_only_if_there_is_some() {
        assert_eq!(
            config("[load]\nkind = \"friction\"\n").load,
            LoadKind::Friction
        );
        assert_eq!(config("[load]\nkind = \"free\"\n").load, LoadKind::Free);
        assert_eq!(
            config("[load]\nkind = \"measured\"\n").load,
            LoadKind::Measured
        );
        let mut file = MotorFile::parse(MOTOR, "test.toml").expect("a valid file");
        (file.mechanics.friction, file.mechanics.load_friction) = (0.0, 0.0);
        file.load = motor_file::LoadKind::Friction;
        let load = MonitorConfig::from_motor_file(&file, 1e-4).map(|config| config.load);
        assert_eq!(load, Ok(LoadKind::Free));
    }

    /// A channel that shows 1.25 times the truth is brought back by 0.8; other effects leave the channels alone.
    #[test]
    fn channel_effects_are_undone_in_their_channel() {
        let config = config(
            "[[effects]]\nname = \"windage\"\nwindage_nm_s2 = 1e-5\n\
             [[effects]]\nname = \"phase-current-gain\"\ncurrent_gain_a = 1.0\ncurrent_gain_b = 1.25\ncurrent_gain_c = 1.0\n\
             [[effects]]\nname = \"phase-voltage-gain\"\nvoltage_gain_a = 0.5\nvoltage_gain_b = 1.0\nvoltage_gain_c = 1.0\n",
        );
        assert_eq!(config.channel_gain, [2.0, 1.0, 1.0, 1.0, 0.8, 1.0]);
        let names = config
            .effects
            .map(|e| e.map(|e| e.effect.descriptor().name));
        let expected = ["windage", "phase-current-gain", "phase-voltage-gain"];
        assert_eq!(names[..3], expected.map(Some));
        assert_eq!(names[3], None);
        assert_eq!(config.effects[0].map(|e| e.parameters[0]), Some(1e-5));
    }

    /// A motor that a program changed: nothing of it is left out in silence.
    #[test]
    fn effects_that_the_core_cannot_take_are_an_error() {
        let motor = MotorFile::parse(MOTOR, "test.toml").expect("a valid file");
        let windage = |size| EffectEntry::with_numbers("windage", [("windage_nm_s2", size)]);
        let refused = |effects| {
            let motor = MotorFile {
                effects,
                ..motor.clone()
            };
            let config = MonitorConfig::from_motor_file(&motor, 1e-4);
            config.err().map(|error| error.to_string())
        };
        assert_eq!(refused(std::vec![windage(1e-5); MAX_EFFECTS]), None);
        let many = refused(std::vec![windage(1e-5); MAX_EFFECTS + 1]).expect("one too many");
        assert!(many.contains("at most"), "{many}");
        let large = refused(std::vec![windage(1e3)]).expect("out of range");
        assert!(large.contains("windage_nm_s2"), "{large}");
    }

    #[test]
    fn statistics_of_the_healthy_motor_become_shares() {
        let config = config(
            "[healthy]\nmean_percent = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]\n\
             scatter_percent = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]\ncurrent_unbalance_percent = [0.5, -0.5]\n\
             current_unbalance_scatter_percent = 0.05\nstator_resistance_percent = 1.0\nrotor_resistance_percent = 2.0\n\
             heating_percent = 30.0\nmagnetizing_inductance_percent = 0.2\nleakage_percent = 0.5\nfriction_percent = 3.0\n\
             current_gain_percent = 0.3\nvoltage_gain_percent = 0.4\nspeed_percent = 0.01\nnegative_impedance_percent = 10.0\n\
             turns_angle_deg = 30.0\nsignificance = 6.0\n",
        );
        let healthy = config.healthy.expect("calibrated");
        let close =
            |got: f32, expected: f32| assert!((got - expected).abs() < 1e-6, "{got} {expected}");
        for (row, (mean, scatter)) in healthy.mean.into_iter().zip(healthy.scatter).enumerate() {
            close(mean, 0.01 * (row + 1) as f32);
            close(scatter, 0.001 * (row + 1) as f32);
        }
        let [re, im] = healthy.turns_axis;
        close(re, 0.75_f32.sqrt());
        close(im, 0.5);
        close(healthy.current_unbalance[1], -0.005);
        close(healthy.current_unbalance_scatter, 0.0005);
        let u = healthy.uncertainty;
        close(u.stator_resistance, 0.01);
        close(u.rotor_resistance, 0.02);
        close(u.heating, 0.3);
        close(u.magnetizing_inductance, 0.002);
        close(u.leakage, 0.005);
        close(u.friction, 0.03);
        close(u.current_gain, 0.003);
        close(u.voltage_gain, 0.004);
        close(u.speed, 0.0001);
        close(u.negative_impedance, 0.1);
        assert_eq!(healthy.significance, 6.0);
        assert!(config.validate().is_ok());
    }
}
