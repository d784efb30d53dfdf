//! The page of `drivemon explain`: what is missing, how sure that is, what to do next.

mod channels;

use maud::{Markup, html};

use crate::page::elements::number::{decimals, shown};
use crate::page::elements::place::Place;
use crate::page::elements::shell::{Mood, cards, next, verdict};
use crate::page::sections::parameters::{Bar, NOISE, bar, bars, nominals, of_effect};
use crate::page::sections::{audit, frame, laws, next_run, overlay, scale};
use discovery::{Fitted, Verdict};

/// Key of the error on data that was not fitted.
const HELD_OUT: &str = "held_out_error_over_noise";

/// Everything between heading and footer.
pub fn content(result: &Place<'_>) -> Markup {
    let steps = result.items("steps");
    html! {
        (answer(result, &steps))
        (cards(&summary(result, &steps)))
        (next(result.text("next/why"), result.text("next/command")))
        (errors(result, &steps))
        (where_it_fails(result))
        @for (k, step) in steps.iter().enumerate() { (effect(step, k)) (frame::section(step)) }
        (laws::section(result))
        (channels::section(result))
        (unexplained(result))
        (overlay::section(result))
        (ranking(result, &steps))
        (fitted(result))
        (scale::section(result))
        (not_testable(result))
        (next_run::section(result))
        (audit::used(result))
        (audit::section(result))
    }
}

fn answer(result: &Place<'_>, steps: &[Place<'_>]) -> Markup {
    let names: Vec<&str> = steps.iter().map(|step| step.text("effect")).collect();
    let (mood, text) = match result.read("verdict").unwrap_or(Verdict::Unsupported) {
        Verdict::Adequate if any_off(result) => (
            Mood::Caution,
            "The model is adequate, but parameters are off".to_owned(),
        ),
        Verdict::Adequate => (Mood::Good, "The model is adequate".to_owned()),
        Verdict::Effect => (Mood::Bad, format!("Missing: {}", names.join(" and "))),
        Verdict::Ambiguous => (
            Mood::Caution,
            format!(
                "Missing: {}",
                steps.iter().map(with_ties).collect::<Vec<_>>().join("; ")
            ),
        ),
        Verdict::Law => (Mood::Bad, format!("Missing: {}", missing(result, &names))),
        Verdict::Unknown if result.get("unexplained/each_alone").is_some() => (
            Mood::Caution,
            "Each recording alone is explained, both together are not".to_owned(),
        ),
        Verdict::Unknown => (
            Mood::Caution,
            "Something is missing that the library does not hold".to_owned(),
        ),
        Verdict::Implausible => (
            Mood::Bad,
            "Only parameters that no such motor has explain the recording".to_owned(),
        ),
        Verdict::Unsupported => (
            Mood::Caution,
            "The data do not support an answer".to_owned(),
        ),
    };
    let more = html! {
        @if result.text("summary").trim_end_matches('.') != text { p { (result.text("summary")) } }
        p.subtle { (result.text("motor")) ", " (proof(result)) "." }
    };
    verdict(mood, &html! { (text) }, &more)
}

/// What was fitted, and what proves.
pub(super) fn proof(result: &Place<'_>) -> String {
    let recordings: Vec<&str> = result
        .items("recordings")
        .iter()
        .map(Place::as_text)
        .collect();
    let order: Fitted = result.read("fitted").unwrap_or_default();
    let is_fitted = |k: usize| order.proof_of(k).is_none();
    let of = |fitted: bool| {
        let all = recordings.iter().enumerate();
        let these = all.filter(|(k, _)| is_fitted(*k) == fitted);
        let names: Vec<&str> = these.map(|(_, name)| *name).collect();
        names.join(" and ")
    };
    match of(false) {
        proofs if !proofs.is_empty() => format!("fitted on {}, proven on {proofs}", of(true)),
        _ => format!(
            "fitted on {}, proven by {} that were left out",
            of(true),
            match result.get("table_overlay") {
                Some(_) => "points",
                None => "interleaved blocks",
            }
        ),
    }
}

/// Effects and laws that are missing.
fn missing(result: &Place<'_>, effects: &[&str]) -> String {
    let effects = effects.iter().map(|name| (*name).to_owned());
    let laws = laws::proven(result);
    let all: Vec<String> = effects.chain(laws.iter().map(laws::name)).collect();
    all.join(" and ")
}

fn any_off(result: &Place<'_>) -> bool {
    let last = result.items("final/parameters");
    last.iter().any(|parameter| parameter.is_true("off"))
}

fn with_ties(step: &Place<'_>) -> String {
    let ties: Vec<&str> = step.items("tied_with").iter().map(Place::as_text).collect();
    match ties.is_empty() {
        true => step.text("effect").to_owned(),
        false => format!("{} or {}", step.text("effect"), ties.join(" or ")),
    }
}

