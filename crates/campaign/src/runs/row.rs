//! One run as one row of a table that other programs can read.

use motor::FaultId;
use parquet_derive::{ParquetRecordReader, ParquetRecordWriter};

use crate::planned::axis::Axis;
use crate::runs::cause;
use crate::runs::outcome::Outcome;
use crate::runs::run::Run;

/// One run: what it was, and what the lamps said. Units stand in the names; a time that does not exist is NaN, a text empty.
#[derive(Clone, Debug, Default, ParquetRecordReader, ParquetRecordWriter)]
pub struct Row {
    /// Index in the plan: `drivemon campaign replay` makes this very run again.
    pub index: u64,
    /// Seed of everything random in it.
    pub seed: u64,
    /// Name of the motor.
    pub motor: String,
    /// Name of the block.
    pub block: String,
    /// Name of the fault; empty for a healthy run.
    pub fault: String,
    /// Phase of the fault, `a` to `c`; empty where it has none.
    pub phase: String,
    /// Size of the fault, percent.
    pub change_percent: f64,
    /// Load, percent of rated torque.
    pub load_percent: f64,
    /// Load after the load step.
    pub load_step_to_percent: f64,
    /// Supply voltage, percent of rated.
    pub voltage_percent: f64,
    /// Supply voltage after the step.
    pub voltage_step_to_percent: f64,
    /// Supply frequency, Hz.
    pub frequency_hz: f64,
    /// Negative over positive sequence of the supply, percent.
    pub unbalance_percent: f64,
    /// Total harmonic distortion of the supply, percent.
    pub voltage_thd_percent: f64,
    /// Temperature of the windings, degC.
    pub winding_degc: f64,
    /// Noise, percent of full scale.
    pub noise_percent_of_full_scale: f64,
    /// Resolution, bit.
    pub adc_bits: f64,
    /// Largest gain error of the channels, percent.
    pub sensor_gain_error_percent: f64,
    /// Samples a second, Hz.
    pub sample_rate_hz: f64,
    /// 1 where the motor ran backwards.
    pub backwards: f64,
    /// How long steps took, s.
    pub ramp_s: f64,
    /// Supply frequency after the step, Hz.
    pub frequency_step_to_hz: f64,
    /// How long a cycle of the load took, s.
    pub load_cycle_s: f64,
    /// Why the motor cannot run under these conditions; empty where it ran.
    pub not_run: String,
    /// Time of the fault, s.
    pub fault_from_s: f64,
    /// Windows.
    pub windows: u32,
    /// Windows judged.
    pub judged_windows: u32,
    /// Windows judged while healthy.
    pub healthy_judged_windows: u32,
    /// Windows with FAULT lit while healthy.
    pub healthy_fault_windows: u32,
    /// Windows that were not at rest; 0 where the plan does not ask for them.
    pub moved_windows: u32,
    /// Of these judged in motion; they count as judged.
    pub motion_judged_windows: u32,
    /// Alarms in motion of the healthy motor that no fault explains; they are no FAULT.
    pub healthy_unexplained: u32,
    /// Whether FAULT came in motion.
    pub found_in_motion: bool,
    /// Time of the first of them, s.
    pub first_false_s: f64,
    /// The conditions without any single one of which FAULT stays dark on the healthy motor; empty without FAULT.
    pub false_cause: String,
    /// Lamps seen while healthy, RUN apart.
    pub healthy_lamps: String,
    /// Lamps seen with the fault.
    pub faulty_lamps: String,
    /// Why most of the windows that were not judged were not.
    pub not_judged: String,
    /// Whether FAULT was lit when the fault came: the run says nothing about detection.
    pub lit_before: bool,
    /// Whether FAULT came with the fault.
    pub detected: bool,
    /// How long after the fault, s.
    pub delay_s: f64,
    /// Whether FAULT was lit at the end.
    pub lit_at_end: bool,
    /// The likeliest cause and what is tied with it, joined by `|`.
    pub named: String,
    /// The phase that goes with it.
    pub named_phase: String,
    /// Its probability.
    pub named_probability: f64,
    /// The probability of the true cause.
    pub truth_probability: f64,
    /// Whether the true cause is likelier than any other.
    pub name_right: bool,
    /// Whether the true cause is among those named.
    pub truth_named: bool,
    /// Whether the phase is the right one; true where the fault has none.
    pub phase_right: bool,
}

/// Windows that a fault needs to be judged in, three of them for the lamp's persistence.
const STEADY_WINDOWS: u32 = 10;

