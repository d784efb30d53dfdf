//! The whole board: power, time, lamps, button, wires, and what can be read of it.

mod faults;

use monitor::RawSample;
use update::layout::PROGRAM;

use crate::TICK_HZ;
use crate::error::BoardError;
use crate::firmware::elf::Firmware;
use crate::firmware::loader;
use crate::firmware::log::Log;
use crate::machine::{Inputs, Machine, Port, Tally};
use crate::peripherals::gpio::Pin;
use crate::peripherals::rcc::Cause;
use crate::peripherals::usart::{Quality, Sent};
use crate::processor::cpu::{Cpu, FLASH, FLASH_SIZE, RAM, RAM_SIZE};

/// Lamps in the order run, r1..r4, sensor, line, load, fault; the table of docs/wiring.md.
pub const LAMPS: [(&str, Pin); 9] = [
    ("run", Pin(2, 8)),
    ("r1", Pin(1, 11)),
    ("r2", Pin(1, 12)),
    ("r3", Pin(1, 13)),
    ("r4", Pin(1, 14)),
    ("sensor", Pin(1, 15)),
    ("line", Pin(2, 9)),
    ("load", Pin(2, 4)),
    ("fault", Pin(2, 5)),
];
/// What the program fills its stack with before it uses it.
const PAINT: u32 = 0xCCCC_CCCC;
const BUTTON: Pin = Pin(2, 13);

/// The state of a board at one moment.
pub struct Snapshot {
    machine: Machine,
    registers: unicorn_engine::Context,
    ram: Vec<u8>,
    flash: Vec<u8>,
}

/// A board with power on.
pub struct VirtualBoard {
    cpu: Cpu,
    firmware: Firmware,
    log: Log,
}

impl VirtualBoard {
    /// Flashes the loader and the program `elf` and applies power. The loader is the file that `DRIVE_MONITOR_LOADER` names, or
    /// `loader` beside the program of `DRIVE_MONITOR_ELF`, or what `tools/thumb` built last.
    ///
    /// # Errors
    /// A file that is no firmware for this chip; no loader.
    pub fn new(elf: &[u8], inputs: Box<dyn Inputs>) -> Result<Self, BoardError> {
        let firmware = Firmware::parse(elf)?;
        let loader = Firmware::parse(&loader::read()?)?;
        let mut cpu = Cpu::new(Machine::new(inputs))?;
        for (address, bytes) in loader.segments.iter().chain(&firmware.segments) {
            cpu.core.mem_write(u64::from(*address), bytes)?;
        }
        cpu.reset()?;
        let log = Log::parse(elf)?;
        Ok(VirtualBoard { cpu, firmware, log })
    }

    /// Runs for `seconds` of emulated time.
    ///
    /// # Errors
    /// The program touched something that is not modelled, or crashed.
    pub fn run(&mut self, seconds: f64) -> Result<(), BoardError> {
        let end = self.cpu.machine().now + (seconds * TICK_HZ as f64) as u64;
        self.cpu.machine().until = end;
        while self.cpu.machine().now < end {
            self.step()?;
        }
        self.cpu.machine().until = u64::MAX;
        self.catch_up();
        Ok(())
    }

    fn step(&mut self) -> Result<(), BoardError> {
        self.cpu.happen()?;
        let machine = self.cpu.machine();
        machine.tally.ticks = machine.now;
        if machine.iwdg.deadline().is_some_and(|at| at <= machine.now) {
            return self.reset(Cause::Watchdog);
        }
        if machine.nvic.reset_requested {
            return self.reset(Cause::Software);
        }
        if machine.flash.launches {
            return self.reset(Cause::OptionBytes);
        }
        if machine.flash.has_failed {
            let cause = machine.flash_failure;
            return self.reset(cause);
        }
        machine.next_event = machine.horizon();
        self.cpu.enter_exception()?;
        self.cpu.run()
    }

