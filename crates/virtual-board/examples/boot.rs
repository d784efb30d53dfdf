//! Boots the firmware on silence and prints lamps and counters; a first look at a new build.
use monitor::RawSample;
use virtual_board::{Inputs, VirtualBoard};

struct Silence;

impl Inputs for Silence {
    fn at(&mut self, _: u64) -> RawSample {
        RawSample {
            voltage_codes: [2048; 3],
            current_codes: [2048; 3],
            encoder_count: 0,
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: boot ELF")?;
    let mut board = VirtualBoard::new(&std::fs::read(path)?, Box::new(Silence))?;
    for tenth in 1..=30 {
        board.run(0.1)?;
        println!(
            "{:.1} s {:?} {:?}",
            f64::from(tenth) / 10.0,
            board.lamps(),
            board.tally()
        );
    }
    Ok(())
}
