//! Table 1 as measured, and the healthy motor at several loads.

use monitor::TABLE_1;
use motor::MotorFile;
use motor::motor_file::Frame;
use schemars::JsonSchema;
use serde::Serialize;

use super::DemoError;
use super::case::Case;
use scenario::PlantKind;

/// Both directions of every row, percent.
const CHANGES_PERCENT: [f64; 2] = [50.0, -50.0];
/// Experiments in one matrix.
pub const CASES: usize = TABLE_1.len() * CHANGES_PERCENT.len();

/// Table 1 on one plant, seen in one frame.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FaultMatrix {
    /// `linear`, the paper's model, or `full`, the three-phase motor.
    pub plant: &'static str,
    /// `voltage`, the paper's frame, or `rotor-flux`.
    pub frame: &'static str,
    /// Rows whose measured pattern is the published one.
    pub agree: usize,
    /// Rows.
    pub of: usize,
    /// The rows.
    pub table: Vec<FaultRow>,
}

/// One fault in one direction.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FaultRow {
    /// Row of Table 1.
    pub fault: &'static str,
    /// Change of the parameter or signal, percent.
    pub change_percent: f64,
    /// Published pattern of r1..r4, 1 is lit.
    pub expected: String,
    /// Pattern of the lamps.
    pub measured: String,
    /// Mean residuals, percent of their scales.
    pub r_percent: [f64; 4],
    /// Probability that the core gave this fault.
    pub probability: f64,
    /// Time from the fault to the FAULT lamp, s; `null` when it was lit before.
    pub delay_s: Option<f64>,
    /// Whether all lamps were dark again after the fault had gone.
    pub dark_after: bool,
}

/// The healthy motor at one load in one frame; the load is declared in its motor file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct HealthyRow {
    /// Load, percent of the motor file's friction.
    pub load_percent: f64,
    /// Frame of the residuals.
    pub frame: &'static str,
    /// Mean residuals, percent of their scales.
    pub r_percent: [f64; 4],
    /// Names of the lamps that were lit (RUN apart).
    pub lit: Vec<&'static str>,
}

impl FaultMatrix {
    /// Runs all rows in both directions.
    ///
    /// # Errors
    /// A motor that cannot be simulated.
    pub fn measure(
        motor: &MotorFile,
        plant: PlantKind,
        seed: u64,
        progress: &mut impl FnMut(),
    ) -> Result<Self, DemoError> {
        let mut table = Vec::with_capacity(CASES);
        for change_percent in CHANGES_PERCENT {
            for row in 0..TABLE_1.len() {
                table.push(FaultRow::measure(motor, plant, row, change_percent, seed)?);
                progress();
            }
        }
        Ok(FaultMatrix {
            plant: match plant {
                PlantKind::Linear => "linear",
                PlantKind::Full => "full",
            },
            frame: frame_name(motor.monitor.frame),
            agree: table.iter().filter(|row| row.agrees()).count(),
            of: table.len(),
            table,
        })
    }
}

impl FaultRow {
    fn measure(
        motor: &MotorFile,
        plant: PlantKind,
        row: usize,
        change_percent: f64,
        seed: u64,
    ) -> Result<Self, DemoError> {
        let (fault, expected) = TABLE_1[row];
        let result = Case {
            motor,
            plant,
            fault: Some((fault, change_percent)),
            seed,
        }
        .run()?;
        Ok(FaultRow {
            fault: fault.name(),
            change_percent,
            expected: digits(expected),
            measured: digits(result.lamps.pattern()),
            r_percent: result.r_percent,
            probability: result.candidates.map_or(0.0, |c| f64::from(c.faults[row])),
            delay_s: result.delay_s,
            dark_after: result.lamps_after.is_quiet(),
        })
    }

    /// Whether the lamps show the published pattern.
    pub fn agrees(&self) -> bool {
        self.expected == self.measured
    }
}

impl HealthyRow {
    /// Runs the healthy full motor at a load that its motor file declares.
    ///
    /// # Errors
    /// A motor that cannot carry the load.
    pub fn measure(
        motor: &MotorFile,
        load_percent: f64,
        frame: Frame,
        seed: u64,
    ) -> Result<Self, DemoError> {
        let mut motor = motor.clone();
        motor.monitor.frame = frame;
        let factor = load_percent / 100.0;
        motor.mechanics.friction *= factor;
        motor.mechanics.load_friction *= factor;
        let result = Case {
            motor: &motor,
            plant: PlantKind::Full,
            fault: None,
            seed,
        }
        .run()?;
        Ok(HealthyRow {
            load_percent,
            frame: frame_name(frame),
            r_percent: result.r_percent,
            lit: result.lamps.lit_names().collect(),
        })
    }
}

fn digits(pattern: [bool; 4]) -> String {
    pattern
        .map(|on| if on { '1' } else { '0' })
        .iter()
        .collect()
}

fn frame_name(frame: Frame) -> &'static str {
    match frame {
        Frame::RotorFlux => "rotor-flux",
        Frame::Voltage => "voltage",
    }
}
