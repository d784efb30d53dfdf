//! Levenberg-Marquardt over all unknowns, with bounds; each point's own unknowns follow.

use nalgebra::DVector;

use super::point_rows::moved;
use super::{PointRows, Problem};
use crate::measured::point::Own;
use crate::measured::unknowns::{Machine, OF_PLATE, Square, UNKNOWNS, Unknowns};

/// Iterations at most, and attempts to find a damping that lowers the cost.
const ITERATIONS: usize = 40;
const ATTEMPTS: usize = 8;
/// Longest step of one unknown.
const LONGEST: f64 = 1.0;
/// A gain below ends the descent: a hundredth of a standard deviation.
const SMALL_GAIN: f64 = 3e-4;
/// A damping below hinders no step: a small gain is then no small step.
const FREE: f64 = 1e-2;
/// A gradient that pushes against a bound.
const PUSHED: f64 = 1.0;

/// Where the fit ended, and how sure it is there.
#[derive(Clone, Debug)]
pub(in crate::measured) struct Posterior {
    pub unknowns: Unknowns,
    pub machine: Machine,
    pub own: Vec<Own>,
    /// Inverse covariance.
    pub precision: Square,
    pub rows: Vec<PointRows>,
    pub cost: f64,
    gradient: Unknowns,
}

impl Posterior {
    /// Covariance of the unknowns.
    pub fn covariance(&self) -> Square {
        inverse(&self.precision)
    }

    /// A place as far off as the posterior leaves open.
    pub fn drawn(&self, normal: &Unknowns) -> Unknowns {
        let factor = self
            .precision
            .cholesky()
            .map(|factor| factor.l().transpose());
        let off = factor.and_then(|upper| upper.solve_upper_triangular(normal));
        self.unknowns + off.unwrap_or_else(Unknowns::zeros)
    }
}

/// Inverse of a precision; nothing where it has none.
pub(in crate::measured) fn inverse(precision: &Square) -> Square {
    precision
        .cholesky()
        .map_or_else(Square::zeros, |factor| factor.inverse())
}

impl Problem<'_> {
    /// The most likely motor near `from`.
    pub fn solved(&self, from: &Unknowns, own: Vec<Own>) -> Option<Posterior> {
        let mut here = self.at(from, own)?;
        let mut damping = 1e-3;
        for _ in 0..ITERATIONS {
            let newton = self.step(&here, 0.0);
            if -newton.dot(&here.gradient) < SMALL_GAIN {
                break;
            }
            let Some(better) = self.lower(&here, &mut damping) else {
                break;
            };
            let gain = here.cost - better.cost;
            here = better;
            if gain < SMALL_GAIN && damping < FREE {
                break;
            }
        }
        Some(here)
    }

    fn lower(&self, here: &Posterior, damping: &mut f64) -> Option<Posterior> {
        for _ in 0..ATTEMPTS {
            let step = self.step(here, *damping);
            let target = self.inside(here.unknowns + step);
            let step = target - here.unknowns;
            let own = here.own.iter().zip(&here.rows).zip(self.points);
            let own = own.map(|((own, rows), point)| rows.settled(point.test, own, &step));
            let trial = self.at(&target, own.collect());
            if let Some(trial) = trial.filter(|trial| trial.cost < here.cost) {
                *damping = (*damping / 10.0).max(1e-12);
                return Some(trial);
            }
            *damping = (*damping * 8.0).min(1e12);
        }
        None
    }

    /// The bounds that stop the fit, one bit for each unknown.
    pub fn stopped(&self, here: &Posterior) -> u32 {
        let stopped = |k: usize| {
            let low = here.unknowns[k] <= self.bounds[0][k] + 1e-9 && here.gradient[k] > PUSHED;
            let high = here.unknowns[k] >= self.bounds[1][k] - 1e-9 && here.gradient[k] < -PUSHED;
            low || high
        };
        (0..UNKNOWNS).filter(|&k| stopped(k)).map(|k| 1 << k).sum()
    }

    pub fn inside(&self, unknowns: Unknowns) -> Unknowns {
        unknowns.sup(&self.bounds[0]).inf(&self.bounds[1])
    }

    fn step(&self, here: &Posterior, damping: f64) -> Unknowns {
        let mut damped = here.precision;
        let mut right = -here.gradient;
        for k in 0..UNKNOWNS {
            damped[(k, k)] *= 1.0 + damping;
            let low = here.unknowns[k] <= self.bounds[0][k] + 1e-12 && here.gradient[k] > 0.0;
            let high = here.unknowns[k] >= self.bounds[1][k] - 1e-12 && here.gradient[k] < 0.0;
            if low || high {
                damped.fill_row(k, 0.0);
                damped.fill_column(k, 0.0);
                damped[(k, k)] = 1.0;
                right[k] = 0.0;
            }
        }
        let solved = damped.cholesky().map(|factor| factor.solve(&right));
        let step = solved.unwrap_or_else(Unknowns::zeros);
        step.map(|x| x.clamp(-LONGEST, LONGEST))
    }

    /// Everything linearised at a place.
    fn at(&self, unknowns: &Unknowns, own: Vec<Own>) -> Option<Posterior> {
        let mut precision = self.prior.precision(&self.doubts.values);
        let from_centre = unknowns - self.prior.centre;
        let mut gradient = precision * from_centre;
        let mut cost = from_centre.dot(&gradient);
        let (plate, residual) = self.term.rows(unknowns)?;
        let mut corner = precision.fixed_view_mut::<OF_PLATE, OF_PLATE>(0, 0);
        corner += plate.tr_mul(&plate);
        let mut head = gradient.fixed_rows_mut::<OF_PLATE>(0);
        head += plate.tr_mul(&residual);
        cost += residual.norm_squared();
        let machine = Machine::of(unknowns, self.completed);
        let machines = if self.points.is_empty() {
            Vec::new()
        } else {
            moved(unknowns, self.completed)
        };
        let mut rows = Vec::with_capacity(self.points.len());
        for (k, point) in self.points.iter().enumerate() {
            let one = PointRows::of(point, &own[k], self.doubts.points[k], &machine, &machines);
            add(&one, &mut precision, &mut gradient);
            cost += one.cost;
            rows.push(one);
        }
        cost.is_finite().then_some(Posterior {
            unknowns: *unknowns,
            machine,
            own,
            precision,
            rows,
            gradient,
            cost,
        })
    }
}

/// Adds the rows of a point.
fn add(rows: &PointRows, precision: &mut Square, gradient: &mut Unknowns) {
    *precision += information(rows);
    let pull: DVector<f64> = rows.jacobian.tr_mul(&rows.residual);
    *gradient += Unknowns::from_column_slice(pull.as_slice());
}

/// What a point adds to the precision.
pub(in crate::measured) fn information(rows: &PointRows) -> Square {
    let squared = rows.jacobian.tr_mul(&rows.jacobian);
    Square::from_column_slice(squared.as_slice())
}

impl Problem<'_> {
    /// What points would add to the precision of a posterior.
    pub fn planned_information(
        &self,
        posterior: &Posterior,
        points: &[crate::measured::point::Point],
    ) -> Square {
        let machines = moved(&posterior.unknowns, self.completed);
        let one = |point: &crate::measured::point::Point| {
            information(&PointRows::of(
                point,
                &point.start,
                1.0,
                &posterior.machine,
                &machines,
            ))
        };
        points
            .iter()
            .map(one)
            .fold(Square::zeros(), |sum, one| sum + one)
    }
}
