//! Healthy transients: FAULT must stay dark in motion. What windows at rest say is not counted: parameters are farther off here than the
//! motor files say; the study `beyond_calibration` counts it.

use rayon::prelude::*;

use crate::judge::{Outcome, judge};
use crate::{MOTORS, motor};
use studies::drive::{DRIVES, Doubts, Drive, run};

/// What all draws of one motor and drive came to.
#[derive(Default)]
struct Cell {
    runs: usize,
    alarms: usize,
    largest: f32,
    cycles: u32,
    judged: u32,
}

impl Cell {
    fn add(&mut self, outcome: &Outcome) {
        self.runs += 1;
        self.alarms += usize::from(outcome.alarm_s.is_some());
        self.largest = self.largest.max(outcome.largest);
        self.cycles += outcome.cycles;
        self.judged += outcome.judged;
    }

    fn merge(&mut self, other: &Cell) {
        self.runs += other.runs;
        self.alarms += other.alarms;
        self.largest = self.largest.max(other.largest);
        self.cycles += other.cycles;
        self.judged += other.judged;
    }
}

fn cell(name: &str, drive: Drive, doubts: &Doubts, draws: u64) -> Cell {
    let believed = motor(name);
    let outcomes: Vec<Outcome> = (0..draws)
        .into_par_iter()
        .filter_map(|k| {
            let seed = 1_000_000 * drive as u64 + k;
            let run = run(&believed, drive, doubts, None, seed);
            judge(&believed, &run, doubts, false).ok()
        })
        .collect();
    let mut cell = Cell::default();
    for outcome in &outcomes {
        cell.add(outcome);
    }
    cell
}

/// One row a drive, one column a motor: alarms of runs, largest T, share judged.
pub fn table(draws: u64, doubts: &Doubts) {
    println!("| transient | {} |", MOTORS.join(" | "));
    println!("|---|{}", "---|".repeat(MOTORS.len()));
    let mut all = Cell::default();
    for drive in DRIVES {
        let cells = MOTORS.map(|name| cell(name, drive, doubts, draws));
        for cell in &cells {
            all.merge(cell);
        }
        let shown = cells.map(|cell| {
            let judged = 100.0 * f64::from(cell.judged) / f64::from(cell.cycles.max(1));
            format!(
                "{} of {}, {:.1}, {judged:.0} %",
                cell.alarms, cell.runs, cell.largest
            )
        });
        println!("| {} | {} |", drive.name(), shown.join(" | "));
    }
    let judged = 100.0 * f64::from(all.judged) / f64::from(all.cycles.max(1));
    println!(
        "\n{} of {} runs with an alarm; largest T in two cycles running {:.1}; {judged:.0} % of {} cycles judged",
        all.alarms, all.runs, all.largest, all.cycles
    );
}

/// What may be off beyond parameters, gains and friction as a calibration leaves them.
fn open_points() -> [(&'static str, Doubts); 8] {
    let usual = Doubts::USUAL;
    let wrong = 2.0;
    let warm_k = 100.0;
    let undeclared_iron = 0.15;
    let offset = 0.005;
    let late_s = 5e-6;
    let backwards = true;
    let noise = 0.005;
    [
        ("nothing more", usual),
        ("parameters twice as far off", Doubts { wrong, ..usual }),
        (
            "windings 20 K colder to 100 K warmer",
            Doubts { warm_k, ..usual },
        ),
        (
            "saturating iron (0.15), not declared",
            Doubts {
                undeclared_iron,
                ..usual
            },
        ),
        (
            "current a off by 0.5 % of full scale",
            Doubts { offset, ..usual },
        ),
        ("currents 5 us late", Doubts { late_s, ..usual }),
        ("backwards", Doubts { backwards, ..usual }),
        ("noise 0.5 % of full scale", Doubts { noise, ..usual }),
    ]
}

/// The same with what was left open: alarms of runs and the largest T over all drives.
pub fn doubts(draws: u64) {
    println!("| what is off | {} |", MOTORS.join(" | "));
    println!("|---|{}", "---|".repeat(MOTORS.len()));
    for (label, doubts) in open_points() {
        let cells = MOTORS.map(|name| {
            let mut all = Cell::default();
            for drive in DRIVES {
                all.merge(&cell(name, drive, &doubts, draws));
            }
            format!("{} of {}, {:.1}", all.alarms, all.runs, all.largest)
        });
        println!("| {label} | {} |", cells.join(" | "));
    }
}
