//! Expressions and statements as text, with as few brackets as keep their order.

use crate::algebra::{Compared, Condition, Expr, Function, Statement, TableOf};
use std::collections::BTreeSet;

/// What differs from language to language.
pub trait Syntax {
    /// A parameter.
    fn parameter(&self, name: &str) -> String;

    /// A function of arguments, as a value that needs no brackets.
    fn call(&self, function: Function, x: &[String]) -> String;

    /// The first where the condition holds, else the second, in brackets.
    fn choice(&self, condition: &str, first: &str, second: &str) -> String;

    /// Word between two conditions.
    fn and(&self) -> &'static str;

    /// A table at a place.
    fn table(&self, name: &str, wanted: TableOf, x: &str) -> String;

    /// A comment line.
    fn note(&self, text: &str) -> String;

    /// Gives a name a value, for the first time or again.
    fn set(&self, name: &str, value: &str, is_new: bool) -> String;

    /// Begins so many rounds.
    fn rounds(&self, rounds: u32) -> String;

    /// Ends the rounds where a condition holds.
    fn until(&self, condition: &str) -> String;

    /// Ends what is repeated.
    fn end(&self) -> Option<&'static str>;
}

/// How tightly a text holds together.
///
/// A sign before a value stands beside no operator: Modelica does not take that.
const SIGN: u8 = 0;
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const VALUE: u8 = 3;

/// An expression as text.
pub fn expression(syntax: &dyn Syntax, expr: &Expr) -> String {
    written(syntax, expr).0
}

/// The text, in brackets where it would fall apart.
fn within(syntax: &dyn Syntax, expr: &Expr, holds: u8) -> String {
    match written(syntax, expr) {
        (text, own) if own >= holds => text,
        (text, _) => format!("({text})"),
    }
}

fn written(syntax: &dyn Syntax, expr: &Expr) -> (String, u8) {
    let two = |a: &Expr, sign: &str, b: &Expr, holds: u8| {
        let (a, b) = (within(syntax, a, holds), within(syntax, b, holds + 1));
        (format!("{a} {sign} {b}"), holds)
    };
    match expr {
        Expr::Number(x) if *x < 0.0 => (format!("{x:?}"), SIGN),
        Expr::Number(x) => (format!("{x:?}"), VALUE),
        Expr::Name(name) => (name.to_string(), VALUE),
        Expr::Parameter(name) => (syntax.parameter(name), VALUE),
        Expr::Negative(a) => (format!("-{}", within(syntax, a, VALUE)), SIGN),
        Expr::Sum(a, b) => two(a, "+", b, SUM),
        Expr::Difference(a, b) => two(a, "-", b, SUM),
        Expr::Product(a, b) => two(a, "*", b, PRODUCT),
        Expr::Quotient(a, b) => two(a, "/", b, PRODUCT),
        Expr::Call(function, arguments) => {
            let x: Vec<_> = arguments.iter().map(|a| expression(syntax, a)).collect();
            (syntax.call(*function, &x), VALUE)
        }
        Expr::Choice(condition, a, b) => {
            let (a, b) = (expression(syntax, a), expression(syntax, b));
            let condition = self::condition(syntax, condition);
            (syntax.choice(&condition, &a, &b), VALUE)
        }
        Expr::Table(name, wanted, x) => {
            let x = expression(syntax, x);
            (syntax.table(name, *wanted, &x), VALUE)
        }
    }
}

fn condition(syntax: &dyn Syntax, condition: &Condition) -> String {
    match condition {
        Condition::Is(a, compared, b) => {
            let sign = match compared {
                Compared::Less => "<",
                Compared::AtMost => "<=",
            };
            format!("{} {sign} {}", expression(syntax, a), expression(syntax, b))
        }
        Condition::Both(a, b) => {
            let (a, b) = (self::condition(syntax, a), self::condition(syntax, b));
            format!("({a}) {} ({b})", syntax.and())
        }
    }
}

/// Statements as lines, each behind `depth` times four blanks and ended by a line feed.
pub fn statements(syntax: &dyn Syntax, statements: &[Statement], depth: usize) -> String {
    let mut lines = String::new();
    write(syntax, statements, depth, &mut BTreeSet::new(), &mut lines);
    lines
}

fn write(
    syntax: &dyn Syntax,
    statements: &[Statement],
    depth: usize,
    known: &mut BTreeSet<String>,
    lines: &mut String,
) {
    for statement in statements {
        match statement {
            Statement::Note(text) => line(lines, depth, &syntax.note(text)),
            Statement::Set(name, value) => {
                let is_new = known.insert(name.clone());
                let value = expression(syntax, value);
                line(lines, depth, &syntax.set(name, &value, is_new));
            }
            Statement::Repeat {
                rounds,
                statements,
                until,
            } => {
                line(lines, depth, &syntax.rounds(*rounds));
                write(syntax, statements, depth + 1, known, lines);
                let until = syntax.until(&condition(syntax, until));
                line(lines, depth + 1, &until);
                if let Some(end) = syntax.end() {
                    line(lines, depth, end);
                }
            }
        }
    }
}

fn line(lines: &mut String, depth: usize, text: &str) {
    lines.push_str(&" ".repeat(4 * depth));
    lines.push_str(text);
    lines.push('\n');
}

/// Names that statements give values, each once, in their order.
pub fn names(statements: &[Statement]) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for statement in statements {
        let new = match statement {
            Statement::Note(_) => Vec::new(),
            Statement::Set(name, _) => vec![name.clone()],
            Statement::Repeat { statements, .. } => names(statements),
        };
        for name in new {
            if !found.contains(&name) {
                found.push(name);
            }
        }
    }
    found
}
