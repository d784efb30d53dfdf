//! Leaves out what nobody asks for.

use super::{Expr, Statement};
use std::collections::BTreeSet;

/// The statements without which `results` could not be computed, in their order; a note stays with what follows it.
pub fn needed(statements: &[Statement], results: &[Expr]) -> Vec<Statement> {
    let mut asked = BTreeSet::new();
    for result in results {
        ask(result, &mut asked);
    }
    let mut kept = Vec::new();
    let mut is_used = false;
    for statement in statements.iter().rev() {
        match statement {
            // Backwards a note comes after what it is about.
            Statement::Note(_) if is_used => {
                is_used = false;
                kept.push(statement.clone());
            }
            Statement::Note(_) => {}
            _ if sets(statement).iter().any(|name| asked.contains(*name)) => {
                is_used = true;
                ask_of(statement, &mut asked);
                kept.push(statement.clone());
            }
            _ => {}
        }
    }
    kept.reverse();
    kept
}

/// Names that a statement gives values.
fn sets(statement: &Statement) -> Vec<&str> {
    match statement {
        Statement::Note(_) => Vec::new(),
        Statement::Set(name, _) => vec![name],
        Statement::Repeat { statements, .. } => statements.iter().flat_map(sets).collect(),
    }
}

fn ask_of(statement: &Statement, asked: &mut BTreeSet<String>) {
    match statement {
        Statement::Note(_) => {}
        Statement::Set(_, value) => ask(value, asked),
        Statement::Repeat {
            statements, until, ..
        } => {
            until.walk(&mut |expr| ask_name(expr, asked));
            statements.iter().for_each(|inner| ask_of(inner, asked));
        }
    }
}

fn ask(expr: &Expr, asked: &mut BTreeSet<String>) {
    expr.walk(&mut |part| ask_name(part, asked));
}

fn ask_name(part: &Expr, asked: &mut BTreeSet<String>) {
    if let Expr::Name(name) = part {
        asked.insert(name.to_string());
    }
}

/// Names of the parameters that statements and results ask for.
pub fn parameters(statements: &[Statement], results: &[Expr]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut see = |part: &Expr| {
        if let Expr::Parameter(name) = part {
            found.insert(name.to_string());
        }
    };
    results.iter().for_each(|result| result.walk(&mut see));
    walk(statements, &mut see);
    found
}

fn walk(statements: &[Statement], see: &mut dyn FnMut(&Expr)) {
    for statement in statements {
        match statement {
            Statement::Note(_) => {}
            Statement::Set(_, value) => value.walk(see),
            Statement::Repeat {
                statements, until, ..
            } => {
                walk(statements, see);
                until.walk(see);
            }
        }
    }
}
