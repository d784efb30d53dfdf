//! A motor file from a plate, with its intervals.

use std::fmt::Write;

use motor::MotorFile;
use nalgebra::DMatrix;

use crate::circuit::REFERENCE_CURRENT;
use crate::estimate::Estimate;
use crate::interval::Interval;
use crate::measured::{ALL, Form, NAMES, Tested};
use crate::physical::PHYSICAL;
use crate::plate::{Completed, PlateFile};

/// Correlations from here on are written.
const STRONG: f64 = 0.5;

/// Places of what stands in `[parameters]`; the others belong to effects.
const IN_PARAMETERS: [usize; 6] = [0, 1, 2, 3, 4, 11];

/// Where the numbers of a file come from, and what its intervals mean.
const FROM_PLATE: [&str; 2] = [
    "Written by `drivemon motor new` from the plate. Nothing here was measured on this motor: see [uncertainty].",
    "what the plate leaves open. `drivemon motor identify` narrows them with recordings.",
];
const FROM_TESTS: [&str; 2] = [
    "Written by `drivemon motor tests` from the plate and standard tests on this motor: see [uncertainty].",
    "what plate and tests leave open.",
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

/// The motor file of a plate and standard tests.
///
/// # Errors
/// Values that the reader of motor files refuses, in its words.
pub fn tested_text(file: &PlateFile, tested: &Tested) -> Result<String, String> {
    let text = Text::of_tests(file, tested).written();
    match MotorFile::parse(&text, "the new motor file") {
        Ok(_) => Ok(text),
        Err(error) => Err(error.to_string()),
    }
}

struct Text<'e> {
    file: &'e PlateFile,
    completed: &'e Completed,
    /// Where the numbers come from: of the file, and of the intervals.
    head: [&'static str; 2],
    form: Form,
    parameters: [Interval; ALL],
    correlations: DMatrix<f64>,
    text: String,
}

impl<'e> Text<'e> {
    fn of(file: &'e PlateFile, estimate: &'e Estimate) -> Text<'e> {
        let told = |inertia: f64| Interval {
            value: inertia,
            low: inertia,
            high: inertia,
        };
        let mut parameters = [told(1.0); ALL];
        parameters[..PHYSICAL].copy_from_slice(&estimate.parameters);
        if let Some(inertia) = file.inertia_kg_m2 {
            parameters[PHYSICAL - 1] = told(inertia);
        }
        let strong = PHYSICAL - 1;
        Text {
            file,
            completed: &estimate.completed,
            head: FROM_PLATE,
            form: Form {
                standstill: estimate.completed.knows_standstill(),
                ..Form::default()
            },
            parameters,
            correlations: DMatrix::from_fn(strong, strong, |a, b| estimate.correlations[(a, b)]),
            text: String::new(),
        }
    }

    fn of_tests(file: &'e PlateFile, tested: &'e Tested) -> Text<'e> {
        Text {
            file,
            completed: &tested.completed,
            head: FROM_TESTS,
            form: tested.form,
            parameters: tested.parameters(),
            correlations: tested.correlations.clone(),
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
        let completed = self.completed;
        let poles = 2 * completed.pole_pairs;
        let plain = format!("{:.4} kW {poles}-pole motor", completed.power_kw);
        let name = self.file.name.clone().unwrap_or(plain);
        let [origin, _] = self.head;
        self.line(format_args!("# {origin}"));
        self.line(format_args!("name = {}", toml_edit::Value::from(name)));
    }

    fn nameplate(&mut self) {
        let completed = self.completed;
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
        for k in IN_PARAMETERS {
            self.number(NAMES[k], self.parameters[k].value);
        }
        self.line(format_args!(
            "friction_nm_s = 0.0\nload_friction_nm_s = 0.0"
        ));
        self.line(format_args!(
            "\n# The plate says nothing about the load: mechanical residuals indicate it and light no FAULT.\n[load]\nkind = \"free\""
        ));
    }

    fn effects(&mut self) {
        if self.form.standstill {
            self.effect("deep-bar", Some("double-cage"), &[5, 6]);
            let amplitude = self.completed.base_current_amp() * 2f64.sqrt();
            self.effect("leakage-saturation", None, &[7]);
            self.number("reference_current_amp", REFERENCE_CURRENT * amplitude);
        }
        self.effect("core-loss", Some("air-gap"), &[8]);
        if self.form.saturates {
            self.effect("magnetizing-saturation", None, &[12, 13]);
            self.number("flux_location", 0.0);
        }
        self.effect("windage", None, &[9]);
        if self.form.bearings {
            self.effect("coulomb-friction", None, &[14]);
        }
        self.effect("stray-load-loss", None, &[10]);
    }

    fn effect(&mut self, name: &str, form: Option<&str>, keys: &[usize]) {
        self.line(format_args!("\n[[effects]]\nname = \"{name}\""));
        if let Some(form) = form {
            self.line(format_args!("form = \"{form}\""));
        }
        for &k in keys {
            self.number(NAMES[k], self.parameters[k].value);
        }
    }

    fn intervals(&mut self) {
        let ([_, meaning], form) = (self.head, self.form);
        self.line(format_args!("\n# 95 % intervals: {meaning}\n[uncertainty]"));
        for k in (0..ALL).filter(|&k| form.has(k)) {
            let Interval { low, high, .. } = self.parameters[k];
            self.line(format_args!(
                "{} = [{:?}, {:?}]",
                NAMES[k],
                rounded(low.max(1e-12)),
                rounded(high)
            ));
        }
    }

    fn correlations(&mut self) {
        let correlations = core::mem::take(&mut self.correlations);
        for b in 0..correlations.nrows() {
            for a in 0..b {
                let value = correlations[(a, b)];
                if value.abs() >= STRONG && self.form.has(a) && self.form.has(b) {
                    let value = value.clamp(-1.0, 1.0);
                    let (first, second) = (NAMES[a], NAMES[b]);
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
