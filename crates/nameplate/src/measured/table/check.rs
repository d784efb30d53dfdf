//! What a row must have to be its test, and what no test shows.

use super::{Column, Row, Test};
use crate::plate::Completed;

/// What a test needs.
const NEEDED: [(Test, &[(Column, &str)]); 5] = [
    (
        Test::DcResistance,
        &[(Column::Resistance, "resistance_ohm")],
    ),
    (
        Test::NoLoad,
        &[
            (Column::Voltage, "voltage_volt"),
            (Column::Current, "current_amp"),
        ],
    ),
    (
        Test::LockedRotor,
        &[
            (Column::Voltage, "voltage_volt"),
            (Column::Current, "current_amp"),
        ],
    ),
    (
        Test::Load,
        &[
            (Column::Voltage, "voltage_volt"),
            (Column::Current, "current_amp"),
        ],
    ),
    (
        Test::CoastDown,
        &[(Column::Time, "time_s"), (Column::Speed, "speed_rpm")],
    ),
];
/// Currents and voltages over the rated ones that no standard test has.
const MOST_CURRENT: f64 = 15.0;
const MOST_VOLTAGE: f64 = 1.6;
/// Power factors below are no motor's; a power in kW that was written as watts has them.
const LEAST_POWER_FACTOR: f64 = 0.002;
/// Instruments may show a little more active than apparent power.
const MOST_POWER_FACTOR: f64 = 1.02;
/// A locked rotor's resistance is at least the winding's; a wattmeter on one phase shows a third.
const LEAST_COPPER: f64 = 0.9;

/// Refuses rows that cannot be their test.
///
/// # Errors
/// Table, line, column and the remedy.
pub(crate) fn check(rows: &[Row], plate: &Completed) -> Result<(), String> {
    if rows.is_empty() {
        return Err("no test: name a table with --tests; `drivemon motor tests --template` prints one to fill in".to_owned());
    }
    for row in rows {
        complete(row)?;
        plausible(row, plate)?;
        turning(row, plate)?;
        copper(row, rows)?;
    }
    coast_downs(rows)
}

fn wrong(row: &Row, column: &str, problem: &str) -> Result<(), String> {
    let test = row.test.name();
    Err(format!(
        "{}: {test}: column {column}: {problem}",
        row.place()
    ))
}

fn complete(row: &Row) -> Result<(), String> {
    let needed = NEEDED.iter().find(|needed| needed.0 == row.test);
    for &(column, name) in needed.map_or(&[][..], |needed| needed.1) {
        if row.get(column).is_none() {
            return wrong(row, name, "is empty; this test needs it");
        }
    }
    let tells = [
        Column::Power,
        Column::Speed,
        Column::Torque,
        Column::ShaftPower,
    ];
    if row.test == Test::Load && tells.iter().all(|&column| row.get(column).is_none()) {
        return wrong(
            row,
            "power_watt",
            "a load point needs power_watt, speed_rpm or torque_nm; more of them tell more",
        );
    }
    if row.get(Column::ShaftPower).is_some()
        && row.get(Column::Torque).is_none()
        && row.get(Column::Speed).is_none()
    {
        return wrong(
            row,
            "speed_rpm",
            "is empty; a shaft power needs it, or give torque_nm",
        );
    }
    Ok(())
}

fn plausible(row: &Row, plate: &Completed) -> Result<(), String> {
    let rated_volt = plate.voltage_volt;
    let rated_amp = plate.base_current_amp();
    if let Some(volt) = row
        .get(Column::Voltage)
        .filter(|volt| *volt > MOST_VOLTAGE * rated_volt)
    {
        let problem = format!(
            "{volt} V, the motor's voltage is {rated_volt} V; is it another unit, or another motor's row?"
        );
        return wrong(row, "voltage_volt", &problem);
    }
    if let Some(amp) = row
        .get(Column::Current)
        .filter(|amp| *amp > MOST_CURRENT * rated_amp)
    {
        let problem = format!(
            "{amp} A, rated is {rated_amp:.3} A; is it in mA, or voltage and current swapped?"
        );
        return wrong(row, "current_amp", &problem);
    }
    let (Some(volt), Some(amp), Some(watt)) = (
        row.get(Column::Voltage),
        row.get(Column::Current),
        row.get(Column::Power),
    ) else {
        return Ok(());
    };
    let factor = watt / (3f64.sqrt() * volt * amp);
    if factor > MOST_POWER_FACTOR {
        let problem = format!(
            "{watt} W is {factor:.3} of sqrt(3) U I = {:.1} VA; is it W in a column of kW, is the voltage that of a phase, or are \
             voltage and current swapped?",
            watt / factor
        );
        return wrong(row, "power_watt", &problem);
    }
    if factor < LEAST_POWER_FACTOR {
        let problem = format!(
            "{watt} W is a power factor of {factor:.5}; is it kW? name the column power_kw"
        );
        return wrong(row, "power_watt", &problem);
    }
    Ok(())
}

