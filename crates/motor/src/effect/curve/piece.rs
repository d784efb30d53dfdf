//! One piece of a cubic spline.

use num_traits::Float;

/// Value of the cubic piece from `x0` to `x1` at `x`.
#[inline]
pub(super) fn piece<F: Float>([x0, x1]: [F; 2], [y0, y1]: [F; 2], [m0, m1]: [F; 2], x: F) -> F {
    let six = F::one() + F::one() + F::one() + F::one() + F::one() + F::one();
    let h = x1 - x0;
    let (a, b) = ((x1 - x) / h, (x - x0) / h);
    let bend = (a * a * a - a) * m0 + (b * b * b - b) * m1;
    a * y0 + b * y1 + bend * h * h / six
}
