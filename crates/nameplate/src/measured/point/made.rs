//! Test points from the rows of a table.

use super::{KELVINS, Own, Point, Reading};
use crate::measured::instruments::{Instruments, deviation, share};
use crate::measured::table::{Column, Row, Test};
use crate::measured::unknowns::Machine;

/// Temperatures of a winding that nobody measured, degC, and how far off they may be, K.
const NOT_MEASURED: [(Test, f64, f64); 4] = [
    (Test::DcResistance, 20.0, 5.0),
    (Test::NoLoad, 45.0, 20.0),
    (Test::LockedRotor, 40.0, 20.0),
    (Test::Load, 75.0, 25.0),
];
/// What supply, position and the circuit's own laws may add to a reading, as a share: saturation is no exact power, a bar is no
/// pair of cages. Motors with other laws (`tests/measured`) set their size.
pub(super) const fn laws(test: Test) -> f64 {
    match test {
        Test::DcResistance => 0.0,
        Test::NoLoad => 0.004,
        Test::LockedRotor => 0.01,
        Test::Load => 0.003,
        Test::CoastDown => 0.001,
    }
}

/// The points of a table's rows; `machine` is the motor of the plate.
pub(in crate::measured) fn points(
    rows: &[Row],
    instruments: &Instruments,
    machine: &Machine,
) -> Vec<Point> {
    let maker = Maker {
        instruments,
        machine,
    };
    let mut points: Vec<Point> = Vec::new();
    let mut run: Vec<usize> = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        if row.test != Test::CoastDown {
            points.push(maker.point(row, k));
            continue;
        }
        // Time going back begins another run.
        let before = run.last().and_then(|&last| rows[last].get(Column::Time));
        if before.is_some_and(|before| row.get(Column::Time).is_some_and(|now| now <= before)) {
            points.push(maker.coast_down(rows, &run));
            run.clear();
        }
        run.push(k);
    }
    if !run.is_empty() {
        points.push(maker.coast_down(rows, &run));
    }
    points
}

struct Maker<'m> {
    instruments: &'m Instruments,
    machine: &'m Machine,
}

