//! Writing a changed motor file so that the comments of its author survive.

use motor::MotorFile;
use motor::motor_file::{EffectEntry, EffectValue, FieldCurrent, Frame, MonitorSettings};
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, Value, value};

/// The text of `motor`: `old` with its parameters and effects changed where they differ. Comments, order and everything
/// else of `old` stay. A text that cannot be changed in this way is replaced by a fresh one.
pub fn updated(old: &str, motor: &MotorFile) -> String {
    let fresh = motor.to_toml();
    let edited = edited(old, motor).filter(|text| means(text, motor));
    edited.unwrap_or(fresh)
}

/// Whether `text` says what `motor` says.
fn means(text: &str, motor: &MotorFile) -> bool {
    MotorFile::parse(text, "").is_ok_and(|read| read.to_toml() == motor.to_toml())
}

fn edited(old: &str, motor: &MotorFile) -> Option<String> {
    let mut document: DocumentMut = old.parse().ok()?;
    let parameters = document.get_mut("parameters")?.as_table_like_mut()?;
    for (key, number) in numbers(motor) {
        set(parameters.entry(key).or_insert(value(number)), number);
    }
    set_frame(&mut document, motor)?;
    set_sensors(&mut document, motor)?;
    set_thresholds(&mut document, motor)?;
    set_healthy(&mut document, motor)?;
    if !motor.effects.is_empty() {
        let effects = document
            .entry("effects")
            .or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()))
            .as_array_of_tables_mut()?;
        write_effects(effects, &motor.effects);
    }
    Some(document.to_string())
}

