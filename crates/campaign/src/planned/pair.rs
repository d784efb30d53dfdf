//! Pairs of faults that share a row of the paper's Table 1: what they are called, and which side an answer takes.

use motor::FaultId;

pub(crate) const STATOR_RESISTANCE: &[FaultId] = &[FaultId::StatorResistance];
pub(crate) const ROTOR_RESISTANCE: &[FaultId] = &[FaultId::RotorResistance];
/// The paper's `L_s` is magnetizing inductance and leakage in one.
pub(crate) const STATOR_INDUCTANCE: &[FaultId] = &[
    FaultId::MagnetizingInductance,
    FaultId::Leakage,
    FaultId::StatorInductance,
    FaultId::RotorInductance,
];
pub(crate) const VOLTAGE_SENSORS: &[FaultId] = &[FaultId::VoltageSensor];

/// Two sides of a row of the paper's Table 1, by what the monitor may call each.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    own: &'static [FaultId],
    other: &'static [FaultId],
    /// The other side, as the tables call it.
    pub rival: &'static str,
}

/// How the two sides of a pair stand in an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// The true side is named, and no name of the other is as likely.
    pub right: bool,
    /// The true side is named, and the other not even tied with it.
    pub apart: bool,
}

impl Pair {
    /// `named`: causes from the likeliest on.
    pub fn sides(&self, named: &[FaultId]) -> Sides {
        let place = |side: &[FaultId]| named.iter().position(|fault| side.contains(fault));
        let (own, other) = (place(self.own), place(self.other));
        Sides {
            right: own.is_some_and(|own| other.is_none_or(|other| own < other)),
            apart: own.is_some() && other.is_none(),
        }
    }
}

/// A pair by its two sides, and what tables call the other one.
pub(crate) const fn against(rival: &'static str, [own, other]: [&'static [FaultId]; 2]) -> Pair {
    Pair { own, other, rival }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_takes_the_side_of_its_likeliest_name() {
        let pair = against("V", [STATOR_INDUCTANCE, VOLTAGE_SENSORS]);
        let faults = |named: &str| -> Vec<FaultId> {
            named.split('|').filter_map(FaultId::from_name).collect()
        };
        let sides = |named: &str| {
            let Sides { right, apart } = pair.sides(&faults(named));
            (right, apart)
        };
        assert_eq!(sides("Lm"), (true, true));
        assert_eq!(sides("Rs|leakage"), (true, true));
        assert_eq!(sides("leakage|Vq"), (true, false));
        assert_eq!(sides("Vq|leakage"), (false, false));
        assert_eq!(sides("Vq"), (false, false));
        assert_eq!(sides("Rr"), (false, false), "neither side");
        assert_eq!(sides(""), (false, false));
    }
}
