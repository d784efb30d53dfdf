//! The covariance of the healthy motor, and what is known of it, against sums in double precision.

use nalgebra::{SMatrix, SVector};
use num_complex::{Complex32, Complex64};

use super::causes::changed;
use super::plant::{Plant, evidence, evidence_by, monitor, statistics};
use crate::Evidence;
use crate::checks::sensors::Phase;
use crate::isolation::{Cause, Healthy, Heating, Isolation, ROWS, Row, Uncertainty};
use crate::window::Window;
use frames::Sequence;

type Matrix = SMatrix<f64, ROWS, ROWS>;

fn wide(rows: [f32; ROWS]) -> SVector<f64, ROWS> {
    SVector::from(rows.map(f64::from))
}

/// Squared length in units of the covariance that the documentation promises: scatter, every uncertainty along its own
/// direction, channel by channel.
fn mahalanobis(evidence: &Evidence, healthy: &Healthy, heating: f64) -> f64 {
    let scatter = wide(healthy.scatter);
    let mut sum = Matrix::from_diagonal(&scatter.component_mul(&scatter));
    let mut add = |rows: [f32; ROWS], deviation: f32| {
        let direction = wide(rows) * f64::from(deviation);
        sum += direction * direction.transpose();
    };
    let u = healthy.uncertainty;
    add(
        evidence.direction(Cause::StatorResistance),
        u.stator_resistance,
    );
    add(
        evidence.direction(Cause::RotorResistance),
        u.rotor_resistance,
    );
    add(
        evidence.direction(Cause::MagnetizingInductance),
        u.magnetizing_inductance,
    );
    add(evidence.direction(Cause::Leakage), u.leakage);
    add(evidence.direction(Cause::Friction), u.friction);
    add(evidence.direction(Cause::SpeedGain), u.speed);
    for phase in Phase::ALL {
        add(
            evidence.direction(Cause::CurrentChannel(phase)),
            u.current_gain,
        );
        add(
            evidence.direction(Cause::VoltageChannel(phase)),
            u.voltage_gain,
        );
    }
    let warm = wide(evidence.direction(Cause::StatorResistance))
        + wide(evidence.direction(Cause::RotorResistance));
    sum += warm * warm.transpose() * heating * heating;
    let x = wide(evidence.departure);
    x.dot(&(sum.try_inverse().expect("scatter in every row") * x))
}

/// Only one uncertainty at a time is more than a trace, so that none hides behind another.
#[test]
fn every_uncertainty_widens_its_own_direction() {
    let mut plant = Plant::healthy();
    plant.gains = [1.002, 1.0, 0.999, 1.0, 1.003, 1.0];
    plant.params.r_r *= 1.03;
    plant.friction *= 1.02;
    let large: [fn(&mut Healthy); 9] = [
        |h| h.uncertainty.stator_resistance = 0.2,
        |h| h.uncertainty.rotor_resistance = 0.2,
        |h| h.uncertainty.magnetizing_inductance = 0.02,
        |h| h.uncertainty.leakage = 0.1,
        |h| h.uncertainty.friction = 0.2,
        |h| h.uncertainty.current_gain = 0.01,
        |h| h.uncertainty.voltage_gain = 0.01,
        |h| h.uncertainty.speed = 0.01,
        |_| (),
    ];
    for (k, make_large) in large.into_iter().enumerate() {
        let mut healthy = statistics();
        healthy.scatter = [2e-3; ROWS];
        healthy.uncertainty.negative_impedance = 0.0;
        make_large(&mut healthy);
        let evidence = monitor()
            .evidence(&healthy, &plant.window())
            .expect("all is measured");
        for heating in [0.0, 0.05] {
            let white = evidence
                .covariance(&healthy, &evidence.resistances(), [heating, 0.0])
                .factorise()
                .whiten(&evidence.departure);
            let got: f64 = white.iter().map(|x| f64::from(*x).powi(2)).sum();
            let expected = mahalanobis(&evidence, &healthy, f64::from(heating));
            assert!(
                (got / expected - 1.0).abs() < 0.01,
                "{k}: {got} instead of {expected}"
            );
        }
    }
}

/// The drop over the negative sequence's impedance, uncertain in size and angle, matters as much as the motor carries
/// negative sequence: a series resistance makes some, a balanced motor none.
#[test]
fn an_uncertain_negative_impedance_excuses_only_currents_of_negative_sequence() {
    let with = |plant: &Plant, uncertain: f32| {
        let mut healthy = statistics();
        healthy.uncertainty.negative_impedance = uncertain;
        Isolation::of(&evidence(plant), &healthy, Heating::any(&healthy)).unknown
    };
    let mut unbalanced = Plant::healthy();
    unbalanced.series[1] = 0.5;
    assert!(with(&unbalanced, 0.5) < 0.9 * with(&unbalanced, 0.0));
    let mut warm = Plant::healthy();
    warm.params.r_r *= 1.3;
    assert!((with(&warm, 0.5) - with(&warm, 0.0)).abs() < 1e-2);
}

