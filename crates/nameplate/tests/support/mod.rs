//! The catalogue motors, and the prior fitted to them by ordinary least squares.

use nalgebra::{DMatrix, DVector};
use nameplate::catalogue;
use nameplate::plate::{Completed, Plate, VALUES};
use nameplate::prior::{Prior, inertia_terms, mean_terms};

/// A motor of a published catalogue.
#[derive(Clone, Debug)]
pub struct Published {
    pub maker: String,
    pub plate: Plate,
    pub pole_pairs: f64,
    pub inertia_kg_m2: Option<f64>,
}

/// All motors of `data/motors.csv`.
pub fn motors() -> Vec<Published> {
    let table = include_str!("../../data/motors.csv");
    let (header, rows) = catalogue::read(table.as_bytes()).unwrap();
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    let (maker, poles, inertia) = (column("maker"), column("poles"), column("inertia_kg_m2"));
    rows.into_iter()
        .map(|row| Published {
            maker: row.cells[maker].clone(),
            pole_pairs: row.cells[poles].parse::<f64>().unwrap() / 2.0,
            inertia_kg_m2: row.cells[inertia].parse().ok(),
            plate: row.plate.unwrap(),
        })
        .collect()
}

/// Least squares of `y` on the rows of `x`.
fn regression(x: &DMatrix<f64>, y: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
    let solved = x.clone().svd(true, true).solve(y, 1e-12).unwrap();
    let residual = y - x * &solved;
    (solved, residual)
}

fn standard_deviation(residual: &DVector<f64>) -> f64 {
    (residual.norm_squared() / residual.len() as f64).sqrt()
}

/// The prior of these motors.
pub fn fitted_prior(motors: &[Published]) -> Prior {
    let sized = |motor: &Published| motor.plate.power_kw.unwrap().value;
    let values: Vec<_> = motors
        .iter()
        .map(|motor| {
            let completed = Completed::of(&motor.plate, &Prior::REAL_MOTORS).unwrap();
            assert_eq!(completed.known, [true; VALUES]);
            completed.targets.values()
        })
        .collect();
    let x = DMatrix::from_fn(motors.len(), 3, |r, c| mean_terms(sized(&motors[r]))[c]);
    let fits: Vec<_> = (0..VALUES)
        .map(|k| regression(&x, &DVector::from_fn(motors.len(), |r, _| values[r][k])))
        .collect();
    let spread: Vec<f64> = fits.iter().map(|fit| standard_deviation(&fit.1)).collect();
    let correlation = |a: usize, b: usize| {
        fits[a].1.dot(&fits[b].1) / (motors.len() as f64 * spread[a] * spread[b])
    };
    let weighed: Vec<_> = motors
        .iter()
        .filter(|m| m.inertia_kg_m2.is_some())
        .collect();
    let x = DMatrix::from_fn(weighed.len(), 4, |r, c| {
        let frequency = weighed[r].plate.frequency_hz.unwrap().value;
        inertia_terms(sized(weighed[r]), weighed[r].pole_pairs * 50.0 / frequency)[c]
    });
    let y = DVector::from_fn(weighed.len(), |r, _| weighed[r].inertia_kg_m2.unwrap().ln());
    let (inertia, residual) = regression(&x, &y);
    Prior {
        mean: core::array::from_fn(|k| core::array::from_fn(|j| fits[k].0[j])),
        spread: core::array::from_fn(|k| spread[k]),
        correlation: core::array::from_fn(|a| core::array::from_fn(|b| correlation(a, b))),
        between_makers: Prior::REAL_MOTORS.between_makers,
        inertia: core::array::from_fn(|k| inertia[k]),
        inertia_spread: standard_deviation(&residual),
    }
}
