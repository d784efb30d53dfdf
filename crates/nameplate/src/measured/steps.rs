//! The tests one after the other: what each told.

use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use super::advice::{Help, helps};
use super::begin::Begin;
use super::doubt::{Doubt, What, doubts, excess};
use super::fit::{Doubts, Posterior, Prior, Problem};
use super::instruments::Instruments;
use super::parameters::{ALL, Form, covariance, derivatives, intervals};
use super::plate_term::PlateTerm;
use super::point::{Point, points};
use super::table::{Column, Row, Test, check};
use super::unknowns::{EXTRA_BOUNDS, Machine, Unknowns};
use crate::circuit::PARAMETERS;
use crate::estimate::Estimate;
use crate::interval::Interval;
use crate::plate::{Completed, VALUES};

/// Rounds in which contradictions are given room.
const ROUNDS: usize = 8;
/// Further starts where something contradicts, and where all agrees but a bound stops the fit; their seed: the same tests give
/// the same motor.
const STARTS: [usize; 2] = [24, 3];
const SEED: u64 = 1;
/// Voltages or frequencies that differ by less than this share are one.
const ONE: f64 = 0.2;

/// What was known after a test.
#[derive(Clone, Debug)]
pub struct Step {
    /// The test; `None` before the first.
    pub test: Option<Test>,
    /// Rows of the table.
    pub rows: usize,
    /// Parameters in the order of [`super::NAMES`].
    pub parameters: [Interval; ALL],
}

/// A motor after its tests.
#[derive(Clone, Debug)]
pub struct Tested {
    /// The plate with every value set.
    pub completed: Completed,
    /// Which effects the tests show.
    pub form: Form,
    /// The plate alone, then one step for each test.
    pub steps: Vec<Step>,
    /// Correlations of the logarithms of the parameters after the last step.
    pub correlations: DMatrix<f64>,
    /// What contradicts what.
    pub doubts: Vec<Doubt>,
    /// Whether all no-load points have one voltage: core loss and friction cannot be told apart.
    pub one_voltage: bool,
    /// Whether all locked-rotor points have one frequency: rotor resistance and skin effect cannot be told apart.
    pub one_frequency: bool,
    /// What is still wide.
    pub helps: Vec<Help>,
}

impl Tested {
    /// Parameters after the last step, in the order of [`super::NAMES`].
    pub fn parameters(&self) -> [Interval; ALL] {
        let nothing = Interval::around(1.0, 0.0);
        self.steps
            .last()
            .map_or([nothing; ALL], |step| step.parameters)
    }

    /// What tests on one motor say beyond its plate; `inertia_kg_m2` where it was told.
    ///
    /// # Errors
    /// Rows that are no such test, with table, line, column and the remedy.
    pub fn of(
        estimate: &Estimate,
        rows: &[Row],
        instruments: &Instruments,
        inertia_kg_m2: Option<f64>,
    ) -> Result<Tested, String> {
        check(rows, &estimate.completed)?;
        let begin = Begin::of(estimate);
        let bench = Bench::of(&begin, rows, instruments, inertia_kg_m2);
        bench.tested(rows).ok_or_else(|| {
            "the plate has no circuit from which the tests could begin; look at what `drivemon motor new` says of it".to_owned()
        })
    }
}

struct Bench<'b> {
    completed: &'b Completed,
    instruments: &'b Instruments,
    term: PlateTerm,
    prior: Prior,
    bounds: [Unknowns; 2],
    points: Vec<Point>,
    form: Form,
}

