//! An equation solved beforehand.

use crate::Hermite;

/// Solutions of an equation over its parameter, at even distances from zero.
#[derive(Clone, Debug)]
pub struct Solved {
    solutions: Hermite,
    serve_as: Serve,
}

/// What solutions are good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Serve {
    Answers,
    Guesses,
    Nothing,
}

/// What is known of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// The solution.
    Answer(f64),
    /// A place near the only solution.
    Guess(f64),
    /// Nothing: beyond the last parameter, or where the solution does not rise with it.
    Nothing,
}

impl Solved {
    /// Solves at `points` parameters, `distance` apart. `solve` gives the solution, from a guess, and its slope over the parameter.
    ///
    /// `limits`: half way between all parameters the solutions are off by less than the first of them: they are answers; than the second: guesses.
    pub fn of(
        points: usize,
        distance: f64,
        limits: [f64; 2],
        solve: impl Fn(f64, f64) -> [f64; 2],
    ) -> Self {
        let (mut guess, mut rises) = (0.0, true);
        let solutions = Hermite::of(points, distance, |parameter| {
            let [x, slope] = solve(parameter, guess);
            rises &= slope > 0.0;
            guess = x + slope * distance;
            [x, slope]
        });
        let error = |k: usize| {
            let parameter = distance * (k as f64 + 0.5);
            let between = solutions.at(parameter).unwrap_or(f64::NAN);
            (solve(parameter, between)[0] - between).abs()
        };
        let worst = (0..points - 1).map(error).fold(0.0, worse);
        let [answers, guesses] = limits.map(|limit| rises && worst < limit);
        let serve_as = match (answers, guesses) {
            (true, _) => Serve::Answers,
            (_, true) => Serve::Guesses,
            _ => Serve::Nothing,
        };
        Self {
            solutions,
            serve_as,
        }
    }

    /// What is known of the solution at a parameter.
    #[inline]
    pub fn at(&self, parameter: f64) -> Known {
        match (self.serve_as, self.solutions.at(parameter)) {
            (Serve::Answers, Some(x)) => Known::Answer(x),
            (Serve::Guesses, Some(x)) => Known::Guess(x),
            _ => Known::Nothing,
        }
    }
}

/// The larger error; what is no number is worse than any.
fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Solutions of x + a x^3 = parameter, by Newton's steps.
    fn cubic(a: f64) -> impl Fn(f64, f64) -> [f64; 2] {
        move |parameter, guess| {
            let mut x = guess;
            let slope = |x: f64| 1.0 + 3.0 * a * x * x;
            for _ in 0..50 {
                x -= (x + a * x.powi(3) - parameter) / slope(x);
            }
            [x, 1.0 / slope(x)]
        }
    }

    /// 1 + 0.2 = 1.2 and 0.5 + 0.2 / 8 = 0.525: answers where the points are dense, guesses where they are not.
    #[test]
    fn solutions_between_dense_points_are_answers() {
        for (points, is_answer) in [(1001, true), (21, false)] {
            let distance = 2.0 / (points - 1) as f64;
            let solved = Solved::of(points, distance, [1e-9, 1e-3], cubic(0.2));
            for (parameter, solution) in [(1.2, 1.0), (0.525, 0.5)] {
                let x = match solved.at(parameter) {
                    Known::Answer(x) if is_answer => x,
                    Known::Guess(x) if !is_answer => x,
                    other => panic!("{points}: {other:?}"),
                };
                let limit = if is_answer { 1e-9 } else { 1e-3 };
                assert!((x - solution).abs() < limit, "{points}: {x}");
            }
            assert_eq!(solved.at(2.1), Known::Nothing);
        }
    }

    /// x - 0.4 x^3 falls from 0.91 on: no solution is the only one.
    #[test]
    fn an_equation_of_several_solutions_is_not_known() {
        let solved = Solved::of(1001, 2e-3, [1e-9, 1e-3], cubic(-0.4));
        assert_eq!(solved.at(0.1), Known::Nothing);
    }
}
