//! MATLAB and Octave: one function file that gives a struct of function handles.

use super::infix::{Syntax, statements};
use super::page::{each, filled, harmless, names, numbers, results};
use super::{File, Job};
use crate::algebra::{Function, Table, TableOf};
use crate::model::{HELD, Model, Quantity, STEP_S};

struct Matlab;

impl Syntax for Matlab {
    fn parameter(&self, name: &str) -> String {
        format!("p.{name}")
    }

    fn call(&self, function: Function, x: &[String]) -> String {
        let name = match function {
            Function::Sign => return format!("(1.0 - 2.0 * (({}) < 0.0))", x[0]),
            Function::Cbrt => return format!("nthroot({}, 3)", x[0]),
            Function::Trunc => "fix",
            Function::Power => "power",
            usual => usual.name(),
        };
        format!("{name}({})", x.join(", "))
    }

    fn choice(&self, condition: &str, first: &str, second: &str) -> String {
        format!("choice({condition}, {first}, {second})")
    }

    fn and(&self) -> &'static str {
        "&&"
    }

    fn table(&self, name: &str, wanted: TableOf, x: &str) -> String {
        match wanted {
            TableOf::Value => format!("table_value(@{name}, {x})"),
            TableOf::Slope => format!("table_slope(@{name}, {x})"),
        }
    }

    fn note(&self, text: &str) -> String {
        format!("% {}", harmless(text))
    }

    fn set(&self, name: &str, value: &str, _is_new: bool) -> String {
        format!("{name} = {value};")
    }

    fn rounds(&self, rounds: u32) -> String {
        format!("for round_number = 1:{rounds}")
    }

    fn until(&self, condition: &str) -> String {
        format!("if {condition}, break; end")
    }

    fn end(&self) -> Option<&'static str> {
        Some("end")
    }
}

/// The file.
pub fn files(model: &Model, job: &Job<'_>) -> Vec<File> {
    let [a, b] = HELD;
    let only_held = |text: &str| match model.held {
        Some(_) => text.to_owned(),
        None => String::new(),
    };
    let begin = "    held = held_voltage(t, x, u, p);\n";
    let text = filled(
        include_str!("../../templates/model.m"),
        &[
            ("@HELD@", held_voltage(model)),
            ("@TABLES@", tables(&model.tables)),
            ("@CHOICE@", CHOICE.to_owned()),
            ("@STATES@", names(&model.states, "'")),
            ("@INPUTS@", names(&model.inputs, "'")),
            ("@OUTPUTS@", names(&model.outputs, "'")),
            ("@STATE_COUNT@", model.states.len().to_string()),
            ("@STEP@", format!("{STEP_S:?}")),
            ("@PARAMETERS@", parameters(&model.parameters)),
            ("@UNPACKED@", unpacked(model)),
            (
                "@DERIVATIVES@",
                statements(&Matlab, &model.derivatives.statements, 1),
            ),
            ("@RATES@", rows(model, true)),
            ("@SHOWN@", statements(&Matlab, &model.shown.statements, 1)),
            ("@READINGS@", rows(model, false)),
            (
                "@HELD_HANDLE@",
                only_held("    model.held_voltage = @held_voltage;\n"),
            ),
            ("@HELD_ARGUMENT@", only_held(", held")),
            (
                "@HELD_UNPACKED@",
                only_held(&format!("    {a} = held(1); {b} = held(2);\n")),
            ),
            ("@BEGIN@", only_held(begin)),
            ("@NAME@", job.name.clone()),
            ("@VERSION@", job.version.to_owned()),
            ("@SOURCE@", harmless(job.source)),
            ("@REMARKS@", super::remarks(model, "% ")),
            ("@TITLE@", harmless(&model.title)),
        ],
    );
    vec![File::text(text)]
}

fn parameters(parameters: &[Quantity]) -> String {
    each(parameters, "\n", |q| {
        format!(
            "    p.{} = {:?}; % {}: {}",
            q.name,
            q.value,
            harmless(&q.unit),
            harmless(&q.meaning)
        )
    })
}

fn unpacked(model: &Model) -> String {
    let one = |from: &'static str| {
        move |(k, q): (usize, &Quantity)| format!("    {} = {from}({});\n", q.name, k + 1)
    };
    let states = model.states.iter().enumerate().map(one("x"));
    states
        .chain(model.inputs.iter().enumerate().map(one("u")))
        .collect()
}

/// Results as the rows of one vector.
fn rows(model: &Model, is_rates: bool) -> String {
    let section = if is_rates {
        &model.derivatives
    } else {
        &model.shown
    };
    results(&Matlab, section, ", ...\n", |_, text| {
        format!("        ({text})")
    })
}

fn held_voltage(model: &Model) -> String {
    let Some(section) = &model.held else {
        return String::new();
    };
    format!(
        "\n% Stator voltage that is decided at the beginning of a step and added during it, V.\n\
         function held = held_voltage(t, x, u, p)\n{}{}    held = [ ...\n{}];\nend\n",
        unpacked(model),
        statements(&Matlab, &section.statements, 1),
        results(&Matlab, section, ", ...\n", |_, text| format!(
            "        ({text})"
        )),
    )
}

const CHOICE: &str = r"
% The first where the condition holds, else the second.
function y = choice(condition, first, second)
    if condition, y = first; else, y = second; end
end
";

const LOOK_UP: &str = r"
% Place in a table: intervals from its begin, number of the interval.
function [at, k, first, per_unit, values] = place(table, x)
    [first, per_unit, values] = table();
    at = (x - first) * per_unit;
    k = min(floor(min(max(at, 0.0), numel(values) - 1)), numel(values) - 2);
end

function y = table_value(table, x)
    [at, k, ~, ~, values] = place(table, x);
    inside = min(max(at, 0.0), numel(values) - 1);
    y = values(k + 1) + (inside - k) * (values(k + 2) - values(k + 1));
end

function y = table_slope(table, x)
    [at, k, ~, per_unit, values] = place(table, x);
    y = (at >= 0.0 && at <= numel(values) - 1) * (values(k + 2) - values(k + 1)) * per_unit;
end
";

fn tables(tables: &[Table]) -> String {
    if tables.is_empty() {
        return String::new();
    }
    let one = |table: &Table| {
        format!(
            "\n% {}: begin, intervals per unit, values\nfunction [first, per_unit, values] = {}()\n    persistent kept\n    \
             if isempty(kept)\n        kept = [ ...\n{}];\n    end\n    first = {:?}; per_unit = {:?}; values = kept;\nend\n",
            harmless(&table.meaning),
            table.name,
            numbers(&table.values, "            ", " ..."),
            table.first,
            table.per_unit,
        )
    };
    let all: String = tables.iter().map(one).collect();
    format!("{LOOK_UP}{all}")
}
