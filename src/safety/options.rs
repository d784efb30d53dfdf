//! Option bytes: what the chip does before the program runs.

use embassy_stm32::pac;
use embassy_stm32::pac::flash::regs::Optr;

use crate::hardware::flash_store;

/// About 2.8 V: below it flash cannot be trusted to be programmed.
const BROWN_OUT_LEVEL: u8 = 4;
const KEYS: [u32; 2] = [0x0819_2A3B, 0x4C5D_6E7F];
const FLASH_KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];

/// As docs/firmware.md wants them: watchdog started by hardware, parity of the RAM, brown-out level, two banks, start from
/// bank 1. Protection of reading and everything else stays as it is.
fn prepared(options: Optr) -> Optr {
    let mut wanted = options;
    wanted.set_bor_lev(BROWN_OUT_LEVEL);
    wanted.set_idwg_sw(false);
    wanted.set_sram_pe(false);
    wanted.set_dbank(true);
    wanted.set_bfb2(false);
    wanted
}

/// Whether they are as they should be.
pub fn are_prepared() -> bool {
    let options = pac::FLASH.optr().read();
    options == prepared(options)
}

/// Writes them and starts the board with them; where the supply is low nothing is written, and SENSOR blinks on.
pub fn prepare() {
    if flash_store::is_supply_low() {
        defmt::error!("option bytes not written: low supply");
        return;
    }
    let options = prepared(pac::FLASH.optr().read());
    while pac::FLASH.sr().read().bsy() {}
    FLASH_KEYS
        .into_iter()
        .for_each(|key| pac::FLASH.keyr().write_value(key));
    KEYS.into_iter()
        .for_each(|key| pac::FLASH.optkeyr().write_value(key));
    pac::FLASH.optr().write_value(options);
    pac::FLASH.cr().modify(|w| w.set_optstrt(true));
    while pac::FLASH.sr().read().bsy() {}
    pac::FLASH.cr().modify(|w| w.set_obl_launch(true));
}
