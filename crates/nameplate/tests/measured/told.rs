//! What single tests tell, what they cannot, and what contradicts.

use nameplate::measured::table::{Column, Test, read_csv};
use nameplate::measured::{NAMES, Tested, What};
use nameplate::plate::PlateFile;
use nameplate::{Estimate, Interval};

use crate::machine::Laws;
use crate::{VOLTAGES, full_set, on_a_bench, told};

const PUMP: &str = "power_kw = 2.2\nvoltage_volt = 400\nfrequency_hz = 50\nspeed_rpm = 1438\ncurrent_amp = 4.78\n\
                    power_factor = 0.77\nefficiency_percent = 86.3";

fn parameter(tested: &Tested, name: &str) -> Interval {
    tested.parameters()[NAMES.iter().position(|known| *known == name).unwrap()]
}

fn factor(tested: &Tested, name: &str) -> f64 {
    let interval = parameter(tested, name);
    interval.high / interval.value
}

#[test]
fn one_voltage_cannot_part_friction_from_core_loss() {
    on_a_bench(4, Laws::Fitted, |_, plate, mut bench| {
        bench.no_load(&[1.0]);
        let one = told(plate, &bench.table);
        bench.no_load(&VOLTAGES);
        let several = told(plate, &bench.table);
        assert!(one.one_voltage && !several.one_voltage);
        let core = "core_loss_resistance_ohm";
        assert!(factor(&one, core) > 1.5, "{}", factor(&one, core));
        assert!(factor(&several, core) < 1.3, "{}", factor(&several, core));
        assert!(factor(&several, "saturation").ln() < 0.5 * factor(&one, "saturation").ln());
    });
}

#[test]
fn a_second_frequency_parts_skin_effect_from_rotor_resistance() {
    on_a_bench(6, Laws::Fitted, |_, plate, mut bench| {
        bench.dc_resistance();
        bench.locked_rotor(&[1.0]);
        let one = told(plate, &bench.table);
        bench.locked_rotor(&[0.25]);
        let two = told(plate, &bench.table);
        assert!(one.one_frequency && !two.one_frequency);
        for name in ["rotor_resistance_ohm", "second_cage_share"] {
            let (one, two) = (factor(&one, name).ln(), factor(&two, name).ln());
            assert!(two < 0.9 * one, "{name}: {one} {two}");
        }
    });
}

#[test]
fn a_coast_down_needs_the_friction() {
    on_a_bench(8, Laws::Fitted, |motor, plate, mut bench| {
        bench.coast_down();
        let alone = told(plate, &bench.table);
        bench.no_load(&VOLTAGES);
        let both = told(plate, &bench.table);
        let (alone, both) = (
            parameter(&alone, "inertia_kg_m2"),
            parameter(&both, "inertia_kg_m2"),
        );
        assert!(alone.high / alone.value > 1.3, "{alone:?}");
        assert!(
            both.high / both.value < 1.1 && both.holds(motor.inertia),
            "{both:?} {}",
            motor.inertia
        );
    });
}

/// A current that is 8 % off is named with its row, and the value that would fit is the true one.
#[test]
fn a_wrong_reading_is_named() {
    let (mut rows, mut readings) = (0, 0);
    for seed in 0..10 {
        on_a_bench(seed, Laws::Fitted, |_, plate, mut bench| {
            full_set(&mut bench);
            let (table, truth) = with_wrong_current(&bench.table, "load");
            let told = told(plate, &table);
            let doubt = told
                .doubts
                .iter()
                .find(|doubt| doubt.what == What::Rows(Test::Load, vec![11]));
            let culprit = doubt.and_then(|doubt| doubt.culprit);
            rows += usize::from(doubt.is_some());
            readings += usize::from(culprit.is_some_and(|culprit| {
                culprit.column == Column::Current && (culprit.fits / truth - 1.0).abs() < 0.03
            }));
        });
    }
    assert!(
        rows >= 9 && readings >= 6,
        "{rows} rows and {readings} readings of 10"
    );
}

/// The table with the current of a test's first row 8 % too high, and the true current.
fn with_wrong_current(table: &str, test: &str) -> (String, f64) {
    let mut truth = f64::NAN;
    let change = |line: &str| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if cells[0] == test && truth.is_nan() {
            truth = cells[3].parse().unwrap();
            cells[3] = (1.08 * truth).to_string();
        }
        cells.join(",")
    };
    let changed: Vec<String> = table.lines().map(change).collect();
    (changed.join("\n"), truth)
}

