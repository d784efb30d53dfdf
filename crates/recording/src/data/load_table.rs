//! A steady-state load test: one row per operating point.

use crate::error::Error;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// A column of a load table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TableColumn {
    /// Shaft power, W.
    Power,
    /// Line current, A rms.
    Current,
    /// Shaft speed, rpm.
    Speed,
    /// Power factor, 0 to 1.
    PowerFactor,
    /// Efficiency, 0 to 1.
    Efficiency,
    /// Shaft torque, N m.
    Torque,
    /// Line-to-line voltage, V rms.
    Voltage,
}

impl TableColumn {
    /// Every column.
    pub const ALL: [TableColumn; 7] = [
        TableColumn::Power,
        TableColumn::Current,
        TableColumn::Speed,
        TableColumn::PowerFactor,
        TableColumn::Efficiency,
        TableColumn::Torque,
        TableColumn::Voltage,
    ];

    /// The column name in a file, with its unit.
    pub const fn name(self) -> &'static str {
        match self {
            TableColumn::Power => "power_watt",
            TableColumn::Current => "current_rms_amp",
            TableColumn::Speed => "speed_rpm",
            TableColumn::PowerFactor => "power_factor",
            TableColumn::Efficiency => "efficiency",
            TableColumn::Torque => "torque_nm",
            TableColumn::Voltage => "voltage_line_rms_volt",
        }
    }

    /// The column that a file calls `name`.
    pub fn parse(name: &str) -> Option<TableColumn> {
        TableColumn::ALL
            .into_iter()
            .find(|column| column.name() == name)
    }

    /// What is wrong with a value, and the remedy.
    pub fn complaint(self, x: f64) -> Option<(&'static str, &'static str)> {
        let share = matches!(self, TableColumn::PowerFactor | TableColumn::Efficiency);
        if share && x > 1.0 {
            return Some(("is above 1", "write a share, 0.9 for 90 %"));
        }
        let positive = matches!(self, TableColumn::Current | TableColumn::Voltage);
        if x < 0.0 || (positive && x == 0.0) {
            return Some((
                "is not a motor's operating point",
                "remove the row; loads are positive",
            ));
        }
        None
    }
}

/// A load test of one motor, in the units of its column names.
///
/// Holds the line current and at least one of power, torque and speed, over at least two points.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadTable {
    name: String,
    points: usize,
    columns: BTreeMap<TableColumn, Vec<f64>>,
    /// What had to be assumed to read the file, one sentence each.
    pub assumptions: Vec<String>,
}

/// One operating point, completed as far as definitions reach (`P = T w`, `P = eta P1`,
/// `P1 = sqrt(3) U I cos phi`); `None` where they do not.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadPoint {
    /// Shaft power, W.
    pub power_watt: Option<f64>,
    /// Line current, A rms.
    pub current_rms_amp: Option<f64>,
    /// Shaft speed, rpm.
    pub speed_rpm: Option<f64>,
    /// Power factor, 0 to 1.
    pub power_factor: Option<f64>,
    /// Efficiency, 0 to 1.
    pub efficiency: Option<f64>,
    /// Shaft torque, N m.
    pub torque_nm: Option<f64>,
    /// Line-to-line voltage, V rms.
    pub voltage_line_rms_volt: Option<f64>,
    /// Electrical power taken from the supply, W.
    pub input_power_watt: Option<f64>,
}

impl LoadTable {
    /// A table from its columns.
    ///
    /// # Errors
    /// Columns that are too few, of unequal length, or hold impossible values; fewer than two points.
    pub fn new(name: &str, columns: BTreeMap<TableColumn, Vec<f64>>) -> Result<LoadTable, Error> {
        LoadTable::sufficient(name, columns.keys().copied())?;
        let points = columns.values().map(Vec::len).max().unwrap_or(0);
        if points < 2 {
            let message = format!("holds {points} operating point(s); at least 2 are needed");
            return Err(Error::bad(
                name,
                message,
                "measure several loads from no load to rated load",
            ));
        }
        for (column, values) in &columns {
            check(name, *column, values, points)?;
        }
        Ok(LoadTable {
            name: name.to_owned(),
            points,
            columns,
            assumptions: Vec::new(),
        })
    }

    /// Whether columns are enough to judge a motor by.
    ///
    /// # Errors
    /// No current, or nothing that says how the motor was loaded.
    pub fn sufficient(
        name: &str,
        columns: impl Iterator<Item = TableColumn> + Clone,
    ) -> Result<(), Error> {
        let has = |wanted: &[TableColumn]| columns.clone().any(|column| wanted.contains(&column));
        if !has(&[TableColumn::Current]) {
            let remedy = "add the line current, A rms";
            return Err(Error::at(
                name,
                1,
                "current_rms_amp",
                "the column is missing",
                remedy,
            ));
        }
        if !has(&[TableColumn::Power, TableColumn::Torque, TableColumn::Speed]) {
            let remedy = "add at least one of power_watt, torque_nm, speed_rpm";
            return Err(Error::at(
                name,
                1,
                "",
                "the table does not say how the motor was loaded",
                remedy,
            ));
        }
        Ok(())
    }