/// A row without statistics, or a torque balance without a known load, is neither evidence nor excuse.
#[test]
fn unknown_rows_say_nothing() {
    let mut healthy = statistics();
    healthy.scatter[Row::ZeroVoltage as usize] = 0.0;
    healthy.scatter[Row::ZeroVoltage as usize + 1] = 0.0;
    let mut plant = Plant::healthy();
    plant.gains[0] = 1.05;
    let evidence = monitor()
        .evidence(&healthy, &plant.window())
        .expect("all is measured");
    assert_eq!(known_rows(&evidence), ROWS - 2);
    assert_eq!(
        evidence.known()[Row::ZeroVoltage as usize..],
        [false, false]
    );
    assert_eq!(evidence.departure[Row::ZeroVoltage as usize..], [0.0, 0.0]);
    let direction = evidence.direction(Cause::VoltageChannel(Phase::A));
    assert_eq!(direction[Row::ZeroVoltage as usize..], [0.0, 0.0]);
    assert!(direction[Row::Negative as usize] != 0.0);
}

/// What the healthy motor shows anyway is no departure.
#[test]
fn the_mean_of_the_healthy_motor_is_taken_off() {
    let mut healthy = statistics();
    for (row, mean) in healthy.mean.iter_mut().enumerate() {
        *mean = 0.01 * (row + 1) as f32;
    }
    let evidence = monitor()
        .evidence(&healthy, &Plant::healthy().window())
        .expect("all is measured");
    for (row, x) in evidence.departure.iter().enumerate() {
        assert!((x + 0.01 * (row + 1) as f32).abs() < 1e-5, "row {row}: {x}");
    }
}

/// The error of the negative sequence's impedance that a calibration saw is in its mean: on the same supply nothing of it is in doubt.
#[test]
fn the_drop_that_a_calibration_saw_is_in_no_doubt() {
    let unbalance = Complex32::new(0.006, -0.008);
    let plant = Plant {
        unbalance: Complex64::new(0.006, -0.008),
        ..Plant::healthy()
    };
    let window = plant.window();
    let variance = |healthy: &Healthy, row: usize| {
        let evidence = monitor()
            .evidence(healthy, &window)
            .expect("all is measured");
        let along = evidence.resistances();
        let covariance = evidence.covariance(healthy, &along, [0.0; 2]).factorise();
        covariance.variances().nth(row).expect("a row")
    };
    let known = Healthy {
        uncertainty: Uncertainty::default(),
        ..statistics()
    };
    let mut doubted = known;
    doubted.uncertainty.negative_impedance = 0.3;
    let drop = monitor()
        .evidence(&known, &window)
        .expect("all")
        .negative_drop();
    assert!((drop - unbalance).norm() < 1e-4, "{drop}");
    let seen = Healthy {
        negative_drop: [drop.re, drop.im],
        ..doubted
    };
    // Single precision, of sums of a dozen squares.
    for row in [Row::Negative as usize, Row::Negative as usize + 1] {
        let [own, open, closed] = [&known, &doubted, &seen].map(|h| variance(h, row));
        assert!((closed - own).abs() < 1e-3 * own, "{closed} {own}");
        let expected = own + 0.09 * drop.norm_sqr();
        assert!(
            (open - expected).abs() < 1e-3 * expected,
            "{open} {expected}"
        );
    }
}

/// A window that shows currents only; `i_2` and `i_0` over the positive sequence of 5 A.
fn currents(i_2: Complex32, i_0: Complex32) -> Window {
    let positive = Complex32::from_polar(5.0, 0.8);
    Window {
        i_s: Sequence {
            positive,
            negative: positive * i_2,
            zero: positive * i_0,
        },
        omega_sync: 314.0,
        span: 0.08,
        ..Window::default()
    }
}

/// With three currents alone two rows speak of the motor, two of the instrument.
#[test]
fn currents_alone_show_their_unbalance() {
    let mut healthy = statistics();
    healthy.current_unbalance = [0.01, -0.02];
    let window = currents(Complex32::new(0.05, 0.03), Complex32::new(0.004, -0.006));
    let evidence = monitor().evidence(&healthy, &window).expect("currents");
    let close = |row: usize, expected: f32| {
        let got = evidence.departure[row];
        assert!((got - expected).abs() < 1e-6, "row {row}: {got}");
    };
    close(Row::Negative as usize, 0.04);
    close(Row::Negative as usize + 1, 0.05);
    close(Row::ZeroCurrent as usize, 0.004);
    close(Row::ZeroCurrent as usize + 1, -0.006);
    let known = [false, false, false, true, true, true, true, false, false];
    assert_eq!(evidence.known(), &known);
    healthy.current_unbalance_scatter = 0.0;
    healthy.scatter = [0.0; ROWS];
    let nothing = Evidence::of_currents(&healthy, &window, &[0.0; ROWS], 0.0);
    assert_eq!(known_rows(&nothing), 0);
}

