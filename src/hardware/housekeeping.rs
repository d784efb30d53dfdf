//! The chip's own health: why it was reset, and its analogue reference.

use embassy_stm32::Peri;
use embassy_stm32::adc::{Adc, AdcConfig, SampleTime, VREF_CALIB_MV, VrefInt};
use embassy_stm32::pac;
use embassy_stm32::peripherals::ADC5;

/// mV; the supply that all dividers and current sensors of docs/wiring.md are computed for.
const NOMINAL_VDDA: u32 = 3_300;
/// Per mille; the NUCLEO's regulator and the factory's reference value together stay within 2 %.
const VDDA_TOLERANCE: u32 = 30;

/// Why the program started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum ResetCause {
    /// Power came (back): the chip cannot tell a brown-out from a first power-up.
    PowerOrBrownOut,
    /// The watchdog: no good block came in time.
    Watchdog,
    /// The program itself, after a panic.
    Software,
    /// The reset pin or a debugger.
    Pin,
    /// Loading of option bytes, or low power: not used here.
    Other,
}

impl ResetCause {
    /// Reads the chip's flags and clears them for the next time.
    pub fn take() -> Self {
        let flags = pac::RCC.csr().read();
        pac::RCC.csr().modify(|w| w.set_rmvf(true));
        // The pin flag accompanies every other cause, so it comes last.
        match () {
            () if flags.borrstf() => ResetCause::PowerOrBrownOut,
            () if flags.iwdgrstf() => ResetCause::Watchdog,
            () if flags.sftrstf() => ResetCause::Software,
            () if flags.pinrstf() => ResetCause::Pin,
            () => ResetCause::Other,
        }
    }
}

/// Measures the supply of the converters against the chip's reference.
pub struct Housekeeping {
    adc: Adc<'static, ADC5>,
    reference: VrefInt,
}

impl Housekeeping {
    /// Starts the reference.
    pub fn new(adc: Peri<'static, ADC5>) -> Self {
        let adc = Adc::new(adc, AdcConfig::default());
        let reference = adc.enable_vrefint();
        Housekeeping { adc, reference }
    }

    /// Supply of the converters, mV; 0 when the reference shows nothing.
    pub fn vdda_millivolt(&mut self) -> u32 {
        let calibrated = u32::from(self.reference.calibrated_value());
        // 247.5 cycles are 5.8 us; the reference wants at least 4.
        let measured = self
            .adc
            .blocking_read(&mut self.reference, SampleTime::CYCLES247_5);
        (VREF_CALIB_MV * calibrated)
            .checked_div(u32::from(measured))
            .unwrap_or(0)
    }
}

/// Whether codes can be taken for volts and amperes at this converter supply, mV.
pub fn is_vdda_credible(millivolt: u32) -> bool {
    millivolt.abs_diff(NOMINAL_VDDA) * 1_000 <= VDDA_TOLERANCE * NOMINAL_VDDA
}
