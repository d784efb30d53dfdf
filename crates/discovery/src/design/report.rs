//! A designed run as a report shows it: what it decides, how surely, and what to do.

use super::goal::{DECISIVE, Goal, Verdict};
use super::plan::{Level, Plan, SWITCH_ON};
use super::search::Design;
use motor::MotorFile;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// Gain, in those that proofs ask for, from which a run decides surely.
const SURE: f64 = 2.0;
/// Share of a standard error that goes where a run narrows it surely, and where it does likely.
const NARROWS: [f64; 2] = [0.5, 0.2];

/// The next experiment.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema, Deserialize)]
pub struct DesignReport {
    /// What it is to do.
    pub goal: DesignGoal,
    /// What it decides, in a sentence.
    pub summary: String,
    /// What it decides, question by question.
    pub decides: Vec<DecidesReport>,
    /// The best of the runs that a person would try first.
    pub best_standard_run: String,
    /// That one.
    pub standard_run: RunReport,
    /// What that one would decide.
    pub standard_decides: Vec<DecidesReport>,
    /// What to do, step by step.
    pub instructions: Vec<String>,
    /// The run as a scenario file, for `drivemon simulate`.
    pub scenario: String,
    /// The run.
    pub run: RunReport,
}

/// What a run is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DesignGoal {
    /// Tell explanations apart.
    TellApart,
    /// Show effects that the recordings could not show.
    Show,
    /// Narrow parameters.
    Narrow,
}

/// How surely a run decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Certainty {
    /// It gains twice what a proof asks for; of a standard error more than half goes.
    Sure,
    /// It gains what a proof asks for; of a standard error more than a fifth goes.
    Likely,
    /// It gains less.
    Unlikely,
}

impl Certainty {
    /// As a person reads it.
    pub fn word(self) -> &'static str {
        match self {
            Certainty::Sure => "sure",
            Certainty::Likely => "likely",
            Certainty::Unlikely => "unlikely",
        }
    }

    fn of(goal: &Goal, gain: f64) -> Self {
        let [sure, likely] = match goal {
            Goal::Narrow(..) => NARROWS,
            Goal::Tell(_) | Goal::Show(..) => [SURE * DECISIVE, DECISIVE],
        };
        match gain {
            gain if gain > sure => Certainty::Sure,
            gain if gain > likely => Certainty::Likely,
            _ => Certainty::Unlikely,
        }
    }
}

/// A run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema, Deserialize)]
pub struct RunReport {
    /// Length, s.
    pub duration_s: f64,
    /// Whether it begins at standstill; otherwise with the motor running at the first level.
    pub starts: bool,
    /// When the motor is switched on, s.
    pub switch_on_s: f64,
    /// When the supply is switched off and the motor coasts, s.
    pub switch_off_s: Option<f64>,
    /// What holds, one after the other.
    pub levels: Vec<LevelReport>,
}

/// What holds from an instant on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema, Deserialize)]
pub struct LevelReport {
    /// Beginning, s.
    pub at_s: f64,
    /// Time in which voltage and frequency get there, s; 0: at once.
    pub ramp_s: f64,
    /// Load, percent of rated torque.
    pub load_percent: f64,
    /// Voltage, percent of rated.
    pub voltage_percent: f64,
    /// Supply frequency, Hz.
    pub frequency_hz: f64,
}

impl RunReport {
    fn of(plan: &Plan) -> Self {
        let level = |level: &Level| LevelReport {
            at_s: level.at_s,
            ramp_s: level.ramp_s,
            load_percent: 100.0 * level.load,
            voltage_percent: 100.0 * level.voltage,
            frequency_hz: level.frequency_hz,
        };
        Self {
            duration_s: plan.duration_s,
            starts: plan.starts,
            switch_on_s: if plan.starts { SWITCH_ON } else { 0.0 },
            switch_off_s: plan.off_s,
            levels: plan.levels.iter().map(level).collect(),
        }
    }
}

/// One question that a run decides.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema, Deserialize)]
pub struct DecidesReport {
    /// The explanation that is found wrong, the effect that is shown, or the parameter.
    pub what: String,
    /// By so much the error of the wrong explanation is larger, percent; of a parameter: so much of its standard error goes.
    pub gain_percent: f64,
    /// How surely.
    pub how_surely: Certainty,
}

/// The report of a design for this motor; `file` is the motor file as the scenario names it.
pub(crate) fn design_report(design: &Design, motor: &MotorFile, file: &str) -> DesignReport {
    let decides = told(&design.goal, &design.verdict);
    DesignReport {
        goal: match design.goal {
            Goal::Tell(_) => DesignGoal::TellApart,
            Goal::Show(..) => DesignGoal::Show,
            Goal::Narrow(..) => DesignGoal::Narrow,
        },
        summary: summary(&design.goal, &decides),
        best_standard_run: design.standard.0.to_owned(),
        standard_decides: told(&design.goal, &design.standard.2),
        standard_run: RunReport::of(&design.standard.1),
        instructions: instructions(&design.plan, motor, design.recordings),
        scenario: scenario(&design.plan, motor, file),
        run: RunReport::of(&design.plan),
        decides,
    }
}

fn told(goal: &Goal, verdict: &Verdict) -> Vec<DecidesReport> {
    let one = |(what, gain): &(String, f64)| DecidesReport {
        what: what.clone(),
        gain_percent: 100.0 * gain,
        how_surely: Certainty::of(goal, *gain),
    };
    verdict.gains.iter().map(one).collect()
}

