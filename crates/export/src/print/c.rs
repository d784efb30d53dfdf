//! C99: a header and a source.

use super::infix::{Syntax, statements};
use super::page::{each, filled, harmless, numbers, plain_names, results};
use super::{File, Job};
use crate::algebra::{Function, Table, TableOf};
use crate::model::{HELD, Model, Quantity, STEP_S, Section};

struct C;

impl Syntax for C {
    fn parameter(&self, name: &str) -> String {
        format!("p->{name}")
    }

    fn call(&self, function: Function, x: &[String]) -> String {
        let name = match function {
            Function::Sign => return format!("copysign(1.0, {})", x[0]),
            Function::Abs => "fabs",
            Function::Min => "fmin",
            Function::Max => "fmax",
            usual => usual.name(),
        };
        format!("{name}({})", x.join(", "))
    }

    fn choice(&self, condition: &str, first: &str, second: &str) -> String {
        format!("({condition} ? {first} : {second})")
    }

    fn and(&self) -> &'static str {
        "&&"
    }

    fn table(&self, name: &str, wanted: TableOf, x: &str) -> String {
        match wanted {
            TableOf::Value => format!("table_value(&{name}, {x})"),
            TableOf::Slope => format!("table_slope(&{name}, {x})"),
        }
    }

    fn note(&self, text: &str) -> String {
        format!("/* {} */", harmless(text))
    }

    fn set(&self, name: &str, value: &str, is_new: bool) -> String {
        match is_new {
            true => format!("double {name} = {value};"),
            false => format!("{name} = {value};"),
        }
    }

    fn rounds(&self, rounds: u32) -> String {
        format!("for (int round_number = 0; round_number < {rounds}; ++round_number) {{")
    }

    fn until(&self, condition: &str) -> String {
        format!("if ({condition}) {{ break; }}")
    }

    fn end(&self) -> Option<&'static str> {
        Some("}")
    }
}

/// Source and header.
pub fn files(model: &Model, job: &Job<'_>) -> Vec<File> {
    vec![
        File::text(source(model, job)),
        File::text(header(model, job)),
    ]
}

/// The header.
pub fn header(model: &Model, job: &Job<'_>) -> String {
    let held = model.held.is_some();
    let note = match held {
        true => "; held: the voltage of held_voltage at the beginning of the step",
        false => "",
    };
    let declared = match held {
        true => format!(
            "\n/* Stator voltage (alpha, beta) that is decided at the beginning of a step and added during it, V. */\n\
             void {}_held_voltage(double t, const double x[], const double u[], const {0}_parameters *p, double held[]);\n",
            job.name
        ),
        false => String::new(),
    };
    let mut places = vec![
        ("@PARAMETERS@", members(&model.parameters)),
        ("@STATE_NOTES@", notes(&model.states)),
        ("@INPUT_NOTES@", notes(&model.inputs)),
        ("@OUTPUT_NOTES@", notes(&model.outputs)),
        ("@STATE_COUNT@", model.states.len().to_string()),
        ("@INPUT_COUNT@", model.inputs.len().to_string()),
        ("@OUTPUT_COUNT@", model.outputs.len().to_string()),
        ("@STEP@", format!("{STEP_S:?}")),
        ("@HELD_NOTE@", note.to_owned()),
        ("@HELD_HEADER@", declared),
        ("@REMARKS@", super::remarks(model, " * ")),
        ("@SOURCE@", harmless(job.source)),
    ];
    places.extend(common(model, job));
    filled(include_str!("../../templates/model.h"), &places)
}

/// The source.
pub fn source(model: &Model, job: &Job<'_>) -> String {
    let held = model.held.is_some();
    let only_held = |text: String| if held { text } else { String::new() };
    let derivatives = lines(&model.derivatives);
    let [a, b] = HELD;
    let begin = format!(
        "    double held[2];\n    {}_held_voltage(t, x, u, p, held);\n",
        job.name
    );
    let mut places = vec![
        (
            "@DEFAULTS@",
            each(&model.parameters, "\n", |q| {
                format!("    {:?}, /* {} */", q.value, q.name)
            }),
        ),
        ("@TABLES@", tables(&model.tables, &derivatives)),
        ("@UNPACKED@", unpacked(model)),
        (
            "@HELD_UNPACKED@",
            only_held(format!("    const double {a} = held[0], {b} = held[1];\n")),
        ),
        ("@DERIVATIVES@", derivatives),
        ("@RATES@", given(&model.derivatives, "dx")),
        ("@SHOWN@", lines(&model.shown)),
        ("@READINGS@", given(&model.shown, "y")),
        ("@HELD@", held_voltage(model)),
        ("@HELD_PASSED@", only_held(" held,".to_owned())),
        ("@BEGIN@", only_held(begin)),
        ("@INPUTS@", plain_names(&model.inputs, ",")),
        ("@OUTPUTS@", plain_names(&model.outputs, ",")),
    ];
    places.extend(common(model, job));
    filled(include_str!("../../templates/model.c"), &places)
}

