//! Cubic splines through knots: bends from the knots, and one piece at a time. On hosts dense tables, too, for inner loops.
//!
//! ```
//! let straight = spline::piece([0.0, 2.0], [1.0, 5.0], [0.0, 0.0], 0.5);
//! assert_eq!(straight, 2.0);
//! ```

#![cfg_attr(not(any(test, feature = "std")), no_std)]

#[cfg(any(test, feature = "std"))]
mod curve;
#[cfg(any(test, feature = "std"))]
mod hermite;
#[cfg(any(test, feature = "std"))]
mod solved;
#[cfg(any(test, feature = "std"))]
mod table;

#[cfg(any(test, feature = "std"))]
pub use curve::{Spline, bends};
#[cfg(any(test, feature = "std"))]
pub use hermite::Hermite;
#[cfg(any(test, feature = "std"))]
pub use solved::{Known, Solved};
#[cfg(any(test, feature = "std"))]
pub use table::{TABLE_POINTS, Table, tabulated, traced};

use num_traits::Float;

/// Value at `x` of the cubic piece from `x0` to `x1` with the values `y0`, `y1` and the second derivatives `m0`, `m1` there.
#[inline]
pub fn piece<F: Float>([x0, x1]: [F; 2], [y0, y1]: [F; 2], [m0, m1]: [F; 2], x: F) -> F {
    let six = F::one() + F::one() + F::one() + F::one() + F::one() + F::one();
    let h = x1 - x0;
    let (a, b) = ((x1 - x) / h, (x - x0) / h);
    let bend = (a * a * a - a) * m0 + (b * b * b - b) * m1;
    a * y0 + b * y1 + bend * h * h / six
}
