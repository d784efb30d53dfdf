//! The page of `drivemon monitor` on a load-test table.

use maud::{Markup, html};

use crate::page::elements::chart::{Chart, Kind, Series};
use crate::page::elements::number::{Style, decimals, shown};
use crate::page::elements::place::Place;
use crate::page::elements::shell::{Mood, verdict};

/// Columns: key, what it is, unit, how it is written.
const COLUMNS: [(&str, &str, &str, Style); 8] = [
    ("power_watt", "shaft power", "W", decimals(0)),
    ("torque_nm", "torque", "N m", decimals(1)),
    ("current_rms_amp", "line current", "A rms", decimals(2)),
    ("speed_rpm", "speed", "1/min", decimals(1)),
    ("slip_percent", "slip", "%", decimals(2)),
    ("power_factor", "power factor", "1", decimals(3)),
    ("efficiency", "efficiency", "1", decimals(3)),
    ("losses_watt", "losses", "W", decimals(0)),
];

/// Everything between heading and footer.
pub fn content(result: &Place<'_>) -> Markup {
    let points = result.items("operating_points");
    let present: Vec<_> = COLUMNS
        .into_iter()
        .filter(|(key, ..)| points.iter().any(|point| point.get(key).is_some()))
        .collect();
    let answer =
        html! { "A table has no waveforms: operating points are shown, no lamp is judged" };
    html! {
        (verdict(Mood::Caution, &answer, &html! { p.subtle { (result.text("table")) } }))
        div.charts { @for column in present.iter().skip(1) { (figure(result, column)) } }
        section aria-labelledby="numbers" {
            h2 id="numbers" { "All points" }
            div.wide tabindex="0" { table {
                thead { tr { @for (_, what, unit, _) in &present { th scope="col" { (what) ", " (unit) } } } }
                tbody { @for point in &points { tr {
                    @for (key, _, _, style) in &present { td { (shown(point, key, *style)) } }
                } } }
            } }
        }
    }
}

fn figure(result: &Place<'_>, (key, what, unit, _): &(&str, &str, &'static str, Style)) -> Markup {
    let at = |key: &str| result.pointer_to(&format!("operating_points/*/{key}"));
    Chart::over("shaft power", "W", at("power_watt"))
        .y(what, unit)
        .with(Series::line(what, at(key), "blue").kind(Kind::Marked))
        .figure(what, "")
}
