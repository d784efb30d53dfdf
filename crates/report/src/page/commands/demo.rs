//! The page of `drivemon demo`: published table against measured lamps.

use maud::{Markup, html};

use crate::page::elements::chart::{Chart, Kind, Series};
use crate::page::elements::number::{decimals, shown};
use crate::page::elements::place::Place;
use crate::page::elements::shell::{Mood, cards, verdict};

/// Colour of each matrix and frame, the same in all figures.
const COLOURS: [&str; 3] = ["blue", "vermillion", "purple"];

/// Everything between heading and footer.
pub fn content(demo: &Place<'_>) -> Markup {
    let matrices = demo.items("matrices");
    html! {
        (answer(demo, &matrices))
        (cards(&summary(demo, &matrices)))
        (lamps(&matrices))
        (bars(demo, &matrices))
        (healthy(demo))
        (numbers(&matrices))
    }
}

/// Plant and frame in words.
fn name(matrix: &Place<'_>) -> String {
    let plant = match matrix.text("plant") {
        "linear" => "paper's linear model",
        _ => "full motor",
    };
    format!("{plant}, {} frame", matrix.text("frame"))
}

fn answer(demo: &Place<'_>, matrices: &[Place<'_>]) -> Markup {
    let Some(published) = matrices.first() else {
        return html! {};
    };
    let mood = if published.number("agree") == published.number("of") {
        Mood::Good
    } else {
        Mood::Bad
    };
    let noise = decimals(1).times(100.0);
    verdict(
        mood,
        &html! {
            (shown(published, "agree", decimals(0))) " of " (shown(published, "of", decimals(0)))
            " published lamp patterns appear on the paper's own model"
        },
        &html! {
            p.subtle {
                (demo.text("motor")) ", through the board's core: "
                (shown(demo, "noise_sigma_fraction_of_full_scale", noise)) " % noise, "
                (shown(demo, "adc_bits", decimals(0))) " bit, seed " (shown(demo, "seed", decimals(0)))
                ". One set of thresholds for everything: "
                @for k in 0..4 {
                    "r" (k + 1) " " (shown(demo, &format!("threshold_percent/{k}"), decimals(1))) " %"
                    @if k < 3 { ", " }
                }
                "."
            }
        },
    )
}

fn summary(demo: &Place<'_>, matrices: &[Place<'_>]) -> Vec<(Markup, Markup)> {
    let agreement = matrices.iter().map(|matrix| {
        (
            html! { (shown(matrix, "agree", decimals(0))) " / " (shown(matrix, "of", decimals(0))) },
            html! { "patterns as published: " (name(matrix)) },
        )
    });
    let drift = ["rotor-flux", "voltage"].into_iter().filter_map(|frame| {
        let worst = worst_healthy(demo, frame)?;
        Some((
            html! { (shown(&worst, "r_percent/0", decimals(2).signed())) " %" },
            html! { "furthest r1 of the healthy motor, " (frame) " frame, at " (shown(&worst, "load_percent", decimals(0))) " % load" },
        ))
    });
    agreement.chain(drift).collect()
}

/// The healthy row of a frame in which r1 is furthest from zero.
fn worst_healthy<'a>(demo: &Place<'a>, frame: &str) -> Option<Place<'a>> {
    let rows = demo.items("healthy").into_iter();
    let size = |row: &Place<'_>| row.number("r_percent/0").unwrap_or(0.0).abs();
    rows.filter(|row| row.text("frame") == frame)
        .max_by(|a, b| size(a).total_cmp(&size(b)))
}

