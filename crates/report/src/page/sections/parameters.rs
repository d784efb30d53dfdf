//! Fitted values with their uncertainty, and errors as bars.

use maud::{Markup, html};

use crate::page::elements::number::{decimals, shown, significant};
use crate::page::elements::place::Place;

/// What an error over noise of 1 means.
pub const NOISE: &str =
    "1 is what the sensors' own noise leaves, or the accuracy that a table is taken to have.";

/// Nominal parameters: believed, fitted, how sure.
pub fn nominals(rows: &[Place<'_>]) -> Markup {
    html! {
        div.wide tabindex="0" { table {
            thead { tr {
                th scope="col" { "parameter" } th scope="col" { "believed" } th scope="col" { "fitted" }
                th scope="col" { "± standard error" } th scope="col" { "unit" } th scope="col" { "change, %" } th.word scope="col" { "" }
            } }
            tbody { @for row in rows { tr {
                th scope="row" { (row.text("name")) }
                td { (shown(row, "believed", significant(5))) }
                td { (shown(row, "value", significant(5))) }
                td { (error(row)) }
                td.unit { (row.text("unit")) }
                td { (shown(row, "change_percent", decimals(1).signed())) }
                td.word { @if row.is_true("off") { span.off { "off" } } }
            } } }
        } }
        p.subtle { "Off: by more than three standard errors and 5 %. The change of the friction is given in percent of rated torque at rated speed." }
    }
}

/// A standard error; a value that was not fitted has none.
fn error(row: &Place<'_>) -> Markup {
    match row.number("std_error") {
        Some(error) if error > 0.0 => shown(row, "std_error", significant(2)),
        _ => html! { "not fitted" },
    }
}

/// Parameters of an effect.
pub fn of_effect(rows: &[Place<'_>]) -> Markup {
    html! {
        div.wide tabindex="0" { table {
            thead { tr { th scope="col" { "parameter" } th scope="col" { "fitted" } th scope="col" { "± standard error" } th scope="col" { "unit" } } }
            tbody { @for row in rows { tr {
                th scope="row" { (row.text("name")) }
                td { (shown(row, "value", significant(5))) }
                td { (error(row)) }
                td.unit { (row.text("unit")) }
            } } }
        } }
    }
}

/// One error as a bar.
pub struct Bar<'a> {
    /// What it is the error of.
    pub label: String,
    /// Where the number stands.
    pub place: Place<'a>,
    /// Its key there.
    pub key: &'static str,
    /// `chosen`, `tied` or nothing.
    pub class: &'static str,
}

/// Errors over noise as bars over each other, the longest as wide as the table.
pub fn bars(rows: &[Bar<'_>]) -> Markup {
    let error = |row: &Bar<'_>| row.place.number(row.key).unwrap_or_default();
    let full = rows.iter().map(error).fold(0.0, f64::max);
    html! {
        div.wide tabindex="0" { table.bars {
            thead { tr { th scope="col" { "model" } th scope="col" { "error, × noise" } th.word scope="col" { "" } } }
            tbody { @for row in rows { tr class=(row.class) {
                th scope="row" { (row.label) }
                td { (shown(&row.place, row.key, decimals(3))) }
                td.bar { (bar(error(row), full)) }
            } } }
        } }
    }
}

/// A bar of `value` out of `full`.
pub fn bar(value: f64, full: f64) -> Markup {
    let percent = 100.0 * (value / full.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    html! { i style={ "width:" (format!("{percent:.1}")) "%" } {} }
}
