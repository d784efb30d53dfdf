//! What the board stores: the calibration in the last two pages of bank 2, the event log in the eight before, the
//! configuration in the four before those, and a new program from its beginning on, away from the one that runs in bank 1.
//! Only the journal of updates lies in bank 1.

use board::{
    CONFIGURATION_PAGES, ConfigurationStore, EVENT_BYTES, EventLog, LOG_EVENTS, LOG_PAGES,
    PAGE_BYTES, PAGES, Store,
};
use embassy_stm32::Peri;
use embassy_stm32::flash::{Blocking, Error, Flash};
use embassy_stm32::pac;
use embassy_stm32::peripherals::FLASH;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use update::{BackgroundFlash, Updater};

/// Bytes of the chip's flash.
const FLASH_BYTES: u32 = 512 * 1024;
/// Level of the voltage detector, about 2.9 V: below it nothing is begun that a brown-out would cut off.
const DETECTOR_LEVEL: u8 = 6;

/// Where the two banks meet.
const BANK_BYTES: u32 = FLASH_BYTES / 2;
/// From the beginning of flash.
const CALIBRATION: u32 = FLASH_BYTES - PAGES * PAGE_BYTES;
const EVENTS: u32 = CALIBRATION - LOG_PAGES * PAGE_BYTES;
const CONFIGURATION: u32 = EVENTS - CONFIGURATION_PAGES * PAGE_BYTES;
/// Where flash is read.
const FLASH_BASE: usize = 0x0800_0000;
const LOG_BYTES: usize = LOG_EVENTS as usize * EVENT_BYTES;

/// The calibration in this chip's flash.
pub type FlashStore = Store<GuardedFlash>;

/// The event log in this chip's flash.
pub type FlashLog = EventLog<GuardedFlash>;

/// What lies in flash beside the program.
pub struct Stored {
    /// What was learnt.
    pub calibration: FlashStore,
    /// What happened.
    pub events: FlashLog,
    /// What was configured.
    pub configuration: ConfigurationStore<GuardedFlash>,
    /// A new program, and how far it is.
    pub updates: Updater<GuardedFlash>,
}

/// Opens all of it. `None` on a chip whose option bytes join the banks: its pages are others, and the driver would panic.
#[allow(unsafe_code)]
pub fn open(flash: Peri<'static, FLASH>) -> Option<Stored> {
    pac::PWR.cr2().modify(|w| {
        w.set_pls(DETECTOR_LEVEL);
        w.set_pvde(true);
    });
    let two_banks = pac::FLASH.optr().read().dbank();
    two_banks.then(|| {
        // Safety: all handles stay in the task of the samples, none is kept across a wait, and each waits for the others'
        // erasure.
        let handles = [(); 5].map(|()| unsafe { flash.clone_unchecked() });
        let [calibration, events, configuration, waiting, journal] =
            handles.map(|flash| GuardedFlash(Flash::new_blocking(flash)));
        Stored {
            configuration: ConfigurationStore::new(configuration, CONFIGURATION),
            calibration: Store::new(calibration, CALIBRATION),
            events: EventLog::open(events, EVENTS),
            updates: Updater::open(waiting, journal),
        }
    })
}

/// Copies bytes of the event log; `false` while a page is being erased: a read would hold up the samples until it is done.
#[allow(unsafe_code)]
pub fn read_events(at: usize, bytes: &mut [u8]) -> bool {
    let inside = at + bytes.len() <= LOG_BYTES;
    if !inside || is_erasing() {
        return false;
    }
    let first = (FLASH_BASE + EVENTS as usize + at) as *const u8;
    for (k, byte) in bytes.iter_mut().enumerate() {
        // Safety: within the log, and read as it lies in flash at this moment.
        *byte = unsafe { first.add(k).read_volatile() };
    }
    true
}

fn is_erasing() -> bool {
    pac::FLASH.sr().read().bsy()
}

/// Flash that is neither erased nor programmed while the supply is low.
pub struct GuardedFlash(Flash<'static, Blocking>);

/// Why flash was not read, erased or programmed.
#[derive(Debug)]
pub enum FlashError {
    /// The supply is below the voltage detector's level.
    LowSupply,
    /// The driver's.
    Driver(Error),
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            FlashError::LowSupply => NorFlashErrorKind::Other,
            FlashError::Driver(error) => error.kind(),
        }
    }
}

/// Whether the supply is below the voltage detector's level.
pub fn is_supply_low() -> bool {
    pac::PWR.sr2().read().pvdo()
}

/// Waits for what is being erased in the background; the driver does not. Then the supply has to be good.
fn settle() -> Result<(), FlashError> {
    while is_erasing() {}
    if pac::FLASH.cr().read().per() {
        end_erase();
    }
    match is_supply_low() {
        true => Err(FlashError::LowSupply),
        false => Ok(()),
    }
}

impl BackgroundFlash for GuardedFlash {
    fn is_ready(&mut self) -> bool {
        if is_erasing() {
            return false;
        }
        if pac::FLASH.cr().read().per() {
            end_erase();
        }
        !is_supply_low()
    }

    /// As the driver does it, but without waiting 22 ms for the end.
    fn begin_erase(&mut self, offset: u32) {
        let page = offset.saturating_sub(BANK_BYTES) / PAGE_BYTES;
        if pac::FLASH.cr().read().lock() {
            pac::FLASH.keyr().write_value(0x4567_0123);
            pac::FLASH.keyr().write_value(0xCDEF_89AB);
        }
        pac::FLASH.cr().modify(|w| {
            w.set_per(true);
            w.set_bker(true);
            w.set_pnb(page as u8);
        });
        pac::FLASH.cr().modify(|w| w.set_strt(true));
    }
}

/// The data cache may hold bytes of the page as they were.
fn end_erase() {
    pac::FLASH.cr().modify(|w| w.set_per(false));
    pac::FLASH.cr().modify(|w| w.set_lock(true));
    let cached = pac::FLASH.acr().read().dcen();
    pac::FLASH.acr().modify(|w| w.set_dcen(false));
    pac::FLASH.acr().modify(|w| w.set_dcrst(true));
    pac::FLASH.acr().modify(|w| w.set_dcrst(false));
    pac::FLASH.acr().modify(|w| w.set_dcen(cached));
}

impl ErrorType for GuardedFlash {
    type Error = FlashError;
}

impl ReadNorFlash for GuardedFlash {
    const READ_SIZE: usize = <Flash<'static, Blocking> as ReadNorFlash>::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        ReadNorFlash::read(&mut self.0, offset, bytes).map_err(FlashError::Driver)
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for GuardedFlash {
    const WRITE_SIZE: usize = <Flash<'static, Blocking> as NorFlash>::WRITE_SIZE;
    const ERASE_SIZE: usize = <Flash<'static, Blocking> as NorFlash>::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        settle()?;
        NorFlash::erase(&mut self.0, from, to).map_err(FlashError::Driver)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        settle()?;
        NorFlash::write(&mut self.0, offset, bytes).map_err(FlashError::Driver)
    }
}
