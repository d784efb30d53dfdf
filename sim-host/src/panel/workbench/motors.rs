//! The motor file on the desk.

use std::sync::Arc;

use axum::Json;
use axum::body::Bytes;
use axum::extract::rejection::JsonRejection;
use axum::extract::{Query, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use motor::MotorFile;
use serde::{Deserialize, Serialize};

use super::desk::Bench;
use super::upload::harmless;
use super::{answer, refused};
use crate::motor_text;
use crate::panel::fields::problems;
use crate::panel::session::Refusal;
use crate::study::effects_fit;

/// A shipped motor file.
macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../../motors/", $name)))),*]
    };
}

/// Every motor file of the folder `motors`.
const SHIPPED: [(&str, &str); 11] = shipped![
    "assumed-300w.toml",
    "assumed-300w-calibrated.toml",
    "chalmers-4kw.toml",
    "chalmers-4kw-calibrated.toml",
    "imc-18k5.toml",
    "itsc-075hp.toml",
    "peer-2k2.toml",
    "peer-2k2-calibrated.toml",
    "peer-2k2-saturating.toml",
    "peer-2k2-saturating-calibrated.toml",
    "published-300w.toml",
];

/// A motor file.
#[derive(Clone, Debug)]
pub(super) struct Motor {
    /// Its name.
    pub file: String,
    /// Its text, comments included.
    pub text: String,
    /// What it says.
    pub motor: MotorFile,
    /// What was adopted to get here; `None` for a file as it was given.
    pub adopted: Option<String>,
}

/// What the page shows of it.
#[derive(Debug, Serialize)]
pub(super) struct MotorView {
    /// Name of the motor.
    name: String,
    /// Name of the file.
    file: String,
    /// Effects that its model has.
    effects: Vec<String>,
    /// What was adopted on this desk, the first first.
    adopted: Vec<String>,
    /// Rated frequency, Hz.
    frequency_hz: f64,
}

impl Motor {
    /// Reads a motor file.
    fn parse(file: &str, text: &str) -> Result<Motor, Refusal> {
        let motor = MotorFile::parse(text, file).map_err(|error| Refusal {
            problems: problems(&error),
            ..Refusal::of(error.to_string())
        })?;
        effects_fit(file, &motor).map_err(Refusal::of)?;
        Ok(Motor {
            file: file.to_owned(),
            text: text.to_owned(),
            motor,
            adopted: None,
        })
    }

    /// What the panel judges with.
    pub fn of_panel(motor: MotorFile) -> Motor {
        Motor {
            file: "panel.toml".into(),
            text: motor.to_toml(),
            motor,
            adopted: None,
        }
    }

    /// The file with an effect added; comments stay.
    pub fn with(&self, effect: &str, motor: MotorFile) -> Motor {
        let stem = self.file.trim_end_matches(".toml");
        Motor {
            file: format!("{stem}-{effect}.toml"),
            text: motor_text::updated(&self.text, &motor),
            motor,
            adopted: Some(effect.to_owned()),
        }
    }

    pub fn view(&self, before: &[Motor]) -> MotorView {
        let steps = before.iter().chain([self]);
        MotorView {
            name: self.motor.name.clone(),
            file: self.file.clone(),
            effects: self
                .motor
                .effects
                .iter()
                .map(|effect| effect.name.clone())
                .collect(),
            adopted: steps.filter_map(|motor| motor.adopted.clone()).collect(),
            frequency_hz: self.motor.nameplate.frequency_hz,
        }
    }
}

/// Names of the shipped motor files.
pub(super) fn shipped_names() -> Vec<&'static str> {
    SHIPPED.iter().map(|(name, _)| *name).collect()
}

/// A shipped motor file by its name; the panel's own without one.
#[derive(Debug, Deserialize)]
pub(super) struct Choice {
    shipped: Option<String>,
}