fn lamps(matrices: &[Place<'_>]) -> Markup {
    let rows = matrices.first().map(|matrix| matrix.items("table"));
    html! {
        section aria-labelledby="lamps" {
            h2 id="lamps" { "Lamps: published and measured" }
            p.subtle { "Each row is one fault in one direction; lamps r1 to r4 from left to right." }
            p.key {
                span { span.lamp.on {} "on" }
                span { span.lamp {} "off" }
                span { span.lamp.on.differs {} "differs from the published table" }
            }
            div.wide tabindex="0" role="region" aria-labelledby="lamps" {
                table.lamps {
                    thead {
                        tr {
                            th scope="col" { "fault" }
                            th.group colspan="4" scope="colgroup" { "published" }
                            @for matrix in matrices { th.group colspan="4" scope="colgroup" { (name(matrix)) } }
                        }
                    }
                    tbody {
                        @for (k, row) in rows.iter().flatten().enumerate() { (lamp_row(matrices, row, k)) }
                    }
                }
            }
            p.subtle { "On the full motor some rows leave the published table: a changed leakage inductance looks like a resistance, and in the voltage frame the load itself moves the residuals. Exact physics, not a fault of the instrument." }
        }
    }
}

fn lamp_row(matrices: &[Place<'_>], first: &Place<'_>, k: usize) -> Markup {
    let turns = k > 0 && k * 2 == matrices[0].items("table").len();
    html! {
        tr.direction[turns] {
            th scope="row" { (class(first)) }
            (pattern(first.text("expected"), None))
            @for matrix in matrices {
                @if let Some(row) = matrix.get(&format!("table/{k}")) {
                    (pattern(row.text("measured"), Some(row.text("expected"))))
                }
            }
        }
    }
}

/// Four cells; without anything to compare with they are the published ones.
fn pattern(lit: &str, expected: Option<&str>) -> Markup {
    let published = expected.is_none();
    let expected = expected.unwrap_or(lit);
    html! {
        @for (k, (is, should)) in lit.chars().zip(expected.chars()).enumerate() {
            td.published[published].group[k == 0].last[k == 3] { (lamp(k, is == '1', is != should)) }
        }
    }
}

fn lamp(k: usize, on: bool, differs: bool) -> Markup {
    let state = if on { "on" } else { "off" };
    let remark = if differs { ", not as published" } else { "" };
    let words = format!("r{} {state}{remark}", k + 1);
    html! { span.lamp.on[on].differs[differs] role="img" aria-label=(words) title=(words) {} }
}

/// A fault and its direction.
fn class(row: &Place<'_>) -> String {
    let change = row.number("change_percent").unwrap_or_default();
    format!(
        "{} {} %",
        row.text("fault"),
        decimals(0).signed().text(change)
    )
}

fn bars(demo: &Place<'_>, matrices: &[Place<'_>]) -> Markup {
    let classes: Vec<String> = matrices.first().map_or_else(Vec::new, |matrix| {
        matrix.items("table").iter().map(class).collect()
    });
    html! {
        section aria-labelledby="bars" {
            h2 id="bars" { "Residuals: how far each fault moves them" }
            p.subtle { "Mean over the fault, percent of each residual's own scale. Inside the shaded band the lamp stays dark. The axis is logarithmic beyond one percent." }
            div.charts { @for k in 0..4 { (bar_chart(demo, matrices, &classes, k)) } }
        }
    }
}

fn bar_chart(demo: &Place<'_>, matrices: &[Place<'_>], classes: &[String], k: usize) -> Markup {
    let mut chart = Chart::over_classes("fault", classes.to_vec())
        .y(&format!("r{}", k + 1), "% of scale")
        .asinh(1.0)
        .limits(
            "threshold",
            demo.pointer_to(&format!("threshold_percent/{k}")),
        );
    chart.height_rem = 21.0;
    for (matrix, colour) in matrices.iter().zip(COLOURS) {
        let from = matrix.pointer_to(&format!("table/*/r_percent/{k}"));
        chart = chart.with(Series::line(&name(matrix), from, colour).kind(Kind::Bars));
    }
    chart.figure(&format!("r{}", k + 1), "")
}

fn healthy(demo: &Place<'_>) -> Markup {
    html! {
        section aria-labelledby="healthy" {
            h2 id="healthy" { "The healthy motor against its load, in both frames" }
            p.subtle { "Exact parameters, load declared, nothing wrong with the motor: every residual should be zero. In the paper's voltage frame it is not, and a change of load looks like a fault; in the rotor-flux frame it stays inside the band." }
            div.charts { @for k in 0..4 { (healthy_chart(demo, k)) } }
        }
    }
}

fn healthy_chart(demo: &Place<'_>, k: usize) -> Markup {
    let from = demo.pointer_to(&format!("healthy/*/r_percent/{k}"));
    let frame = demo.pointer_to("healthy/*/frame");
    let of = |name: &str, colour| {
        Series::line(&format!("{name} frame"), from.clone(), colour)
            .kind(Kind::Marked)
            .rows(frame.clone(), name)
    };
    Chart::over(
        "load",
        "% of the declared friction",
        demo.pointer_to("healthy/*/load_percent"),
    )
    .y(&format!("r{}", k + 1), "% of scale")
    .limits(
        "threshold",
        demo.pointer_to(&format!("threshold_percent/{k}")),
    )
    .with(of("rotor-flux", "green"))
    .with(of("voltage", "vermillion"))
    .group("healthy")
    .figure(&format!("r{} of the healthy motor", k + 1), "")
}

fn numbers(matrices: &[Place<'_>]) -> Markup {
    html! {
        section aria-labelledby="numbers" {
            h2 id="numbers" { "All numbers" }
            @for matrix in matrices {
                details { summary { (name(matrix)) } div.wide tabindex="0" { (table(matrix)) } }
            }
        }
    }
}

fn table(matrix: &Place<'_>) -> Markup {
    let percent = decimals(0).times(100.0);
    html! {
        table {
            thead { tr {
                th scope="col" { "fault" } th scope="col" { "published" } th scope="col" { "measured" }
                @for k in 1..=4 { th scope="col" { "r" (k) ", % of scale" } }
                th scope="col" { "probability of this fault, %" } th scope="col" { "delay of FAULT, ms" } th scope="col" { "dark again after it" }
            } }
            tbody { @for row in matrix.items("table") { tr {
                th scope="row" { (class(&row)) }
                td { (row.text("expected")) } td { (row.text("measured")) }
                @for k in 0..4 { td { (shown(&row, &format!("r_percent/{k}"), decimals(2).signed())) } }
                td { (shown(&row, "probability", percent)) }
                td { (shown(&row, "delay_s", decimals(0).times(1000.0))) }
                td { (if row.is_true("dark_after") { "yes" } else { "no" }) }
            } } }
        }
    }
}
