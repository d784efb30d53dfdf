//! Section 4, left half: the published linear plant (33).

use super::full_motor::full;
use super::*;
use parity::linear_plant::LinearParams;

/// One experiment on the linear plant: the believed parameters monitor a changed plant or sensor.
fn linear(believed: &LinearParams, fault: &str, factor: f64) -> [f64; 4] {
    let mut plant = *believed;
    let (mut i_q_gain, mut v_gain, mut w_gain) = (1.0, 1.0, 1.0);
    match fault {
        "Rs" => plant.r_s *= factor,
        "Rr" => plant.r_r *= factor,
        "Ls" => plant.l_s *= factor,
        "Lr" => plant.l_r *= factor,
        "B" => plant.friction *= factor,
        "Bl" => plant.load_friction *= factor,
        "Iq" => i_q_gain = factor,
        "Vq" => v_gain = factor,
        "wr" => w_gain = factor,
        other => panic!("{other}"),
    }
    let state = plant.steady_state(TABLE_VOLT);
    let measured = Measured {
        u: Complex64::new(0.0, v_gain * TABLE_VOLT),
        i: Complex64::new(believed.field_current, i_q_gain * state.i_q),
        omega_el: w_gain * state.omega_el,
        omega_sync: motor().nameplate.omega_sync(),
    };
    let t_model = motor().parameters;
    residuals(
        &t_model,
        believed.n_p,
        believed.b_t(),
        believed.field_current,
        measured,
    )
}

/// The published instrument's constant field current: `I_d` of the healthy motor at rated load in the
/// frame that it uses, the voltage frame. Seen in the rotor-flux frame it would be 1.7 % less.
fn linear_plant() -> LinearParams {
    let full = full();
    let healthy = full.point(&full.believed, full.mechanics.total_friction());
    let i_f = healthy.in_voltage_frame().i_d;
    LinearParams::new(&full.believed, &full.mechanics, i_f)
}

#[test]
fn the_motor_files_field_current_is_the_published_instruments() {
    let written = motor().monitor.nominal_field_current_amp.expect("there");
    // Written with three digits.
    assert!((written - linear_plant().field_current).abs() < 0.005);
}

#[test]
fn the_linear_plant_gives_the_published_left_hand_table() {
    let (two, one) = (TWO_DIGITS, ONE_DIGIT);
    let none = 1e-10;
    #[rustfmt::skip]
    let table = [
        ("Rs", [(-1.38, two), (0.0, none), (-1.38, two), (-1.38, two)]),
        ("Rr", [(-1.21, two), (0.0, none), (-1.21, two), (-1.21, two)]),
        ("Ls", [(-32.7, one), (0.0, none), (-32.7, one), (-32.7, one)]),
        ("Lr", [(1.21, two), (-47.3, one), (47.9, one), (-1.38, two)]),
        ("B",  [(0.0, none), (-8.88, two), (8.77, two), (-0.49, two)]),
        ("Bl", [(0.0, none), (-38.2, one), (37.8, one), (-2.09, two)]),
        ("Iq", [(2.62, two), (-48.0, one), (50.0, one), (0.0, none)]),
        ("Vq", [(-33.3, one), (0.0, none), (-33.3, one), (-33.3, one)]),
        ("wr", [(47.4, one), (48.0, one), (0.0, none), (50.0, one)]),
    ];
    for (fault, printed) in table {
        assert_row(fault, linear(&linear_plant(), fault, 1.5), printed);
    }
}

#[test]
fn one_threshold_set_gives_all_18_published_patterns_on_the_linear_plant() {
    for (fault, expected) in TABLE_1 {
        for factor in [1.5, 0.5] {
            let r = linear(&linear_plant(), fault, factor);
            for thresholds in threshold_sets() {
                let lit = lamps(r, thresholds);
                assert_eq!(lit, expected, "{fault} x {factor}: {r:.2?}, {thresholds:?}");
            }
        }
    }
}
