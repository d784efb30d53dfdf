//! Expressions of real numbers.

use std::ops::{Add, Div, Mul, Neg, Sub};
use std::rc::Rc;

/// A function that every language has, or gets from the preamble of its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Magnitude.
    Abs,
    /// 1 or -1, 1 for zero.
    Sign,
    /// Sine, of rad.
    Sin,
    /// Cosine, of rad.
    Cos,
    /// Tangent, of rad.
    Tan,
    /// Inverse sine, rad.
    Asin,
    /// Inverse cosine, rad.
    Acos,
    /// Inverse tangent, rad.
    Atan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// Inverse hyperbolic sine.
    Asinh,
    /// Inverse hyperbolic cosine.
    Acosh,
    /// Inverse hyperbolic tangent.
    Atanh,
    /// Largest integer at or below.
    Floor,
    /// Smallest integer at or above.
    Ceil,
    /// Nearest integer, halves away from zero.
    Round,
    /// Integer part.
    Trunc,
    /// Exponential.
    Exp,
    /// Exponential less one, without cancellation.
    Expm1,
    /// Square root.
    Sqrt,
    /// Cube root.
    Cbrt,
    /// Natural logarithm.
    Ln,
    /// Logarithm to base 2.
    Log2,
    /// Logarithm to base 10.
    Log10,
    /// First argument to the power of the second.
    Power,
    /// Angle of the point (second, first argument), rad.
    Atan2,
    /// The smaller one.
    Min,
    /// The larger one.
    Max,
}

impl Function {
    /// Its usual name, which most languages share: a printer names those that its language calls otherwise, or lacks.
    pub fn name(self) -> &'static str {
        match self {
            Function::Abs => "abs",
            Function::Sign => "sign",
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Tan => "tan",
            Function::Asin => "asin",
            Function::Acos => "acos",
            Function::Atan => "atan",
            Function::Sinh => "sinh",
            Function::Cosh => "cosh",
            Function::Tanh => "tanh",
            Function::Asinh => "asinh",
            Function::Acosh => "acosh",
            Function::Atanh => "atanh",
            Function::Floor => "floor",
            Function::Ceil => "ceil",
            Function::Round => "round",
            Function::Trunc => "trunc",
            Function::Exp => "exp",
            Function::Expm1 => "expm1",
            Function::Sqrt => "sqrt",
            Function::Cbrt => "cbrt",
            Function::Ln => "log",
            Function::Log2 => "log2",
            Function::Log10 => "log10",
            Function::Power => "pow",
            Function::Atan2 => "atan2",
            Function::Min => "min",
            Function::Max => "max",
        }
    }
}

/// How a condition compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compared {
    /// Left below right.
    Less,
    /// Left below or equal to right.
    AtMost,
}

/// A condition.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// Two numbers compared.
    Is(Expr, Compared, Expr),
    /// Both.
    Both(Box<Condition>, Box<Condition>),
}

/// What is asked of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableOf {
    /// Its value.
    Value,
    /// Its slope; 0 beyond its ends.
    Slope,
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Expr {
    /// A finite number.
    Number(f64),
    /// A state, an input, the time, or what a statement has named.
    Name(Rc<str>),
    /// A parameter of the model.
    Parameter(Rc<str>),
    /// The negative.
    Negative(Rc<Expr>),
    /// A sum.
    Sum(Rc<Expr>, Rc<Expr>),
    /// A difference.
    Difference(Rc<Expr>, Rc<Expr>),
    /// A product.
    Product(Rc<Expr>, Rc<Expr>),
    /// A quotient.
    Quotient(Rc<Expr>, Rc<Expr>),
    /// A function of one or two arguments.
    Call(Function, Vec<Expr>),
    /// The first where the condition holds, else the second; the other one is of no account.
    Choice(Rc<Condition>, Rc<Expr>, Rc<Expr>),
    /// A table of the model at a place.
    Table(Rc<str>, TableOf, Rc<Expr>),
}

/// A number as an expression.
pub fn number(x: f64) -> Expr {
    Expr::Number(x)
}

impl From<f64> for Expr {
    fn from(x: f64) -> Expr {
        Expr::Number(x)
    }
}

impl From<&Expr> for Expr {
    fn from(x: &Expr) -> Expr {
        x.clone()
    }
}

