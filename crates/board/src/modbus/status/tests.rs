//! What a master reads of a report.

use super::*;
use monitor::{Candidates, Residuals};

/// The registers of a door that shows what the monitor says.
fn registers(report: &Report) -> Image {
    let shown = Shown {
        lamps: report.lamps,
        ..Shown::default()
    };
    Status::default().take(report, &shown, &BoardStatus::default())
}

fn float(image: &Image, field: Field) -> f32 {
    let words = image
        .range(super::super::map::address(field), 2)
        .expect("in the map");
    f32::from_bits(u32::from(words[0]) << 16 | u32::from(words[1]))
}

fn word(image: &Image, field: Field) -> u16 {
    image
        .range(super::super::map::address(field), 1)
        .expect("in the map")[0]
}

fn report() -> Report {
    let mut window = Window {
        omega_sync: 60.0 * TAU,
        omega_mech: Some(1_500.0 * RAD_S_PER_RPM),
        ..Window::default()
    };
    window.channels[4].phasor.im = 3.0 * SQRT_2;
    Report {
        window: Some(window),
        residuals: Some(Residuals {
            r: [0.1, -0.2, 0.3, -0.4],
            e_d: 0.0,
            e_q: 0.0,
        }),
        ..Report::default()
    }
}

#[test]
fn measurements_arrive_in_the_units_of_the_map() {
    let image = registers(&report());
    assert_eq!(float(&image, Field::Residual2), -0.2);
    for (field, expected) in [
        (Field::Speed, 1_500.0),
        (Field::SupplyFrequency, 60.0),
        (Field::CurrentB, 3.0),
    ] {
        // Two roundings of single precision.
        assert!(
            (float(&image, field) - expected).abs() < 2e-7 * expected,
            "{field:?}"
        );
    }
    assert_eq!(word(&image, Field::Verdict), 1);
}

/// All angles of a circle: what the map promises of it, against the mathematical library.
#[test]
fn the_current_lags_by_its_angle_within_a_fifth_of_a_degree() {
    let mut worst: f32 = 0.0;
    for tenth in -1_799..=1_799_i16 {
        let expected = f32::from(tenth) / 10.0;
        let mut window = Window::default();
        window.u_s.positive.re = 325.0;
        let angle = -expected.to_radians();
        window.i_s.positive.re = 4.0 * libm::cosf(angle);
        window.i_s.positive.im = 4.0 * libm::sinf(angle);
        worst = worst.max((current_lag(&window) - expected).abs());
    }
    assert!(worst < 0.2, "{worst}");
    assert!(current_lag(&Window::default()).is_nan());
}

#[test]
fn without_a_window_there_are_no_measurements() {
    let nothing = Report {
        not_judged: Some(monitor::NotJudged::NotLocked),
        ..Report::default()
    };
    let image = registers(&nothing);
    for field in RESIDUALS
        .into_iter()
        .chain(CHANNEL_FIELDS)
        .chain([Field::Speed])
    {
        assert!(float(&image, field).is_nan(), "{field:?}");
    }
    assert_eq!(
        (word(&image, Field::Verdict), word(&image, Field::NotJudged)),
        (0, 1)
    );
}

#[test]
fn a_lit_fault_names_its_likeliest_row() {
    let mut faulty = report();
    faulty.lamps.fault = Lamp::On;
    // Speed sensor: r1, r2, r4 and not r3.
    faulty.candidates = Some(Candidates::from_normalised(&[9.0, 9.0, 0.0, 9.0]));
    let image = registers(&faulty);
    assert_eq!(
        (
            word(&image, Field::Verdict),
            word(&image, Field::LikelyFault)
        ),
        (2, 9)
    );
    assert!((500..=1000).contains(&word(&image, Field::FaultProbability)));
    // The likeliest is no row at all: it has no number, as before.
    faulty.candidates = Some(Candidates::from_normalised(&[0.0, 0.0, 9.0, 0.0]));
    let image = registers(&faulty);
    assert_eq!(word(&image, Field::LikelyFault), 0);
}

#[test]
fn a_dead_sensor_and_broken_bars_are_named_too() {
    let mut faulty = report();
    faulty.lamps.fault = Lamp::On;
    faulty.sensor = Some(monitor::SensorFinding::DeadCurrent(monitor::Phase::A));
    let named = |report: &Report| {
        let image = registers(report);
        (
            word(&image, Field::LikelyFault),
            word(&image, Field::FaultProbability),
        )
    };
    assert_eq!(named(&faulty), (7, 1000));
    faulty.sensor = None;
    faulty.rotor.is_broken = true;
    assert_eq!(named(&faulty), (13, 1000));
}

#[test]
fn a_doubt_about_the_instrument_reaches_the_master_between_two_reports() {
    let mut faulty = report();
    faulty.lamps.fault = Lamp::On;
    faulty.candidates = Some(Candidates::from_normalised(&[9.0, 9.0, 0.0, 9.0]));
    let mut status = Status::default();
    let shown = Shown {
        lamps: faulty.lamps,
        ..Shown::default()
    };
    let mut image = status.take(&faulty, &shown, &BoardStatus::default());
    let mut doubt = shown;
    (doubt.lamps.sensor, doubt.instrument_faulty) = (Lamp::On, true);
    status.refresh(&mut image, &doubt, &BoardStatus::default());
    assert_eq!(image, status_with(&faulty, &doubt));
    assert_eq!(word(&image, Field::NotJudged), 14);
    assert_eq!(word(&image, Field::LikelyFault), 0);
}

fn status_with(report: &Report, shown: &Shown) -> Image {
    Status::default().take(report, shown, &BoardStatus::default())
}

#[test]
fn nobody_reads_healthy_beside_a_lit_sensor_lamp() {
    let mut shown = Shown::default();
    shown.lamps.sensor = Lamp::On;
    assert_eq!(word(&status_with(&report(), &shown), Field::Verdict), 0);
}
