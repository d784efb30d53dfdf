//! Laws that no library holds: where, over what, the curve with its band.

use maud::{Markup, html};

use crate::page::elements::chart::{Chart, Kind, Series};
use crate::page::elements::number::{decimals, shown, significant};
use crate::page::elements::place::Place;
use motor::effect::curve::{Coordinate, Place as LawPlace};

/// Place and coordinate of a law.
pub fn name(law: &Place<'_>) -> String {
    match law.get("bursts") {
        Some(_) => format!("{} that comes and goes", law.text("place")),
        None => format!("{} over {}", law.text("place"), law.text("coordinate")),
    }
}

/// Laws that a recording which was not fitted has proven.
pub fn proven<'a>(result: &Place<'a>) -> Vec<Place<'a>> {
    let mut laws = result.items("laws");
    laws.retain(|law| law.is_true("proven"));
    laws
}

/// One figure each.
pub fn section(result: &Place<'_>) -> Markup {
    let laws = result.items("laws");
    html! { @for (k, law) in laws.iter().enumerate() { (one(law, k)) } }
}

fn one(law: &Place<'_>, k: usize) -> Markup {
    let id = format!("law-{k}");
    let ties = law.items("tied_with");
    html! {
        section aria-labelledby=(id) {
            h2 id=(id) { (name(law)) @if !law.is_true("proven") { " (a lead, not proven)" } }
            p {
                @if law.get("bursts").is_some() { "With these bursts" } @else { "With this curve" } " the error falls from " (shown(law, "held_out_error_over_noise_without", decimals(2)))
                " to " (shown(law, "held_out_error_over_noise", decimals(2))) " × noise"
                (proof(law))
            }
            @if law.get("bursts").is_some() { (bursts(law)) (curve(law)) } @else { (curve(law)) (formulas(law)) }
            @if !ties.is_empty() { p { strong { "As likely: " } @for (n, tie) in ties.iter().enumerate() { @if n > 0 { ", " } (name(tie)) } "." } }
        }
    }
}

/// What proves the law, or would.
fn proof(law: &Place<'_>) -> Markup {
    html! {
        @if law.is_true("proven") { " on the recording that was not fitted." }
        @else { ". A further recording with other loads and speeds can prove it." }
    }
}

/// How often something comes and goes, and how large it is.
fn bursts(law: &Place<'_>) -> Markup {
    let size = |key: &str| shown(law, &format!("bursts/{key}"), significant(3));
    html! {
        p {
            "It comes and goes " (shown(law, "bursts/count", decimals(0))) " times, "
            (shown(law, "bursts/share_of_time_percent", decimals(1))) " % of the time: smallest " (size("smallest"))
            ", median " (size("median")) ", largest " (size("largest")) " " (law.text("bursts/unit")) "."
        }
    }
}

/// Formulas that fit as well as the curve.
fn formulas(law: &Place<'_>) -> Markup {
    let formulas = law.items("formulas");
    html! {
        @if !formulas.is_empty() {
            p { "Formulas that fit as well as the curve; " code { "drivemon adopt law --formula N" } " takes one:" }
            ol {
                @for formula in &formulas {
                    li {
                        code { (formula.text("formula")) } ": " (shown(formula, "held_out_error_over_noise", decimals(3))) " × noise; "
                        @for (n, p) in formula.items("parameters").iter().enumerate() {
                            @if n > 0 { ", " }
                            (p.text("name")) " = " (shown(p, "value", significant(4))) " ± " (shown(p, "std_error", significant(2)))
                            @if p.text("unit") != "-" { " " (p.text("unit")) }
                        }
                    }
                }
            }
        }
    }
}

fn curve(law: &Place<'_>) -> Markup {
    let at = |key: &str| law.pointer_to(&format!("curve/{key}/*"));
    let coordinate = Coordinate::by_name(law.text("coordinate"));
    let unit = coordinate.map_or("", Coordinate::unit);
    let relative = law.text("curve/y_unit") == "-";
    let place = LawPlace::by_name(law.text("place"));
    let y_unit = match (law.text("curve/y_unit"), place) {
        ("ohm", _) => "ohm",
        ("%", _) => "%",
        _ if relative => "",
        (_, Some(LawPlace::Torque)) => "N m",
        _ => "V",
    };
    let chart = Chart::over(law.text("coordinate"), unit, at("x"))
        .y(law.text("meaning"), y_unit)
        .with(Series::line("curve", at("y"), "blue").kind(Kind::Line));
    if law.get("bursts").is_some() {
        return chart.figure(
            &name(law),
            "Each block is one time of the fitted recording.",
        );
    }
    let sentence = "The line is the fitted curve, the dashed lines its 95 % band.";
    chart
        .with(Series::line("lower end of the band", at("lower"), "sky").dashed(0))
        .with(Series::line("upper end of the band", at("upper"), "sky").dashed(0))
        .figure(&name(law), sentence)
}
