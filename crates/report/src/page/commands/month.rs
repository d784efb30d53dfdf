//! The page of `drivemon fleet report`: a month of a plant.

use maud::{Markup, html};

use crate::page::elements::number::{decimals, shown};
use crate::page::elements::place::Place;
use crate::page::elements::shell::{Mood, cards, verdict};

/// Alarms that are listed; the embedded result has all.
const MOST_ALARMS: usize = 500;

/// Everything between heading and footer.
pub fn content(result: &Place<'_>) -> Markup {
    let alarms = result.items("alarms");
    html! {
        (answer(result, &alarms))
        (cards(&figures(result, &alarms)))
        (causes(result))
        (listed(&alarms))
        (trends(result))
        (models(result))
    }
}

fn marked(alarms: &[Place<'_>]) -> usize {
    let marked = alarms.iter().filter(|alarm| alarm.is_true("marked_false"));
    marked.count()
}

fn answer(result: &Place<'_>, alarms: &[Place<'_>]) -> Markup {
    let high = alarms.iter().any(|alarm| alarm.text("severity") == "high");
    let mood = match (alarms.is_empty(), high) {
        (true, _) => Mood::Good,
        (false, true) => Mood::Bad,
        (false, false) => Mood::Caution,
    };
    verdict(
        mood,
        &html! { (result.text("month")) ": " (alarms.len()) " alarms rose on " (result.items("motors").len()) " motors" },
        &html! { p.subtle { "Days and times are UTC. A month that is not over is counted up to the report." } },
    )
}

fn figures(result: &Place<'_>, alarms: &[Place<'_>]) -> Vec<(Markup, Markup)> {
    let unseen = alarms
        .iter()
        .filter(|alarm| alarm.get("acknowledged_by").is_none())
        .count();
    let due = result
        .items("models")
        .iter()
        .filter(|model| model.is_true("due"))
        .count();
    vec![
        (
            html! { (shown(result, "availability_percent", decimals(2))) " %" },
            html! { "of all seconds are stored" },
        ),
        (
            html! { (unseen) },
            html! { "alarms that nobody acknowledged in the month" },
        ),
        (
            html! { (marked(alarms)) },
            html! { "alarms that people marked as false (“false alarm” in a comment)" },
        ),
        (html! { (due) }, html! { "calibrations are due" }),
    ]
}

fn heads(heads: &[&str]) -> Markup {
    html! { thead { tr { @for head in heads { th scope="col" { (head) } } } } }
}

fn causes(result: &Place<'_>) -> Markup {
    let causes = result.items("causes");
    html! {
        section {
            h2 { "Alarms by cause" }
            @if causes.is_empty() { p { "None." } } @else {
                div.wide tabindex="0" { table {
                    (heads(&["cause", "alarms", "motors", "lasted, h", "marked as false"]))
                    tbody { @for row in &causes { tr {
                        th scope="row" { (row.text("words")) } td { (shown(row, "alarms", decimals(0))) } td { (shown(row, "motors", decimals(0))) }
                        td { (shown(row, "hours", decimals(1))) } td { (shown(row, "marked_false", decimals(0))) }
                    } } }
                } }
            }
        }
    }
}

fn listed(alarms: &[Place<'_>]) -> Markup {
    if alarms.is_empty() {
        return html! {};
    }
    html! {
        section {
            h2 { "Alarms" }
            @if alarms.len() > MOST_ALARMS { p.subtle { "The first " (MOST_ALARMS) " of them; the embedded result has all." } }
            div.wide tabindex="0" { table {
                (heads(&["number", "motor", "what", "severity", "rose", "lasted, h", "acknowledged by", "after, h", "comment", "false"]))
                tbody { @for row in alarms.iter().take(MOST_ALARMS) { tr {
                    th scope="row" { (shown(row, "number", decimals(0))) } td { (row.text("motor")) } td { (row.text("words")) } td { (row.text("severity")) }
                    td { (row.text("raised")) } td { (shown(row, "hours", decimals(1))) } td { (row.text("acknowledged_by")) }
                    td { (shown(row, "acknowledged_after_hours", decimals(1))) } td { (row.text("comment")) } td { (if row.is_true("marked_false") { "yes" } else { "" }) }
                } } }
            } }
        }
    }
}

fn trends(result: &Place<'_>) -> Markup {
    html! {
        section {
            h2 { "Motors, those whose residuals moved most first" }
            p.subtle { "Means of the first and of the last seven days, percent of scale. A load that changed moves r2 and r3 where it is not declared." }
            div.wide tabindex="0" { table {
                (heads(&["motor", "place", "moved, %", "r1, first", "r1, last", "r2, first", "r2, last", "r3, first", "r3, last", "r4, first", "r4, last", "data, %", "judged, %", "alarms", "in alarm, h"]))
                tbody { @for row in result.items("motors") { tr {
                    th scope="row" { (row.text("title")) } td { (row.text("place")) } td { (shown(&row, "moved_percent", decimals(2))) }
                    @for k in 0..4 {
                        td { (shown(&row, &format!("first_percent/{k}"), decimals(2))) } td { (shown(&row, &format!("last_percent/{k}"), decimals(2))) }
                    }
                    td { (shown(&row, "availability_percent", decimals(2))) } td { (shown(&row, "judged_percent", decimals(1))) }
                    td { (shown(&row, "alarms", decimals(0))) } td { (shown(&row, "alarm_hours", decimals(1))) }
                } } }
            } }
        }
    }
}

fn models(result: &Place<'_>) -> Markup {
    html! {
        section {
            h2 { "Models in force" }
            div.wide tabindex="0" { table {
                (heads(&["motor", "motor file", "effects", "constants of the file", "of the board", "calibrated", "by", "drift, %", "due", "why, or what is not known"]))
                tbody { @for row in result.items("models") { tr {
                    th scope="row" { (row.text("title")) } td { (row.text("file")) }
                    td { @for (k, effect) in row.items("effects").iter().enumerate() { @if k > 0 { ", " } (effect.as_text()) } }
                    td { (row.text("file_constants")) } td { (row.text("board_constants")) } td { (row.text("calibrated_on")) } td { (row.text("calibrated_by")) }
                    td { (shown(&row, "drift_percent", decimals(2))) } td { (if row.is_true("due") { "due" } else { "" }) } td { (row.text("why")) }
                } } }
            } }
        }
    }
}
