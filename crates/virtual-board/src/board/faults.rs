//! Faults of the board itself: of its parts, its supply, its memory and its processor.

use super::VirtualBoard;
use crate::TICK_HZ;
use crate::error::BoardError;
use crate::machine::relay::Contact;
use crate::peripherals::gpio::Pin;

impl VirtualBoard {
    /// Stops or restarts the clock of the sampling converter.
    pub fn stop_converter_clock(&mut self, stopped: bool) {
        self.catch_up();
        self.cpu.machine().adc1.clock_stopped = stopped;
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

    /// Sets the converters' supply, mV (3300 is nominal, > 0).
    pub fn set_vdda(&mut self, millivolt: u32) {
        self.catch_up();
        self.cpu.machine().vdda_millivolt = millivolt.max(1);
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
