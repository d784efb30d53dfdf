//! Names of lamps and faults, and numbers that JSON has.

/// Names of the lamps, in the order of their bits.
const LAMPS: [&str; 9] = [
    "RUN", "r1", "r2", "r3", "r4", "SENSOR", "LINE", "LOAD", "FAULT",
];

/// Lamps that are on, by name.
pub(super) fn lit_lamps(lamps: u32) -> Vec<String> {
    let all = LAMPS.iter().zip(0..);
    all.filter(|(_, k)| (lamps >> (2 * k)) & 3 == 1)
        .map(|(name, _)| (*name).to_owned())
        .collect()
}

/// Short name of a fault by its number; 0 and unknown numbers have none.
pub(super) fn fault_name(number: u8) -> Option<String> {
    let mut all = motor::FaultId::ALL.into_iter();
    let found = all.find(|fault| number != 0 && fault.number() == u16::from(number));
    found.map(|fault| fault.name().to_owned())
}

/// A number that JSON has.
pub(super) fn finite(value: f32) -> Option<f32> {
    Some(value).filter(|value| value.is_finite())
}
