//! Values of expressions: what an exported program computes.

use super::{Compared, Condition, Expr, Function, Statement, Table, TableOf};
use std::collections::BTreeMap;

/// Values by name.
///
/// A name without a value is NaN.
#[derive(Clone, Debug, Default)]
pub struct Values<'a> {
    /// Names.
    pub names: BTreeMap<String, f64>,
    /// Parameters.
    pub parameters: BTreeMap<&'a str, f64>,
    /// Tables.
    pub tables: &'a [Table],
}

impl Values<'_> {
    /// Runs statements.
    pub fn run(&mut self, statements: &[Statement]) {
        for statement in statements {
            match statement {
                Statement::Note(_) => {}
                Statement::Set(name, value) => {
                    let value = self.of(value);
                    self.names.insert(name.clone(), value);
                }
                Statement::Repeat {
                    rounds,
                    statements,
                    until,
                } => {
                    for _ in 0..*rounds {
                        self.run(statements);
                        if self.holds(until) {
                            break;
                        }
                    }
                }
            }
        }
    }

    /// Value of an expression.
    pub fn of(&self, expr: &Expr) -> f64 {
        match expr {
            Expr::Number(x) => *x,
            Expr::Name(name) => self.names.get(&**name).copied().unwrap_or(f64::NAN),
            Expr::Parameter(name) => self.parameters.get(&**name).copied().unwrap_or(f64::NAN),
            Expr::Negative(a) => -self.of(a),
            Expr::Sum(a, b) => self.of(a) + self.of(b),
            Expr::Difference(a, b) => self.of(a) - self.of(b),
            Expr::Product(a, b) => self.of(a) * self.of(b),
            Expr::Quotient(a, b) => self.of(a) / self.of(b),
            Expr::Call(function, arguments) => {
                let x: Vec<f64> = arguments.iter().map(|a| self.of(a)).collect();
                value(*function, &x)
            }
            Expr::Choice(condition, a, b) => match self.holds(condition) {
                true => self.of(a),
                false => self.of(b),
            },
            Expr::Table(name, wanted, x) => {
                let table = self.tables.iter().find(|t| t.name == **name);
                table.map_or(f64::NAN, |table| at(table, *wanted, self.of(x)))
            }
        }
    }

    fn holds(&self, condition: &Condition) -> bool {
        match condition {
            Condition::Is(a, Compared::Less, b) => self.of(a) < self.of(b),
            Condition::Is(a, Compared::AtMost, b) => self.of(a) <= self.of(b),
            Condition::Both(a, b) => self.holds(a) && self.holds(b),
        }
    }
}

fn at(table: &Table, wanted: TableOf, x: f64) -> f64 {
    let last = table.values.len() - 1;
    let u = (x - table.first) * table.per_unit;
    let inside = u.clamp(0.0, last as f64);
    let k = (inside as usize).min(last - 1);
    let rise = table.values[k + 1] - table.values[k];
    match wanted {
        TableOf::Value => table.values[k] + (inside - k as f64) * rise,
        TableOf::Slope if (0.0..=last as f64).contains(&u) => rise * table.per_unit,
        TableOf::Slope => 0.0,
    }
}

fn value(function: Function, x: &[f64]) -> f64 {
    let a = x[0];
    match function {
        Function::Abs => a.abs(),
        Function::Sign => a.signum(),
        Function::Sin => a.sin(),
        Function::Cos => a.cos(),
        Function::Tan => a.tan(),
        Function::Asin => a.asin(),
        Function::Acos => a.acos(),
        Function::Atan => a.atan(),
        Function::Sinh => a.sinh(),
        Function::Cosh => a.cosh(),
        Function::Tanh => a.tanh(),
        Function::Asinh => a.asinh(),
        Function::Acosh => a.acosh(),
        Function::Atanh => a.atanh(),
        Function::Floor => a.floor(),
        Function::Ceil => a.ceil(),
        Function::Round => a.round(),
        Function::Trunc => a.trunc(),
        Function::Exp => a.exp(),
        Function::Expm1 => a.exp_m1(),
        Function::Sqrt => a.sqrt(),
        Function::Cbrt => a.cbrt(),
        Function::Ln => a.ln(),
        Function::Log2 => a.log2(),
        Function::Log10 => a.log10(),
        Function::Power => a.powf(x[1]),
        Function::Atan2 => a.atan2(x[1]),
        Function::Min => a.min(x[1]),
        Function::Max => a.max(x[1]),
    }
}
