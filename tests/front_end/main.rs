//! The front end of docs/wiring.md: its netlists in ngspice against closed forms and against limits that other circuits fail.
//!
//! Every test that needs ngspice says so and passes where it is not installed; `.ci/run` installs it.

mod limits;
mod page;
mod spice;

use limits::{Board, Point, crosstalk_problems, nominal_problems, spread_problems};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Capacitors of the bill of materials, as shares: stage and pin.
const C0G: (f64, f64) = (0.01, 0.05);
const X7R: (f64, f64) = (0.1, 0.1);
const BOARDS: u32 = 500;

fn points(netlist: &str, word: &str) -> Option<Vec<Point>> {
    let lines = spice::lines(&spice::netlist(netlist), word)?;
    let point = |x: &Vec<f64>| Point {
        hertz: x[0],
        gain: x[1],
        delay_us: x.get(2).copied().unwrap_or(f64::NAN),
    };
    Some(lines.iter().map(point).collect())
}

fn boards((stage, pin): (f64, f64)) -> Option<Vec<Board>> {
    let text = spice::netlist("tolerances.cir")
        .replace("set tol_stage=0.01", &format!("set tol_stage={stage}"))
        .replace("set tol_pin=0.05", &format!("set tol_pin={pin}"))
        .replace("set boards=500", &format!("set boards={BOARDS}"));
    let lines = spice::lines(&text, "board")?;
    let board = |x: &Vec<f64>| Board {
        hertz: x[0],
        gain_percent: 100.0 * (x[1] / x[3] - 1.0),
        delay_us: x[2] - x[4],
    };
    let boards: Vec<Board> = lines.iter().map(board).collect();
    assert_eq!(boards.len(), 2 * BOARDS as usize, "50 and 60 Hz each");
    Some(boards)
}

/// Poles of a channel with an ideal amplifier, as a product.
fn closed_form(time_constants_us: &[f64], hertz: f64) -> (f64, f64) {
    let pole = |tau: &f64| Complex64::new(1.0, TAU * hertz * 1e-6 * tau).inv();
    let response: Complex64 = time_constants_us.iter().map(pole).product();
    (response.norm(), -response.arg() / TAU / hertz * 1e6)
}

#[test]
fn the_nominal_channels_are_the_product_of_their_poles() {
    let stage = [9.53e3 * 8.2e-3, 150.0 * 47e-3];
    let input = 3.32e3 * 1.996e6 / (3.32e3 + 1.996e6) * 1e-3;
    let cases = [
        ("voltage-channel.cir", [stage[0], stage[1], input, 0.4244]),
        ("current-channel.cir", [stage[0], stage[1], 0.53, 0.0]),
    ];
    for (netlist, taus) in cases {
        let Some(points) = points(netlist, "point") else {
            return;
        };
        for point in points.iter().filter(|point| point.hertz < 5e3) {
            let (gain, delay_us) = closed_form(&taus, point.hertz);
            // The amplifier's finite bandwidth is some 0.03 us and its output resistance less.
            assert!(
                (point.gain / gain - 1.0).abs() < 2e-3,
                "{netlist} {point:?} {gain}"
            );
            assert!(
                (point.delay_us - delay_us).abs() < 0.1,
                "{netlist} {point:?} {delay_us}"
            );
        }
    }
}

#[test]
fn the_nominal_channels_keep_their_limits() {
    let (Some(voltage), Some(current)) = (
        points("voltage-channel.cir", "point"),
        points("current-channel.cir", "point"),
    ) else {
        return;
    };
    assert_eq!(nominal_problems(&voltage, &current), Vec::<String>::new());
}

