//! The Cramer-Rao bound: the inverse of the information that a window has on everything unknown together.

use nalgebra::{DMatrix, DVector};

use crate::plant::{MEASURED, Plant, UNKNOWNS, Unknown};

/// Unknown shares; behind them lies the state.
const SHARES: usize = Unknown::ALL.len();
/// Step of the derivatives, as a share.
const STEP: f64 = 1e-5;

/// Standard deviations of a fault's size, as a share.
pub struct Bound {
    /// With every other constant known: what the noise of one window leaves.
    pub noise: f64,
    /// With what a calibration leaves open.
    pub with_open: f64,
    /// Standard deviations at which FAULT lights.
    pub significance: f64,
    /// What opens the bound most.
    pub most: &'static str,
}

/// Of this fault in one window; `None` where nothing is told of it.
pub fn of(plant: &Plant, fault: Unknown) -> Option<Bound> {
    let information = Information::of(plant);
    let nothing = [0.0; SHARES];
    let noise = information.deviation(&nothing, fault)?;
    let with_open = information.deviation(&plant.prior, fault)?;
    Some(Bound {
        noise,
        with_open,
        significance: plant.significance,
        most: information.most(plant, fault, noise, with_open),
    })
}

/// Derivatives of what is measured, each over its standard deviation.
struct Information {
    jacobian: DMatrix<f64>,
    zero_voltage: f64,
}

impl Information {
    fn of(plant: &Plant) -> Information {
        let mut at = [0.0; UNKNOWNS];
        at[SHARES..].copy_from_slice(&plant.state);
        let largest = plant.state[0];
        let jacobian = DMatrix::from_fn(MEASURED, UNKNOWNS, |_, _| 0.0);
        let mut information = Information {
            jacobian,
            zero_voltage: plant.zero_voltage,
        };
        for k in 0..UNKNOWNS {
            let step = match k {
                _ if k < SHARES => STEP,
                _ if k + 1 < UNKNOWNS => STEP * largest,
                _ => STEP * plant.state[6],
            };
            let side = |sign: f64| {
                let mut moved = at;
                moved[k] += sign * step;
                DVector::from_column_slice(&plant.measured(&moved))
            };
            let slope = (side(1.0) - side(-1.0)) / (2.0 * step);
            let white = slope.component_div(&DVector::from_column_slice(&plant.sigma));
            information.jacobian.set_column(k, &white);
        }
        information
    }

    /// Standard deviation of the fault's size; a share whose prior is 0 is known, except that of the fault.
    fn deviation(&self, prior: &[f64; SHARES], fault: Unknown) -> Option<f64> {
        let fault = fault as usize;
        let state = SHARES..UNKNOWNS;
        let open = (0..SHARES).filter(|k| *k != fault && prior[*k] > 0.0);
        // The fault's own quantity is uncertain in the healthy motor already: that part stands beside the fault.
        let own = (prior[fault] > 0.0).then_some(fault);
        let columns: Vec<usize> = std::iter::once(fault)
            .chain(own)
            .chain(open)
            .chain(state)
            .collect();
        let jacobian = self.jacobian.select_columns(&columns);
        let mut information = jacobian.transpose() * &jacobian;
        for (place, k) in columns.iter().enumerate().skip(1) {
            let weight = match *k {
                k if k < SHARES => prior[k].powi(-2),
                k if (SHARES + 4..SHARES + 6).contains(&k) => self.zero_voltage.powi(-2),
                _ => 0.0,
            };
            information[(place, place)] += weight;
        }
        scaled_inverse(information)
    }

    /// The unknown without which the bound would be closest to the noise alone.
    fn most(&self, plant: &Plant, fault: Unknown, noise: f64, with_open: f64) -> &'static str {
        if with_open < 1.05 * noise {
            return "noise";
        }
        let groups = Unknown::ALL
            .iter()
            .filter(|k| plant.prior[**k as usize] > 0.0);
        let without = |words: &str| {
            let mut prior = plant.prior;
            for k in Unknown::ALL.iter().filter(|k| k.words() == words) {
                prior[*k as usize] = 0.0;
            }
            self.deviation(&prior, fault).unwrap_or(f64::INFINITY)
        };
        let words = groups.map(|k| k.words());
        words
            .min_by(|a, b| without(a).total_cmp(&without(b)))
            .unwrap_or("")
    }
}

/// Square root of the inverse's first entry; scaled to a diagonal of ones before, as units differ by many powers of ten.
fn scaled_inverse(information: DMatrix<f64>) -> Option<f64> {
    let scale = information
        .diagonal()
        .map(|x| x.max(f64::MIN_POSITIVE).sqrt().recip());
    let scaled = DMatrix::from_fn(scale.len(), scale.len(), |r, c| {
        scale[r] * information[(r, c)] * scale[c]
    });
    let cholesky = scaled.cholesky()?;
    let mut unit = DVector::zeros(scale.len());
    unit[0] = 1.0;
    Some(scale[0] * cholesky.solve(&unit)[0].sqrt())
}

/// Cumulative distribution of the standard normal.
pub fn normal_cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x / std::f64::consts::SQRT_2)
}
