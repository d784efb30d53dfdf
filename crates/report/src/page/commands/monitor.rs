//! The page of `drivemon monitor`: verdict, lamps over time, residuals against their thresholds.

use maud::{Markup, html};

use crate::page::elements::chart::{Chart, Kind, Series};
use crate::page::elements::number::{decimals, shown, significant};
use crate::page::elements::place::Place;
use crate::page::elements::shell::{Mood, cards, verdict};
use crate::page::sections::{audit, motion};
use motor::FaultId;
use replay::VerdictState;

/// Everything between heading and footer.
pub fn content(result: &Place<'_>) -> Markup {
    html! {
        (answer(result))
        (cards(&summary(result)))
        (doubts(result))
        (candidates(result))
        (motion::section(result, "motion"))
        (lamps(result))
        (residuals(result))
        (audit::section(result))
        (operation(result))
        (sequence(result))
        (not_judged(result))
    }
}

fn answer(result: &Place<'_>) -> Markup {
    let read = |path: &str| result.read(path).unwrap_or(VerdictState::NotJudged);
    let (state, at_rest) = (read("state"), read("verdict/state"));
    let (mood, text) = match (result.is_true("audit/supported"), state) {
        (false, _) => (
            Mood::Caution,
            html! { "The audit refused this recording: nothing was judged" },
        ),
        (true, VerdictState::Fault) if at_rest != VerdictState::Fault => {
            (Mood::Bad, motion::alarm(result).unwrap_or_default())
        }
        (true, VerdictState::Fault) => (
            Mood::Bad,
            html! { "Fault, first lit at " (shown(result, "first_alarm_s", decimals(3))) " s" },
        ),
        (true, VerdictState::Healthy) if at_rest == VerdictState::NotJudged => (
            Mood::Good,
            html! { "No fault was seen in motion; nothing could be judged at rest" },
        ),
        (true, VerdictState::Healthy) => (Mood::Good, html! { "Healthy: no fault was lit" }),
        (true, VerdictState::NotJudged) if !result.items("motion/unexplained").is_empty() => (
            Mood::Caution,
            html! { "Not judged: something in motion does not fit, and no fault explains it" },
        ),
        (true, VerdictState::NotJudged) if !result.items("doubts").is_empty() => (
            Mood::Caution,
            html! { "Not judged: no fault was lit, and something does not fit" },
        ),
        (true, VerdictState::NotJudged) => (
            Mood::Caution,
            html! { "Not judged: no window met the conditions" },
        ),
    };
    let judged = html! {
        p.subtle {
            (result.text("recording")) ": " (shown(result, "judged", decimals(0))) " of "
            (shown(result, "windows", decimals(0))) " windows were judged."
        }
        (beyond(result))
    };
    verdict(mood, &text, &judged)
}

/// How much lies beyond the calibration, where little is known.
fn beyond(result: &Place<'_>) -> Markup {
    let windows = result.number("beyond_calibration/windows");
    let path = |key: &str| format!("beyond_calibration/{key}_percent");
    let parts = [
        ("current", " % above its largest current"),
        ("volt_per_hertz", " % off its voltages over frequency"),
        ("frequency", " % off its frequencies"),
        (
            "lighter",
            " % of the rated current below its smallest active current",
        ),
        ("fed_back", " % of the rated current fed back"),
        ("slip", " % more frequency in the cage than loads bring"),
    ];
    // As in the words of the timeline: less is not worth one.
    let told = parts
        .into_iter()
        .filter(|(key, _)| result.number(&path(key)).is_some_and(|x| x >= 1.0));
    html! {
        @if windows.is_some_and(|windows| windows > 0.0) {
            p.subtle {
                (shown(result, "beyond_calibration/windows", decimals(0))) " of them lie beyond the calibration ("
                @for (k, (key, words)) in told.enumerate() {
                    @if k > 0 { ", " }
                    "up to " (shown(result, &path(key), decimals(0))) (words)
                }
                "): small faults stay dark there. Record the motor in good order there, and calibrate with it."
            }
        }
    }
}

