//! A resistance measured with direct current beside the plate.

use nameplate::Estimate;
use nameplate::plate::PlateFile;

const PLATE: &str = "power_kw = 2.2\nvoltage_volt = 400\nfrequency_hz = 50\nspeed_rpm = 1438\ncurrent_amp = 4.78\n\
                     power_factor = 0.77\nefficiency_percent = 86.3\n";

fn estimate(more: &str) -> Estimate {
    let file = PlateFile::parse(&format!("{PLATE}{more}"), "plate.toml").unwrap();
    Estimate::of(&file.plate).unwrap()
}

/// 2.4 ohm at 100 degC are 2 x 2.4 x 255/335 = 3.654 ohm between two terminals at 20 degC (copper, IEC 60034-1).
#[test]
fn a_measured_resistance_narrows_its_interval() {
    let plain = estimate("").parameters[0];
    let measured = estimate("dc_resistance_ohm = 3.654\n").parameters[0];
    assert!(measured.holds(2.4), "{measured:?}");
    assert!(measured.high / measured.low < 1.25, "{measured:?}");
    assert!(
        measured.high / measured.low < 0.5 * plain.high / plain.low,
        "{plain:?} {measured:?}"
    );
    // The same winding measured at 60 degC: 3.654 x 295/255.
    let warm = estimate("dc_resistance_ohm = 4.227\ndc_resistance_degc = 60\n").parameters[0];
    assert!(
        (warm.value / measured.value - 1.0).abs() < 1e-3,
        "{warm:?} {measured:?}"
    );
}

#[test]
fn a_temperature_without_a_resistance_is_refused() {
    let file =
        PlateFile::parse(&format!("{PLATE}dc_resistance_degc = 25\n"), "plate.toml").unwrap();
    assert!(
        Estimate::of(&file.plate)
            .unwrap_err()
            .to_string()
            .contains("dc_resistance_ohm")
    );
    assert!(PlateFile::parse(&format!("{PLATE}dc_resistance_degc = 900\n"), "plate.toml").is_err());
}
