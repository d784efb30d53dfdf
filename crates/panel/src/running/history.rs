//! The last windows, for a page that comes later and for export.

use std::collections::VecDeque;

use serde::Serialize;

use crate::running::message::WindowMessage;

/// Windows that are kept: two minutes at 50 Hz.
const MOST_WINDOWS: usize = 6_000;

/// One window as a row of a table.
#[derive(Clone, Debug, Default, PartialEq, Serialize, parquet_derive::ParquetRecordWriter)]
pub struct HistoryRow {
    /// End of the window on the source's clock, s.
    pub t_s: f64,
    /// r1, percent of its scale.
    pub r1_percent: Option<f32>,
    /// r2, percent of its scale.
    pub r2_percent: Option<f32>,
    /// r3, percent of its scale.
    pub r3_percent: Option<f32>,
    /// r4, percent of its scale.
    pub r4_percent: Option<f32>,
    /// Distance from the healthy motor, standard deviations.
    pub significance_sigma: Option<f32>,
    /// Thresholds were applied.
    pub judged: bool,
    /// FAULT is on.
    pub fault: bool,
    /// Lamps that are on, RUN apart, separated by blanks.
    pub lit: String,
    /// Positive sequence of the phase voltages, V rms.
    pub voltage_rms_volt: Option<f32>,
    /// Positive sequence of the phase currents, A rms.
    pub current_rms_amp: Option<f32>,
    /// Supply frequency, Hz.
    pub frequency_hz: Option<f32>,
    /// Shaft speed, rad/s.
    pub speed_rad_s: Option<f32>,
    /// Slip, percent.
    pub slip_percent: Option<f32>,
    /// Air-gap torque, N m.
    pub torque_nm: Option<f32>,
    /// The same, percent of rated.
    pub load_percent: Option<f32>,
}

/// The last windows in the order of time.
#[derive(Clone, Debug, Default)]
pub struct History {
    rows: VecDeque<HistoryRow>,
}

impl History {
    /// Adds a window; an older clock begins anew.
    pub fn push(&mut self, window: &WindowMessage) {
        if self.rows.back().is_some_and(|last| last.t_s >= window.t_s) {
            self.rows.clear();
        }
        if self.rows.len() >= MOST_WINDOWS {
            self.rows.pop_front();
        }
        self.rows.push_back(HistoryRow::of(window));
    }

    /// All rows, the oldest first.
    pub fn rows(&self) -> Vec<HistoryRow> {
        self.rows.iter().cloned().collect()
    }
}

impl HistoryRow {
    fn of(window: &WindowMessage) -> HistoryRow {
        let r = window.r_percent.map_or([None; 4], |r| r.map(Some));
        let operation = &window.operation;
        HistoryRow {
            t_s: window.t_s,
            r1_percent: r[0],
            r2_percent: r[1],
            r3_percent: r[2],
            r4_percent: r[3],
            significance_sigma: window.significance_sigma,
            judged: window.not_judged.is_none(),
            fault: window.lamps.fault == monitor::Lamp::On,
            lit: window.lamps.lit().join(" "),
            voltage_rms_volt: operation.voltage_rms_volt,
            current_rms_amp: operation.current_rms_amp,
            frequency_hz: operation.frequency_hz,
            speed_rad_s: operation.speed_rad_s,
            slip_percent: operation.slip_percent,
            torque_nm: operation.torque_nm,
            load_percent: operation.load_percent,
        }
    }
}