fn summary(result: &Place<'_>) -> Vec<(Markup, Markup)> {
    let cards = (0..4).filter_map(|k| {
        let mean = format!("residual_percent/mean/{k}");
        result.get(&mean)?;
        let scatter = format!("residual_percent/standard_deviation/{k}");
        Some((
            html! { (shown(result, &mean, decimals(2).signed())) " %" },
            html! {
                "mean r" (k + 1) " of the judged windows, scatter " (shown(result, &scatter, decimals(2))) " %"
                @if result.get("threshold_percent").is_some() {
                    ", lamp at ±" (shown(result, &format!("threshold_percent/{k}"), significant(2))) " %"
                }
            },
        ))
    });
    cards.chain(rotor(result)).collect()
}

/// The sidebands that broken bars would leave, where there was load enough to see them.
fn rotor(result: &Place<'_>) -> Option<(Markup, Markup)> {
    result.get("rotor/lower_sideband_percent")?;
    let percent = |key: &str| shown(result, &format!("rotor/{key}_percent"), decimals(2));
    Some((
        html! { (percent("lower_sideband")) " %" },
        html! {
            "of the active current at (1 - 2 s) f, mean of " (shown(result, "rotor/blocks", decimals(0)))
            " blocks; bars " (result.text("rotor/state")) ": doubtful from " (percent("doubtful_from")) " %, broken from "
            (percent("broken_from")) " %"
            @if result.get("rotor/at_calibration_percent").is_some() {
                ", at calibration " (percent("at_calibration")) " %"
            }
        },
    ))
}

/// What contradicts a motor in good order, and what settles it.
fn doubts(result: &Place<'_>) -> Markup {
    let rows = result.items("doubts");
    html! {
        @if !rows.is_empty() {
            section aria-labelledby="doubts" {
                h2 id="doubts" { "What does not fit" }
                table {
                    thead { tr { th.word scope="col" { "seen" } th.word scope="col" { "what settles it" } } }
                    tbody { @for row in &rows { tr { td.word { (row.text("seen")) } td.word { (row.text("remedy")) } } } }
                }
            }
        }
    }
}

fn candidates(result: &Place<'_>) -> Markup {
    let rows = result.items("verdict/candidates");
    html! {
        @if !rows.is_empty() {
            section aria-labelledby="causes" {
                h2 id="causes" { "Possible causes" }
                div.wide tabindex="0" { table.bars.plain {
                    thead { tr { th scope="col" { "cause" } th scope="col" { "probability, %" } th.word scope="col" { "" } } }
                    tbody { @for row in &rows { (candidate(row)) } }
                } }
                (tie(result))
            }
        }
    }
}

fn tie(result: &Place<'_>) -> Markup {
    let tests = result.items("verdict/separating_tests");
    html! {
        @if !tests.is_empty() {
            p {
                "The first " (shown(result, "verdict/tied", decimals(0)))
                " are tied: this recording does not tell them apart. What does:"
            }
            ul { @for test in &tests { li { (test.as_text()) } } }
        }
    }
}

fn candidate(row: &Place<'_>) -> Markup {
    let name = row.text("fault");
    let fault = FaultId::from_name(name).unwrap_or(FaultId::Unknown);
    let share = 100.0 * row.number("probability").unwrap_or_default();
    html! {
        tr {
            th scope="row" {
                (fault.words()) " (" (name) ")"
                @if row.get("phase").is_some() { ", phase " (row.text("phase")) }
                @if row.get("size_percent").is_some() {
                    ", " (shown(row, "size_percent", decimals(0).signed())) " %"
                }
            }
            td { (shown(row, "probability", decimals(1).times(100.0))) }
            td.bar { i style={ "width:" (format!("{share:.1}")) "%" } {} }
        }
    }
}

/// Lamps from top to bottom: key in the result, name on the panel.
const LAMPS: [(&str, &str); 9] = [
    ("run", "RUN"),
    ("r1", "r1"),
    ("r2", "r2"),
    ("r3", "r3"),
    ("r4", "r4"),
    ("sensor", "SENSOR"),
    ("line", "LINE"),
    ("load", "LOAD"),
    ("fault", "FAULT"),
];

