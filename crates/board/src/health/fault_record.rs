//! What a crash leaves behind: words in the chip's backup registers, which every reset but a power failure keeps.

use serde::{Deserialize, Serialize};

use crate::checksum::crc32_words;

/// Words of a record, magic and checksum included.
pub const FAULT_RECORD_WORDS: usize = 13;
/// Layout of the words; a different one gets a different number.
const MAGIC: u32 = 0x444D_5201;

/// What ended the program. The numbers are those of the Modbus register and of the event log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[repr(u8)]
pub enum FaultCause {
    /// The processor could not execute or reach something.
    HardFault = 1,
    /// The program found a contradiction in itself.
    Panic = 2,
    /// A word of the RAM whose parity does not hold.
    RamParity = 3,
    /// Two wrong bits in a double word of the program in flash.
    FlashError = 4,
    /// The crystal stopped.
    ClockFailure = 5,
    /// The watchdog: a task left no mark in time.
    Watchdog = 6,
    /// A cell of the RAM failed its test at the start.
    RamTest = 7,
    /// The processor's registers failed their test.
    ProcessorTest = 8,
}

impl FaultCause {
    /// All of them, in the order of their numbers.
    pub const ALL: [FaultCause; 8] = [
        FaultCause::HardFault,
        FaultCause::Panic,
        FaultCause::RamParity,
        FaultCause::FlashError,
        FaultCause::ClockFailure,
        FaultCause::Watchdog,
        FaultCause::RamTest,
        FaultCause::ProcessorTest,
    ];

    /// By its number.
    pub fn by_number(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|cause| *cause as u32 == number)
    }

    /// In words.
    pub fn label(self) -> &'static str {
        match self {
            FaultCause::HardFault => "hard fault",
            FaultCause::Panic => "panic",
            FaultCause::RamParity => "parity error in the RAM",
            FaultCause::FlashError => "error in the program's flash",
            FaultCause::ClockFailure => "crystal stopped",
            FaultCause::Watchdog => "watchdog",
            FaultCause::RamTest => "RAM failed its test",
            FaultCause::ProcessorTest => "processor failed its test",
        }
    }
}

/// A crash. What does not apply to its cause is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FaultRecord {
    /// What happened.
    pub cause: FaultCause,
    /// Program counter and link register of the interrupted code.
    pub pc: u32,
    /// See `pc`.
    pub lr: u32,
    /// Program status register: the exception that ran.
    pub xpsr: u32,
    /// Fault status of the processor (CFSR).
    pub cfsr: u32,
    /// Hard fault status (HFSR).
    pub hfsr: u32,
    /// Address that could not be reached, that failed, or that the panic's file name lies at; of a watchdog the marks that
    /// were missing.
    pub address: u32,
    /// Stack pointer.
    pub sp: u32,
    /// Line of a panic.
    pub line: u32,
    /// Bytes of the panic's file name.
    pub length: u32,
    /// Since the start, ms.
    pub uptime_ms: u32,
}

impl FaultRecord {
    /// Nothing but the cause.
    pub fn of(cause: FaultCause) -> Self {
        FaultRecord {
            cause,
            pc: 0,
            lr: 0,
            xpsr: 0,
            cfsr: 0,
            hfsr: 0,
            address: 0,
            sp: 0,
            line: 0,
            length: 0,
            uptime_ms: 0,
        }
    }

    /// For the backup registers.
    pub fn to_words(&self) -> [u32; FAULT_RECORD_WORDS] {
        let mut words = [
            MAGIC,
            self.cause as u32,
            self.pc,
            self.lr,
            self.xpsr,
            self.cfsr,
            self.hfsr,
            self.address,
            self.sp,
            self.line,
            self.length,
            self.uptime_ms,
            0,
        ];
        let [content @ .., checksum] = &mut words;
        *checksum = crc32_words(content);
        words
    }

    /// From the backup registers; `None` where they hold no whole record.
    pub fn from_words(words: &[u32; FAULT_RECORD_WORDS]) -> Option<Self> {
        let [content @ .., checksum] = words;
        let [
            magic,
            cause,
            pc,
            lr,
            xpsr,
            cfsr,
            hfsr,
            address,
            sp,
            line,
            length,
            uptime_ms,
        ] = *content;
        if magic != MAGIC || crc32_words(content) != *checksum {
            return None;
        }
        Some(FaultRecord {
            cause: FaultCause::by_number(cause)?,
            pc,
            lr,
            xpsr,
            cfsr,
            hfsr,
            address,
            sp,
            line,
            length,
            uptime_ms,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn example(cause: FaultCause) -> FaultRecord {
        FaultRecord {
            pc: 0x0800_1234,
            lr: 0x0800_4321,
            line: 77,
            uptime_ms: 1_000,
            ..FaultRecord::of(cause)
        }
    }

    #[test]
    fn every_cause_comes_back_and_none_shares_a_number() {
        for (k, cause) in FaultCause::ALL.into_iter().enumerate() {
            let record = example(cause);
            assert_eq!(FaultRecord::from_words(&record.to_words()), Some(record));
            assert_eq!(cause as usize, k + 1);
        }
    }

    #[test]
    fn registers_that_were_never_written_hold_no_record() {
        assert_eq!(FaultRecord::from_words(&[0; FAULT_RECORD_WORDS]), None);
        assert_eq!(
            FaultRecord::from_words(&[u32::MAX; FAULT_RECORD_WORDS]),
            None
        );
    }

    proptest! {
        #[test]
        fn any_flipped_bit_is_found(place in 0..FAULT_RECORD_WORDS, bit in 0..32_u32) {
            let mut words = example(FaultCause::Panic).to_words();
            words[place] ^= 1 << bit;
            prop_assert_eq!(FaultRecord::from_words(&words), None);
        }
    }
}
