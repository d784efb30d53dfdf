//! A plate as a TOML file: digits count, so numbers are read as they are written.

use toml_edit::{Item, Value};

use super::code_letter::kva_per_horsepower;
use super::{DcResistance, Plate, Printed};
use crate::estimate::COLUMN_KEYS;

/// One horsepower, kW.
pub const HORSEPOWER_KW: f64 = 0.745_699_9;

/// A plate with what else is known of the motor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlateFile {
    /// What people call the motor.
    pub name: Option<String>,
    /// The numbers of the plate.
    pub plate: Plate,
    /// Whether the windings are in delta.
    pub delta: bool,
    /// Inertia of everything on the shaft, kg m2.
    pub inertia_kg_m2: Option<f64>,
    /// Bars of the cage.
    pub rotor_bars: Option<u32>,
}

/// Keys of a plate's file beyond [`COLUMN_KEYS`].
pub const EXTRA_KEYS: [&str; 8] = [
    "name",
    "connection",
    "power_hp",
    "nema_code",
    "inertia_kg_m2",
    "rotor_bars",
    "dc_resistance_ohm",
    "dc_resistance_degc",
];

impl PlateFile {
    /// Reads a plate; `label` is the name that errors print.
    ///
    /// # Errors
    /// Broken TOML, an unknown key, or a value that is no number, each with its line.
    pub fn parse(text: &str, label: &str) -> Result<PlateFile, String> {
        let document: toml_edit::Document<&str> =
            toml_edit::Document::parse(text).map_err(|error| format!("{label}: {error}"))?;
        let mut file = PlateFile::default();
        for (key, item) in document.iter() {
            let line = item
                .span()
                .map_or(0, |span| text[..span.start].matches('\n').count() + 1);
            file.set(key, &raw(item, text))
                .map_err(|problem| format!("{label}:{line}: {key}: {problem}"))?;
        }
        Ok(file)
    }

    /// Sets one key from its text, as a file or a flag has it.
    ///
    /// # Errors
    /// An unknown key, or a text that is no value of it.
    pub fn set(&mut self, key: &str, text: &str) -> Result<(), String> {
        let number = || text.parse::<Printed>().map_err(|error| error.to_string());
        match key {
            "name" => self.name = Some(text.to_owned()),
            "connection" => {
                self.delta = match text {
                    "star" | "wye" | "Y" => false,
                    "delta" | "D" => true,
                    _ => return Err(format!("\"{text}\" is neither \"star\" nor \"delta\"")),
                }
            }
            "power_hp" => self.plate.power_kw = Some(number()?.times(HORSEPOWER_KW)),
            "inertia_kg_m2" => self.inertia_kg_m2 = Some(number()?.value),
            "rotor_bars" => self.rotor_bars = Some(bars(text)?),
            "dc_resistance_ohm" => self.dc_resistance().terminals_ohm = number()?.value,
            "dc_resistance_degc" => self.dc_resistance().winding_degc = degrees(text)?,
            "nema_code" => self.set_code(text)?,
            _ => {
                let Some(place) = COLUMN_KEYS.iter().position(|known| *known == key) else {
                    let known = [&COLUMN_KEYS[..], &EXTRA_KEYS[..]].concat().join(", ");
                    return Err(format!("unknown; a plate has {known}"));
                };
                let number = number()?;
                if let Some(slot) = self.plate.places().into_iter().nth(place) {
                    *slot = Some(number);
                }
            }
        }
        Ok(())
    }

    /// The measured resistance, at room temperature until it is told.
    fn dc_resistance(&mut self) -> &mut DcResistance {
        self.plate.dc_resistance.get_or_insert(DcResistance {
            terminals_ohm: f64::NAN,
            winding_degc: ROOM_DEGC,
        })
    }

