//! What rows amount to: healthy windows and their alarms, and what is detected.

use schemars::JsonSchema;
use serde::Serialize;

use crate::results::detection::{Detection, detection};
use crate::results::groups::{Named, counted, grouped};
use crate::results::statistics::Share;
use crate::runs::file::{About, Results};
use crate::runs::row::Row;

/// A campaign, counted.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Table {
    /// Which campaign.
    #[serde(flatten)]
    pub about: About,
    /// Runs that are counted here.
    pub counted: u64,
    /// Runs whose motor cannot run under their conditions.
    pub not_run: u64,
    /// Healthy windows judged.
    pub healthy_windows: u64,
    /// Windows with FAULT lit among the healthy ones.
    pub fault_windows: u64,
    /// Targets that are met.
    pub targets_met: Share,
    /// Healthy windows, by motor and block.
    pub healthy: Vec<Healthy>,
    /// Runs with FAULT on a healthy motor.
    pub alarms: Vec<Alarm>,
    /// How often each condition was to blame for them.
    pub causes: Vec<Named>,
    /// What is detected.
    pub detection: Vec<Detection>,
}

/// The healthy windows of one motor in one block.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Healthy {
    /// The motor.
    pub motor: String,
    /// The block.
    pub block: String,
    /// Windows judged.
    pub judged_windows: u64,
    /// Windows that were not at rest; 0 where the plan does not ask for them.
    pub moved_windows: u64,
    /// Of these judged in motion, among those judged.
    pub motion_judged_windows: u64,
    /// Runs in which something came in motion on the healthy motor that no fault explains: no FAULT, and not called healthy.
    pub unexplained_runs: u64,
    /// Windows with FAULT lit, and alarms in motion.
    pub fault_windows: u64,
    /// Runs with such windows.
    pub fault_runs: Share,
    /// Probability of such a run, at most, with 95 % confidence.
    pub fault_run_probability_at_most: f64,
}

/// FAULT on a healthy motor.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Alarm {
    /// The run.
    pub index: u64,
    /// The motor.
    pub motor: String,
    /// The block.
    pub block: String,
    /// Windows with FAULT lit.
    pub fault_windows: u32,
    /// Windows judged.
    pub judged_windows: u32,
    /// When it was lit first, s.
    pub first_s: f64,
    /// Lamps seen.
    pub lamps: String,
    /// Likeliest cause named.
    pub named: String,
    /// The conditions without any single one of which FAULT stays dark.
    pub cause: String,
    /// The conditions in words.
    pub conditions: String,
}

impl Table {
    /// Counts a campaign.
    pub fn of(results: &Results) -> Table {
        let rows = &results.rows;
        let (healthy, detection) = (healthy(rows), detection(results));
        Table {
            about: results.about.clone(),
            counted: rows.len() as u64,
            not_run: rows.iter().filter(|row| !row.not_run.is_empty()).count() as u64,
            healthy_windows: healthy.iter().map(|row| row.judged_windows).sum(),
            fault_windows: healthy.iter().map(|row| row.fault_windows).sum(),
            targets_met: Share::count(detection.iter().filter_map(|row| row.target_met)),
            alarms: rows.iter().filter(is_alarm).map(alarm).collect(),
            causes: counted(
                rows.iter()
                    .filter(is_alarm)
                    .map(|row| row.false_cause.clone()),
            ),
            healthy,
            detection,
        }
    }
}

fn healthy(rows: &[Row]) -> Vec<Healthy> {
    let key = |row: &Row| {
        row.not_run
            .is_empty()
            .then(|| (row.motor.clone(), row.block.clone()))
    };
    let groups = grouped(rows, key).into_iter();
    let count = |group: Vec<&Row>| {
        let fault_runs = Share::count(group.iter().map(is_alarm));
        let sum = |of: fn(&Row) -> u32| group.iter().map(|row| u64::from(of(row))).sum();
        Healthy {
            motor: group[0].motor.clone(),
            block: group[0].block.clone(),
            judged_windows: sum(|row| row.healthy_judged_windows),
            moved_windows: sum(|row| row.moved_windows),
            motion_judged_windows: sum(|row| row.motion_judged_windows),
            unexplained_runs: sum(|row| u32::from(row.healthy_unexplained > 0)),
            fault_windows: sum(|row| row.healthy_fault_windows),
            fault_runs,
            fault_run_probability_at_most: fault_runs.at_most(),
        }
    };
    groups.map(count).collect()
}

fn is_alarm(row: &&Row) -> bool {
    row.healthy_fault_windows > 0
}

fn alarm(row: &Row) -> Alarm {
    Alarm {
        index: row.index,
        motor: row.motor.clone(),
        block: row.block.clone(),
        fault_windows: row.healthy_fault_windows,
        judged_windows: row.healthy_judged_windows,
        first_s: row.first_false_s,
        lamps: row.healthy_lamps.clone(),
        named: row.named.clone(),
        cause: row.false_cause.clone(),
        conditions: conditions(row),
    }
}

/// The conditions of a run in words.
pub fn conditions(row: &Row) -> String {
    let step = |to: f64| {
        if to.is_nan() {
            String::new()
        } else {
            format!(" to {to:.0}")
        }
    };
    format!(
        "load {:.0}{} %, voltage {:.0}{} %, {:.1} Hz, unbalance {:.1} %, THD {:.1} %, {:.0} degC, noise {:.2} %, gains within {:.2} %{}",
        row.load_percent,
        step(row.load_step_to_percent),
        row.voltage_percent,
        step(row.voltage_step_to_percent),
        row.frequency_hz,
        row.unbalance_percent,
        row.voltage_thd_percent,
        row.winding_degc,
        row.noise_percent_of_full_scale,
        row.sensor_gain_error_percent,
        beyond_the_board(row),
    )
}

/// What not every campaign asks: another sampling rate than the board's, the mirror, ramps.
fn beyond_the_board(row: &Row) -> String {
    let mut more = String::new();
    if row.sample_rate_hz > 0.0 && row.sample_rate_hz != 10_000.0 {
        more += &format!(", {:.0} samples a second", row.sample_rate_hz);
    }
    if row.frequency_step_to_hz > 0.0 {
        more += &format!(", to {:.1} Hz", row.frequency_step_to_hz);
    }
    if row.load_cycle_s > 0.0 {
        more += &format!(", load in cycles of {:.2} s", row.load_cycle_s);
    }
    if row.ramp_s > 0.0 {
        more += &format!(", within {:.1} s", row.ramp_s);
    }
    if row.backwards > 0.0 {
        more += ", backwards";
    }
    more
}
