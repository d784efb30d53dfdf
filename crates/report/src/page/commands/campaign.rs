//! The page of `drivemon campaign table`: healthy windows and their alarms, what is detected, what is named.

use maud::{Markup, html};

use crate::page::elements::chart::{Chart, Kind, Series};
use crate::page::elements::number::{decimals, shown};
use crate::page::elements::place::Place;
use crate::page::elements::shell::{Mood, cards, verdict};

/// Alarms that are listed; the embedded result has all.
const MOST_ALARMS: usize = 100;

/// Everything between heading and footer.
pub fn content(result: &Place<'_>) -> Markup {
    let campaigns = result.items("campaigns");
    html! {
        @for campaign in &campaigns {
            (answer(campaign))
            (cards(&summary(campaign)))
            (healthy(campaign))
            (in_motion(campaign))
            (alarms(campaign))
            (detection(campaign))
        }
    }
}

fn answer(campaign: &Place<'_>) -> Markup {
    let quiet = campaign.number("fault_windows") == Some(0.0);
    verdict(
        if quiet { Mood::Good } else { Mood::Bad },
        &html! {
            (campaign.text("plan")) ": FAULT in " (shown(campaign, "fault_windows", decimals(0))) " of "
            (shown(campaign, "healthy_windows", decimals(0))) " windows of healthy motors"
        },
        &html! {
            p.subtle {
                (shown(campaign, "counted", decimals(0))) " of " (shown(campaign, "runs", decimals(0)))
                " runs, seed " (shown(campaign, "seed", decimals(0))) ", fingerprint " (campaign.text("fingerprint"))
                ". " (shown(campaign, "not_run", decimals(0))) " could not run under their conditions."
            }
        },
    )
}

fn summary(campaign: &Place<'_>) -> Vec<(Markup, Markup)> {
    let mut cards = vec![(
        html! { (shown(campaign, "healthy_windows", decimals(0))) },
        html! { "healthy windows judged" },
    )];
    if campaign.number("targets_met/of") > Some(0.0) {
        cards.push((
            html! { (shown(campaign, "targets_met/count", decimals(0))) " / " (shown(campaign, "targets_met/of", decimals(0))) },
            html! { "targets of detection met" },
        ));
    }
    cards
}

fn healthy(campaign: &Place<'_>) -> Markup {
    html! {
        section {
            h2 { "Healthy motors" }
            div.wide tabindex="0" { table {
                thead { tr {
                    @for head in ["motor", "block", "windows judged", "FAULT in", "runs", "with FAULT", "at most, % (95 %)"] { th scope="col" { (head) } }
                } }
                tbody { @for row in campaign.items("healthy") { tr {
                    th scope="row" { (row.text("motor")) } td { (row.text("block")) }
                    td { (shown(&row, "judged_windows", decimals(0))) } td { (shown(&row, "fault_windows", decimals(0))) }
                    td { (shown(&row, "fault_runs/of", decimals(0))) } td { (shown(&row, "fault_runs/count", decimals(0))) }
                    td { (shown(&row, "fault_run_probability_at_most", decimals(2).times(100.0))) }
                } } }
            } }
        }
    }
}

/// Windows that were not at rest, where the plan asks for them.
fn in_motion(campaign: &Place<'_>) -> Markup {
    let rows = campaign.items("healthy");
    let moved = |row: &&Place<'_>| row.number("moved_windows") > Some(0.0);
    if !rows.iter().any(|row| moved(&row)) {
        return html! {};
    }
    html! {
        section {
            h2 { "In motion" }
            p.subtle { "Unexplained: runs in which something came on the healthy motor that no fault explains. It is no FAULT, and nothing is called healthy." }
            div.wide tabindex="0" { table {
                thead { tr {
                    @for head in ["motor", "block", "windows not at rest", "judged in motion", "unexplained, runs"] { th scope="col" { (head) } }
                } }
                tbody { @for row in rows.iter().filter(moved) { tr {
                    th scope="row" { (row.text("motor")) } td { (row.text("block")) }
                    td { (shown(row, "moved_windows", decimals(0))) } td { (shown(row, "motion_judged_windows", decimals(0))) }
                    td { (shown(row, "unexplained_runs", decimals(0))) }
                } } }
            } }
        }
    }
}