impl Maker<'_> {
    fn point(&self, row: &Row, number: usize) -> Point {
        let machine = self.machine;
        let rated = machine.completed.frequency_hz;
        let nu = row.get(Column::Frequency).unwrap_or(rated) / rated;
        let apparent = 3f64.sqrt()
            * row.get(Column::Voltage).unwrap_or(0.0)
            * row.get(Column::Current).unwrap_or(0.0);
        let active = row
            .get(Column::Power)
            .unwrap_or(apparent)
            .clamp(1e-3 * apparent, apparent);
        let mut readings = Vec::new();
        for column in [
            Column::Resistance,
            Column::Voltage,
            Column::Current,
            Column::Power,
            Column::Speed,
            Column::Torque,
        ] {
            let measured = match (
                column,
                row.get(column),
                row.get(Column::ShaftPower),
                row.get(Column::Speed),
            ) {
                (Column::Torque, None, Some(power), Some(speed)) => Some(power / radians(speed)),
                (_, measured, _, _) => measured,
            };
            let Some(measured) = measured.filter(|_| is_read(row.test, column)) else {
                continue;
            };
            readings.push(self.reading(
                row.test,
                column,
                measured,
                nu,
                apparent / active.max(1e-12),
            ));
        }
        let (temperature, reading) = self.temperature(row);
        readings.push(reading);
        let (own, start) = self.start(row, nu, temperature);
        Point {
            test: row.test,
            rows: vec![number],
            nu,
            tan_phi: (apparent * apparent - active * active).max(0.0).sqrt() / active.max(1e-12),
            times: Vec::new(),
            readings,
            own,
            start,
        }
    }

    fn reading(
        &self,
        test: Test,
        column: Column,
        measured: f64,
        nu: f64,
        apparent_over_active: f64,
    ) -> Reading {
        let i = self.instruments;
        let (value, limit) = match column {
            Column::Speed => {
                let synchronous = nu * self.machine.base.rad_s;
                let slip = 1.0 - radians(measured) / synchronous;
                return Reading {
                    column,
                    measured,
                    value: slip,
                    deviation: deviation(radians(i.speed_rpm)) / synchronous,
                };
            }
            Column::Resistance => (measured.ln(), share(i.resistance_percent)),
            Column::Voltage => (measured.ln(), share(i.voltage_percent)),
            Column::Current => (measured.ln(), share(i.current_percent)),
            Column::Power => (measured.ln(), share(i.power_percent) * apparent_over_active),
            _ => (measured.ln(), share(i.torque_percent)),
        };
        Reading {
            column,
            measured,
            value,
            deviation: limit.hypot(laws(test)),
        }
    }

    /// The winding's temperature in hundreds of degC, measured or usual in the test.
    fn temperature(&self, row: &Row) -> (f64, Reading) {
        let usual = NOT_MEASURED.iter().find(|usual| usual.0 == row.test);
        let (degc, kelvins) = match (row.get(Column::Temperature), usual) {
            (Some(measured), _) => (measured, deviation(self.instruments.temperature_kelvin)),
            (None, Some(&(_, degc, kelvins))) => (degc, kelvins),
            (None, None) => (20.0, 20.0),
        };
        let reading = Reading {
            column: Column::Temperature,
            measured: degc,
            value: degc / KELVINS,
            deviation: kelvins / KELVINS,
        };
        (reading.value, reading)
    }

    /// How many unknowns of its own a point has, and where they are about.
    fn start(&self, row: &Row, nu: f64, temperature: f64) -> (usize, Own) {
        let base = &self.machine.base;
        let voltage = row.get(Column::Voltage).unwrap_or(base.volt) / base.volt;
        let current = row.get(Column::Current).unwrap_or(base.amp) / base.amp;
        let rated_slip = 1.0 - self.machine.rated_speed;
        match row.test {
            Test::DcResistance => (1, [temperature, 0.0, 0.0]),
            Test::NoLoad => (2, [0.97 * voltage, temperature, 0.0]),
            Test::LockedRotor => (2, [current, temperature, 0.0]),
            Test::Load | Test::CoastDown => {
                let speed = row
                    .get(Column::Speed)
                    .map(|rpm| 1.0 - radians(rpm) / (nu * base.rad_s));
                let by_power = row
                    .get(Column::Power)
                    .map(|watt| rated_slip * watt / base.watt);
                let slip = speed.or(by_power).unwrap_or(rated_slip).clamp(1e-4, 0.9);
                (3, [0.94 * voltage, slip, temperature])
            }
        }
    }

    fn coast_down(&self, rows: &[Row], run: &[usize]) -> Point {
        let rated = self.machine.rated_speed * self.machine.base.rad_s;
        let time = |k: &usize| rows[*k].get(Column::Time).unwrap_or(0.0);
        let first = run.first().map_or(0.0, time);
        let reading = |k: &usize| {
            let measured = rows[*k].get(Column::Speed).unwrap_or(0.0);
            let value = radians(measured) / rated;
            Reading {
                column: Column::Speed,
                measured,
                value,
                deviation: deviation(radians(self.instruments.speed_rpm) / rated)
                    .hypot(laws(Test::CoastDown) * value),
            }
        };
        let readings: Vec<Reading> = run.iter().map(reading).collect();
        Point {
            test: Test::CoastDown,
            rows: run.to_vec(),
            nu: 1.0,
            tan_phi: 0.0,
            times: run.iter().map(|k| time(k) - first).collect(),
            own: 1,
            start: [readings.first().map_or(1.0, |r| r.value), 0.0, 0.0],
            readings,
        }
    }
}

/// Whether a test uses a column.
fn is_read(test: Test, column: Column) -> bool {
    match test {
        Test::DcResistance => column == Column::Resistance,
        Test::NoLoad => matches!(column, Column::Voltage | Column::Current | Column::Power),
        Test::LockedRotor => matches!(
            column,
            Column::Voltage | Column::Current | Column::Power | Column::Torque
        ),
        Test::Load => column != Column::Resistance,
        Test::CoastDown => false,
    }
}

/// rad/s of rpm.
pub(in crate::measured) fn radians(rpm: f64) -> f64 {
    rpm * std::f64::consts::TAU / 60.0
}