/// Without voltages an unbalance of the currents may be the supply's: what it draws by `Z_2`, and, at another current than that of the
/// calibration, what its share of `I_2/I_1` changes by.
#[test]
fn currents_alone_leave_open_what_a_supply_may_draw() {
    let mut healthy = statistics();
    healthy.current_unbalance = [0.03, -0.04];
    healthy.uncertainty = Uncertainty {
        supply_unbalance: 0.002,
        ..Uncertainty::default()
    };
    let window = currents(Complex32::new(0.03, -0.04), Complex32::ZERO);
    let config = *monitor().config();
    let scatter = |learnt: f32| {
        let mut healthy = healthy;
        healthy.current_unbalance_at = learnt / config.rated_current;
        let evidence = monitor().evidence(&healthy, &window).expect("currents");
        let along = evidence.resistances();
        let covariance = evidence.covariance(&healthy, &along, [0.0; 2]).factorise();
        let variance = covariance.variances().nth(Row::Negative as usize);
        f64::from(variance.expect("a row")).sqrt()
    };
    // Both resistances in series with both leakages, the cage's at twice the frequency; the magnetizing branch takes little of it.
    let p = config.params;
    let reactance = config.rated_omega * (p.l_ls + p.l_lr);
    let standing = f64::from(p.r_s + 0.5 * p.r_r).hypot(f64::from(reactance));
    let drawn = 0.002 * f64::from(config.rated_voltage) / (standing * 5.0);
    let own = f64::from(healthy.current_unbalance_scatter);
    // What the magnetizing branch takes of a standing motor's impedance: leakage over main inductance, a twentieth.
    let near = |x: f64, y: f64| assert!((x - y).abs() < 0.05 * y, "{x} {y}");
    near(scatter(5.0), own.hypot(drawn));
    near(scatter(0.0), own.hypot(drawn));
    // Calibrated at 8 A: three fifths of 5 %.
    near(scatter(8.0), own.hypot(drawn).hypot(0.03));
}

/// Turns shorted in one phase add a current in phase with that phase's voltage, which leads its current by the load's
/// angle; without a zero sequence it is no channel.
#[test]
fn currents_alone_name_the_phase_of_shorted_turns() {
    let healthy = statistics();
    let [re, im] = healthy.turns_axis;
    let third = core::f32::consts::TAU / 3.0;
    for (k, phase) in Phase::ALL.into_iter().enumerate() {
        // The negative sequence sees phase b a third of a turn ahead, phase c a third behind.
        let axis = Complex32::from_polar(1.0, third * k as f32);
        let window = currents(Complex32::new(re, im) * axis * (0.1 / 3.0), Complex32::ZERO);
        let evidence = Evidence::of_currents(&healthy, &window, &[0.0; ROWS], 0.0);
        let isolation = Isolation::of(&evidence, &healthy, Heating::any(&healthy));
        let place = |cause| {
            crate::ALL_CAUSES
                .iter()
                .position(|c| *c == cause)
                .expect("listed")
        };
        let own = place(Cause::Turns(phase));
        let (shares, _) = isolation.probabilities();
        assert!(shares[own] > 0.5, "{phase:?}: {shares:?}");
        assert!(
            (isolation.sizes[own] - 0.1).abs() < 0.005,
            "{}",
            isolation.sizes[own]
        );
        assert!(!isolation.points_to_sensor());
    }
}

/// A contact's row may turn by the angle of the impedance that its current meets: against the impedances of two motors in double
/// precision, of which one parameter differs by its deviation.
#[test]
fn a_contact_turns_by_the_angle_that_uncertain_parameters_leave() {
    const BY: f64 = 0.01;
    let plant = Plant::healthy();
    let impedance = |of: &Plant| of.negative_impedance(&plant.point());
    let contact = Cause::SeriesResistance(Phase::A);
    let row = |rows: [f32; ROWS]| {
        let row = Row::Negative as usize;
        Complex64::new(rows[row].into(), rows[row + 1].into())
    };
    // A change of 1 % bends by about as much. Leakage is the chord to three times itself: with a = l_lr/l_m the rotor's part is
    // 1 - 4 a, the tangent's 1 - 2 a.
    let chord = 2.0 * plant.params.l_lr / plant.params.l_m;
    for (cause, bends) in [
        (Cause::StatorResistance, 2.0 * BY),
        (Cause::RotorResistance, 2.0 * BY),
        (Cause::Leakage, 2.0 * BY + chord),
    ] {
        let mut healthy = statistics();
        healthy.uncertainty = Uncertainty::default();
        let u = &mut healthy.uncertainty;
        let place = match cause {
            Cause::StatorResistance => &mut u.stator_resistance,
            Cause::RotorResistance => &mut u.rotor_resistance,
            _ => &mut u.leakage,
        };
        *place = BY as f32;
        let evidence = evidence_by(&plant, &healthy);
        let across = evidence.across(contact).expect("of a contact");
        let angle = (row(across) / row(evidence.direction(contact))).norm();
        let turned = impedance(&changed(cause, BY)) / impedance(&plant);
        let expected = turned.arg().abs();
        let miss = (angle - expected).abs();
        assert!(miss < bends * expected, "{cause:?}: {angle} {expected}");
    }
}

fn known_rows(evidence: &Evidence) -> usize {
    evidence.known().iter().filter(|known| **known).count()
}
