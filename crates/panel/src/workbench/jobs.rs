//! Questions: one at a time, on a thread of its own, so that lamps and pages go on.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Arc, Weak};

use axum::Json;
use axum::extract::State;
use axum::extract::rejection::JsonRejection;
use axum::response::Response;
use recording::{Recording, Source};
use replay::check::Knowledge;
use serde::Deserialize;

use super::desk::{Bench, Desk, Job, Kind};
use super::motors::Motor;
use super::{answer, check};
use crate::running::shared::Refusal;
use report::json::Answer;
use report::study::{Adopted, Checkup, Compared, Explained, Inputs, Known};
use report::{Subject, fragment};

/// A question of the page.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Question {
    kind: Kind,
    /// What to adopt.
    #[serde(default)]
    effect: String,
    /// Which recording to check shows the motor in good order.
    #[serde(default)]
    healthy: Healthy,
}

/// Which recording of the motor in good order there is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Healthy {
    /// None that anybody knows of.
    #[default]
    None,
    /// The one that is checked.
    This,
    /// The second one on the desk.
    Earlier,
}

/// What a question is worked out from.
struct Work {
    question: Question,
    names: Vec<String>,
    sources: Vec<Source>,
    motor: Motor,
    /// The motor of a check.
    known: Option<Known>,
}

/// A result as JSON, and what becomes of the motor file.
struct Done {
    json: String,
    motor: Change,
}

/// What a question changes about the motor file on the desk.
enum Change {
    /// Nothing.
    Stays,
    /// An effect was added: the one before can come back.
    Adopted(Motor),
    /// Healthy recordings taught it.
    Learnt(Motor),
}

type Outcome = Result<Done, String>;

/// What ends a question that somebody stopped. It unwinds from the report of progress: no step in between has to hand
/// a request on, and no panic is reported.
struct Stopped;

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
    let (names, sources) = match question.kind {
        Kind::Check => desk.check_sources(question.healthy)?,
        Kind::Compare | Kind::Explain | Kind::Adopt => desk.sources(),
    };
    if sources.is_empty() {
        return Err(Refusal::of("load a recording first"));
    }
    let known = desk.check.as_ref().map(|checked| checked.known.clone());
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
            known,
        };
        run(&weak, work);
    });
    spawned.map(drop).map_err(|error| {
        bench.desk().job.running = false;
        Refusal::of(format!("no thread for the question: {error}"))
    })
}

/// Stops the question that is being worked on, at its next report of progress.
pub(super) async fn stop(State(bench): State<Arc<Bench>>) -> Response {
    let stopped = {
        let mut desk = bench.desk();
        desk.job.stopping = desk.job.running;
        desk.job.running.then_some(())
    };
    let nothing = || Refusal {
        status: 409,
        ..Refusal::of("no question is being worked on")
    };
    answer(&bench, stopped.ok_or_else(nothing))
}

/// Works and puts the answer on the desk; a panel that has ended meanwhile needs none.
fn run(bench: &Weak<Bench>, work: Work) {
    let kind = work.question.kind;
    let believed = work.motor.clone();
    let outcome = catch_unwind(AssertUnwindSafe(|| work.outcome(bench)));
    let Some(bench) = bench.upgrade() else {
        return;
    };
    let mut desk = bench.desk();
    match outcome {
        Ok(outcome) => desk.finish(kind, believed, outcome),
        Err(payload) if payload.is::<Stopped>() => desk.job.running = false,
        Err(_) => {
            let words = "the question broke off; please report it".to_owned();
            desk.finish(kind, believed, Err(words));
        }
    }
}

impl Desk {
    /// The recording to check, and the one of the motor in good order behind it where it is the second one.
    fn check_sources(&self, healthy: Healthy) -> Result<(Vec<String>, Vec<Arc<Source>>), Refusal> {
        if self.check.is_none() {
            return Err(check::no_motor());
        }
        let of = |slot: usize, what: &str| {
            let slot = self.slots[slot].as_ref();
            let there = slot.and_then(|slot| Some((slot.view.name.clone(), slot.source.clone()?)));
            let (name, source) = there.ok_or_else(|| Refusal::of(format!("load {what} first")))?;
            match source.as_ref() {
                Source::Recording(_) => Ok((name, source)),
                Source::LoadTable(_) => Err(Refusal::of(format!(
                    "{name}: a load table has no waveforms to judge; the workbench explains it"
                ))),
            }
        };
        let mut both = vec![of(0, "a recording")?];
        if healthy == Healthy::Earlier {
            both.push(of(1, "the recording of the motor in good order")?);
        }
        Ok(both.into_iter().unzip())
    }

