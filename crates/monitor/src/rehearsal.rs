//! Sensor faults that a person tries out on a running motor.

/// Gains put on the d-q signals after the frame is known: 1 in service.
///
/// This is the paper's bench (section 7): sensor faults are switched on the d-q signals. It lets a
/// person rehearse each sensor row of Table 1 on the running motor and see its lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rehearsal {
    /// On the voltage vector.
    pub voltage_gain: f32,
    /// On `I_q`.
    pub current_q_gain: f32,
    /// On the rotor speed.
    pub speed_gain: f32,
}

impl Default for Rehearsal {
    fn default() -> Self {
        Rehearsal {
            voltage_gain: 1.0,
            current_q_gain: 1.0,
            speed_gain: 1.0,
        }
    }
}
