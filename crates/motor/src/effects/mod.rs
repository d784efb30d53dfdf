//! Physical effects: one file each, one line in the macro `effects!` below to register it.
//!
//! An effect is stateless; its parameters are a slice in the order of its [`Descriptor`]. Its steady-state term
//! ([`SteadyEffect`]) needs neither `std` nor allocation and works in `f32` or `f64`; its dynamic term
//! ([`Effect`]) lives on the host.

#[cfg(feature = "std")]
mod config;
mod descriptor;
#[cfg(feature = "std")]
mod effect;
#[cfg(feature = "file")]
pub mod expression;
#[cfg(feature = "file")]
mod file;
#[cfg(feature = "file")]
mod motions;
#[cfg(feature = "std")]
mod signals;
#[cfg(feature = "std")]
mod simulate;
#[cfg(feature = "std")]
mod stack;
mod steady;

#[cfg(feature = "std")]
pub use config::{EffectConfig, EffectError};
pub use descriptor::{Applies, Descriptor, Kind, Parameter, Rated, Role, Scale, Written};
#[cfg(feature = "std")]
pub use effect::{At, Cage, Effect, Hook, Instantaneous, Rates};
#[cfg(feature = "file")]
pub(crate) use file::check;
#[cfg(feature = "file")]
pub use file::{from_entry, from_motor_file, rated, to_entry};
#[cfg(feature = "std")]
pub use signals::{Inputs, Outputs};
#[cfg(feature = "std")]
pub use simulate::{Between, Plant, Run, SpeedSource, simulate};
#[cfg(feature = "std")]
pub use stack::{EffectStack, Timeline, extra_states};
pub use steady::{MAX_PARAMETERS, SteadyEffect, SteadyPoint};

/// Registers effects: the file and the type in it.
macro_rules! effects {
    ($($file:ident: $effect:ident),* $(,)?) => {
        $(mod $file;)*

        /// All effects, as the monitor core and the firmware see them.
        pub static STEADY: &[&dyn SteadyEffect] = &[$(&$file::$effect),*];

        /// Types of [`STEADY`], in its order, by name: a program that names one holds its code and no other's.
        pub mod types {
            $(pub use super::$file::$effect;)*
        }

        /// Names in [`types`] of [`STEADY`], in its order.
        #[cfg(feature = "std")]
        pub static TYPES: &[&str] = &[$(stringify!($effect)),*];

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
}

/// The effect of this name and form; an empty form means the effect's first.
#[cfg(feature = "std")]
pub fn find(name: &str, form: &str) -> Option<&'static dyn Effect> {
    let fits = |e: &&&'static dyn Effect| {
        let d = e.descriptor();
        d.name == name && (form.is_empty() || d.form == form)
    };
    ALL.iter().find(fits).copied()
}

/// The steady-state term of this name and form; an empty form means the effect's first.
pub fn find_steady(name: &str, form: &str) -> Option<&'static dyn SteadyEffect> {
    let fits = |e: &&&'static dyn SteadyEffect| {
        let d = e.descriptor();
        d.name == name && (form.is_empty() || d.form == form)
    };
    STEADY.iter().find(fits).copied()
}

/// Names of all effects, each once.
#[cfg(feature = "std")]
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<_> = ALL.iter().map(|e| e.descriptor().name).collect();
    names.dedup();
    names
}
