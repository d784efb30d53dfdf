//! What the audit of a recording found.

use maud::{Markup, html};

use crate::page::elements::place::Place;

/// The findings under a heading; nothing found is said too.
pub fn section(result: &Place<'_>) -> Markup {
    section_of(result, "audit", "")
}

/// The same of one of several recordings.
pub fn section_of(result: &Place<'_>, id: &str, name: &str) -> Markup {
    let findings = result.items("audit/findings");
    html! {
        section aria-labelledby=(id) {
            h2 id=(id) { "The recording itself" }
            @if !name.is_empty() { p.subtle { (name) } }
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
