//! Tests that were not done, as the motor so far believed would show them: what they would tell.

use super::{KELVINS, Own, Point, Reading};
use crate::measured::instruments::{Instruments, deviation, share};
use crate::measured::point::made::{laws, radians};
use crate::measured::table::{Column, Test};
use crate::measured::unknowns::Machine;

/// Air-gap voltages of a no-load test with several voltages.
const VOLTAGES: [f64; 6] = [1.05, 0.97, 0.8, 0.6, 0.4, 0.25];
/// Frequencies of a locked-rotor test, over rated (IEEE 112, 5.9: 25 %).
const FREQUENCIES: [f64; 2] = [1.0, 0.25];
/// Slips of a load test, over rated.
const LOADS: [f64; 5] = [0.25, 0.5, 0.75, 1.0, 1.25];
/// Share of the speed that a coast-down loses.
const READINGS: usize = 8;

/// The points of a whole test, with the temperature measured.
pub(in crate::measured) fn planned(
    test: Test,
    machine: &Machine,
    instruments: &Instruments,
) -> Vec<Point> {
    let slip = 1.0 - machine.rated_speed;
    let flux = machine.rated_flux;
    let point = |nu: f64, own: usize, start: Own| {
        filled(
            Point {
                test,
                rows: Vec::new(),
                nu,
                tan_phi: 1.0,
                times: Vec::new(),
                readings: Vec::new(),
                own,
                start,
            },
            machine,
            instruments,
        )
    };
    match test {
        Test::DcResistance => vec![point(1.0, 1, [0.2, 0.0, 0.0])],
        Test::NoLoad => VOLTAGES.map(|e| point(1.0, 2, [e, 0.4, 0.0])).to_vec(),
        Test::LockedRotor => FREQUENCIES.map(|nu| point(nu, 2, [1.0, 0.4, 0.0])).to_vec(),
        Test::Load => LOADS
            .map(|share| point(1.0, 3, [flux, share * slip, 0.8]))
            .to_vec(),
        Test::CoastDown => vec![coast_down(
            point(1.0, 1, [1.0, 0.0, 0.0]),
            machine,
            instruments,
        )],
    }
}

fn columns(test: Test) -> &'static [Column] {
    match test {
        Test::DcResistance => &[Column::Resistance, Column::Temperature],
        Test::Load => &[
            Column::Voltage,
            Column::Current,
            Column::Power,
            Column::Speed,
            Column::Torque,
            Column::Temperature,
        ],
        Test::NoLoad | Test::LockedRotor => &[
            Column::Voltage,
            Column::Current,
            Column::Power,
            Column::Temperature,
        ],
        Test::CoastDown => &[],
    }
}

fn filled(mut point: Point, machine: &Machine, i: &Instruments) -> Point {
    let limit = |column: Column| match column {
        Column::Speed => deviation(radians(i.speed_rpm)) / machine.base.rad_s,
        Column::Temperature => deviation(i.temperature_kelvin) / KELVINS,
        Column::Resistance => share(i.resistance_percent),
        Column::Torque => share(i.torque_percent),
        Column::Power => share(i.power_percent),
        Column::Current => share(i.current_percent),
        _ => share(i.voltage_percent),
    };
    let law = |column: Column| match column {
        Column::Speed | Column::Temperature => 0.0,
        _ => laws(point.test),
    };
    point.readings = columns(point.test)
        .iter()
        .map(|&column| Reading {
            column,
            measured: 0.0,
            value: 0.0,
            deviation: limit(column).hypot(law(column)),
        })
        .collect();
    with_power_error(meets(point, machine), i)
}

fn coast_down(mut point: Point, machine: &Machine, i: &Instruments) -> Point {
    let loss = machine.friction(1.0) * machine.base.nm;
    let rated = machine.rated_speed * machine.base.rad_s;
    let whole = machine
        .get(crate::measured::unknowns::Unknown::Inertia)
        .exp()
        * rated
        / loss;
    point.times = (0..READINGS).map(|k| 0.1 * whole * k as f64).collect();
    point.readings = vec![
        Reading {
            column: Column::Speed,
            measured: 0.0,
            value: 0.0,
            deviation: deviation(radians(i.speed_rpm) / rated).hypot(laws(Test::CoastDown)),
        };
        READINGS
    ];
    meets(point, machine)
}

/// Reads what the motor would show.
fn meets(mut point: Point, machine: &Machine) -> Point {
    let shown = point.predicted(machine, &point.start);
    for (reading, value) in point.readings.iter_mut().zip(shown) {
        reading.value = value;
    }
    point
}

/// A wattmeter's error is a share of the apparent power.
fn with_power_error(mut point: Point, i: &Instruments) -> Point {
    let value = |column: Column| {
        let found = point
            .readings
            .iter()
            .find(|reading| reading.column == column);
        found.map(|reading| reading.value)
    };
    let (Some(volt), Some(amp), Some(watt)) = (
        value(Column::Voltage),
        value(Column::Current),
        value(Column::Power),
    ) else {
        return point;
    };
    let apparent_over_active = 3f64.sqrt() * (volt + amp - watt).exp();
    point.tan_phi = (apparent_over_active * apparent_over_active - 1.0)
        .max(0.0)
        .sqrt();
    for reading in point
        .readings
        .iter_mut()
        .filter(|reading| reading.column == Column::Power)
    {
        reading.deviation = (share(i.power_percent) * apparent_over_active).hypot(laws(point.test));
    }
    point
}
