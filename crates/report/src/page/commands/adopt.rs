//! The page of `drivemon adopt`: before and after.

use maud::{Markup, html};

use super::explain::proof;
use crate::page::elements::number::{decimals, shown};
use crate::page::elements::place::Place;
use crate::page::elements::shell::{Mood, cards, next, verdict};
use crate::page::sections::parameters::{Bar, NOISE, bars, nominals, of_effect};
use crate::page::sections::{audit, frame, laws, overlay, scale};
use discovery::PARAMETERS;

/// Everything between heading and footer.
pub fn content(result: &Place<'_>) -> Markup {
    html! {
        (answer(result))
        (cards(&summary(result)))
        @if !result.text("next_command").is_empty() {
            (next("Is anything still missing?", result.text("next_command")))
        }
        (errors(result))
        (frame::section(result))
        (laws::section(result))
        (overlay::section(result))
        (values(result))
        (scale::section(result))
        (audit::used(result))
        (audit::section(result))
    }
}

fn answer(result: &Place<'_>) -> Markup {
    let effect = result.text("effect");
    let after = html! {
        (shown(result, "before/held_out_error_over_noise", decimals(2))) " to "
        (shown(result, "after/held_out_error_over_noise", decimals(2))) " times the noise"
    };
    let (mood, text) = match (effect, result.is_true("proven")) {
        ("parameters", true) => (
            Mood::Good,
            html! { "The refitted parameters take the error from " (after) },
        ),
        ("parameters", false) => (
            Mood::Caution,
            html! { "Nothing is gained by refitted parameters: " (after) },
        ),
        (_, true) => (
            Mood::Good,
            html! { (effect) " takes the error from " (after) },
        ),
        (_, false) => (
            Mood::Caution,
            html! { "The gain of " (effect) " is not proven: " (after) },
        ),
    };
    let file = result.text("motor_file");
    let more = html! {
        p.subtle {
            (result.text("motor")) ", " (proof(result)) ". Errors on data that was not fitted. "
            @if file.is_empty() { "No motor file is written." } @else { "Motor file: " code { (file) } }
        }
    };
    verdict(mood, &text, &more)
}

/// Errors: where they stand and what they are.
const ERRORS: [(&str, &str, &str); 4] = [
    (
        "before",
        "held_out_error_over_noise",
        "before, data that was not fitted",
    ),
    (
        "after",
        "held_out_error_over_noise",
        "after, data that was not fitted",
    ),
    ("before", "error_over_noise", "before, fitted data"),
    ("after", "error_over_noise", "after, fitted data"),
];

fn summary(result: &Place<'_>) -> Vec<(Markup, Markup)> {
    let card = |(when, key, what): (&str, &str, &str)| {
        let path = format!("{when}/{key}");
        (
            html! { (shown(result, &path, decimals(3))) " × noise" },
            html! { (what) },
        )
    };
    ERRORS.into_iter().map(card).collect()
}

fn errors(result: &Place<'_>) -> Markup {
    let row = |(when, key, what): (&str, &'static str, &str)| {
        Some(Bar {
            label: what.to_owned(),
            place: result.get(when)?,
            key,
            class: if when == "after" { "chosen" } else { "" },
        })
    };
    let rows: Vec<Bar<'_>> = ERRORS.into_iter().filter_map(row).collect();
    let before = match result.text("effect") {
        PARAMETERS => " Before: the motor file as it is; after: all parameters refitted.",
        _ => " Before and after, all parameters are refitted.",
    };
    html! {
        section aria-labelledby="fall" {
            h2 id="fall" { "Error before and after" }
            (bars(&rows))
            p.subtle { (NOISE) (before) }
        }
    }
}

fn values(result: &Place<'_>) -> Markup {
    let effect = result.items("parameters");
    html! {
        section aria-labelledby="parameters" {
            h2 id="parameters" {
                @if result.text("motor_file").is_empty() { "What the fit found" } @else { "What the new motor file holds" }
            }
            @if !effect.is_empty() { (of_effect(&effect)) }
            (nominals(&result.items("nominals")))
        }
    }
}
