//! Measures what the firmware costs on a running motor, and fails beyond the budget: `budget ELF MOTOR.toml`.
use monitor::{MonitorConfig, RawSample};
use motion::Companion;
use motor::MotorFile;
use scenario::Scenario;
use scenario::simulate::Simulation;
use virtual_board::{CORE_HZ, Inputs, TICK_HZ, Tally, VirtualBoard};

/// Bytes of flash.
const MOST_FLASH: f64 = 216.0 * 1024.0;
/// Bytes of RAM, stack included.
const MOST_RAM: f64 = 64.0 * 1024.0;
/// What depends on the motor.
struct Most {
    /// Instructions per sampling instant, everything included.
    per_sample: f64,
    /// Instructions of the longest window: residuals, lamps, frame.
    per_window: f64,
    /// Per cent of the core at one cycle per instruction.
    load: f64,
}

/// A motor that is judged at rest alone.
const AT_REST: Most = Most {
    per_sample: 800.0,
    per_window: 60_000.0,
    load: 12.5,
};
/// One that is judged in motion as well. A block must be read before the one after the next begins to overwrite it: its longest
/// window may take two blocks' time, 512 000 cycles, and takes two thirds of it at two cycles per instruction.
const IN_MOTION: Most = Most {
    per_sample: 2_300.0,
    per_window: 130_000.0,
    load: 29.0,
};
/// Cycles that an instruction may take on average.
const CYCLES: [f64; 3] = [1.0, 1.5, 2.0];
/// Bytes of stack.
const MOST_STACK: f64 = 15.0 * 1024.0;
/// Blocks of 32 instants that are measured: 2 s.
const BLOCKS: usize = 625;
const BLOCK_S: f64 = 0.0032;
const BLOCK_SAMPLES: u64 = 32;

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
                    ..RawSample::default()
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
    let motor = MotorFile::read(motor)?;
    let most = most_of(&motor)?;
    let scenario = Scenario::of(motor, 60.0);
    let motor = Motor(Simulation::new(&scenario)?, RawSample::default(), 0);
    let mut board = VirtualBoard::new(&std::fs::read(elf)?, Box::new(motor))?;
    board.run(2.5)?;
    align(&mut board)?;
    board.start_profile();
    let before = board.tally();
    let blocks = instructions_by_block(&mut board)?;
    let after = board.tally();
    show_profile(&mut board, after.conversions - before.conversions);
    let mut rows = vec![
        ("bytes of flash", f64::from(board.flash_used()), MOST_FLASH),
        ("bytes of RAM with the stack", ram(&mut board)?, MOST_RAM),
        (
            "bytes of them stack",
            f64::from(board.stack_used()?),
            MOST_STACK,
        ),
        (
            "instructions per sample",
            per_sample(before, after),
            most.per_sample,
        ),
        (
            "instructions of the longest window",
            longest_window(&blocks),
            most.per_window,
        ),
    ];
    for cycles in CYCLES {
        let what = match cycles {
            1.0 => "per cent of the core at 1 cycle per instruction",
            1.5 => "per cent of it at 1.5",
            _ => "per cent of it at 2",
        };
        rows.push((what, load(&mut board, cycles)?, cycles * most.load));
    }
    let end = board.tally();
    rows.push(("missed triggers", end.missed_triggers as f64, 0.0));
    rows.push(("resets", end.resets as f64, 0.0));
    let gaps = board
        .log()
        .iter()
        .filter(|line| line.contains("missing"))
        .count();
    rows.push(("gaps in the samples", gaps as f64, 0.0));
    for (what, value, most) in &rows {
        println!("{value:9.1} {what} (at most {most})");
    }
    let within = rows.iter().all(|(_, value, most)| value <= most);
    within
        .then_some(())
        .ok_or_else(|| "beyond the budget".into())
}

fn most_of(motor: &MotorFile) -> Result<Most, Box<dyn std::error::Error>> {
    let companion = Companion::new(&MonitorConfig::of_board(motor)?);
    Ok(match companion.not_possible() {
        Some(_) => AT_REST,
        None => IN_MOTION,
    })
}

/// Runs on to the last instant of a block: what follows a block is then in one piece as long as it takes less than a block's time.
fn align(board: &mut VirtualBoard) -> Result<(), Box<dyn std::error::Error>> {
    while !(board.tally().conversions + 1).is_multiple_of(BLOCK_SAMPLES) {
        board.run(1e-5)?;
    }
    Ok(())
}

fn instructions_by_block(board: &mut VirtualBoard) -> Result<Vec<f64>, Box<dyn std::error::Error>> {
    let mut blocks = Vec::new();
    for _ in 0..BLOCKS {
        let before = board.tally().instructions;
        board.run(BLOCK_S)?;
        blocks.push((board.tally().instructions - before) as f64);
    }
    Ok(blocks)
}

/// Most blocks end no window; what the longest one takes beyond the ordinary one is its window's.
fn longest_window(blocks: &[f64]) -> f64 {
    let mut sorted = blocks.to_vec();
    sorted.sort_by(f64::total_cmp);
    let ordinary = sorted[sorted.len() / 2];
    sorted.last().map_or(0.0, |longest| longest - ordinary)
}

fn show_profile(board: &mut VirtualBoard, samples: u64) {
    println!("instructions per sample by function:");
    for (name, count) in board.profile().into_iter().take(12) {
        println!("{:9.1} {name}", count as f64 / samples as f64);
    }
}

fn ram(board: &mut VirtualBoard) -> Result<f64, Box<dyn std::error::Error>> {
    let symbol = |name: &str| board.symbol(name).ok_or(format!("no symbol {name}"));
    let fixed = symbol("__euninit")? - symbol("__sdata")?;
    Ok(f64::from(fixed + board.stack_used()?))
}

fn per_sample(before: Tally, after: Tally) -> f64 {
    let samples = after.conversions - before.conversions;
    (after.instructions - before.instructions) as f64 / samples as f64
}

/// Per cent of the core's cycles over two seconds in which an instruction takes so many of them.
fn load(board: &mut VirtualBoard, cycles: f64) -> Result<f64, Box<dyn std::error::Error>> {
    board.set_cycles_per_instruction(cycles);
    let before = board.tally();
    board.run(2.0)?;
    let after = board.tally();
    let seconds = (after.ticks - before.ticks) as f64 / TICK_HZ as f64;
    let instructions = (after.instructions - before.instructions) as f64;
    Ok(100.0 * cycles * instructions / seconds / CORE_HZ as f64)
}
