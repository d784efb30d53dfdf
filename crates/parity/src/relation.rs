//! The general parity method (5)-(10) for any linear model.
//!
//! ```text
//! x' = A x + B u,  y = C x                                                   (5), (6)
//! Y  = [y; y'; y''; ...] = T x + Q_u U,   U = [u; u'; u''; ...]              (7), (8)
//! r  = W (Y - Q_u U)  with  W T = 0                                          (9), (10)
//! ```

use crate::linear_plant::LinearParams;
use nalgebra::{DMatrix, DVector};

/// A parity relation of a given order: `T`, `Q_u` and a basis `W` of the left null space of `T`.
#[derive(Clone, Debug, PartialEq)]
pub struct Parity {
    t: DMatrix<f64>,
    q_u: DMatrix<f64>,
    w: DMatrix<f64>,
}

/// Why there is no parity relation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParityError {
    /// The matrices do not fit together: A must be n x n, B n x m and C p x n.
    Dimensions,
    /// `T` has no left null space: no redundancy at this order.
    NoRedundancy {
        /// The order asked for; a higher one may have redundancy.
        order: usize,
    },
}

impl std::fmt::Display for ParityError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            ParityError::Dimensions => {
                write!(f, "matrices do not fit: A must be n x n, B n x m, C p x n")
            }
            ParityError::NoRedundancy { order } => {
                write!(f, "no redundancy at order {order}: raise the order")
            }
        }
    }
}

impl std::error::Error for ParityError {}

impl Parity {
    /// The parity relation with derivatives up to `order`. `W` has orthonormal rows when every row of `T`
    /// is measured in units of its own length.
    ///
    /// # Errors
    /// Matrices that do not fit together, or an order at which nothing is redundant.
    pub fn new(
        a: &DMatrix<f64>,
        b: &DMatrix<f64>,
        c: &DMatrix<f64>,
        order: usize,
    ) -> Result<Parity, ParityError> {
        let n = a.nrows();
        if a.ncols() != n || b.nrows() != n || c.ncols() != n {
            return Err(ParityError::Dimensions);
        }
        let t = observability(a, c, order);
        let q_u = input_response(&t, b, c.nrows(), order);
        let w = left_null_space(&t);
        if w.nrows() == 0 {
            return Err(ParityError::NoRedundancy { order });
        }
        Ok(Parity { t, q_u, w })
    }

    /// `T = [C; CA; CA^2; ...]` (8).
    pub fn t(&self) -> &DMatrix<f64> {
        &self.t
    }

    /// `Q_u`: what the inputs and their derivatives add to the outputs and theirs (8).
    pub fn q_u(&self) -> &DMatrix<f64> {
        &self.q_u
    }

    /// `W` with `W T = 0` (10).
    pub fn w(&self) -> &DMatrix<f64> {
        &self.w
    }

    /// Residuals `r = W (Y - Q_u U)` (9) of stacked outputs and inputs with their derivatives.
    pub fn residuals(&self, y: &DVector<f64>, u: &DVector<f64>) -> DVector<f64> {
        &self.w * (y - &self.q_u * u)
    }
}

fn observability(a: &DMatrix<f64>, c: &DMatrix<f64>, order: usize) -> DMatrix<f64> {
    let p = c.nrows();
    let mut t = DMatrix::zeros(p * (order + 1), a.ncols());
    let mut block = c.clone();
    for i in 0..=order {
        t.rows_mut(i * p, p).copy_from(&block);
        block = &block * a;
    }
    t
}

/// Block `(i, j)` is `C A^(i-j-1) B` below the diagonal and zero elsewhere.
fn input_response(t: &DMatrix<f64>, b: &DMatrix<f64>, p: usize, order: usize) -> DMatrix<f64> {
    let m = b.ncols();
    let mut q_u = DMatrix::zeros(t.nrows(), m * (order + 1));
    for i in 1..=order {
        for j in 0..i {
            let markov = t.rows((i - j - 1) * p, p) * b;
            q_u.view_mut((i * p, j * m), (p, m)).copy_from(&markov);
        }
    }
    q_u
}

