//! Statements in their order.

use super::{Condition, Expr, Vector};
use std::collections::BTreeSet;

/// One statement.
#[derive(Clone, Debug, PartialEq)]
pub enum Statement {
    /// What the statements after it are about.
    Note(String),
    /// Gives a name a value.
    Set(String, Expr),
    /// Repeats statements until a condition holds after them, so many times at most.
    Repeat {
        /// Most rounds.
        rounds: u32,
        /// What is repeated.
        statements: Vec<Statement>,
        /// What ends it early.
        until: Condition,
    },
}

/// Statements that are being written.
#[derive(Clone, Debug, Default)]
pub struct Body {
    statements: Vec<Statement>,
    names: BTreeSet<String>,
}

impl Body {
    /// Nothing yet; these names are in use elsewhere.
    pub fn new<'a>(taken: impl IntoIterator<Item = &'a str>) -> Body {
        Body {
            statements: Vec::new(),
            names: taken.into_iter().map(str::to_owned).collect(),
        }
    }

    /// The statements so far.
    pub fn statements(&self) -> &[Statement] {
        &self.statements
    }

    /// Says what the next statements are about.
    pub fn note(&mut self, text: impl Into<String>) {
        self.statements.push(Statement::Note(text.into()));
    }

    /// Gives a value a name, with a number behind it where the name is taken.
    pub fn name(&mut self, name: &str, value: impl Into<Expr>) -> Expr {
        let mut free = name.to_owned();
        let mut k = 2;
        while !self.names.insert(free.clone()) {
            free = format!("{name}_{k}");
            k += 1;
        }
        self.statements
            .push(Statement::Set(free.clone(), value.into()));
        Expr::name(&free)
    }

    /// Gives a vector's components names.
    pub fn vector(&mut self, name: &str, value: &Vector) -> Vector {
        Vector {
            re: self.name(&format!("{name}_alpha"), &value.re),
            im: self.name(&format!("{name}_beta"), &value.im),
        }
    }

    /// Repeats what `write` writes until its condition holds, at most `rounds` times.
    pub fn repeat(&mut self, rounds: u32, write: impl FnOnce(&mut Body) -> Condition) {
        let outer = std::mem::take(&mut self.statements);
        let until = write(self);
        let statements = std::mem::replace(&mut self.statements, outer);
        self.statements.push(Statement::Repeat {
            rounds,
            statements,
            until,
        });
    }

    /// Gives a name that has a value another one.
    pub fn again(&mut self, name: &Expr, value: impl Into<Expr>) {
        if let Expr::Name(name) = name {
            let set = Statement::Set(name.to_string(), value.into());
            self.statements.push(set);
        }
    }
}