/// Takes a shipped motor file, or the panel's own.
pub(super) async fn choose(
    State(bench): State<Arc<Bench>>,
    body: Result<Json<Choice>, JsonRejection>,
) -> Response {
    let choice = body.map_err(|error| Refusal::of(error.body_text()));
    let motor = choice.and_then(|Json(choice)| {
        let Some(name) = choice.shipped else {
            return Ok(None);
        };
        let found = SHIPPED.iter().find(|(known, _)| *known == name);
        let (file, text) = found.ok_or_else(|| Refusal::of("there is no such motor file here"))?;
        Motor::parse(file, text).map(Some)
    });
    let done = motor.and_then(|motor| take(&bench, motor));
    answer_audited(bench, done).await
}

/// What goes with a motor file.
#[derive(Debug, Deserialize)]
pub(super) struct Named {
    name: String,
}

/// Takes a motor file that the page sends.
pub(super) async fn file(
    State(bench): State<Arc<Bench>>,
    Query(named): Query<Named>,
    body: Bytes,
) -> Response {
    let name = harmless(&named.name);
    let text = std::str::from_utf8(&body);
    let text = text
        .map_err(|error| Refusal::of(format!("{name}: is no text: {error}; choose a motor file")));
    let motor = text.and_then(|text| Motor::parse(&name, text));
    let done = motor.and_then(|motor| take(&bench, Some(motor)));
    answer_audited(bench, done).await
}

fn take(bench: &Bench, motor: Option<Motor>) -> Result<(), Refusal> {
    let mut desk = bench.free_desk()?;
    desk.take_motor(motor);
    desk.job.problem = None;
    Ok(())
}

/// The state after another motor file was taken, with the audits that belong to it.
async fn answer_audited(bench: Arc<Bench>, done: Result<(), Refusal>) -> Response {
    if done.is_ok() {
        let shared = bench.clone();
        // A panic would leave a recording without findings.
        let _ = tokio::task::spawn_blocking(move || shared.audit_missing()).await;
    }
    answer(&bench, done)
}

/// Goes back to the motor file before the last adoption.
pub(super) async fn undo(State(bench): State<Arc<Bench>>) -> Response {
    let done = bench.free_desk().and_then(|mut desk| {
        let before = desk.before.pop();
        desk.motor = Some(before.ok_or_else(|| Refusal::of("nothing was adopted"))?);
        desk.results.clear();
        desk.job.problem = None;
        Ok(())
    });
    answer(&bench, done)
}

/// The motor file as `drivemon adopt -o` would write it.
pub(super) async fn save(State(bench): State<Arc<Bench>>) -> Response {
    let Some(motor) = bench.motor() else {
        return refused(&Refusal::of("there is no motor file"));
    };
    let ascii = |c: char| {
        if c.is_ascii_alphanumeric() || "._-".contains(c) {
            c
        } else {
            '_'
        }
    };
    let name: String = motor.file.chars().map(ascii).collect();
    let headers = [
        (CONTENT_TYPE, "application/toml".to_owned()),
        (
            CONTENT_DISPOSITION,
            format!("attachment; filename=\"{name}\""),
        ),
    ];
    (headers, motor.text).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_motor_file_can_be_chosen() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../motors");
        let entries = std::fs::read_dir(folder).expect("motors");
        let mut there: Vec<String> = entries
            .map(|entry| {
                entry
                    .expect("a file")
                    .file_name()
                    .to_string_lossy()
                    .into_owned()
            })
            .filter(|name| name.ends_with(".toml"))
            .collect();
        there.sort();
        let mut known = shipped_names();
        known.sort_unstable();
        assert_eq!(known, there, "each file of motors/ stands in SHIPPED");
        for (name, text) in SHIPPED {
            assert!(Motor::parse(name, text).is_ok(), "{name}");
        }
    }

    #[test]
    fn a_motor_file_that_is_none_is_refused_with_the_readers_words() {
        let refusal = Motor::parse("m.toml", "name = 3").expect_err("no motor");
        assert!(refusal.message.contains("m.toml:1"), "{}", refusal.message);
        assert!(!refusal.problems.is_empty());
    }
}
