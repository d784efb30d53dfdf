//! A motor as the text of a motor file.

use super::healthy::{ACTIVE_KEY, RANGE_KEYS};
use super::monitor::{FIELD_CURRENTS, FRAMES, LOADS};
use super::sensors::MICROSECOND;
use super::{
    Connection, EffectEntry, EffectValue, HealthySettings, MonitorSettings, MotorFile, Nameplate,
    Sensors, Uncertainty,
};
use crate::InMotion;
use std::fmt::Write;

pub(super) fn to_toml(motor: &MotorFile) -> String {
    let mut text = Text::default();
    text.words("name", &motor.name);
    nameplate(&mut text, &motor.nameplate);
    parameters(&mut text, motor);
    text.header("[load]");
    text.words("kind", word(&LOADS, motor.load));
    sensors(&mut text, &motor.sensors);
    monitor(&mut text, &motor.monitor);
    if let Some(settings) = &motor.healthy {
        healthy(&mut text, settings);
    }
    for effect in &motor.effects {
        write_effect(&mut text, effect);
    }
    if let Some(settings) = &motor.uncertainty {
        uncertainty(&mut text, settings);
    }
    text.0
}

/// Lines of `key = value`; `{:?}` of an `f64` is the shortest text that reads back the same.
#[derive(Default)]
struct Text(String);

impl Text {
    fn header(&mut self, header: &str) {
        self.line(format_args!("\n{header}"));
    }

    fn number(&mut self, key: &str, number: f64) {
        self.line(format_args!("{key} = {number:?}"));
    }

    fn integer(&mut self, key: &str, number: u32) {
        self.line(format_args!("{key} = {number}"));
    }

    fn numbers(&mut self, key: &str, numbers: &[f64]) {
        self.line(format_args!("{key} = {numbers:?}"));
    }

    fn optional(&mut self, key: &str, number: Option<f64>) {
        if let Some(number) = number {
            self.number(key, number);
        }
    }

    fn words(&mut self, key: &str, words: &str) {
        let quoted = toml::Value::String(words.to_owned());
        self.line(format_args!("{key} = {quoted}"));
    }

    fn line(&mut self, line: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.0, "{line}");
    }
}

fn word<'w, T: PartialEq>(words: &[(&'w str, T)], value: T) -> &'w str {
    words
        .iter()
        .find(|(_, meaning)| *meaning == value)
        .map_or("", |(word, _)| word)
}

fn nameplate(text: &mut Text, nameplate: &Nameplate) {
    text.header("[nameplate]");
    text.integer("pole_pairs", nameplate.pole_pairs);
    text.number("power_watt", nameplate.power_watt);
    text.number("voltage_line_rms_volt", nameplate.voltage_line_rms_volt);
    text.number("current_rms_amp", nameplate.current_rms_amp);
    text.number("frequency_hz", nameplate.frequency_hz);
    text.number("torque_nm", nameplate.torque_nm);
    let connection = match nameplate.connection {
        Connection::Star => "star",
        Connection::Delta => "delta",
    };
    text.words("connection", connection);
    text.optional("speed_rpm", nameplate.speed_rpm);
    if let Some(bars) = nameplate.rotor_bars {
        text.integer("rotor_bars", bars);
    }
}

fn parameters(text: &mut Text, motor: &MotorFile) {
    text.header("[parameters]");
    text.number("stator_resistance_ohm", motor.parameters.r_s);
    text.number("rotor_resistance_ohm", motor.parameters.r_r);
    text.number("stator_leakage_henry", motor.parameters.l_ls);
    text.number("rotor_leakage_henry", motor.parameters.l_lr);
    text.number("magnetizing_inductance_henry", motor.parameters.l_m);
    text.optional("temperature_degc", motor.parameter_temperature_degc);
    text.number("inertia_kg_m2", motor.mechanics.inertia);
    text.number("friction_nm_s", motor.mechanics.friction);
    text.number("load_friction_nm_s", motor.mechanics.load_friction);
}

