//! From findings to lamps: persistence, hysteresis, and what each lamp means.

use crate::config::{LoadKind, MonitorConfig};
use crate::isolation::Isolation;
use crate::lamps::{Lamp, Lamps};
use crate::report::{NotJudged, Report};
use crate::residuals::RESIDUALS;
use crate::signature::Candidates;
use crate::supply::SupplyFinding;
use crate::threshold::{ComparatorConfig, ComparatorState};

/// How lamps react.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelConfig {
    comparator: ComparatorConfig,
    load: LoadKind,
    /// Standard deviations at which FAULT lights on a calibrated motor.
    significance: Option<f32>,
}

/// What the lamps remember.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PanelState {
    residuals: [ComparatorState; RESIDUALS],
    sensor: ComparatorState,
    line: ComparatorState,
    overload: ComparatorState,
    isolated: ComparatorState,
}

impl PanelState {
    /// Whether FAULT is lit by the evidence of a calibrated motor.
    pub(crate) fn is_isolated(&self) -> bool {
        self.isolated.is_lit()
    }
}

/// Torque, as a share of rated, above which LOAD lights where the load is free: past the usual service factor of 1.15.
const OVERLOAD: f32 = 1.15;

impl PanelConfig {
    /// Takes over what concerns the lamps.
    pub fn new(config: &MonitorConfig) -> Self {
        PanelConfig {
            comparator: config.comparator,
            load: config.load,
            significance: config.healthy.map(|healthy| healthy.significance),
        }
    }

    /// Updates all lamps from one report's findings and writes them into it.
    pub fn show(&self, state: &mut PanelState, report: &mut Report) {
        let judged = report.not_judged.is_none();
        if let (true, Some(normalised)) = (judged, report.normalised) {
            self.compare(state, &normalised);
        }
        if report.window.is_some() {
            self.confirm(&mut state.sensor, report.sensor.is_some());
        }
        self.confirm(&mut state.line, report.supply.is_some());
        self.confirm(&mut state.overload, self.is_overloaded(report));
        self.follow_isolation(state, report);
        report.candidates = self.candidates(state, report);
        report.lamps = self.lamps(state, report);
    }

    fn follow_isolation(&self, state: &mut PanelState, report: &Report) {
        if let (Some(isolation), Some(limit)) = (&report.isolation, self.significance) {
            self.comparator
                .update(&mut state.isolated, isolation.significance / limit);
        }
    }

    fn compare(&self, state: &mut PanelState, normalised: &[f32; RESIDUALS]) {
        for (comparator, &x) in state.residuals.iter_mut().zip(normalised) {
            self.comparator.update(comparator, x);
        }
    }

    fn confirm(&self, state: &mut ComparatorState, present: bool) {
        self.comparator
            .update(state, if present { 2.0 } else { 0.0 });
    }

    fn is_overloaded(&self, report: &Report) -> bool {
        let free = self.load == LoadKind::Free;
        // r2 of a load that is not declared is minus the torque over the rated torque.
        free && report
            .residuals
            .is_some_and(|residuals| -residuals.r[1] > OVERLOAD)
    }

    fn lamps(&self, state: &PanelState, report: &Report) -> Lamps {
        let residual_lit = state.residuals.iter().any(ComparatorState::is_lit);
        let motor_fault = if self.significance.is_some() {
            state.isolated.is_lit()
        } else {
            residual_lit
        };
        let sensor = state.sensor.is_lit() || motor_fault && points_to_sensor(report);
        Lamps {
            run: run_lamp(report.not_judged),
            r: state
                .residuals
                .map(|comparator| Lamp::lit(comparator.is_lit())),
            sensor: sensor_lamp(sensor, report.not_judged),
            line: line_lamp(state.line.is_lit(), report.not_judged),
            load: load_lamp(state.overload.is_lit(), report.not_judged),
            fault: Lamp::lit(motor_fault || state.sensor.is_lit()),
        }
    }

    fn candidates(&self, state: &PanelState, report: &Report) -> Option<Candidates> {
        let lit = state.residuals.iter().any(ComparatorState::is_lit);
        let by_table = lit && self.significance.is_none() && report.not_judged.is_none();
        let normalised = report.normalised.filter(|_| by_table)?;
        Some(Candidates::from_normalised(&normalised))
    }
}

/// Whether the instrument is a likelier cause than the motor.
fn points_to_sensor(report: &Report) -> bool {
    let by_table = report.candidates.as_ref();
    let by_evidence = report.isolation.as_ref();
    by_table.is_some_and(Candidates::points_to_sensor)
        || by_evidence.is_some_and(Isolation::points_to_sensor)
}

fn run_lamp(not_judged: Option<NotJudged>) -> Lamp {
    match not_judged {
        None => Lamp::On,
        Some(NotJudged::Supply(SupplyFinding::Lost)) => Lamp::Off,
        Some(_) => Lamp::Blink,
    }
}

fn sensor_lamp(confirmed: bool, not_judged: Option<NotJudged>) -> Lamp {
    match not_judged {
        _ if confirmed => Lamp::On,
        Some(NotJudged::Clipped | NotJudged::Invalid) => Lamp::Blink,
        _ => Lamp::Off,
    }
}

fn line_lamp(confirmed: bool, not_judged: Option<NotJudged>) -> Lamp {
    match not_judged {
        _ if confirmed => Lamp::On,
        Some(NotJudged::NotLocked) => Lamp::Blink,
        _ => Lamp::Off,
    }
}

fn load_lamp(overload: bool, not_judged: Option<NotJudged>) -> Lamp {
    match not_judged {
        Some(NotJudged::Transient) => Lamp::Blink,
        _ => Lamp::lit(overload),
    }
}
