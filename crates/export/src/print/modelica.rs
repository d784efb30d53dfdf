//! Modelica: one model of equations, whose loops are left to the tool.

use super::infix::{Syntax, expression, names};
use super::page::{each, filled, harmless, numbers};
use super::{File, Job};
use crate::ExportError;
use crate::algebra::{Expr, Function, Statement, Table, TableOf};
use crate::model::{Model, Quantity};

struct Modelica<'a>(&'a [Table]);

impl Syntax for Modelica<'_> {
    fn parameter(&self, name: &str) -> String {
        name.to_owned()
    }

    fn call(&self, function: Function, x: &[String]) -> String {
        let name = match function {
            Function::Power => return format!("(({})^({}))", x[0], x[1]),
            Function::Expm1 => return format!("(exp({}) - 1.0)", x[0]),
            Function::Log2 => return format!("(log({}) / log(2.0))", x[0]),
            Function::Asinh => return format!("log(({0}) + sqrt(({0})^2 + 1.0))", x[0]),
            Function::Acosh => return format!("log(({0}) + sqrt(({0})^2 - 1.0))", x[0]),
            Function::Atanh => return format!("(0.5 * log((1.0 + ({0})) / (1.0 - ({0}))))", x[0]),
            Function::Sign => "signOf",
            Function::Cbrt => "cubeRoot",
            Function::Floor => "floorOf",
            Function::Ceil => return format!("(-floorOf(-({})))", x[0]),
            Function::Trunc => return format!("(signOf({0}) * floorOf(abs({0})))", x[0]),
            Function::Round => return format!("(signOf({0}) * floorOf(abs({0}) + 0.5))", x[0]),
            usual => usual.name(),
        };
        format!("{name}({})", x.join(", "))
    }

    fn choice(&self, condition: &str, first: &str, second: &str) -> String {
        format!("noEvent(if {condition} then {first} else {second})")
    }

    fn and(&self) -> &'static str {
        "and"
    }

    fn table(&self, name: &str, wanted: TableOf, x: &str) -> String {
        let table = self.0.iter().find(|table| table.name == name);
        let (first, per_unit) = table.map_or((0.0, 1.0), |table| (table.first, table.per_unit));
        let function = match wanted {
            TableOf::Value => "tableValue",
            TableOf::Slope => "tableSlope",
        };
        format!("{function}({name}, {first:?}, {per_unit:?}, {x})")
    }

    fn note(&self, text: &str) -> String {
        format!("// {}", harmless(text))
    }

    fn set(&self, name: &str, value: &str, _is_new: bool) -> String {
        format!("{name} = {value};")
    }

    fn rounds(&self, _rounds: u32) -> String {
        "// what the next equations have in common is their solution".to_owned()
    }

    fn until(&self, _condition: &str) -> String {
        String::new()
    }

    fn end(&self) -> Option<&'static str> {
        None
    }
}

/// The file.
///
/// # Errors
/// A voltage that is decided once a step: equations have no steps.
pub fn files(model: &Model, job: &Job<'_>) -> Result<Vec<File>, ExportError> {
    if model.held.is_some() {
        return Err(ExportError::Language {
            effect: model.held_by.clone(),
            language: "Modelica",
            reason: "it is decided once a step, and equations have no steps",
        });
    }
    let syntax = Modelica(&model.tables);
    let (equations, variables) = equations(&syntax, model);
    let variables: String = variables
        .iter()
        .map(|name| format!("  Real {name};\n"))
        .collect();
    let text = filled(
        include_str!("../../templates/model.mo"),
        &[
            ("@PARAMETERS@", each(&model.parameters, "\n", parameter)),
            (
                "@INPUTS@",
                each(&model.inputs, "\n", |q| declared("input Real", q, "")),
            ),
            (
                "@OUTPUTS@",
                each(&model.outputs, "\n", |q| declared("output Real", q, "")),
            ),
            (
                "@STATES@",
                each(&model.states, "\n", |q| {
                    declared("Real", q, "start = 0.0, fixed = true, ")
                }),
            ),
            ("@VARIABLES@", variables),
            ("@TABLES@", tables(&model.tables)),
            ("@FUNCTIONS@", functions(&equations)),
            ("@EQUATIONS@", equations),
            (
                "@RATES@",
                results(
                    &syntax,
                    model.states.iter().map(|q| format!("der({})", q.name)),
                    &model.derivatives.results,
                ),
            ),
            (
                "@READINGS@",
                results(
                    &syntax,
                    model.outputs.iter().map(|q| q.name.clone()),
                    &model.shown.results,
                ),
            ),
            ("@REMARKS@", super::remarks(model, "  // ")),
            ("@NAME@", job.name.clone()),
            ("@VERSION@", job.version.to_owned()),
            ("@SOURCE@", harmless(job.source)),
            ("@TITLE@", harmless(&model.title)),
        ],
    );
    Ok(vec![File::text(text)])
}

fn results(syntax: &Modelica<'_>, to: impl Iterator<Item = String>, results: &[Expr]) -> String {
    let one = |(name, value): (String, &Expr)| format!("  {name} = {};", expression(syntax, value));
    to.zip(results).map(one).collect::<Vec<_>>().join("\n")
}

/// Unit as Modelica writes it.
fn unit(text: &str) -> String {
    match text {
        "-" => "1".to_owned(),
        unit => unit.replace("ohm", "Ohm").replace(' ', "."),
    }
}