fn turning(row: &Row, plate: &Completed) -> Result<(), String> {
    let frequency = row.get(Column::Frequency).unwrap_or(plate.frequency_hz);
    let synchronous = 60.0 * frequency / f64::from(plate.pole_pairs);
    let Some(rpm) = row.get(Column::Speed) else {
        return Ok(());
    };
    match row.test {
        Test::LockedRotor if rpm > 0.0 => wrong(
            row,
            "speed_rpm",
            &format!("{rpm} rpm with a locked rotor; hold the rotor, or write it as load"),
        ),
        Test::Load if rpm >= synchronous => wrong(
            row,
            "speed_rpm",
            &format!(
                "{rpm} rpm is not below the synchronous speed {synchronous} rpm; is it another frequency (frequency_hz)?"
            ),
        ),
        Test::Load if rpm < 0.3 * synchronous => wrong(
            row,
            "speed_rpm",
            &format!("{rpm} rpm of {synchronous} rpm is no load point; is it in 1/s or rad/s?"),
        ),
        Test::CoastDown if rpm > 1.2 * synchronous => wrong(
            row,
            "speed_rpm",
            &format!("{rpm} rpm, synchronous speed is {synchronous} rpm"),
        ),
        _ => Ok(()),
    }
}

/// The power of one phase instead of three.
fn copper(row: &Row, rows: &[Row]) -> Result<(), String> {
    let resistances: Vec<f64> = rows
        .iter()
        .filter_map(|other| other.get(Column::Resistance))
        .collect();
    let (Some(watt), Some(amp)) = (row.get(Column::Power), row.get(Column::Current)) else {
        return Ok(());
    };
    if row.test == Test::DcResistance || resistances.is_empty() {
        return Ok(());
    }
    let terminals = resistances.iter().sum::<f64>() / resistances.len() as f64;
    let lost = 1.5 * amp * amp * terminals;
    match watt < LEAST_COPPER * lost {
        true => wrong(
            row,
            "power_watt",
            &format!(
                "{watt} W is less than the windings lose alone, {lost:.1} W by the dc-resistance rows; is it the power of one phase? write \
                 that of all three. Is resistance_ohm between two terminals?"
            ),
        ),
        false => Ok(()),
    }
}

fn coast_downs(rows: &[Row]) -> Result<(), String> {
    let run: Vec<&Row> = rows
        .iter()
        .filter(|row| row.test == Test::CoastDown)
        .collect();
    for pair in run.windows(2) {
        let time = |row: &Row| row.get(Column::Time).unwrap_or(0.0);
        let speed = |row: &Row| row.get(Column::Speed).unwrap_or(0.0);
        if time(pair[1]) > time(pair[0]) && speed(pair[1]) > speed(pair[0]) {
            return wrong(
                pair[1],
                "speed_rpm",
                "is above the row before; a motor that runs out slows down. Sort the rows by time_s",
            );
        }
    }
    let slow = |row: &&&Row| row.get(Column::Speed).is_some_and(|rpm| rpm <= 0.0);
    if let Some(row) = run.iter().find(slow) {
        return wrong(
            row,
            "speed_rpm",
            "is 0; leave out what comes after standstill",
        );
    }
    match run.as_slice() {
        [only] => wrong(
            only,
            "time_s",
            "one row is no coast-down; give at least two, better eight",
        ),
        _ => Ok(()),
    }
}
