//! The page of `drivemon compare`: where the model fails.

use maud::{Markup, html};

use crate::page::elements::chart::{Chart, Kind, Series};
use crate::page::elements::number::{decimals, shown, significant};
use crate::page::elements::place::Place;
use crate::page::elements::shell::{Mood, cards, next, verdict};
use crate::page::sections::parameters::bar;
use crate::page::sections::{audit, overlay, scale};

/// From this error over noise on a model is called wrong.
pub const AGREES: f64 = 1.1;
/// Error over noise at which a cell is as hot as can be.
const HOTTEST: f64 = 20.0;
/// Places that are named first.
const PLACES: usize = 3;
/// Where the error of everything stands.
const OVERALL: &str = "overall/error_over_noise";

/// Everything between heading and footer.
pub fn content(result: &Place<'_>) -> Markup {
    let wrong = result.number(OVERALL).is_some_and(|error| error > AGREES);
    html! {
        (answer(result, wrong))
        @if result.get(OVERALL).is_some() {
            (cards(&worst(result)))
            (heat(result))
            (overlay::section(result))
            (orders(result))
            (regions(result))
            (signals(result))
            (scale::section(result))
        }
        (audit::used(result))
        (audit::section(result))
        @if wrong { (next("Find out which physics is missing:", result.text("next_command"))) }
    }
}

fn answer(result: &Place<'_>, wrong: bool) -> Markup {
    let error = shown(result, OVERALL, decimals(2));
    let (mood, text) = match (result.get(OVERALL), wrong) {
        (None, _) => (
            Mood::Caution,
            html! { "The audit refused this recording: nothing was compared" },
        ),
        (Some(_), true) => (
            Mood::Bad,
            html! { "The model misses the measurement by " (error) " times the noise" },
        ),
        (Some(_), false) => (
            Mood::Good,
            html! { "The model agrees with the measurement: " (error) " times the noise" },
        ),
    };
    let more = html! {
        p.subtle { (result.text("motor")) " against " (result.text("recording")) ", as the motor file says, nothing refitted" @if result.get("speed_scale").is_some() { " but the scale of the speed" } ". An error of 1 is what the sensors' own noise leaves." }
    };
    verdict(mood, &text, &more)
}

/// The worst places, each kind once.
fn worst(result: &Place<'_>) -> Vec<(Markup, Markup)> {
    let error = |place: &Place<'_>| place.number("error_over_noise").unwrap_or_default();
    let mut regions = result.items("regions");
    regions.sort_by(|a, b| error(b).total_cmp(&error(a)));
    let mut found: Vec<Place<'_>> = Vec::new();
    for region in regions {
        if found
            .iter()
            .all(|known| known.text("name") != region.text("name"))
        {
            found.push(region);
        }
    }
    found.truncate(PLACES);
    let card = |region: &Place<'_>| {
        (
            html! { (shown(region, "error_over_noise", decimals(2))) " × noise" },
            html! {
                (region.text("name")) ", "
                (shown(region, "from_s", decimals(2))) " to " (shown(region, "to_s", decimals(2))) " s"
            },
        )
    };
    found.iter().map(card).collect()
}

/// Rows of the heat map.
const QUANTITIES: [&str; 4] = ["load", "voltage", "slip", "frequency"];

fn heat(result: &Place<'_>) -> Markup {
    let bands = result.items("bands");
    if bands.is_empty() {
        return html! {};
    }
    let mut columns: Vec<&Place<'_>> = Vec::new();
    for band in &bands {
        if !columns.iter().any(|known| edge(known) == edge(band)) {
            columns.push(band);
        }
    }
    columns.sort_by_key(|band| edge(band));
    html! {
        section aria-labelledby="heat" {
            h2 id="heat" { "Where it fails: error by operating point" }
            p.subtle { "Error over noise of all parts of the recording in a band; 1 means that nothing is missing. Bands in percent of rated (slip: percent)." }
            div.wide tabindex="0" { table.heat {
                thead { tr {
                    th scope="col" { "" }
                    @for band in &columns { th scope="col" { (band_name(band)) } }
                } }
                tbody { @for quantity in QUANTITIES { tr {
                    th scope="row" { (quantity) }
                    @for column in &columns { (cell(&bands, quantity, column)) }
                } } }
            } }
        }
    }
}

