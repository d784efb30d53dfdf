//! Which physical effect a model misses.

use discovery::{Asked, Error, ExplainReport, LAW, Progress, Sources, Verdict};
use schemars::JsonSchema;
use serde::Serialize;

use super::places::{Place, furthest_off, worst};
use super::{Inputs, PARAMETERS, shown};
use crate::overlay::{Model, Overlay, TableOverlay};

/// Share of the work that the search takes; the rest goes into the worst places.
const SEARCH: f64 = 0.9;

/// Everything that an explanation says.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Explained {
    /// The recordings, the fitted one first.
    pub recordings: Vec<String>,
    /// The motor's name.
    pub motor: String,
    /// What to do next.
    pub next: Next,
    /// The worst places of the fitted recording, with the model as the motor file says.
    pub where_it_fails: Vec<Place>,
    /// The explanation itself.
    #[serde(flatten)]
    pub report: ExplainReport,
    /// Measured and modelled signals of the last recording.
    pub overlay: Option<Overlay>,
    /// The same for a load table.
    pub table_overlay: Option<TableOverlay>,
}

/// What to do next.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Next {
    /// In words.
    pub why: String,
    /// The name to adopt, where there is one.
    pub adopt: Option<String>,
    /// What to type, where there is something.
    pub command: Option<String>,
}

impl Explained {
    /// Searches the missing effect; `command` gives what to type for adopting a name from recordings in this order.
    ///
    /// # Errors
    /// As [`discovery::explain`].
    pub fn new(
        inputs: Inputs<'_>,
        command: &dyn Fn(&str, &[String]) -> Option<String>,
        progress: &mut Progress<'_>,
    ) -> Result<Self, Error> {
        let Inputs {
            sources,
            motor,
            laws,
            next_run,
            ..
        } = inputs;
        let asked = Asked {
            laws,
            next_run: next_run.cloned(),
        };
        let searched = discovery::explain_with(sources, motor, asked, &mut |what, share| {
            progress(what, SEARCH * share)
        });
        let report = searched?;
        let (names, sources) = inputs.as_answered(report.fitted);
        let sources = Sources::Listed(&sources);
        let scale = report.speed_scale.as_ref();
        let proof = report.fitted.proof_of(names.len().saturating_sub(1));
        let models = Model::of_explanation(motor, &report, proof);
        let is_judged = report.baseline.is_some();
        let where_it_fails = match is_judged {
            true => worst(&discovery::compare(sources, motor, &mut |what, share| {
                progress(what, SEARCH + (1.0 - SEARCH) * share);
            })?),
            false => Vec::new(),
        };
        let last = sources.iter().next_back().filter(|_| is_judged);
        // The worst places are the fitted recording's.
        let at_s = match names.len() {
            1 => furthest_off(&where_it_fails),
            _ => 0.0,
        };
        let last = last.and_then(|source| shown(source, scale, at_s));
        let judged = last.as_deref();
        Ok(Explained {
            motor: motor.name.clone(),
            next: Next::new(&report, &|name| command(name, &names)),
            where_it_fails,
            overlay: judged
                .and_then(|source| Overlay::new(source, &models))
                .map(|overlay| overlay.named(names.last())),
            table_overlay: judged
                .and_then(|source| TableOverlay::new(source, motor, &models))
                .map(|overlay| overlay.named(names.last())),
            recordings: names,
            report,
        })
    }
}

impl Explained {
    /// Heading of the worst places, which are those of the fitted recording.
    pub fn title_of_the_worst(&self) -> &'static str {
        match self.recordings.len() {
            0 | 1 => "The model of the motor file is furthest off",
            _ => "The model of the motor file is furthest off in the fitted recording",
        }
    }
}

impl Next {
    fn new(report: &ExplainReport, command: &dyn Fn(&str) -> Option<String>) -> Next {
        let (why, adopt) = match (report.verdict, report.steps.first()) {
            (Verdict::Effect, Some(step)) => (
                format!("Add {} to the model:", step.effect),
                Some(step.effect.clone()),
            ),
            (Verdict::Ambiguous, Some(step)) => (
                "Measure first what separates them, or take the first of the tie:".to_owned(),
                Some(step.effect.clone()),
            ),
            (Verdict::Law, _) if comes_and_goes(report) => (
                "Find what is loose, worn or sticks there and mend it: it is a fault, no law that a model could hold."
                    .to_owned(),
                None,
            ),
            (Verdict::Law, _) => ("Add the law to the model:".to_owned(), Some(LAW.to_owned())),
            (Verdict::Adequate, _) if something_else_is_off(report) => (
                "Take over the refitted parameters:".to_owned(),
                Some(PARAMETERS.to_owned()),
            ),
            _ => (nothing_to_adopt(report), None),
        };
        Next {
            command: adopt.as_deref().and_then(command),
            why,
            adopt,
        }
    }
}

/// Whether what was found last comes and goes.
fn comes_and_goes(report: &ExplainReport) -> bool {
    let last = report.laws.iter().rfind(|law| law.proven);
    last.is_some_and(|law| law.bursts.is_some())
}

fn nothing_to_adopt(report: &ExplainReport) -> String {
    let advice = match report.verdict {
        Verdict::Adequate if something_was_changed(report) => {
            "Find out what was changed: the model is adequate for each recording with its resistances."
        }
        Verdict::Adequate if anything_off(report) => {
            "Nothing to take over: resistances that are off move with the temperature, from one recording to the next."
        }
        Verdict::Adequate => "Nothing to do: the model is adequate.",
        Verdict::Unsupported => "Record again as the audit says.",
        Verdict::Implausible => {
            "Check nameplate, connection and scales of the sensors before anything else."
        }
        _ if is_explained_each_alone(report) => {
            "Record both with the same machine on the shaft, or ask about each alone."
        }
        _ => {
            "Record more of what the description names, with a second load and a second voltage. \
             If you suspect what it is, write it as a formula into the motor file: docs/adding-an-effect.md."
        }
    };
    advice.to_owned()
}

/// Whether two recordings ask for other parameters, and nothing is missing in either of them.
fn is_explained_each_alone(report: &ExplainReport) -> bool {
    let rest = report.unexplained.as_ref();
    rest.is_some_and(|rest| rest.each_alone.is_some())
}

/// Whether a recording that proves asks for resistances that no temperature makes.
fn something_was_changed(report: &ExplainReport) -> bool {
    let mut windings = report.final_.iter().flat_map(|fit| &fit.windings);
    windings.any(|windings| !windings.is_temperature)
}

/// Whether a refitted parameter is far from what was believed, for another reason than the motor's temperature.
fn something_else_is_off(report: &ExplainReport) -> bool {
    let mut last = report.final_.iter();
    last.any(|fit| {
        let moves = |name: &str| !fit.windings.is_empty() && name.ends_with("resistance_ohm");
        let mut parameters = fit.parameters.iter();
        parameters.any(|parameter| parameter.off && !moves(&parameter.name))
    })
}

/// Whether a refitted parameter is far from what was believed.
pub fn anything_off(report: &ExplainReport) -> bool {
    let last = report.final_.iter().flat_map(|fit| &fit.parameters);
    last.into_iter().any(|parameter| parameter.off)
}

#[cfg(test)]
mod tests;