fn parameter(q: &Quantity) -> String {
    let (unit, meaning) = (unit(&q.unit), harmless(&q.meaning));
    format!(
        "  parameter Real {}(unit = \"{unit}\") = {:?} \"{meaning}\";",
        q.name, q.value
    )
}

fn declared(kind: &str, q: &Quantity, more: &str) -> String {
    let (unit, meaning) = (unit(&q.unit), harmless(&q.meaning));
    format!(
        "  {kind} {}({more}unit = \"{unit}\") \"{meaning}\";",
        q.name
    )
}

/// The equations of rates and readings, each once, and the names that they define.
fn equations(syntax: &Modelica<'_>, model: &Model) -> (String, Vec<String>) {
    let (mut text, mut known) = (String::new(), vec!["t".to_owned()]);
    text.push_str("  t = time;\n");
    for section in [&model.derivatives, &model.shown] {
        let new: Vec<Statement> = section
            .statements
            .iter()
            .filter(|statement| !is_known(statement, &known))
            .cloned()
            .collect();
        known.extend(names(&new));
        write(syntax, &told(&new), &mut text);
    }
    (text, known)
}

/// Without notes that have nothing left to tell of.
fn told(statements: &[Statement]) -> Vec<Statement> {
    let is_note = |k: usize| matches!(statements.get(k), Some(Statement::Note(_)) | None);
    let all = statements.iter().enumerate();
    let kept = all.filter(|(k, _)| !(is_note(*k) && is_note(k + 1)));
    kept.map(|(_, statement)| statement.clone()).collect()
}

fn is_known(statement: &Statement, known: &[String]) -> bool {
    let sets = names(std::slice::from_ref(statement));
    !sets.is_empty() && sets.iter().all(|name| known.contains(name))
}

/// What is found by an iteration is what no longer changes: the value that begins it is left out.
fn write(syntax: &Modelica<'_>, statements: &[Statement], text: &mut String) {
    for (k, statement) in statements.iter().enumerate() {
        match statement {
            Statement::Set(name, _) if is_found_later(name, &statements[k + 1..]) => {}
            Statement::Note(note) => text.push_str(&format!("  {}\n", syntax.note(note))),
            Statement::Set(name, value) => {
                let value = expression(syntax, value);
                text.push_str(&format!("  {name} = {value};\n"));
            }
            Statement::Repeat { statements, .. } => {
                text.push_str("  // solved by the tool for what these equations have in common\n");
                write(syntax, statements, text);
            }
        }
    }
}

fn is_found_later(name: &str, later: &[Statement]) -> bool {
    let sets = |statement: &Statement| match statement {
        Statement::Repeat { .. } => {
            names(std::slice::from_ref(statement)).contains(&name.to_owned())
        }
        _ => false,
    };
    later.iter().any(sets)
}

fn tables(tables: &[Table]) -> String {
    let one = |table: &Table| {
        format!(
            "  // {}\n  constant Real {}[{}] = {{\n{}}};\n",
            harmless(&table.meaning),
            table.name,
            table.values.len(),
            numbers(&table.values, "    ", ""),
        )
    };
    tables.iter().map(one).collect()
}

/// Functions that the equations call; in a function nothing triggers an event.
const FUNCTIONS: [(&str, &str); 5] = [
    (
        "tableValue(",
        "  function tableValue \"a curve of values at equal distances; beyond its ends it stays\"
    input Real values[:];
    input Real first;
    input Real perUnit;
    input Real x;
    output Real y;
  protected
    Real inside;
    Integer k;
  algorithm
    inside := min(max((x - first) * perUnit, 0.0), size(values, 1) - 1.0);
    k := min(integer(floor(inside)), size(values, 1) - 2);
    y := values[k + 1] + (inside - k) * (values[k + 2] - values[k + 1]);
  end tableValue;
",
    ),
    (
        "tableSlope(",
        "  function tableSlope \"slope of a curve; 0 beyond its ends\"
    input Real values[:];
    input Real first;
    input Real perUnit;
    input Real x;
    output Real y;
  protected
    Real at;
    Integer k;
  algorithm
    at := (x - first) * perUnit;
    k := min(integer(floor(min(max(at, 0.0), size(values, 1) - 1.0))), size(values, 1) - 2);
    y := if at >= 0.0 and at <= size(values, 1) - 1.0 then (values[k + 2] - values[k + 1]) * perUnit else 0.0;
  end tableSlope;
",
    ),
    (
        "floorOf(",
        "  function floorOf \"largest integer at or below\"
    input Real x;
    output Real y;
  algorithm
    y := floor(x);
  end floorOf;
",
    ),
    (
        "signOf(",
        "  function signOf \"1 or -1\"
    input Real x;
    output Real y;
  algorithm
    y := if x < 0.0 then -1.0 else 1.0;
  end signOf;
",
    ),
    (
        "cubeRoot(",
        "  function cubeRoot \"cube root\"
    input Real x;
    output Real y;
  algorithm
    y := if x < 0.0 then -(-x)^(1.0 / 3.0) else x^(1.0 / 3.0);
  end cubeRoot;
",
    ),
];

fn functions(equations: &str) -> String {
    let called = FUNCTIONS
        .iter()
        .filter(|(call, _)| equations.contains(call));
    called.map(|(_, function)| *function).collect()
}
