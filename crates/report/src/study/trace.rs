//! Every window of a replay as a row of a Parquet file.

use std::io::Write;

use formats::RowsWriter;
use monitor::{Lamp, Report};
use parquet::errors::ParquetError;
use parquet_derive::ParquetRecordWriter;
use replay::{Unjudged, WindowOperation, WindowResiduals};

/// What one window was, and what the lamps said. Units stand in the names; a number that does not exist is NaN, a text empty.
#[derive(Clone, Debug, PartialEq, ParquetRecordWriter)]
pub struct WindowRow {
    /// End of the window, s.
    pub t_s: f64,
    /// Whether the motor was judged in it, at rest.
    pub judged: bool,
    /// Why it was not.
    pub not_judged: String,
    /// Whether FAULT was lit.
    pub fault: bool,
    /// Residual r1, percent of its scale.
    pub r1_percent: f64,
    /// Residual r2.
    pub r2_percent: f64,
    /// Residual r3.
    pub r3_percent: f64,
    /// Residual r4.
    pub r4_percent: f64,
    /// Positive sequence of the phase voltages, V rms.
    pub voltage_rms_volt: f64,
    /// Positive sequence of the phase currents, A rms.
    pub current_rms_amp: f64,
    /// Supply frequency, Hz.
    pub frequency_hz: f64,
    /// Shaft speed, mechanical rad/s.
    pub speed_rad_s: f64,
    /// Brake torque, N m.
    pub torque_nm: f64,
    /// Negative over positive sequence of the currents, percent.
    pub i2_over_i1_percent: f64,
    /// Negative over positive sequence of the voltages, percent.
    pub v2_over_v1_percent: f64,
}

impl WindowRow {
    /// Of one report; `t` is the time of the window's end, s.
    pub fn of(t: f64, report: &Report) -> WindowRow {
        let residuals = WindowResiduals::of(t, report);
        let [r1, r2, r3, r4] = residuals.map_or([f64::NAN; 4], |residuals| residuals.r_percent);
        let operation = WindowOperation::of(t, report);
        let of = |quantity: fn(&WindowOperation) -> Option<f64>| {
            operation.as_ref().and_then(quantity).unwrap_or(f64::NAN)
        };
        let why = report.not_judged;
        WindowRow {
            t_s: t,
            judged: report.is_judged(),
            not_judged: why.map_or_else(String::new, |why| Unjudged::ByCore(why).to_string()),
            fault: report.lamps.fault == Lamp::On,
            r1_percent: r1,
            r2_percent: r2,
            r3_percent: r3,
            r4_percent: r4,
            voltage_rms_volt: of(|one| one.voltage_rms_volt),
            current_rms_amp: of(|one| one.current_rms_amp),
            frequency_hz: of(|one| Some(one.frequency_hz)),
            speed_rad_s: of(|one| one.speed_rad_s),
            torque_nm: of(|one| one.torque_nm),
            i2_over_i1_percent: 100.0 * of(|one| one.i2_over_i1),
            v2_over_v1_percent: 100.0 * of(|one| one.v2_over_v1),
        }
    }
}

/// Writes windows as they come; memory does not grow with them.
pub struct WindowTrace<W: Write + Send> {
    rows: RowsWriter<WindowRow, W>,
    failed: Option<ParquetError>,
}

impl<W: Write + Send> WindowTrace<W> {
    /// Before the first window.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn new(file: W) -> Result<Self, ParquetError> {
        Ok(WindowTrace {
            rows: RowsWriter::new(file)?,
            failed: None,
        })
    }

    /// Takes a window; what cannot be written is told by [`WindowTrace::finish`].
    pub fn add(&mut self, t: f64, report: &Report) {
        if self.failed.is_none() {
            self.failed = self.rows.push(WindowRow::of(t, report)).err();
        }
    }

    /// Writes what is left.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> Result<(), ParquetError> {
        match self.failed {
            Some(error) => Err(error),
            None => self.rows.finish(),
        }
    }
}
