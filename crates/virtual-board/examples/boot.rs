//! Boots the firmware on a running motor and prints log, lamps and counters: a first look at a new build.
//! `boot ELF MOTOR.toml [SECONDS]`
use monitor::RawSample;
use motor::MotorFile;
use scenario::Scenario;
use scenario::simulate::Simulation;
use virtual_board::{Inputs, LAMPS, VirtualBoard};

struct Motor(Simulation);

impl Inputs for Motor {
    fn at(&mut self, _: u64) -> RawSample {
        self.0
            .next()
            .map_or(RawSample::default(), |sample| RawSample {
                voltage_codes: sample.measured.voltage_codes,
                current_codes: sample.measured.current_codes,
                encoder_count: sample.measured.encoder_count,
                ..RawSample::default()
            })
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [elf, motor, rest @ ..] = &arguments[..] else {
        return Err("usage: boot ELF MOTOR.toml [SECONDS]".into());
    };
    let seconds: f64 = rest.first().map_or(Ok(3.0), |text| text.parse())?;
    let scenario = Scenario::of(MotorFile::read(motor)?, seconds + 1.0);
    let motor = Motor(Simulation::new(&scenario)?);
    let mut board = VirtualBoard::new(&std::fs::read(elf)?, Box::new(motor))?;
    for tenth in 1..=(10.0 * seconds) as u32 {
        board.run(0.1)?;
        let lit = LAMPS.iter().filter(|(name, _)| board.lamp(name));
        let lit: Vec<&str> = lit.map(|(name, _)| *name).collect();
        println!("{:5.1} s {lit:?}", f64::from(tenth) / 10.0);
        board
            .log()
            .iter()
            .for_each(|line| println!("        {line}"));
    }
    println!("{:?}", board.tally());
    Ok(())
}
