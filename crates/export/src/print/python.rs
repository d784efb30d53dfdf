//! Python: one file of plain functions.

use super::infix::{Syntax, statements};
use super::page::{each, filled, harmless, names, numbers, results};
use super::{File, Job};
use crate::algebra::{Function, Table, TableOf};
use crate::model::{HELD, Model, STEP_S};

struct Python;

impl Syntax for Python {
    fn parameter(&self, name: &str) -> String {
        format!("p.{name}")
    }

    fn call(&self, function: Function, x: &[String]) -> String {
        let name = match function {
            Function::Sign => return format!("math.copysign(1.0, {})", x[0]),
            Function::Round => {
                return format!("math.copysign(math.floor(abs({0}) + 0.5), {0})", x[0]);
            }
            Function::Cbrt => {
                return format!("math.copysign(math.pow(abs({0}), 1.0 / 3.0), {0})", x[0]);
            }
            Function::Abs | Function::Min | Function::Max => function.name().to_owned(),
            of_library => format!("math.{}", of_library.name()),
        };
        format!("{name}({})", x.join(", "))
    }

    fn choice(&self, condition: &str, first: &str, second: &str) -> String {
        format!("({first} if {condition} else {second})")
    }

    fn and(&self) -> &'static str {
        "and"
    }

    fn table(&self, name: &str, wanted: TableOf, x: &str) -> String {
        match wanted {
            TableOf::Value => format!("_value({}, {x})", name.to_uppercase()),
            TableOf::Slope => format!("_slope({}, {x})", name.to_uppercase()),
        }
    }

    fn note(&self, text: &str) -> String {
        format!("# {}", harmless(text))
    }

    fn set(&self, name: &str, value: &str, _is_new: bool) -> String {
        format!("{name} = {value}")
    }

    fn rounds(&self, rounds: u32) -> String {
        format!("for _ in range({rounds}):")
    }

    fn until(&self, condition: &str) -> String {
        format!("if {condition}: break")
    }

    fn end(&self) -> Option<&'static str> {
        None
    }
}

/// The file.
pub fn files(model: &Model, job: &Job<'_>) -> Vec<File> {
    let rows = |_: usize, text: String| format!("        {text},");
    let held = model.held.is_some();
    let only_held = |text: &str| if held { text.to_owned() } else { String::new() };
    let text = filled(
        include_str!("../../templates/model.py"),
        &[
            ("@PARAMETERS@", parameters(model)),
            ("@STATES@", names(&model.states, "\"")),
            ("@STATE_LIST@", names(&model.states, "")),
            ("@INPUTS@", names(&model.inputs, "\"")),
            ("@INPUT_LIST@", names(&model.inputs, "")),
            ("@OUTPUTS@", names(&model.outputs, "\"")),
            ("@STEP@", format!("{STEP_S:?}")),
            ("@TABLES@", tables(&model.tables)),
            (
                "@DERIVATIVES@",
                statements(&Python, &model.derivatives.statements, 1),
            ),
            ("@RATES@", results(&Python, &model.derivatives, "\n", rows)),
            ("@SHOWN@", statements(&Python, &model.shown.statements, 1)),
            ("@READINGS@", results(&Python, &model.shown, "\n", rows)),
            ("@HELD@", held_voltage(model)),
            ("@HELD_ARGUMENT@", only_held(", held")),
            ("@HELD_PASSED@", only_held(", held")),
            (
                "@BEGIN@",
                only_held("    held = held_voltage(t, x, u, p)\n"),
            ),
            ("@NAME@", job.name.clone()),
            ("@VERSION@", job.version.to_owned()),
            ("@SOURCE@", harmless(job.source)),
            ("@REMARKS@", super::remarks(model, "")),
            ("@TITLE@", harmless(&model.title)),
        ],
    );
    let text = match held {
        true => unpacked(&text),
        false => text,
    };
    vec![File::text(text)]
}

/// The held voltage is an argument of the rates.
fn unpacked(text: &str) -> String {
    let [a, b] = HELD;
    let docs = "\"\"\"Rates of change of the states, per second.\"\"\"\n";
    text.replace(docs, &format!("{docs}    {a}, {b} = held\n"))
}

fn parameters(model: &Model) -> String {
    each(&model.parameters, "\n", |q| {
        format!(
            "    {}: float = {:?}  # {}: {}",
            q.name,
            q.value,
            harmless(&q.unit),
            harmless(&q.meaning)
        )
    })
}

fn held_voltage(model: &Model) -> String {
    let Some(section) = &model.held else {
        return String::new();
    };
    let rows = |_: usize, text: String| format!("        {text},");
    format!(
        "\ndef held_voltage(t, x, u, p):\n    \"\"\"Stator voltage that is decided at the beginning of a step and added during it, V.\"\"\"\n    \
         {} = x\n    {} = u\n{}    return (\n{}\n    )\n\n",
        names(&model.states, ""),
        names(&model.inputs, ""),
        statements(&Python, &section.statements, 1),
        results(&Python, section, "\n", rows),
    )
}

const LOOK_UP: &str = r#"

def _place(table, x):
    first, per_unit, values = table
    at = (x - first) * per_unit
    inside = min(max(at, 0.0), len(values) - 1.0)
    k = min(int(inside), len(values) - 2)
    return at, k, inside - k, values[k], values[k + 1]


def _value(table, x):
    _, _, share, a, b = _place(table, x)
    return a + share * (b - a)


def _slope(table, x):
    at, _, _, a, b = _place(table, x)
    return (b - a) * table[1] if 0.0 <= at <= len(table[2]) - 1.0 else 0.0
"#;

fn tables(tables: &[Table]) -> String {
    if tables.is_empty() {
        return String::new();
    }
    let one = |table: &Table| {
        let values = numbers(&table.values, "    ", "");
        format!(
            "# {}: begin, intervals per unit, values\n{} = ({:?}, {:?}, [\n{values},\n])\n",
            harmless(&table.meaning),
            table.name.to_uppercase(),
            table.first,
            table.per_unit
        )
    };
    let all: String = tables.iter().map(one).collect();
    format!("{all}{LOOK_UP}")
}