impl<'b> Bench<'b> {
    fn of(
        begin: &'b Begin,
        rows: &[Row],
        instruments: &'b Instruments,
        inertia: Option<f64>,
    ) -> Bench<'b> {
        let prior = Prior::of(begin, instruments, inertia);
        let machine = Machine::of(&prior.centre, &begin.completed);
        let has = |test: Test| rows.iter().any(|row| row.test == test);
        Bench {
            completed: &begin.completed,
            instruments,
            term: PlateTerm::of(begin, &prior.centre),
            bounds: bounds(&begin.completed),
            points: points(rows, instruments, &machine),
            form: Form {
                standstill: begin.completed.knows_standstill() || has(Test::LockedRotor),
                saturates: has(Test::NoLoad),
                bearings: has(Test::CoastDown),
            },
            prior,
        }
    }

    fn tested(&self, rows: &[Row]) -> Option<Tested> {
        let (mut steps, mut used) = (Vec::new(), Vec::new());
        let (plate, _) = self.solved(&used, None)?;
        let (mut last, mut named) = (plate.clone(), Vec::new());
        steps.push(self.step(None, 0, &last));
        for test in Test::ALL {
            let more: Vec<Point> = self
                .points
                .iter()
                .filter(|p| p.test == test)
                .cloned()
                .collect();
            if more.is_empty() {
                continue;
            }
            used.extend(more);
            (last, named) = self.solved(&used, Some([&last, &plate]))?;
            steps.push(self.step(
                Some(test),
                rows.iter().filter(|row| row.test == test).count(),
                &last,
            ));
        }
        Some(self.answer(rows, steps, &last, named, &used))
    }

    fn answer(
        &self,
        rows: &[Row],
        steps: Vec<Step>,
        last: &Posterior,
        doubts: Vec<Doubt>,
        used: &[Point],
    ) -> Tested {
        let by_unknowns = derivatives(last, self.completed, &self.form);
        let spread = covariance(&by_unknowns, &last.covariance());
        let correlations = DMatrix::from_fn(ALL, ALL, |a, b| {
            spread[(a, b)] / (spread[(a, a)] * spread[(b, b)]).sqrt().max(1e-300)
        });
        let certain = Doubts::none(used.len());
        let problem = self.problem(used, &certain);
        Tested {
            completed: last.machine.completed.clone(),
            form: self.form,
            steps,
            correlations,
            doubts,
            one_voltage: are_one(rows, Test::NoLoad, Column::Voltage, f64::NAN),
            one_frequency: are_one(
                rows,
                Test::LockedRotor,
                Column::Frequency,
                self.completed.frequency_hz,
            ),
            helps: helps(&problem, last, self.instruments, &self.form, &by_unknowns),
        }
    }

    fn problem<'p>(&'p self, points: &'p [Point], doubts: &'p Doubts) -> Problem<'p> {
        Problem {
            completed: self.completed,
            term: &self.term,
            prior: &self.prior,
            points,
            doubts,
            bounds: &self.bounds,
        }
    }

    fn step(&self, test: Option<Test>, rows: usize, posterior: &Posterior) -> Step {
        let by_unknowns = derivatives(posterior, self.completed, &self.form);
        let spread = covariance(&by_unknowns, &posterior.covariance());
        Step {
            test,
            rows,
            parameters: intervals(posterior, &self.form, &spread),
        }
    }

    /// The posterior of some points, with room for what contradicts, and the contradictions as they were first found.
    fn solved(
        &self,
        points: &[Point],
        known: Option<[&Posterior; 2]>,
    ) -> Option<(Posterior, Vec<Doubt>)> {
        let before = known.map(|[before, _]| before);
        let mut factors = Doubts::none(points.len());
        let mut from = before.map_or(self.prior.centre, |before| before.unknowns);
        let mut own: Vec<_> = points.iter().map(|point| point.start).collect();
        for (new, old) in own
            .iter_mut()
            .zip(before.iter().flat_map(|before| &before.own))
        {
            *new = *old;
        }
        let mut named: Vec<Doubt> = Vec::new();
        for round in 0..ROUNDS {
            let problem = self.problem(points, &factors);
            let mut posterior = problem.solved(&from, own)?;
            let mut found = doubts(&problem, &posterior);
            let newly = |before: &Posterior| {
                problem.stopped(&posterior) != 0
                    && problem.stopped(&posterior) != problem.stopped(before)
            };
            let suspicious = !found.is_empty() || before.is_some_and(newly);
            if let (true, 0, Some(around)) = (suspicious, round, known) {
                // Perhaps a local minimum.
                let starts = STARTS[usize::from(found.is_empty())];
                posterior = self.elsewhere(&problem, around, posterior, starts);
                found = doubts(&problem, &posterior);
            }
            if found.is_empty() {
                return Some((posterior, named));
            }
            factors.grow(points, &found);
            for doubt in found {
                if !named.iter().any(|old| old.what == doubt.what) {
                    named.push(doubt);
                }
            }
            (from, own) = (posterior.unknowns, posterior.own);
        }
        let posterior = self.problem(points, &factors).solved(&from, own)?;
        Some((posterior, named))
    }

    /// The best of further starts, drawn from what was known before this test, and before all.
    fn elsewhere(
        &self,
        problem: &Problem<'_>,
        around: [&Posterior; 2],
        found: Posterior,
        starts: usize,
    ) -> Posterior {
        let mut rng = Pcg64Mcg::seed_from_u64(SEED);
        let mut best = found;
        for k in 0..starts {
            let normal = Unknowns::from_fn(|_, _| StandardNormal.sample(&mut rng));
            let own = problem.points.iter().map(|point| point.start).collect();
            let from = problem.inside(around[k % 2].drawn(&normal));
            if let Some(other) = problem.solved(&from, own)
                && other.cost < best.cost
            {
                best = other;
            }
        }
        best
    }
}

impl Doubts {
    fn none(points: usize) -> Doubts {
        Doubts {
            points: vec![1.0; points],
            values: [1.0; VALUES],
        }
    }

    fn grow(&mut self, points: &[Point], found: &[Doubt]) {
        for doubt in found {
            match &doubt.what {
                What::Plate(k) => self.values[*k] *= excess(doubt).max(1.1),
                What::Rows(_, rows) => {
                    if let Some(k) = points.iter().position(|point| point.rows == *rows) {
                        self.points[k] *= excess(doubt).max(1.1);
                    }
                }
            }
        }
    }
}

/// Lowest and highest place of every unknown.
fn bounds(completed: &Completed) -> [Unknowns; 2] {
    let circuit = crate::fit::bounds(&completed.targets);
    [(-30.0, 0), (30.0, 1)].map(|(end, side)| {
        let mut all = Unknowns::repeat(end);
        all.fixed_rows_mut::<PARAMETERS>(VALUES)
            .copy_from(&circuit[side]);
        for (unknown, ends) in EXTRA_BOUNDS {
            all[unknown as usize] = ends[side];
        }
        all
    })
}

/// Whether a test has rows, and all of them with about one value of a column.
fn are_one(rows: &[Row], test: Test, column: Column, otherwise: f64) -> bool {
    let of_test = rows.iter().filter(|row| row.test == test);
    let values = of_test.map(|row| row.get(column).unwrap_or(otherwise));
    let (low, high) = values.fold((f64::MAX, 0.0f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    high > 0.0 && low > (1.0 - ONE) * high
}
