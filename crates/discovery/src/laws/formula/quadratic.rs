//! What a refitted curve costs to bend: its normal equations with all other coordinates projected out.

use estimation::fit::normal_equations;
use estimation::fit::output_error::Fit;
use nalgebra::{DMatrix, DVector};

/// Squared error over the modes of a law, every other coordinate at its best.
#[derive(Clone, Debug)]
pub(crate) struct Quadratic {
    /// Error `s(z) = least - 2 score'(z - here) + (z - here)' gram (z - here)`.
    pub gram: DMatrix<f64>,
    /// Half the fall of the error with the modes.
    pub score: DVector<f64>,
    /// Error where the modes are.
    pub least: f64,
    /// The modes of the fit.
    pub here: DVector<f64>,
    /// Step of the other coordinates where the modes are, and how it changes with them.
    others: (DVector<f64>, DMatrix<f64>),
}

/// Rows and columns of a matrix.
fn part(m: &DMatrix<f64>, rows: &[usize], columns: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), columns.len(), |a, b| m[(rows[a], columns[b])])
}

impl Quadratic {
    /// Of a fit whose coordinates `modes` (positions among the free ones) are a law's. The modes' own priors are left
    /// out: a formula has none.
    pub fn of(fit: &Fit, modes: &[usize]) -> Option<Self> {
        let all = normal_equations::total(&fit.blocks);
        let rest: Vec<usize> = (0..fit.free.len()).filter(|k| !modes.contains(k)).collect();
        let at = |k: &usize| fit.hypothesis.z[fit.free[*k]];
        let (weight, pull) = (&fit.penalty.weight, &fit.penalty.pull);
        let score = |k: &usize| all.score[*k] + weight[*k] * pull[*k];
        let mut own = part(&all.gram, &rest, &rest);
        for (n, k) in rest.iter().enumerate() {
            own[(n, n)] += weight[*k] + f64::MIN_POSITIVE;
        }
        let own = nalgebra::Cholesky::new(own)?;
        let cross = part(&all.gram, &rest, modes);
        let score_rest = DVector::from_iterator(rest.len(), rest.iter().map(score));
        let step = own.solve(&score_rest);
        let follows = own.solve(&cross);
        let pulls: f64 = rest.iter().map(|k| weight[*k] * pull[*k].powi(2)).sum();
        let score_modes = DVector::from_iterator(modes.len(), modes.iter().map(|k| all.score[*k]));
        Some(Self {
            gram: part(&all.gram, modes, modes) - cross.transpose() * &follows,
            score: score_modes - cross.transpose() * &step,
            least: all.sse + pulls - score_rest.dot(&step),
            here: DVector::from_iterator(modes.len(), modes.iter().map(at)),
            others: (step, follows),
        })
    }

    /// Of modes beside which nothing else moves.
    #[cfg(test)]
    pub fn bare(gram: DMatrix<f64>, score: DVector<f64>, least: f64, here: DVector<f64>) -> Self {
        Self {
            others: (DVector::zeros(0), DMatrix::zeros(0, here.len())),
            gram,
            score,
            least,
            here,
        }
    }

    /// Best amplitudes of terms that are columns of modes, and the squared error with them.
    pub fn best(&self, terms: &DMatrix<f64>) -> Option<(DVector<f64>, f64)> {
        let bent = &self.gram * terms;
        let mut normal = terms.transpose() * &bent;
        let mean = normal.trace() / normal.nrows() as f64;
        for k in 0..normal.nrows() {
            normal[(k, k)] += 1e-9 * mean + f64::MIN_POSITIVE;
        }
        let wanted = terms.transpose() * (&self.score + &self.gram * &self.here);
        let sizes = nalgebra::Cholesky::new(normal)?.solve(&wanted);
        let step = terms * &sizes - &self.here;
        let error = self.least - 2.0 * self.score.dot(&step) + step.dot(&(&self.gram * &step));
        error.is_finite().then_some((sizes, error))
    }

    /// Step of the other coordinates for modes `z`.
    pub fn others(&self, z: &DVector<f64>) -> DVector<f64> {
        &self.others.0 - &self.others.1 * (z - &self.here)
    }
}
