//! What is judged, what is not, and which reason is told.

use num_complex::Complex64;

use super::drive::{AMPLITUDE, Bench, Drive, PARAMS, T_SAMPLE, config, last, phases, point_of};
use crate::{
    Lamp, LoadKind, MonitorConfig, NotJudged, Phase, Rehearsal, Report, Sample, SensorFinding,
    SpeedSample, SupplyFinding,
};

/// The last report when every sample of the healthy motor is changed.
fn changed(change: impl Fn(f64, &mut Sample)) -> Report {
    last(config(), |t| {
        let mut sample = Drive::healthy().sample(t);
        change(t, &mut sample);
        sample
    })
}

#[test]
fn a_healthy_motor_is_judged_once_per_cycle_and_lights_nothing() {
    let mut bench = Bench::new(config());
    let reports = bench.run(1.0, |t| Drive::healthy().sample(t));
    let judged: Vec<_> = reports.iter().filter(|r| r.is_judged()).collect();
    assert!(judged.len() > 35, "{} of 50 cycles", judged.len());
    for pair in judged.windows(2) {
        assert!(pair[1].sample_index.abs_diff(pair[0].sample_index + 200) <= 1);
    }
    for report in judged {
        assert!(
            report.lamps.is_quiet() && report.lamps.run == Lamp::On,
            "{report:?}"
        );
        assert_eq!((report.sensor, report.supply), (None, None));
        let worst = report
            .normalised
            .into_iter()
            .flatten()
            .fold(0.0, |a: f32, b| a.max(b.abs()));
        assert!(worst < 0.1, "{worst} thresholds");
    }
    assert_eq!(bench.monitor.config(), &config());
}

/// Between the lock and the first full window the reason is that the window fills.
#[test]
fn a_window_settles_before_it_is_judged() {
    let reports = Bench::new(config()).run(1.0, |t| Drive::healthy().sample(t));
    let settling = reports
        .iter()
        .filter(|r| r.not_judged == Some(NotJudged::Settling));
    // The first cycle closes a turn after the oscillator was set; the fifth fills the window.
    assert_eq!(settling.count(), 4);
    let first = reports.iter().position(Report::is_judged).expect("judged");
    assert!(reports[first..].iter().all(Report::is_judged));
}

#[test]
fn what_is_not_measured_is_told() {
    assert_eq!(
        changed(|_, s| s.u_s_abc = None).not_judged,
        Some(NotJudged::NoVoltages)
    );
    assert_eq!(
        changed(|_, s| s.i_s_abc = None).not_judged,
        Some(NotJudged::NoCurrents)
    );
    let no_speed = changed(|_, s| s.speed = SpeedSample::None);
    assert_eq!(no_speed.not_judged, Some(NotJudged::NoSpeed));
    assert_eq!((no_speed.residuals, no_speed.point), (None, None));
    let nothing = changed(|_, s| *s = Sample::default());
    assert_eq!(nothing.not_judged, Some(NotJudged::NotLocked));
    assert_eq!(nothing.supply, None, "no channel could have seen a supply");
}

#[test]
fn a_channel_at_its_rail_is_told_even_before_the_window_is_full() {
    let clipped = |config: MonitorConfig| {
        Bench::new(config).run(1.0, |t| {
            let mut sample = Drive::healthy().sample(t);
            sample.clipped.mark_current(1);
            sample
        })
    };
    let reports = clipped(config());
    let of_cycles: Vec<_> = reports
        .iter()
        .filter(|r| r.not_judged != Some(NotJudged::NotLocked))
        .collect();
    assert!(of_cycles.len() > 40);
    for report in of_cycles {
        assert_eq!(report.not_judged, Some(NotJudged::Clipped));
        assert_eq!(report.lamps.sensor, Lamp::Blink);
    }
}

/// Every 0.1 s, and then a supply that was there is called lost.
#[test]
fn silence_is_reported_ten_times_a_second() {
    let mut bench = Bench::new(config());
    bench.run(0.5, |t| Drive::healthy().sample(t));
    let silent = Sample {
        u_s_abc: Some(Default::default()),
        i_s_abc: Some(Default::default()),
        ..Sample::default()
    };
    // Peaks are forgotten at 5 per second: ln(1/0.05)/5 = 0.6 s after the last cycle.
    bench.run(0.7, |_| silent);
    let reports = bench.run(1.0, |_| silent);
    assert_eq!(reports.len(), 10);
    for report in &reports {
        assert_eq!(
            report.not_judged,
            Some(NotJudged::Supply(SupplyFinding::Lost))
        );
        assert_eq!((report.window, report.lamps.run), (None, Lamp::Off));
    }
    assert_eq!(reports[1].sample_index - reports[0].sample_index, 1000);
    assert_eq!(reports[9].lamps.line, Lamp::On);
}