/// Rows that span the left null space, by a singular value decomposition.
///
/// Rows of `T` differ by powers of the plant's fastest rate, so both sides are scaled to unit length
/// first: the null space keeps its digits and a small state is not taken for a redundant one.
fn left_null_space(t: &DMatrix<f64>) -> DMatrix<f64> {
    let rows = t.nrows();
    let mut scaled = DMatrix::zeros(rows, rows.max(t.ncols()));
    let lengths: Vec<f64> = t.row_iter().map(|row| length(row.norm())).collect();
    for (i, row) in t.row_iter().enumerate() {
        scaled
            .view_mut((i, 0), (1, t.ncols()))
            .copy_from(&(row / lengths[i]));
    }
    for mut column in scaled.column_iter_mut() {
        let norm = length(column.norm());
        column /= norm;
    }
    // Square by zero columns, so that the decomposition returns all left singular vectors.
    let svd = scaled.svd(true, false);
    let tolerance = svd.singular_values.max() * rows as f64 * f64::EPSILON;
    let u = svd.u.unwrap_or_else(|| DMatrix::zeros(rows, 0));
    let null: Vec<_> = (0..u.ncols())
        .filter(|&i| svd.singular_values[i] <= tolerance)
        .map(|i| u.column(i).transpose())
        .collect();
    let mut w = DMatrix::from_fn(null.len(), rows, |i, j| null[i][j]);
    for (mut column, length) in w.column_iter_mut().zip(lengths) {
        column /= length;
    }
    w
}

/// A divisor for scaling: a vector without length stays as it is.
fn length(norm: f64) -> f64 {
    if norm > 0.0 { norm } else { 1.0 }
}

