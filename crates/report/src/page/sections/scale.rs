//! A speed of unknown scale, and what it leaves open.

use maud::{Markup, html};

use crate::page::elements::number::{decimals, shown, significant};
use crate::page::elements::place::Place;
use discovery::{AtRest, ErrorSource};

/// The fitted scale and what cannot be concluded beside it; nothing where every scale is known.
pub fn section(result: &Place<'_>) -> Markup {
    let Some(scale) = result.get("speed_scale") else {
        return html! {};
    };
    let open = result.items("cannot_be_concluded");
    html! {
        section aria-labelledby="scale" {
            h2 id="scale" { "What cannot be concluded: the scale of the speed is unknown" }
            p {
                "It was declared unknown and is a free parameter of every model here. Fitted: speed = ("
                (shown(&scale, "factor", significant(5))) " ± " (shown(&scale, "std_error", significant(2))) ") "
                (scale.text("unit")) " × (column − " (shown(&scale, "offset", significant(5))) @if scale.number("offset_std_error") > Some(0.0) { " ± " (shown(&scale, "offset_std_error", significant(2))) } "), the reading at rest "
                (origin(scale.read("offset_is").unwrap_or(AtRest::Assumed))) "."
                @if scale.read("std_error_is") == Some(ErrorSource::Physics) {
                    " No model here explains the recording, so the factor is only as sure as physics makes it: the least slip lies between none and that of rated load."
                }
            }
            @if open.is_empty() { p { "Every parameter keeps its uncertainty beside it." } } @else {
                div.wide tabindex="0" { table {
                    thead { tr { th scope="col" { "not concluded" } th scope="col" { "± standard error, %" } th scope="col" { "with a known scale, %" } th.word scope="col" { "" } } }
                    tbody { @for row in &open { tr {
                        th scope="row" { (row.text("name")) }
                        td { (percent(row, "std_error_percent")) }
                        td { (percent(row, "std_error_with_known_scale_percent")) }
                        td.word { (row.text("why")) }
                    } } }
                } }
            }
        }
    }
}

fn percent(row: &Place<'_>, key: &str) -> Markup {
    match row.get(key) {
        Some(_) => shown(row, key, decimals(1)),
        None => html! { "–" },
    }
}

fn origin(at_rest: AtRest) -> &'static str {
    match at_rest {
        AtRest::Given => "as given",
        AtRest::Measured => "read while the motor stood",
        AtRest::Assumed => "assumed, because the recording does not hold the motor at rest",
    }
}