fn sensors(text: &mut Text, own: &Sensors) {
    text.header("[sensors]");
    text.number("voltage_full_scale_volt", own.voltage_full_scale_volt);
    text.number("current_full_scale_amp", own.current_full_scale_amp);
    text.number("speed_full_scale_rad_s", own.speed_full_scale_rad_s);
    text.number("torque_full_scale_nm", own.torque_full_scale_nm);
    text.integer("adc_bits", own.adc_bits);
    let pulses = own.encoder_pulses_per_revolution;
    text.integer("encoder_pulses_per_revolution", pulses);
    let noise = own.noise_sigma_fraction_of_full_scale;
    text.number("noise_sigma_fraction_of_full_scale", noise);
    text.numbers("voltage_offset_volt", &own.voltage_offset_volt);
    text.numbers("current_offset_amp", &own.current_offset_amp);
    text.numbers("voltage_gain", &own.voltage_gain);
    text.numbers("current_gain", &own.current_gain);
    let references = ["voltage_reference", "current_reference"];
    for (key, ratiometric) in references.into_iter().zip(own.ratiometric) {
        if ratiometric {
            text.words(key, "ratiometric");
        }
    }
    if *own != own.without_delays() {
        let us = |seconds: [f64; 3]| seconds.map(microseconds);
        text.numbers("voltage_delay_us", &us(own.voltage_delay_s));
        text.numbers("current_delay_us", &us(own.current_delay_s));
        text.number("roll_off_us", microseconds(own.roll_off_s));
    }
}

/// To the picosecond, so that what was read is written again.
fn microseconds(seconds: f64) -> f64 {
    (seconds / MICROSECOND * 1e6).round() / 1e6
}

fn monitor(text: &mut Text, settings: &MonitorSettings) {
    text.header("[monitor]");
    text.words("frame", word(&FRAMES, settings.frame));
    text.words(
        "field_current",
        word(&FIELD_CURRENTS, settings.field_current),
    );
    text.optional(
        "nominal_field_current_amp",
        settings.nominal_field_current_amp,
    );
    text.numbers("threshold_percent", &settings.threshold_percent);
    text.integer("window_cycles", settings.window_cycles);
    text.integer("persistence_windows", settings.persistence_windows);
    text.number("hysteresis", settings.hysteresis);
}

fn healthy(text: &mut Text, settings: &HealthySettings) {
    text.header("[healthy]");
    text.numbers("mean_percent", &settings.mean_percent);
    text.numbers("scatter_percent", &settings.scatter_percent);
    text.numbers(
        "current_unbalance_percent",
        &settings.current_unbalance_percent,
    );
    text.numbers("negative_drop_percent", &settings.negative_drop_percent);
    for (key, share) in settings.shares() {
        text.number(key, share);
    }
    if let Some(range) = &settings.range {
        let [current, volt_per_hertz, frequency] = RANGE_KEYS;
        text.number(current, range.current_percent);
        text.numbers(volt_per_hertz, &range.volt_per_hertz_percent);
        text.numbers(frequency, &range.frequency_percent);
        text.number(ACTIVE_KEY, range.active_percent);
    }
    text.number("turns_angle_deg", settings.turns_angle_deg);
    text.number("significance", settings.significance);
    if let Some(rotor) = &settings.rotor {
        text.numbers("rotor_active_percent", &rotor.active_percent);
        text.numbers("rotor_sideband_percent", &rotor.sideband_percent);
        text.number("rotor_sideband_scatter_percent", rotor.scatter_percent);
    }
    if settings.in_motion != InMotion::Unseen {
        text.words("in_motion", settings.in_motion.word());
    }
}

fn uncertainty(text: &mut Text, settings: &Uncertainty) {
    text.header("[uncertainty]");
    for interval in &settings.intervals {
        text.numbers(&interval.key, &[interval.low, interval.high]);
    }
    for correlation in &settings.correlations {
        text.header("[[uncertainty.correlation]]");
        text.words("first", &correlation.first);
        text.words("second", &correlation.second);
        text.number("value", correlation.value);
    }
}

fn write_effect(text: &mut Text, effect: &EffectEntry) {
    text.header("[[effects]]");
    text.words("name", &effect.name);
    for parameter in &effect.parameters {
        match &parameter.value {
            EffectValue::Number(number) => text.number(&parameter.key, *number),
            EffectValue::Text(words) => text.words(&parameter.key, words),
            EffectValue::List(numbers) => text.numbers(&parameter.key, numbers),
        }
    }
}