fn summary(result: &Place<'_>, steps: &[Place<'_>]) -> Vec<(Markup, Markup)> {
    let error = |path: &str, what: &str| {
        result.get(path)?;
        Some((
            html! { (shown(result, path, decimals(3))) " × noise" },
            html! { (what) },
        ))
    };
    let baseline = match result.get("channels") {
        Some(_) => format!("channels/{}", channels::WITHOUT),
        None => format!("baseline/{HELD_OUT}"),
    };
    let refitted = "error on data that was not fitted, all parameters refitted";
    let mut found: Vec<(Markup, Markup)> = error(&baseline, refitted).into_iter().collect();
    let with = format!("channels/{HELD_OUT}");
    found.extend(error(&with, "the same beside what the channels are off by"));
    let laws = laws::proven(result);
    if !steps.is_empty() || !laws.is_empty() {
        let last = format!("final/{HELD_OUT}");
        found.extend(error(&last, "the same with what was found"));
    }
    let share = |place: &Place<'_>, name: &str| {
        (
            html! { (shown(place, "explained_percent", decimals(0))) " %" },
            html! { "of the excess error explained by " (name) },
        )
    };
    found.extend(steps.iter().map(|step| share(step, step.text("effect"))));
    found.extend(laws.iter().map(|law| share(law, &laws::name(law))));
    found
}

fn errors(result: &Place<'_>, steps: &[Place<'_>]) -> Markup {
    let Some(baseline) = result.get("baseline") else {
        return html! {};
    };
    let channels = result.get("channels");
    let mut rows: Vec<Bar<'_>> = channels.iter().map(channels::without).collect();
    let refitted = match rows.is_empty() {
        true => "all parameters refitted, nothing added",
        false => channels::WITH,
    };
    rows.push(row(refitted.to_owned(), &baseline, ""));
    rows.extend(
        steps
            .iter()
            .filter(|step| step.get("frame").is_none())
            .map(|step| row(format!("with {}", step.text("effect")), step, "chosen")),
    );
    let laws = laws::proven(result);
    rows.extend(
        laws.iter()
            .map(|law| row(format!("with {}", laws::name(law)), law, "chosen")),
    );
    html! {
        section aria-labelledby="fall" {
            h2 id="fall" { "How the error falls on data that was not fitted" }
            (bars(&rows))
            p.subtle { (NOISE) }
        }
    }
}

/// The worst places of the model as the motor file says.
fn where_it_fails(result: &Place<'_>) -> Markup {
    let places = result.items("where_it_fails");
    let error = |place: &Place<'_>| place.number("error_over_noise").unwrap_or_default();
    let full = places.iter().map(error).fold(0.0, f64::max);
    let timed = places.iter().any(|place| place.get("from_s").is_some());
    let recordings = result.items("recordings");
    html! {
        @if !places.is_empty() {
            section aria-labelledby="fails" {
                h2 id="fails" { "Where the model of the motor file is furthest off" }
                @if recordings.len() > 1 { p.subtle { "In the fitted recording, " (recordings[0].as_text()) "." } }
                div.wide tabindex="0" { table.bars.plain {
                    thead { tr { th scope="col" { "place" } @if timed { th scope="col" { "from, s" } th scope="col" { "to, s" } } th scope="col" { "error, × noise" } th.word scope="col" { "" } } }
                    tbody { @for place in &places { tr {
                        th scope="row" { (place.text("name")) }
                        @if timed { td { (shown(place, "from_s", decimals(2))) } td { (shown(place, "to_s", decimals(2))) } }
                        td { (shown(place, "error_over_noise", decimals(2))) }
                        td.bar { (bar(error(place), full)) }
                    } } }
                } }
            }
        }
    }
}

fn row<'a>(label: String, place: &Place<'a>, class: &'static str) -> Bar<'a> {
    Bar {
        label,
        place: place.clone(),
        key: HELD_OUT,
        class,
    }
}

fn effect(step: &Place<'_>, k: usize) -> Markup {
    let id = format!("effect-{k}");
    let ties = step.items("tied_with");
    html! {
        section aria-labelledby=(id) {
            h2 id=(id) { (step.text("effect")) @if !step.text("form").is_empty() { " (" (step.text("form")) ")" } }
            p { "Seen when it is missing: " (step.text("symptom")) "." }
            (of_effect(&step.items("parameters")))
            @if step.get("loss_watt").is_some() { p { "It takes " (shown(step, "loss_watt", decimals(0))) " W at rated voltage and synchronous speed." } }
            @if !ties.is_empty() {
                p { strong { "As likely: " } @for (n, tie) in ties.iter().enumerate() { @if n > 0 { ", " } (tie.as_text()) } "." }
                p { strong { "What separates them: " } (step.text("separating_test")) "." }
            }
        }
    }
}

