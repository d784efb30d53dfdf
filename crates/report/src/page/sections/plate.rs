//! How a motor came to be known: its plate, what contradicts what, its parameters.

use maud::{Markup, html};

use crate::page::elements::number::{shown, significant};
use crate::page::elements::place::Place;

/// The section.
pub fn section(result: &Place<'_>) -> Markup {
    let contradictions = result.items("contradictions");
    let notes = result.items("notes");
    html! {
        section aria-labelledby="motor" {
            h2 id="motor" { "How the motor is known" }
            p { (result.text("motor")) ": " (result.text("known_by")) "." }
            @if !contradictions.is_empty() || !notes.is_empty() {
                ul.findings {
                    @for contradiction in &contradictions { li { strong { "The plate contradicts itself: " } (contradiction.as_text()) } }
                    @for note in &notes { li { (note.as_text()) } }
                }
            }
            div.sides { (printed(result)) (parameters(result)) }
        }
    }
}

fn printed(result: &Place<'_>) -> Markup {
    let rows = result.items("plate");
    html! {
        @if !rows.is_empty() {
            div.wide tabindex="0" { table {
                caption { "The plate, and what the circuit gives for each number" }
                thead { tr { th scope="col" { "number" } th scope="col" { "printed" } th scope="col" { "circuit" } th scope="col" { "95 % interval" } } }
                tbody { @for row in &rows { tr {
                    th scope="row" { (in_words(row.text("name"))) }
                    td { (shown(row, "printed", significant(4))) }
                    td { (shown(row, "circuit", significant(4))) }
                    td.interval { (interval(row)) }
                } } }
            } }
        }
    }
}

fn parameters(result: &Place<'_>) -> Markup {
    let rows = result.items("parameters");
    let told = rows.iter().any(|row| row.get("would_tell").is_some());
    html! {
        div.wide tabindex="0" { table {
            caption { "Parameters, per equivalent star phase" }
            thead { tr {
                th scope="col" { "parameter" } th scope="col" { "value" } th scope="col" { "95 % interval" }
                @if told { th.word scope="col" { "to learn it, record" } }
            } }
            tbody { @for row in &rows { tr {
                th scope="row" { (in_words(row.text("name"))) }
                td { (shown(row, "value", significant(4))) }
                td.interval { (interval(row)) }
                @if told { td.word { (row.text("would_tell")) } }
            } } }
        } }
    }
}

fn interval(row: &Place<'_>) -> Markup {
    match row.get("low") {
        Some(_) => {
            html! { (shown(row, "low", significant(4))) " … " (shown(row, "high", significant(4))) }
        }
        None => html! { "–" },
    }
}

/// Ends of keys and how their unit is written.
const UNITS: [(&str, &str); 14] = [
    ("_nm_s2", "N m s²"),
    ("_nm_s", "N m s"),
    ("_kg_m2", "kg m²"),
    ("_nm", "N m"),
    ("_kw", "kW"),
    ("_volt", "V"),
    ("_hz", "Hz"),
    ("_rpm", "rpm"),
    ("_percent", "%"),
    ("_amp", "A"),
    ("_ohm", "Ω"),
    ("_henry", "H"),
    ("_ratio", ""),
    ("_watt", "W"),
];

/// A key as words, its unit behind a comma.
fn in_words(key: &str) -> String {
    let found = UNITS
        .iter()
        .find_map(|(end, unit)| Some((key.strip_suffix(end)?, *unit)));
    let (stem, unit) = found.unwrap_or((key, ""));
    let words = stem.replace('_', " ");
    match unit {
        "" => words,
        unit => format!("{words}, {unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::in_words;

    #[test]
    fn keys_become_words() {
        assert_eq!(in_words("stator_resistance_ohm"), "stator resistance, Ω");
        assert_eq!(in_words("windage_nm_s2"), "windage, N m s²");
        assert_eq!(in_words("breakdown_torque_ratio"), "breakdown torque");
        assert_eq!(in_words("power_factor"), "power factor");
    }
}