fn summary(goal: &Goal, decides: &[DecidesReport]) -> String {
    let (verb, all): (&str, Vec<&str>) = match goal {
        Goal::Tell(all) => ("tells apart", all.iter().map(|c| c.name.as_str()).collect()),
        Goal::Show(_, all) => ("shows, present or not:", first_names(all)),
        Goal::Narrow(_, all) => ("narrows", first_names(all)),
    };
    let is_decided = |d: &&DecidesReport| d.how_surely != Certainty::Unlikely;
    let (decided, open): (Vec<_>, Vec<_>) = decides.iter().partition(is_decided);
    let names =
        |of: &[&DecidesReport]| listed(&of.iter().map(|d| d.what.as_str()).collect::<Vec<_>>());
    if decided.is_empty() {
        let all = listed(&all);
        return format!(
            "No run within these limits {verb} {all}. Allow more loads, voltages or speeds."
        );
    }
    let surely = match decided.iter().all(|d| d.how_surely == Certainty::Sure) {
        true => "surely",
        false => "probably",
    };
    if open.is_empty() {
        return format!("This run {verb} {}, {surely}.", listed(&all));
    }
    let verb = if matches!(goal, Goal::Tell(_)) {
        "tells"
    } else {
        verb
    };
    format!(
        "This run {verb} {}, {surely}. Not: {}.",
        names(&decided),
        names(&open)
    )
}

fn first_names<T>(all: &[(String, T)]) -> Vec<&str> {
    all.iter().map(|(name, _)| name.as_str()).collect()
}

/// Names as a sentence lists them.
fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

/// What a technician does.
fn instructions(plan: &Plan, motor: &MotorFile, recordings: usize) -> Vec<String> {
    let mut all = vec![format!(
        "Record {:.1} s with the instruments of the other recordings: three voltages, three currents, speed and torque where it is measured.",
        plan.duration_s
    )];
    let torque = |level: &Level| {
        let nm = level.load * motor.nameplate.torque_nm;
        format!("load {:.0} % of rated ({nm:.1} N m)", 100.0 * level.load)
    };
    let supply = |level: &Level| match plan.drive {
        true => format!(
            "{:.1} Hz at {:.0} % of rated voltage",
            level.frequency_hz,
            100.0 * level.voltage
        ),
        false => format!(
            "{:.0} % of rated voltage ({:.0} V between lines)",
            100.0 * level.voltage,
            level.voltage * motor.nameplate.voltage_line_rms_volt
        ),
    };
    for (k, level) in plan.levels.iter().enumerate() {
        let (load, supply) = (torque(level), supply(level));
        let at = level.at_s;
        let within = match level.ramp_s > 0.0 {
            true => format!(" within {:.1} s", level.ramp_s),
            false => String::new(),
        };
        all.push(match (k, plan.starts) {
            (0, true) => format!("{SWITCH_ON:.2} s: switch on, {supply}, {load}."),
            (0, false) => format!("Begin with the motor running: {supply}, {load}."),
            _ => format!("{at:.1} s: {supply}{within}, {load}."),
        });
    }
    if let Some(off) = plan.off_s {
        all.push(format!(
            "{off:.1} s: switch the supply off and the load to nothing; record while the motor coasts."
        ));
    }
    let again = match recordings {
        1 => {
            "Ask again with both recordings, the new one first: it is fitted, the other one proves."
        }
        _ => {
            "Ask again with all recordings, the new one as the third: the first and the third are fitted, the second proves."
        }
    };
    all.push(again.to_owned());
    all
}

/// The run as a scenario file.
fn scenario(plan: &Plan, motor: &MotorFile, file: &str) -> String {
    let mut text = String::new();
    let first = &plan.levels[0];
    let rated = motor.nameplate.voltage_line_rms_volt;
    let _ = writeln!(text, "name = \"The next experiment\"\nmotor = {file:?}");
    let _ = writeln!(text, "duration_s = {:.3}", plan.duration_s);
    if !plan.starts {
        let _ = writeln!(text, "start = \"running\"");
    }
    let _ = writeln!(text, "\n[supply]\nvoltage_line_rms_volt = {rated}");
    let _ = writeln!(text, "frequency_hz = {:.3}", first.frequency_hz);
    if plan.starts {
        let _ = writeln!(text, "switch_on_s = {SWITCH_ON}");
    }
    if let Some(off) = plan.off_s {
        let _ = writeln!(text, "switch_off_s = {off:.3}");
    }
    for level in &plan.levels {
        if level.at_s == 0.0 && level.voltage == 1.0 {
            continue;
        }
        let _ = writeln!(
            text,
            "[[supply.steps]]\nat_s = {:.3}\nramp_s = {:.3}\nvoltage_percent = {:.3}\nfrequency_hz = {:.3}",
            level.at_s,
            level.ramp_s,
            100.0 * level.voltage,
            level.frequency_hz
        );
    }
    let point = |level: &Level| {
        format!(
            "    {{ at_s = {:.3}, torque_percent = {:.3} }},\n",
            level.at_s,
            100.0 * level.load
        )
    };
    let mut points: String = plan.levels.iter().map(point).collect();
    if let Some(off) = plan.off_s {
        let _ = writeln!(points, "    {{ at_s = {off:.3}, torque_percent = 0.0 }},");
    }
    let _ = writeln!(text, "\n[load]\nprofile = [\n{points}]");
    text
}
