//! The formula of a motor file as an expression.
//!
//! The formula language is that of the library `exmex`, which evaluates formulas but does not show their structure. What is read here is
//! therefore compared with its values before it is used.

use crate::algebra::{Expr, Function, Values, number};
use exmex::Express;
use std::collections::BTreeMap;
use std::f64::consts::{E, PI, TAU};
use std::rc::Rc;

/// A formula whose names are [`Expr::Name`]s.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula(Expr);

/// Why a formula is not written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotWritten {
    /// It has something that is not known here.
    #[error("`{0}` is not understood at character {1}")]
    Unknown(String, usize),
    /// It ends too early.
    #[error("it ends where something must follow")]
    Ends,
    /// The bracket is not closed.
    #[error("a bracket is not closed")]
    Open,
    /// It is nested too deep.
    #[error("its brackets are nested too deep")]
    Deep,
    /// It is read differently by the simulation.
    #[error("its brackets can be read in two ways: put brackets around each part")]
    Ambiguous,
}

/// Brackets within brackets.
const DEEPEST: u32 = 100;
/// Points at which the formula is compared with the simulation's own reading.
const POINTS: usize = 64;

impl Formula {
    /// Reads a formula.
    ///
    /// # Errors
    /// Something that is not known here, or that the simulation reads differently.
    pub fn read(text: &str) -> Result<Formula, NotWritten> {
        let mut reader = Reader {
            text: text.char_indices().collect(),
            next: 0,
            depth: 0,
        };
        let formula = Formula(reader.sum(0)?);
        match reader.peek() {
            None if formula.is_read_the_same(text) => Ok(formula),
            None => Err(NotWritten::Ambiguous),
            Some(_) => Err(reader.unknown()),
        }
    }

    /// The formula with each name replaced.
    pub fn with(&self, replace: &dyn Fn(&str) -> Expr) -> Expr {
        replaced(&self.0, replace)
    }

    /// Compares with the reading of the simulation at pseudo-random places.
    fn is_read_the_same(&self, text: &str) -> bool {
        let Ok(flat) = exmex::parse::<f64>(text) else {
            return false;
        };
        let mut seed = 1u64;
        let mut draw = || {
            // Numerical Recipes' linear congruence (Press et al., 3rd edition, 7.1).
            seed = seed
                .wrapping_mul(2_862_933_555_777_941_757)
                .wrapping_add(3_037_000_493);
            (seed >> 11) as f64 / (1u64 << 53) as f64 * 4.0 - 1.5
        };
        (0..POINTS).all(|_| {
            let x: Vec<f64> = flat.var_names().iter().map(|_| draw()).collect();
            let names = flat.var_names().iter().cloned().zip(x.iter().copied());
            let values = Values {
                names: names.collect::<BTreeMap<_, _>>(),
                ..Values::default()
            };
            flat.eval(&x)
                .is_ok_and(|theirs| is_same(theirs, values.of(&self.0)))
        })
    }
}

fn is_same(a: f64, b: f64) -> bool {
    if !(a.is_finite() && b.is_finite()) {
        return a.is_finite() == b.is_finite();
    }
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1e-9)
}

fn replaced(expr: &Expr, replace: &dyn Fn(&str) -> Expr) -> Expr {
    let inner = |a: &Rc<Expr>| Rc::new(replaced(a, replace));
    match expr {
        Expr::Name(name) => replace(name),
        Expr::Negative(a) => Expr::Negative(inner(a)),
        Expr::Sum(a, b) => Expr::Sum(inner(a), inner(b)),
        Expr::Difference(a, b) => Expr::Difference(inner(a), inner(b)),
        Expr::Product(a, b) => Expr::Product(inner(a), inner(b)),
        Expr::Quotient(a, b) => Expr::Quotient(inner(a), inner(b)),
        Expr::Call(function, arguments) => {
            let all = arguments.iter().map(|a| replaced(a, replace));
            Expr::Call(*function, all.collect())
        }
        // A formula has none of these.
        Expr::Number(_) | Expr::Parameter(_) | Expr::Choice(..) | Expr::Table(..) => expr.clone(),
    }
}

struct Reader {
    text: Vec<(usize, char)>,
    next: usize,
    depth: u32,
}

/// Operators between two values: sign, priority. Division binds more tightly than a product, a difference than a sum.
const BETWEEN: [(char, u32); 5] = [('+', 0), ('-', 1), ('*', 2), ('/', 3), ('^', 4)];
const HIGHEST: u32 = 4;