    /// The locked-rotor current of a code letter; power, voltage and current must be set before.
    fn set_code(&mut self, text: &str) -> Result<(), String> {
        let mut letters = text.chars();
        let per_horsepower = match (letters.next(), letters.next()) {
            (Some(letter), None) => kva_per_horsepower(letter),
            _ => None,
        };
        let per_horsepower = per_horsepower.ok_or_else(|| {
            format!("\"{text}\" is no NEMA code letter; they are A to V without I, O and Q")
        })?;
        let plate = &self.plate;
        let (Some(power), Some(voltage), Some(current)) =
            (plate.power_kw, plate.voltage_volt, plate.current_amp)
        else {
            return Err("write it below power, voltage_volt and current_amp, from which the current follows".to_owned());
        };
        let apparent_kva = 3f64.sqrt() * voltage.value * current.value / 1000.0;
        let horsepower = power.value / HORSEPOWER_KW;
        self.plate.locked_rotor_current_ratio =
            Some(per_horsepower.times(horsepower / apparent_kva));
        Ok(())
    }
}

/// Temperature of a winding that has stood for a day.
const ROOM_DEGC: f64 = 20.0;
/// Temperatures that a winding may have, degC.
const WINDINGS_DEGC: [f64; 2] = [-50.0, 200.0];

fn bars(text: &str) -> Result<u32, String> {
    let bars = text.trim().parse::<u32>().ok();
    bars.filter(|bars| (5..=400).contains(bars))
        .ok_or_else(|| format!("\"{text}\" is no whole number of 5 to 400 bars"))
}

fn degrees(text: &str) -> Result<f64, String> {
    let [low, high] = WINDINGS_DEGC;
    let degrees = text.trim().parse::<f64>().ok();
    degrees
        .filter(|x| (low..=high).contains(x))
        .ok_or_else(|| format!("\"{text}\" is outside {low}..{high} degC"))
}

/// The digits of a number, or the text inside quotes.
fn raw(item: &Item, text: &str) -> String {
    match item.as_value() {
        Some(Value::String(quoted)) => quoted.value().clone(),
        _ => item
            .span()
            .map_or(String::new(), |span| text[span].trim().to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PUMP: &str = "name = \"Pump 3\"\npower_kw = 5.5\nvoltage_volt = 400\nfrequency_hz = 50\nspeed_rpm = 1455\ncurrent_amp = 10.40\npower_factor = 0.850\nconnection = \"delta\"\n";

    #[test]
    fn digits_count() {
        let file = PlateFile::parse(PUMP, "plate.toml").unwrap();
        assert_eq!(file.name.as_deref(), Some("Pump 3"));
        assert!(file.delta);
        assert!((file.plate.power_factor.unwrap().half_step - 0.0005).abs() < 1e-15);
        assert!((file.plate.current_amp.unwrap().half_step - 0.005).abs() < 1e-15);
    }

    #[test]
    fn wrong_lines_are_named() {
        let cases = [
            (
                "power_kw = 5.5",
                "power_kw = -5.5",
                "plate.toml:2: power_kw",
            ),
            (
                "speed_rpm = 1455",
                "rpm = 1455",
                "plate.toml:5: rpm: unknown",
            ),
            ("\"delta\"", "\"triangle\"", "plate.toml:8: connection"),
            (
                "power_kw = 5.5",
                "power_kw = ",
                "plate.toml: TOML parse error at line 2",
            ),
        ];
        for (old, new, told) in cases {
            let error = PlateFile::parse(&PUMP.replace(old, new), "plate.toml").unwrap_err();
            assert!(error.contains(told), "{error}");
        }
    }

    #[test]
    fn a_code_letter_is_a_current() {
        // 5.5 kW are 7.376 hp; G is 5.95 kVA/hp: 43.9 kVA over 7.205 kVA.
        let file = PlateFile::parse(&format!("{PUMP}nema_code = \"G\"\n"), "p").unwrap();
        let ratio = file.plate.locked_rotor_current_ratio.unwrap();
        assert!((ratio.value - 6.09).abs() < 0.01 && (ratio.relative() - 0.35 / 5.95).abs() < 1e-9);
    }
}
