//! What the frame of the monitor's model costs: bars before and after, and the first residual at every load.

use maud::{Markup, html};

use super::parameters::{Bar, bars};
use crate::page::elements::number::{decimals, shown};
use crate::page::elements::place::Place;

/// The section, empty unless `holder` (a step or an adoption) is about the frame.
pub fn section(holder: &Place<'_>) -> Markup {
    let Some(frame) = holder.get("frame") else {
        return html! {};
    };
    let bar = |label: &str, key, class| Bar {
        label: label.to_owned(),
        place: frame.clone(),
        key,
        class,
    };
    html! {
        section aria-labelledby="frame" {
            h2 id="frame" { "The monitor's first residual, before and after" }
            p { "On data that was not fitted, parameters refitted:" }
            (bars(&[
                bar("in the motor file's frame", "held_out_before", ""),
                bar("in the rotor-flux frame", "held_out_after", "chosen"),
            ]))
            p { "With the parameters of the motor file, over windows of steady running, percent of the voltage:" }
            div.wide tabindex="0" { table {
                thead { tr { th scope="col" { "load, %" } th scope="col" { "windows" } th scope="col" { "r1 in its frame, %" } th scope="col" { "r1 in the rotor-flux frame, %" } } }
                tbody { @for band in &frame.items("by_load") { tr {
                    th scope="row" { (shown(band, "load_percent", decimals(0))) }
                    td { (shown(band, "windows", decimals(0))) }
                    td { (shown(band, "r1_before_percent", decimals(3))) }
                    td { (shown(band, "r1_after_percent", decimals(3))) }
                } } }
            } }
        }
    }
}
