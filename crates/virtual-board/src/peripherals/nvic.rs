//! Interrupt controller and system control: enabling, pending, priorities, vector table, reset request.

use crate::peripherals::registers::{Registers, Unmodelled};

const IRQS: usize = 102;
/// Stand for the non-maskable interrupt and the hard fault, which are none of the lines.
const NON_MASKABLE: usize = usize::MAX;
const HARD_FAULT: usize = usize::MAX - 1;
/// Status of faults: configurable ones, written as 1 to clear, and the hard fault; addresses.
const CFSR: u32 = 0xD28;
const HFSR: u32 = 0xD2C;
const MMFAR: u32 = 0xD34;
const BFAR: u32 = 0xD38;
/// HFSR: a fault that could not be handled otherwise.
const FORCED: u32 = 1 << 30;
/// Memory protection.
const MPU_TYPE: u32 = 0xD90;
const MPU_CTRL: u32 = 0xD94;
const MPU_RNR: u32 = 0xD98;
const MPU_RBAR: u32 = 0xD9C;
const MPU_RASR: u32 = 0xDA0;
const MPU_REGIONS: u32 = 8;
const VTOR: u32 = 0xD08;
const AIRCR: u32 = 0xD0C;
const CPACR: u32 = 0xD88;
const RESET: &[(u32, u32)] = &[
    (VTOR, 0),
    (0xD10, 0),     // SCR
    (0xD14, 0x200), // CCR
    (0xD18, 0),     // SHPR1
    (0xD1C, 0),     // SHPR2
    (0xD20, 0),     // SHPR3
    (0xD24, 0),     // SHCSR
    (CFSR, 0),
    (HFSR, 0),
    (MMFAR, 0),
    (BFAR, 0),
    (CPACR, 0),
    (MPU_CTRL, 0),
    (MPU_RNR, 0),
    (0xDFC, 0),           // DEMCR
    (0xF34, 0xC000_0000), // FPCCR
];

/// State of the controller.
#[derive(Clone, Debug)]
pub struct Nvic {
    enabled: [bool; IRQS],
    pending: [bool; IRQS],
    priority: [u8; IRQS],
    /// Priorities of the running handlers, innermost last.
    active: Vec<(usize, u8)>,
    registers: Registers,
    /// Base and attributes of the regions of memory protection.
    regions: [(u32, u32); MPU_REGIONS as usize],
    /// What [`Nvic::take`] would take; found anew whenever something changes, because it is asked for at every block.
    candidate: Option<usize>,
    /// The program asked for a reset.
    pub reset_requested: bool,
}

impl Nvic {
    /// After reset.
    pub fn new() -> Self {
        Nvic {
            enabled: [false; IRQS],
            pending: [false; IRQS],
            priority: [0; IRQS],
            active: Vec::new(),
            registers: Registers::new("NVIC/SCB", RESET),
            regions: [(0, 0); MPU_REGIONS as usize],
            candidate: None,
            reset_requested: false,
        }
    }

    /// Base of the vector table.
    pub fn vector_table(&self) -> u32 {
        self.registers.get(VTOR)
    }

    /// A peripheral's line is asserted.
    pub fn pend(&mut self, irq: usize) {
        if !self.pending[irq] {
            self.pending[irq] = true;
            self.candidate = self.find_candidate();
        }
    }

    /// Whether some enabled interrupt waits with a higher priority than what runs.
    pub fn is_waiting(&self) -> bool {
        self.candidate.is_some()
    }

    fn find_candidate(&self) -> Option<usize> {
        let running = self.active.last().map_or(u16::MAX, |(_, p)| u16::from(*p));
        if self
            .active
            .last()
            .is_some_and(|(irq, _)| *irq >= HARD_FAULT)
        {
            return None;
        }
        let ready = (0..IRQS).filter(|&irq| self.enabled[irq] && self.pending[irq]);
        ready
            .min_by_key(|&irq| (self.priority[irq], irq))
            .filter(|&irq| u16::from(self.priority[irq]) < running)
    }

    /// Takes the non-maskable interrupt, unless its handler runs already.
    pub fn take_non_maskable(&mut self) -> bool {
        let free = self
            .active
            .last()
            .is_none_or(|(irq, _)| *irq != NON_MASKABLE);
        if free {
            self.active.push((NON_MASKABLE, 0));
            self.candidate = self.find_candidate();
        }
        free
    }

