//! Normal equations of a few columns.

/// The lower half of the columns' scalar products, summed over rows.
pub(crate) fn normal<const N: usize>(rows: &[[f64; N]]) -> [[f64; N]; N] {
    let mut matrix = [[0.0; N]; N];
    for row in rows {
        for (i, line) in matrix.iter_mut().enumerate() {
            for (j, entry) in line.iter_mut().enumerate().take(i + 1) {
                *entry += row[i] * row[j];
            }
        }
    }
    matrix
}

/// Lower factor of a symmetric matrix of which the lower half is given. `None` where the columns before a column leave this share
/// of it or less.
pub(crate) fn cholesky<const N: usize>(a: [[f64; N]; N], share: f64) -> Option<[[f64; N]; N]> {
    let mut l = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..=i {
            let dot: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            let left = a[i][j] - dot;
            if i == j {
                if left.is_nan() || left <= share * a[i][i] {
                    return None;
                }
                l[i][i] = left.sqrt();
            } else {
                l[i][j] = left / l[j][j];
            }
        }
    }
    Some(l)
}

/// Solves `L L' y = x`.
pub(crate) fn solve<const N: usize>(l: &[[f64; N]; N], mut x: [f64; N]) -> [f64; N] {
    for i in 0..N {
        let dot: f64 = (0..i).map(|k| l[i][k] * x[k]).sum();
        x[i] = (x[i] - dot) / l[i][i];
    }
    for i in (0..N).rev() {
        let dot: f64 = (i + 1..N).map(|k| l[k][i] * x[k]).sum();
        x[i] = (x[i] - dot) / l[i][i];
    }
    x
}