#[test]
fn two_resistances_that_contradict_are_both_named_and_the_interval_widens() {
    let plate = PlateFile::parse(PUMP, "p").unwrap().plate;
    let header = "test,resistance_ohm,temperature_degc\n";
    let agree = told(
        &plate,
        &format!("{header}dc-resistance,3.65,20\ndc-resistance,3.66,20\n"),
    );
    let apart = told(
        &plate,
        &format!("{header}dc-resistance,3.65,20\ndc-resistance,4.38,20\n"),
    );
    assert!(agree.doubts.is_empty());
    assert_eq!(apart.doubts.len(), 2, "{:?}", apart.doubts);
    assert!(
        apart
            .doubts
            .iter()
            .all(|doubt| doubt.culprit.unwrap().column == Column::Resistance)
    );
    let r_s = parameter(&apart, "stator_resistance_ohm");
    let ends = [3.65, 4.38].map(|ohm| 0.5 * ohm * 335.0 / 255.0);
    assert!(
        r_s.low < 1.01 * ends[0] && r_s.high > 0.99 * ends[1],
        "{r_s:?} {ends:?}"
    );
}

/// A motor that is not the one of the plate: its power factor at full load is 0.62 where 0.77 is printed.
#[test]
fn a_plate_that_contradicts_is_named() {
    let plate = PlateFile::parse(PUMP, "p").unwrap().plate;
    let table = "test,voltage_volt,current_amp,power_watt,speed_rpm,torque_nm\nload,400,5.95,2555,1438,14.6\nno-load,400,4.9,180,,\n";
    let told = told(&plate, table);
    assert!(
        told.doubts
            .iter()
            .any(|doubt| matches!(doubt.what, What::Plate(_))),
        "{:?}",
        told.doubts
    );
}

/// The resistance of a star phase is half of that between terminals, whatever the connection; 3.654 ohm at 20 degC are 2.4 ohm at
/// 100 degC (copper, IEC 60034-1).
#[test]
fn a_dc_resistance_is_taken_to_rated_load() {
    let plate = PlateFile::parse(PUMP, "p").unwrap().plate;
    let cold = told(
        &plate,
        "test,resistance_ohm,temperature_degc\ndc-resistance,3.654,20\n",
    );
    let warm = told(
        &plate,
        "test,resistance_ohm,temperature_degc\ndc-resistance,4.227,60\n",
    );
    for tested in [&cold, &warm] {
        let r_s = parameter(tested, "stator_resistance_ohm");
        assert!(
            (r_s.value / 2.4 - 1.0).abs() < 0.01 && r_s.high / r_s.value < 1.1,
            "{r_s:?}"
        );
    }
}

#[test]
fn the_template_contradicts_nothing() {
    let plate = PlateFile::parse(PUMP, "p").unwrap().plate;
    let told = told(&plate, nameplate::measured::table::TEMPLATE);
    assert!(told.doubts.is_empty(), "{:?}", told.doubts);
    assert_eq!(told.steps.len(), 6);
}

/// A column that no test reads changes nothing, nor does the order of the rows of different tests.
#[test]
fn only_readings_count() {
    let plate = PlateFile::parse(PUMP, "p").unwrap().plate;
    let rows = [
        "no-load,400,2.8,128,40,",
        "dc-resistance,,,,22,3.58",
        "no-load,200,0.95,47,39,",
    ];
    let table = |order: [usize; 3]| {
        let header = "test,voltage_volt,current_amp,power_watt,temperature_degc,resistance_ohm\n";
        format!(
            "{header}{}\n{}\n{}\n",
            rows[order[0]], rows[order[1]], rows[order[2]]
        )
    };
    let (one, other) = (
        told(&plate, &table([0, 1, 2])),
        told(&plate, &table([1, 0, 2])),
    );
    for (a, b) in one.parameters().iter().zip(other.parameters()) {
        assert!((a.value / b.value - 1.0).abs() < 1e-9, "{a:?} {b:?}");
    }
}

