//! The ends of the program: hard faults, panics, and the causes of the non-maskable interrupt. Each leaves a record in the
//! backup registers and starts the board again.
// Handlers of the processor, and the frame that it pushed.
#![allow(unsafe_code)]

use core::arch::global_asm;
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicU32, Ordering};

use board::{FaultCause, FaultRecord};
use cortex_m::peripheral::SCB;
use cortex_m_rt::exception;
use embassy_stm32::pac;
use update::layout::{BANK_BYTES, FLASH_BASE, JOURNAL, JOURNAL_PAGES, PAGE_BYTES};

use super::{marks, retained};

/// Where words may be torn in bank 1: the journal of updates.
const JOURNAL_BYTES: core::ops::Range<u32> = JOURNAL..JOURNAL + JOURNAL_PAGES * PAGE_BYTES;
/// Errors in stored data since the start, and corrected ones.
static STORED_DATA_ERRORS: AtomicU32 = AtomicU32::new(0);

// The stack may be what is broken: nothing is pushed before the pointer is at its reserve.
global_asm!(
    ".section .HardFault.user, \"ax\"
     .global HardFault
     .type HardFault,%function
     .thumb_func
     HardFault:
     mrs r0, msp
     ldr r1, =__fault_stack_top
     msr msp, r1
     b record_hard_fault
     .ltorg
     .size HardFault, . - HardFault"
);

unsafe extern "C" {
    static _stack_end: u8;
    static _stack_start: u8;
}

/// Tells what the processor pushed when it faulted. `sp` is the stack pointer of that moment.
#[unsafe(no_mangle)]
extern "C" fn record_hard_fault(sp: u32) -> ! {
    // Safety: the registers are readable at any time.
    let scb = unsafe { &*SCB::PTR };
    let cfsr = scb.cfsr.read();
    let [lr, pc, xpsr] = frame(sp).unwrap_or_default();
    let address = match cfsr {
        status if status & 1 << 7 != 0 => scb.mmfar.read(),
        status if status & 1 << 15 != 0 => scb.bfar.read(),
        _ => 0,
    };
    end(FaultRecord {
        pc,
        lr,
        xpsr,
        cfsr,
        hfsr: scb.hfsr.read(),
        address,
        sp,
        ..FaultRecord::of(FaultCause::HardFault)
    })
}

/// Link register, program counter and status of the frame at `sp`; `None` where it is not all in the stack's memory.
fn frame(sp: u32) -> Option<[u32; 3]> {
    let (end, start) = (&raw const _stack_end as u32, &raw const _stack_start as u32);
    let whole = sp.is_multiple_of(4) && sp >= end && sp <= start - 32;
    // Safety: eight aligned words within the stack's memory.
    whole.then(|| [5, 6, 7].map(|k| unsafe { (sp as *const u32).add(k).read_volatile() }))
}

/// Leaves the record and starts the board again.
fn end(record: FaultRecord) -> ! {
    retained::open();
    retained::leave(&FaultRecord {
        uptime_ms: marks::uptime_ms(),
        ..record
    });
    SCB::sys_reset()
}

/// No message could be read: its place is kept, and the board starts again.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let mut record = FaultRecord::of(FaultCause::Panic);
    if let Some(place) = info.location() {
        record.address = place.file().as_ptr() as u32;
        record.length = place.file().len() as u32;
        record.line = place.line();
    }
    end(record)
}

/// Ends the program for a failed test of the processor.
pub fn end_untrusted() -> ! {
    end(FaultRecord::of(FaultCause::ProcessorTest))
}

/// Errors in stored data that were read and whose checksum has decided, since the start.
pub fn stored_data_errors() -> u32 {
    STORED_DATA_ERRORS.load(Ordering::Relaxed)
}

/// One cause after the other; what none of them explains comes back and starves the watchdog.
#[exception]
unsafe fn NonMaskableInt() {
    if pac::RCC.cifr().read().cssf() {
        pac::RCC.cicr().write(|w| w.set_cssc(true));
        end(FaultRecord::of(FaultCause::ClockFailure));
    }
    if pac::SYSCFG.cfgr2().read().spf() {
        end(FaultRecord::of(FaultCause::RamParity));
    }
    let error = pac::FLASH.eccr().read();
    if error.eccd() {
        forgive_stored_data(error);
    }
}

/// A double word whose programming a reset cut off fails its error correction, and reading it raises this. In bank 2, where
/// data are stored, and in the journal of updates the value that was read is wrong and a checksum finds it; without clearing
/// the flag this would come for ever. The program lies in bank 1, and is not executed with wrong bits.
fn forgive_stored_data(error: pac::flash::regs::Eccr) {
    let in_bank = error.addr_ecc() % BANK_BYTES;
    if !error.bk_ecc() && !JOURNAL_BYTES.contains(&in_bank) {
        end(FaultRecord {
            address: FLASH_BASE + in_bank,
            ..FaultRecord::of(FaultCause::FlashError)
        });
    }
    pac::FLASH.eccr().modify(|w| w.set_eccd(true));
    STORED_DATA_ERRORS.fetch_add(1, Ordering::Relaxed);
}
