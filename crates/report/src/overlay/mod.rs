//! Measured and modelled signals over each other, for figures: the recorded voltages drive the models.
//!
//! Unlike the errors that `compare`, `explain` and `adopt` state, these are in the signals' own units, and the voltages are
//! taken as recorded, with their noise.

mod drive;
mod model;
mod table;

pub use model::Model;
pub use table::{Quantities, TableOverlay, TablePoint};

use motor::effect::Outputs;
use recording::{Recording, Source};
use schemars::JsonSchema;
use serde::Serialize;

use drive::Drive;

/// Most rows of the whole recording; more would make a page slow without showing more.
const ROWS: usize = 6000;
/// Length of a block over which errors are averaged, s.
const BLOCK_S: f64 = 0.04;
/// Length of the close look at the worst place, s.
const CLOSE_S: f64 = 0.12;
/// Digits that a figure can show.
const DIGITS: i32 = 5;

/// A recording with models beside it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Overlay {
    /// The recording.
    pub recording: String,
    /// The models, in the order of all lists below.
    pub models: Vec<String>,
    /// The whole recording, thinned.
    pub whole: Traces,
    /// Every sample around the place where the first model is furthest off in current.
    pub close: Traces,
    /// Operating point and errors of each block of 40 ms.
    pub blocks: Vec<Block>,
}

/// Signals over one clock.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Traces {
    /// Time, s.
    pub t: Vec<f64>,
    /// The signals.
    pub signals: Vec<Trace>,
}

/// One signal, measured and modelled.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Trace {
    /// Channel.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// As recorded.
    pub measured: Vec<f64>,
    /// One list for each model.
    pub modelled: Vec<Vec<f64>>,
}

/// One block of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Block {
    /// Middle, s.
    pub t: f64,
    /// Brake torque, percent of rated; absent where it is not measured.
    pub load_percent: Option<f64>,
    /// Voltage, percent of rated.
    pub voltage_percent: f64,
    /// Slip, percent; absent without speed or voltage.
    pub slip_percent: Option<f64>,
    /// Supply frequency, Hz; absent without voltage.
    pub frequency_hz: Option<f64>,
    /// Rms error of the three currents, A, for each model.
    pub current_error_amp: Vec<f64>,
    /// Rms error of the speed, rad/s, for each model; empty without a speed that the model can be held to.
    pub speed_error_rad_s: Vec<f64>,
}

impl Overlay {
    /// Simulates the models on a recording; `None` for load tables and recordings that cannot drive a model.
    pub fn new(source: &Source, models: &[Model]) -> Option<Overlay> {
        let Source::Recording(recording) = source else {
            return None;
        };
        let first = models.first()?;
        let drive = Drive::new(recording, &first.plant.rated)?;
        let outputs: Vec<Outputs> = models.iter().map(|model| drive.run(&model.plant)).collect();
        let board = Board {
            recording,
            drive: &drive,
            outputs: &outputs,
        };
        let blocks = board.blocks(first);
        let worst = blocks.iter().max_by(|a, b| {
            let error = |block: &Block| block.current_error_amp.first().copied().unwrap_or(0.0);
            error(a).total_cmp(&error(b))
        });
        let middle = worst.map_or(0.0, |block| block.t);
        Some(Overlay {
            recording: recording.name().to_owned(),
            models: models.iter().map(|model| model.label.clone()).collect(),
            whole: board.traces(0..drive.rows(), drive.rows().div_ceil(ROWS).max(1)),
            close: board.traces(drive.rows_around(middle, CLOSE_S), 1),
            blocks,
        })
    }

    /// The same under the name by which people know the recording.
    pub fn named(self, name: Option<&String>) -> Overlay {
        Overlay {
            recording: name.cloned().unwrap_or(self.recording),
            ..self
        }
    }

    /// Measured and modelled signals from one instant to another, s; every sample unless they are too many.
    /// `None` as for [`Overlay::new`], and where the stretch holds no samples.
    pub fn part(source: &Source, models: &[Model], from_s: f64, to_s: f64) -> Option<Traces> {
        let Source::Recording(recording) = source else {
            return None;
        };
        let drive = Drive::new(recording, &models.first()?.plant.rated)?;
        let rows = drive.rows_around(0.5 * (from_s + to_s), to_s - from_s);
        if rows.len() < 2 {
            return None;
        }
        let outputs: Vec<Outputs> = models.iter().map(|model| drive.run(&model.plant)).collect();
        let board = Board {
            recording,
            drive: &drive,
            outputs: &outputs,
        };
        let every = rows.len().div_ceil(ROWS);
        Some(board.traces(rows, every))
    }
}

/// Everything that is laid over each other.
struct Board<'a> {
    recording: &'a Recording,
    drive: &'a Drive,
    outputs: &'a [Outputs],
}