/// The published null space (35) of the linear model (33) at order 2, with state `[I_q, w_r]` measured
/// and rows in the order r1..r4; columns `I_q, w_r, I_q', w_r', I_q'', w_r''`.
pub fn published_w(p: &LinearParams) -> DMatrix<f64> {
    let (r_a, l_a, j, b_t) = (p.r_a(), p.l_a(), p.inertia, p.b_t());
    let torque_per_amp = p.k_f() * p.n_p;
    let k1 = p.psi() * torque_per_amp + r_a * b_t;
    let k2 = l_a * b_t + j * r_a;
    #[rustfmt::skip]
    let w = DMatrix::from_row_slice(4, 6, &[
        r_a,             p.psi(), l_a, 0.0, 0.0,     0.0,
        -torque_per_amp, b_t,     0.0, j,   0.0,     0.0,
        k1,              0.0,     k2,  0.0, j * l_a, 0.0,
        0.0,             k1,      0.0, k2,  0.0,     j * l_a,
    ]); // (35)
    w
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Seeded: the same machines in every run.
    fn seeded() -> ProptestConfig {
        ProptestConfig {
            cases: 4000,
            rng_seed: proptest::test_runner::RngSeed::Fixed(8372),
            ..ProptestConfig::default()
        }
    }

    fn plants() -> impl Strategy<Value = LinearParams> {
        (
            (0.1..20.0_f64, 0.1..20.0_f64, 0.01..1.0_f64, 0.01..1.0_f64),
            (0.02..0.3_f64, 1.0..4.0_f64, 1e-3..1.0_f64),
            (1e-4..1e-1_f64, 1e-4..1e-1_f64, 0.1..10.0_f64),
        )
            .prop_map(
                |((r_s, r_r, l_s, l_r), (sigma, n_p, inertia), rest)| LinearParams {
                    r_s,
                    r_r,
                    l_s,
                    l_r,
                    l_m: (l_s * l_r * (1.0 - sigma)).sqrt(),
                    sigma,
                    n_p,
                    inertia,
                    friction: rest.0,
                    load_friction: rest.1,
                    field_current: rest.2,
                },
            )
    }

    fn parity(p: &LinearParams) -> Parity {
        let a = DMatrix::from_column_slice(2, 2, p.a().as_slice());
        let b = DMatrix::from_column_slice(2, 1, p.b().as_slice());
        Parity::new(&a, &b, &DMatrix::identity(2, 2), 2).expect("redundant")
    }

    /// Each row of a product over the product of the magnitudes: cancellation to rounding and no more.
    fn relative(w: &DMatrix<f64>, t: &DMatrix<f64>) -> f64 {
        let (product, scale) = (w * t, w.abs() * t.abs());
        product
            .iter()
            .zip(scale.iter())
            .map(|(x, s)| x.abs() / s.max(f64::MIN_POSITIVE))
            .fold(0.0, f64::max)
    }

    /// `W` for outputs measured in units of the length of their row of `T`.
    fn in_units_of_t(w: &DMatrix<f64>, t: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(w.nrows(), w.ncols(), |i, j| w[(i, j)] * t.row(j).norm())
    }

    /// Outputs and inputs with their derivatives, consistent with (33): for any state, input and slopes.
    fn stacked(p: &LinearParams, x: [f64; 2], u: [f64; 3]) -> (DVector<f64>, DVector<f64>) {
        let rate = |i: f64, w: f64, v: f64| {
            [
                (v - p.r_a() * i - p.psi() * w) / p.l_a(),       // (33)
                (p.k_f() * p.n_p * i - p.b_t() * w) / p.inertia, // (33)
            ]
        };
        let first = rate(x[0], x[1], u[0]);
        let second = rate(first[0], first[1], u[1]);
        let y = [x[0], x[1], first[0], first[1], second[0], second[1]];
        (DVector::from_row_slice(&y), DVector::from_row_slice(&u))
    }

    /// Largest residual relative to the sum of the magnitudes of its terms.
    fn residual(w: &DMatrix<f64>, q_u: &DMatrix<f64>, y: &DVector<f64>, u: &DVector<f64>) -> f64 {
        let r = w * y - w * q_u * u;
        let scale = w.abs() * y.abs() + w.abs() * q_u.abs() * u.abs();
        r.iter()
            .zip(scale.iter())
            .map(|(r, s)| r.abs() / s)
            .fold(0.0, f64::max)
    }

    proptest! {
        #![proptest_config(seeded())]

        #[test]
        fn the_null_space_annihilates_t(p in plants()) {
            let parity = parity(&p);
            prop_assert_eq!(parity.w().nrows(), 4);
            prop_assert!(relative(parity.w(), parity.t()) < 1e-13);
            let scaled = in_units_of_t(parity.w(), parity.t());
            let gram = &scaled * scaled.transpose();
            prop_assert!((gram - DMatrix::identity(4, 4)).norm() < 1e-13);
        }

        /// (35): the published `W` annihilates `T` and spans the same space as the computed one.
        #[test]
        fn the_published_null_space_is_a_null_space(p in plants()) {
            let parity = parity(&p);
            let published = published_w(&p);
            prop_assert!(relative(&published, parity.t()) < 1e-14);
            let w = in_units_of_t(&published, parity.t());
            let basis = in_units_of_t(parity.w(), parity.t());
            let inside = &w * basis.transpose() * &basis;
            for row in 0..4 {
                let off = (w.row(row) - inside.row(row)).norm();
                prop_assert!(off < 1e-13 * w.row(row).norm(), "row {} is off by {}", row, off);
            }
            let unit = DMatrix::from_fn(4, 6, |i, j| w[(i, j)] / w.row(i).norm());
            prop_assert_eq!(unit.rank(1e-12), 4);
        }

        #[test]
        fn residuals_vanish_on_every_consistent_motion(
            p in plants(), i in -10.0..10.0_f64, w in -300.0..300.0_f64,
            v in -300.0..300.0_f64, dv in -1e4..1e4_f64, ddv in -1e6..1e6_f64
        ) {
            let (y, u) = stacked(&p, [i, w], [v, dv, ddv]);
            let parity = parity(&p);
            prop_assert!(residual(&published_w(&p), parity.q_u(), &y, &u) < 1e-12);
            prop_assert!(residual(parity.w(), parity.q_u(), &y, &u) < 1e-12);
        }

        /// Erratum of (36): its rows 3 and 4 print `L_a k2 d/dt`; with that factor they do not vanish.
        #[test]
        fn the_printed_rows_of_36_are_no_parity_relation(p in plants()) {
            prop_assume!((p.l_a() - 1.0).abs() > 0.01);
            let mut printed = published_w(&p);
            printed[(2, 2)] *= p.l_a();
            printed[(3, 3)] *= p.l_a();
            let (y, u) = stacked(&p, [1.0, 100.0], [150.0, 0.0, 0.0]);
            let q_u = parity(&p).q_u().clone();
            let r = &printed * &y - published_w(&p) * &q_u * &u;
            let missing = published_w(&p)[(2, 2)] * (p.l_a() - 1.0) * y[2];
            let scale = (published_w(&p).abs() * y.abs())[2];
            prop_assert!((r[2] - missing).abs() < 1e-12 * scale);
            prop_assert!(relative(&printed, parity(&p).t()) > 1e-6);
        }

        /// Erratum of (34): row 5 of `T` begins with `R_a^2/L_a^2 - Psi K_f N_p/(J L_a)`; printed without J.
        #[test]
        fn row_5_of_34_needs_its_j(p in plants()) {
            let (r_a, l_a, psi) = (p.r_a(), p.l_a(), p.psi());
            let torque_per_amp = p.k_f() * p.n_p;
            let resistive = (r_a / l_a).powi(2);
            let corrected = resistive - psi * torque_per_amp / (p.inertia * l_a);
            let printed = resistive - psi * torque_per_amp / l_a;
            let row_5 = parity(&p).t()[(4, 0)];
            let scale = resistive + psi * torque_per_amp / (p.inertia * l_a);
            prop_assert!((row_5 - corrected).abs() < 1e-13 * scale);
            let gap = psi * torque_per_amp / l_a * (1.0 / p.inertia - 1.0);
            prop_assert!(((printed - row_5) - gap).abs() < 1e-12 * scale);
        }

        /// In steady state (37): r3 = B_t r1 - Psi r2 and r4 = K_f N_p r1 + R_a r2 for ANY measurement.
        #[test]
        fn four_residuals_carry_two_numbers(
            p in plants(), i in -10.0..10.0_f64, w in -300.0..300.0_f64, v in -300.0..300.0_f64
        ) {
            let torque_per_amp = p.k_f() * p.n_p;
            let y = DVector::from_row_slice(&[i, w, 0.0, 0.0, 0.0, 0.0]);
            let u = DVector::from_row_slice(&[v, 0.0, 0.0]);
            let r = published_w(&p) * (y - parity(&p).q_u() * u);
            let r1 = p.r_a() * i + p.psi() * w - v;
            let r2 = -torque_per_amp * i + p.b_t() * w;
            let scale = (torque_per_amp + p.r_a() + p.b_t() + p.psi()) * (r1.abs() + r2.abs() + v.abs()
                + p.r_a() * i.abs() + p.psi() * w.abs() + torque_per_amp * i.abs());
            for (k, expected) in [r1, r2, p.b_t() * r1 - p.psi() * r2, torque_per_amp * r1 + p.r_a() * r2]
                .into_iter()
                .enumerate()
            {
                prop_assert!((r[k] - expected).abs() < 1e-12 * scale, "r{}", k + 1);
            }
        }
    }

    #[test]
    fn what_cannot_be_a_parity_relation_is_refused() {
        let eye = DMatrix::identity(2, 2);
        let wide = DMatrix::zeros(2, 3);
        let narrow = DMatrix::from_row_slice(1, 2, &[1.0, 0.0]);
        let coupled = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, 0.0]);
        let b = DMatrix::zeros(2, 1);
        assert_eq!(
            Parity::new(&wide, &b, &eye, 1),
            Err(ParityError::Dimensions)
        );
        // One output of two states: redundant only from the second derivative on.
        let order = |order| Parity::new(&coupled, &b, &narrow, order);
        assert_eq!(order(1), Err(ParityError::NoRedundancy { order: 1 }));
        assert_eq!(order(2).map(|parity| parity.w().nrows()), Ok(1));
    }
}
