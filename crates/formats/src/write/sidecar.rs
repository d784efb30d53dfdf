//! Sidecars: what is known of a recording, and how its file is read.

use recording::{
    ColumnMap, DateOrder, Factor, LoadTorque, Mapping, Metadata, Recording, Sensors, StartsFrom,
    Supply, Target, UnknownScale, VoltageKind,
};
use std::fmt::Write as _;

/// A sidecar that reads back to the same metadata.
pub fn sidecar_text(metadata: &Metadata) -> String {
    let mut text = String::new();
    let mut word = |key: &str, value: &str| {
        let _ = writeln!(text, "{key} = {}", toml::Value::from(value));
    };
    word("voltage", voltage_word(metadata.voltage));
    word("supply", supply_word(metadata.supply));
    if !metadata.supply_belief.trim().is_empty() {
        word("supply_belief", &metadata.supply_belief);
    }
    if let Some(load) = load_word(metadata.load_torque) {
        word("load_torque", load);
    }
    word("starts_from", starts_word(metadata.starts_from));
    sensors_text(&mut text, &metadata.sensors, &[]);
    text
}

/// The sidecar with which a recording's file is read again in the same way, without flags.
pub fn reading_text(recording: &Recording) -> String {
    let reading = &recording.reading;
    let metadata = sidecar_text(&Metadata {
        sensors: Sensors::default(),
        ..recording.metadata.clone()
    });
    let mut text = metadata + &layout_text(reading);
    let mut sensors = recording.metadata.sensors.clone();
    let pulses = reading.encoder_pulses_per_revolution;
    sensors.encoder_pulses_per_revolution = pulses.or(sensors.encoder_pulses_per_revolution);
    let scales: Vec<(String, &str)> = reading
        .columns
        .iter()
        .filter_map(|(target, map)| Some((target.to_string(), map.sensor.as_ref()?.text())))
        .collect();
    sensors_text(&mut text, &sensors, &scales);
    text + &columns_text(reading)
}

fn layout_text(reading: &Mapping) -> String {
    let mut text = String::new();
    let mut key = |key: &str, value: Option<toml::Value>| {
        if let Some(value) = value {
            let _ = writeln!(text, "{key} = {value}");
        }
    };
    let word = |text: String| toml::Value::from(text);
    let separator = reading.delimiter.map(|byte| match byte {
        b'\t' => "tab".to_owned(),
        b' ' => "space".to_owned(),
        byte => char::from(byte).to_string(),
    });
    key("delimiter", separator.map(word));
    key(
        "decimal_comma",
        reading.decimal_comma.map(toml::Value::from),
    );
    let mark = |mark: Option<char>| match mark {
        None => "none".to_owned(),
        Some(' ') => "space".to_owned(),
        Some(mark) => mark.to_string(),
    };
    key("thousands", reading.thousands.map(mark).map(word));
    let order = |order| match order {
        DateOrder::DayFirst => "dmy".to_owned(),
        DateOrder::MonthFirst => "mdy".to_owned(),
    };
    key("date_order", reading.date_order.map(order).map(word));
    key(
        "sample_rate_hz",
        reading.sample_rate_hz.map(toml::Value::from),
    );
    key("skip_missing", reading.skip_missing.map(toml::Value::from));
    key(
        "line_voltages",
        reading.line_voltages.map(toml::Value::from),
    );
    key(
        "column_order",
        reading
            .names
            .as_ref()
            .map(|names| word(names.what.join(","))),
    );
    text
}

fn columns_text(reading: &Mapping) -> String {
    let entries: Vec<String> = reading
        .columns
        .iter()
        .filter_map(|(target, map)| column_text(*target, map))
        .collect();
    match entries.is_empty() {
        true => String::new(),
        false => format!("\n[columns]\n{}", entries.concat()),
    }
}

fn column_text(target: Target, map: &ColumnMap) -> Option<String> {
    let word = |text: &str| toml::Value::from(text).to_string();
    let number = |x: f64| toml::Value::from(x).to_string();
    let scale = map.scale.map(|scale| match scale {
        Factor::Known(factor) => number(factor),
        Factor::Unknown => word(Factor::UNKNOWN),
    });
    let keys = [
        ("name", map.name.as_deref().map(word)),
        ("unit", map.unit.map(|unit| word(unit.name))),
        ("scale", scale),
        ("offset", map.offset.map(number)),
        ("delay_us", map.delay.map(|delay| number(1e6 * delay))),
    ];
    let said = keys
        .iter()
        .filter_map(|(key, value)| Some(format!("{key} = {}", value.as_ref()?)));
    let said: Vec<String> = said.collect();
    (!said.is_empty()).then(|| format!("{target} = {{ {} }}\n", said.join(", ")))
}

/// What the sidecar says of a speed of unknown scale; the written column is free of a given offset.
pub(super) fn scale_text(recording: &Recording) -> String {
    match recording.unknown_speed_scale.as_deref() {
        None => String::new(),
        Some(UnknownScale { offset: None, .. }) => {
            "\n[columns.speed]\nscale = \"unknown\"\n".into()
        }
        Some(_) => "\n[columns.speed]\nscale = \"unknown\"\noffset = 0.0\n".into(),
    }
}

fn sensors_text(text: &mut String, sensors: &Sensors, scales: &[(String, &str)]) {
    if *sensors == Sensors::default() && scales.is_empty() {
        return;
    }
    text.push_str("\n[sensors]\n");
    let numbers = [
        ("voltage_full_scale_volt", sensors.voltage_full_scale_volt),
        ("current_full_scale_amp", sensors.current_full_scale_amp),
        ("speed_full_scale_rad_s", sensors.speed_full_scale_rad_s),
        ("torque_full_scale_nm", sensors.torque_full_scale_nm),
        (
            "noise_sigma_fraction_of_full_scale",
            sensors.noise_sigma_fraction_of_full_scale,
        ),
    ];
    for (key, value) in numbers {
        if let Some(value) = value {
            let _ = writeln!(text, "{key} = {}", toml::Value::from(value));
        }
    }
    for (channel, scale) in scales {
        let _ = writeln!(text, "{channel} = {}", toml::Value::from(*scale));
    }
    let counts = [
        ("adc_bits", sensors.adc_bits),
        (
            "encoder_pulses_per_revolution",
            sensors.encoder_pulses_per_revolution,
        ),
        ("encoder_edges_per_pulse", sensors.encoder_edges_per_pulse),
        ("encoder_counter_bits", sensors.encoder_counter_bits),
    ];
    for (key, value) in counts {
        if let Some(value) = value {
            let _ = writeln!(text, "{key} = {value}");
        }
    }
}

fn voltage_word(voltage: VoltageKind) -> &'static str {
    match voltage {
        VoltageKind::Instantaneous => "instantaneous",
        VoltageKind::Hold => "hold",
    }
}

fn supply_word(supply: Supply) -> &'static str {
    match supply {
        Supply::Grid => "grid",
        Supply::Inverter => "inverter",
    }
}

fn load_word(load: LoadTorque) -> Option<&'static str> {
    match load {
        LoadTorque::Measured => Some("measured"),
        LoadTorque::Friction => Some("friction"),
        LoadTorque::Free => Some("free"),
        LoadTorque::Undeclared => None,
    }
}

fn starts_word(starts: StartsFrom) -> &'static str {
    match starts {
        StartsFrom::Standstill => "standstill",
        StartsFrom::Running => "running",
        StartsFrom::Unknown => "unknown",
    }
}
