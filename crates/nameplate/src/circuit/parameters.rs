//! The twelve unknowns of the circuit.

use nalgebra::SVector;

/// How many unknowns the circuit has.
pub const PARAMETERS: usize = 12;

/// Natural logarithms of the unknowns, in the order of [`Place`].
pub type Logs = SVector<f64, PARAMETERS>;

/// The circuit, per unit of rated voltage and rated current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circuit {
    /// Stator resistance at rated load's temperature.
    pub stator_resistance: f64,
    /// Stator leakage reactance, and the leakage reactance common to both cages, at rated current.
    pub leakage: f64,
    /// Magnetizing reactance.
    pub magnetizing: f64,
    /// Resistance of the inner cage `R_1`.
    pub inner_resistance: f64,
    /// How much the outer cage's resistance is above the inner one's, `R_2 - R_1`.
    pub outer_excess: f64,
    /// Leakage reactance of the inner cage beyond the common one, `X_1`.
    pub inner_leakage: f64,
    /// Core-loss conductance across the magnetizing branch.
    pub core_conductance: f64,
    /// Windage and friction torque at rated speed over rated torque.
    pub windage: f64,
    /// Stray-load torque at rated current and speed over rated torque.
    pub stray: f64,
    /// Leakage at infinite current over leakage at rated current.
    pub saturated_leakage: f64,
    /// Resistance in the tests of breakdown and locked rotor over resistance at rated load.
    pub cold_resistance: f64,
    /// True rated slip over the slip of the printed speed.
    pub slip_ratio: f64,
}

/// The place of an unknown in [`Logs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Place {
    /// [`Circuit::stator_resistance`].
    StatorResistance,
    /// [`Circuit::leakage`].
    Leakage,
    /// [`Circuit::magnetizing`].
    Magnetizing,
    /// [`Circuit::inner_resistance`].
    InnerResistance,
    /// [`Circuit::outer_excess`].
    OuterExcess,
    /// [`Circuit::inner_leakage`].
    InnerLeakage,
    /// [`Circuit::core_conductance`].
    CoreConductance,
    /// [`Circuit::windage`].
    Windage,
    /// [`Circuit::stray`].
    Stray,
    /// [`Circuit::saturated_leakage`].
    SaturatedLeakage,
    /// [`Circuit::cold_resistance`].
    ColdResistance,
    /// [`Circuit::slip_ratio`].
    SlipRatio,
}

impl Circuit {
    /// The unknowns as logarithms.
    pub fn logs(&self) -> Logs {
        Logs::from([
            self.stator_resistance,
            self.leakage,
            self.magnetizing,
            self.inner_resistance,
            self.outer_excess,
            self.inner_leakage,
            self.core_conductance,
            self.windage,
            self.stray,
            self.saturated_leakage,
            self.cold_resistance,
            self.slip_ratio,
        ])
        .map(f64::ln)
    }

    /// The circuit of logarithms.
    pub fn from_logs(logs: &Logs) -> Circuit {
        let value = logs.map(f64::exp);
        Circuit {
            stator_resistance: value[0],
            leakage: value[1],
            magnetizing: value[2],
            inner_resistance: value[3],
            outer_excess: value[4],
            inner_leakage: value[5],
            core_conductance: value[6],
            windage: value[7],
            stray: value[8],
            saturated_leakage: value[9],
            cold_resistance: value[10],
            slip_ratio: value[11],
        }
    }

    /// Resistance of the outer cage `R_2`.
    pub fn outer_resistance(&self) -> f64 {
        self.inner_resistance + self.outer_excess
    }
}
