//! The first check of a motor: its plate or motor file, and what the page must know to ask for them.

use std::sync::Arc;

use axum::Json;
use axum::body::Bytes;
use axum::extract::rejection::JsonRejection;
use axum::extract::{Query, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use nameplate::plate::{PlateFile, Printing, QUESTIONS};
use report::study::{Known, PlateRow};
use report::{Subject, page_of_json};
use serde::Serialize;

use super::desk::{Bench, Kind};
use super::known::{Checked, Typed};
use super::motor_requests::{Named, answer_audited, sent, take};
use super::motors::Motor;
use super::upload::harmless;
use super::{answer, refused};
use crate::running::fields::FieldProblem;
use crate::running::shared::Refusal;

/// Characters of one answer.
const MOST_CHARACTERS: usize = 100;

/// One question of the form.
#[derive(Debug, Serialize)]
struct Asked {
    key: &'static str,
    words: &'static str,
    unit: &'static str,
    range: &'static str,
    missing: &'static str,
    on: &'static str,
}

/// The questions: those of `drivemon motor new`.
pub(super) async fn form() -> Response {
    let asked = QUESTIONS.map(|question| Asked {
        key: question.key,
        words: question.words,
        unit: question.unit,
        range: question.range,
        missing: question.missing,
        on: match question.printing {
            Printing::Every => "every",
            Printing::Iec => "iec",
            Printing::Nema => "nema",
            Printing::Elsewhere => "elsewhere",
        },
    });
    Json(asked).into_response()
}

/// What a plate as far as it is typed comes to.
#[derive(Debug, Default, Serialize)]
struct Tried {
    /// Why there is no circuit yet.
    missing: Option<String>,
    /// Values that exclude each other.
    contradictions: Vec<String>,
    /// The plate's numbers, printed or expected.
    plate: Vec<PlateRow>,
}

/// Tries what was typed so far.
pub(super) async fn attempt(
    State(bench): State<Arc<Bench>>,
    body: Result<Json<Typed>, JsonRejection>,
) -> Response {
    let file = body_of(body).and_then(|typed| read(&typed));
    let file = match file {
        Ok(file) => file,
        Err(refusal) => return refused(&refusal),
    };
    let tried = match estimated(&bench, file).await {
        Ok(known) => Tried {
            missing: None,
            contradictions: known.contradictions,
            plate: known.plate,
        },
        Err(refusal) => Tried {
            missing: Some(refusal.message),
            ..Tried::default()
        },
    };
    Json(tried).into_response()
}

/// Takes a plate: it becomes the motor file on the desk.
pub(super) async fn plate(
    State(bench): State<Arc<Bench>>,
    body: Result<Json<Typed>, JsonRejection>,
) -> Response {
    let read = body_of(body).and_then(|typed| Ok((read(&typed)?, typed)));
    let known = match read {
        Ok((file, typed)) => estimated(&bench, file).await.map(|known| (known, typed)),
        Err(refusal) => Err(refusal),
    };
    let done = known.and_then(|(known, typed)| {
        let name = file_name(&known.motor.name);
        let motor = Motor::parse(&name, &known.text)?;
        take(&bench, Some(motor), Some(Checked { known, typed }))
    });
    answer_audited(bench, done).await
}

/// A file name for a motor.
fn file_name(motor: &str) -> String {
    let letter = |c: char| match c.is_ascii_alphanumeric() {
        true => c.to_ascii_lowercase(),
        false => '-',
    };
    let name: String = motor.chars().map(letter).collect();
    let parts: Vec<&str> = name.split('-').filter(|part| !part.is_empty()).collect();
    match parts.is_empty() {
        true => "motor.toml".to_owned(),
        false => harmless(&format!("{}.toml", parts.join("-"))),
    }
}

/// Takes a motor file instead of a plate.
pub(super) async fn motor(
    State(bench): State<Arc<Bench>>,
    Query(named): Query<Named>,
    body: Bytes,
) -> Response {
    let done = sent(&named, &body).and_then(|(motor, text)| {
        let checked = Checked {
            known: Known::of_file(motor.motor.clone(), text.to_owned()),
            typed: Typed::new(),
        };
        take(&bench, Some(motor), Some(checked))
    });
    answer_audited(bench, done).await
}

/// The next recording of the same motor: what was learnt of it stays, the recordings go.
pub(super) async fn next(State(bench): State<Arc<Bench>>) -> Response {
    let done = bench.free_desk().and_then(|mut desk| {
        let learnt = desk.motor.clone().filter(|_| desk.check.is_some());
        desk.believe(learnt.ok_or_else(no_motor)?);
        desk.slots = Default::default();
        desk.results.clear();
        desk.job.problem = None;
        Ok(())
    });
    answer(&bench, done)
}

/// The page of the last check, as `drivemon check --report` writes it.
pub(super) async fn report(State(bench): State<Arc<Bench>>) -> Response {
    let json = bench.desk().results.get(&Kind::Check).cloned();
    let shown: Option<serde_json::Value> = json.and_then(|json| serde_json::from_str(&json).ok());
    let html = shown.and_then(|shown| page_of_json(Subject::Check, &shown["result"]).ok());
    let Some(html) = html else {
        return refused(&Refusal {
            status: 404,
            ..Refusal::of("there is no checked recording")
        });
    };
    let headers = [
        (CONTENT_TYPE, "text/html; charset=utf-8"),
        (CONTENT_DISPOSITION, "attachment; filename=\"check.html\""),
    ];
    (headers, html).into_response()
}

pub(super) fn no_motor() -> Refusal {
    Refusal::of("fill in the nameplate first, or choose a motor file")
}

fn body_of(body: Result<Json<Typed>, JsonRejection>) -> Result<Typed, Refusal> {
    body.map(|Json(typed)| typed)
        .map_err(|error| Refusal::of(error.body_text()))
}

/// The plate; each answer that is not a number is named with its key. A code letter needs the numbers before it.
fn read(typed: &Typed) -> Result<PlateFile, Refusal> {
    let mut file = PlateFile::default();
    let mut problems = Vec::new();
    let said = |text: &&String| !text.trim().is_empty();
    let keys = QUESTIONS.map(|question| question.key);
    let known = keys
        .iter()
        .filter(|key| **key != "nema_code")
        .chain([&"nema_code"]);
    for key in known {
        let Some(text) = typed.get(*key).filter(said) else {
            continue;
        };
        let text = match *key {
            "name" => text.trim().to_owned(),
            // Many plates are printed with a decimal comma.
            _ => text.trim().replace(',', "."),
        };
        let read = match text.chars().count() <= MOST_CHARACTERS {
            true => file.set(key, &text),
            false => Err(format!("at most {MOST_CHARACTERS} characters")),
        };
        problems.extend(read.err().map(|message| FieldProblem {
            key: (*key).to_owned(),
            message,
        }));
    }
    let unknown = typed.keys().find(|key| !keys.contains(&key.as_str()));
    match (problems.is_empty(), unknown) {
        (_, Some(key)) => Err(Refusal::of(format!("a plate has no {key}"))),
        (true, None) => Ok(file),
        (false, None) => Err(Refusal {
            problems,
            ..Refusal::of("the plate cannot be read")
        }),
    }
}

/// The circuit of a plate, beside the server's thread and one at a time.
async fn estimated(bench: &Bench, file: PlateFile) -> Result<Known, Refusal> {
    let _one = bench.estimating.lock().await;
    let work = tokio::task::spawn_blocking(move || Known::of_plate(&file));
    let done = work.await;
    done.map_err(|_| Refusal::of("the plate cannot be computed: the search broke off"))?
        .map_err(Refusal::of)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(pairs: &[(&str, &str)]) -> Typed {
        let owned = |(key, text): &(&str, &str)| ((*key).to_owned(), (*text).to_owned());
        pairs.iter().map(owned).collect()
    }

    #[test]
    fn a_plate_is_read_as_it_is_typed() {
        let american = [
            ("power_hp", "3"),
            ("voltage_volt", " 460 "),
            ("frequency_hz", "60"),
            ("current_amp", "4,2"),
            ("nema_code", "K"),
            ("speed_rpm", ""),
        ];
        let file = read(&typed(&american)).expect("a plate");
        assert!(file.plate.locked_rotor_current_ratio.is_some() && file.plate.speed_rpm.is_none());
    }

    #[test]
    fn what_is_no_number_is_named_with_its_field() {
        let refusal = read(&typed(&[("power_kw", "5.5 kW"), ("speed_rpm", "fast")]));
        let problems = refusal.expect_err("no numbers").problems;
        let keys: Vec<&str> = problems
            .iter()
            .map(|problem| problem.key.as_str())
            .collect();
        assert_eq!(keys, ["power_kw", "speed_rpm"]);
        let strange = read(&typed(&[("colour", "blue")])).expect_err("no key");
        assert!(strange.message.contains("colour"));
        assert!(read(&typed(&[("name", &"x".repeat(101))])).is_err());
    }

    #[test]
    fn motors_get_harmless_file_names() {
        assert_eq!(file_name("Pump 3 / west"), "pump-3-west.toml");
        assert_eq!(file_name("../.."), "motor.toml");
    }
}
