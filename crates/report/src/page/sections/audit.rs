//! What the audit of a recording found.

use maud::{Markup, html};

use crate::page::elements::place::Place;

/// The findings under a heading; nothing found is said too.
pub fn section(result: &Place<'_>) -> Markup {
    let findings = result.items("audit/findings");
    html! {
        section aria-labelledby="audit" {
            h2 id="audit" { "The recording itself" }
            @for assumption in result.items("audit/assumptions") {
                p { "Assumed: " (assumption.as_text()) }
            }
            @if findings.is_empty() {
                p { "The audit of clock, wiring, units, ranges and supply found nothing to object to." }
            } @else {
                ul.findings { @for finding in &findings { (one(finding)) } }
            }
        }
    }
}

fn one(finding: &Place<'_>) -> Markup {
    html! {
        li.refuses[finding.is_true("refuses")] {
            strong { (finding.text("code")) " " (finding.text("channel")) ": " }
            (finding.text("detail"))
        }
    }
}
