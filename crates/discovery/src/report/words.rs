//! Reports in a sentence.

use crate::report::law::{BurstsReport, LawReport};
use crate::report::types::{ExplainReport, FitReport, Unexplained, Verdict};
use estimation::proof::accept::ADEQUATE;
use estimation::proof::channels::ChannelsReport;
use estimation::proof::windings::told;

/// Error over noise below which the noise cannot be what it is said to be: no model predicts noise that it was not fitted to.
const FAR_BELOW: f64 = 0.3;

/// What was found, in a sentence or two.
pub(crate) fn summary(report: &ExplainReport) -> String {
    let windings = report.final_.as_ref().map_or(&[][..], |f| &f.windings);
    let channels = report.channels.as_ref();
    let found = format!(
        "{}{}{}{}",
        finding(report),
        channels.map_or_else(String::new, ChannelsReport::told),
        told(windings),
        report.fitted.told()
    );
    let error = report.final_.as_ref().map(|f| f.held_out_error_over_noise);
    match error {
        Some(error) if error < FAR_BELOW => format!(
            "{found} The error is only {error:.2} x noise: the recording holds less noise than its instruments declare; with the \
             right noise smaller errors show."
        ),
        _ => found,
    }
}

fn finding(report: &ExplainReport) -> String {
    let off: Vec<String> = report
        .final_
        .iter()
        .flat_map(|f| &f.parameters)
        .filter(|p| p.off)
        .map(|p| format!("{} {:+.1} %", p.name, p.change_percent))
        .collect();
    let moved = if off.is_empty() {
        String::new()
    } else {
        format!(" Parameters that are off: {}.", off.join(", "))
    };
    let effects: Vec<String> = report.steps.iter().map(named).collect();
    match report.verdict {
        Verdict::Law => format!("{}{moved}", laws(report, &effects)),
        Verdict::Adequate => format!("The model explains the recording{}.{moved}", as_far(report)),
        Verdict::Effect => format!("Missing: {}.{moved}", effects.join("; ")),
        Verdict::Ambiguous => {
            let test = report.steps.iter().find(|s| !s.tied_with.is_empty());
            let test = test.map_or("", |s| s.separating_test.as_str());
            format!(
                "Missing: {}. To separate: {test}.{moved}",
                effects.join("; ")
            )
        }
        Verdict::Implausible => {
            format!("Only parameters that no such motor has explain the recording.{moved}")
        }
        Verdict::Unknown => report
            .unexplained
            .as_ref()
            .map_or_else(String::new, |rest| unknown(report, rest)),
        Verdict::Unsupported => "The recording cannot be judged.".to_owned(),
    }
}

/// Where a model counts as adequate because the noise is hardly known: what it leaves.
fn as_far(report: &ExplainReport) -> String {
    let error = |f: &FitReport| f.held_out_error_over_noise.max(f.fold_error_over_noise);
    let left = report.final_.as_ref().map(error);
    left.filter(|error| *error >= ADEQUATE)
        .map_or_else(String::new, |error| {
            format!(
                " as far as its noise is known: the error is {error:.2} x noise, no more than the noise is uncertain"
            )
        })
}

/// What is said of an error that nothing was proven to explain.
fn unknown(report: &ExplainReport, rest: &Unexplained) -> String {
    if rest.each_alone.is_some() {
        return rest.description.clone();
    }
    if let Some(lead) = rest.sufficient_lead() {
        return format!(
            "Something is missing, but too few moments of the recording show it to prove what: {lead} would explain it. Record more starts and more steps of load and voltage. {}",
            rest.description
        );
    }
    let law = report.laws.first().map_or_else(String::new, |law| {
        format!(
            " Best lead: {} explains {:.0} % of the excess; a further recording with other loads and speeds can prove it.",
            law.name(),
            law.explained_percent.min(100.0)
        )
    });
    format!(
        "Something is missing that the library does not hold. {}{law}",
        rest.description
    )
}

/// Effects and laws that are missing.
fn laws(report: &ExplainReport, effects: &[String]) -> String {
    let law = |law: &LawReport| {
        let tied = law.tied_with.iter();
        let others: Vec<String> = tied
            .map(|t| format!("{} over {}", t.place, t.coordinate))
            .collect();
        let or = match others.is_empty() {
            true => String::new(),
            false => format!(" (or {})", others.join(" or ")),
        };
        let (before, after) = (
            law.held_out_error_over_noise_without,
            law.held_out_error_over_noise,
        );
        format!(
            "{}{or}{}; with it the error falls from {before:.2} to {after:.2} x noise on the recording that was not fitted",
            law.name(),
            law.bursts.as_ref().map_or_else(String::new, often)
        )
    };
    let proven = report.laws.iter().filter(|law| law.proven).map(law);
    let laws = proven.collect::<Vec<String>>().join("; ");
    match effects {
        [] => format!("Missing, a law that the library does not hold: {laws}."),
        some => format!(
            "Missing: {}, and a law that the library does not hold: {laws}.",
            some.join("; ")
        ),
    }
}

/// How often something comes, and how large it is.
fn often(bursts: &BurstsReport) -> String {
    format!(
        ", {} times, {:.1} % of the time, {:.3} to {:.3} {}",
        bursts.count, bursts.share_of_time_percent, bursts.smallest, bursts.largest, bursts.unit
    )
}

fn named(step: &crate::report::types::StepReport) -> String {
    if step.tied_with.is_empty() {
        step.effect.clone()
    } else {
        format!("{} (or {})", step.effect, step.tied_with.join(" or "))
    }
}

#[cfg(test)]
mod tests;
