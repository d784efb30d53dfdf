//! Measured and modelled points of a load table, against the load.

use maud::{Markup, html};

use super::models::models;
use crate::page::elements::chart::{Chart, Kind, Series};
use crate::page::elements::place::Place;

/// Columns: key, what it is, unit.
const COLUMNS: [(&str, &str, &str); 4] = [
    ("current_rms_amp", "line current", "A rms"),
    ("speed_rpm", "speed", "1/min"),
    ("power_factor", "power factor", "1"),
    ("efficiency", "efficiency", "1"),
];

/// The figures; nothing where there is no table.
pub fn section(result: &Place<'_>) -> Markup {
    let Some(overlay) = result.get("table_overlay") else {
        return html! {};
    };
    let points = overlay.items("points");
    let is_measured = |key: &str| {
        points
            .iter()
            .any(|p| p.get(&format!("measured/{key}")).is_some())
    };
    html! {
        section aria-labelledby="overlay" {
            h2 id="overlay" { "Measured and modelled, against the load" }
            p.subtle { "Every point of " (overlay.text("recording")) ". Where a line leaves the dots, the model fails." }
            div.charts { @for column in COLUMNS { @if is_measured(column.0) { (figure(&overlay, column)) } } }
        }
    }
}

fn figure(overlay: &Place<'_>, (key, what, unit): (&str, &str, &'static str)) -> Markup {
    let at = |key: &str| overlay.pointer_to(&format!("points/*/{key}"));
    let measured = Series::line("measured", at(&format!("measured/{key}")), "blue");
    let mut chart = Chart::over("load", "% of rated", at("load_percent"))
        .y(what, unit)
        .with(measured.kind(Kind::Points));
    for (k, (label, colour)) in models(overlay).into_iter().enumerate() {
        let from = at(&format!("modelled/{k}/{key}"));
        chart = chart.with(Series::line(&label, from, colour).dashed(k));
    }
    chart.figure(what, "")
}
