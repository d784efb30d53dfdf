//! Reports in a sentence.

use crate::report::types::{ExplainReport, Verdict};

/// Error over noise below which the noise cannot be what it is said to be: no model predicts noise that it was not fitted to.
const FAR_BELOW: f64 = 0.3;

/// What was found, in a sentence or two.
pub(crate) fn summary(report: &ExplainReport) -> String {
    let found = finding(report);
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
        Verdict::Adequate => format!("The model explains the recording.{moved}"),
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
        Verdict::Unknown => report.unexplained.as_ref().map_or_else(String::new, |u| {
            format!(
                "Something is missing that the library does not hold. {}",
                u.description
            )
        }),
        Verdict::Unsupported => "The recording cannot be judged.".to_owned(),
    }
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
