//! From findings to lamps: persistence, hysteresis, and what each lamp means.

use crate::checks::supply::SupplyFinding;
use crate::config::{LoadKind, MonitorConfig};
use crate::isolation::Isolation;
use crate::lamps::lamp::{Lamp, Lamps};
use crate::lamps::signature::Candidates;
use crate::lamps::threshold::{ComparatorConfig, ComparatorState};
use crate::model::residuals::RESIDUALS;
use crate::report::{NotJudged, Report};

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
    rotor: ComparatorState,
    unbalance: ComparatorState,
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
        self.follow_rotor(state, report);
        if let (true, Some(beyond)) = (judged, report.unbalance) {
            self.comparator.update(&mut state.unbalance, beyond);
        }
        report.is_unbalanced = state.unbalance.is_lit();
        report.candidates = self.candidates(state, report);
        report.lamps = self.lamps(state, report);
    }

    fn follow_isolation(&self, state: &mut PanelState, report: &Report) {
        if let (Some(isolation), Some(limit)) = (&report.isolation, self.significance) {
            self.comparator
                .update(&mut state.isolated, isolation.significance / limit);
        }
    }

    fn follow_rotor(&self, state: &mut PanelState, report: &mut Report) {
        if let (Some(sidebands), Some(limits)) = (&report.rotor.sidebands, &report.rotor.limits) {
            self.comparator
                .update(&mut state.rotor, limits.normalised(sidebands));
        }
        report.rotor.is_broken = state.rotor.is_lit();
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
            fault: Lamp::lit(
                motor_fault
                    || state.sensor.is_lit()
                    || state.rotor.is_lit()
                    || state.unbalance.is_lit(),
            ),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::sensors::SensorFinding;
    use crate::model::residuals::Residuals;
    use crate::window::Window;

    fn panel(load: LoadKind, significance: Option<f32>) -> PanelConfig {
        PanelConfig {
            comparator: ComparatorConfig {
                persistence: 3,
                hysteresis: 0.8,
            },
            load,
            significance,
        }
    }

    fn judged(normalised: [f32; RESIDUALS]) -> Report {
        Report {
            window: Some(Window::default()),
            normalised: Some(normalised),
            residuals: Some(Residuals::default()),
            ..Report::default()
        }
    }

    fn not_judged(reason: NotJudged) -> Report {
        Report {
            not_judged: Some(reason),
            ..judged([0.0; RESIDUALS])
        }
    }

    /// The lamps after the same report came `times` in a row.
    fn after(config: &PanelConfig, times: usize, report: Report) -> Report {
        let mut state = PanelState::default();
        let mut shown = report;
        for _ in 0..times {
            shown = report;
            config.show(&mut state, &mut shown);
        }
        shown
    }

    const UNCALIBRATED: Option<f32> = None;

    #[test]
    fn residuals_beyond_their_thresholds_light_their_lamps_and_fault() {
        let config = panel(LoadKind::Friction, UNCALIBRATED);
        let report = judged([2.0, 0.0, 0.0, -2.0]);
        assert!(
            after(&config, 2, report).lamps.is_quiet(),
            "persistence is three"
        );
        let shown = after(&config, 3, report);
        assert_eq!(shown.lamps.pattern(), [true, false, false, true]);
        assert_eq!((shown.lamps.fault, shown.lamps.run), (Lamp::On, Lamp::On));
        assert_eq!(shown.lamps.sensor, Lamp::Off, "a resistance is no sensor");
        assert!(shown.candidates.is_some());
    }

    #[test]
    fn the_pattern_of_a_sensor_lights_sensor_as_well() {
        let config = panel(LoadKind::Friction, UNCALIBRATED);
        let shown = after(&config, 3, judged([2.0, 2.0, 2.0, 0.0]));
        assert_eq!(
            (shown.lamps.fault, shown.lamps.sensor),
            (Lamp::On, Lamp::On)
        );
    }

    /// What is not judged meets no threshold, and no row of Table 1.
    #[test]
    fn residuals_of_a_transient_light_nothing() {
        let config = panel(LoadKind::Friction, UNCALIBRATED);
        let report = Report {
            not_judged: Some(NotJudged::Transient),
            ..judged([9.0; RESIDUALS])
        };
        let shown = after(&config, 9, report);
        assert_eq!(shown.lamps.pattern(), [false; RESIDUALS]);
        assert_eq!(
            (shown.lamps.load, shown.lamps.run),
            (Lamp::Blink, Lamp::Blink)
        );
        assert_eq!((shown.lamps.fault, shown.candidates), (Lamp::Off, None));
    }

    #[test]
    fn a_lamp_that_was_lit_stays_through_a_transient_but_its_row_is_not_named() {
        let config = panel(LoadKind::Friction, UNCALIBRATED);
        let mut state = PanelState::default();
        for _ in 0..3 {
            config.show(&mut state, &mut judged([2.0, 2.0, 2.0, 0.0]));
        }
        let mut transient = Report {
            not_judged: Some(NotJudged::Transient),
            ..judged([2.0, 2.0, 2.0, 0.0])
        };
        config.show(&mut state, &mut transient);
        assert_eq!(transient.lamps.fault, Lamp::On);
        assert_eq!(transient.candidates, None);
    }

    #[test]
    fn findings_about_sensors_and_supply_persist_before_they_light() {
        let config = panel(LoadKind::Friction, UNCALIBRATED);
        let sensor = Report {
            sensor: Some(SensorFinding::CurrentSum),
            ..judged([0.0; RESIDUALS])
        };
        assert_eq!(after(&config, 2, sensor).lamps.sensor, Lamp::Off);
        let lamps = after(&config, 3, sensor).lamps;
        assert_eq!((lamps.sensor, lamps.fault), (Lamp::On, Lamp::On));
        assert_eq!(lamps.line, Lamp::Off);
        let supply = Report {
            supply: Some(SupplyFinding::Unbalance),
            ..judged([0.0; RESIDUALS])
        };
        assert_eq!(after(&config, 2, supply).lamps.line, Lamp::Off);
        let lamps = after(&config, 3, supply).lamps;
        assert_eq!(
            (lamps.line, lamps.fault),
            (Lamp::On, Lamp::Off),
            "the line is no fault"
        );
    }

    /// Without a window nothing is known about the sensors: the lamp stays as it was.
    #[test]
    fn silence_neither_lights_nor_darkens_sensor() {
        let config = panel(LoadKind::Friction, UNCALIBRATED);
        let mut state = PanelState::default();
        for _ in 0..3 {
            let mut dead = not_judged(NotJudged::Sensor(SensorFinding::CurrentSum));
            dead.sensor = Some(SensorFinding::CurrentSum);
            config.show(&mut state, &mut dead);
        }
        for _ in 0..9 {
            let mut silent = Report {
                window: None,
                ..not_judged(NotJudged::NotLocked)
            };
            config.show(&mut state, &mut silent);
            assert_eq!(silent.lamps.sensor, Lamp::On);
        }
    }

    #[test]
    fn run_line_and_sensor_say_why_nothing_is_judged() {
        let config = panel(LoadKind::Friction, UNCALIBRATED);
        let lamps = |reason| after(&config, 1, not_judged(reason)).lamps;
        assert_eq!(lamps(NotJudged::Supply(SupplyFinding::Lost)).run, Lamp::Off);
        assert_eq!(lamps(NotJudged::Settling).run, Lamp::Blink);
        assert_eq!(lamps(NotJudged::NotLocked).line, Lamp::Blink);
        assert_eq!(lamps(NotJudged::Settling).line, Lamp::Off);
        assert_eq!(lamps(NotJudged::Clipped).sensor, Lamp::Blink);
        assert_eq!(lamps(NotJudged::Invalid).sensor, Lamp::Blink);
        assert_eq!(lamps(NotJudged::Settling).sensor, Lamp::Off);
        assert_eq!(lamps(NotJudged::Settling).load, Lamp::Off);
    }

    /// Where the load is free, `r2` is minus the torque over the rated torque; LOAD lights beyond a service factor of 1.15.
    #[test]
    fn load_lights_for_an_undeclared_load_beyond_the_service_factor() {
        let at = |load, torque: f32| {
            let mut report = judged([f32::NAN; RESIDUALS]);
            report.residuals = Some(Residuals {
                r: [0.0, -torque, 0.0, 0.0],
                ..Residuals::default()
            });
            after(&panel(load, UNCALIBRATED), 3, report).lamps.load
        };
        assert_eq!(at(LoadKind::Free, 1.16), Lamp::On);
        assert_eq!(at(LoadKind::Free, 1.14), Lamp::Off);
        assert_eq!(
            at(LoadKind::Free, -1.5),
            Lamp::Off,
            "a generator is no overload"
        );
        assert_eq!(at(LoadKind::Friction, 1.5), Lamp::Off);
        assert_eq!(at(LoadKind::Measured, 1.5), Lamp::Off);
    }

    fn isolation(significance: f32, sensor: bool) -> Isolation {
        let mut scores = [0.0; crate::CAUSES];
        let cause = if sensor { 5 } else { 0 }; // all currents, stator resistance
        scores[cause] = 50.0;
        Isolation {
            scores,
            unknown: 0.0,
            sizes: [0.0; crate::CAUSES],
            significance,
            at_any_temperature: significance,
            heating: crate::Heating::default(),
            apart: Default::default(),
        }
    }

    /// On a calibrated motor FAULT follows the evidence; r1..r4 show, but decide nothing and name no row.
    #[test]
    fn a_calibrated_motor_is_judged_by_its_evidence() {
        let config = panel(LoadKind::Friction, Some(5.0));
        let with = |significance, sensor, r1| Report {
            isolation: Some(isolation(significance, sensor)),
            ..judged([r1, 0.0, 0.0, 0.0])
        };
        let shown = after(&config, 3, with(4.9, false, 9.0));
        assert_eq!(shown.lamps.fault, Lamp::Off);
        assert_eq!(shown.lamps.pattern(), [true, false, false, false]);
        assert_eq!(shown.candidates, None);
        let lamps = after(&config, 3, with(5.1, false, 0.0)).lamps;
        assert_eq!((lamps.fault, lamps.sensor), (Lamp::On, Lamp::Off));
        let lamps = after(&config, 3, with(5.1, true, 0.0)).lamps;
        assert_eq!((lamps.fault, lamps.sensor), (Lamp::On, Lamp::On));
        let lamps = after(&config, 3, with(4.9, true, 0.0)).lamps;
        assert_eq!(lamps.sensor, Lamp::Off, "no fault, no culprit");
        assert_eq!(
            after(&config, 2, with(5.1, false, 0.0)).lamps.fault,
            Lamp::Off
        );
    }
}
