//! What is wrong with a plan although every value of it is in its range.

use document::Section;
use monitor::{Monitor, MonitorConfig};

use crate::planned::axis::{Axis, Grid};
use crate::planned::fault::FaultKind;
use crate::planned::plan::{Block, LoadKnowledge, MotorPair, Plan};
use crate::runs::run::T_SAMPLE_S;
use scenario::Scenario;
use scenario::simulate::{Simulation, SimulationError};

/// A motor that the monitor or the simulation cannot take.
pub(crate) fn motor(section: &Section<'_>, pair: &MotorPair) {
    match MonitorConfig::from_motor_file(&pair.monitor, T_SAMPLE_S).map(Monitor::new) {
        Ok(Ok(_)) => {}
        Ok(Err(error)) => section.report(
            "file",
            format!("{error}: change the value in the motor file"),
        ),
        Err(error) => section.report("file", error.to_string()),
    }
    let scenario = Scenario::of(pair.plant.clone(), 1.0);
    if let Err(error @ SimulationError::Effect { .. }) = Simulation::new(&scenario) {
        section.report("plant", error.to_string());
    }
}

/// A block that contradicts itself.
pub(crate) fn block(section: &Section<'_>, block: &Block, motors: &[MotorPair]) {
    let steps = &block.grids[Axis::LoadStepTo as usize];
    let has_steps = !matches!(steps, Grid::Values(values) if values.iter().all(|x| x.is_nan()));
    if block.load == LoadKnowledge::Friction && has_steps {
        section.report(
            "load_step_to_percent",
            "is a fault where load_kind = \"friction\", which says that the load never changes: use \"Bl\", or \"free\"",
        );
    }
    if section.has("load_cycle_s") && !has_steps {
        section.report(
            "load_cycle_s",
            "goes between two loads: add load_step_to_percent",
        );
    }
    if block.cases.is_empty() && section.has("faulty_s") {
        section.report(
            "faulty_s",
            "there are no faults: remove it, or add [[blocks.faults]]",
        );
    }
    for case in &block.cases {
        let free = block.load == LoadKnowledge::Free;
        let mut motors = motors.iter();
        let obstacle = motors.find_map(|pair| case.kind.obstacle(&pair.plant, free));
        if let Some(obstacle) = obstacle {
            section.report("faults", format!("\"{}\" {obstacle}", case.kind.name));
        }
    }
    dry_runs(section, block, motors);
}

/// Sizes that the plant cannot take.
fn dry_runs(section: &Section<'_>, block: &Block, motors: &[MotorPair]) {
    for case in &block.cases {
        for pair in motors {
            let scenario = Scenario {
                faults: case.kind.faults(case.percent, 0, block.healthy_s),
                ..Scenario::of(pair.plant.clone(), block.duration_s())
            };
            if let Err(error @ SimulationError::Effect { .. }) = Simulation::new(&scenario) {
                section.report("faults", error.to_string());
            }
        }
    }
}

/// Sizes that change nothing or more than there is.
pub(crate) fn sizes(section: &Section<'_>, kind: &FaultKind, sizes: &[f64]) -> Option<()> {
    let complaint = if sizes.is_empty() {
        "gives no size: write a list in percent, [10.0, 20.0]"
    } else if sizes.contains(&0.0) {
        "has a 0, which changes nothing: leave it out"
    } else if sizes.contains(&-100.0) && !kind.is_sensor {
        "has a -100: only a sensor can be dead, a parameter stays above nothing"
    } else {
        return Some(());
    };
    section.report("change_percent", complaint);
    None
}

/// A campaign that would take too long.
pub(crate) fn runs(root: &Section<'_>, plan: &Plan, most: u64) {
    let per_block = plan.blocks.iter().map(|block| {
        let cells = block.grids.iter().map(Grid::len).map(|len| len as f64);
        let cells = if block.drawn { 1.0 } else { cells.product() };
        let cases = block.cases.len().max(1) as f64;
        block.repeats as f64 * plan.motors.len() as f64 * cases * cells
    });
    let runs: f64 = per_block.sum();
    if runs > most as f64 {
        let message = format!("are {runs:.0} runs, more than {most}: use draws, or fewer values");
        root.report("blocks", message);
    }
}
