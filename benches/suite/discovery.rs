//! What `drivemon explain` costs on one core, stage by stage, beside the simulations that it makes: an effect of the library in one
//! recording, and a law that the library does not hold in two.
//!
//! The peer is the simulator of `drivemon simulate` on the same recording, sensors included, as often: a ratio below 1 says
//! that a stage takes less than its simulations would take there.

use benches::interleaved::shortest;
use discovery::{explain, simulations};
use motor::MotorFile;
use recording::{Recording, Source};
use scenario::simulate;
use scenario::{Piecewise, Scenario, Start};
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

/// Length of the recording, s; 10 kHz.
const SECONDS: f64 = 5.0;

fn motor(name: &str) -> MotorFile {
    let folder = Path::new(benches::FOLDER).join("../motors");
    MotorFile::read(folder.join(name)).expect("shipped")
}

/// A start, a load step and a dip of the voltage of a motor whose iron saturates.
fn recorded() -> Recording {
    let mut scenario = Scenario::of(motor("peer-2k2-saturating.toml"), SECONDS);
    scenario.start = Start::Standstill;
    scenario.seed = 7;
    let rated = scenario.motor.nameplate.phase_voltage_amplitude();
    let mut voltage = Piecewise::constant(rated);
    voltage.change(3.5, 0.8 * rated, 0.0);
    scenario.supply.amplitude_volt = voltage;
    simulate::record(&scenario, |_| ()).expect("a valid scenario")
}

/// A compressor whose torque changes twice a turn, at two loads: the library has no such effect.
fn compressor(seed: u64, loads: [f64; 2]) -> Recording {
    let text = format!(
        "motor = \"motors/peer-2k2.toml\"\nduration_s = {SECONDS}\nseed = {seed}\n\
         [load]\nprofile = [{{ at_s = 1.0, torque_percent = {:?} }}, {{ at_s = 3.0, torque_percent = {:?} }}]\n\
         [sensors]\ntorque = true\nnoise_sigma_fraction_of_full_scale = 0.002\n\
         [[effects]]\nname = \"expression\"\nadds_to = \"torque\"\n\
         formula = \"cos_nm * cos(2 * theta) + sin_nm * sin(2 * theta)\"\ncos_nm = 6.0\nsin_nm = -3.0\n",
        loads[0], loads[1]
    );
    let folder = Path::new(benches::FOLDER).join("..");
    let scenario = Scenario::parse(&text, "compressor.toml", &folder).expect("a scenario");
    simulate::record(&scenario, |_| ()).expect("a valid scenario")
}

/// A stage, when it began, and the simulations made by then.
struct Mark {
    stage: String,
    at: Instant,
    simulations: u64,
}

fn mark(stage: &str) -> Mark {
    Mark {
        stage: stage.to_owned(),
        at: Instant::now(),
        simulations: simulations(),
    }
}

fn print(what: &str, marks: &[Mark], alone: f64) {
    println!("explain, one core, {what}, {SECONDS} s at 10 kHz each");
    println!("  stage                                     s  simulations   ratio");
    let row = |stage: &str, from: &Mark, to: &Mark| {
        let seconds = (to.at - from.at).as_secs_f64();
        let count = to.simulations - from.simulations;
        let ratio = match count {
            0 => "-".to_owned(),
            _ => format!("{:.2}", seconds / (count as f64 * alone)),
        };
        println!("  {stage:<37} {seconds:>5.2} {count:>12} {ratio:>7}");
    };
    for pair in marks.windows(2) {
        row(&pair[0].stage, &pair[0], &pair[1]);
    }
    if let (Some(first), Some(last)) = (marks.first(), marks.last()) {
        row("altogether", first, last);
    }
}

/// Asks on one core and prints the stages.
fn explained(what: &str, recordings: Vec<Recording>, alone: f64) {
    let believed = motor("peer-2k2.toml");
    let sources: Vec<Source> = recordings.into_iter().map(Source::Recording).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    let mut marks = Vec::new();
    let report = pool.install(|| {
        explain(&sources, &believed, &mut |stage, _| {
            marks.push(mark(stage));
        })
    });
    let report = report.expect("recordings that are supported");
    print(what, &marks, alone);
    println!("{}\n", report.summary);
}

fn main() {
    let scenario = Scenario::of(motor("peer-2k2-saturating.toml"), SECONDS);
    let plant_alone = || {
        let simulation = simulate::Simulation::new(&scenario).expect("a valid scenario");
        black_box(
            simulation
                .map(|sample| sample.truth.omega_mech)
                .sum::<f64>(),
        );
    };
    let alone = shortest(5, plant_alone);
    println!("drivemon simulate, in memory: {alone:.3} s for one recording\n");
    explained("one recording", vec![recorded()], alone);
    let pair = vec![compressor(1, [80.0, 40.0]), compressor(2, [60.0, 100.0])];
    explained("a law in two recordings", pair, alone);
}