fn lamps(result: &Place<'_>) -> Markup {
    let changes = result.items("lamps");
    let last = result.items("operation").last().cloned();
    let (Some(first), Some(last)) = (changes.first(), last) else {
        return html! {};
    };
    let span = Span {
        from: first.number("t").unwrap_or_default(),
        to: last.number("t").unwrap_or_default(),
    };
    html! {
        section aria-labelledby="lamps" {
            h2 id="lamps" { "Lamps over time" }
            p.key {
                span { span.swatch { i style="background:var(--vermillion)" {} } "on" }
                span { span.swatch.strip { i.blink style="width:100%" {} } "blinking: waiting, transient or not judged" }
                span { span.swatch {} "off" }
            }
            div.strips {
                @for (key, name) in LAMPS {
                    span { (name) }
                    div.strip.run[key == "run"] role="img" aria-label={ (name) ": " (story(&changes, key)) } {
                        (strip(&changes, key, &span))
                    }
                }
                span {}
                div.scale {
                    span { (shown(first, "t", decimals(2))) " s" }
                    span { (shown(&last, "t", decimals(2))) " s" }
                }
            }
        }
    }
}

/// The time that the strips show, s.
struct Span {
    from: f64,
    to: f64,
}

fn strip(changes: &[Place<'_>], key: &str, span: &Span) -> Markup {
    let percent = 100.0 / (span.to - span.from).max(f64::MIN_POSITIVE);
    html! {
        @for (from, to, state) in stretches(changes, key, span.to) {
            i class=(state) style={ "width:" (format!("{:.3}", percent * (to - from))) "%" }
                title={ (state) ", " (decimals(3).text(from)) " to " (decimals(3).text(to)) " s" } {}
        }
    }
}

/// Stretches of time in which one lamp stays as it is.
fn stretches<'a>(changes: &[Place<'a>], key: &str, end: f64) -> Vec<(f64, f64, &'a str)> {
    let mut found: Vec<(f64, f64, &str)> = Vec::new();
    for change in changes {
        let (t, state) = (change.number("t").unwrap_or_default(), change.text(key));
        if let Some((_, to, _)) = found.last_mut() {
            *to = t;
        }
        if found.last().is_none_or(|(_, _, before)| *before != state) {
            found.push((t, end, state));
        }
    }
    if let Some((_, to, _)) = found.last_mut() {
        *to = end;
    }
    found
}

