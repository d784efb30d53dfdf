//! The chip's own health: why it was reset, its analogue reference, its temperature.

use embassy_stm32::Peri;
use embassy_stm32::adc::{
    Adc, AdcChannel, AdcConfig, SampleTime, Temperature, VREF_CALIB_MV, VrefInt,
};
use embassy_stm32::pac;
use embassy_stm32::peripherals::ADC5;

/// mV; the supply that all dividers and current sensors of docs/wiring.md are computed for.
const NOMINAL_VDDA: u32 = 3_300;
/// Readings of the reference that are averaged: one code of it is 2 mV.
const READINGS: u32 = 16;
/// Per mille; the NUCLEO's regulator and the factory's reference value together stay within 2 %.
const VDDA_TOLERANCE: u32 = 30;

/// 247.5 cycles are 6.2 us; the temperature sensor wants at least 5, the reference 4.
const SAMPLE_TIME: SampleTime = SampleTime::CYCLES247_5;

/// Codes of the temperature sensor at two temperatures, degrees Celsius, which the factory leaves in the chip (3.0 V).
const TEMPERATURE_CALIBRATION: [(*const u16, f32); 2] = [
    (0x1FFF_75A8 as *const u16, 30.0),
    (0x1FFF_75CA as *const u16, 130.0),
];

/// Why the program started. The numbers are those of the Modbus register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum ResetCause {
    /// Power came (back): the chip cannot tell a brown-out from a first power-up.
    PowerOrBrownOut = 1,
    /// The watchdog: no good block came in time.
    Watchdog,
    /// The program itself, after a panic.
    Software,
    /// The reset pin or a debugger.
    Pin,
    /// Loading of option bytes; low power, which is not used here.
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
    temperature: Temperature,
    calibration: [(f32, f32); 2],
}

impl Housekeeping {
    /// Starts the reference.
    pub fn new(adc: Peri<'static, ADC5>) -> Self {
        let adc = Adc::new(adc, AdcConfig::default());
        let reference = adc.enable_vrefint();
        let temperature = adc.enable_temperature();
        Housekeeping {
            adc,
            reference,
            temperature,
            calibration: TEMPERATURE_CALIBRATION
                .map(|(address, degc)| (factory_code(address), degc)),
        }
    }

    /// Temperature of the chip, degrees Celsius, with converters supplied by `vdda_millivolt`.
    pub fn temperature_degc(&mut self, vdda_millivolt: u32) -> f32 {
        let code = settled(&mut self.adc, &mut self.temperature);
        let at_calibration = f32::from(code) * vdda_millivolt as f32 / VREF_CALIB_MV as f32;
        let [(cold, cold_degc), (hot, hot_degc)] = self.calibration;
        cold_degc + (at_calibration - cold) * (hot_degc - cold_degc) / (hot - cold)
    }

    /// Supply of the converters, mV; 0 when the reference shows nothing.
    pub fn vdda_millivolt(&mut self) -> u32 {
        let calibrated = u32::from(self.reference.calibrated_value());
        let mut measured = u32::from(settled(&mut self.adc, &mut self.reference));
        for _ in 1..READINGS {
            measured += u32::from(self.adc.blocking_read(&mut self.reference, SAMPLE_TIME));
        }
        // Rounded: half of the divisor more.
        (VREF_CALIB_MV * calibrated * READINGS + measured / 2)
            .checked_div(measured)
            .unwrap_or(0)
    }
}

/// The second of two results: the first one after a pause of 1 ms or more, and the first one of another channel, may be wrong
/// (erratum of the family).
fn settled(adc: &mut Adc<'static, ADC5>, channel: &mut impl AdcChannel<ADC5>) -> u16 {
    let _ = adc.blocking_read(channel, SAMPLE_TIME);
    adc.blocking_read(channel, SAMPLE_TIME)
}

/// Reads a constant that the factory wrote beside the flash.
#[allow(unsafe_code)]
fn factory_code(address: *const u16) -> f32 {
    // Safety: both addresses are readable, aligned and never change on every chip of this family.
    f32::from(unsafe { address.read_volatile() })
}

/// The chip's serial number of 96 bits, its highest 32 first.
pub fn serial_number() -> [u32; 3] {
    let id = embassy_stm32::uid::uid();
    let word = |k: usize| {
        let bytes = id.as_chunks::<4>().0.get(k);
        bytes.map_or(0, |bytes| u32::from_le_bytes(*bytes))
    };
    [word(2), word(1), word(0)]
}

/// The converters' supply as a share of the one that all full scales are meant for. To a millivolt, so that what is corrected by
/// is what frames and registers tell.
pub fn share_of_nominal(millivolt: u32) -> f32 {
    millivolt as f32 / NOMINAL_VDDA as f32
}

/// Whether codes can be taken for volts and amperes at this converter supply, mV.
pub fn is_vdda_credible(millivolt: u32) -> bool {
    millivolt.abs_diff(NOMINAL_VDDA) * 1_000 <= VDDA_TOLERANCE * NOMINAL_VDDA
}