/// Direct voltage is a voltage: not lost, but there is nothing to lock to.
#[test]
fn direct_voltage_is_no_lost_supply() {
    let report = changed(|_, s| {
        s.u_s_abc = Some(crate::Abc {
            a: 300.0,
            b: -150.0,
            c: -150.0,
        });
    });
    assert_eq!(
        (report.not_judged, report.supply),
        (Some(NotJudged::NotLocked), None)
    );
    assert_eq!(report.lamps.line, Lamp::Blink);
}

/// An unbalanced supply is told by LINE; the motor is judged nevertheless.
#[test]
fn an_unbalanced_supply_is_told_and_judged() {
    let report = last(config(), |t| {
        let mut drive = Drive::healthy();
        drive.u[0] *= 1.15; // 5 % negative sequence
        drive.sample(t)
    });
    assert_eq!(report.supply, Some(SupplyFinding::Unbalance));
    assert_eq!(report.lamps.line, Lamp::On);
    assert!(report.is_judged(), "{:?}", report.not_judged);
}

#[test]
fn a_motor_without_current_is_not_judged() {
    let report = changed(|_, s| s.i_s_abc = Some(Default::default()));
    assert_eq!(report.not_judged, Some(NotJudged::NoLoadCurrent));
    assert_eq!(report.sensor, None);
}

#[test]
fn a_dead_channel_and_a_false_speed_are_sensors() {
    let report = last(config(), |t| {
        let mut drive = Drive::healthy();
        drive.i[1] *= 0.0;
        drive.sample(t)
    });
    let dead = SensorFinding::DeadCurrent(Phase::B);
    assert_eq!(report.not_judged, Some(NotJudged::Sensor(dead)));
    assert_eq!(
        (report.lamps.sensor, report.lamps.fault),
        (Lamp::On, Lamp::On)
    );
    let report = changed(|_, s| s.speed = SpeedSample::RadPerSecond(0.0));
    assert_eq!(report.sensor, Some(SensorFinding::SpeedImplausible));
    let report = changed(|_, s| s.u_s_abc = Some(Default::default()));
    assert_eq!(report.sensor, Some(SensorFinding::VoltagesMissing));
}

/// The shaft held, or turning slowly, and leakage that saturates at the current of a stall: what is left of the rotor flux implies any speed.
#[test]
fn a_held_shaft_is_no_dead_encoder() {
    for (leakage, rotor, slip) in [
        (1.0, 1.0, 1.0),
        (0.7, 1.0, 1.0),
        (0.6, 2.0, 1.0),
        (0.6, 1.5, 0.6),
    ] {
        let omega = core::f64::consts::TAU * 50.0;
        let reactance = |l: f64| Complex64::new(0.0, omega * l);
        let cage = reactance(leakage * PARAMS.l_lr) + rotor * PARAMS.r_r / slip;
        let main = reactance(PARAMS.l_m);
        let stator = reactance(leakage * PARAMS.l_ls) + PARAMS.r_s;
        let u = Complex64::from(AMPLITUDE);
        let held = Drive {
            u: phases(u),
            i: phases(u / (stator + cage * main / (cage + main))),
            omega_mech: (1.0 - slip) * omega / 2.0,
        };
        let report = last(config(), |t| held.sample(t));
        assert_eq!(report.sensor, None, "leakage {leakage}, slip {slip}");
        assert_eq!(report.lamps.sensor, Lamp::Off);
        assert_eq!(report.lamps.fault, Lamp::Off, "nobody measured it there");
        assert_eq!(report.not_judged, Some(NotJudged::Held));
    }
}

/// A motor that runs up from a stall draws currents beyond full scale: what is left of them implies any speed.
#[test]
fn clipped_currents_contradict_no_speed() {
    let report = changed(|_, s| {
        s.speed = SpeedSample::RadPerSecond(0.0);
        s.clipped.mark_current(1);
    });
    assert_eq!(report.not_judged, Some(NotJudged::Clipped));
    assert_eq!((report.sensor, report.lamps.fault), (None, Lamp::Off));
}

/// (36) row 2: with 0.015 kg m2 on a scale of 0.065 N m s * 314/2 rad/s the threshold of 5 % is 34 rad/s2. A quarter of
/// what is carried along stays in doubt, and a quarter of the threshold may.
#[test]
fn a_speeding_shaft_is_a_transient_from_the_threshold_on() {
    for (rate, judged) in [(32.0_f32, true), (36.5, false), (-36.5, false)] {
        let report = changed(|t, s| {
            if let SpeedSample::RadPerSecond(omega) = &mut s.speed {
                *omega += rate * (t as f32 - 1.0);
            }
        });
        let expected = (!judged).then_some(NotJudged::Transient);
        assert_eq!(report.not_judged, expected, "{rate} rad/s2");
        assert!(report.residuals.is_some(), "evaluated even so");
    }
}

