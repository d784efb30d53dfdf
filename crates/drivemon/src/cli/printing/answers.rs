//! The answers of one command about several recordings: each by itself on the terminal, a list in the JSON.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::{OutputArgs, text_of};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::{self, say};
use crate::cli::told;
use report::Subject;
use report::json::Answer;

/// Where an answer goes: straight out where it is the only one, into the list where it is one of several.
pub struct Answers<'a> {
    output: &'a OutputArgs,
    /// The JSON of each answer so far; `None` where there is one recording.
    list: Option<Vec<String>>,
}

/// Exit codes from the worst to the best: bad input, something found, not judged, nothing found.
const WORST_FIRST: [(u8, &str); 4] = [
    (2, "not read"),
    (1, "FAULT"),
    (3, "not judged"),
    (0, "nothing found"),
];

/// Asks `judge` about every recording; one that fails leaves the others their answer. Returns the worst exit code.
///
/// # Errors
/// Of a single recording whatever `judge` returns; of several a path that cannot be written.
pub fn each(
    recordings: &[PathBuf],
    output: &OutputArgs,
    mut judge: impl FnMut(&PathBuf, &mut Answers<'_>) -> Result<Finding, Failure>,
) -> Result<Finding, Failure> {
    let list = (recordings.len() > 1).then(Vec::new);
    let mut answers = Answers { output, list };
    if let [recording] = recordings {
        return judge(recording, &mut answers);
    }
    if output.report.is_some() {
        return Err(Failure::Usage(ONE_PAGE.to_owned()));
    }
    let mut codes = Vec::new();
    for (k, recording) in recordings.iter().enumerate() {
        if k > 0 {
            output.json.show(|| say!(""));
        }
        let code = match judge(recording, &mut answers) {
            Ok(finding) => finding.exit_code(),
            Err(failure) => answers.refused(recording, &failure)?,
        };
        codes.push(code);
    }
    answers.write()?;
    output.json.show(|| summary(recordings, &codes));
    Ok(worst(&codes))
}

/// A recording that could not be read, among others.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Refused {
    /// The file.
    recording: String,
    /// Why, and what to do about it.
    error: String,
}

impl Answer for Refused {
    const FORMAT: &'static str = "refused/1";
}

/// A page shows one recording.
const ONE_PAGE: &str =
    "--report draws one recording, and several are named: ask for the page of each by itself";

impl Answers<'_> {
    /// Takes an answer: the files first, then `show` on the terminal.
    ///
    /// # Errors
    /// A path that cannot be written.
    pub fn give(
        &mut self,
        subject: Subject,
        value: &impl Answer,
        show: impl FnOnce(),
    ) -> Result<(), Failure> {
        let Some(list) = &mut self.list else {
            return self.output.give(subject, value, show);
        };
        if self.output.json.json.is_some() {
            list.push(text_of(value)?);
        }
        self.output.json.show(show);
        Ok(())
    }

    fn refused(&mut self, recording: &Path, failure: &Failure) -> Result<u8, Failure> {
        let name = recording.display().to_string();
        let answer = Refused {
            recording: name.clone(),
            error: failure.to_string(),
        };
        self.list.get_or_insert_default().push(text_of(&answer)?);
        self.output.json.show(|| say!("{}", paint::strong(name)));
        terminal::flush();
        Ok(told(failure))
    }

    fn write(&self) -> Result<(), Failure> {
        let list = self.list.as_deref().unwrap_or_default();
        let text = format!("[\n{}\n]", list.join(",\n"));
        self.output.json.write_text(&text)
    }
}

fn summary(recordings: &[PathBuf], codes: &[u8]) {
    say!("\n{} recordings:", recordings.len());
    for (code, words) in WORST_FIRST {
        let of_code = codes.iter().zip(recordings).filter(|(c, _)| **c == code);
        for (_, recording) in of_code {
            say!("  {words:<13} {}", recording.display());
        }
    }
}

fn worst(codes: &[u8]) -> Finding {
    let found = WORST_FIRST.iter().find(|(code, _)| codes.contains(code));
    match found {
        Some((2, _)) => Finding::NotRead,
        Some((1, _)) => Finding::Something,
        Some((3, _)) => Finding::Unsupported,
        _ => Finding::Nothing,
    }
}
