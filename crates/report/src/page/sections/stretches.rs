//! Which stretches of a long recording an answer is made of.

use maud::{Markup, html};

use crate::page::elements::number::{decimals, shown};
use crate::page::elements::place::Place;

/// The stretches with what they were taken for; nothing of a recording that was taken whole.
pub fn section(result: &Place<'_>) -> Markup {
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