/// The rotor flux that follows a current of `di/dt` changes by some `(L_a^2 + (R_s/w)^2)^1/2 di/dt`, 0.025 V a second per
/// A/s; the current that charges it is worth up to `w L_m/R_r` = 32 times as much in r1: 0.25 % of 326.6 V, and half of
/// it at the angle between current and flux. So 0.6 % is some 5 A/s.
#[test]
fn a_changing_current_is_a_transient_from_the_threshold_on() {
    let i = point_of(&PARAMS).i_s;
    for (rate, judged) in [(2.2, true), (-2.2, true), (10.0, false), (-10.0, false)] {
        let report = last(config(), |t| {
            let mut drive = Drive::healthy();
            let factor = 1.0 + rate * (t - 1.0) / i.norm();
            drive.i = drive.i.map(|x| x * factor);
            drive.sample(t)
        });
        let expected = (!judged).then_some(NotJudged::Transient);
        assert_eq!(report.not_judged, expected, "{rate} A/s");
    }
}

/// What is not declared about the load says nothing about the motor: `r1` alone is left.
#[test]
fn residuals_with_a_torque_in_them_need_a_declared_load() {
    let known = |load, tau_load| {
        let loaded = MonitorConfig { load, ..config() };
        let report = last(loaded, |t| Sample {
            tau_load,
            ..Drive::healthy().sample(t)
        });
        let [r1, rest @ ..] = report.normalised.expect("evaluated");
        assert!(r1.is_finite());
        rest.map(f32::is_finite)
    };
    let torque = Some(point_of(&PARAMS).tau_em as f32);
    assert_eq!(known(LoadKind::Friction, None), [true; 3]);
    assert_eq!(known(LoadKind::Free, None), [false; 3]);
    assert_eq!(known(LoadKind::Free, torque), [false; 3]);
    assert_eq!(known(LoadKind::Measured, None), [false; 3]);
    assert_eq!(known(LoadKind::Measured, torque), [true; 3]);
}

/// A measured torque replaces the declared friction of the load, here wrong by a factor of two.
#[test]
fn a_measured_torque_replaces_the_declared_load() {
    let mut measured = config();
    measured.load = LoadKind::Measured;
    measured.mechanics.load_friction *= 2.0;
    let tau = point_of(&PARAMS).tau_em as f32;
    let r2 = |config, tau_load| {
        let report = last(config, |t| Sample {
            tau_load,
            ..Drive::healthy().sample(t)
        });
        report.residuals.expect("evaluated").r[1]
    };
    assert!(r2(measured, Some(tau)).abs() < 1e-3);
    // Twice the friction asks for twice the torque: half of the scale is missing.
    let wrong = MonitorConfig {
        load: LoadKind::Friction,
        ..measured
    };
    let omega_share = point_of(&PARAMS).omega_el / super::drive::OMEGA_SYNC;
    assert!((f64::from(r2(wrong, None)) - 0.5 * omega_share).abs() < 1e-3);
}

/// The paper's bench on the running motor: a rehearsed voltage sensor leaves `r2` dark, a speed sensor `r3`.
#[test]
fn rehearsed_sensor_faults_light_their_rows_until_they_end() {
    let rows = [
        (
            Rehearsal {
                voltage_gain: 1.2,
                ..Rehearsal::default()
            },
            [true, false, true, true],
        ),
        (
            Rehearsal {
                current_q_gain: 1.5,
                ..Rehearsal::default()
            },
            [true, true, true, false],
        ),
        (
            Rehearsal {
                speed_gain: 0.8,
                ..Rehearsal::default()
            },
            [true, true, false, true],
        ),
    ];
    for (gains, pattern) in rows {
        let mut bench = Bench::new(config());
        bench.run(0.5, |t| Drive::healthy().sample(t));
        bench.state.rehearse(gains);
        let reports = bench.run(0.2, |t| Drive::healthy().sample(t));
        assert_eq!(
            reports.last().map(|r| r.lamps.pattern()),
            Some(pattern),
            "{gains:?}"
        );
        bench.state.rehearse(Rehearsal::default());
        let reports = bench.run(0.2, |t| Drive::healthy().sample(t));
        assert!(
            reports.last().is_some_and(|r| r.lamps.is_quiet()),
            "{gains:?}"
        );
    }
}

