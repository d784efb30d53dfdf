//! Questions: one at a time, on a thread of its own, so that lamps and pages go on.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Weak};

use axum::Json;
use axum::extract::State;
use axum::extract::rejection::JsonRejection;
use axum::response::Response;
use recording::Source;
use serde::{Deserialize, Serialize};

use super::answer;
use super::desk::{Bench, Desk, Job, Kind};
use super::motors::Motor;
use crate::running::shared::Refusal;
use report::study::{Adopted, Compared, Explained, Inputs};
use report::{Subject, fragment};

/// A question of the page.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Question {
    kind: Kind,
    /// What to adopt.
    #[serde(default)]
    effect: String,
}

/// What a question is worked out from.
struct Work {
    question: Question,
    names: Vec<String>,
    sources: Vec<Source>,
    motor: Motor,
}

/// A result as JSON, and the motor file that came with it.
type Outcome = Result<(String, Option<Motor>), String>;

/// Begins to work on a question.
pub(super) async fn begin(
    State(bench): State<Arc<Bench>>,
    body: Result<Json<Question>, JsonRejection>,
) -> Response {
    let question = body.map_err(|error| Refusal::of(error.body_text()));
    let begun = question.and_then(|Json(question)| start(&bench, question));
    answer(&bench, begun)
}

fn start(bench: &Arc<Bench>, question: Question) -> Result<(), Refusal> {
    let motor = bench
        .motor()
        .ok_or_else(|| Refusal::of("choose a motor file first"))?;
    let mut desk = bench.free_desk()?;
    let (names, sources) = desk.sources();
    if sources.is_empty() {
        return Err(Refusal::of("load a recording first"));
    }
    desk.job = Job {
        id: desk.job.id + 1,
        kind: Some(question.kind),
        running: true,
        what: "starting".into(),
        ..Job::default()
    };
    drop(desk);
    let weak = Arc::downgrade(bench);
    let thread = std::thread::Builder::new().name("question".into());
    let spawned = thread.spawn(move || {
        let sources = sources.iter().map(|source| Source::clone(source)).collect();
        let work = Work {
            question,
            names,
            sources,
            motor,
        };
        run(&weak, work);
    });
    spawned.map(drop).map_err(|error| {
        bench.desk().job.running = false;
        Refusal::of(format!("no thread for the question: {error}"))
    })
}

/// Works and puts the answer on the desk; a panel that has ended meanwhile needs none.
fn run(bench: &Weak<Bench>, work: Work) {
    let kind = work.question.kind;
    let believed = work.motor.clone();
    let outcome = catch_unwind(AssertUnwindSafe(|| work.outcome(bench)));
    let outcome =
        outcome.unwrap_or_else(|_| Err("the question broke off; please report it".into()));
    if let Some(bench) = bench.upgrade() {
        bench.desk().finish(kind, believed, outcome);
    }
}

impl Desk {
    fn finish(&mut self, kind: Kind, believed: Motor, outcome: Outcome) {
        self.job.running = false;
        match outcome {
            Ok((json, adopted)) => {
                if adopted.is_some() {
                    self.before.push(believed);
                    self.motor = adopted;
                    // They are about the motor file before.
                    self.results.clear();
                }
                self.results.insert(kind, json.into());
                self.job.share = 1.0;
            }
            Err(problem) => self.job.problem = Some(problem),
        }
    }
}

impl Work {
    fn outcome(&self, bench: &Weak<Bench>) -> Outcome {
        let mut progress = |what: &str, share: f64| {
            if let Some(bench) = bench.upgrade() {
                let mut desk = bench.desk();
                what.clone_into(&mut desk.job.what);
                desk.job.share = share;
            }
        };
        let inputs = Inputs {
            names: &self.names,
            sources: &self.sources,
            motor: &self.motor.motor,
        };
        let plainly = |error: discovery::Error| error.to_string();
        match self.question.kind {
            Kind::Compare => {
                let compared = Compared::new(inputs, String::new(), &mut progress);
                Ok((shown(Subject::Compare, &compared.map_err(plainly)?)?, None))
            }
            Kind::Explain => {
                let explained = Explained::new(inputs, &|_| None, &mut progress);
                Ok((shown(Subject::Explain, &explained.map_err(plainly)?)?, None))
            }
            Kind::Adopt => {
                let effect = self.question.effect.as_str();
                let adopted = Adopted::new(effect, inputs, &mut progress);
                let (mut adopted, motor) = adopted.map_err(plainly)?;
                if !adopted.report.proven {
                    return Ok((shown(Subject::Adopt, &adopted)?, None));
                }
                let motor = self.motor.with(effect, motor);
                adopted.report.motor_file.clone_from(&motor.file);
                Ok((shown(Subject::Adopt, &adopted)?, Some(motor)))
            }
        }
    }
}

/// The same that the report of the command shows. Styles of single elements, which the page's policy forbids, become
/// data that its script applies.
fn shown(subject: Subject, result: &impl Serialize) -> Result<String, String> {
    let failed = |error: serde_json::Error| format!("the result cannot be shown: {error}");
    let mut fragment = fragment(subject, result).map_err(failed)?;
    fragment.html = fragment.html.replace(" style=\"", " data-style=\"");
    serde_json::to_string(&fragment).map_err(failed)
}
