//! One experiment on the published timeline: start, fault in, fault out.

use monitor::{
    Candidates, ClippedChannels, FaultId, Lamps, Monitor, MonitorConfig, MonitorState, RawSample,
    Rehearsal, Report,
};
use motor::MotorFile;
use motor::motor_file::Frame;

use super::DemoError;
use scenario::simulate::{Measured, Simulation};
use scenario::{Fault, PlantKind, Scenario, Start, Target};

/// The fault is switched in and out at these times, s (theory, section 7).
const FAULT_S: [f64; 2] = [2.0, 3.5];
/// The end of the experiment: as long after the fault as the motor had to start.
const END_S: f64 = 4.5;
/// Residuals are averaged over this long before the fault ends, s.
const AVERAGE_S: f64 = 0.5;

/// What is to be run.
#[derive(Clone, Copy, Debug)]
pub struct Case<'m> {
    /// The motor, its instruments and its monitor.
    pub motor: &'m MotorFile,
    /// What is simulated.
    pub plant: PlantKind,
    /// Row of Table 1 and change in percent; `None` for the healthy motor.
    pub fault: Option<(FaultId, f64)>,
    /// Seed of the noise.
    pub seed: u64,
}

/// What the core showed.
#[derive(Clone, Copy, Debug, Default)]
pub struct CaseResult {
    /// Mean residuals over the last half second of the fault, percent of their scales.
    pub r_percent: [f64; 4],
    /// Lamps just before the fault is switched out.
    pub lamps: Lamps,
    /// Probabilities just before the fault is switched out.
    pub candidates: Option<Candidates>,
    /// Time from the fault to the FAULT lamp, s; `None` when it was lit before.
    pub delay_s: Option<f64>,
    /// Lamps at the end, a second after the fault has gone.
    pub lamps_after: Lamps,
    windows: u32,
}

impl Case<'_> {
    /// Runs the experiment through the core.
    ///
    /// # Errors
    /// A motor that cannot be simulated.
    pub fn run(&self) -> Result<CaseResult, DemoError> {
        let simulation = Simulation::new(&self.scenario())?;
        let scenario = simulation.scenario();
        let told = scenario.sensors.told(self.motor);
        let config = MonitorConfig::from_motor_file(&told, scenario.t_sample())?;
        let monitor = Monitor::new(config)?;
        let mut state = MonitorState::default();
        let mut result = CaseResult::default();
        for sample in simulation {
            state.rehearse(self.rehearsal_at(sample.t));
            if let Some(report) = monitor.update_raw(&mut state, &raw(&sample.measured)) {
                result.take(sample.t, &report);
            }
        }
        result.r_percent = result
            .r_percent
            .map(|sum| sum / f64::from(result.windows.max(1)));
        Ok(result)
    }

    fn scenario(&self) -> Scenario {
        let motor_fault = self
            .fault
            .filter(|(fault, _)| sensor_gain(*fault).is_none());
        Scenario {
            plant: self.plant,
            start: Start::Standstill,
            seed: self.seed,
            faults: motor_fault
                .and_then(|(fault, percent)| {
                    let target = Target::of(fault, Frame::RotorFlux)?;
                    Some(Fault {
                        from_s: FAULT_S[0],
                        to_s: FAULT_S[1],
                        ..Fault::of(target, percent)
                    })
                })
                .into_iter()
                .collect(),
            ..Scenario::of(self.motor.clone(), END_S)
        }
    }

    /// Sensor faults are switched on the d-q signals, as the published bench does.
    fn rehearsal_at(&self, t: f64) -> Rehearsal {
        let present = (FAULT_S[0]..FAULT_S[1]).contains(&t);
        self.fault
            .filter(|_| present)
            .and_then(|(fault, percent)| Some(sensor_gain(fault)?(1.0 + percent as f32 / 100.0)))
            .unwrap_or_default()
    }
}

/// How a sensor row of Table 1 is rehearsed with a given gain.
fn sensor_gain(fault: FaultId) -> Option<fn(f32) -> Rehearsal> {
    match fault {
        FaultId::CurrentSensor => Some(|gain| Rehearsal {
            current_q_gain: gain,
            ..Rehearsal::default()
        }),
        FaultId::VoltageSensor => Some(|gain| Rehearsal {
            voltage_gain: gain,
            ..Rehearsal::default()
        }),
        FaultId::SpeedSensor => Some(|gain| Rehearsal {
            speed_gain: gain,
            ..Rehearsal::default()
        }),
        _ => None,
    }
}

fn raw(measured: &Measured) -> RawSample {
    RawSample {
        voltage_codes: measured.voltage_codes,
        current_codes: measured.current_codes,
        encoder_count: measured.encoder_count,
        clipped: ClippedChannels::of(measured.clipped),
    }
}

impl CaseResult {
    fn take(&mut self, t: f64, report: &Report) {
        let [from, to] = FAULT_S;
        if t >= to {
            self.lamps_after = report.lamps;
            return;
        }
        let lit_before = self.lamps.fault == monitor::Lamp::On;
        self.lamps = report.lamps;
        self.candidates = report.candidates.or(self.candidates);
        if t >= from
            && !lit_before
            && self.delay_s.is_none()
            && report.lamps.fault == monitor::Lamp::On
        {
            self.delay_s = Some(t - from);
        }
        if let (true, Some(residuals)) = (t >= to - AVERAGE_S, report.residuals) {
            self.windows += 1;
            for (sum, r) in self.r_percent.iter_mut().zip(residuals.r) {
                *sum += 100.0 * f64::from(r);
            }
        }
    }
}
