//! What a calibration learned about the healthy motor and its instrument.

use motor::InMotion;

use super::range::{Added, CalibratedRange, length};
use crate::config::{ConfigError, check_range};

/// Rows of evidence.
pub const ROWS: usize = 9;

/// The rows, each relative to its own scale.
///
/// Negative and zero sequence are complex and take two rows each: real and imaginary part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Row {
    /// Torque balance: `r2` of (37) with the inertia's term of (36).
    Torque = 0,
    /// `e_d`: rotor flux against `L_m I_d`.
    Flux = 1,
    /// `e_q`: slip against the rotor's resistance.
    Slip = 2,
    /// `(V_2 - Z_2 I_2)/V_1`; with currents alone `I_2/I_1`.
    Negative = 3,
    /// `I_0/I_1`.
    ZeroCurrent = 5,
    /// `V_0/V_1`.
    ZeroVoltage = 7,
}

/// Standard uncertainties of what the evidence rests on, as shares of the values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Uncertainty {
    /// Stator resistance, off the direction of heating.
    pub stator_resistance: f32,
    /// Rotor resistance, off the direction of heating.
    pub rotor_resistance: f32,
    /// Both resistances together: the range of winding temperature, 0.39 % per kelvin.
    pub heating: f32,
    /// Magnetizing inductance.
    pub magnetizing_inductance: f32,
    /// Leakage inductances.
    pub leakage: f32,
    /// Friction of motor and load.
    pub friction: f32,
    /// Gain of each current channel.
    pub current_gain: f32,
    /// Gain of each voltage channel.
    pub voltage_gain: f32,
    /// Speed measurement.
    pub speed: f32,
    /// Current that feeds the losses of the iron at rated voltage, of rated current.
    pub iron_loss: f32,
    /// Unbalance of the supply from one time to another, where no voltages are measured.
    pub supply_unbalance: f32,
    /// Impedance of the negative sequence: deep bars make it differ from the T model's.
    pub negative_impedance: f32,
}

/// Statistics of the healthy motor. Shares of the scales of [`Row`]; a row whose scatter is 0 was not calibrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Healthy {
    /// What the healthy motor shows.
    pub mean: [f32; ROWS],
    /// How much that scatters from window to window and from load to load.
    pub scatter: [f32; ROWS],
    /// `I_2/I_1` of the healthy motor where only currents are measured: real and imaginary part.
    pub current_unbalance: [f32; 2],
    /// Its scatter; 0 if it was not calibrated.
    pub current_unbalance_scatter: f32,
    /// Positive sequence of the currents at which it was learnt, of rated current; 0: not said.
    pub current_unbalance_at: f32,
    /// What the supply's negative sequence dropped over the motor's impedance where the mean was learnt, `Z_2 I_2/V_1`: real and imaginary
    /// part.
    pub negative_drop: [f32; 2],
    /// Direction of a shorted turn's current seen from the motor's current, real and imaginary part, of length 1: it leads
    /// by the angle that the motor's current lags its voltage.
    pub turns_axis: [f32; 2],
    /// What remains uncertain.
    pub uncertainty: Uncertainty,
    /// Where the calibration saw the motor; `None` where the motor file does not say.
    pub range: Option<CalibratedRange>,
    /// Standard deviations at which FAULT lights, > 0.
    pub significance: f32,
    /// How the motor in good order moved, beside how its file says.
    pub in_motion: InMotion,
}

impl Uncertainty {
    /// The same where more is uncertain.
    pub(super) fn and(&self, added: &Added) -> Self {
        Uncertainty {
            stator_resistance: length([self.stator_resistance, added.stator_resistance]),
            rotor_resistance: length([self.rotor_resistance, added.rotor_resistance]),
            magnetizing_inductance: length([
                self.magnetizing_inductance,
                added.magnetizing_inductance,
            ]),
            leakage: length([self.leakage, added.leakage]),
            ..*self
        }
    }

    fn shares(&self) -> [f32; 12] {
        [
            self.stator_resistance,
            self.rotor_resistance,
            self.heating,
            self.magnetizing_inductance,
            self.leakage,
            self.friction,
            self.current_gain,
            self.voltage_gain,
            self.speed,
            self.iron_loss,
            self.supply_unbalance,
            self.negative_impedance,
        ]
    }
}

impl Healthy {
    #[inline(never)]
    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        let signed = [-10.0, 10.0];
        let share = [0.0, 10.0];
        let unbalance = [self.current_unbalance_scatter, self.current_unbalance_at];
        let uncertainty = self.uncertainty.shares();
        let significance = [self.significance];
        let all: [(&str, &[f32], [f32; 2]); 8] = [
            ("healthy.mean", &self.mean, signed),
            ("healthy.scatter", &self.scatter, share),
            ("healthy.current_unbalance", &self.current_unbalance, signed),
            ("healthy.current_unbalance", &unbalance, share),
            ("healthy.negative_drop", &self.negative_drop, signed),
            ("healthy.turns_axis", &self.turns_axis, [-1.01, 1.01]),
            ("healthy.uncertainty", &uncertainty, share),
            ("healthy.significance", &significance, [1.0, 1000.0]),
        ];
        for (name, values, range) in all {
            values
                .iter()
                .try_for_each(|value| check_range((name, *value, range)))?;
        }
        self.range
            .as_ref()
            .map_or(Ok(()), CalibratedRange::validate)
    }
}

impl Healthy {
    /// Nothing known yet: evidence against it is what the windows show.
    pub fn unknown() -> Self {
        Healthy {
            mean: [0.0; ROWS],
            scatter: [1.0; ROWS],
            current_unbalance: [0.0; 2],
            current_unbalance_scatter: 1.0,
            current_unbalance_at: 0.0,
            negative_drop: [0.0; 2],
            turns_axis: [1.0, 0.0],
            uncertainty: Uncertainty::default(),
            range: None,
            significance: 1000.0,
            in_motion: InMotion::Unseen,
        }
    }
}