impl Reader {
    fn peek(&mut self) -> Option<char> {
        while self.text.get(self.next).is_some_and(|(_, c)| *c == ' ') {
            self.next += 1;
        }
        self.text.get(self.next).map(|(_, c)| *c)
    }

    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        self.next += usize::from(found);
        found
    }

    fn unknown(&self) -> NotWritten {
        let rest = self.text[self.next.min(self.text.len())..].iter();
        NotWritten::Unknown(rest.map(|(_, c)| *c).take(12).collect(), self.next + 1)
    }

    /// Values joined by operators of at least this priority, from left to right.
    fn sum(&mut self, priority: u32) -> Result<Expr, NotWritten> {
        if priority > HIGHEST {
            return self.value();
        }
        let mut left = self.sum(priority + 1)?;
        let operator = BETWEEN.iter().find(|(_, p)| *p == priority).map(|o| o.0);
        while let Some(sign) = operator {
            if !self.take(sign) {
                break;
            }
            let right = self.sum(priority + 1)?;
            left = match sign {
                '+' => left + right,
                '-' => left - right,
                '*' => left * right,
                '/' => left / right,
                _ => left.power(right),
            };
        }
        Ok(left)
    }

    /// A number, a name, a bracket, or a sign or function before a value.
    fn value(&mut self) -> Result<Expr, NotWritten> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(NotWritten::Deep);
        }
        let value = match self.peek().ok_or(NotWritten::Ends)? {
            '-' => {
                self.next += 1;
                Ok(-self.value()?)
            }
            '+' => {
                self.next += 1;
                self.value()
            }
            '(' => self.bracket(),
            c if c.is_ascii_digit() || c == '.' => self.number(),
            c if c.is_alphabetic() || c == '_' => self.word(),
            _ => Err(self.unknown()),
        };
        self.depth -= 1;
        value
    }

    fn bracket(&mut self) -> Result<Expr, NotWritten> {
        self.next += 1;
        let inner = self.sum(0)?;
        match self.take(')') {
            true => Ok(inner),
            false if self.peek().is_none() => Err(NotWritten::Open),
            false => Err(self.unknown()),
        }
    }

    fn run_of(&mut self, belongs: impl Fn(char) -> bool) -> String {
        let rest = self.text[self.next..].iter().map(|(_, c)| *c);
        let run: String = rest.take_while(|c| belongs(*c)).collect();
        self.next += run.chars().count();
        run
    }

    fn number(&mut self) -> Result<Expr, NotWritten> {
        let begin = self.next;
        let digits = self.run_of(|c| c.is_ascii_digit() || c == '.');
        digits.parse().map(number).map_err(|_| {
            self.next = begin;
            self.unknown()
        })
    }

    fn word(&mut self) -> Result<Expr, NotWritten> {
        let word = self.run_of(|c| c.is_alphanumeric() || c == '_');
        if let Some(function) = of_one(&word) {
            return Ok(self.value()?.of(function));
        }
        if let Some(function) = of_two(&word) {
            return self.two(function);
        }
        Ok(match word.as_str() {
            "PI" | "π" => number(PI),
            "E" | "e" => number(E),
            "TAU" | "τ" => number(TAU),
            "fract" => {
                let x = self.value()?;
                &x - x.of(Function::Trunc)
            }
            _ => Expr::name(&word),
        })
    }

    fn two(&mut self, function: Function) -> Result<Expr, NotWritten> {
        if self.peek() != Some('(') {
            return Err(self.unknown());
        }
        self.next += 1;
        let first = self.sum(0)?;
        if !self.take(',') {
            return Err(self.unknown());
        }
        let second = self.sum(0)?;
        match self.take(')') {
            true => Ok(first.with(function, second)),
            false => Err(NotWritten::Open),
        }
    }
}

fn of_one(word: &str) -> Option<Function> {
    Some(match word {
        "abs" => Function::Abs,
        "signum" => Function::Sign,
        "sin" => Function::Sin,
        "cos" => Function::Cos,
        "tan" => Function::Tan,
        "asin" => Function::Asin,
        "acos" => Function::Acos,
        "atan" => Function::Atan,
        "sinh" => Function::Sinh,
        "cosh" => Function::Cosh,
        "tanh" => Function::Tanh,
        "asinh" => Function::Asinh,
        "acosh" => Function::Acosh,
        "atanh" => Function::Atanh,
        "floor" => Function::Floor,
        "ceil" => Function::Ceil,
        "round" => Function::Round,
        "trunc" => Function::Trunc,
        "exp" => Function::Exp,
        "sqrt" => Function::Sqrt,
        "cbrt" => Function::Cbrt,
        "ln" | "log" => Function::Ln,
        "log2" => Function::Log2,
        "log10" => Function::Log10,
        _ => return None,
    })
}

fn of_two(word: &str) -> Option<Function> {
    Some(match word {
        "atan2" => Function::Atan2,
        "min" => Function::Min,
        "max" => Function::Max,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_read_as_the_simulation_reads_them() {
        for text in [
            "2 * k * (omega / 40) / (1 + (omega / 40)^2)",
            "-x^2 + 3",
            "a*b/c*d - a/b/c + 2^x^y",
            "a-b+c-d",
            "sin x * 2 + abs(-x)",
            "k*exp(-t/10) + signum(x) * sqrt(x^2 + y^2)",
            "max(a, b) + 1",
            "atan2(a - b, c) * PI",
            "round(3*a) + fract(b) + log2(2+x)",
            "--a",
            "1.5e - a",
        ] {
            match Formula::read(text) {
                // What the simulation refuses is refused here as well.
                Err(error) => assert!(exmex::parse::<f64>(text).is_err(), "{text}: {error}"),
                Ok(formula) => assert!(formula.is_read_the_same(text), "{text}"),
            }
        }
    }

    #[test]
    fn what_is_no_formula_is_refused_with_its_place() {
        for (text, said) in [
            ("a +", "it ends"),
            ("(a", "not closed"),
            ("a $ b", "`$ b` is not understood at character 3"),
            ("", "it ends"),
            ("1.2.3", "`1.2.3`"),
            ("max(a)", "`)`"),
        ] {
            let error = Formula::read(text).expect_err(text).to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
        let deep = format!("{}a{}", "(".repeat(400), ")".repeat(400));
        assert_eq!(Formula::read(&deep), Err(NotWritten::Deep));
    }

    #[test]
    fn a_difference_between_the_readings_is_seen() {
        let formula = Formula(Expr::name("a") - Expr::name("b"));
        assert!(formula.is_read_the_same("a - b"));
        assert!(!formula.is_read_the_same("b - a"));
    }
}
