//! `[load]` and `[monitor]`: what the residuals may assume and how they are judged.

use document::{Bounds, Section};

/// What is known about the load torque.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoadKind {
    /// The load is friction that never changes: the paper's case. A change is a fault.
    #[default]
    Friction,
    /// A torque channel measures it.
    Measured,
    /// Not known: the mechanical residuals indicate load and never a motor fault.
    Free,
}

/// The frame in which the residuals (37) are formed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frame {
    /// d axis on the rotor flux: (13)-(29) hold exactly.
    #[default]
    RotorFlux,
    /// q axis on the voltage: the published instrument.
    Voltage,
}

/// Where the field current of (37) comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FieldCurrent {
    /// The measured `I_d`.
    #[default]
    Live,
    /// A constant `i_f`: the published simplification.
    Nominal,
}

/// How the residuals are formed and judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonitorSettings {
    /// Frame of the residuals.
    pub frame: Frame,
    /// Live or constant field current.
    pub field_current: FieldCurrent,
    /// The constant of [`FieldCurrent::Nominal`], A; absent: from the rated operating point.
    pub nominal_field_current_amp: Option<f64>,
    /// Thresholds of r1..r4, percent of their scales.
    pub threshold_percent: [f64; 4],
    /// Supply cycles in one window, 2..=10.
    pub window_cycles: u32,
    /// Windows in a row before a lamp lights or goes out, 1..=255.
    pub persistence_windows: u32,
    /// Fraction of its threshold below which a lit lamp goes out, 0.1..=1.
    pub hysteresis: f64,
}

/// Defaults of r1..r4, percent of scale: between what must stay dark and what must light at +-50 % on the
/// assumed 300 W motor, full and linear. r2 must pass over 2.9 (`R_s` on the full motor) and catch 8.8 (`B`): 5 is
/// their geometric middle. r1: 0.02 (`B`) and 1.2 (`R_r`); r3: 1.4 (`R_s`) and 8.7 (`B`); r4: 0.02 (`I_q`) and 0.49 (`B`).
const THRESHOLD_PERCENT: [f64; 4] = [0.6, 5.0, 4.0, 0.3];

impl Default for MonitorSettings {
    fn default() -> MonitorSettings {
        MonitorSettings {
            frame: Frame::default(),
            field_current: FieldCurrent::default(),
            nominal_field_current_amp: None,
            threshold_percent: THRESHOLD_PERCENT,
            window_cycles: 5,
            persistence_windows: 3,
            hysteresis: 0.8,
        }
    }
}

pub(super) const LOADS: [(&str, LoadKind); 3] = [
    ("friction", LoadKind::Friction),
    ("measured", LoadKind::Measured),
    ("free", LoadKind::Free),
];
pub(super) const FRAMES: [(&str, Frame); 2] = [
    ("rotor-flux", Frame::RotorFlux),
    ("voltage", Frame::Voltage),
];
pub(super) const FIELD_CURRENTS: [(&str, FieldCurrent); 2] = [
    ("live", FieldCurrent::Live),
    ("nominal", FieldCurrent::Nominal),
];
const FIELD_CURRENT: Bounds = Bounds::above(0.0, 1e6, "A");
const THRESHOLD: Bounds = Bounds::above(0.0, 1000.0, "percent").hint("of the residual's scale");
const CYCLES: Bounds = Bounds::between(2.0, 10.0, "cycles");
const WINDOWS: Bounds = Bounds::between(1.0, 255.0, "windows");
const HYSTERESIS: Bounds = Bounds::between(0.1, 1.0, "").hint("a fraction of the threshold");

pub(super) fn read_load(root: &Section<'_>) -> Option<LoadKind> {
    let Some(section) = root.optional_section("load")? else {
        return Some(LoadKind::default());
    };
    let kind = section.choice_or("kind", &LOADS, LoadKind::default());
    section.finish();
    kind
}

pub(super) fn read(root: &Section<'_>) -> Option<MonitorSettings> {
    let base = MonitorSettings::default();
    let Some(section) = root.optional_section("monitor")? else {
        return Some(base);
    };
    let settings = read_values(&section, &base);
    section.finish();
    settings
}

fn read_values(section: &Section<'_>, base: &MonitorSettings) -> Option<MonitorSettings> {
    let frame = section.choice_or("frame", &FRAMES, base.frame);
    let field_current = section.choice_or("field_current", &FIELD_CURRENTS, base.field_current);
    let nominal = section.optional_number("nominal_field_current_amp", &FIELD_CURRENT);
    let threshold = section.optional_numbers::<4>("threshold_percent", &THRESHOLD);
    let cycles = section.integer_or("window_cycles", &CYCLES, base.window_cycles);
    let windows = section.integer_or("persistence_windows", &WINDOWS, base.persistence_windows);
    let hysteresis = section.number_or("hysteresis", &HYSTERESIS, base.hysteresis);
    Some(MonitorSettings {
        frame: frame?,
        field_current: field_current?,
        nominal_field_current_amp: nominal?,
        threshold_percent: threshold?.unwrap_or(base.threshold_percent),
        window_cycles: cycles?,
        persistence_windows: windows?,
        hysteresis: hysteresis?,
    })
}
