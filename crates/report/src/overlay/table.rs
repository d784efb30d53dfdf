//! Measured and modelled points of a load table.

use discovery::table_values;
use motor::MotorFile;
use recording::{LoadPoint, Source};
use schemars::JsonSchema;
use serde::Serialize;

use super::{Model, rounded};

/// Revolutions per minute in one radian per second.
const RPM: f64 = 60.0 / std::f64::consts::TAU;

/// A load table with models beside it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TableOverlay {
    /// The table.
    pub recording: String,
    /// The models, in the order of all lists below.
    pub models: Vec<String>,
    /// Points by rising load.
    pub points: Vec<TablePoint>,
}

/// One operating point.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TablePoint {
    /// Shaft power, or torque, or line current, whichever is measured: percent of rated.
    pub load_percent: f64,
    /// As measured.
    pub measured: Quantities,
    /// As each model has it.
    pub modelled: Vec<Quantities>,
}

/// What a table tells of a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Quantities {
    /// Line current, A rms.
    pub current_rms_amp: Option<f64>,
    /// Speed, revolutions per minute.
    pub speed_rpm: Option<f64>,
    /// Power factor.
    pub power_factor: Option<f64>,
    /// Efficiency.
    pub efficiency: Option<f64>,
}

impl TableOverlay {
    /// The same under the name by which people know the table.
    pub fn named(self, name: Option<&String>) -> TableOverlay {
        TableOverlay {
            recording: name.cloned().unwrap_or(self.recording),
            ..self
        }
    }

    /// Runs the models on a load table; `None` for recordings over time.
    pub fn new(source: &Source, motor: &MotorFile, models: &[Model]) -> Option<TableOverlay> {
        let Source::LoadTable(table) = source else {
            return None;
        };
        let values: Vec<_> = models
            .iter()
            .map(|m| table_values(table, &m.plant))
            .collect();
        let point = |(k, p): (usize, &LoadPoint)| {
            let modelled: Option<Vec<_>> = values.iter().map(|v| v[k].map(modelled)).collect();
            Some(TablePoint {
                load_percent: rounded(load_percent(p, motor)?),
                measured: measured(p),
                modelled: modelled?,
            })
        };
        let mut points: Vec<_> = table
            .points()
            .iter()
            .enumerate()
            .filter_map(point)
            .collect();
        points.sort_by(|a, b| a.load_percent.total_cmp(&b.load_percent));
        Some(TableOverlay {
            recording: table.name().to_owned(),
            models: models.iter().map(|model| model.label.clone()).collect(),
            points,
        })
    }
}

fn load_percent(p: &LoadPoint, motor: &MotorFile) -> Option<f64> {
    let plate = &motor.nameplate;
    let power = p.power_watt.map(|x| x / plate.power_watt);
    let torque = p.torque_nm.map(|x| x / plate.torque_nm);
    let current = p.current_rms_amp.map(|x| x / plate.current_rms_amp);
    power.or(torque).or(current).map(|share| 100.0 * share)
}

fn measured(p: &LoadPoint) -> Quantities {
    Quantities {
        current_rms_amp: p.current_rms_amp,
        speed_rpm: p.speed_rpm,
        power_factor: p.power_factor,
        efficiency: p.efficiency,
    }
}

fn modelled([current, speed, power_factor, efficiency]: [f64; 4]) -> Quantities {
    Quantities {
        current_rms_amp: Some(rounded(current)),
        speed_rpm: Some(rounded(speed * RPM)),
        power_factor: Some(rounded(power_factor)),
        efficiency: Some(rounded(efficiency)),
    }
}