/// The lower end of a band, percent.
fn edge(band: &Place<'_>) -> i64 {
    band.number("from_percent").unwrap_or_default() as i64
}

fn band_name(band: &Place<'_>) -> Markup {
    let to = band.number("to_percent").unwrap_or_default();
    html! {
        @if to >= 1000.0 { "above " (shown(band, "from_percent", decimals(0))) " %" }
        @else { (shown(band, "from_percent", decimals(0))) " to " (shown(band, "to_percent", decimals(0))) " %" }
    }
}

fn cell(bands: &[Place<'_>], quantity: &str, column: &Place<'_>) -> Markup {
    let found = bands
        .iter()
        .find(|band| band.text("quantity") == quantity && edge(band) == edge(column));
    match found {
        None => html! { td.none { "–" } },
        Some(band) => heat_cell(band),
    }
}

/// An error over noise on a ground that tells its size.
fn heat_cell(place: &Place<'_>) -> Markup {
    let error = place.number("error_over_noise").unwrap_or_default();
    let share = 100.0 * (error.max(1.0).ln() / HOTTEST.ln()).min(1.0);
    html! {
        td.hot[share > 55.0] style={ "--share:" (format!("{share:.0}")) } { (shown(place, "error_over_noise", decimals(2))) }
    }
}

fn regions(result: &Place<'_>) -> Markup {
    let rows = result.items("regions");
    let error = |row: &Place<'_>| row.number("error_over_noise").unwrap_or_default();
    let full = rows.iter().map(error).fold(0.0, f64::max);
    html! {
        @if !rows.is_empty() {
            section aria-labelledby="regions" {
                h2 id="regions" { "Where it fails: part by part" }
                div.wide tabindex="0" { table.bars.plain {
                    thead { tr { th scope="col" { "what the motor did" } th scope="col" { "from, s" } th scope="col" { "to, s" } th scope="col" { "error, × noise" } th.word scope="col" { "" } } }
                    tbody { @for row in &rows { tr {
                        th scope="row" { (row.text("name")) }
                        td { (shown(row, "from_s", decimals(2))) } td { (shown(row, "to_s", decimals(2))) }
                        td { (shown(row, "error_over_noise", decimals(2))) }
                        td.bar { (bar(error(row), full)) }
                    } } }
                } }
            }
        }
    }
}

/// What an order of the current error usually comes from.
fn meaning(order: f64) -> &'static str {
    match order as i64 {
        0 => "offset",
        1 => "positive sequence",
        -1 => "negative sequence",
        _ => "harmonic",
    }
}

fn orders(result: &Place<'_>) -> Markup {
    let rows = result.items("orders");
    if rows.is_empty() {
        return html! {};
    }
    let label = |row: &Place<'_>| {
        let order = row.number("order").unwrap_or_default();
        format!("{} {}", decimals(0).signed().text(order), meaning(order))
    };
    let chart = Chart::over_classes(
        "order of the supply frequency",
        rows.iter().map(label).collect(),
    )
    .y("amplitude", "A")
    .starting_at_zero()
    .with(
        Series::line(
            "current error",
            result.pointer_to("orders/*/amplitude_amp"),
            "blue",
        )
        .kind(Kind::Bars),
    );
    html! {
        section aria-labelledby="orders" {
            h2 id="orders" { "Orders of the current error" }
            div.charts.single { (chart.figure("Order spectrum", "Positive sequence: parameters, gains, saturation. Negative: an unbalanced machine, sensor or supply. 0: offsets. −5 and 7: inverter or saturation harmonics.")) }
        }
    }
}

fn signals(result: &Place<'_>) -> Markup {
    html! {
        section aria-labelledby="signals" {
            h2 id="signals" { "Signal by signal" }
            div.wide tabindex="0" { table.heat {
                thead { tr { th scope="col" { "signal" } th scope="col" { "rms" } th scope="col" { "rms error" } th scope="col" { "noise" } th scope="col" { "unit" } th scope="col" { "error, × noise" } } }
                tbody { @for row in result.items("signals") { tr {
                    th scope="row" { (row.text("name")) }
                    td.none { (shown(&row, "rms", significant(4))) }
                    td.none { (shown(&row, "error_rms", significant(3))) }
                    td.none { (shown(&row, "noise_floor", significant(3))) }
                    td.none { (row.text("unit")) }
                    (heat_cell(&row))
                } } }
            } }
        }
    }
}
