//! One printer for each language.

mod c;
mod fmu;
mod infix;
mod libraries;
mod matlab;
mod modelica;
mod page;
mod python;

use crate::model::Model;
use page::harmless;

pub use libraries::{Library, parameters};

/// What a model is written for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// Python without libraries.
    Python,
    /// C99: a source and a header.
    C,
    /// MATLAB and Octave.
    Matlab,
    /// Modelica.
    Modelica,
    /// A functional mock-up unit.
    Fmu,
}

impl Language {
    /// How the name of its file ends.
    pub fn ending(self) -> &'static str {
        match self {
            Language::Python => "py",
            Language::C => "c",
            Language::Matlab => "m",
            Language::Modelica => "mo",
            Language::Fmu => "fmu",
        }
    }

    /// How files beside it end, in the order of [`files`].
    pub fn beside(self) -> &'static [&'static str] {
        match self {
            Language::C => &["h"],
            _ => &[],
        }
    }
}

/// What a printer is told beside the model.
#[derive(Clone, Debug)]
pub struct Job<'a> {
    /// Name of the model, as of [`model_name`].
    pub name: String,
    /// What it comes from.
    pub source: &'a str,
    /// Version of the program.
    pub version: &'a str,
}

/// A file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its content.
    pub content: Vec<u8>,
    /// What the user should know of it.
    pub remarks: Vec<String>,
}

impl File {
    fn text(text: String) -> File {
        File {
            content: text.into_bytes(),
            remarks: Vec::new(),
        }
    }
}

/// The files of a model in a language; the first is the one that people use.
///
/// # Errors
/// A model that the language cannot hold.
pub fn files(
    model: &Model,
    language: Language,
    job: &Job<'_>,
) -> Result<Vec<File>, crate::ExportError> {
    let mut files = match language {
        Language::Python => python::files(model, job),
        Language::C => c::files(model, job),
        Language::Matlab => matlab::files(model, job),
        Language::Modelica => modelica::files(model, job)?,
        Language::Fmu => fmu::files(model, job)?,
    };
    if let Some(first) = files.first_mut() {
        first.remarks.splice(0..0, model.remarks.iter().cloned());
    }
    Ok(files)
}

/// Words that no language takes as a name.
const WORDS: [&str; 24] = [
    "and", "break", "class", "do", "else", "end", "for", "from", "function", "if", "import", "in",
    "int", "is", "math", "model", "not", "or", "package", "return", "switch", "time", "when",
    "while",
];

/// The name of a model: letters, digits and underlines of ASCII, a letter first, no word of a language.
pub fn model_name(text: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = text.chars().map(plain).collect();
    match name.starts_with(|c: char| c.is_ascii_alphabetic()) && !WORDS.contains(&name.as_str()) {
        true => name,
        false => format!("motor_{name}"),
    }
}

/// The remarks of a model as comment lines.
fn remarks(model: &Model, before: &str) -> String {
    let line = |remark: &String| format!("{before}{}.\n", harmless(remark));
    model.remarks.iter().map(line).collect()
}