#[test]
fn what_no_test_shows_is_refused_with_line_column_and_remedy() {
    let plate = PlateFile::parse(PUMP, "p").unwrap().plate;
    let estimate = Estimate::of(&plate).unwrap();
    let header = "test,voltage_volt,frequency_hz,current_amp,power_kw,speed_rpm,torque_nm,resistance_ohm,time_s";
    for (row, words) in [
        (
            "no-load,400,50,2.8,128,,,,",
            "t.csv:2: no-load: column power_watt: 128000 W",
        ),
        (
            "no-load,400,50,2.8,-0.1,,,,",
            "column power_kw: -0.1 is negative",
        ),
        ("no-load,400,50,2.8,0.000128,,,,", "is it kW?"),
        ("no-load,,50,2.8,0.128,,,,", "column voltage_volt: is empty"),
        (
            "no-load,4000,50,2.8,0.128,,,,",
            "column voltage_volt: 4000 V",
        ),
        (
            "no-load,400,50,2800,0.128,,,,",
            "is it in mA, or voltage and current swapped?",
        ),
        (
            "no-load,4.8,50,400,0.128,,,,",
            "voltage and current swapped",
        ),
        ("no-load,400 V,50,2.8,0.128,,,,", "write the number alone"),
        (
            "locked-rotor,90,50,4.8,0.3,30,,,",
            "30 rpm with a locked rotor",
        ),
        (
            "load,400,50,4.8,2.5,1510,14,,",
            "not below the synchronous speed 1500",
        ),
        ("load,400,50,4.8,2.5,150,14,,", "is it in 1/s or rad/s?"),
        (
            "load,400,50,4.8,,,,,",
            "needs power_watt, speed_rpm or torque_nm",
        ),
        (
            "blocked,400,50,4.8,0.3,,,,",
            "\"blocked\" is no test; write dc-resistance",
        ),
        (",400,50,4.8,0.3,,,,", "column test: is empty"),
        ("coast-down,,,,,1490,,,0", "one row is no coast-down"),
        (
            "coast-down,,,,,1200,,,0\ncoast-down,,,,,1300,,,1",
            "t.csv:3: coast-down: column speed_rpm: is above the row before",
        ),
        (
            "locked-rotor,90,50,4.8,0.1,,,,\ndc-resistance,,,,,,,3.6,",
            "is it the power of one phase?",
        ),
        (
            "no-load,400,50,2.8,0.128,,,,,,,5",
            "has 12 cells, the header has 9",
        ),
    ] {
        let rows = read_csv(&format!("{header}\n{row}\n"), "t.csv");
        let error = match rows {
            Ok(rows) => Tested::of(&estimate, &rows, &Default::default(), None).unwrap_err(),
            Err(error) => error,
        };
        assert!(
            error.contains(words) && error.starts_with("t.csv:"),
            "{row}: {error}"
        );
    }
    for (header, words) in [
        (
            "test,ia_amp\nno-load,3",
            "write the mean of the three into current_amp",
        ),
        ("test,volts\nno-load,3", "\"volts\" is unknown"),
        ("voltage_volt\n400", "has no column test"),
        (
            "test,voltage_volt,voltage_volt\nno-load,400,400",
            "appears twice",
        ),
        (
            "test,power_kw,power_watt\nno-load,1,1000",
            "given in two units",
        ),
        ("", "is empty"),
        ("test,voltage_volt\n", "has no row below the header"),
    ] {
        let error = read_csv(header, "t.csv").unwrap_err();
        assert!(error.contains(words), "{header}: {error}");
    }
}

/// A decimal comma beside semicolons, tabs, a title above the header, a mark of the byte order: the same rows.
#[test]
fn a_table_is_read_as_spreadsheets_write_it() {
    let plain = read_csv("test,voltage_volt,current_amp\nno-load,400.5,2.8\n", "t").unwrap();
    for other in [
        "test;voltage_volt;current_amp\r\nno-load;400,5;2,8\r\n",
        "\u{feff}test\tvoltage_volt\tcurrent_amp\nNo load\t400.5\t2.8\n",
        "test,voltage_volt,current_amp,remark\nno_load,400.5,2.8,by night\n",
    ] {
        let rows = read_csv(other, "t").unwrap();
        assert_eq!(rows, plain, "{other}");
    }
    let titled = read_csv(
        "Bench 3,,\n,,\ntest,voltage_volt,current_amp\nno-load,400.5,2.8\n",
        "t",
    )
    .unwrap();
    assert_eq!(titled[0].values, plain[0].values);
    assert_eq!(titled[0].line, 4);
}
