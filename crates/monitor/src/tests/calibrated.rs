//! A motor whose healthy statistics are known: temperature, causes, currents alone.

use motor::TParams;

use super::drive::{Bench, Drive, PARAMS, config, last};
use crate::{
    ALL_CAUSES, Cause, Healthy, Lamp, MonitorConfig, ROWS, Rehearsal, Report, Uncertainty,
};

fn statistics() -> Healthy {
    Healthy {
        mean: [0.0; ROWS],
        scatter: [5e-4; ROWS],
        current_unbalance: [0.0; 2],
        current_unbalance_at: 0.0,
        negative_drop: [0.0; 2],
        current_unbalance_scatter: 5e-4,
        turns_axis: [0.342, 0.94],
        uncertainty: Uncertainty {
            stator_resistance: 0.01,
            rotor_resistance: 0.01,
            heating: 0.3,
            magnetizing_inductance: 0.002,
            leakage: 0.005,
            friction: 0.02,
            current_gain: 0.002,
            voltage_gain: 0.002,
            speed: 1e-4,
            iron_loss: 0.015,
            supply_unbalance: 0.002,
            negative_impedance: 0.1,
        },
        range: None,
        significance: 5.5,
        in_motion: motor::InMotion::Unseen,
    }
}

pub fn calibrated() -> MonitorConfig {
    MonitorConfig {
        healthy: Some(statistics()),
        ..config()
    }
}

fn warm(share: f64) -> TParams<f64> {
    TParams {
        r_s: PARAMS.r_s * (1.0 + share),
        r_r: PARAMS.r_r * (1.0 + share),
        ..PARAMS
    }
}

/// A warm winding moves the residuals of a motor taken for cold; a calibrated monitor sees the temperature and takes it off.
#[test]
fn residuals_of_a_calibrated_motor_are_those_of_its_winding_temperature() {
    let drive = Drive::with(&warm(0.2));
    let cold = last(config(), |t| drive.sample(t))
        .residuals
        .expect("evaluated");
    let report = last(calibrated(), |t| drive.sample(t));
    let shown = report.residuals.expect("evaluated");
    assert!(cold.r[0].abs() > 0.005, "{cold:?}");
    assert!(
        shown.r[0].abs() < 0.1 * cold.r[0].abs(),
        "{shown:?} {cold:?}"
    );
    let rise = report.isolation.expect("calibrated").heating.rise;
    assert!((rise - 0.2).abs() < 0.02, "{rise}");
    let normalised = report.normalised.expect("evaluated");
    assert!((normalised[0] * 0.006 - shown.r[0]).abs() < 1e-6);
    assert!(report.lamps.is_quiet(), "{:?}", report.lamps);
    // Both resistances of the point that is shown, not only one.
    let point = report.point.expect("evaluated");
    assert!((point.params.r_s / 3.7 - 1.0 - rise).abs() < 1e-5);
    assert!((point.params.r_r / 2.3 - 1.0 - rise).abs() < 1e-5);
}

/// [`crate::Monitor::residuals`] is what the lamps show, from a window alone.
#[test]
fn residuals_of_a_single_window_are_those_of_the_lamps() {
    let mut bench = Bench::new(calibrated());
    let drive = Drive::with(&warm(0.1));
    let reports = bench.run(1.0, |t| drive.sample(t));
    let report = reports.last().expect("a report");
    let window = report.window.expect("full");
    let alone = bench
        .monitor
        .residuals(&statistics(), &Rehearsal::default(), &window);
    let (alone, shown) = (
        alone.expect("measured"),
        report.residuals.expect("measured"),
    );
    for (a, b) in alone.r.into_iter().zip(shown.r) {
        assert!((a - b).abs() < 1e-3, "{alone:?} {shown:?}");
    }
}

fn likeliest(report: &Report) -> (Cause, f32) {
    let isolation = report.isolation.expect("calibrated and judged");
    let (shares, _) = isolation.probabilities();
    let best = (0..shares.len()).max_by(|a, b| shares[*a].total_cmp(&shares[*b]));
    let best = best.expect("there are causes");
    (ALL_CAUSES[best], isolation.sizes[best])
}

#[test]
fn a_channel_that_shows_too_much_is_named_and_lights_fault_and_sensor() {
    let mut drive = Drive::healthy();
    drive.i[2] *= 1.05;
    let report = last(calibrated(), |t| drive.sample(t));
    let (cause, size) = likeliest(&report);
    assert_eq!(cause, Cause::CurrentChannel(crate::Phase::C));
    assert!((size - 0.05).abs() < 0.005, "{size}");
    assert_eq!(
        (report.lamps.fault, report.lamps.sensor),
        (Lamp::On, Lamp::On)
    );
    assert_eq!(
        report.candidates, None,
        "causes replace the rows of Table 1"
    );
}

/// A resistance that jumps is no heat: the winding was known to be cold a cycle before.
#[test]
fn a_jump_of_both_resistances_is_a_fault_and_a_warm_start_is_not() {
    let (cold, hot) = (Drive::healthy(), Drive::with(&warm(0.25)));
    let mut bench = Bench::new(calibrated());
    bench.run(1.0, |t| cold.sample(t));
    let jumped = bench.run(0.5, |t| hot.sample(t));
    assert_eq!(jumped.last().map(|r| r.lamps.fault), Some(Lamp::On));
    let warm_start = last(calibrated(), |t| hot.sample(t));
    assert_eq!(warm_start.lamps.fault, Lamp::Off);
    // Five minutes at rest would excuse it; a gap in the samples would not.
    bench.state.resume_after_gap();
    let after = bench.run(1.0, |t| hot.sample(t));
    assert_eq!(after.last().map(|r| r.lamps.fault), Some(Lamp::On));
}

