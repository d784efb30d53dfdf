//! Information about the departures: `H = sum A' R^-1 A` and `b = -sum A' R^-1 z`, and what follows from them.
//!
//! Departures are in units of their priors, rows in units of their noise. Symmetric matrices are kept row by row up to the
//! diagonal.

use crate::departures::UNKNOWNS;

/// Rows of one cycle.
pub const ROWS: usize = 9;
const PACKED: usize = UNKNOWNS * (UNKNOWNS + 1) / 2;

/// Vectors that are whitened at once: all causes in three turns, and the processor's registers hold them.
pub const ABREAST: usize = 6;

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

/// Lower Cholesky factor, in the place of the matrix that it is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor<'a>(&'a Symmetric);

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
///
/// Four sums side by side: a processor need not wait for one addition to begin the next.
#[inline]
pub fn dot(a: &[f32], b: &[f32]) -> f32 {
    let length = a.len().min(b.len());
    let [a, b] = [a, b].map(|x| x.get(..length).unwrap_or_default());
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let [mut s, mut t, mut u, mut v] = [0.0; 4];
    for ([a, b, c, d], [e, f, g, h]) in a.iter().zip(b) {
        s += a * e;
        t += b * f;
        u += c * g;
        v += d * h;
    }
    let rest: f32 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
    (s + t) + (u + v) + rest
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
        let mut sum = *self;
        for x in &mut sum.0 {
            *x *= scale;
        }
        for i in 0..UNKNOWNS {
            if let Some(diagonal) = sum.row_mut(i).last_mut() {
                *diagonal += 1.0;
            }
        }
        sum
    }

    /// Adds another one.
    pub fn add(&mut self, other: &Symmetric) {
        for (x, y) in self.0.iter_mut().zip(&other.0) {
            *x += y;
        }
    }

    /// Adds some columns that follow each other: the product with a vector of ones there and noughts elsewhere.
    #[inline(never)]
    pub fn add_columns(&self, first: usize, count: usize, sum: &mut Vector) {
        for column in first..first + count {
            for (x, h) in sum.iter_mut().zip(self.row(column)) {
                *x += h;
            }
            // Below the diagonal, each a row further on.
            let mut place = (column + 1) * (column + 2) / 2 + column;
            for (i, x) in sum.iter_mut().enumerate().skip(column + 1) {
                *x += at(&self.0, place);
                place += i + 1;
            }
        }
    }

    /// Cholesky factor of a positive definite matrix; where rounding leaves nothing of a diagonal it keeps a rounding's share.
    #[inline(never)]
    pub fn factorise(&mut self) -> Factor<'_> {
        /// What single precision leaves of a variance that others explain.
        const LEAST_SHARE: f32 = 1e-6;
        for i in 0..UNKNOWNS {
            let (done, rest) = self
                .0
                .split_at_mut_checked(i * (i + 1) / 2)
                .unwrap_or_default();
            let row = rest.get_mut(..=i).unwrap_or_default();
            let mut above = &*done;
            for j in 0..i {
                let (own, further) = above.split_at_checked(j + 1).unwrap_or_default();
                above = further;
                let (before, here) = row.split_at_mut_checked(j).unwrap_or_default();
                if let (Some(x), Some(diagonal)) = (here.first_mut(), own.last()) {
                    *x = (*x - dot(own, before)) / diagonal;
                }
            }
            if let Some((diagonal, before)) = row.split_last_mut() {
                let least = LEAST_SHARE * *diagonal + f32::MIN_POSITIVE;
                *diagonal = processor::sqrtf((*diagonal - dot(before, before)).max(least));
            }
        }
        Factor(self)
    }
}

impl Factor<'_> {
    /// `L^-1 x` of a vector whose entries before the `first` are nought.
    #[inline(never)]
    pub fn whiten(&self, x: &Vector, first: usize) -> Vector {
        let mut white = [0.0; UNKNOWNS];
        for (i, x) in x.iter().enumerate().skip(first) {
            let row = self.0.row(i);
            let span = first..i;
            let earlier = white.get(span.clone()).unwrap_or_default();
            let known = dot(row.get(span).unwrap_or_default(), earlier);
            if let Some(place) = white.get_mut(i) {
                *place = (x - known) / at(row, i);
            }
        }
        white
    }

    /// Squared lengths of `L^-1 x` of vectors side by side, whose entries before the `first` are nought: each entry of the
    /// factor is fetched once for all of them. The vectors become `L^-1 x`.
    #[inline(never)]
    pub fn squared_lengths(
        &self,
        side_by_side: &mut [[f32; ABREAST]; UNKNOWNS],
        first: usize,
    ) -> [f32; ABREAST] {
        let mut squares = [0.0; ABREAST];
        for i in first..UNKNOWNS {
            let (earlier, rest) = side_by_side.split_at_mut_checked(i).unwrap_or_default();
            let (Some((diagonal, row)), Some(x)) = (self.0.row(i).split_last(), rest.first_mut())
            else {
                continue;
            };
            // One by one, so that they stay in registers.
            let [mut a, mut b, mut c, mut d, mut e, mut f] = *x;
            let earlier = earlier.get(first..).unwrap_or_default();
            for (l, [p, q, r, s, t, u]) in row.get(first..).unwrap_or_default().iter().zip(earlier)
            {
                a -= l * p;
                b -= l * q;
                c -= l * r;
                d -= l * s;
                e -= l * t;
                f -= l * u;
            }
            let per = 1.0 / diagonal;
            *x = [a, b, c, d, e, f].map(|x| x * per);
            for (square, x) in squares.iter_mut().zip(*x) {
                *square += x * x;
            }
        }
        squares
    }

    /// `(L L')^-1 x`.
    #[inline(never)]
    pub fn solve(&self, x: &Vector) -> Vector {
        let mut solution = self.whiten(x, 0);
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
    /// What one cycle knows.
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
        self.matrix.add(&other.matrix);
        for (x, y) in self.vector.iter_mut().zip(other.vector) {
            *x += y;
        }
    }

    /// What it would have been had departure `k` been counted from a point `delta` further on.
    pub fn shift(&mut self, k: usize, delta: f32) {
        let mut column = [0.0; UNKNOWNS];
        self.matrix.add_columns(k, 1, &mut column);
        for (b, moved) in self.vector.iter_mut().zip(column) {
            *b -= delta * moved;
        }
    }
}
