//! The page of `drivemon check`: state, cause, what to do, what cannot be seen; then what that rests on.

use maud::{Markup, html};

use crate::page::elements::chart::{Chart, Kind, Series};
use crate::page::elements::number::{Style, decimals, shown, significant};
use crate::page::elements::place::Place;
use crate::page::elements::shell::{Mood, cards, verdict};
use crate::page::sections::{audit, motion, plate};
use motor::FaultId;
use replay::VerdictState;

/// Everything between heading and footer.
pub fn content(result: &Place<'_>) -> Markup {
    let recordings = result.items("recordings");
    html! {
        div.check {
            @for (k, one) in recordings.iter().enumerate() {
                (answer(result, one))
                (steps(one, k))
                (cards(&figures(one)))
                (signals(one, k))
                (motion::section(one, &id("motion", k)))
                (causes(one, k))
            }
            (plate::section(result))
            @for (k, one) in recordings.iter().enumerate() { (basis(one, k)) }
        }
    }
}

fn answer(result: &Place<'_>, one: &Place<'_>) -> Markup {
    let mood = match one.read("state") {
        Some(VerdictState::Healthy) => Mood::Good,
        Some(VerdictState::Fault) => Mood::Bad,
        Some(VerdictState::NotJudged) | None => Mood::Caution,
    };
    let text = html! {
        span.told.coarse[!result.is_true("calibrated")] { (one.text("told/state")) }
        @if one.get("told/cause").is_some() { span.culprit { (one.text("told/cause")) } }
    };
    let severity = one.text("told/severity");
    let more = html! {
        @if !severity.is_empty() { p.severity { "Severity: " b { (severity) } } }
        p { (how_sure(one)) (one.text("told/sure")) }
        @for contradiction in result.items("contradictions").iter().take(1) {
            p { b { "The plate contradicts itself: " } (contradiction.as_text()) ". Read it again: the answer is as good as the plate." }
        }
        @if one.is_true("is_reference") {
            p { "You called the motor healthy in this recording: it taught what is normal, and is compared with itself. The next recording is compared with it." }
        }
        p.subtle { (result.text("motor")) ", " (result.text("known_by")) ". " (one.text("recording")) ", " (shown(one, "duration_s", significant(3))) " s." }
    };
    verdict(mood, &text, &more)
}

fn how_sure(one: &Place<'_>) -> &'static str {
    match one.read("state") {
        Some(VerdictState::Healthy | VerdictState::Fault) => "How sure: ",
        Some(VerdictState::NotJudged) | None => "Why: ",
    }
}

/// Faults that no row of the method is about ([`FaultId`]).
const BEYOND: &str = "bearings, insulation to ground, cooling";

/// What to do beside what cannot be seen.
fn steps(one: &Place<'_>, k: usize) -> Markup {
    let todo = one.items("todo");
    let blind = one.items("blind");
    html! {
        div.sides {
            section aria-labelledby=(id("todo", k)) {
                h2 id=(id("todo", k)) { "What to do" }
                @if todo.is_empty() { p { "Nothing. Check again in some weeks, or after anything was changed." } }
                ol.todo { @for step in &todo { li { (step.as_text()) } } }
            }
            section aria-labelledby=(id("blind", k)) {
                h2 id=(id("blind", k)) { "What cannot be seen here" }
                ul.blind {
                    @for spot in &blind { li { (spot.text("unseen")) span.subtle { " – needs " (spot.text("needs")) } } }
                    li { (BEYOND) span.subtle { " – needs other methods" } }
                }
            }
        }
    }
}

fn id(name: &str, k: usize) -> String {
    match k {
        0 => name.to_owned(),
        k => format!("{name}-{}", k + 1),
    }
}

fn figures(one: &Place<'_>) -> Vec<(Markup, Markup)> {
    let percent = |key: &str, style: Style, what: &'static str| {
        one.get(key)
            .map(|_| (html! { (shown(one, key, style)) " %" }, html! { (what) }))
    };
    let judged = (
        html! { (shown(one, "windows/0", decimals(0))) },
        html! { "windows judged, of " (shown(one, "windows/1", decimals(0))) },
    );
    let moved = one.number("motion/judged").filter(|judged| *judged > 0.0);
    let moved = moved.map(|_| {
        (
            html! { (shown(one, "motion/judged", decimals(0))) },
            html! { "windows judged in motion, of " (shown(one, "motion/windows", decimals(0))) " that were not at rest" },
        )
    });
    let speed = one.get("speed/mean_rpm").map(|_| {
        (
            html! { (shown(one, "speed/mean_rpm", decimals(0))) " rpm" },
            html! {
                "speed, estimated: no encoder. Slip " (shown(one, "speed/slip_percent", decimals(2))) " ± "
                (shown(one, "speed/slip_half_width_percent", decimals(2))) " % of synchronous speed"
            },
        )
    });
    let unbalance = percent(
        "current_unbalance_percent",
        decimals(2),
        "unbalance of the currents, negative over positive sequence, mean over the recording",
    );
    let visible = percent(
        "visible_percent/0",
        significant(3),
        "of the voltage balance (r1): a departure shows from here on",
    );
    let clamps = one.items("clamps").into_iter().map(|clamp| {
        (
            html! { (shown(&clamp, "rms", significant(3))) " " (clamp.text("unit")) },
            html! {
                (clamp.text("channel")) ", effective value"
                @if clamp.get("frequency_hz").is_some() { " at " (shown(&clamp, "frequency_hz", decimals(2))) " Hz" }
                ", " (shown(&clamp, "change_percent", decimals(1).signed())) " % from the first to the last quarter"
                @if clamp.get("rotor").is_some() { "; " (clamp.text("rotor")) }
            },
        )
    });
    let known = [Some(judged), moved, visible, unbalance, speed];
    known.into_iter().flatten().chain(clamps).collect()
}