/// A motor at rest may take any temperature within minutes: 0.2 % a second against a range of 30 %.
#[test]
fn minutes_at_rest_excuse_a_warm_winding() {
    let (cold, hot) = (Drive::healthy(), Drive::with(&warm(0.25)));
    let mut bench = Bench::new(calibrated());
    bench.run(1.0, |t| cold.sample(t));
    bench.run(180.0, |_| crate::Sample {
        u_s_abc: Some(Default::default()),
        i_s_abc: Some(Default::default()),
        ..crate::Sample::default()
    });
    let after = bench.run(1.0, |t| hot.sample(t));
    assert_eq!(after.last().map(|r| r.lamps.fault), Some(Lamp::Off));
}

/// With three currents alone there are no residuals, but a judgement: their symmetry.
#[test]
fn currents_alone_are_judged_by_their_symmetry() {
    let without_voltages = |drive: Drive| {
        last(calibrated(), |t| crate::Sample {
            u_s_abc: None,
            speed: crate::SpeedSample::None,
            ..drive.sample(t)
        })
    };
    let with_speed = last(calibrated(), |t| crate::Sample {
        u_s_abc: None,
        ..Drive::healthy().sample(t)
    });
    for healthy in [without_voltages(Drive::healthy()), with_speed] {
        assert!(
            healthy.is_judged() && healthy.lamps.is_quiet(),
            "{healthy:?}"
        );
        assert_eq!((healthy.residuals, healthy.normalised), (None, None));
    }
    let mut unequal = Drive::healthy();
    unequal.i[0] *= 1.1;
    let report = without_voltages(unequal);
    assert_eq!(report.lamps.fault, Lamp::On);
    assert_eq!(likeliest(&report).0, Cause::CurrentChannel(crate::Phase::A));
}

/// What is not judged is no evidence either.
#[test]
fn a_transient_is_not_isolated() {
    let report = last(calibrated(), |t| {
        let mut sample = Drive::healthy().sample(t);
        if let crate::SpeedSample::RadPerSecond(omega) = &mut sample.speed {
            *omega += 60.0 * (t as f32 - 1.0);
        }
        sample
    });
    assert_eq!(report.not_judged, Some(crate::NotJudged::Transient));
    assert_eq!(report.isolation, None);
}

/// Thresholds that a constant field current makes wide let no window pass that holds the moment of switching off: the evidence
/// beside them is as sharp as ever, and would call it a fault.
#[test]
fn wide_thresholds_make_no_stop_steady() {
    let drive = Drive::healthy();
    let config = MonitorConfig {
        thresholds: [0.5; 4],
        ..calibrated()
    };
    // At every place of the cycle, for the rotor's flux goes on turning at the terminals.
    for part in 0..8 {
        let off = 1.0 + f64::from(part) * 0.02 / 8.0;
        let coasting = |t: f64| Drive {
            u: drive.u.map(|u| u * 0.93 * (-(t - off) / 0.2).exp()),
            i: [num_complex::Complex64::ZERO; 3],
            omega_mech: drive.omega_mech * (1.0 - 0.5 * (t - off)),
        };
        let reports = Bench::new(config).run(off + 0.3, |t| match t < off {
            true => drive.sample(t),
            false => coasting(t).sample(t),
        });
        assert!(reports.iter().filter(|report| report.is_judged()).count() > 40);
        let departs = |report: &&Report| {
            let isolation = report.isolation;
            isolation.is_some_and(|isolation| isolation.significance > statistics().significance)
        };
        // The last tenths of a cycle may be missing unseen, once: a lamp wants three windows.
        assert!(reports.iter().filter(departs).count() <= 1, "part {part}");
        assert!(reports.iter().all(|report| report.lamps.fault == Lamp::Off));
    }
}

/// The torque balance holds the inertia's term: a shaft that speeds up steadily within the limit departs by no more.
#[test]
fn acceleration_is_part_of_the_torque_balance() {
    let drive = Drive::healthy();
    let mut bench = Bench::new(calibrated());
    let window = bench
        .run(1.0, |t| drive.sample(t))
        .last()
        .and_then(|r| r.window)
        .expect("full");
    let mut speeding = window;
    speeding.rates.speed = 0.4 / window.span;
    let departure = |window| {
        let evidence = bench.monitor.evidence(&statistics(), &window);
        evidence.expect("all is measured").departure[0]
    };
    // J dw/dt over B_t w_s/n_p.
    let expected = 0.015 * 0.4 / window.span / (0.065 * super::drive::OMEGA_SYNC as f32 / 2.0);
    let got = departure(speeding) - departure(window);
    assert!((got - expected).abs() < 1e-5, "{got} {expected}");
}

/// Changes weigh less than a lasting deviation: a rate that is untrue, as large as it may be, convinces by no more than one over the
/// share of it that stays in doubt.
#[test]
fn a_change_convinces_less_than_what_stands() {
    let drive = Drive::healthy();
    let mut bench = Bench::new(calibrated());
    let window = bench
        .run(1.0, |t| drive.sample(t))
        .last()
        .and_then(|r| r.window)
        .expect("full");
    let significance = |window| {
        let evidence = bench
            .monitor
            .evidence(&statistics(), &window)
            .expect("measured");
        crate::Isolation::of(&evidence, &statistics(), crate::Heating::any(&statistics()))
            .significance
    };
    for rate in [2.0, 10.0] {
        let mut unsteady = window;
        unsteady.rates.current = num_complex::Complex32::new(rate, -rate);
        let found = significance(unsteady);
        assert!(
            found > significance(window) && found < 4.0,
            "{rate}: {found}"
        );
    }
}