const PHASES: [&str; 3] = ["a", "b", "c"];

impl Row {
    /// Makes the run.
    pub fn of(run: &Run<'_>) -> Row {
        let row = conditions(run);
        match run.outcome() {
            Ok(outcome) => with_outcome(row, run, &outcome),
            Err(not_run) => Row { not_run, ..row },
        }
    }

    /// Whether the fault was there and could be detected.
    pub fn is_a_try(&self) -> bool {
        self.is_faulty() && !self.lit_before && !self.is_unsteady()
    }

    /// Whether the motor stalled or swung with the fault: nothing to judge, and nothing lit.
    pub fn is_unsteady(&self) -> bool {
        let judged = self
            .judged_windows
            .saturating_sub(self.healthy_judged_windows);
        self.is_faulty() && !self.detected && judged < STEADY_WINDOWS
    }

    fn is_faulty(&self) -> bool {
        !self.fault.is_empty() && self.not_run.is_empty()
    }

    /// [`Row::named`], from the likeliest on.
    pub fn faults(&self) -> Vec<FaultId> {
        let names = self.named.split('|');
        names.filter_map(FaultId::from_name).collect()
    }

    /// Whether fault and phase were named rightly.
    pub fn is_isolated(&self) -> bool {
        self.name_right && self.phase_right
    }
}

fn conditions(run: &Run<'_>) -> Row {
    let of = |axis| run.conditions.of(axis);
    let case = run.place.case;
    let has_phase = case.is_some_and(|case| case.kind.has_phase);
    Row {
        index: run.index,
        seed: run.seed,
        motor: run.place.motor.name.clone(),
        block: run.place.block.name.clone(),
        fault: case.map_or("", |case| case.kind.name).to_owned(),
        phase: if has_phase { PHASES[run.phase] } else { "" }.to_owned(),
        change_percent: case.map_or(0.0, |case| case.percent),
        load_percent: of(Axis::Load),
        load_step_to_percent: of(Axis::LoadStepTo),
        voltage_percent: of(Axis::Voltage),
        voltage_step_to_percent: of(Axis::VoltageStepTo),
        frequency_hz: of(Axis::Frequency),
        unbalance_percent: of(Axis::Unbalance),
        voltage_thd_percent: of(Axis::Distortion),
        winding_degc: of(Axis::Winding),
        noise_percent_of_full_scale: of(Axis::Noise),
        adc_bits: of(Axis::Bits).round(),
        sensor_gain_error_percent: of(Axis::GainError),
        sample_rate_hz: of(Axis::SampleRate),
        backwards: of(Axis::Backwards).round(),
        ramp_s: of(Axis::Ramp),
        frequency_step_to_hz: of(Axis::FrequencyStepTo),
        load_cycle_s: of(Axis::LoadCycle),
        fault_from_s: if case.is_some() {
            run.fault_from_s
        } else {
            f64::NAN
        },
        first_false_s: f64::NAN,
        delay_s: f64::NAN,
        ..Row::default()
    }
}

fn with_outcome(row: Row, run: &Run<'_>, outcome: &Outcome) -> Row {
    let kind = run.place.case.map(|case| case.kind);
    let answer = outcome.answer(kind);
    Row {
        windows: outcome.windows,
        judged_windows: outcome.judged,
        healthy_judged_windows: outcome.healthy_judged,
        healthy_fault_windows: outcome.healthy_fault,
        moved_windows: outcome.moved,
        motion_judged_windows: outcome.judged_in_motion,
        healthy_unexplained: outcome.healthy_unexplained,
        found_in_motion: outcome.found_in_motion,
        first_false_s: outcome.first_false_s.unwrap_or(f64::NAN),
        false_cause: match outcome.healthy_fault {
            0 => String::new(),
            _ => cause::of(run),
        },
        healthy_lamps: outcome.healthy_lamps.to_string(),
        faulty_lamps: outcome.faulty_lamps.to_string(),
        not_judged: outcome.main_reason(),
        lit_before: kind.is_some() && outcome.lit_before,
        detected: outcome.delay_s.is_some(),
        delay_s: outcome.delay_s.unwrap_or(f64::NAN),
        lit_at_end: outcome.lit_at_end,
        phase_right: row.phase == answer.phase || row.phase.is_empty(),
        named: answer.named,
        named_phase: answer.phase,
        named_probability: answer.probability,
        truth_probability: answer.truth,
        name_right: answer.name_is_right,
        truth_named: answer.truth_is_named,
        ..row
    }
}
