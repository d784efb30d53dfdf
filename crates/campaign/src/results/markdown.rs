//! The golden table: one page that is written by the program and reviewed as a whole.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::planned::fault::FaultKind;
use crate::results::detection::{Detection, Size, TOLD_APART};
use crate::results::print::{in_motion, named, percent, size_of};
use crate::results::table::Table;

/// Alarms that are listed one by one.
const MOST_ALARMS: usize = 50;

const INTRODUCTION: &str = "\
# What is detected, how small, how fast, how often wrongly

Written by `drivemon campaign table`; do not edit. How it is measured, and how any line of it is made again, is in
[campaign](campaign.md). Every run is simulated, replayed through the core in ADC codes as the board sees it, and
judged with the motor file that the table names; what is simulated departs from it.

*Smallest* is the smallest size from which on FAULT comes in at least 99 of 100 runs; *proven* is the exact lower bound of
that probability (Clopper and Pearson, 95 % one-sided) at this size. Delays count from the fault to FAULT:
a window of five cycles and three windows of persistence take 160 ms at 50 Hz; beyond 200 ms the smallest size stands so near the limit that
noise keeps single windows below it. *Cause right*: the true cause
is likelier than any other, at the smallest size; *or tied*: or at most
half a decade less likely than the likeliest; *at twice*: cause and phase, at the first size that is at least twice the smallest.
`<=` stands where nothing smaller was tried. *Left out*: runs that say nothing because FAULT was lit before the fault came; where they are
most of the runs, no size counts as detected. *Unsteady*: runs that say nothing because the motor stalled or swung with the fault, so that nothing
was judged; sizes with which most motors do so are beyond the scale.
";

/// The page for some campaigns.
pub fn page(tables: &[Table]) -> String {
    let mut page = INTRODUCTION.to_owned();
    for table in tables {
        // Writing to a String cannot fail.
        let _ = campaign(&mut page, table);
    }
    page
}

fn campaign(page: &mut String, table: &Table) -> std::fmt::Result {
    let about = &table.about;
    writeln!(page, "\n## {}\n", about.plan)?;
    writeln!(
        page,
        "{} of {} runs, seed {}, fingerprint `{}`, version {}. Runs whose motor cannot carry the load under their conditions: {}.\n",
        table.counted, about.runs, about.seed, about.fingerprint, about.version, table.not_run
    )?;
    healthy(page, table)?;
    alarms(page, table)?;
    detection(page, table)
}

fn healthy(page: &mut String, table: &Table) -> std::fmt::Result {
    writeln!(
        page,
        "| motor | block | healthy windows judged | FAULT in | runs | with FAULT | at most (95 %) |"
    )?;
    writeln!(page, "|---|---|---|---|---|---|---|")?;
    for row in &table.healthy {
        writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} | {:.2} % |",
            row.motor,
            row.block,
            row.judged_windows,
            row.fault_windows,
            row.fault_runs.of,
            row.fault_runs.count,
            100.0 * row.fault_run_probability_at_most
        )?;
    }
    writeln!(
        page,
        "\nAltogether {} healthy windows were judged, FAULT was lit in {}.",
        table.healthy_windows, table.fault_windows
    )?;
    match in_motion(table) {
        Some(moved) => writeln!(page, "{moved}."),
        None => Ok(()),
    }
}

fn alarms(page: &mut String, table: &Table) -> std::fmt::Result {
    if table.alarms.is_empty() {
        return Ok(());
    }
    let causes = named(&table.causes, table.causes.len());
    writeln!(
        page,
        "\nTo blame for FAULT (without it the same run stays dark): {causes}.\n\nRun by run:\n"
    )?;
    writeln!(
        page,
        "| run | motor | from | windows with it | judged | lamps | named | to blame | conditions |"
    )?;
    writeln!(page, "|---|---|---|---|---|---|---|---|---|")?;
    for alarm in table.alarms.iter().take(MOST_ALARMS) {
        writeln!(
            page,
            "| {} | {} | {:.3} s | {} | {} | {} | {} | {} | {} |",
            alarm.index,
            alarm.motor,
            alarm.first_s,
            alarm.fault_windows,
            alarm.judged_windows,
            alarm.lamps,
            cell(&alarm.named),
            alarm.cause,
            alarm.conditions
        )?;
    }
    let more = table.alarms.len().saturating_sub(MOST_ALARMS);
    if more > 0 {
        writeln!(page, "\n{more} more runs are left out.")?;
    }
    Ok(())
}

