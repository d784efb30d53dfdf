//! What the recorder's channels are off by, where that is part of an explanation.

use maud::{Markup, html};

use crate::page::elements::number::{decimals, shown};
use crate::page::elements::place::Place;
use crate::page::sections::parameters::Bar;

/// The refitted model beside the channels.
pub const WITH: &str = "beside what the channels are off by";

/// Key of the error without what the channels are off by.
pub const WITHOUT: &str = "held_out_error_over_noise_without";

/// The error of the refitted model with the channels taken as they are.
pub fn without<'a>(channels: &Place<'a>) -> Bar<'a> {
    Bar {
        label: "all parameters refitted, nothing added".to_owned(),
        place: channels.clone(),
        key: WITHOUT,
        class: "",
    }
}

/// Each channel with its gain and zero; nothing where channels are no part of the answer.
pub fn section(result: &Place<'_>) -> Markup {
    let channels = result.items("channels/channels");
    if channels.is_empty() {
        return html! {};
    }
    html! {
        section aria-labelledby="channels" {
            h2 id="channels" { "What the recorder's channels are off by" }
            p.subtle { "Gains and zeros, taken as unknown: gains are believed to be right within class 0.5 (0.3 % of the reading, standard deviation). They belong to the recorder: " code { "adopt" } " leaves them out of the motor file." }
            div.wide tabindex="0" { table {
                thead { tr { th scope="col" { "channel" } th scope="col" { "gain error, %" } th scope="col" { "zero" } th.word scope="col" { "" } th scope="col" { "zero, % of rated" } th.word scope="col" { "" } } }
                tbody { @for channel in &channels { tr {
                    th scope="row" { (channel.text("channel")) }
                    td { (shown(channel, "gain_error_percent", decimals(2).signed())) }
                    td { (shown(channel, "zero", decimals(3).signed())) }
                    td.word { (channel.text("unit")) }
                    td { (shown(channel, "zero_percent_of_rated", decimals(2).signed())) }
                    td.word { @if !channel.is_true("is_within_class") { strong { "beyond class 0.5" } } }
                } } }
            } }
            @for lag in &result.items("channels/lags") {
                p { (lag.text("instrument")) ": " (shown(lag, "late_by_second", decimals(1).times(1e3))) " ms late" }
            }
        }
    }
}