impl Expr {
    /// A name as an expression.
    pub fn name(name: &str) -> Expr {
        Expr::Name(name.into())
    }

    /// A function of it.
    pub fn of(&self, function: Function) -> Expr {
        Expr::Call(function, vec![self.clone()])
    }

    /// A function of it and another.
    pub fn with(&self, function: Function, other: impl Into<Expr>) -> Expr {
        Expr::Call(function, vec![self.clone(), other.into()])
    }

    /// Square.
    pub fn squared(&self) -> Expr {
        self * self
    }

    /// To the power of.
    pub fn power(&self, exponent: impl Into<Expr>) -> Expr {
        self.with(Function::Power, exponent)
    }

    /// Not below.
    pub fn at_least(&self, low: impl Into<Expr>) -> Expr {
        self.with(Function::Max, low)
    }

    /// Square root.
    pub fn root(&self) -> Expr {
        self.of(Function::Sqrt)
    }

    /// Itself where the condition holds, else the other.
    pub fn where_holds(&self, condition: Condition, other: impl Into<Expr>) -> Expr {
        Expr::Choice(
            Rc::new(condition),
            Rc::new(self.clone()),
            Rc::new(other.into()),
        )
    }

    /// Whether it is below another.
    pub fn less(&self, other: impl Into<Expr>) -> Condition {
        Condition::Is(self.clone(), Compared::Less, other.into())
    }

    /// Whether it is not above another.
    pub fn at_most(&self, other: impl Into<Expr>) -> Condition {
        Condition::Is(self.clone(), Compared::AtMost, other.into())
    }

    /// Calls `see` with itself and everything in it.
    pub fn walk(&self, see: &mut dyn FnMut(&Expr)) {
        see(self);
        match self {
            Expr::Number(_) | Expr::Name(_) | Expr::Parameter(_) => {}
            Expr::Negative(a) | Expr::Table(_, _, a) => a.walk(see),
            Expr::Sum(a, b)
            | Expr::Difference(a, b)
            | Expr::Product(a, b)
            | Expr::Quotient(a, b) => {
                a.walk(see);
                b.walk(see);
            }
            Expr::Call(_, arguments) => arguments.iter().for_each(|a| a.walk(see)),
            Expr::Choice(condition, a, b) => {
                condition.walk(see);
                a.walk(see);
                b.walk(see);
            }
        }
    }
}

impl Condition {
    /// This one and another.
    pub fn and(self, other: Condition) -> Condition {
        Condition::Both(Box::new(self), Box::new(other))
    }

    /// Calls `see` with every expression in it.
    pub fn walk(&self, see: &mut dyn FnMut(&Expr)) {
        match self {
            Condition::Is(a, _, b) => {
                a.walk(see);
                b.walk(see);
            }
            Condition::Both(a, b) => {
                a.walk(see);
                b.walk(see);
            }
        }
    }
}

/// An operator on every mixture of expressions, references and numbers.
macro_rules! operator {
    ($trait:ident, $method:ident, $kind:ident) => {
        operator!($trait, $method, $kind, Expr, Expr);
        operator!($trait, $method, $kind, &Expr, &Expr);
        operator!($trait, $method, $kind, Expr, &Expr);
        operator!($trait, $method, $kind, &Expr, Expr);
        operator!($trait, $method, $kind, Expr, f64);
        operator!($trait, $method, $kind, &Expr, f64);
        operator!($trait, $method, $kind, f64, Expr);
        operator!($trait, $method, $kind, f64, &Expr);
    };
    ($trait:ident, $method:ident, $kind:ident, $left:ty, $right:ty) => {
        impl $trait<$right> for $left {
            type Output = Expr;

            fn $method(self, other: $right) -> Expr {
                Expr::$kind(Rc::new(Expr::from(self)), Rc::new(Expr::from(other)))
            }
        }
    };
}

operator!(Add, add, Sum);
operator!(Sub, sub, Difference);
operator!(Mul, mul, Product);
operator!(Div, div, Quotient);

impl Neg for Expr {
    type Output = Expr;

    fn neg(self) -> Expr {
        Expr::Negative(Rc::new(self))
    }
}

impl Neg for &Expr {
    type Output = Expr;

    fn neg(self) -> Expr {
        -self.clone()
    }
}
