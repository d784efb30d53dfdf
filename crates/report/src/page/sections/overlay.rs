//! Measured and modelled signals over each other, and the error against time and operating point.

use maud::{Markup, html};

use super::models::models;
use super::table_overlay;
use crate::page::elements::chart::{Chart, Kind, Series};
use crate::page::elements::place::Place;

/// Quantities that the error is shown against: key, axis, unit, what a trend would mean.
const AGAINST: [(&str, &str, &str, &str); 4] = [
    (
        "slip_percent",
        "slip",
        "%",
        "A rise with slip points at the rotor circuit or the start.",
    ),
    (
        "load_percent",
        "load",
        "% of rated",
        "A rise with load points at resistances, leakage or gains.",
    ),
    (
        "voltage_percent",
        "voltage",
        "% of rated",
        "A rise with voltage points at iron: saturation or core loss.",
    ),
    (
        "frequency_hz",
        "frequency",
        "Hz",
        "A rise with frequency points at inductance, delay or friction.",
    ),
];

/// The figures, or a sentence when there is nothing to lay over each other.
pub fn section(result: &Place<'_>) -> Markup {
    let Some(overlay) = result.get("overlay") else {
        return table_overlay::section(result);
    };
    let models = models(&overlay);
    html! {
        section aria-labelledby="overlay" {
            h2 id="overlay" { "Measured and modelled" }
            p.subtle { "The recorded voltages of " (overlay.text("recording")) " drive the model. First the place where the current is furthest off, every sample; then the whole recording, thinned." }
            div.charts {
                (signal(&overlay, "close", "ia", &models))
                (signal(&overlay, "close", "speed", &models))
                (signal(&overlay, "whole", "ia", &models))
                (signal(&overlay, "whole", "speed", &models))
            }
        }
        section aria-labelledby="error" {
            h2 id="error" { "The error against time, slip, load, voltage and frequency" }
            p.subtle { "Rms over blocks of 40 ms, logarithmic. Where the points of one figure lie on a rising line, the missing physics depends on that quantity." }
            div.charts {
                (error(&overlay, &models, "current_error_amp", "current error", "A rms"))
                (error(&overlay, &models, "speed_error_rad_s", "speed error", "rad/s rms"))
                @for against in AGAINST { (trend(&overlay, &models, &against)) }
            }
        }
    }
}

fn signal(
    overlay: &Place<'_>,
    part: &str,
    name: &str,
    models: &[(String, &'static str)],
) -> Markup {
    let signals = overlay.items(&format!("{part}/signals"));
    let Some(signal) = signals.iter().find(|signal| signal.text("name") == name) else {
        return html! {};
    };
    let unit = if name == "speed" { "rad/s" } else { "A" };
    let mut chart = Chart::over("time", "s", overlay.pointer_to(&format!("{part}/t/*")))
        .y(name, unit)
        .with(Series::line(
            "measured",
            signal.pointer_to("measured/*"),
            "blue",
        ))
        .group(if part == "close" { "close" } else { "time" });
    for (k, (label, colour)) in models.iter().enumerate() {
        let from = signal.pointer_to(&format!("modelled/{k}/*"));
        let line = Series::line(label, from, colour);
        // Over the whole recording the lines are too dense for dashes.
        let line = if part == "close" {
            line.dashed(k)
        } else {
            line
        };
        chart = chart.with(line);
    }
    let heading = match part {
        "close" => format!("{name}, where the current is furthest off"),
        _ => format!("{name}, whole recording"),
    };
    chart.figure(&heading, "")
}

fn error(
    overlay: &Place<'_>,
    models: &[(String, &'static str)],
    key: &str,
    label: &str,
    unit: &'static str,
) -> Markup {
    if overlay.get(&format!("blocks/0/{key}/0")).is_none() {
        return html! {};
    }
    let mut chart = Chart::over("time", "s", overlay.pointer_to("blocks/*/t"))
        .y(label, unit)
        .log()
        .group("time");
    for (k, (model, colour)) in models.iter().enumerate() {
        let from = overlay.pointer_to(&format!("blocks/*/{key}/{k}"));
        chart = chart.with(Series::line(model, from, colour));
    }
    chart.figure(&format!("{label} against time"), "")
}

/// Spread of a quantity below which nothing can be told from it, in its own unit (percent, or Hz of 50 or 60).
const LEAST_SPREAD: f64 = 0.5;

/// Largest minus smallest value of a quantity over the blocks.
fn spread(overlay: &Place<'_>, key: &str) -> Option<f64> {
    let blocks = overlay.items("blocks");
    let values = blocks.iter().filter_map(|block| block.number(key));
    let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), x| {
        (least.min(x), most.max(x))
    });
    (most >= least).then_some(most - least)
}

fn hardly_varies(axis: &str) -> Markup {
    html! {
        div.subtle {
            h3 { "current error against " (axis) }
            p { "The " (axis) " hardly varies in this recording, so nothing can be told from it. A recording at two values would show more." }
        }
    }
}

fn trend(
    overlay: &Place<'_>,
    models: &[(String, &'static str)],
    (key, axis, unit, meaning): &(&str, &str, &'static str, &str),
) -> Markup {
    match spread(overlay, key) {
        None => return html! {},
        Some(spread) if spread < LEAST_SPREAD => return hardly_varies(axis),
        Some(_) => {}
    }
    let mut chart = Chart::over(axis, unit, overlay.pointer_to(&format!("blocks/*/{key}")))
        .y("current error", "A rms")
        .log();
    for (k, (model, colour)) in models.iter().enumerate() {
        let from = overlay.pointer_to(&format!("blocks/*/current_error_amp/{k}"));
        chart = chart.with(Series::line(model, from, colour).kind(Kind::Points));
    }
    chart.figure(&format!("current error against {axis}"), meaning)
}
