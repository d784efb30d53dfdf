//! The whole board: power, time, lamps, button, and faults of the board itself.

use monitor::RawSample;
use update::layout::PROGRAM;

use crate::TICK_HZ;
use crate::error::BoardError;
use crate::firmware::elf::Firmware;
use crate::firmware::loader;
use crate::firmware::log::Log;
use crate::machine::relay::Contact;
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

    /// Stops or restarts the clock of the sampling converter.
    pub fn stop_converter_clock(&mut self, stopped: bool) {
        self.catch_up();
        self.cpu.machine().adc1.clock_stopped = stopped;
    }

    /// Whether the relay is energised.
    pub fn relay(&mut self) -> bool {
        let machine = self.cpu.machine();
        machine.relay.is_energised(machine.now)
    }

    /// Lets the relay's contact behave so.
    pub fn set_contact(&mut self, contact: Contact) {
        self.cpu.machine().relay.contact = contact;
    }

    /// Shorts a wire to a level, or takes the short away.
    pub fn short(&mut self, Pin(port, number): Pin, to: Option<bool>) {
        self.cpu.machine().ports[port].short(number, to);
    }

    /// The crystal oscillates from now on, or is dead.
    pub fn set_crystal(&mut self, oscillates: bool) {
        self.catch_up();
        let machine = self.cpu.machine();
        machine.rcc.set_crystal(oscillates, machine.now);
        machine.change_clocks();
    }

    /// Sets the low-speed oscillator, Hz; 29 500 to 34 000 within the chip's temperatures.
    pub fn set_low_speed_oscillator(&mut self, hz: u64) {
        self.cpu.machine().lsi_hz = hz;
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

    /// Two wrong bits in the double word of flash at `address` are found, as its reading or fetching does.
    pub fn detect_flash_error(&mut self, address: u32) {
        let machine = self.cpu.machine();
        machine.flash.detect(address);
        machine.next_event = machine.now;
    }

    /// A word of the RAM is read whose parity does not hold.
    pub fn fail_parity(&mut self) {
        let machine = self.cpu.machine();
        machine.parity_failed = true;
        machine.next_event = machine.now;
    }

    /// Lets the processor go on at `address` with these registers from r0 on, as code does that runs astray.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn go_astray(&mut self, address: u32, registers: &[u32]) -> Result<(), BoardError> {
        self.cpu.divert(address, registers)
    }

    /// Moves the stack pointer to `address`, as an overflow does.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn move_stack(&mut self, address: u32) -> Result<(), BoardError> {
        self.cpu.move_stack(address)
    }

    /// Faults of the processor since power-up: status register and program counter of each.
    pub fn processor_faults(&mut self) -> &[(u32, u32)] {
        &self.cpu.machine().faults
    }

    /// Holds a bit of the RAM at a level, as a defective cell does.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn stick_ram_bit(&mut self, address: u32, bit: u32, level: bool) -> Result<(), BoardError> {
        self.cpu.stick_ram_bit(address, bit, level)
    }

    /// Flips bits of a core register (0 to 12) whenever the instruction at `address` is reached, as a defective register
    /// does.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn flip_register(
        &mut self,
        address: u32,
        register: usize,
        bits: u32,
    ) -> Result<(), BoardError> {
        self.cpu.flip_register(address, register, bits)
    }

    /// The words of the backup domain.
    pub fn backup_words(&mut self) -> [u32; 32] {
        self.cpu.machine().backup.words()
    }

    /// Lets the voltage detector see this supply, mV, whatever the converters have.
    pub fn set_detector_sees(&mut self, millivolt: Option<u32>) {
        self.cpu.machine().detector_millivolt = millivolt;
    }

    /// Leaves a function out from now on: its instruction at `address` returns at once, as a task does that is never woken.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn leave_out(&mut self, address: u32) -> Result<(), BoardError> {
        self.cpu.leave_out(address)
    }

    /// Writes a word of RAM, or a register of a peripheral, behind the program's back.
    ///
    /// # Errors
    /// Nothing is there.
    pub fn poke(&mut self, address: u32, value: u32) -> Result<(), BoardError> {
        self.cpu.poke(address, value)
    }

    /// Word of the RAM or the flash at `address`.
    ///
    /// # Errors
    /// An address outside of both.
    pub fn word(&mut self, address: u32) -> Result<u32, BoardError> {
        self.cpu.word(address)
    }

    /// Sets the converters' supply, mV (3300 is nominal, > 0).
    pub fn set_vdda(&mut self, millivolt: u32) {
        self.catch_up();
        self.cpu.machine().vdda_millivolt = millivolt.max(1);
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

    /// Flips bits of the flash word at `address`, as ageing does.
    ///
    /// # Errors
    /// An address outside flash.
    pub fn corrupt_flash(&mut self, address: u32, bits: u32) -> Result<(), BoardError> {
        let word = self.cpu.word(address)? ^ bits;
        self.cpu
            .core
            .mem_write(u64::from(address), &word.to_le_bytes())?;
        Ok(())
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

    /// Sets the speed of whoever is on the other end of a port's wire, bit/s; without it that end follows the port.
    pub fn set_peer_speed(&mut self, port: Port, baud: u32) {
        self.cpu.machine().port(port).peer_bit = Some(TICK_HZ / u64::from(baud.max(1)));
    }

    /// Takes what the program has sent over a port.
    pub fn take_sent(&mut self, port: Port) -> Vec<Sent> {
        std::mem::take(&mut self.cpu.machine().port(port).sent)
    }

    /// Lets DMA answer no request, as when the bus is taken: the converter overruns.
    pub fn block_dma(&mut self, blocked: bool) {
        self.catch_up();
        self.cpu.machine().dma_blocked = blocked;
    }

    /// Leaves the next `requests` of the encoder's DMA unanswered: its ring falls behind the converter's.
    pub fn lose_encoder_counts(&mut self, requests: u32) {
        self.catch_up();
        self.cpu.machine().lost_encoder_requests = requests;
    }

    /// Holds the processor up while everything else goes on, as a bus master does that does not let go.
    ///
    /// # Errors
    /// The emulator refuses.
    pub fn hold_up(&mut self, seconds: f64) -> Result<(), BoardError> {
        let end = self.cpu.machine().now + (seconds * TICK_HZ as f64) as u64;
        while self.cpu.machine().now < end {
            self.cpu.happen()?;
            let machine = self.cpu.machine();
            machine.now = machine.horizon().clamp(machine.now + 1, end);
        }
        Ok(())
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

    /// Interrupts the program every `cycles` of 80 MHz for nothing, with the DMA channel of the converter.
    pub fn interrupt_for_nothing(&mut self, cycles: u64) {
        let machine = self.cpu.machine();
        let cycles = cycles * (TICK_HZ / crate::CORE_HZ);
        machine.spurious = Some((cycles, machine.now + cycles));
    }

    /// Leaves out the stacking of floating-point registers: a negative control, for tests.
    pub fn forget_float_stacking(&mut self) {
        self.cpu.stacks_floats = false;
    }
}