/// Residuals against what shows, current and its unbalance, each small.
fn signals(one: &Place<'_>, k: usize) -> Markup {
    let any = |list: &str, key: &str| one.items(list).iter().any(|row| row.get(key).is_some());
    let residuals = any("residuals", "r_percent");
    let current = any("operation", "current_rms_amp");
    html! {
        @if residuals || current {
            section aria-labelledby=(id("signals", k)) {
                h2 id=(id("signals", k)) { "Over time" }
                div.charts.small {
                    @if residuals { @for r in 0..4 { (residual(one, r)) } }
                    @if current {
                        (over_time(one, Series::line("current", operation(one, "current_rms_amp"), "blue"), "A rms").figure("Current", "Positive sequence of the phase currents."))
                        (over_time(one, Series::line("share", operation(one, "i2_over_i1"), "blue").percent(), "%").figure("Current unbalance", "Negative over positive sequence."))
                    }
                }
            }
        }
    }
}

/// What each residual compares, in a few words.
const RESIDUALS: [&str; 4] = [
    "Voltage balance.",
    "Torque balance.",
    "Voltage and torque balance together, the speed taken out.",
    "Voltage and torque balance together, the current taken out.",
];

fn residual(one: &Place<'_>, r: usize) -> Markup {
    let from = one.pointer_to(&format!("residuals/*/r_percent/{r}"));
    let judged = one.pointer_to("residuals/*/judged");
    let mut chart = small("residuals", one)
        .y(&format!("r{}", r + 1), "% of scale")
        .with(
            Series::line("not judged", from.clone(), "grey")
                .kind(Kind::Points)
                .interrupted(judged.clone(), false)
                .outside_scale(),
        )
        .with(Series::line("judged", from, "blue").interrupted(judged, true));
    let limit = format!("visible_percent/{r}");
    if one.get(&limit).is_some() {
        chart = chart.limits("shows from", one.pointer_to(&limit));
    }
    chart.figure(&format!("r{}", r + 1), RESIDUALS[r])
}

fn operation(one: &Place<'_>, key: &str) -> String {
    one.pointer_to(&format!("operation/*/{key}"))
}

fn over_time(one: &Place<'_>, series: Series, unit: &'static str) -> Chart {
    let label = series.label.clone();
    small("operation", one)
        .y(&label, unit)
        .starting_at_zero()
        .with(series)
}

fn small(list: &str, one: &Place<'_>) -> Chart {
    let mut chart = Chart::over("time", "s", one.pointer_to(&format!("{list}/*/t"))).group("time");
    chart.height_rem = 11.0;
    chart
}

fn causes(one: &Place<'_>, k: usize) -> Markup {
    let rows = one.items("verdict/candidates");
    let tests = one.items("verdict/separating_tests");
    html! {
        @if !rows.is_empty() {
            section aria-labelledby=(id("causes", k)) {
                h2 id=(id("causes", k)) { "Possible causes" }
                div.wide tabindex="0" { table.bars.plain {
                    thead { tr { th scope="col" { "cause" } th scope="col" { "probability, %" } th.word scope="col" { "" } } }
                    tbody { @for row in &rows { (cause(row)) } }
                } }
                @if !tests.is_empty() {
                    p { "The first " (shown(one, "verdict/tied", decimals(0))) " are tied: this recording does not tell them apart. What does:" }
                    ul { @for test in &tests { li { (test.as_text()) } } }
                }
            }
        }
    }
}

fn cause(row: &Place<'_>) -> Markup {
    let fault = FaultId::from_name(row.text("fault")).unwrap_or(FaultId::Unknown);
    let share = 100.0 * row.number("probability").unwrap_or_default();
    html! {
        tr {
            th scope="row" {
                (fault.words())
                @if row.get("phase").is_some() { ", phase " (row.text("phase")) }
                @if row.get("size_percent").is_some() { ", " (shown(row, "size_percent", decimals(1).signed())) " %" }
            }
            td { (shown(row, "probability", decimals(1).times(100.0))) }
            td.bar { i style={ "width:" (format!("{share:.1}")) "%" } {} }
        }
    }
}

/// What the answer rests on: the recording itself, bars, windows that were left out.
fn basis(one: &Place<'_>, k: usize) -> Markup {
    let reasons = one.items("not_judged");
    html! {
        (audit::section_of(one, &id("audit", k), one.text("recording")))
        p { "Rotor: " (one.text("rotor")) "." }
        @if !reasons.is_empty() {
            p { "Left out of the judgement:" }
            ul { @for reason in &reasons { li { (reason.as_text()) } } }
        }
    }
}
