//! How small a fault can be told at all: the Cramer-Rao bound of each row of docs/detection.md, beside what was found.
//!
//! `cargo run --release -p studies --example bounds` reads `campaigns/detection.toml` for motors and conditions and
//! `docs/detection.md` for the smallest sizes, and prints one table for each motor and block.

mod bound;
mod found;
mod plant;

use campaign::{Place, Plan, Run};
use rayon::prelude::*;

use bound::Bound;
use found::Found;
use plant::{Plant, Unknown};

/// Standard deviations of a size that 99 of 100 runs exceed: quantile of the normal distribution.
const NINETY_NINE: f64 = 2.326;
/// Draws of the conditions; a block has 60 to 300 of them.
const DRAWS: u64 = 60;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let plan = Plan::read(format!("{root}/campaigns/detection.toml"))?;
    let page = std::fs::read_to_string(format!("{root}/docs/detection.md"))?;
    for section in found::sections(&page) {
        let rows: Vec<String> = section
            .rows
            .iter()
            .filter_map(|row| line(&plan, &section.title, row))
            .collect();
        if rows.is_empty() {
            continue;
        }
        println!("\n### {}\n", section.title);
        println!(
            "| fault | smallest found | bound: noise alone | bound: with what a calibration leaves open | found over bound | what opens it most |"
        );
        println!("|---|---|---|---|---|---|");
        rows.iter().for_each(|row| println!("{row}"));
    }
    Ok(())
}

/// A row of the table; `None` for a fault that the steady circuit does not hold.
fn line(plan: &Plan, title: &str, found: &Found) -> Option<String> {
    let bounds: Vec<Bound> = runs_of(plan, title, &found.fault)
        .par_iter()
        .map(|run| bound::of(&Plant::of(run)?, Unknown::of_fault(&found.fault)?))
        .collect::<Option<_>>()?;
    let [noise, open] = [false, true].map(|open| smallest(&bounds, open));
    let ratio = found.smallest_percent.map_or("-".into(), |smallest| {
        let [below, found] =
            [tried_below(plan, title, found, smallest), smallest].map(|size| size.abs() / open);
        format!("{below:.1} to {found:.1}")
    });
    let (fault, told) = (&found.fault, &found.told);
    let most = bounds.first().map_or("", |bound| bound.most);
    Some(format!(
        "| `{fault}` | {told} | {noise:.2} % | {open:.1} % | {ratio} | {most} |"
    ))
}

/// As docs/detection.md heads its tables.
fn title_of(place: &Place<'_>) -> String {
    format!("{}, {}", place.motor.name, place.block.name)
}

/// Runs of the fault's first size: their conditions are those of every size.
fn runs_of<'p>(plan: &'p Plan, title: &str, fault: &str) -> Vec<Run<'p>> {
    let all = (0..plan.runs()).filter_map(|index| Run::new(plan, index));
    let wanted = all.filter(|run| {
        let place = &run.place;
        title_of(place) == title && place.case.is_some_and(|case| case.kind.name == fault)
    });
    wanted.take(DRAWS as usize).collect()
}

/// The next smaller size of the same sign that was tried, percent; 0 where nothing smaller was.
fn tried_below(plan: &Plan, title: &str, found: &Found, smallest: f64) -> f64 {
    let all = (0..plan.runs()).filter_map(|index| plan.place(index));
    let tried = all.filter(|place| title_of(place) == title);
    let cases = tried
        .filter_map(|place| place.case)
        .filter(|case| case.kind.name == found.fault);
    let sizes = cases
        .map(|case| case.percent)
        .filter(|size| size * smallest > 0.0 && size.abs() < smallest.abs());
    sizes.fold(
        0.0,
        |best: f64, size| if size.abs() > best.abs() { size } else { best },
    )
}

/// Size, percent, that is beyond the motor's limit in 99 of 100 runs, by bisection over the mean of the draws.
fn smallest(bounds: &[Bound], open: bool) -> f64 {
    let share = |percent: f64| {
        let above = |bound: &Bound| {
            let sigma = 100.0 * if open { bound.with_open } else { bound.noise };
            bound::normal_cdf(percent / sigma - bound.significance)
        };
        bounds.iter().map(above).sum::<f64>() / bounds.len() as f64
    };
    let wanted = bound::normal_cdf(NINETY_NINE);
    let (mut low, mut high) = (0.0, 1e5);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        match share(middle) < wanted {
            true => low = middle,
            false => high = middle,
        }
    }
    high
}
