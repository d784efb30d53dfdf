//! What the tests told, for the terminal and as JSON.

use std::path::Path;

use nameplate::measured::table::{Column, Row, Test};
use nameplate::measured::{Culprit, Doubt, Help, NAMES, Step, Tested, What};
use nameplate::plate::Value;
use nameplate::{Estimate, Interval};
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

/// What the standard tests tell of the motor.
#[derive(Debug, Serialize, JsonSchema)]
pub struct TestsJson {
    /// The motor file that was written.
    pub motor_file: String,
    /// What was known after each test.
    pub steps: Vec<StepJson>,
    /// What contradicts each other.
    pub contradictions: Vec<ContradictionJson>,
    /// What a reader should know of the tests.
    pub notes: Vec<String>,
    /// Parameters that are still wide, and what would narrow them.
    pub still_wide: Vec<HelpJson>,
}

impl Answer for TestsJson {
    const FORMAT: &'static str = "motor-tests/1";
}

/// What was known after a test.
#[derive(Debug, Serialize, JsonSchema)]
pub struct StepJson {
    /// `plate`, then the tests.
    pub after: &'static str,
    /// Rows of the test.
    pub rows: usize,
    /// Parameters with their intervals.
    pub parameters: Vec<ParameterJson>,
}

/// A parameter with its interval.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ParameterJson {
    /// Its name, with the unit.
    pub name: &'static str,
    /// Its interval.
    #[serde(flatten)]
    pub interval: Interval,
}

/// A test that contradicts the others.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ContradictionJson {
    /// The test, or `plate`.
    pub test: &'static str,
    /// Table and lines, as `tests.csv:7`.
    pub places: Vec<String>,
    /// Chi-square against what all others say.
    pub chi_square: Option<f64>,
    /// Its degrees of freedom.
    pub degrees_of_freedom: Option<usize>,
    /// What one row in 10 000 exceeds by chance.
    pub limit: Option<f64>,
    /// The same in words.
    pub message: String,
}

/// A parameter that is still wide.
#[derive(Debug, Serialize, JsonSchema)]
pub struct HelpJson {
    /// The parameter.
    pub parameter: &'static str,
    /// Ends of its interval over each other, as it is now.
    pub factor_now: f64,
    /// The test that would narrow it most; `null` where no test would.
    pub test: Option<&'static str>,
    /// Ends of its interval over each other after that test.
    pub factor_then: Option<f64>,
    /// The test was done: once more averages its scatter.
    pub again: bool,
    /// How the test is done.
    #[serde(skip)]
    pub how: &'static str,
}

impl TestsJson {
    pub fn of(out: &Path, estimate: &Estimate, tested: &Tested, rows: &[Row]) -> TestsJson {
        let of_plate = estimate
            .contradictions
            .iter()
            .map(|contradiction| ContradictionJson {
                test: "plate",
                places: Vec::new(),
                chi_square: None,
                degrees_of_freedom: None,
                limit: None,
                message: contradiction.to_string(),
            });
        TestsJson {
            motor_file: out.display().to_string(),
            steps: tested
                .steps
                .iter()
                .map(|step| of_step(step, tested))
                .collect(),
            contradictions: of_plate
                .chain(tested.doubts.iter().map(|doubt| of_doubt(doubt, rows)))
                .collect(),
            notes: notes(tested),
            still_wide: tested
                .helps
                .iter()
                .map(|help| of_help(help, tested))
                .collect(),
        }
    }
}

fn of_step(step: &Step, tested: &Tested) -> StepJson {
    let shown = (0..NAMES.len()).filter(|&k| tested.form.has(k));
    StepJson {
        after: step.test.map_or("plate", Test::name),
        rows: step.rows,
        parameters: shown
            .map(|k| ParameterJson {
                name: NAMES[k],
                interval: step.parameters[k],
            })
            .collect(),
    }
}