fn unexplained(result: &Place<'_>) -> Markup {
    // That each recording alone is explained stands above.
    let rest = result.get("unexplained");
    let Some(rest) = rest.filter(|rest| rest.get("each_alone").is_none()) else {
        return html! {};
    };
    html! {
        section aria-labelledby="rest" {
            h2 id="rest" { "What is left" }
            p { (rest.text("description")) }
            @if rest.get("best_lead").is_some() {
                p { "Best lead, not proven: " strong { (rest.text("best_lead")) } ", explains " (shown(&rest, "best_lead_explains_percent", decimals(0))) " % of the excess." }
            }
            @let grows = rest.items("correlates_with");
            @if !grows.is_empty() {
                p { "It grows with: " @for (n, word) in grows.iter().enumerate() { @if n > 0 { ", " } (word.as_text()) } "." }
            }
        }
    }
}

/// Gain below which an effect is folded away, percent.
const LEAST_GAIN_PERCENT: f64 = 0.5;

fn ranking(result: &Place<'_>, steps: &[Place<'_>]) -> Markup {
    let rows = result.items("ranking");
    if rows.is_empty() {
        return html! {};
    }
    let gains = |row: &&Place<'_>| row.number("gain_percent") >= Some(LEAST_GAIN_PERCENT);
    let (top, rest): (Vec<_>, Vec<_>) = rows.iter().partition(gains);
    html! {
        section aria-labelledby="ranking" {
            h2 id="ranking" { "Every effect, added alone" }
            p.subtle { "Error on data that was not fitted, with all parameters refitted beside the effect; ~ is linearised. Visibility is what an effect of typical size would show in this recording, percent of the noise: below 2 the recording can neither find nor exclude it." }
            @if top.is_empty() { p { "None lowers the error noticeably." } } @else {
                p.key { span { span.swatch { i style="background:var(--blue)" {} } "found" } span { span.swatch { i style="background:var(--sky)" {} } "tied with it" } span { span.swatch { i style="background:var(--grey)" {} } "others" } }
                (ranks(result, steps, &top))
            }
            details { summary { "Effects that lower it by less than half a percent" } (ranks(result, steps, &rest)) }
        }
    }
}

fn ranks(result: &Place<'_>, steps: &[Place<'_>], rows: &[&Place<'_>]) -> Markup {
    let full = result
        .number(&format!("baseline/{HELD_OUT}"))
        .unwrap_or_default();
    html! {
        div.wide tabindex="0" { table.bars {
            thead { tr { th scope="col" { "effect" } th scope="col" { "error, × noise" } th scope="col" { "gain, %" } th scope="col" { "visibility, %" } th.word scope="col" { "" } } }
            tbody { @for row in rows { tr class=(rank_class(row.text("effect"), steps)) {
                th scope="row" { (row.text("effect")) }
                td { @if !row.is_true("refitted") { "~ " } (shown(row, HELD_OUT, decimals(3))) }
                td { (shown(row, "gain_percent", decimals(1).signed())) }
                td { (shown(row, "visibility_percent", decimals(1))) }
                td.bar { (bar(row.number(HELD_OUT).unwrap_or_default(), full)) }
            } } }
        } }
    }
}

fn rank_class(name: &str, steps: &[Place<'_>]) -> &'static str {
    let tied = |step: &Place<'_>| {
        let ties = step.items("tied_with");
        ties.iter().any(|tie| tie.as_text() == name)
    };
    if steps.iter().any(|step| step.text("effect") == name) {
        "chosen"
    } else if steps.iter().any(tied) {
        "tied"
    } else {
        ""
    }
}

fn fitted(result: &Place<'_>) -> Markup {
    let last = result.items("final/parameters");
    html! {
        @if !last.is_empty() {
            section aria-labelledby="parameters" {
                h2 id="parameters" { "Parameters with their uncertainty" }
                (nominals(&last))
                details { summary { "Without the effects that were found" } (nominals(&result.items("baseline/parameters"))) }
            }
        }
    }
}

fn not_testable(result: &Place<'_>) -> Markup {
    let names = result.items("not_testable");
    html! {
        @if !names.is_empty() {
            section aria-labelledby="hidden" {
                h2 id="hidden" { "What this recording cannot show" }
                p { "Present or not, an effect of typical size would stay below 2 % of the noise here:" }
                p { @for (n, name) in names.iter().enumerate() { @if n > 0 { ", " } (name.as_text()) } "." }
            }
        }
    }
}
