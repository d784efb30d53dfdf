//! Questions put to `explain` about foreign machines, and how the answers are counted.

use super::cases::{self, Case};
use super::{
    COAST, Course, Hidden, INVERTER, INVERTER_B, LOADS, Machine, STEADY, STEPS, priors, record,
};
use discovery::{ExplainReport, explain_without};
use recording::Source;

/// Effects that these recordings cannot tell from each other, whatever the method. A gain of all currents, of all
/// voltages or of the torque is a motor of other impedances, inertia and friction; a delay, a filter and a turned frame
/// are one angle as long as the supply is a sine.
const TWINS: [&[&str]; 2] = [
    &[
        "current-gain",
        "voltage-gain",
        "load-gain",
        "phase-current-gain",
        "phase-voltage-gain",
    ],
    &["sample-delay", "sensor-filter", "frame-rotation"],
];

/// The effect and what cannot be told from it.
pub fn with_twins(name: &'static str) -> Vec<&'static str> {
    let twins = TWINS.iter().find(|twins| twins.contains(&name));
    twins.map_or_else(|| vec![name], |twins| twins.to_vec())
}

/// What is recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// Two recordings, one of them with a coast-down.
    CoastDown,
    /// Two recordings of starts, loads and voltages.
    Loads,
    /// One recording of one steady load.
    Steady,
}

/// One question.
#[derive(Clone, Debug)]
pub struct Question {
    pub names: Vec<&'static str>,
    pub hidden: Hidden,
    pub inverter: bool,
    pub setting: Setting,
    /// Taken out of the library.
    pub without: Vec<&'static str>,
    pub seed: u64,
}

/// An answer, and how it is counted.
pub struct Answer {
    pub question: Question,
    pub report: ExplainReport,
}

impl Question {
    pub fn of(case: &Case, setting: Setting, seed: u64) -> Self {
        Self {
            names: vec![case.name],
            hidden: case.hidden,
            inverter: case.inverter,
            setting,
            without: Vec::new(),
            seed,
        }
    }

    pub fn healthy(setting: Setting, inverter: bool, seed: u64) -> Self {
        Self {
            names: Vec::new(),
            hidden: Hidden::default(),
            inverter,
            setting,
            without: Vec::new(),
            seed,
        }
    }

    fn courses(&self) -> Vec<&'static Course> {
        match (self.setting, self.inverter) {
            (Setting::Steady, _) => vec![&STEADY],
            (_, true) => vec![&INVERTER, &INVERTER_B],
            (Setting::CoastDown, _) => vec![&COAST, &LOADS],
            (Setting::Loads, _) => vec![&STEPS, &LOADS],
        }
    }

    pub fn sources(&self) -> Vec<Source> {
        let machine = Machine::of(self.seed);
        let one = |(k, course): (usize, &&Course)| {
            let seed = 10 * self.seed + k as u64;
            Source::Recording(record(&machine, &self.hidden, course, seed))
        };
        self.courses().iter().enumerate().map(one).collect()
    }

    pub fn ask(&self) -> Answer {
        let motor = priors(&Machine::of(self.seed), self.seed);
        let (sources, quiet) = (self.sources(), &mut |_: &str, _: f64| {});
        let report = explain_without(&sources, &motor, &self.without, quiet);
        Answer {
            question: self.clone(),
            report: report.unwrap(),
        }
    }
}

impl Answer {
    /// Whether a step names `name`, alone or in its tie.
    pub fn names(&self, name: &str) -> bool {
        let mut steps = self.report.steps.iter();
        steps.any(|s| s.effect == name || s.tied_with.iter().any(|t| t == name))
    }

    /// Whether everything that is hidden is in a tie set, and there are no more steps.
    pub fn is_found(&self) -> bool {
        self.question.names.iter().all(|n| self.names(n))
    }

    /// Whether exactly what is hidden is named, alone or beside its twins.
    pub fn is_unique_but_for_twins(&self) -> bool {
        let steps = &self.report.steps;
        let names = &self.question.names;
        let allowed = |name: &str| names.iter().any(|n| with_twins(n).contains(&name));
        let mut ties = steps.iter().flat_map(|s| &s.tied_with);
        self.is_found() && steps.len() == names.len() && ties.all(|tie| allowed(tie))
    }

    /// Whether exactly what is hidden is named, alone.
    pub fn is_unique(&self) -> bool {
        let steps = &self.report.steps;
        self.is_found()
            && steps.len() == self.question.names.len()
            && steps.iter().all(|s| s.tied_with.is_empty())
    }

    /// Whether a step names something else, the truth not in its tie.
    pub fn is_wrong(&self) -> bool {
        let names = &self.question.names;
        let right = |s: &discovery::StepReport| {
            let tied = |n: &str| s.effect == n || s.tied_with.iter().any(|t| t == n);
            names.iter().any(|n| tied(n))
        };
        !self.report.steps.iter().all(right)
    }

    pub fn line(&self) -> String {
        let q = &self.question;
        let error = |f: &Option<discovery::FitReport>| {
            f.as_ref().map_or(f64::NAN, |f| f.held_out_error_over_noise)
        };
        let (before, after) = (error(&self.report.baseline), error(&self.report.final_));
        let mark = match (self.is_found(), self.is_wrong()) {
            (_, true) => "WRONG",
            (true, _) => "ok",
            _ => "-",
        };
        let hidden = if q.names.is_empty() {
            "nothing".to_owned()
        } else {
            q.names.join("+")
        };
        format!(
            "{mark:5} {hidden:28} {:3} {:?} {before:.3} -> {after:.3}: {}",
            q.seed, q.setting, self.report.summary
        )
    }
}

/// Two effects at once.
pub fn double(seed: u64) -> Vec<Question> {
    let question = |(names, hidden): ([&'static str; 2], Hidden)| Question {
        names: names.to_vec(),
        hidden,
        inverter: false,
        setting: Setting::CoastDown,
        without: Vec::new(),
        seed,
    };
    cases::double(seed).into_iter().map(question).collect()
}
