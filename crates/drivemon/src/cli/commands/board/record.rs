//! `drivemon board record`: what ended the program, and what the board doubts.

use std::path::PathBuf;

use board::modbus::Field;
use board::{Doubts, FaultCause, FaultRecord};
use clap::Args;
use live::Registers;
use program::Places;
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use super::line::LineArgs;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::JsonArgs;
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Tell what ended the board's program before its last start, and what the board doubts about itself.
///
/// The record lies in the chip's backup registers, which every reset but a power failure leaves. With the ELF file that was
/// flashed its addresses become functions, files and lines.
#[derive(Debug, Args)]
pub struct Record {
    #[command(flatten)]
    line: LineArgs,
    /// The ELF file that was flashed: target/thumbv7em-none-eabihf/release/drive-monitor
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    #[command(flatten)]
    json: JsonArgs,
}

/// What the last reset left behind.
#[derive(Debug, Serialize, JsonSchema)]
pub struct RecordJson {
    /// Bits of the processor's reset register.
    reset_cause: u16,
    /// Crashes without a quiet minute between them.
    crashes: u16,
    /// The crash before the last start; `null` where there was none.
    crash: Option<FaultRecord>,
    /// Function, file and line of the program counter, innermost first; needs the program (`--elf`).
    at: Vec<String>,
    /// The same of the link register.
    called_from: Vec<String>,
    /// File of a panic; needs the program (`--elf`).
    panicked_in: Option<String>,
    /// What the board doubts of itself.
    doubts: Vec<&'static str>,
    /// Most bytes of stack that were in use.
    stack_bytes: u16,
    /// Time since the start, s.
    uptime_s: u32,
}

impl Answer for RecordJson {
    const FORMAT: &'static str = "board-record/1";
}

impl Record {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        // A wrong file is told before the line is asked.
        let program = self.elf.as_deref().map(Places::read).transpose()?;
        let registers = Registers::read(&mut self.line.open()?)?;
        if let Some(program) = &program {
            check_seal(program, &registers)?;
        }
        let told = tell(&registers, program.as_ref());
        self.json.give(&told, || {
            print(&told, registers.doubts(), program.is_some())
        })?;
        let found = told.crash.is_some() || registers.doubts().is_any();
        Ok(match found {
            true => Finding::Something,
            false => Finding::Nothing,
        })
    }
}

/// Another program's lines would be wrong ones.
fn check_seal(program: &Places, registers: &Registers) -> Result<(), Failure> {
    let board = (
        registers.long(Field::ProgramLength),
        registers.long(Field::ProgramChecksum),
    );
    match program.seal() {
        Some(file) if file != board => Err(Failure::Usage(format!(
            "--elf: this file (checksum {:08x}) is not the program on the board ({:08x}); name the file that was flashed",
            file.1, board.1
        ))),
        _ => Ok(()),
    }
}

fn tell(registers: &Registers, program: Option<&Places>) -> RecordJson {
    let crash = registers.crash();
    let place = |address: fn(&FaultRecord) -> u32| match (program, &crash) {
        (Some(program), Some(crash)) if address(crash) != 0 => program.place(address(crash)),
        _ => Vec::new(),
    };
    let name = |crash: &FaultRecord| {
        let panicked = crash.cause == FaultCause::Panic;
        program
            .filter(|_| panicked)?
            .text(crash.address, crash.length)
    };
    RecordJson {
        reset_cause: registers.word(Field::ResetCause),
        crashes: registers.word(Field::Crashes),
        at: place(|crash| crash.pc),
        called_from: place(|crash| crash.lr),
        panicked_in: crash.as_ref().and_then(name),
        crash,
        doubts: registers.doubts().iter().map(board::Doubt::label).collect(),
        stack_bytes: registers.word(Field::Stack),
        uptime_s: registers.long(Field::Uptime),
    }
}

fn print(told: &RecordJson, doubts: Doubts, has_program: bool) {
    match &told.crash {
        None => say!("The last start followed no crash."),
        Some(crash) => print_crash(told, crash, has_program),
    }
    if told.crashes > 1 {
        say!(
            "{} crashes without a quiet minute between them",
            told.crashes
        );
    }
    say!("doubts     {}", live::doubts_in_words(doubts));
    say!("stack      {} byte at most", told.stack_bytes);
    say!("running    for {} s", told.uptime_s);
}

fn print_crash(told: &RecordJson, crash: &FaultRecord, has_program: bool) {
    let after = f64::from(crash.uptime_ms) / 1_000.0;
    say!("{} after {after:.1} s", paint::error(crash.cause.label()));
    match crash.cause {
        FaultCause::Watchdog => say!("missing    {}", live::missing_marks(crash.address)),
        FaultCause::Panic => {
            let file = told.panicked_in.clone();
            let file = file.unwrap_or_else(|| format!("file at {:#010x}", crash.address));
            say!("at         {file}:{}", crash.line);
        }
        _ => print_registers(told, crash),
    }
    if !has_program && crash.pc != 0 {
        say!("           --elf FILE says function, file and line");
    }
}

fn print_registers(told: &RecordJson, crash: &FaultRecord) {
    for (name, value, places) in [
        ("at", crash.pc, &told.at),
        ("called by", crash.lr, &told.called_from),
    ] {
        if value != 0 {
            say!(
                "{name:10} {value:#010x}  {}",
                places.join("\n                       ")
            );
        }
    }
    if crash.address != 0 {
        say!("address    {:#010x}", crash.address);
    }
    let faults = live::fault_status(crash.cfsr);
    if !faults.is_empty() {
        say!("because    {}", faults.join(", "));
    }
    if crash.sp != 0 {
        say!("stack at   {:#010x}", crash.sp);
    }
}
