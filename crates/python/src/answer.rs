//! The answer to a question, as the commands give it.

use crate::errors::usage;
use crate::motor::Motor;
use pyo3::prelude::*;
use replay::operating_points::OperatingPoints;
use report::study::{Adopted, Calibration, Checkup, Compared, Explained, Monitored};
use report::{Subject, json, page};

/// What was asked, and what came out.
#[derive(Clone, Debug)]
pub enum Outcome {
    Monitor(Box<Monitored>),
    LoadTable(OperatingPoints),
    Check(Box<Checkup>),
    Compare(Box<Compared>),
    Explain(Box<Explained>),
    Adopt(Box<Adopted>),
    Calibrate(Box<Calibration>),
}

impl Outcome {
    /// Its page; a calibration has none.
    fn subject(&self) -> Option<Subject> {
        Some(match self {
            Outcome::Monitor(_) => Subject::Monitor,
            Outcome::LoadTable(_) => Subject::LoadTable,
            Outcome::Check(_) => Subject::Check,
            Outcome::Compare(_) => Subject::Compare,
            Outcome::Explain(_) => Subject::Explain,
            Outcome::Adopt(_) => Subject::Adopt,
            Outcome::Calibrate(_) => return None,
        })
    }
}

/// Does the same with whatever the outcome holds.
macro_rules! with_answer {
    ($outcome:expr, $answer:ident => $done:expr) => {
        match $outcome {
            Outcome::LoadTable($answer) => $done,
            Outcome::Monitor(boxed) => with_answer!(@unboxed boxed, $answer => $done),
            Outcome::Check(boxed) => with_answer!(@unboxed boxed, $answer => $done),
            Outcome::Compare(boxed) => with_answer!(@unboxed boxed, $answer => $done),
            Outcome::Explain(boxed) => with_answer!(@unboxed boxed, $answer => $done),
            Outcome::Adopt(boxed) => with_answer!(@unboxed boxed, $answer => $done),
            Outcome::Calibrate(boxed) => with_answer!(@unboxed boxed, $answer => $done),
        }
    };
    (@unboxed $boxed:ident, $answer:ident => $done:expr) => {{
        let $answer = &**$boxed;
        $done
    }};
}

/// An answer: its JSON, its page, its tables, and the motor that came out of it.
#[pyclass(frozen, module = "drivemon._drivemon")]
#[derive(Debug)]
pub struct Answer {
    outcome: Outcome,
    motor: Option<Motor>,
}

impl Answer {
    pub fn new(outcome: Outcome, motor: Option<Motor>) -> Answer {
        Answer { outcome, motor }
    }
}

#[pymethods]
impl Answer {
    /// The bytes that `--json FILE` of the command writes.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        let text = py.detach(|| with_answer!(&self.outcome, answer => json::text(answer)));
        text.map(|text| text + "\n").map_err(no_json)
    }

    /// The page that `--report FILE.html` of the command writes.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        let subject = self
            .outcome
            .subject()
            .ok_or_else(|| usage("this answer has no page"))?;
        py.detach(|| with_answer!(&self.outcome, answer => page(subject, answer)))
            .map_err(no_json)
    }

    #[getter]
    fn motor(&self) -> Option<Motor> {
        self.motor.clone()
    }
}

fn no_json(error: serde_json::Error) -> PyErr {
    usage(format!("the result cannot be written as JSON: {error}"))
}
