//! The next experiment: what to do, and what it decides.

use maud::{Markup, html};

use crate::page::elements::number::{decimals, shown};
use crate::page::elements::place::Place;
use discovery::DesignGoal;

/// Nothing where no experiment was asked for.
pub fn section(result: &Place<'_>) -> Markup {
    if result.get("next_run").is_none() {
        return html! {};
    }
    let decides = result.items("next_run/decides");
    let gain = match result.read("next_run/goal") {
        Some(DesignGoal::Narrow) => "less of the standard error, %",
        Some(DesignGoal::Show) => "larger error of a model without it, %",
        _ => "larger error of the wrong explanation, %",
    };
    html! {
        section aria-labelledby="next-run" {
            h2 id="next-run" { "The next experiment" }
            p { (result.text("next_run/summary")) }
            ol { @for line in result.items("next_run/instructions") { li { (line.as_text()) } } }
            div.wide tabindex="0" { table {
                thead { tr { th scope="col" { "it decides" } th scope="col" { (gain) } th.word scope="col" { "how surely" } } }
                tbody { @for one in &decides { tr {
                    th scope="row" { (one.text("what")) }
                    td { (shown(one, "gain_percent", decimals(1))) }
                    td.word { (one.text("how_surely")) }
                } } }
            } }
            p.subtle { "The best of the usual runs: " (result.text("next_run/best_standard_run")) "." }
        }
    }
}
