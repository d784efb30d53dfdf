//! The result of a command as one self-contained HTML page: no network, the same JSON embedded.
//!
//! Every number on a page is taken from the JSON through a [`Place`], which remembers where it stands there;
//! figures are drawn in the browser by an embedded chart library from the embedded JSON. So a page can show
//! nothing that the JSON does not hold.

mod commands;
mod elements;
mod sections;

pub use commands::compare::AGREES;
pub use elements::number::{Style, decimals, significant};
pub use elements::place::Place;

use crate::json::{self, Answer};
use commands::{adopt, campaign, check, compare, demo, explain, load_table, monitor, month};
use elements::shell;
use serde::Serialize;
use serde_json::Value;

/// Which command's result a page shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// `drivemon demo`.
    Demo,
    /// `drivemon monitor` on a recording.
    Monitor,
    /// `drivemon monitor` on a load-test table.
    LoadTable,
    /// `drivemon compare`.
    Compare,
    /// `drivemon explain`.
    Explain,
    /// `drivemon adopt`.
    Adopt,
    /// `drivemon campaign table`.
    Campaign,
    /// `drivemon check`.
    Check,
    /// `drivemon fleet report`.
    FleetMonth,
}

/// The page for a result, complete.
///
/// # Errors
/// A result that is no JSON.
pub fn page(subject: Subject, result: &impl Answer) -> Result<String, serde_json::Error> {
    page_of_json(subject, &json::value(result)?)
}

/// The page for the JSON of a result, complete.
///
/// # Errors
/// None with a value that JSON can say.
pub fn page_of_json(subject: Subject, value: &Value) -> Result<String, serde_json::Error> {
    let (title, content) = content(subject, value);
    Ok(shell::page(title, &content, &serde_json::to_string(value)?))
}

/// What a page holds between heading and footer, for pages that have their own.
#[derive(Clone, Debug, Serialize)]
pub struct Fragment {
    /// The heading.
    pub title: &'static str,
    /// HTML without scripts; figures are drawn by `report.js` from `result`.
    pub html: String,
    /// The result that every number comes from.
    pub result: Value,
}

/// The fragment for a result.
///
/// # Errors
/// A result that is no JSON.
pub fn fragment(subject: Subject, result: &impl Answer) -> Result<Fragment, serde_json::Error> {
    let result = json::value(result)?;
    let (title, content) = content(subject, &result);
    Ok(Fragment {
        title,
        html: content.into_string(),
        result,
    })
}

/// Heading and content.
fn content(subject: Subject, value: &Value) -> (&'static str, maud::Markup) {
    let place = Place::root(value);
    match subject {
        Subject::Demo => ("Table 1 on a simulated motor", demo::content(&place)),
        Subject::Monitor => ("What the lamps would have shown", monitor::content(&place)),
        Subject::LoadTable => (
            "Operating points of a load test",
            load_table::content(&place),
        ),
        Subject::Compare => ("Where the model fails", compare::content(&place)),
        Subject::Explain => ("Which physics the model misses", explain::content(&place)),
        Subject::Adopt => ("A model made better", adopt::content(&place)),
        Subject::Campaign => (
            "What the lamps can be trusted with",
            campaign::content(&place),
        ),
        Subject::Check => ("Is this motor in good order?", check::content(&place)),
        Subject::FleetMonth => ("A month of a plant", month::content(&place)),
    }
}