/// After missing samples the supply is found anew; lamps, count and a rehearsal stay.
#[test]
fn a_gap_costs_the_lock_and_nothing_else() {
    let mut bench = Bench::new(config());
    bench.run(0.5, |t| Drive::healthy().sample(t));
    bench.state.rehearse(Rehearsal {
        voltage_gain: 1.2,
        ..Rehearsal::default()
    });
    let before = *bench
        .run(0.2, |t| Drive::healthy().sample(t))
        .last()
        .expect("a report");
    assert_eq!(before.lamps.fault, Lamp::On);
    bench.state.resume_after_gap();
    let reports = bench.run(1.0, |t| Drive::healthy().sample(t + 0.0123));
    let first = reports.first().expect("a report");
    assert!(!first.is_judged());
    assert!(first.sample_index > before.sample_index);
    assert!(
        reports.iter().all(|r| r.lamps.fault == Lamp::On),
        "the lamp stays lit"
    );
    assert!(reports.last().is_some_and(Report::is_judged));
}

/// A channel known to show 1.25 times the truth is corrected before anything is concluded from it.
#[test]
fn a_channel_gain_of_the_motor_file_is_undone() {
    let mut corrected = config();
    corrected.channel_gain[4] = 0.8;
    let seen = |t| {
        let mut drive = Drive::healthy();
        drive.i[1] *= 1.25;
        drive.sample(t)
    };
    let report = last(corrected, seen);
    assert!(report.is_judged() && report.lamps.is_quiet(), "{report:?}");
    assert!(!last(config(), seen).lamps.is_quiet());
}

/// The supply is followed by its voltage, or by the current where voltages are not measured.
#[test]
fn the_frequency_is_that_of_the_supply() {
    for without_voltages in [false, true] {
        let report = changed(|_, s| {
            if without_voltages {
                s.u_s_abc = None;
            }
        });
        let omega = report.window.expect("locked").omega_sync;
        assert!(
            (f64::from(omega) / super::drive::OMEGA_SYNC - 1.0).abs() < 1e-5,
            "{omega}"
        );
    }
}

/// A third of a turn of the reference is not taken for a new frequency: what is seen are amplitudes per phase.
#[test]
fn the_window_holds_amplitudes_and_sequences_of_the_samples() {
    let report = changed(|_, _| ());
    let window = report.window.expect("a full window");
    for channel in &window.channels[..3] {
        assert!((channel.phasor.norm() - AMPLITUDE as f32).abs() < 0.02);
        assert!((channel.mean_square - 0.5 * (AMPLITUDE * AMPLITUDE) as f32).abs() < 5.0);
    }
    let i: Complex64 = point_of(&PARAMS).i_s;
    assert!((f64::from(window.i_s.positive.norm()) - i.norm()).abs() < 1e-3);
    assert!((f64::from(window.span) - 4.0 * 200.0 * T_SAMPLE).abs() < 2e-6);
}

#[test]
fn a_configuration_outside_its_ranges_makes_no_monitor() {
    let wrong: [fn(&mut MonitorConfig); 6] = [
        |c| c.params.r_s = 0.0,
        |c| c.params.l_m = f32::NAN,
        |c| c.window_cycles = 11,
        |c| c.comparator.persistence = 0,
        |c| c.thresholds[2] = 0.0,
        |c| c.channel_gain[5] = 0.0,
    ];
    for (k, spoil) in wrong.into_iter().enumerate() {
        let mut config = config();
        spoil(&mut config);
        assert!(crate::Monitor::new(config).is_err(), "{k}");
    }
    let mut no_leakage = config();
    (no_leakage.params.l_ls, no_leakage.params.l_lr) = (0.0, 0.0);
    let error = crate::Monitor::new(no_leakage).expect_err("the sum must not be zero");
    assert_eq!(error.parameter, "l_ls + l_lr");
}

/// A recorder that goes on writing what it saw last: SENSOR blinks, and nobody looks for the supply.
#[test]
fn a_recorder_that_stands_still_shows_at_the_sensor_lamp() {
    for at in [0.5, 0.5013, 0.507, 0.5149] {
        let mut bench = Bench::new(config());
        let reports = bench.run(1.5, |t| Drive::healthy().sample(t.min(at)));
        let report = reports.last().expect("reports go on");
        assert_eq!(report.not_judged, Some(NotJudged::Invalid), "{at}");
        assert_eq!(
            (report.lamps.sensor, report.supply),
            (Lamp::Blink, None),
            "{at}"
        );
        assert!(
            reports.iter().all(|report| report.lamps.fault == Lamp::Off),
            "{at}"
        );
    }
    // A supply that was switched off holds its values too: zeros.
    let reports = Bench::new(config()).run(2.0, |t| {
        let mut sample = Drive::healthy().sample(t);
        if t > 0.5 {
            sample.u_s_abc = Some(Default::default());
            sample.i_s_abc = Some(Default::default());
        }
        sample
    });
    let dark = reports.last().expect("reports go on");
    assert_eq!(
        dark.not_judged,
        Some(NotJudged::Supply(SupplyFinding::Lost))
    );
}
