//! What a model is held against: the waveforms of a recording, or the operating points of a load-test table.

mod judged_speed;
mod switched_off;
mod waveform;

use crate::data::channels::N_CHANNELS;
use crate::data::load_table::{LoadPoints, load_points};
use crate::data::unsupported::Unsupported;
use motor::effect::{Plant, Rated};
use recording::{LoadTable, Recording};
use std::ops::Range;

pub use waveform::{RELATIVE_CURRENT, Speeds, Waveform, running_at};

/// Output channels of a recording in the order of a residual row, and their units.
const OF_RECORDING: [(&str, &str); N_CHANNELS] = [
    ("ia", "A"),
    ("ib", "A"),
    ("ic", "A"),
    ("speed", "rad/s"),
    ("v0", "V"),
];
/// Output channels of a load table.
const OF_TABLE: [(&str, &str); N_CHANNELS] = [
    ("current", "A rms"),
    ("speed", "rad/s"),
    ("power_factor", "-"),
    ("efficiency", "-"),
    ("", ""),
];

/// What a model is held against, made ready.
#[derive(Clone, Debug)]
pub enum Case {
    /// Samples of a recording: the model is simulated.
    Waveform(Box<Waveform>),
    /// Points of a load-test table: the model is solved in steady state.
    LoadTable(LoadPoints),
}

impl From<Waveform> for Case {
    fn from(waveform: Waveform) -> Self {
        Case::Waveform(Box::new(waveform))
    }
}

impl Case {
    /// Prepares a recording.
    ///
    /// # Errors
    /// As [`Waveform::new`].
    pub fn new(rec: &Recording, rated: &Rated<f64>) -> Result<Self, Unsupported> {
        Waveform::new(rec, rated).map(Case::from)
    }

    /// Prepares a load-test table.
    ///
    /// # Errors
    /// With fewer than five points.
    pub fn of_table(table: &LoadTable, rated: &Rated<f64>) -> Result<Self, Unsupported> {
        load_points(table, rated).map(Case::LoadTable)
    }

    /// The waveforms; `None` of a load table.
    pub fn waveform(&self) -> Option<&Waveform> {
        match self {
            Case::Waveform(waveform) => Some(waveform),
            Case::LoadTable(_) => None,
        }
    }

    /// The same to be changed.
    pub fn waveform_mut(&mut self) -> Option<&mut Waveform> {
        match self {
            Case::Waveform(waveform) => Some(waveform),
            Case::LoadTable(_) => None,
        }
    }

    /// The same with the scale of the speed as a plant has it: see [`Waveform::as_seen_by`].
    pub fn as_seen_by(&self, plant: &Plant) -> Self {
        match self {
            Case::Waveform(waveform) => waveform.as_seen_by(plant).into(),
            Case::LoadTable(_) => self.clone(),
        }
    }

    /// Whether it is a load table.
    pub fn is_table(&self) -> bool {
        matches!(self, Case::LoadTable(_))
    }

    /// Measured rows.
    pub fn measured(&self) -> &[[f64; N_CHANNELS]] {
        match self {
            Case::Waveform(waveform) => &waveform.measured,
            Case::LoadTable(table) => &table.measured,
        }
    }

    /// One over the standard deviation of each measured value; zero where not judged.
    pub fn weight(&self) -> &[[f64; N_CHANNELS]] {
        match self {
            Case::Waveform(waveform) => &waveform.weight,
            Case::LoadTable(table) => &table.weight,
        }
    }

    /// Names and units of the output channels.
    pub fn channels(&self) -> [(&'static str, &'static str); N_CHANNELS] {
        match self {
            Case::Waveform(_) => OF_RECORDING,
            Case::LoadTable(_) => OF_TABLE,
        }
    }

    /// Rows of each block, a short rest joined to the last; of a load table each point.
    pub fn blocks(&self) -> Vec<Range<usize>> {
        match self {
            Case::Waveform(waveform) => waveform.blocks(),
            Case::LoadTable(table) => whole_blocks(table.measured.len(), 1),
        }
    }

    /// Number of values that are judged.
    pub fn judged(&self) -> f64 {
        let one = |w: &[f64; N_CHANNELS]| w.iter().filter(|&&w| w > 0.0).count();
        self.weight().iter().map(one).sum::<usize>() as f64
    }

    /// Takes out of weighted rows what nothing is judged by: the state in which the motor was when a recording began.
    pub fn project_out(&self, rows: &mut [f64]) {
        if let Case::Waveform(waveform) = self {
            waveform.nuisance.project_out(rows);
        }
    }
}

/// Blocks of so many rows, a short rest joined to the last.
fn whole_blocks(rows: usize, block: usize) -> Vec<Range<usize>> {
    let n = rows / block;
    let end = |k: usize| if k + 1 == n { rows } else { (k + 1) * block };
    (0..n).map(|k| k * block..end(k)).collect()
}

#[cfg(test)]
mod tests;