fn alarms(campaign: &Place<'_>) -> Markup {
    let alarms = campaign.items("alarms");
    if alarms.is_empty() {
        return html! {};
    }
    html! {
        section {
            h2 { "FAULT on a healthy motor" }
            p.subtle { "drivemon campaign replay PLAN --index RUN makes any of these runs again." }
            @if alarms.len() > MOST_ALARMS { p.subtle { "The first " (MOST_ALARMS) " of them; the embedded result has all." } }
            p { "To blame: " @for cause in campaign.items("causes") { (cause.text("cause")) " in " (shown(&cause, "runs", decimals(0))) " runs. " } }
            div.wide tabindex="0" { table {
                thead { tr {
                    @for head in ["run", "motor", "from, s", "windows", "lamps", "named", "to blame", "conditions"] { th scope="col" { (head) } }
                } }
                tbody { @for row in alarms.iter().take(MOST_ALARMS) { tr {
                    th scope="row" { (shown(row, "index", decimals(0))) } td { (row.text("motor")) }
                    td { (shown(row, "first_s", decimals(3))) } td { (shown(row, "fault_windows", decimals(0))) }
                    td { (row.text("lamps")) } td { (row.text("named")) } td { (row.text("cause")) } td { (row.text("conditions")) }
                } } }
            } }
        }
    }
}

fn detection(campaign: &Place<'_>) -> Markup {
    let rows = campaign.items("detection");
    if rows.is_empty() {
        return html! {};
    }
    html! {
        section {
            h2 { "What is detected" }
            p.subtle { "The smallest size from which on FAULT comes in at least 99 of 100 runs; what is named counts from there on." }
            div.wide tabindex="0" { table {
                thead { tr {
                    @for head in ["fault", "motor", "block", "smallest, %", "target, %", "met", "isolation at, %", "named"] { th scope="col" { (head) } }
                } }
                tbody { @for row in &rows { (detected(row)) } }
            } }
            div.charts { @for row in &rows { (chart(row)) } }
        }
    }
}

fn detected(row: &Place<'_>) -> Markup {
    let met = match row.get("target_met") {
        None => "",
        Some(_) if row.is_true("target_met") => "yes",
        Some(_) => "no",
    };
    html! { tr {
        th scope="row" { (row.text("fault")) " " (row.text("direction")) } td { (row.text("motor")) } td { (row.text("block")) }
        td { (shown(row, "smallest_percent", decimals(1).signed())) }
        td { (shown(row, "target_percent", decimals(0))) } td { (met) }
        td { (shown(row, "isolation_percent", decimals(1).signed())) }
        td { @for named in row.items("named").iter().take(4) {
            (named.text("cause")) " in " (shown(named, "runs", decimals(0))) " runs. "
        } }
    } }
}

fn chart(row: &Place<'_>) -> Markup {
    let at = |key: &str| row.pointer_to(&format!("sizes/*/{key}"));
    let share = |label: &str, key: &str, colour| {
        Series::line(label, at(&format!("{key}/percent")), colour).kind(Kind::Marked)
    };
    let heading = format!(
        "{} {}, {}, {}",
        row.text("fault"),
        row.text("direction"),
        row.text("motor"),
        row.text("block")
    );
    Chart::over("change", "%", at("change_percent"))
        .y("runs", "%")
        .starting_at_zero()
        .with(share("detected", "detected", "blue"))
        .with(share(
            "cause right, of the detected",
            "cause_right",
            "green",
        ))
        .with(share("cause and phase right", "isolated", "purple"))
        .figure(&heading, row.text("limit"))
}