    /// Takes a hard fault with its status and the address that could not be reached; `false` where one is being handled, or
    /// the non-maskable interrupt: the core locks up.
    pub fn take_hard_fault(&mut self, status: u32, address: Option<u32>) -> bool {
        self.registers.set(CFSR, self.registers.get(CFSR) | status);
        self.registers.set(HFSR, self.registers.get(HFSR) | FORCED);
        if let Some(address) = address {
            self.registers.set(BFAR, address);
            self.registers.set(MMFAR, address);
        }
        let free = self.active.last().is_none_or(|(irq, _)| *irq < HARD_FAULT);
        if free {
            self.active.push((HARD_FAULT, 0));
            self.candidate = self.find_candidate();
        }
        free
    }

    /// Whether an enabled region of memory protection that holds `address` forbids to execute.
    pub fn forbids_execution(&self, address: u32) -> bool {
        self.region_of(address)
            .is_some_and(|attributes| attributes >> 28 & 1 == 1)
    }

    /// Attributes of the region that decides about an address: the last one that holds it.
    fn region_of(&self, address: u32) -> Option<u32> {
        let on = self.registers.get(MPU_CTRL) & 1 == 1;
        let holds = |(base, attributes): &&(u32, u32)| {
            let size = 2_u64 << (attributes >> 1 & 0x1F);
            let first = u64::from(*base & !0x1F);
            attributes & 1 == 1 && (first..first + size).contains(&u64::from(address))
        };
        let found = self.regions.iter().rev().find(holds).filter(|_| on);
        found.map(|(_, attributes)| *attributes)
    }

    /// Takes the next interrupt to be served.
    pub fn take(&mut self) -> Option<usize> {
        let irq = self.candidate?;
        self.pending[irq] = false;
        self.active.push((irq, self.priority[irq]));
        self.candidate = self.find_candidate();
        Some(irq)
    }

    /// Ends the innermost handler and names it.
    pub fn leave(&mut self) -> Option<usize> {
        let ended = self.active.pop().map(|(irq, _)| irq);
        self.candidate = self.find_candidate();
        ended
    }

    /// A bus read; offsets count from 0xE000_E000.
    pub fn read(&self, offset: u32) -> Result<u32, Unmodelled> {
        let bits = |flags: &[bool; IRQS], word: u32| {
            let first = word as usize * 32;
            (0..32).fold(0, |bits, k| {
                bits | u32::from(flags.get(first + k).copied().unwrap_or(false)) << k
            })
        };
        match offset {
            0x100..0x110 => Ok(bits(&self.enabled, (offset - 0x100) / 4)),
            0x180..0x190 => Ok(bits(&self.enabled, (offset - 0x180) / 4)),
            0x200..0x210 => Ok(bits(&self.pending, (offset - 0x200) / 4)),
            0x280..0x290 => Ok(bits(&self.pending, (offset - 0x280) / 4)),
            0x400..0x466 => Ok(u32::from(self.priority[(offset - 0x400) as usize])),
            AIRCR => Ok(0xFA05_0000),
            MPU_TYPE => Ok(MPU_REGIONS << 8),
            _ => self.registers.read(offset),
        }
    }

    /// A bus write; priorities are written byte by byte.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), Unmodelled> {
        let mut assign = |flags: fn(&mut Nvic) -> &mut [bool; IRQS], base: u32, level: bool| {
            let first = (offset - base) as usize / 4 * 32;
            for k in (0..32).filter(|k| value >> k & 1 == 1) {
                if let Some(flag) = flags(self).get_mut(first + k) {
                    *flag = level;
                }
            }
        };
        match offset {
            0x100..0x110 => assign(|nvic| &mut nvic.enabled, 0x100, true),
            0x180..0x190 => assign(|nvic| &mut nvic.enabled, 0x180, false),
            0x200..0x210 => assign(|nvic| &mut nvic.pending, 0x200, true),
            0x280..0x290 => assign(|nvic| &mut nvic.pending, 0x280, false),
            0x400..0x466 => self.priority[(offset - 0x400) as usize] = value as u8,
            AIRCR => self.reset_requested = value == 0x05FA_0004,
            CFSR | HFSR => {
                let left = self.registers.get(offset) & !value;
                self.registers.set(offset, left);
            }
            MPU_RBAR | MPU_RASR => {
                let region = (self.registers.get(MPU_RNR) % MPU_REGIONS) as usize;
                match offset {
                    MPU_RBAR => self.regions[region].0 = value,
                    _ => self.regions[region].1 = value,
                }
            }
            _ => return self.registers.write(offset, value),
        }
        self.candidate = self.find_candidate();
        Ok(())
    }
}
