//! Table 1 through the core: the published patterns, the full motor, and the healthy motor at every load.

use std::sync::OnceLock;

use crate::common::motor;
use sim_host::demo::{self, Demo, FaultMatrix};

/// One run for all tests; the seed is arbitrary.
fn demo() -> &'static Demo {
    static DEMO: OnceLock<Demo> = OnceLock::new();
    DEMO.get_or_init(|| {
        demo::run(&motor("motors/assumed-300w.toml"), 11, || {}).expect("the motor runs")
    })
}

fn matrix(plant: &str, frame: &str) -> &'static FaultMatrix {
    let mut matrices = demo().matrices.iter();
    matrices
        .find(|matrix| matrix.plant == plant && matrix.frame == frame)
        .expect("the demonstration has this matrix")
}

#[test]
fn the_linear_plant_shows_all_published_patterns() {
    let matrix = matrix("linear", "voltage");
    for row in &matrix.table {
        assert!(row.agrees(), "{row}");
        assert!(row.dark_after, "lamps stay lit after the fault: {row}");
    }
    assert_eq!((matrix.agree, matrix.of), (18, 18));
}

#[test]
fn the_full_motor_in_the_rotor_flux_frame_shows_what_physics_leaves_of_the_table() {
    let robust = ["Rs", "Rr", "B", "Bl", "Iq", "Vq", "wr"];
    let rows = matrix("full", "rotor-flux").table.iter();
    let rows: Vec<_> = rows.filter(|row| robust.contains(&row.fault)).collect();
    assert_eq!(rows.len(), 14);
    for row in rows {
        assert!(row.agrees(), "{row}");
    }
}

/// Percent of scale from an independent computation: the paper's linear model solved in closed form (theory, section 4).
#[test]
fn measured_residuals_are_those_of_the_closed_form() {
    let expected = [
        ("Rs", [-1.38, 0.0, -1.38, -1.38]),
        ("Rr", [-1.21, 0.0, -1.21, -1.21]),
        ("Ls", [-32.7, 0.0, -32.7, -32.7]),
        ("Lr", [1.21, -47.3, 47.9, -1.38]),
        ("B", [0.0, -8.88, 8.77, -0.49]),
        ("Bl", [0.0, -38.2, 37.8, -2.09]),
        ("Iq", [2.62, -48.0, 50.0, 0.0]),
        ("Vq", [-33.3, 0.0, -33.3, -33.3]),
        ("wr", [47.4, 48.0, 0.0, 50.0]),
    ];
    for (fault, expected) in expected {
        let mut rows = matrix("linear", "voltage").table.iter();
        let row = rows
            .find(|row| row.fault == fault && row.change_percent > 0.0)
            .expect("every fault has a row");
        for (measured, expected) in row.r_percent.iter().zip(expected) {
            // 0.05 for the last printed digit; the rest is three sigma of half a second of 0.2 % noise on a
            // 15 A scale read at 0.43 A (0.1 % in r2 and r3).
            assert!(
                (measured - expected).abs() < 0.35,
                "{fault}: {measured} for {expected}"
            );
        }
    }
}

#[test]
fn ties_of_the_table_are_told_as_ties() {
    for row in &matrix("linear", "voltage").table {
        // All four are lit by a wrong motor file, too: a tie of 1 with 1/2 + 1/32 for "none of the table".
        let expected = match row.fault {
            "Iq" | "wr" => 0.85..1.0,
            "Lr" => 0.64..0.66,
            _ => 0.4..0.5,
        };
        assert!(expected.contains(&row.probability), "{row}");
    }
}

#[test]
fn the_healthy_motor_lights_nothing_at_any_load_in_the_rotor_flux_frame() {
    for row in demo()
        .healthy
        .iter()
        .filter(|row| row.frame == "rotor-flux")
    {
        assert!(row.lit.is_empty(), "{row:?}");
    }
}

/// The published frame error (theory, section 5): r1 of the healthy motor drifts with load.
#[test]
fn the_voltage_frame_drifts_with_load_and_the_rotor_flux_frame_does_not() {
    let r1 = |frame: &str, load: f64| {
        let mut rows = demo().healthy.iter();
        let row = rows.find(|row| row.frame == frame && row.load_percent == load);
        row.expect("the demonstration has this load").r_percent[0]
    };
    // Section 5 prints 1.33 % at rated load and 4.00 % at 1.5 times rated torque; here friction is scaled.
    assert!((r1("voltage", 100.0) - 1.33).abs() < 0.15);
    assert!(r1("voltage", 150.0) > 3.5);
    for load in [10.0, 50.0, 100.0, 150.0] {
        assert!(r1("rotor-flux", load).abs() < 0.1);
    }
}

#[test]
fn nothing_is_hard_coded_a_changed_motor_file_changes_the_numbers() {
    let mut changed = motor("motors/assumed-300w.toml");
    changed.parameters.r_s *= 2.0;
    let other = demo::run(&changed, 11, || {}).expect("the motor runs");
    let r1 = |demo: &Demo| demo.matrices[0].table[0].r_percent[0];
    // Twice the resistance, twice the drop that +50 % of it adds, less the current it costs.
    let ratio = r1(&other) / r1(demo());
    assert!((1.7..2.1).contains(&ratio), "{ratio}");
}
