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

/// Head of a column, and whether words stand in it.
type Head = (&'static str, bool);

const fn word(head: &'static str) -> Head {
    (head, true)
}

const fn number(head: &'static str) -> Head {
    (head, false)
}

fn heads(heads: &[Head]) -> Markup {
    html! { thead { tr { @for (head, is_word) in heads { th.word[*is_word] scope="col" { (head) } } } } }
}

fn causes(result: &Place<'_>) -> Markup {
    let causes = result.items("causes");
    html! {
        section {
            h2 { "Alarms by cause" }
            @if causes.is_empty() { p { "None." } } @else {
                div.wide tabindex="0" { table {
                    (heads(&[word("cause"), number("alarms"), number("motors"), number("lasted"), number("marked as false")]))
                    tbody { @for row in &causes { tr {
                        th scope="row" { (row.text("words")) } td { (shown(row, "alarms", decimals(0))) } td { (shown(row, "motors", decimals(0))) }
                        td { (time(row, "hours")) } td { (shown(row, "marked_false", decimals(0))) }
                    } } }
                } }
            }
        }
    }
}

/// Hours in the unit that suits them.
fn time(row: &Place<'_>, path: &str) -> Markup {
    let hours = row.number(path).unwrap_or_default();
    let (style, unit) = match hours {
        _ if hours < 1.0 / 60.0 => (decimals(0).times(3600.0), "s"),
        _ if hours < 1.0 => (decimals(0).times(60.0), "min"),
        _ => (decimals(1), "h"),
    };
    html! { (shown(row, path, style)) @if row.get(path).is_some() { " " (unit) } }
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
                (heads(&[number("number"), word("motor"), word("what"), word("severity"), word("rose"), number("lasted"), word("acknowledged by"), number("after"), word("comment"), word("false")]))
                tbody { @for row in alarms.iter().take(MOST_ALARMS) { tr {
                    th scope="row" { (shown(row, "number", decimals(0))) } td.word { (row.text("motor")) } td.word { (row.text("words")) } td.word { (row.text("severity")) }
                    td.word { (row.text("raised")) } td { (time(row, "hours")) } td.word { (row.text("acknowledged_by")) }
                    td { (time(row, "acknowledged_after_hours")) } td.word { (row.text("comment")) } td.word { (if row.is_true("marked_false") { "yes" } else { "" }) }
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
                (heads(&[word("motor"), word("place"), number("moved, %"), number("r1, first"), number("r1, last"), number("r2, first"), number("r2, last"), number("r3, first"), number("r3, last"), number("r4, first"), number("r4, last"), number("data, %"), number("judged, %"), number("alarms"), number("in alarm")]))
                tbody { @for row in result.items("motors") { tr {
                    th scope="row" { (row.text("title")) } td.word { (row.text("place")) } td { (shown(&row, "moved_percent", decimals(2))) }
                    @for k in 0..4 {
                        td { (shown(&row, &format!("first_percent/{k}"), decimals(2))) } td { (shown(&row, &format!("last_percent/{k}"), decimals(2))) }
                    }
                    td { (shown(&row, "availability_percent", decimals(2))) } td { (shown(&row, "judged_percent", decimals(1))) }
                    td { (shown(&row, "alarms", decimals(0))) } td { (time(&row, "alarm_hours")) }
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
                (heads(&[word("motor"), word("motor file"), word("effects"), word("constants of the file"), word("of the board"), word("calibrated"), word("by"), number("drift, %"), word("due"), word("why, or what is not known")]))
                tbody { @for row in result.items("models") { tr {
                    th scope="row" { (row.text("title")) } td.word { (row.text("file")) }
                    td.word { @for (k, effect) in row.items("effects").iter().enumerate() { @if k > 0 { ", " } (effect.as_text()) } }
                    td.word { (row.text("file_constants")) } td.word { (row.text("board_constants")) } td.word { (row.text("calibrated_on")) } td.word { (row.text("calibrated_by")) }
                    td { (shown(&row, "drift_percent", decimals(2))) } td.word { (if row.is_true("due") { "due" } else { "" }) } td.word { (row.text("why")) }
                } } }
            } }
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn times_have_the_unit_that_suits_them() {
        let result = json!({ "seconds": 0.01, "minutes": 0.5, "hours": 30.25, "open": null });
        let result = Place::root(&result);
        for (path, shown) in [
            ("seconds", ">36<"),
            ("minutes", ">30<"),
            ("hours", ">30.2<"),
        ] {
            let cell = time(&result, path).into_string();
            assert!(cell.contains(shown), "{cell}");
        }
        assert!(time(&result, "minutes").into_string().ends_with(" min"));
        assert!(time(&result, "open").into_string().contains('\u{2013}'));
        assert!(!time(&result, "open").into_string().ends_with(" s"));
    }
}
