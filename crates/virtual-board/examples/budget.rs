//! Measures what the firmware costs on a running motor, and fails beyond the budget: `budget ELF`.
use monitor::RawSample;
use motor::MotorFile;
use sim_host::scenario::Scenario;
use sim_host::simulate::Simulation;
use virtual_board::{CORE_HZ, Inputs, VirtualBoard};

/// Instructions per sampling instant, everything included. 715 were measured; the design aims at 400, so this bound only
/// keeps what is reached.
const MOST_PER_SAMPLE: f64 = 730.0;
/// Share of the core's cycles.
const MOST_CPU: f64 = 0.05;
/// Bytes of RAM, stack included.
const MOST_RAM: u32 = 24 * 1024;
const SECONDS: f64 = 2.0;

struct Motor(Simulation, RawSample, u64);

impl Inputs for Motor {
    fn at(&mut self, index: u64) -> RawSample {
        while self.2 <= index {
            self.2 += 1;
            if let Some(sample) = self.0.next() {
                self.1 = RawSample {
                    voltage_codes: sample.measured.voltage_codes,
                    current_codes: sample.measured.current_codes,
                    encoder_count: sample.measured.encoder_count,
                };
            }
        }
        self.1
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(elf), Some(motor)) = (arguments.next(), arguments.next()) else {
        return Err("usage: budget ELF MOTOR.toml".into());
    };
    let scenario = Scenario::of(MotorFile::read(motor)?, 60.0);
    let motor = Motor(Simulation::new(&scenario)?, RawSample::default(), 0);
    let mut board = VirtualBoard::new(&std::fs::read(elf)?, Box::new(motor))?;
    board.run(2.5)?;
    board.start_profile();
    let before = board.tally();
    board.run(SECONDS)?;
    let after = board.tally();
    let instructions = (after.instructions - before.instructions) as f64;
    let samples = (after.conversions - before.conversions) as f64;
    for (name, count) in board.profile().into_iter().take(16) {
        println!("{:8.1} {name}", count as f64 / samples);
    }
    let per_sample = instructions / samples;
    let cpu = instructions / SECONDS / CORE_HZ as f64;
    let stack = board.stack_used()?;
    println!("{per_sample:.0} instructions per sample (at most {MOST_PER_SAMPLE})");
    println!(
        "{:.2} % of the core at one instruction per cycle (at most {} %)",
        100.0 * cpu,
        100.0 * MOST_CPU
    );
    println!("{stack} bytes of stack at most");
    let static_ram = board.symbol("__ebss").map_or(0, |end| end - 0x2000_0000);
    println!(
        "{} bytes of RAM with the stack (at most {MOST_RAM})",
        static_ram + stack
    );
    println!(
        "{} missed triggers, {} resets",
        after.missed_triggers, after.resets
    );
    let within = per_sample <= MOST_PER_SAMPLE && cpu <= MOST_CPU && static_ram + stack <= MOST_RAM;
    if within {
        Ok(())
    } else {
        Err("beyond the budget".into())
    }
}
