//! Space vectors of expressions, amplitude-invariant.

use super::{Expr, Function, number};
use std::ops::{Add, Mul, Sub};

/// A space vector: alpha (d) and beta (q) component.
#[derive(Clone, Debug, PartialEq)]
pub struct Vector {
    /// Real part.
    pub re: Expr,
    /// Imaginary part.
    pub im: Expr,
}

impl Vector {
    /// From its parts.
    pub fn new(re: impl Into<Expr>, im: impl Into<Expr>) -> Vector {
        Vector {
            re: re.into(),
            im: im.into(),
        }
    }

    /// Nothing.
    pub fn zero() -> Vector {
        Vector::new(0.0, 0.0)
    }

    /// The conjugate.
    pub fn conj(&self) -> Vector {
        Vector::new(&self.re, -&self.im)
    }

    /// Square of the length.
    pub fn squared(&self) -> Expr {
        self.re.squared() + self.im.squared()
    }

    /// Length.
    pub fn length(&self) -> Expr {
        self.squared().root()
    }

    /// Angle, rad.
    pub fn angle(&self) -> Expr {
        self.im.with(Function::Atan2, &self.re)
    }

    /// The same turned by a quarter forward, times `x`.
    pub fn quarter(&self, x: impl Into<Expr>) -> Vector {
        let x = x.into();
        Vector::new(-(&self.im * &x), &self.re * x)
    }

    /// The length in the direction of this angle, rad.
    pub fn polar(length: &Expr, angle: &Expr) -> Vector {
        Vector::new(
            length * angle.of(Function::Cos),
            length * angle.of(Function::Sin),
        )
    }

    /// Product as complex numbers.
    pub fn times(&self, other: &Vector) -> Vector {
        Vector::new(
            &self.re * &other.re - &self.im * &other.im,
            &self.re * &other.im + &self.im * &other.re,
        )
    }
}

impl Add for &Vector {
    type Output = Vector;

    fn add(self, other: &Vector) -> Vector {
        Vector::new(&self.re + &other.re, &self.im + &other.im)
    }
}

impl Sub for &Vector {
    type Output = Vector;

    fn sub(self, other: &Vector) -> Vector {
        Vector::new(&self.re - &other.re, &self.im - &other.im)
    }
}

impl Mul<&Expr> for &Vector {
    type Output = Vector;

    fn mul(self, x: &Expr) -> Vector {
        Vector::new(&self.re * x, &self.im * x)
    }
}

/// Space vector of three phase quantities.
pub fn clarke([a, b, c]: &[Expr; 3]) -> Vector {
    Vector::new((2.0 * a - b - c) / 3.0, (b - c) / number(3.0).root())
}

/// Phase quantities of a space vector without zero sequence.
pub fn phases(x: &Vector) -> [Expr; 3] {
    let across = 0.5 * number(3.0).root() * &x.im;
    [x.re.clone(), -0.5 * &x.re + &across, -0.5 * &x.re - &across]
}
