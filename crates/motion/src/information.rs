//! Information about the departures: `H = sum A' R^-1 A` and `b = -sum A' R^-1 z`, and what follows from them.
//!
//! Departures are in units of their priors, rows in units of their noise. Symmetric matrices are kept row by row up to the
//! diagonal.

use crate::departures::UNKNOWNS;

/// Rows of one cycle.
pub const ROWS: usize = 9;
const PACKED: usize = UNKNOWNS * (UNKNOWNS + 1) / 2;

/// A vector of departures.
pub type Vector = [f32; UNKNOWNS];

/// Rows of one cycle in units of their noise: each row's sensitivities, and the row itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct White {
    /// Sensitivities.
    pub sensitivities: [Vector; ROWS],
    /// Rows.
    pub rows: [f32; ROWS],
}

/// A symmetric matrix over the departures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetric([f32; PACKED]);

/// Lower Cholesky factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor(Symmetric);

/// `H` and `b`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Information {
    /// `H`.
    pub matrix: Symmetric,
    /// `b`.
    pub vector: Vector,
}

impl Default for Symmetric {
    fn default() -> Self {
        Symmetric([0.0; PACKED])
    }
}

impl Default for White {
    fn default() -> Self {
        White {
            sensitivities: [[0.0; UNKNOWNS]; ROWS],
            rows: [0.0; ROWS],
        }
    }
}

/// Scalar product over the shorter of the two.
pub fn dot(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn at(x: &[f32], k: usize) -> f32 {
    x.get(k).copied().unwrap_or(0.0)
}

impl Symmetric {
    /// Row `i` up to the diagonal.
    pub fn row(&self, i: usize) -> &[f32] {
        let start = i * (i + 1) / 2;
        self.0.get(start..=start + i).unwrap_or_default()
    }

    fn row_mut(&mut self, i: usize) -> &mut [f32] {
        let start = i * (i + 1) / 2;
        self.0.get_mut(start..=start + i).unwrap_or_default()
    }

    /// `scale` times itself, plus the unit matrix.
    pub fn with_prior(&self, scale: f32) -> Symmetric {
        let mut sum = Symmetric(self.0.map(|x| scale * x));
        for i in 0..UNKNOWNS {
            if let Some(diagonal) = sum.row_mut(i).last_mut() {
                *diagonal += 1.0;
            }
        }
        sum
    }

    /// Sum of two matrices.
    pub fn plus(&self, other: &Symmetric) -> Symmetric {
        let mut sum = *self;
        for (x, y) in sum.0.iter_mut().zip(&other.0) {
            *x += y;
        }
        sum
    }

    /// Product with a vector.
    #[inline(never)]
    pub fn times(&self, v: &Vector) -> Vector {
        let mut product = [0.0; UNKNOWNS];
        for (i, x) in v.iter().enumerate() {
            let row = self.row(i);
            let own = dot(row, v);
            for (p, h) in product.iter_mut().zip(row.get(..i).unwrap_or_default()) {
                *p += h * x;
            }
            if let Some(p) = product.get_mut(i) {
                *p += own;
            }
        }
        product
    }

    /// Cholesky factor of a positive definite matrix; where rounding leaves nothing of a diagonal it keeps a rounding's share.
    #[inline(never)]
    pub fn factorise(&self) -> Factor {
        /// What single precision leaves of a variance that others explain.
        const LEAST_SHARE: f32 = 1e-6;
        let mut lower = Symmetric::default();
        for i in 0..UNKNOWNS {
            let mut row = [0.0; UNKNOWNS];
            for j in 0..i {
                let above = lower.row(j);
                let before = above.get(..j).unwrap_or_default();
                let x = (at(self.row(i), j) - dot(before, &row)) / at(above, j);
                if let Some(place) = row.get_mut(j) {
                    *place = x;
                }
            }
            let diagonal = at(self.row(i), i);
            let own = (diagonal - dot(&row, &row)).max(LEAST_SHARE * diagonal + f32::MIN_POSITIVE);
            if let Some(place) = row.get_mut(i) {
                *place = libm::sqrtf(own);
            }
            for (place, x) in lower.row_mut(i).iter_mut().zip(row) {
                *place = x;
            }
        }
        Factor(lower)
    }
}

impl Factor {
    /// `L^-1 x`.
    pub fn whiten(&self, x: &Vector) -> Vector {
        let mut white = [0.0; UNKNOWNS];
        for (i, x) in x.iter().enumerate() {
            let row = self.0.row(i);
            let known = dot(row.get(..i).unwrap_or_default(), &white);
            if let Some(place) = white.get_mut(i) {
                *place = (x - known) / at(row, i);
            }
        }
        white
    }

    /// `(L L')^-1 x`.
    #[inline(never)]
    pub fn solve(&self, x: &Vector) -> Vector {
        let mut solution = self.whiten(x);
        for i in (0..UNKNOWNS).rev() {
            let row = self.0.row(i);
            let own = at(&solution, i) / at(row, i);
            if let Some(place) = solution.get_mut(i) {
                *place = own;
            }
            for (s, l) in solution.iter_mut().zip(row.get(..i).unwrap_or_default()) {
                *s -= l * own;
            }
        }
        solution
    }
}

impl Information {
    /// Adds one cycle.
    #[inline(never)]
    pub fn add(&mut self, cycle: &White) {
        for (a, z) in cycle.sensitivities.iter().zip(cycle.rows) {
            for (i, x) in a.iter().enumerate().filter(|(_, x)| **x != 0.0) {
                for (h, y) in self.matrix.row_mut(i).iter_mut().zip(a) {
                    *h += x * y;
                }
            }
            for (b, x) in self.vector.iter_mut().zip(a) {
                *b -= x * z;
            }
        }
    }

    /// Forgets all but a share.
    pub fn fade(&mut self, keep: f32) {
        for x in self.matrix.0.iter_mut().chain(&mut self.vector) {
            *x *= keep;
        }
    }

    /// Adds what another one knows.
    pub fn merge(&mut self, other: &Information) {
        self.matrix = self.matrix.plus(&other.matrix);
        for (x, y) in self.vector.iter_mut().zip(other.vector) {
            *x += y;
        }
    }

    /// What it would have been had departure `k` been counted from a point `delta` further on.
    pub fn shift(&mut self, k: usize, delta: f32) {
        let mut unit = [0.0; UNKNOWNS];
        if let Some(x) = unit.get_mut(k) {
            *x = delta;
        }
        for (b, moved) in self.vector.iter_mut().zip(self.matrix.times(&unit)) {
            *b -= moved;
        }
    }
}
