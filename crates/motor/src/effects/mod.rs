//! Physical effects: one file each, one line in the macro `effects!` below to register it.
//!
//! What an effect is and may change says [`crate::effect`].

use crate::effect::SteadyEffect;
#[cfg(feature = "std")]
use crate::effect::{Effect, Instrument, Side};

/// Registers effects: the file and the type in it.
macro_rules! effects {
    ($($file:ident: $effect:ident),* $(,)?) => {
        $(mod $file;)*

        /// All effects, as the monitor core and the firmware see them.
        pub static STEADY: &[&dyn SteadyEffect] = &[$(&$file::$effect),*];

        /// All effects, as simulator and discovery see them.
        #[cfg(feature = "std")]
        pub static ALL: &[&dyn Effect] = &[$(&$file::$effect),*];
    };
}

effects! {
    magnetizing_saturation: MagnetizingSaturation,
    leakage_saturation: LeakageSaturation,
    core_loss: CoreLoss,
    core_loss_air_gap: CoreLossAirGap,
    stator_heating: StatorHeating,
    rotor_heating: RotorHeating,
    deep_bar: DeepBar,
    double_cage: DoubleCage,
    coulomb_friction: CoulombFriction,
    windage: Windage,
    stray_load_loss: StrayLoadLoss,
    load_pulsation: LoadPulsation,
    shaft_compliance: ShaftCompliance,
    voltage_asymmetry: VoltageAsymmetry,
    stator_asymmetry: StatorAsymmetry,
    rotor_asymmetry: RotorAsymmetry,
    inverter_dead_time: InverterDeadTime,
    series_inductance: SeriesInductance,
    lc_filter: LcFilter,
    dc_link: DcLink,
    dc_link_capacitor: DcLinkCapacitor,
    voltage_gain: VoltageGain,
    current_gain: CurrentGain,
    load_gain: LoadGain,
    load_delay: LoadDelay,
    phase_voltage_gain: PhaseVoltageGain,
    phase_current_gain: PhaseCurrentGain,
    current_offset: CurrentOffset,
    voltage_offset: VoltageOffset,
    sample_delay: SampleDelay,
    sensor_filter: SensorFilter,
    frame_rotation: FrameRotation,
    speed_scale: SpeedScale,
    speed_ripple: SpeedRipple,
    speed_delay: SpeedDelay,
    speed_mean: SpeedMean,
}

/// The effect of this name and form; an empty form means the effect's first.
#[cfg(feature = "std")]
pub fn find(name: &str, form: &str) -> Option<&'static dyn Effect> {
    let mut all = ALL.iter().copied();
    all.find(|e| e.descriptor().is_meant(name, form))
}

/// The steady-state term of this name and form; an empty form means the effect's first.
pub fn find_steady(name: &str, form: &str) -> Option<&'static dyn SteadyEffect> {
    let mut all = STEADY.iter().copied();
    all.find(|e| e.descriptor().is_meant(name, form))
}

/// The effect that is the gain of an instrument; each has exactly one, which the tests of the library hold.
#[cfg(feature = "std")]
pub fn gain_of(instrument: Instrument) -> Option<&'static dyn Effect> {
    let is_gain = |e: &&&'static dyn Effect| e.gain_of() == Some(instrument);
    ALL.iter().find(is_gain).copied()
}

/// The effect that is the offset of an instrument's channels, where one is in the library.
#[cfg(feature = "std")]
pub fn offset_of(instrument: Instrument) -> Option<&'static dyn Effect> {
    let is_offset = |e: &&&'static dyn Effect| e.offset_of() == Some(instrument);
    ALL.iter().find(is_offset).copied()
}

/// The effect that breaks the symmetry of a winding; each has exactly one, which the tests of the library hold.
#[cfg(feature = "std")]
pub fn asymmetry_of(side: Side) -> Option<&'static dyn Effect> {
    let breaks = |e: &&&'static dyn Effect| e.asymmetry_of() == Some(side);
    ALL.iter().find(breaks).copied()
}

/// Names of all effects, each once.
#[cfg(feature = "std")]
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<_> = ALL.iter().map(|e| e.descriptor().name).collect();
    names.dedup();
    names
}
