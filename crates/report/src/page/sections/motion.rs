//! What was judged while current, speed or supply changed.

use maud::{Markup, html};

use crate::page::elements::number::{decimals, shown};
use crate::page::elements::place::Place;
use replay::words;

/// The first alarm in motion, as a heading says it; `None` without one.
pub fn alarm(result: &Place<'_>) -> Option<Markup> {
    let alarms = result.items("motion/alarms");
    let first = alarms.first()?;
    Some(
        html! { "Fault in motion at " (shown(first, "raised_s", decimals(3))) " s: " (cause(first)) },
    )
}

/// How much was judged in motion, why the rest was not, and every alarm; `id`: of the heading.
pub fn section(result: &Place<'_>, id: &str) -> Markup {
    let Some(motion) = result.get("motion") else {
        return html! {};
    };
    let windows = motion.number("windows").unwrap_or_default();
    let alarms = motion.items("alarms");
    let unexplained = motion.items("unexplained");
    html! {
        @if windows > 0.0 {
            section aria-labelledby=(id) {
                h2 id=(id) { "In motion" }
                p {
                    @if motion.get("not_possible").is_some() {
                        "Windows that were not at rest were not judged: " (motion.text("not_possible")) "."
                    } @else {
                        (shown(&motion, "judged", decimals(0))) " of " (shown(&motion, "windows", decimals(0)))
                        " windows that were not at rest were judged" @if alarms.is_empty() && unexplained.is_empty() { "; no fault was seen" } "."
                    }
                }
                @for doubt in &unexplained {
                    p {
                        "From about " (shown(doubt, "onset_s", decimals(3))) " s on something does not fit (T = "
                        (shown(doubt, "statistic", decimals(1))) "): "
                        @match doubt.text("cause") {
                            "" => { "no fault of a size that occurs explains it. It may be " (words::UNEXPLAINED) "." }
                            cause => { "it looks like " (cause) ", but " (words::NEVER_SEEN_IN_MOTION) "." }
                        }
                    }
                }
                @if !alarms.is_empty() {
                    div.wide tabindex="0" { table {
                        thead { tr { th.word scope="col" { "cause" } th scope="col" { "first seen, s" } th scope="col" { "FAULT, s" } th scope="col" { "T" } } }
                        tbody { @for alarm in &alarms { tr {
                            th scope="row" { (cause(alarm)) }
                            td { (shown(alarm, "onset_s", decimals(3))) }
                            td { (shown(alarm, "raised_s", decimals(3))) }
                            td { (shown(alarm, "statistic", decimals(1))) }
                        } } }
                    } }
                }
            }
        }
    }
}

fn cause<'a>(alarm: &Place<'a>) -> &'a str {
    match alarm.text("cause") {
        "" => "it was over before its cause could be told",
        cause => cause,
    }
}