#[test]
fn the_old_divider_breaks_them() {
    let (Some(old), Some(current)) = (
        points("old-divider.cir", "point"),
        points("current-channel.cir", "point"),
    ) else {
        return;
    };
    let problems = nominal_problems(&old, &current).join("\n");
    for word in ["gain at 60 Hz", "delay at 60 Hz", "not flat", "V against I"] {
        assert!(problems.contains(word), "{word} is not among:\n{problems}");
    }
    let corner = spice::lines(&spice::netlist("old-divider.cir"), "corner_hz").expect("ngspice");
    let expected = 1e9 / (TAU * 100.0 * (1e3 + 1.88e6 * 7.87e3 / (1.88e6 + 7.87e3)));
    assert!(
        (corner[0][0] / expected - 1.0).abs() < 1e-3,
        "{corner:?}, not {expected}"
    );
}

#[test]
fn an_unbuffered_reference_breaks_the_gain() {
    let Some(weak) = points("current-channel.cir", "weak") else {
        return;
    };
    let at_60 = weak
        .iter()
        .find(|point| point.hertz == 60.0)
        .expect("60 Hz");
    // 200 ohm ahead of 21.63 kohm in one of two inputs, whose other half is fixed.
    assert!((0.991..0.994).contains(&at_60.gain), "{at_60:?}");
}

#[test]
fn five_hundred_boards_keep_their_limits() {
    let Some(boards) = boards(C0G) else {
        return;
    };
    assert_eq!(spread_problems(&boards), Vec::<String>::new());
}

#[test]
fn boards_with_capacitors_of_ten_percent_break_them() {
    let Some(boards) = boards(X7R) else {
        return;
    };
    let problems = spread_problems(&boards).join("\n");
    assert!(problems.contains("delay"), "{problems}");
    assert!(
        !problems.contains("gain"),
        "capacitors move no gain:\n{problems}"
    );
}

#[test]
fn the_pin_holds_the_charge_of_the_channel_before() {
    let text = spice::netlist("kickback.cir");
    let Some(found) = spice::named(&text, "crosstalk") else {
        return;
    };
    let of = |name: &str| found.iter().find(|(n, _)| n == name).expect("printed").1;
    for name in ["stage", "fast"] {
        assert_eq!(crosstalk_problems(of(name)), Vec::<String>::new(), "{name}");
    }
    for name in ["old", "weak"] {
        assert_eq!(
            crosstalk_problems(of(name)).len(),
            1,
            "{name}: {}",
            of(name)
        );
    }
    // Charge balance: 5 pF take the difference once per 100 us, and 150 ohm bring it back.
    let expected = 100.0 * 5e-12 * 8.84e3 / 100e-6;
    assert!(
        (of("old") / expected - 1.0).abs() < 0.02,
        "{} {expected}",
        of("old")
    );
}

#[test]
fn the_table_of_parts_is_the_list_of_parts() {
    page::check_or_update("parts", &page::parts_table());
}

#[test]
fn the_table_of_channels_is_what_ngspice_computes() {
    let netlists = [
        ("voltage", "voltage-channel.cir"),
        ("current", "current-channel.cir"),
        ("old divider", "old-divider.cir"),
    ];
    let mut channels = Vec::new();
    for (name, netlist) in netlists {
        let Some(points) = points(netlist, "point") else {
            return;
        };
        channels.push((name, points));
    }
    page::check_or_update("channels", &page::channel_table(&channels));
}

#[test]
fn every_value_of_the_netlists_is_in_the_list_of_parts() {
    let listed = page::parts();
    for value in [
        "12.1 kohm",
        "9.53 kohm",
        "8.2 nF",
        "150 ohm",
        "47 nF",
        "499 kohm",
        "3.32 kohm",
        "1 nF",
    ] {
        assert!(listed.contains(value), "{value}");
    }
    let library = spice::netlist("channel.lib");
    for value in [
        "12.1k", "9.53k", "8.2n", "150", "47n", "1.996meg", "3.32k", "1n",
    ] {
        assert!(
            library
                .lines()
                .any(|line| line.ends_with(&format!(" {value}"))),
            "{value}"
        );
    }
}
