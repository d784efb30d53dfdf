//! Reports in a sentence.

use crate::report::{ExplainReport, Verdict};

/// One sentence that says what was found.
pub(crate) fn summary(report: &ExplainReport) -> String {
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

fn named(step: &crate::report::StepReport) -> String {
    if step.tied_with.is_empty() {
        step.effect.clone()
    } else {
        format!("{} (or {})", step.effect, step.tied_with.join(" or "))
    }
}

#[cfg(test)]
mod tests;