fn of_doubt(doubt: &Doubt, rows: &[Row]) -> ContradictionJson {
    let (test, places, lead) = match &doubt.what {
        What::Rows(test, numbers) => {
            let all = numbers.iter().filter_map(|&k| rows.get(k));
            let places: Vec<String> = all.map(Row::place).collect();
            (
                test.name(),
                places,
                format!("{} does not go with plate and other tests", test.name()),
            )
        }
        What::Plate(value) => {
            let lead = format!(
                "{} does not go with the tests, beyond the tolerances of IEC 60034-1",
                plate_value(*value)
            );
            ("plate", Vec::new(), lead)
        }
    };
    let settled = doubt
        .culprit
        .as_ref()
        .map_or(String::new(), |culprit| format!("; {}", would_fit(culprit)));
    ContradictionJson {
        test,
        places,
        chi_square: Some(doubt.chi_square),
        degrees_of_freedom: Some(doubt.freedom),
        limit: Some(doubt.limit),
        message: format!(
            "{lead} (chi-square {:.0}, by chance at most {:.0}){settled}",
            doubt.chi_square, doubt.limit
        ),
    }
}

fn plate_value(value: usize) -> &'static str {
    const NAMES: [(Value, &str); 6] = [
        (Value::Slip, "the plate's speed"),
        (Value::Loss, "the plate's efficiency"),
        (Value::TanPhi, "the plate's power factor"),
        (Value::Breakdown, "the plate's breakdown torque"),
        (Value::LockedRotorTorque, "the plate's locked-rotor torque"),
        (
            Value::LockedRotorCurrent,
            "the plate's locked-rotor current",
        ),
    ];
    let found = NAMES.iter().find(|name| name.0 as usize == value);
    found.map_or("the plate", |name| name.1)
}

fn would_fit(culprit: &Culprit) -> String {
    let (name, unit) = match culprit.column {
        Column::Voltage => ("voltage_volt", "V"),
        Column::Frequency => ("frequency_hz", "Hz"),
        Column::Current => ("current_amp", "A"),
        Column::Power => ("power_watt", "W"),
        Column::Speed => ("speed_rpm", "rpm"),
        Column::Torque | Column::ShaftPower => ("torque_nm", "N m"),
        Column::Temperature => ("temperature_degc", "degC"),
        Column::Resistance => ("resistance_ohm", "ohm"),
        Column::Time => ("time_s", "s"),
    };
    let digits = super::print::short;
    format!(
        "if one reading is wrong it is {name}, {}: {} {unit} would fit",
        digits(culprit.measured),
        digits(culprit.fits)
    )
}

fn notes(tested: &Tested) -> Vec<String> {
    let mut notes = Vec::new();
    let done = |test: Test| tested.steps.iter().any(|step| step.test == Some(test));
    if tested.one_voltage {
        notes.push(
            "no-load at one voltage: core loss and friction cannot be told apart, and saturation is as the prior has it; rows at lower \
             voltages, down to a quarter, tell them"
                .to_owned(),
        );
    }
    if tested.one_frequency {
        notes.push(
            "locked rotor at one frequency: the rotor's resistance in running cannot be told from its skin effect; a row at a quarter of \
             the rated frequency tells it"
                .to_owned(),
        );
    }
    if done(Test::CoastDown) && (!done(Test::NoLoad) || tested.one_voltage) {
        notes.push(
            "a coast-down tells inertia over friction: the inertia is as uncertain as the friction, which no-load rows at several voltages \
             tell"
                .to_owned(),
        );
    }
    notes
}

fn of_help(help: &Help, tested: &Tested) -> HelpJson {
    let whole_already = |test: Test| {
        let part = match test {
            Test::NoLoad => tested.one_voltage,
            Test::LockedRotor => tested.one_frequency,
            _ => false,
        };
        !part && tested.steps.iter().any(|step| step.test == Some(test))
    };
    HelpJson {
        again: help.test.is_some_and(|(test, _)| whole_already(test)),
        parameter: help.parameter,
        factor_now: help.factor_now,
        test: help.test.map(|(test, _)| test.name()),
        factor_then: help.test.map(|(_, factor)| factor),
        how: help.test.map_or("", |(test, _)| whole(test)),
    }
}

/// What a whole test is.
fn whole(test: Test) -> &'static str {
    match test {
        Test::DcResistance => "the resistance between the terminals (dc-resistance)",
        Test::NoLoad => "no-load at six voltages from 110 to 25 %",
        Test::LockedRotor => "locked rotor at rated frequency and a quarter of it",
        Test::Load => "load at 25 to 125 % with torque and speed",
        Test::CoastDown => "a coast-down from no load",
    }
}