    /// The file, as the user named it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of operating points; at least 2.
    #[allow(clippy::len_without_is_empty)]
    pub fn len(&self) -> usize {
        self.points
    }

    /// A column in the unit of its name, if the file has it.
    pub fn column(&self, column: TableColumn) -> Option<&[f64]> {
        self.columns.get(&column).map(Vec::as_slice)
    }

    /// The operating points in the order of the file.
    pub fn points(&self) -> Vec<LoadPoint> {
        (0..self.points).map(|k| self.point(k)).collect()
    }

    fn point(&self, k: usize) -> LoadPoint {
        let at = |column| {
            self.column(column)
                .and_then(|values| values.get(k).copied())
        };
        LoadPoint {
            power_watt: at(TableColumn::Power),
            current_rms_amp: at(TableColumn::Current),
            speed_rpm: at(TableColumn::Speed),
            power_factor: at(TableColumn::PowerFactor),
            efficiency: at(TableColumn::Efficiency),
            torque_nm: at(TableColumn::Torque),
            voltage_line_rms_volt: at(TableColumn::Voltage),
            input_power_watt: None,
        }
        .completed()
    }
}

impl LoadPoint {
    fn completed(mut self) -> LoadPoint {
        let omega = self
            .speed_rpm
            .map(|rpm| rpm * TAU / 60.0)
            .filter(|omega| *omega > 0.0);
        let from_torque = self
            .torque_nm
            .zip(omega)
            .map(|(torque, omega)| torque * omega);
        self.power_watt = self.power_watt.or(from_torque);
        let from_power = self
            .power_watt
            .zip(omega)
            .map(|(power, omega)| power / omega);
        self.torque_nm = self.torque_nm.or(from_power);
        self.input_power_watt = self
            .electrical_power()
            .or_else(|| self.shaft_power_over_efficiency());
        let efficiency = self
            .power_watt
            .zip(self.input_power_watt)
            .map(|(p, p1)| p / p1);
        self.efficiency = self.efficiency.or(efficiency);
        self
    }

    fn electrical_power(&self) -> Option<f64> {
        let apparent = 3f64.sqrt() * self.voltage_line_rms_volt? * self.current_rms_amp?;
        Some(apparent * self.power_factor?)
    }

    fn shaft_power_over_efficiency(&self) -> Option<f64> {
        let efficiency = self.efficiency.filter(|efficiency| *efficiency > 0.0)?;
        Some(self.power_watt? / efficiency)
    }
}

fn check(name: &str, column: TableColumn, values: &[f64], points: usize) -> Result<(), Error> {
    let bad =
        |message: String, remedy: &str| Err(Error::at(name, 0, column.name(), message, remedy));
    if values.len() != points {
        let message = format!("{} values for {points} points", values.len());
        return bad(message, "give every column one value per point");
    }
    for (k, &x) in values.iter().enumerate() {
        if !x.is_finite() {
            return bad(
                format!("point {} is {x}", k + 1),
                "measure it again, or remove the point",
            );
        }
        if let Some((complaint, remedy)) = column.complaint(x) {
            return bad(format!("{x} at point {} {complaint}", k + 1), remedy);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(list: &[(TableColumn, &[f64])]) -> BTreeMap<TableColumn, Vec<f64>> {
        list.iter()
            .map(|(column, values)| (*column, values.to_vec()))
            .collect()
    }

    /// Rated point of the 18.5 kW motor: 18500 W at 1462 rpm, 32.85 A, 0.896, 90.44 %; 400 V line.
    #[test]
    fn a_point_is_completed_by_definitions_only() {
        let table = LoadTable::new(
            "x.csv",
            columns(&[
                (TableColumn::Power, &[0.0, 18500.0]),
                (TableColumn::Current, &[11.0, 32.85]),
                (TableColumn::Speed, &[1500.0, 1462.0]),
                (TableColumn::PowerFactor, &[0.085, 0.896]),
                (TableColumn::Efficiency, &[0.0, 0.9044]),
            ]),
        );
        let points = table.unwrap().points();
        let torque = points[1].torque_nm.unwrap();
        assert!((torque - 18500.0 / 153.1).abs() < 0.01, "{torque}");
        let input = points[1].input_power_watt.unwrap();
        assert!((input - 18500.0 / 0.9044).abs() < 1e-9);
        // sqrt(3) 400 V 32.85 A 0.896 = 20392 W: the table's own three figures agree within 0.4 %.
        assert!((input / 20392.0 - 1.0).abs() < 0.004);
        assert_eq!(points[0].input_power_watt, None);
        assert_eq!(points[0].torque_nm, Some(0.0));
    }

    #[test]
    fn torque_and_speed_stand_for_power() {
        let table = LoadTable::new(
            "x.csv",
            columns(&[
                (TableColumn::Current, &[1.0, 2.0]),
                (TableColumn::Torque, &[1.0, 2.0]),
                (TableColumn::Speed, &[1500.0, 1500.0]),
            ]),
        );
        let power = table.unwrap().points()[1].power_watt.unwrap();
        assert!((power - 2.0 * 50.0 * std::f64::consts::PI).abs() < 1e-9);
    }
}