    /// Resets the chip; memory keeps its content, the flash too.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn reset(&mut self, cause: Cause) -> Result<(), BoardError> {
        self.cpu.machine().reset(cause);
        self.cpu.guard_flash()?;
        self.cpu.reset()
    }

    /// Resets the chip for `cause` within a step of flash (a word programmed, two of a double word; a page erased), after
    /// `steps` whole ones.
    pub fn reset_within_flash_step(&mut self, steps: u32, cause: Cause) {
        let machine = self.cpu.machine();
        machine.flash_failure = cause;
        machine.flash.fail_after(steps);
    }

    /// Whether the lamp's wire is driven high now. Unknown names are dark.
    pub fn lamp(&mut self, name: &str) -> bool {
        let wire = LAMPS.iter().find(|(lamp, _)| *lamp == name);
        wire.is_some_and(|(_, pin)| self.level(*pin))
    }

    /// All lamps in the order of the table.
    pub fn lamps(&mut self) -> [bool; 9] {
        LAMPS.map(|(_, pin)| self.level(pin))
    }

    fn level(&mut self, Pin(port, number): Pin) -> bool {
        self.cpu.machine().ports[port].shown(number)
    }

    /// Presses or releases the button.
    pub fn press(&mut self, pressed: bool) {
        let Pin(port, number) = BUTTON;
        self.cpu.machine().ports[port].apply(number, pressed);
    }

    /// Acquisition up to now, before the outside world changes.
    fn catch_up(&mut self) {
        let machine = self.cpu.machine();
        if let Err(unmodelled) = machine.catch_up() {
            machine.failure = Some(unmodelled.to_string());
        }
    }

    /// Whether the relay is energised.
    pub fn relay(&mut self) -> bool {
        let machine = self.cpu.machine();
        machine.relay.is_energised(machine.now)
    }

    /// Cycles that an instruction takes on average, to halves: wait states, loads, branches, divisions.
    pub fn set_cycles_per_instruction(&mut self, cycles: f64) {
        self.cpu.machine().half_cycles = (2.0 * cycles) as u64;
    }

    /// Puts option bytes in place as a programmer does; power comes anew.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn set_options(&mut self, options: u32) -> Result<(), BoardError> {
        self.cpu.machine().flash.set_options(options);
        self.reset(Cause::Power)
    }

    /// Option bytes in the array.
    pub fn options(&mut self) -> u32 {
        self.cpu.machine().flash.options()
    }

    /// Faults of the processor since power-up: status register and program counter of each.
    pub fn processor_faults(&mut self) -> &[(u32, u32)] {
        &self.cpu.machine().faults
    }

    /// The words of the backup domain.
    pub fn backup_words(&mut self) -> [u32; 32] {
        self.cpu.machine().backup.words()
    }

    /// Word of the RAM or the flash at `address`.
    ///
    /// # Errors
    /// An address outside of both.
    pub fn word(&mut self, address: u32) -> Result<u32, BoardError> {
        self.cpu.word(address)
    }

    /// Keeps the state of the whole board. Inputs are shared: asked for an earlier instant again, they must answer alike.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn snapshot(&mut self) -> Result<Snapshot, BoardError> {
        Ok(Snapshot {
            machine: self.cpu.machine().clone(),
            registers: self.cpu.core.context_init()?,
            ram: self
                .cpu
                .core
                .mem_read_as_vec(u64::from(RAM), RAM_SIZE as usize)?,
            flash: self.read_flash(FLASH, FLASH_SIZE as usize)?,
        })
    }

    /// Goes back to a snapshot of this board.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), BoardError> {
        *self.cpu.machine() = snapshot.machine.clone();
        self.cpu.core.context_restore(&snapshot.registers)?;
        self.cpu.forget_sleep();
        self.cpu.core.mem_write(u64::from(RAM), &snapshot.ram)?;
        self.cpu.core.mem_write(u64::from(FLASH), &snapshot.flash)?;
        self.cpu.guard_flash()
    }

    /// Writes to flash as a programmer does, before power-up or a reset.
    ///
    /// # Errors
    /// Addresses outside flash.
    pub fn flash(&mut self, address: u32, bytes: &[u8]) -> Result<(), BoardError> {
        Ok(self.cpu.core.mem_write(u64::from(address), bytes)?)
    }

    /// Content of flash from `address` on.
    ///
    /// # Errors
    /// Addresses outside flash.
    pub fn read_flash(&mut self, address: u32, length: usize) -> Result<Vec<u8>, BoardError> {
        Ok(self.cpu.core.mem_read_as_vec(u64::from(address), length)?)
    }

    /// Names of all symbols that contain `part`, with their addresses.
    pub fn symbols(&self, part: &str) -> Vec<(String, u32)> {
        self.firmware.symbols(part)
    }

    /// Address of the symbol whose name contains `part`.
    pub fn symbol(&self, part: &str) -> Option<u32> {
        self.firmware.symbol(part)
    }

    /// Bytes of flash that the program takes.
    pub fn flash_used(&self) -> u32 {
        let bytes = |(_, bytes): &(u32, Vec<u8>)| bytes.len() as u32;
        self.firmware.segments.iter().map(bytes).sum()
    }

    /// Counters.
    pub fn tally(&mut self) -> Tally {
        self.cpu.machine().tally
    }

    /// Every sample that the firmware's converter made, in order, sixteen codes added up; none after [`VirtualBoard::forget_taken`].
    pub fn taken(&mut self) -> &[RawSample] {
        self.cpu.machine().taken.as_deref().unwrap_or_default()
    }

    /// Takes the samples that were made since the last call.
    pub fn drain_taken(&mut self) -> Vec<RawSample> {
        let taken = self.cpu.machine().taken.as_mut();
        taken.map(std::mem::take).unwrap_or_default()
    }

    /// Keeps no samples from here on: an hour of them is half a gigabyte.
    pub fn forget_taken(&mut self) {
        self.cpu.machine().taken = None;
    }

    /// Takes the lines that the firmware logged since the last call; what was not taken in time is dropped on the board.
    pub fn log(&mut self) -> Vec<String> {
        self.read_log();
        self.log.lines()
    }

    /// Takes the frames that the firmware wrote into its log since the last call.
    pub fn frames(&mut self) -> Vec<u8> {
        self.read_log();
        self.log.frames()
    }

    /// Reads the debugger's channel, as a debugger does.
    fn read_log(&mut self) {
        let bytes = crate::firmware::rtt::drain(&mut self.cpu, 0);
        self.log.take(&bytes.unwrap_or_default());
    }

    /// Bytes of stack that the program used at most since power-up: from its beginning, its vector table's first word, down to the deepest
    /// word that was written. It ends where the program's variables end.
    ///
    /// # Errors
    /// A program without the symbol `_stack_end`, or the emulator refuses.
    pub fn stack_used(&mut self) -> Result<u32, BoardError> {
        let no_symbol = || BoardError::Elf("no symbol _stack_end".into());
        let end = self.symbol("_stack_end").ok_or_else(no_symbol)?;
        let length = self.cpu.word(FLASH + PROGRAM)? - end;
        let stack = self
            .cpu
            .core
            .mem_read_as_vec(u64::from(end), length as usize)?;
        let (words, _) = stack.as_chunks::<4>();
        let untouched = words
            .iter()
            .take_while(|word| u32::from_le_bytes(**word) == PAINT);
        Ok(length - 4 * untouched.count() as u32)
    }

    /// Sets the temperature of the chip, degrees Celsius.
    pub fn set_temperature(&mut self, degc: f64) {
        self.cpu.machine().temperature_degc = degc;
    }

    /// Puts bytes on the wire towards a port, from now on and at the speed that it is set to.
    pub fn deliver(&mut self, port: Port, bytes: &[(u8, Quality)]) {
        let machine = self.cpu.machine();
        let now = machine.now;
        machine.port(port).deliver(now, bytes);
    }

    /// Sets the speed of the other end of a port's wire, bit/s; without it that end follows the port.
    pub fn set_peer_speed(&mut self, port: Port, baud: u32) {
        self.cpu.machine().port(port).peer_bit = Some(TICK_HZ / u64::from(baud.max(1)));
    }

    /// Takes what the program has sent over a port.
    pub fn take_sent(&mut self, port: Port) -> Vec<Sent> {
        std::mem::take(&mut self.cpu.machine().port(port).sent)
    }

    /// Counts instructions by function from here on.
    pub fn start_profile(&mut self) {
        self.cpu.machine().profile = Some(std::collections::HashMap::new());
    }

    /// Instructions by function since [`VirtualBoard::start_profile`], most first; function names are mangled.
    pub fn profile(&mut self) -> Vec<(String, u64)> {
        let blocks = self.cpu.machine().profile.take().unwrap_or_default();
        self.firmware.by_function(blocks)
    }
}