/// The strip for those who hear it.
fn story(changes: &[Place<'_>], key: &str) -> String {
    let first_on = changes.iter().find(|change| change.text(key) == "on");
    match first_on.and_then(|change| change.number("t")) {
        Some(t) => format!("first on at {} s", decimals(3).text(t)),
        None => "never on".to_owned(),
    }
}

fn residuals(result: &Place<'_>) -> Markup {
    html! {
        @if !result.items("residuals").is_empty() {
            section aria-labelledby="residuals" {
                h2 id="residuals" { "Residuals against their thresholds" }
                p.subtle { "One value per window. Inside the shaded band the lamp stays dark; grey points were not judged and may leave the figure." }
                div.charts { @for k in 0..4 { (residual(result, k)) } }
            }
        }
    }
}

fn residual(result: &Place<'_>, k: usize) -> Markup {
    let from = result.pointer_to(&format!("residuals/*/r_percent/{k}"));
    let judged = result.pointer_to("residuals/*/judged");
    let mut chart = Chart::over("time", "s", result.pointer_to("residuals/*/t"))
        .y(&format!("r{}", k + 1), "% of scale")
        .with(
            Series::line("not judged", from.clone(), "grey")
                .kind(Kind::Points)
                .interrupted(judged.clone(), false)
                .outside_scale(),
        )
        .with(
            Series::line("judged", from, "blue")
                .kind(Kind::Marked)
                .interrupted(judged, true),
        )
        .group("time");
    if result.get("threshold_percent").is_some() {
        chart = chart.limits(
            "threshold",
            result.pointer_to(&format!("threshold_percent/{k}")),
        );
    }
    chart.figure(&format!("r{}", k + 1), RESIDUAL_MEANING[k])
}

/// What each residual compares.
const RESIDUAL_MEANING: [&str; 4] = [
    "Voltage equation: measured voltage against resistance drop and speed voltage.",
    "Torque balance: electrical torque against friction and load.",
    "Voltage and torque balance with the speed eliminated.",
    "Voltage and torque balance with the current eliminated.",
];

/// What the machine did: key, axis, unit, what exactly.
const SIGNALS: [(&str, &str, &str, &str); 7] = [
    (
        "voltage_rms_volt",
        "voltage",
        "V rms",
        "Positive sequence of the phase voltages.",
    ),
    (
        "current_rms_amp",
        "current",
        "A rms",
        "Positive sequence of the phase currents.",
    ),
    (
        "speed_rad_s",
        "speed",
        "rad/s",
        "Mechanical speed of the shaft.",
    ),
    (
        "frequency_hz",
        "frequency",
        "Hz",
        "Frequency of the supply.",
    ),
    (
        "torque_nm",
        "brake torque",
        "N m",
        "Torque of the load at the shaft.",
    ),
    (
        "i2_over_i1",
        "current unbalance",
        "%",
        "Negative over positive sequence of the currents.",
    ),
    (
        "v2_over_v1",
        "voltage unbalance",
        "%",
        "Negative over positive sequence of the voltages.",
    ),
];

/// What is shown in percent is a share in the result.
fn in_unit(unit: &str, series: Series) -> Series {
    match unit {
        "%" => series.percent(),
        _ => series,
    }
}

fn operation(result: &Place<'_>) -> Markup {
    let windows = result.items("operation");
    let measured = |key: &str| windows.iter().any(|window| window.get(key).is_some());
    html! {
        @if !windows.is_empty() {
            section aria-labelledby="operation" {
                h2 id="operation" { "What the motor did" }
                div.charts {
                    @for (key, axis, unit, what) in SIGNALS {
                        @if measured(key) {
                            (Chart::over("time", "s", result.pointer_to("operation/*/t"))
                                .y(axis, unit)
                                .with(in_unit(unit, Series::line(axis, result.pointer_to(&format!("operation/*/{key}")), "blue")))
                                .group("time")
                                .figure(axis, what))
                        }
                    }
                }
            }
        }
    }
}

fn sequence(result: &Place<'_>) -> Markup {
    let percent = decimals(2).times(100.0);
    let rows = [
        (
            "i2_over_i1",
            percent,
            "%",
            "negative over positive sequence of the currents",
        ),
        (
            "i2_over_i1_angle_deg",
            decimals(0),
            "°",
            "angle of that ratio, from phase a",
        ),
        (
            "largest_i2_over_i1",
            percent,
            "%",
            "the same in the worst single window",
        ),
        (
            "v2_over_v1",
            percent,
            "%",
            "negative over positive sequence of the voltages",
        ),
        (
            "i0_over_i1",
            percent,
            "%",
            "zero over positive sequence of the currents",
        ),
    ];
    html! {
        section aria-labelledby="sequence" {
            h2 id="sequence" { "Symmetrical components" }
            p.subtle { "A negative sequence of the current that the voltage does not explain is an unbalance inside the motor or of a sensor; a zero sequence without a neutral conductor is a sensor." }
            table { tbody { @for (key, style, unit, what) in rows { tr {
                th scope="row" { (what) }
                td {
                    @let path = format!("sequence/{key}");
                    @if result.get(&path).is_some() { (shown(result, &path, style)) " " (unit) } @else { "not measured" }
                }
            } } } }
        }
    }
}

fn not_judged(result: &Place<'_>) -> Markup {
    let reasons = result.items("not_judged");
    html! {
        @if !reasons.is_empty() {
            section aria-labelledby="reasons" {
                h2 id="reasons" { "Why windows were not judged" }
                table { thead { tr { th scope="col" { "reason" } th scope="col" { "windows" } } }
                    tbody { @for reason in &reasons { tr {
                        th scope="row" { (reason.text("reason")) } td { (shown(reason, "windows", decimals(0))) }
                    } } }
                }
            }
        }
    }
}
