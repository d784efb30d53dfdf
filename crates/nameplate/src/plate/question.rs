//! What a plate is asked for: the same questions in the terminal and in the panel.

/// Which plates print a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Printing {
    /// Every plate.
    Every,
    /// Plates after IEC 60034.
    Iec,
    /// Plates after NEMA MG 1.
    Nema,
    /// None: catalogue, test sheet or a measurement.
    Elsewhere,
}

/// One question about a plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Question {
    /// Key in a plate's file.
    pub key: &'static str,
    /// What is asked.
    pub words: &'static str,
    /// Unit; empty for ratios and words.
    pub unit: &'static str,
    /// Usual range.
    pub range: &'static str,
    /// What a missing answer costs.
    pub missing: &'static str,
    /// Where the number stands.
    pub printing: Printing,
}

const fn question(
    printing: Printing,
    key: &'static str,
    [words, unit, range, missing]: [&'static str; 4],
) -> Question {
    Question {
        key,
        words,
        unit,
        range,
        missing,
        printing,
    }
}

/// All questions, in the order in which they are asked; a code letter comes behind what it needs.
pub const QUESTIONS: [Question; 18] = [
    question(
        Printing::Elsewhere,
        "name",
        [
            "Name of the motor",
            "",
            "what people call it",
            "its power and poles",
        ],
    ),
    question(
        Printing::Iec,
        "power_kw",
        ["Rated power", "kW", "0.05 to 2000", "needed"],
    ),
    question(
        Printing::Nema,
        "power_hp",
        ["Rated power", "hp", "0.07 to 2700", "needed"],
    ),
    question(
        Printing::Every,
        "voltage_volt",
        ["Line voltage", "V", "200 to 11000", "needed"],
    ),
    question(
        Printing::Every,
        "frequency_hz",
        ["Frequency", "Hz", "50 or 60", "follows from the speed"],
    ),
    question(
        Printing::Every,
        "speed_rpm",
        [
            "Rated speed",
            "rpm",
            "below 3000, 1500, 1000 at 50 Hz; below 3600, 1800, 1200 at 60 Hz",
            "rotor resistance is then known to a factor of two",
        ],
    ),
    question(
        Printing::Every,
        "current_amp",
        [
            "Rated current",
            "A",
            "about 2 per kW at 400 V",
            "follows from efficiency and power factor",
        ],
    ),
    question(
        Printing::Every,
        "power_factor",
        [
            "Power factor (cos phi)",
            "",
            "0.6 to 0.93",
            "follows from current and efficiency",
        ],
    ),
    question(
        Printing::Every,
        "efficiency_percent",
        [
            "Efficiency",
            "percent",
            "60 to 97",
            "follows from current and power factor",
        ],
    ),
    question(
        Printing::Every,
        "connection",
        [
            "Connection, star or delta",
            "",
            "as wired",
            "star: the circuit is the same, per equivalent star phase",
        ],
    ),
    question(
        Printing::Nema,
        "nema_code",
        [
            "Code letter",
            "",
            "A to V",
            "locked-rotor current is known to 40 %",
        ],
    ),
    question(
        Printing::Elsewhere,
        "breakdown_torque_ratio",
        [
            "Breakdown torque / rated torque",
            "",
            "1.8 to 4",
            "known to 50 % from motors of this size",
        ],
    ),
    question(
        Printing::Elsewhere,
        "locked_rotor_torque_ratio",
        [
            "Locked-rotor torque / rated torque",
            "",
            "0.7 to 4",
            "known to 70 %",
        ],
    ),
    question(
        Printing::Elsewhere,
        "locked_rotor_current_ratio",
        [
            "Locked-rotor current / rated current",
            "",
            "3.5 to 10",
            "known to 40 %",
        ],
    ),
    question(
        Printing::Elsewhere,
        "dc_resistance_ohm",
        [
            "Resistance between two terminals",
            "ohm",
            "measured with direct current",
            "nothing else narrows the stator resistance as much",
        ],
    ),
    question(
        Printing::Elsewhere,
        "dc_resistance_degc",
        [
            "Temperature of the winding then",
            "degC",
            "\u{2212}50 to 200",
            "20 degC",
        ],
    ),
    question(
        Printing::Elsewhere,
        "rotor_bars",
        [
            "Number of rotor bars",
            "",
            "20 to 100, from the maker",
            "without an encoder the speed then comes from the circuit, less sure",
        ],
    ),
    question(
        Printing::Elsewhere,
        "inertia_kg_m2",
        [
            "Inertia of everything on the shaft",
            "kg m2",
            "the rotor's and the load's",
            "that of rotors of this size",
        ],
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plate::{EXTRA_KEYS, PlateFile};
    use crate::{COLUMN_KEYS, Estimate};

    #[test]
    fn every_key_of_a_plate_is_asked_once() {
        let mut asked: Vec<&str> = QUESTIONS.iter().map(|question| question.key).collect();
        let mut known = [&COLUMN_KEYS[..], &EXTRA_KEYS[..]].concat();
        asked.sort_unstable();
        known.sort_unstable();
        assert_eq!(asked, known);
    }

    #[test]
    fn what_is_needed_is_enough() {
        let mut file = PlateFile::default();
        for (key, text) in [
            ("power_kw", "5.5"),
            ("voltage_volt", "400"),
            ("frequency_hz", "50"),
        ] {
            file.set(key, text).unwrap();
        }
        assert!(Estimate::of(&file.plate).is_ok());
    }
}
