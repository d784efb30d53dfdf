//! Which motors can be judged in motion, and with which constants.

use monitor::{ActiveEffect, FieldCurrent, InMotion, LoadKind, MonitorConfig};

use crate::circuit::{Circuit, Iron, Scales};
use crate::decision::Limits;
use crate::departures::{Priors, place};
use crate::{KnownLoad, Motion, rated_step};

/// Why a motor cannot be judged in motion at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoMotion {
    /// Without a calibration nothing says how far the parameters may be off.
    NotCalibrated,
    /// The motor file holds an effect or a law that the flux equations in motion do not have; its name.
    Effect(&'static str),
    /// The motor file asks for the published instrument with its constant field current.
    NominalField,
    /// Fewer samples a cycle than the flux equations need.
    SampledTooSlowly,
    /// In good order the motor moved otherwise than its file says.
    Differs,
    /// Channels are late by times that are further apart than a sample.
    ChannelsApart,
}

impl core::fmt::Display for NoMotion {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            NoMotion::NotCalibrated => f.write_str(
                "the motor is not calibrated, so nothing says how far its parameters may be off (drivemon calibrate)",
            ),
            NoMotion::Effect(name) => {
                write!(f, "the motor file's {name} is not in the equations of motion")
            }
            NoMotion::NominalField => f.write_str("the motor file takes a constant field current"),
            NoMotion::Differs => f.write_str(
                "in good order it moved otherwise than its file says: an effect is missing there, and drivemon explain \
                 says which; then calibrate again",
            ),
            NoMotion::ChannelsApart => {
                f.write_str("channels are late by times that are more than a sample apart")
            }
            NoMotion::SampledTooSlowly => {
                f.write_str("it takes 80 samples a cycle: record at 5 kHz or more")
            }
        }
    }
}

/// Limits of the decision. `T` is a sum of many cycles with unit variance on a healthy motor; 17 causes and 50 cycles a second
/// are tried, and the rest of the margin is for what the T model lacks.
const LIMITS: Limits = Limits {
    statistic: 6.5,
    square: 75.0,
};
/// Fewest samples of a rated cycle: the trapezoidal rule is then off by 5e-4.
const LEAST_SAMPLES: f32 = 80.0;
/// Length of a part of a cycle, s.
const PART_S: f32 = 1e-3;
/// Saturation that a motor may have whose file declares none, and how far that moves its mean magnetizing inductance.
const ANY_IRON: f32 = 0.15;
const ANY_MAGNETIZING: f32 = 0.02;

impl Motion {
    /// Prepares a motor whose configuration is valid.
    ///
    /// # Errors
    /// Why it cannot be judged in motion.
    #[inline(never)]
    pub fn new(config: &MonitorConfig) -> Result<Motion, NoMotion> {
        if config.field != FieldCurrent::Live {
            return Err(NoMotion::NominalField);
        }
        let circuit = circuit(config)?;
        let samples = circuit.cycle_samples();
        if samples < LEAST_SAMPLES {
            return Err(NoMotion::SampledTooSlowly);
        }
        let healthy = config.healthy.as_ref().ok_or(NoMotion::NotCalibrated)?;
        if healthy.in_motion == InMotion::Differs {
            return Err(NoMotion::Differs);
        }
        let mut priors = Priors::of(&healthy.uncertainty);
        if circuit.iron == Iron::LINEAR {
            priors.widen(place::IRON, ANY_IRON);
            priors.widen(place::L_M, ANY_MAGNETIZING);
        }
        Ok(Motion {
            priors,
            limits: LIMITS,
            channel_gain: config.channel_gain,
            per_count: core::f32::consts::TAU * config.mechanics.n_p
                / config.encoder_counts_per_revolution,
            samples,
            part: libm::roundf(PART_S / config.t_sample).max(1.0),
            step: rated_step(config.rated_omega, config.t_sample),
            load: match config.load {
                LoadKind::Friction => KnownLoad::Friction,
                LoadKind::Measured => KnownLoad::Measured,
                LoadKind::Free => KnownLoad::Nothing,
            },
            circuit,
            is_doubted: healthy.in_motion == InMotion::Unseen,
        })
    }
}

fn circuit(config: &MonitorConfig) -> Result<Circuit, NoMotion> {
    if config.laws.iter().flatten().next().is_some() {
        return Err(NoMotion::Effect("curve"));
    }
    let mut circuit = Circuit {
        params: config.params,
        iron: Iron::LINEAR,
        mechanics: config.mechanics,
        friction: match config.load {
            LoadKind::Friction => config.mechanics.total_friction(),
            LoadKind::Measured | LoadKind::Free => config.mechanics.friction,
        },
        rated: Scales {
            voltage: config.rated_voltage,
            current: config.rated_current,
            omega: config.rated_omega,
            torque: config.rated_torque,
        },
        t_sample: config.t_sample,
    };
    for active in config.effects.iter().flatten() {
        adopt(&mut circuit, active)?;
    }
    Ok(circuit)
}

fn adopt(circuit: &mut Circuit, active: &ActiveEffect) -> Result<(), NoMotion> {
    match active.effect.descriptor().name {
        // Their corrections are among the gains of the channels.
        "phase-voltage-gain" | "phase-current-gain" => Ok(()),
        "magnetizing-saturation" => {
            let [saturation, exponent, location, ..] = active.parameters;
            circuit.iron = Iron {
                saturation,
                exponent,
            };
            move_leakage(circuit, location);
            Ok(())
        }
        name => Err(NoMotion::Effect(name)),
    }
}

/// Part of the stator's leakage lies behind the iron that saturates; at its terminals the linear motor stays the same.
fn move_leakage(circuit: &mut Circuit, location: f32) {
    let p = circuit.params;
    let l_ls = (1.0 - location) * p.l_ls;
    let l_m = p.l_s() - l_ls;
    let k = l_m / p.l_m;
    circuit.params.l_ls = l_ls;
    circuit.params.l_m = l_m;
    circuit.params.r_r = k * k * p.r_r;
    circuit.params.l_lr = k * k * p.l_r() - l_m;
}
