//! One run through the core as the board samples it: windows at rest and cycles in motion side by side.

use monitor::{Abc, Monitor, MonitorConfig, MonitorState, RawSample, Sample};
use motion::{Motion, MotionCycle, MotionSample, MotionState, Named};
use motor::MotorFile;
use scenario::simulate::{SimSample, Simulation};

use studies::drive::{Doubts, Run};

/// What a run came to.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Alarm in motion after the fault, or any in a healthy run, s of the experiment.
    pub alarm_s: Option<f64>,
    /// Alarm before the fault.
    pub early: bool,
    pub named: Option<Named>,
    /// Largest statistic in two cycles running, while no fault was there.
    pub largest: f32,
    /// Cycles after the supply came on, and those that were judged.
    pub cycles: u32,
    pub judged: u32,
    /// Every cycle's rows.
    pub rows: Vec<([f32; 9], bool)>,
}

pub fn judge(
    believed: &MotorFile,
    run: &Run,
    doubts: &Doubts,
    faulty: bool,
) -> Result<Outcome, String> {
    let simulation = Simulation::new(&run.scenario).map_err(|error| error.to_string())?;
    let t_sample = run.scenario.t_sample();
    let config =
        MonitorConfig::from_motor_file(believed, t_sample).map_err(|error| error.to_string())?;
    let motion = Motion::new(&config).map_err(|error| error.to_string())?;
    let monitor = Monitor::new(config).map_err(|error| error.to_string())?;
    let (mut state, mut moving) = (MonitorState::default(), MotionState::default());
    let mut outcome = Outcome::default();
    let late = (doubts.late_s / t_sample) as f32;
    let mut before = None;
    let mut last = 0.0_f32;
    for sample in simulation {
        let shown = shown(&monitor, &sample, run.torque_gain, doubts.backwards);
        let shown = delayed(shown, &mut before, late);
        monitor.update(&mut state, &shown);
        let supply = state.supply();
        let both = MotionSample {
            sample: shown,
            supply,
        };
        if let Some(cycle) = motion.update(&mut moving, &both) {
            outcome.take(&cycle, sample.t, run, faulty, &mut last);
        }
    }
    Ok(outcome)
}

impl Outcome {
    fn take(&mut self, cycle: &MotionCycle, t: f64, run: &Run, faulty: bool, last: &mut f32) {
        if t > run.on_s {
            self.cycles += 1;
            self.judged += u32::from(cycle.not_judged.is_none());
        }
        let present = faulty && t > run.fault_s;
        if !present {
            self.largest = self.largest.max(cycle.statistic.min(*last));
            self.rows.push((cycle.rows, cycle.not_judged.is_none()));
        }
        *last = cycle.statistic;
        let Some(alarm) = &cycle.alarm else {
            return;
        };
        if faulty && !present {
            self.early = true;
        } else if self.alarm_s.is_none() {
            self.alarm_s = Some(t);
        }
        if let Some(named) = alarm.named
            && self.named.is_none()
        {
            self.named = Some(named);
        }
    }
}

fn shown(monitor: &Monitor, sample: &SimSample, torque_gain: f64, backwards: bool) -> Sample {
    let m = &sample.measured;
    let swap = |[a, b, c]: [u16; 3]| if backwards { [a, c, b] } else { [a, b, c] };
    let raw = RawSample {
        voltage_codes: swap(m.voltage_codes),
        current_codes: swap(m.current_codes),
        encoder_count: if backwards {
            m.encoder_count.wrapping_neg()
        } else {
            m.encoder_count
        },
        ..RawSample::default()
    };
    let tau = (m.tau_load * torque_gain) as f32;
    Sample {
        tau_load: Some(if backwards { -tau } else { tau }),
        ..monitor.config().converter.convert(&raw)
    }
}

/// Currents that are late by a share of a sample.
fn delayed(mut now: Sample, before: &mut Option<Abc>, late: f32) -> Sample {
    let i = now.i_s_abc.unwrap_or_default();
    let old = before.replace(i).unwrap_or(i);
    now.i_s_abc = Some(i.zip(old, |x, y| x + late * (y - x)));
    now
}
