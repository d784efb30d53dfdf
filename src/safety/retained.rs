//! Words that survive every reset but a power failure: the record of a crash, and how often it happened in a row.

use board::{FAULT_RECORD_WORDS, FaultCause, FaultRecord};
use embassy_stm32::pac;

use super::start::{RAM_DEFECT, RAM_DEFECT_WORD};

/// Crashes in a row after which nothing is computed until somebody acknowledges.
const MOST_CRASHES: u32 = 3;
/// Number of the register that counts them, above a mark that tells a count from what power-up leaves.
const CRASHES_WORD: usize = 16;
const CRASHES_MARK: u32 = 0x444D_0000;
/// The marks that the watchdog misses, and the time since the start, ms.
const MISSING_WORD: usize = 17;
const UPTIME_WORD: usize = 18;

/// Makes the registers writable.
pub fn open() {
    pac::RCC.apb1enr1().modify(|w| w.set_pwren(true));
    // A peripheral answers two cycles after its clock.
    let _ = pac::RCC.apb1enr1().read();
    pac::PWR.cr1().modify(|w| w.set_dbp(true));
}

fn read(word: usize) -> u32 {
    pac::TAMP.bkpr(word).read().0
}

fn write(word: usize, value: u32) {
    pac::TAMP.bkpr(word).write(|w| w.0 = value);
}

/// Leaves a record for the next start.
pub fn leave(record: &FaultRecord) {
    for (k, word) in record.to_words().into_iter().enumerate() {
        write(k, word);
    }
}

/// Takes the record that a crash has left, and clears it; where the watchdog ended the program, what is known of that.
pub fn take(by_watchdog: bool) -> Option<FaultRecord> {
    let record = left().or_else(|| {
        by_watchdog.then(|| FaultRecord {
            address: read(MISSING_WORD),
            uptime_ms: read(UPTIME_WORD),
            ..FaultRecord::of(FaultCause::Watchdog)
        })
    });
    write(0, 0);
    write(RAM_DEFECT_WORD, 0);
    write(UPTIME_WORD, 0);
    record
}

fn left() -> Option<FaultRecord> {
    let mut words = [0; FAULT_RECORD_WORDS];
    for (k, word) in words.iter_mut().enumerate() {
        *word = read(k);
    }
    let of_ram_test = || {
        (read(RAM_DEFECT_WORD) == RAM_DEFECT).then(|| FaultRecord {
            address: read(RAM_DEFECT_WORD + 1),
            ..FaultRecord::of(FaultCause::RamTest)
        })
    };
    FaultRecord::from_words(&words).or_else(of_ram_test)
}

/// Counts a crash.
pub fn count_crash() {
    let crashes = crashes().saturating_add(1);
    write(CRASHES_WORD, CRASHES_MARK | crashes.min(0xFFFF));
}

/// Whether there were too many in a row.
pub fn are_too_many() -> bool {
    crashes() >= MOST_CRASHES
}

/// Crashes without a quiet minute between them.
pub fn crashes() -> u32 {
    match read(CRASHES_WORD) {
        word if word & 0xFFFF_0000 == CRASHES_MARK => word & 0xFFFF,
        _ => 0,
    }
}

/// A quiet minute, or a person who acknowledged.
pub fn forget_crashes() {
    if crashes() > 0 {
        write(CRASHES_WORD, CRASHES_MARK);
    }
}

/// Notes what the watchdog waits for, should it end the program.
pub fn note(missing: u32, uptime_ms: u32) {
    write(MISSING_WORD, missing);
    write(UPTIME_WORD, uptime_ms);
}