fn common(model: &Model, job: &Job<'_>) -> Vec<(&'static str, String)> {
    let argument = match model.held {
        Some(_) => " const double held[],",
        None => "",
    };
    vec![
        ("@HELD_ARGUMENT@", argument.to_owned()),
        ("@NAME@", job.name.clone()),
        ("@VERSION@", job.version.to_owned()),
        ("@TITLE@", harmless(&model.title)),
    ]
}

fn members(parameters: &[Quantity]) -> String {
    each(parameters, "\n", |q| {
        format!(
            "    double {}; /* {}: {} */",
            q.name,
            harmless(&q.unit),
            harmless(&q.meaning)
        )
    })
}

fn notes(quantities: &[Quantity]) -> String {
    each(quantities, "", |q| {
        format!(" * {}, {}: {}\n", q.name, q.unit, q.meaning)
    })
}

/// States and inputs by their names; who does not use one is no error.
fn unpacked(model: &Model) -> String {
    let one = |from: &'static str| {
        move |(k, q): (usize, &Quantity)| {
            format!(
                "    const double {0} = {from}[{k}];\n    (void){0};\n",
                q.name
            )
        }
    };
    let states = model.states.iter().enumerate().map(one("x"));
    let inputs = model.inputs.iter().enumerate().map(one("u"));
    let all: String = states.chain(inputs).collect();
    format!("    (void)t;\n    (void)p;\n{all}")
}

fn lines(section: &Section) -> String {
    statements(&C, &section.statements, 1)
}

fn given(section: &Section, to: &str) -> String {
    results(&C, section, "\n", |k, text| {
        format!("    {to}[{k}] = {text};")
    })
}

fn held_voltage(model: &Model) -> String {
    let Some(section) = &model.held else {
        return String::new();
    };
    format!(
        "\nvoid @NAME@_held_voltage(double t, const double x[], const double u[], const @NAME@_parameters *p, double held[])\n{{\n{}{}{}\n}}\n",
        unpacked(model),
        lines(section),
        given(section, "held"),
    )
}

const LOOK_UP: &str = r#"
static double table_place(const struct table *table, double x, int *k)
{
    double at = (x - table->first) * table->per_unit;
    double inside = fmin(fmax(at, 0.0), (double)table->last);
    *k = (int)inside < table->last - 1 ? (int)inside : table->last - 1;
    return at;
}

static double table_value(const struct table *table, double x)
{
    int k;
    double inside = fmin(fmax(table_place(table, x, &k), 0.0), (double)table->last);
    return table->values[k] + (inside - k) * (table->values[k + 1] - table->values[k]);
}
"#;

const SLOPE: &str = r#"
static double table_slope(const struct table *table, double x)
{
    int k;
    double at = table_place(table, x, &k);
    int is_inside = at >= 0.0 && at <= (double)table->last;
    return is_inside ? (table->values[k + 1] - table->values[k]) * table->per_unit : 0.0;
}
"#;

/// The tables, and what reads them in `text`.
fn tables(tables: &[Table], text: &str) -> String {
    if tables.is_empty() {
        return String::new();
    }
    let one = |table: &Table| {
        format!(
            "\n/* {} */\nstatic const double {name}_values[] = {{\n{},\n}};\nstatic const struct table {name} = {{ {:?}, {:?}, {}, {name}_values }};\n",
            harmless(&table.meaning),
            numbers(&table.values, "    ", ""),
            table.first,
            table.per_unit,
            table.values.len() - 1,
            name = table.name,
        )
    };
    let all: String = tables.iter().map(one).collect();
    let kind = "\n/* A curve at equal distances: begin, intervals per unit, number of the last value, values. */\n\
                struct table {\n    double first, per_unit;\n    int last;\n    const double *values;\n};\n";
    let slope = if text.contains("table_slope(") {
        SLOPE
    } else {
        ""
    };
    format!("{kind}{all}{LOOK_UP}{slope}")
}
