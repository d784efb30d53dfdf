//! The tables of docs/fleet/false-alarms.md.

use std::collections::BTreeMap;

use campaign::hours::Event;
use campaign::poisson_at_most;

use crate::tally::{Lit, Tally};

pub fn print(tallies: &[Tally], seed: u64, list: bool) {
    let (refused, lived): (Vec<_>, Vec<_>) = tallies.iter().partition(|t| t.refused.is_some());
    let days: f64 = lived.iter().map(|t| t.days).sum();
    let ran: f64 = lived.iter().map(|t| t.ran_days).sum();
    let in_cycles: f64 = lived.iter().map(|t| t.lived_days).sum();
    let windows: u64 = lived.iter().map(|t| t.windows).sum();
    let judged: u64 = lived.iter().map(|t| t.judged).sum();
    println!(
        "{} machines, seed {seed}; {} calibrations refused. {days:.0} motor-days, {ran:.1} of them running, {in_cycles:.1} in cycles \
         and samples; {windows} windows, {judged} judged.\n",
        lived.len(),
        refused.len()
    );
    counted(&lived, days);
    let faults: Vec<&Lit> = lived.iter().flat_map(|t| &t.faults).collect();
    by_doing(&lived, &faults);
    by_cause(&faults);
    departures(&lived);
    if list {
        listed(tallies);
    }
}

fn counted(lived: &[&Tally], days: f64) {
    let alarms = |k: usize| lived.iter().map(|t| t.alarms[k]).sum::<u64>();
    let lamps = |of: fn(&Tally) -> usize| lived.iter().map(|t| of(t) as u64).sum::<u64>();
    let machines = |of: fn(&Tally) -> bool| lived.iter().filter(|t| of(t)).count();
    let rows = [
        (
            "FAULT lit",
            lamps(|t| t.faults.len()),
            machines(|t| !t.faults.is_empty()),
        ),
        (
            "SENSOR lit",
            lamps(|t| t.sensors.len()),
            machines(|t| !t.sensors.is_empty()),
        ),
        ("alarm of FAULT", alarms(0), machines(|t| t.alarms[0] > 0)),
        ("alarm of SENSOR", alarms(1), machines(|t| t.alarms[1] > 0)),
    ];
    println!("| what | how often | machines | per 1000 motor-days | at most (95 %) |");
    println!("|---|---|---|---|---|");
    for (name, count, machines) in rows {
        let share = 1000.0 / days;
        println!(
            "| {name} | {count} | {machines} | {:.2} | {:.2} |",
            count as f64 * share,
            poisson_at_most(count) * share
        );
    }
}

fn by_doing(lived: &[&Tally], faults: &[&Lit]) {
    let mut events: BTreeMap<&str, u64> = BTreeMap::new();
    for event in Event::ALL {
        let count = lived.iter().filter_map(|t| t.events.get(&event)).sum();
        events.insert(event.name(), count);
    }
    let mut during: BTreeMap<&str, u64> = BTreeMap::new();
    for lit in faults {
        *during.entry(lit.doing.name()).or_default() += 1;
    }
    println!("\n| what happened | how often | FAULT came |");
    println!("|---|---|---|");
    for name in ["steady hours", "load ramp", "unbalance step"] {
        println!("| {name} | | {} |", during.get(name).unwrap_or(&0));
    }
    for (name, count) in events {
        println!("| {name} | {count} | {} |", during.get(name).unwrap_or(&0));
    }
}

fn by_cause(faults: &[&Lit]) {
    let mut causes: BTreeMap<&str, u64> = BTreeMap::new();
    for lit in faults {
        *causes.entry(&lit.cause).or_default() += 1;
    }
    if causes.is_empty() {
        return;
    }
    println!("\n| named cause | FAULT came |");
    println!("|---|---|");
    for (cause, count) in causes {
        println!("| {cause} | {count} |");
    }
}

/// How near steady windows come to FAULT.
fn departures(lived: &[&Tally]) {
    println!("\n| departure over the limit of FAULT | windows of steady hours |");
    println!("|---|---|");
    for tenth in 0..10 {
        let count: u64 = lived.iter().map(|t| t.departures[tenth]).sum();
        let to = if tenth == 9 { " and more" } else { "" };
        println!("| 0.{tenth}{to} | {count} |");
    }
}

fn listed(tallies: &[Tally]) {
    for tally in tallies {
        match &tally.refused {
            Some(why) => println!("\n{}: refused: {why}", tally.words),
            None => println!(
                "\n{}: FAULT {}, SENSOR {}, ran {:.2} days",
                tally.words,
                tally.faults.len(),
                tally.sensors.len(),
                tally.ran_days
            ),
        }
        let named = [("FAULT", &tally.faults), ("SENSOR", &tally.sensors)];
        for (lamp, lit) in named {
            for lit in lit.iter().take(8) {
                println!(
                    "  {lamp} {:10.1} s {:14} {:12} winding {:.0} cage {:.0} degC, {:.2} deviations, {:.3} s after its beginning: {}",
                    lit.t_s,
                    lit.doing.name(),
                    lit.cause,
                    lit.degc[0],
                    lit.degc[1],
                    lit.significance,
                    lit.since_s,
                    lit.window
                );
            }
        }
    }
}