fn numbers(motor: &MotorFile) -> [(&'static str, f64); 8] {
    let (electrical, mechanical) = (&motor.parameters, &motor.mechanics);
    [
        ("stator_resistance_ohm", electrical.r_s),
        ("rotor_resistance_ohm", electrical.r_r),
        ("stator_leakage_henry", electrical.l_ls),
        ("rotor_leakage_henry", electrical.l_lr),
        ("magnetizing_inductance_henry", electrical.l_m),
        ("inertia_kg_m2", mechanical.inertia),
        ("friction_nm_s", mechanical.friction),
        ("load_friction_nm_s", mechanical.load_friction),
    ]
}

/// Frame and field current, where the file names them or they are no longer what silence means.
fn set_frame(document: &mut DocumentMut, motor: &MotorFile) -> Option<()> {
    let silence = MonitorSettings::default();
    let frame = match motor.monitor.frame {
        Frame::RotorFlux => "rotor-flux",
        Frame::Voltage => "voltage",
    };
    let field = match motor.monitor.field_current {
        FieldCurrent::Live => "live",
        FieldCurrent::Nominal => "nominal",
    };
    set_word(
        document,
        "frame",
        frame,
        motor.monitor.frame != silence.frame,
    )?;
    let spoken = motor.monitor.field_current != silence.field_current;
    set_word(document, "field_current", field, spoken)
}

/// Gains and delays of the channels, where the file names them or they are no longer what silence means.
fn set_sensors(document: &mut DocumentMut, motor: &MotorFile) -> Option<()> {
    let of = |motor: &MotorFile| {
        let fresh: DocumentMut = motor.to_toml().parse().ok()?;
        let sensors = fresh.get("sensors")?.as_table_like()?;
        let keys = CHANNEL_KEYS.into_iter();
        let named = keys.filter_map(|key| Some((key, sensors.get(key)?.clone())));
        Some(named.collect::<Vec<_>>())
    };
    let before = of(&MotorFile::parse(&document.to_string(), "").ok()?)?;
    for (key, item) in of(motor)? {
        let old = before.iter().find(|(named, _)| *named == key);
        if old.is_some_and(|(_, old)| old.to_string() == item.to_string()) {
            continue;
        }
        let sensors = document
            .entry("sensors")
            .or_insert_with(|| Item::Table(Table::new()))
            .as_table_like_mut()?;
        sensors.insert(key, item);
    }
    Some(())
}

/// What a calibration of the channels changes, and a roll-off that is written beside delays.
const CHANNEL_KEYS: [&str; 5] = [
    "voltage_gain",
    "current_gain",
    "voltage_delay_us",
    "current_delay_us",
    "roll_off_us",
];

/// Thresholds, where the file names them or they are no longer what silence means.
fn set_thresholds(document: &mut DocumentMut, motor: &MotorFile) -> Option<()> {
    let thresholds = motor.monitor.threshold_percent;
    let spoken = thresholds != MonitorSettings::default().threshold_percent;
    let named = document
        .get("monitor")
        .and_then(|monitor| monitor.get("threshold_percent"));
    if !spoken && named.is_none() {
        return Some(());
    }
    let monitor = document
        .entry("monitor")
        .or_insert_with(|| Item::Table(Table::new()))
        .as_table_like_mut()?;
    monitor.insert("threshold_percent", value(Array::from_iter(thresholds)));
    Some(())
}

/// The statistics of the healthy motor come from `calibrate` alone and are replaced as a whole.
fn set_healthy(document: &mut DocumentMut, motor: &MotorFile) -> Option<()> {
    let fresh: DocumentMut = motor.to_toml().parse().ok()?;
    let (old, new) = (document.get("healthy"), fresh.get("healthy"));
    if old.map(ToString::to_string) == new.map(ToString::to_string) {
        return Some(());
    }
    document.remove("healthy");
    if let Some(Item::Table(table)) = new {
        let mut table = table.clone();
        table.set_position(None);
        table
            .decor_mut()
            .set_prefix("\n# Written by `drivemon calibrate`.\n");
        document.insert("healthy", Item::Table(table));
    }
    Some(())
}

fn set_word(document: &mut DocumentMut, key: &str, word: &str, must: bool) -> Option<()> {
    if !must && document.get("monitor").is_none() {
        return Some(());
    }
    let monitor = document
        .entry("monitor")
        .or_insert_with(|| Item::Table(Table::new()))
        .as_table_like_mut()?;
    match monitor.get_mut(key) {
        Some(item) if item.as_str() == Some(word) => {}
        Some(item) => {
            let old = item.as_value_mut()?;
            let around = old.decor().clone();
            *old = Value::from(word);
            *old.decor_mut() = around;
        }
        None if must => {
            monitor.insert(key, value(word));
        }
        None => {}
    }
    Some(())
}

/// A number in place of another, with what stood around it.
fn set(item: &mut Item, number: f64) {
    let Some(old) = item.as_value_mut() else {
        return;
    };
    if old.as_float() == Some(number) {
        return;
    }
    let around = old.decor().clone();
    let mut new = Value::from(number);
    *new.decor_mut() = around;
    *old = new;
}

/// The entries in the order of `effects`: old ones with what stood around them, new ones behind.
fn write_effects(tables: &mut ArrayOfTables, effects: &[EffectEntry]) {
    let mut old: Vec<Table> = tables.iter().cloned().collect();
    tables.clear();
    for effect in effects {
        let found = old.iter().position(|table| is_same(table, effect));
        let mut table = found.map_or_else(|| empty(&effect.name), |k| old.remove(k));
        // Where it stands follows from its place in the list, no longer from the old text.
        table.set_position(None);
        write_effect(&mut table, effect);
        tables.push(table);
    }
}

/// Whether an entry is this effect, in this form or with this formula.
fn is_same(table: &Table, effect: &EffectEntry) -> bool {
    let texts = table
        .iter()
        .filter_map(|(key, item)| Some((key, item.as_str()?)));
    texts.into_iter().all(|(key, text)| match key {
        "name" => effect.name == text,
        _ => effect.text(key) == Some(text),
    })
}

fn empty(name: &str) -> Table {
    let mut table = Table::new();
    table.decor_mut().set_prefix("\n");
    table.insert("name", value(name));
    table
}

fn write_effect(table: &mut Table, effect: &EffectEntry) {
    table.retain(|key, _| key == "name" || effect.parameter(key).is_some());
    for parameter in &effect.parameters {
        let key = parameter.key.as_str();
        match &parameter.value {
            EffectValue::Number(number) => {
                set(table.entry(key).or_insert(value(*number)), *number);
            }
            EffectValue::Text(text) => {
                table.entry(key).or_insert(value(text.as_str()));
            }
            EffectValue::List(numbers) => {
                let list: toml_edit::Array = numbers.iter().copied().collect();
                table.insert(key, value(list));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OLD: &str = include_str!("../../../motors/peer-2k2.toml");

    fn adopted() -> MotorFile {
        let mut motor = MotorFile::parse(OLD, "old").unwrap();
        motor.parameters.r_s = 3.912_345;
        let numbers = [("core_loss_resistance_ohm", 980.0)];
        motor
            .effects
            .push(EffectEntry::with_numbers("core-loss", numbers));
        motor
    }

    #[test]
    fn comments_survive_and_the_new_text_says_what_was_adopted() {
        let old = OLD.replacen("[parameters]", "# measured on a Monday\n[parameters]", 1);
        let text = updated(&old, &adopted());
        assert!(text.contains("# measured on a Monday"));
        for comment in OLD.lines().filter(|line| line.starts_with('#')) {
            assert!(text.contains(comment), "{comment}");
        }
        let read = MotorFile::parse(&text, "new").unwrap();
        assert_eq!(read.parameters, adopted().parameters);
        assert_eq!(
            read.effects[0].number("core_loss_resistance_ohm"),
            Some(980.0)
        );
    }

    #[test]
    fn gains_and_delays_of_the_channels_are_written_where_the_file_names_its_sensors() {
        let mut motor = MotorFile::parse(OLD, "old").unwrap();
        motor.sensors.voltage_gain = [1.001, 0.998, 1.0];
        motor.sensors.current_delay_s = [88.1e-6, 86.9e-6, 85.7e-6];
        let text = updated(OLD, &motor);
        assert!(
            text.contains("voltage_gain = [1.001, 0.998, 1.0]"),
            "{text}"
        );
        assert!(
            text.contains("current_delay_us = [88.1, 86.9, 85.7]"),
            "{text}"
        );
        assert!(means(&text, &motor));
        let comment = OLD.lines().find(|line| line.starts_with('#')).unwrap();
        assert!(text.contains(comment));
        // And back: what is named stays named.
        let again = updated(&text, &MotorFile::parse(OLD, "old").unwrap());
        assert!(means(&again, &MotorFile::parse(OLD, "old").unwrap()));
    }

    #[test]
    fn another_frame_is_written_where_the_old_one_stood() {
        let old = format!(
            "{OLD}\n[monitor]\nframe = \"voltage\" # as published\nfield_current = \"nominal\"\n"
        );
        let mut motor = MotorFile::parse(&old, "old").unwrap();
        motor.monitor.frame = Frame::RotorFlux;
        motor.monitor.field_current = FieldCurrent::Live;
        let text = updated(&old, &motor);
        assert!(text.contains("frame = \"rotor-flux\" # as published"));
        let read = MotorFile::parse(&text, "new").unwrap();
        assert_eq!(read.monitor, motor.monitor);
    }

    #[test]
    fn a_second_adoption_changes_the_first_effect_in_place() {
        let first = updated(OLD, &adopted());
        let mut again = adopted();
        again.effects[0].parameters[0].value = EffectValue::Number(1020.5);
        let text = updated(&first, &again);
        assert_eq!(text.matches("[[effects]]").count(), 1);
        assert!(text.contains("core_loss_resistance_ohm = 1020.5"));
    }

    const TWO_FORMULAS: &str = "
# twice a turn
[[effects]]
name = \"expression\"
formula = \"a * cos(2 * theta)\"  # two pistons
adds_to = \"torque\"
a = 0.0  # open
a_typical = 1.0

# a fan
[[effects]]
name = \"expression\"
formula = \"b * omega^3\"
adds_to = \"torque\"
b = 1e-6  # from its data sheet
";

    /// As `discovery::adopt` leaves it: the open formula fitted, behind the other.
    #[test]
    fn comments_survive_beside_each_of_several_formulas() {
        let old = OLD.to_owned() + TWO_FORMULAS;
        let mut motor = MotorFile::parse(&old, "old").unwrap();
        let mut fitted = motor.effects.remove(0);
        fitted.parameters.retain(|p| p.key != "a_typical");
        let a = fitted.parameters.iter_mut().find(|p| p.key == "a").unwrap();
        a.value = EffectValue::Number(5.5);
        motor.effects.push(fitted);
        let text = updated(&old, &motor);
        for kept in [
            "# twice a turn",
            "# two pistons",
            "# a fan",
            "# from its data sheet",
            "a = 5.5  # open",
        ] {
            assert!(text.contains(kept), "{kept} is lost:\n{text}");
        }
        let read = MotorFile::parse(&text, "new").unwrap();
        assert_eq!(read.to_toml(), motor.to_toml());
        assert!(text.find("# a fan") < text.find("# twice a turn"), "{text}");
    }

    #[test]
    fn a_text_that_cannot_be_edited_is_written_afresh() {
        let text = updated("not a motor file", &adopted());
        assert_eq!(text, adopted().to_toml());
    }

    const CALIBRATED: &str = include_str!("../../../motors/assumed-300w-calibrated.toml");

    /// A calibration moves parameters and thresholds and writes `[healthy]`; effects come behind it.
    #[test]
    fn comments_survive_a_calibration() {
        let old = OLD.replacen(
            "stator_resistance_ohm = 3.7",
            "stator_resistance_ohm = 3.7 # cold",
            1,
        );
        assert_ne!(old, OLD, "the motor file says it otherwise");
        let mut motor = MotorFile::parse(&old, "old").unwrap();
        motor.parameters.r_s = 3.75;
        motor.monitor.threshold_percent = [1.0, 2.0, 3.0, 4.5];
        motor.healthy = MotorFile::parse(CALIBRATED, "calibrated").unwrap().healthy;
        assert!(motor.healthy.is_some());
        let text = updated(&old, &motor);
        for comment in old.lines().filter(|line| line.starts_with('#')) {
            assert!(text.contains(comment), "{comment}");
        }
        assert!(
            text.contains("stator_resistance_ohm = 3.75 # cold"),
            "{text}"
        );
        assert_eq!(text.matches("[healthy]").count(), 1);
        let read = MotorFile::parse(&text, "new").unwrap();
        assert_eq!(read.healthy, motor.healthy);
        assert_eq!(read.monitor, motor.monitor);
        assert_eq!(
            updated(&text, &motor),
            text,
            "a second writing changes nothing"
        );
    }

    #[test]
    fn a_second_calibration_replaces_the_first() {
        let mut motor = MotorFile::parse(CALIBRATED, "first").unwrap();
        motor.healthy.as_mut().unwrap().significance = 6.25;
        let text = updated(CALIBRATED, &motor);
        assert_eq!(text.matches("[healthy]").count(), 1);
        assert_eq!(text.matches("Written by `drivemon calibrate`").count(), 1);
        assert!(text.contains("significance = 6.25"));
        assert_eq!(
            MotorFile::parse(&text, "second").unwrap().healthy,
            motor.healthy
        );
    }

    #[test]
    fn an_adopted_effect_keeps_the_calibration() {
        let mut motor = MotorFile::parse(CALIBRATED, "calibrated").unwrap();
        let numbers = [("core_loss_resistance_ohm", 980.0)];
        motor
            .effects
            .push(EffectEntry::with_numbers("core-loss", numbers));
        let text = updated(CALIBRATED, &motor);
        for line in CALIBRATED.lines() {
            assert!(text.contains(line), "{line} is lost");
        }
        let read = MotorFile::parse(&text, "adopted").unwrap();
        assert_eq!(read.healthy, motor.healthy);
        assert_eq!(read.effects[0].name, "core-loss");
    }
}