impl Board<'_> {
    fn traces(&self, rows: std::ops::Range<usize>, every: usize) -> Traces {
        let rows: Vec<usize> = rows.step_by(every).collect();
        let mut signals = Vec::new();
        for (phase, name) in ["ia", "ib", "ic"].into_iter().enumerate() {
            let modelled = |out: &Outputs, row: usize| out.i_s_abc[row][phase];
            let measured = self.recording.currents().map(|i| i[phase]);
            signals.extend(self.trace(name, "A", measured, &rows, modelled));
        }
        let speed = self.recording.speed();
        signals.extend(self.trace("speed", "rad/s", speed, &rows, |out, row| {
            out.omega_mech[row]
        }));
        Traces {
            t: rows.iter().map(|&row| rounded(self.drive.t(row))).collect(),
            signals,
        }
    }

    fn trace(
        &self,
        name: &'static str,
        unit: &'static str,
        measured: Option<&[f64]>,
        rows: &[usize],
        modelled: impl Fn(&Outputs, usize) -> f64,
    ) -> Option<Trace> {
        let measured = measured?;
        let pick = |out: &Outputs| {
            rows.iter()
                .map(|&row| rounded(modelled(out, row)))
                .collect()
        };
        Some(Trace {
            name,
            unit,
            measured: rows
                .iter()
                .map(|&row| rounded(measured[self.drive.sample(row)]))
                .collect(),
            modelled: self.outputs.iter().map(pick).collect(),
        })
    }

    fn blocks(&self, model: &Model) -> Vec<Block> {
        let length = ((BLOCK_S / self.drive.t_row()).round() as usize).max(1);
        let count = self.drive.rows() / length;
        (0..count)
            .map(|k| self.block(k * length..(k + 1) * length, model))
            .collect()
    }

    fn block(&self, rows: std::ops::Range<usize>, model: &Model) -> Block {
        let rated = &model.plant.rated;
        let samples = self.drive.sample(rows.start)..self.drive.sample(rows.end - 1) + 1;
        let point = self.drive.point(samples.clone());
        let speed = self
            .recording
            .speed()
            .map(|speed| mean(&speed[samples.clone()]));
        let torque = self.recording.torque().map(|torque| mean(&torque[samples]));
        let supplied = point.amplitude > LEAST_VOLTAGE * rated.voltage;
        let omega_sync = Some(point.omega_sync).filter(|omega| supplied && *omega > 0.0);
        let slip = |(omega_sync, speed): (f64, f64)| 100.0 * (1.0 - rated.n_p * speed / omega_sync);
        Block {
            t: rounded(0.5 * (self.drive.t(rows.start) + self.drive.t(rows.end - 1))),
            load_percent: torque.map(|torque| rounded(100.0 * torque / rated.torque)),
            voltage_percent: rounded(100.0 * point.amplitude / rated.voltage),
            slip_percent: omega_sync.zip(speed).map(slip).map(rounded),
            frequency_hz: omega_sync.map(|omega| rounded(omega / std::f64::consts::TAU)),
            current_error_amp: self.errors(&rows, &|out, row| self.current_error(out, row)),
            speed_error_rad_s: match self
                .recording
                .speed()
                .filter(|_| !self.drive.imposes_speed())
            {
                None => Vec::new(),
                Some(speed) => self.errors(&rows, &|out, row| {
                    (out.omega_mech[row] - speed[self.drive.sample(row)]).powi(2)
                }),
            },
        }
    }

    /// Mean square of the three current errors at a row.
    fn current_error(&self, out: &Outputs, row: usize) -> f64 {
        let sample = self.drive.sample(row);
        let Some(measured) = self.recording.currents() else {
            return 0.0;
        };
        let square = |phase: usize| (out.i_s_abc[row][phase] - measured[phase][sample]).powi(2);
        (0..3).map(square).sum::<f64>() / 3.0
    }

    /// Rms over rows, for each model.
    fn errors(
        &self,
        rows: &std::ops::Range<usize>,
        square: &dyn Fn(&Outputs, usize) -> f64,
    ) -> Vec<f64> {
        let rms = |out: &Outputs| {
            let sum: f64 = rows.clone().map(|row| square(out, row)).sum();
            rounded((sum / rows.len() as f64).sqrt())
        };
        self.outputs.iter().map(rms).collect()
    }
}

/// Share of the rated voltage below which the motor counts as not supplied.
const LEAST_VOLTAGE: f64 = 0.02;

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len().max(1) as f64
}

/// With as many digits as a figure can show; infinite values become the largest number, so that they stay numbers.
fn rounded(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return if x.is_finite() { 0.0 } else { f64::MAX };
    }
    let digits = DIGITS - 1 - x.abs().log10().floor() as i32;
    let scale = 10.0_f64.powi(digits.clamp(-300, 300));
    (x * scale).round() / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_keep_five_digits() {
        assert_eq!(rounded(1.234_567_8), 1.2346);
        assert_eq!(rounded(-98_765.43), -98_765.0);
        assert_eq!(rounded(0.000_123_456_7), 0.000_123_46);
        assert_eq!(rounded(0.0), 0.0);
        assert!(rounded(f64::NAN).is_finite());
    }
}
