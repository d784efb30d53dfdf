//! What the audit of a recording found, and what of a long one was used.

use maud::{Markup, html};

use crate::page::elements::number::{decimals, shown};
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

/// The stretches with what they were taken for; nothing of a recording that was taken whole.
pub fn used(result: &Place<'_>) -> Markup {
    let stretches = result.items("stretches");
    html! {
        @if !stretches.is_empty() {
            section aria-labelledby="stretches" {
                h2 id="stretches" { "What of the recording was used" }
                table {
                    thead { tr { th { "From, s" } th { "to, s" } th { "for" } th { "why" } } }
                    tbody { @for one in &stretches {
                        tr {
                            td.number { (shown(one, "from_s", decimals(1))) }
                            td.number { (shown(one, "to_s", decimals(1))) }
                            td { (purpose(one.text("role"))) }
                            td { (one.text("why")) }
                        }
                    } }
                }
            }
        }
    }
}

fn purpose(role: &str) -> &'static str {
    match role {
        "proves" => "proof: not fitted",
        _ => "fitted or compared",
    }
}
