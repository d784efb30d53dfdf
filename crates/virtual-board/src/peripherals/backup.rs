//! The backup domain: 32 words that every reset but a power failure leaves, and the calendar's sub-seconds.

use crate::TICK_HZ;
use crate::peripherals::registers::Unmodelled;

const WORDS: usize = 32;
const FIRST_WORD: u32 = 0x100;
/// Cycles of the low-speed oscillator per sub-second, and sub-seconds per second: the prescalers' reset values.
const CYCLES_PER_SUBSECOND: u64 = 128;
const SUBSECONDS: u64 = 256;

/// Words and calendar.
#[derive(Clone, Debug, Default)]
pub struct Backup {
    words: [u32; WORDS],
    /// When the calendar began to count.
    since: Option<u64>,
}

impl Backup {
    /// Power failed, or the program resets the domain.
    pub fn clear(&mut self) {
        *self = Backup::default();
    }

    /// The calendar counts or stands.
    pub fn drive_calendar(&mut self, driven: bool, now: u64) {
        self.since = match driven {
            true => self.since.or(Some(now)),
            false => None,
        };
    }

    /// All words.
    pub fn words(&self) -> [u32; WORDS] {
        self.words
    }

    /// A read of the words' block.
    pub fn read(&self, offset: u32) -> Result<u32, Unmodelled> {
        self.place(offset)
            .and_then(|place| self.words.get(place).copied())
            .ok_or_else(|| unmodelled("TAMP", "read".into(), offset))
    }

    /// A write to the words' block; on silicon it is lost while the domain is protected: an error here.
    pub fn write(&mut self, offset: u32, value: u32, protected: bool) -> Result<(), Unmodelled> {
        let missing = |what: &str| unmodelled("TAMP", format!("write of {value:#x}{what}"), offset);
        if protected {
            return Err(missing(" while the backup domain is protected"));
        }
        let word = self.place(offset).and_then(|k| self.words.get_mut(k));
        *word.ok_or_else(|| missing(""))? = value;
        Ok(())
    }

    fn place(&self, offset: u32) -> Option<usize> {
        let bytes = offset.checked_sub(FIRST_WORD)?;
        bytes.is_multiple_of(4).then_some(bytes as usize / 4)
    }

    fn subseconds(&self, now: u64, lsi_hz: u64) -> u64 {
        let cycles = self
            .since
            .map_or(0, |since| u128::from(now - since) * u128::from(lsi_hz));
        (cycles / u128::from(TICK_HZ * CYCLES_PER_SUBSECOND)) as u64
    }

    /// A read of the calendar: sub-seconds and seconds are modelled; the date is read to let them go on.
    pub fn read_calendar(&self, offset: u32, now: u64, lsi_hz: u64) -> Result<u32, Unmodelled> {
        let counted = self.subseconds(now, lsi_hz);
        let seconds = (counted / SUBSECONDS % 60) as u32;
        match offset {
            // Tens and units, in decimal digits.
            0x0 => Ok(((seconds / 10) << 4) | (seconds % 10)),
            0x4 => Ok(0),
            0x8 => Ok((SUBSECONDS - 1 - counted % SUBSECONDS) as u32),
            _ => Err(unmodelled("RTC", "read".into(), offset)),
        }
    }
}

fn unmodelled(block: &'static str, access: String, offset: u32) -> Unmodelled {
    Unmodelled {
        block,
        access,
        offset,
    }
}
