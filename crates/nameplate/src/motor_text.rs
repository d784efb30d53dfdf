//! A motor file from a plate, with its intervals.

use std::fmt::Write;

use motor::MotorFile;

use crate::circuit::REFERENCE_CURRENT;
use crate::estimate::Estimate;
use crate::interval::Interval;
use crate::physical::{KEYS, PHYSICAL};
use crate::plate::PlateFile;

/// Correlations from here on are written.
const STRONG: f64 = 0.5;

/// What a motor file writes from a circuit.
enum Part {
    /// `[parameters]`.
    Parameter,
    /// The second cage and the leakage that saturates: seen at standstill alone.
    Standstill,
    /// Losses beside the copper's.
    Loss,
}

const PARTS: [Part; PHYSICAL] = [
    Part::Parameter,
    Part::Parameter,
    Part::Parameter,
    Part::Parameter,
    Part::Parameter,
    Part::Standstill,
    Part::Standstill,
    Part::Standstill,
    Part::Loss,
    Part::Loss,
    Part::Loss,
    Part::Parameter,
];

/// The motor file of a plate.
///
/// # Errors
/// Values that the reader of motor files refuses, in its words.
pub fn motor_text(file: &PlateFile, estimate: &Estimate) -> Result<String, String> {
    let text = Text::of(file, estimate).written();
    match MotorFile::parse(&text, "the new motor file") {
        Ok(_) => Ok(text),
        Err(error) => Err(error.to_string()),
    }
}

struct Text<'e> {
    file: &'e PlateFile,
    estimate: &'e Estimate,
    parameters: [Interval; PHYSICAL],
    text: String,
}

impl<'e> Text<'e> {
    fn of(file: &'e PlateFile, estimate: &'e Estimate) -> Text<'e> {
        let mut parameters = estimate.parameters;
        if let Some(inertia) = file.inertia_kg_m2 {
            parameters[PHYSICAL - 1] = Interval {
                value: inertia,
                low: inertia,
                high: inertia,
            };
        }
        Text {
            file,
            estimate,
            parameters,
            text: String::new(),
        }
    }

    fn written(mut self) -> String {
        self.head();
        self.nameplate();
        self.values();
        self.effects();
        self.intervals();
        self.correlations();
        self.text
    }

    fn line(&mut self, line: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.text, "{line}");
    }

    fn head(&mut self) {
        let completed = &self.estimate.completed;
        let poles = 2 * completed.pole_pairs;
        let plain = format!("{:.4} kW {poles}-pole motor", completed.power_kw);
        let name = self.file.name.clone().unwrap_or(plain);
        self.line(format_args!(
            "# Written by `drivemon motor new` from the plate. Nothing here was measured on this motor: see [uncertainty]."
        ));
        self.line(format_args!("name = {}", toml_edit::Value::from(name)));
    }

    fn nameplate(&mut self) {
        let completed = &self.estimate.completed;
        let synchronous_rpm = 60.0 * completed.frequency_hz / f64::from(completed.pole_pairs);
        let printed = |number: Option<crate::plate::Printed>, otherwise: f64| {
            number.map_or(otherwise, |printed| printed.value)
        };
        let speed_rpm = printed(
            completed.plate.speed_rpm,
            synchronous_rpm * (1.0 - completed.targets.slip),
        );
        let torque = 1000.0 * completed.power_kw / (speed_rpm * std::f64::consts::TAU / 60.0);
        let current = printed(completed.plate.current_amp, completed.base_current_amp());
        let rows = [
            ("power_watt", 1000.0 * completed.power_kw),
            ("voltage_line_rms_volt", completed.voltage_volt),
            ("current_rms_amp", current),
            ("frequency_hz", completed.frequency_hz),
            ("torque_nm", torque),
            ("speed_rpm", speed_rpm),
        ];
        let pole_pairs = completed.pole_pairs;
        self.line(format_args!("\n[nameplate]\npole_pairs = {pole_pairs}"));
        for (key, value) in rows {
            self.number(key, value);
        }
        let connection = if self.file.delta { "delta" } else { "star" };
        self.line(format_args!("connection = \"{connection}\""));
        if let Some(bars) = self.file.rotor_bars {
            self.line(format_args!("rotor_bars = {bars}"));
        }
    }

    fn number(&mut self, key: &str, value: f64) {
        self.line(format_args!("{key} = {:?}", rounded(value)));
    }

    fn values(&mut self) {
        self.line(format_args!(
            "\n# Per equivalent star phase, warm from rated load.\n[parameters]"
        ));
        for k in 0..PHYSICAL {
            if matches!(PARTS[k], Part::Parameter) {
                self.number(KEYS[k], self.parameters[k].value);
            }
        }
        self.line(format_args!(
            "friction_nm_s = 0.0\nload_friction_nm_s = 0.0"
        ));
        self.line(format_args!(
            "\n# The plate says nothing about the load: mechanical residuals indicate it and light no FAULT.\n[load]\nkind = \"free\""
        ));
    }

    fn knows_standstill(&self) -> bool {
        self.estimate.completed.knows_standstill()
    }

    fn written_part(&self, k: usize) -> bool {
        match PARTS[k] {
            Part::Standstill => self.knows_standstill(),
            Part::Parameter | Part::Loss => true,
        }
    }

    fn effects(&mut self) {
        if self.knows_standstill() {
            self.effect("deep-bar", Some("double-cage"), &[5, 6]);
            let amplitude = self.estimate.completed.base_current_amp() * 2f64.sqrt();
            self.effect("leakage-saturation", None, &[7]);
            self.number("reference_current_amp", REFERENCE_CURRENT * amplitude);
        }
        self.effect("core-loss", Some("air-gap"), &[8]);
        self.effect("windage", None, &[9]);
        self.effect("stray-load-loss", None, &[10]);
    }

    fn effect(&mut self, name: &str, form: Option<&str>, keys: &[usize]) {
        self.line(format_args!("\n[[effects]]\nname = \"{name}\""));
        if let Some(form) = form {
            self.line(format_args!("form = \"{form}\""));
        }
        for &k in keys {
            self.number(KEYS[k], self.parameters[k].value);
        }
    }

    fn intervals(&mut self) {
        self.line(format_args!(
            "\n# 95 % intervals: what the plate leaves open. `drivemon motor identify` narrows them with recordings.\n[uncertainty]"
        ));
        for k in (0..PHYSICAL)
            .filter(|&k| self.written_part(k))
            .collect::<Vec<_>>()
        {
            let Interval { low, high, .. } = self.parameters[k];
            self.line(format_args!(
                "{} = [{:?}, {:?}]",
                KEYS[k],
                rounded(low.max(1e-12)),
                rounded(high)
            ));
        }
    }

    fn correlations(&mut self) {
        for (b, second) in KEYS.iter().enumerate().take(PHYSICAL - 1) {
            for (a, first) in KEYS.iter().enumerate().take(b) {
                let value = self.estimate.correlations[(a, b)];
                if value.abs() >= STRONG && self.written_part(a) && self.written_part(b) {
                    self.line(format_args!(
                        "\n[[uncertainty.correlation]]\nfirst = \"{first}\"\nsecond = \"{second}\"\nvalue = {value:.2}"
                    ));
                }
            }
        }
    }
}

/// Six digits: a plate has three.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