    fn finish(&mut self, kind: Kind, believed: Motor, outcome: Outcome) {
        self.job.running = false;
        match outcome {
            Ok(Done { json, motor }) => {
                if !matches!(motor, Change::Stays) {
                    // They are about the motor file before.
                    self.results.clear();
                }
                match motor {
                    Change::Stays => {}
                    Change::Adopted(motor) => {
                        self.before.push(believed);
                        self.believe(motor);
                    }
                    Change::Learnt(motor) => self.motor = Some(motor),
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
            // A panel that has ended needs no answer either.
            let stopped = bench.upgrade().is_none_or(|bench| {
                let mut desk = bench.desk();
                what.clone_into(&mut desk.job.what);
                desk.job.share = share;
                desk.job.stopping
            });
            if stopped {
                resume_unwind(Box::new(Stopped));
            }
        };
        let inputs = Inputs {
            names: &self.names,
            sources: discovery::Sources::Whole(&self.sources),
            motor: &self.motor.motor,
            laws: discovery::Laws::default(),
            next_run: None,
        };
        let plainly = |error: discovery::Error| error.to_string();
        match self.question.kind {
            Kind::Compare => {
                let compared = Compared::new(inputs, String::new(), &mut progress);
                stays(Subject::Compare, &compared.map_err(plainly)?)
            }
            Kind::Explain => {
                let explained = Explained::new(inputs, &|_, _| None, &mut progress);
                stays(Subject::Explain, &explained.map_err(plainly)?)
            }
            Kind::Adopt => {
                let effect = self.question.effect.as_str();
                let adopted = Adopted::new(effect, inputs, &mut progress);
                let (mut adopted, motor) = adopted.map_err(plainly)?;
                if !adopted.report.proven {
                    return stays(Subject::Adopt, &adopted);
                }
                let motor = self.motor.with(effect, motor);
                adopted.report.motor_file.clone_from(&motor.file);
                Ok(Done {
                    json: shown(Subject::Adopt, &adopted)?,
                    motor: Change::Adopted(motor),
                })
            }
            Kind::Check => self.checked(&mut progress),
        }
    }

    /// As `drivemon check` does it.
    fn checked(&self, progress: &mut discovery::Progress<'_>) -> Outcome {
        let known = self.known.as_ref().ok_or("there is no motor to check")?;
        let recordings: Vec<&Recording> = self.sources.iter().filter_map(recorded).collect();
        let (Some(first), Some(name)) = (recordings.first(), self.names.first()) else {
            return Err("there is no recording to check".to_owned());
        };
        let judged = [(name.clone(), *first)];
        let healthy = match self.question.healthy {
            Healthy::None => &[][..],
            Healthy::This => &recordings[..1],
            Healthy::Earlier => &recordings[1..],
        };
        let (mut checkup, motor) = Checkup::new(known, healthy, &judged, progress)?;
        let change = match checkup.knowledge {
            Knowledge::AsGiven => Change::Stays,
            Knowledge::Identified | Knowledge::Calibrated => {
                let motor = self.motor.learnt(motor);
                checkup.motor_file = Some(motor.file.clone());
                Change::Learnt(motor)
            }
        };
        Ok(Done {
            json: shown(Subject::Check, &checkup)?,
            motor: change,
        })
    }
}

fn recorded(source: &Source) -> Option<&Recording> {
    match source {
        Source::Recording(recording) => Some(recording),
        Source::LoadTable(_) => None,
    }
}

/// A result that leaves the motor file as it is.
fn stays(subject: Subject, result: &impl Answer) -> Outcome {
    Ok(Done {
        json: shown(subject, result)?,
        motor: Change::Stays,
    })
}

/// The same that the report of the command shows. Styles of single elements, which the page's policy forbids, become
/// data that its script applies.
fn shown(subject: Subject, result: &impl Answer) -> Result<String, String> {
    let failed = |error: serde_json::Error| format!("the result cannot be shown: {error}");
    let mut fragment = fragment(subject, result).map_err(failed)?;
    fragment.html = fragment.html.replace(" style=\"", " data-style=\"");
    serde_json::to_string(&fragment).map_err(failed)
}
