//! A load-test table as operating points.

use motor::MotorFile;
use recording::LoadTable;
use schemars::JsonSchema;
use serde::Serialize;

/// All points of a table with what follows from them.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct OperatingPoints {
    /// Name of the table.
    pub table: String,
    /// One entry per row.
    pub operating_points: Vec<Point>,
}

/// One operating point; what neither the table nor the nameplate gives is absent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Point {
    /// Shaft power, W.
    pub power_watt: Option<f64>,
    /// Line current, A rms.
    pub current_rms_amp: Option<f64>,
    /// Shaft speed, revolutions per minute.
    pub speed_rpm: Option<f64>,
    /// Slip, percent of synchronous speed; needs the motor file.
    pub slip_percent: Option<f64>,
    /// Shaft torque, N m: measured, or power over speed.
    pub torque_nm: Option<f64>,
    /// Power factor.
    pub power_factor: Option<f64>,
    /// Efficiency.
    pub efficiency: Option<f64>,
    /// Losses: input minus output power, W; needs voltage, current and power factor.
    pub losses_watt: Option<f64>,
}

impl OperatingPoints {
    /// The points of `table`; a motor file adds slip and, from its rated voltage, losses.
    pub fn new(table: &LoadTable, motor: Option<&MotorFile>) -> Self {
        OperatingPoints {
            table: table.name().to_owned(),
            operating_points: table
                .points()
                .iter()
                .map(|row| Point::new(row, motor))
                .collect(),
        }
    }
}

impl Point {
    fn new(row: &recording::LoadPoint, motor: Option<&MotorFile>) -> Self {
        let plate = motor.map(|motor| &motor.nameplate);
        let omega_mech = row.speed_rpm.map(|rpm| rpm * std::f64::consts::TAU / 60.0);
        let from_power = row
            .power_watt
            .zip(omega_mech)
            .filter(|(_, omega)| *omega > 0.0);
        let volt = row
            .voltage_line_rms_volt
            .or(plate.map(|plate| plate.voltage_line_rms_volt));
        let input = volt
            .zip(row.current_rms_amp)
            .zip(row.power_factor)
            .map(|((volt, amp), power_factor)| 3.0_f64.sqrt() * volt * amp * power_factor);
        Point {
            power_watt: row.power_watt,
            current_rms_amp: row.current_rms_amp,
            speed_rpm: row.speed_rpm,
            slip_percent: plate
                .zip(omega_mech)
                .map(|(plate, omega)| 100.0 * (1.0 - omega / plate.synchronous_speed_mech())),
            torque_nm: row
                .torque_nm
                .or(from_power.map(|(power, omega)| power / omega)),
            power_factor: row.power_factor,
            efficiency: row.efficiency,
            losses_watt: input
                .zip(row.power_watt)
                .map(|(input, output)| input - output),
        }
    }

    fn cells(&self) -> [Option<f64>; 8] {
        [
            self.power_watt,
            self.current_rms_amp,
            self.speed_rpm,
            self.slip_percent,
            self.torque_nm,
            self.power_factor,
            self.efficiency,
            self.losses_watt,
        ]
    }
}

/// Title and decimals of each column.
const COLUMNS: [(&str, usize); 8] = [
    ("power W", 0),
    ("current A", 2),
    ("speed rpm", 0),
    ("slip %", 2),
    ("torque Nm", 2),
    ("cos phi", 3),
    ("efficiency", 4),
    ("losses W", 0),
];

impl std::fmt::Display for OperatingPoints {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let count = self.operating_points.len();
        writeln!(
            f,
            "{}: load-test table, {count} operating points",
            self.table
        )?;
        for (title, _) in COLUMNS {
            write!(f, "{title:>12}")?;
        }
        for point in &self.operating_points {
            writeln!(f)?;
            for (value, (_, decimals)) in point.cells().iter().zip(COLUMNS) {
                match value {
                    Some(value) => write!(f, "{value:>12.decimals$}")?,
                    None => write!(f, "{:>12}", "-")?,
                }
            }
        }
        Ok(())
    }
}