fn detection(page: &mut String, table: &Table) -> std::fmt::Result {
    let mut place = (String::new(), String::new());
    for row in &table.detection {
        let now = (row.motor.clone(), row.block.clone());
        if now != place {
            writeln!(page, "\n### {}, {}\n", now.0, now.1)?;
            writeln!(
                page,
                "| fault | smallest | proven | median | 95 % | cause right | or tied | at twice | left out | unsteady | target | named |"
            )?;
            writeln!(page, "|---|---|---|---|---|---|---|---|---|---|---|---|")?;
            place = now;
        }
        one(page, row)?;
    }
    pairs(page, table)?;
    limits(page, table)
}

/// The pairs that the paper leaves at 50 %.
fn pairs(page: &mut String, table: &Table) -> std::fmt::Result {
    let mut rows = table
        .detection
        .iter()
        .filter_map(|row| Some((row, row.rival.as_ref()?)))
        .peekable();
    if rows.peek().is_none() {
        return Ok(());
    }
    writeln!(
        page,
        "\n### Pairs that share a row of the paper's Table 1, at twice the smallest detected size\n\n\
         `L_s` is magnetizing inductance or leakage. *Right*: the true side is named and likelier than the other; *not even tied*: and the\n\
         other is at least half a decade less likely.\n\n\
         | motor | block | fault | size | against | right | not even tied |\n|---|---|---|---|---|---|---|"
    )?;
    for (row, rival) in rows {
        writeln!(
            page,
            "| {} | {} | `{}` | {:+} % | {} | {} | {} |",
            row.motor,
            row.block,
            row.fault,
            rival.change_percent,
            rival.cause,
            percent(Some(rival.right)),
            percent(Some(rival.told_apart))
        )?;
    }
    Ok(())
}

fn one(page: &mut String, row: &Detection) -> std::fmt::Result {
    let words = FaultKind::find(&row.fault).map_or("", |kind| kind.words);
    let isolated = row.isolation().map(|size| size.isolated);
    writeln!(
        page,
        "| `{}` {words} | {} | {} | {} | {} | {} | {} |",
        row.fault,
        row.smallest()
            .map_or_else(|| best(row), |size| smallest(&size_of(row), size)),
        percent(isolated),
        percent(Some(row.lit_before)),
        percent(Some(row.unsteady)),
        target(row),
        cell(&named(&row.named, 4))
    )
}

fn smallest(words: &str, size: &Size) -> String {
    let time = |s: Option<f64>| s.map_or("-".to_owned(), |s| format!("{:.0} ms", 1000.0 * s));
    format!(
        "{words} | {:.1} % | {} | {} | {} | {}",
        100.0 * size.probability_at_least,
        time(size.delay_median_s),
        time(size.delay_95_s),
        percent(Some(size.cause_right)),
        percent(Some(size.truth_named))
    )
}

/// How far the largest size comes.
fn best(row: &Detection) -> String {
    let largest = row.sizes.last().map_or(String::new(), |size| {
        format!(
            "{} of {:+} %",
            percent(Some(size.detected)),
            size.change_percent
        )
    });
    format!("none: {largest} | - | - | - | - | -")
}

fn target(row: &Detection) -> String {
    match (row.target_percent, row.target_met) {
        (Some(target), Some(true)) => format!("{target} %, met"),
        (Some(target), _) => format!("**{target} %, not met**"),
        _ => "-".to_owned(),
    }
}

/// What limits the targets that are not met.
fn limits(page: &mut String, table: &Table) -> std::fmt::Result {
    let missed = |row: &&Detection| row.target_met == Some(false);
    let limit = |row: &Detection| (row.fault.clone(), row.limit.clone());
    reasons(
        page,
        "What limits the targets that are not met",
        table.detection.iter().filter(missed).map(limit),
    )?;
    let mixed_up = |row: &&Detection| {
        let rival = row.rival.as_ref();
        rival.is_some_and(|rival| rival.right.value() < TOLD_APART)
    };
    let limit = |row: &Detection| (row.fault.clone(), row.pair_limit.clone());
    reasons(
        page,
        "What limits the pairs of which less than 95 % are right",
        table.detection.iter().filter(mixed_up).map(limit),
    )
}

fn reasons(
    page: &mut String,
    title: &str,
    reasons: impl Iterator<Item = (String, String)>,
) -> std::fmt::Result {
    let reasons: BTreeSet<_> = reasons.filter(|(_, why)| !why.is_empty()).collect();
    if reasons.is_empty() {
        return Ok(());
    }
    writeln!(page, "\n{title}:\n")?;
    for (fault, why) in reasons {
        writeln!(page, "- `{fault}`: {why}.")?;
    }
    Ok(())
}

/// A bar would end the cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', " or ")
}
