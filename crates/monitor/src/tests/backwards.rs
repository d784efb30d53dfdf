//! A motor that runs backwards is its own mirror image: phases b and c exchanged, shaft and load turning the other way.

use super::calibrated::calibrated;
use super::drive::{Bench, Drive, config, last};
use crate::{
    Cause, Lamp, LoadKind, MonitorConfig, NotJudged, Phase, Report, Sample, SensorFinding,
    SpeedSample,
};

/// Exchanges phases b and c of voltages and currents: the field turns the other way.
fn exchanged(mut sample: Sample) -> Sample {
    for x in [&mut sample.u_s_abc, &mut sample.i_s_abc]
        .into_iter()
        .flatten()
    {
        core::mem::swap(&mut x.b, &mut x.c);
    }
    sample
}

/// The encoder's tracks exchanged, or the shaft turning the other way.
fn turned(mut sample: Sample) -> Sample {
    if let SpeedSample::RadPerSecond(omega) = &mut sample.speed {
        *omega = -*omega;
    }
    sample.tau_load = sample.tau_load.map(|tau| -tau);
    sample
}

fn mirrored(sample: Sample) -> Sample {
    turned(exchanged(sample))
}

fn after(config: MonitorConfig, sample: impl Fn(f64) -> Sample) -> Report {
    last(config, sample)
}

fn close(a: f32, b: f32, tolerance: f32, what: &str) {
    assert!((a - b).abs() < tolerance, "{what}: {a} and {b}");
}

/// Single precision on sums over a cycle: 1e-5 of a scale.
#[test]
fn the_mirror_image_shows_the_same_residuals() {
    let mut measured = config();
    measured.load = LoadKind::Measured;
    let drive = Drive::healthy();
    let loaded = |t| Sample {
        tau_load: Some(9.0),
        ..drive.sample(t)
    };
    for config in [config(), calibrated(), measured] {
        let forwards = after(config, loaded);
        let backwards = after(config, |t| mirrored(loaded(t)));
        assert!(backwards.is_judged(), "{:?}", backwards.not_judged);
        let [f, b] = [&forwards, &backwards].map(|r| r.residuals.expect("evaluated"));
        for (x, y) in f.r.into_iter().zip(b.r) {
            close(x, y, 2e-5, "residual");
        }
        let [f, b] = [&forwards, &backwards].map(|r| r.window.expect("full"));
        assert!(b.backwards && !f.backwards);
        assert_eq!(b.shaft_speed(), f.shaft_speed().map(|omega| -omega));
        close(b.shaft_torque().expect("measured"), -9.0, 1e-5, "torque");
        assert_eq!(forwards.lamps.fault, backwards.lamps.fault);
    }
    assert!(
        after(config(), |t| mirrored(drive.sample(t)))
            .lamps
            .is_quiet()
    );
}

/// Supply and speed of all four combinations: where they agree the motor is judged, where they do not the speed is false,
/// and never the sum of the currents.
#[test]
fn a_speed_against_the_field_of_a_running_motor_is_a_false_speed() {
    let drive = Drive::healthy();
    for (sample, sound) in [
        (
            Box::new(|t| drive.sample(t)) as Box<dyn Fn(f64) -> Sample>,
            true,
        ),
        (Box::new(|t| mirrored(drive.sample(t))), true),
        (Box::new(|t| exchanged(drive.sample(t))), false),
        (Box::new(|t| turned(drive.sample(t))), false),
    ] {
        let report = after(config(), sample);
        let expected = (!sound).then_some(SensorFinding::SpeedImplausible);
        assert_eq!(report.sensor, expected);
        assert_eq!(report.lamps.fault == Lamp::On, !sound);
    }
}

/// A fault in a phase or a channel keeps its name: its phase is the wire that it is in.
#[test]
fn phases_keep_their_names_in_the_mirror() {
    for (k, phase) in Phase::ALL.into_iter().enumerate() {
        let mut drive = Drive::healthy();
        drive.i[k] *= 1.05;
        let forwards = after(calibrated(), |t| drive.sample(t));
        // Exchanging all that belongs to phases b and c is the mirror; the channel stays the k-th.
        let mut drive = Drive::healthy();
        drive.u.swap(1, 2);
        drive.i.swap(1, 2);
        drive.omega_mech = -drive.omega_mech;
        drive.i[k] *= 1.05;
        let backwards = after(calibrated(), |t| drive.sample(t));
        for report in [forwards, backwards] {
            let isolation = report.isolation.expect("judged");
            assert_eq!(
                likeliest(&report),
                Cause::CurrentChannel(phase),
                "{isolation:?}"
            );
            assert_eq!(report.lamps.fault, Lamp::On);
        }
    }
}

fn likeliest(report: &Report) -> Cause {
    let isolation = report.isolation.expect("judged");
    let scores = crate::ALL_CAUSES.iter().zip(isolation.scores);
    let best = scores.max_by(|(_, a), (_, b)| a.total_cmp(b));
    *best.expect("there are causes").0
}

/// A channel that is dead backwards is dead, and named.
#[test]
fn a_dead_channel_is_named_in_either_direction() {
    let mut drive = Drive::healthy();
    drive.u.swap(1, 2);
    drive.i.swap(1, 2);
    drive.omega_mech = -drive.omega_mech;
    drive.i[1] *= 0.0;
    let report = after(config(), |t| drive.sample(t));
    let dead = SensorFinding::DeadCurrent(Phase::B);
    assert_eq!(report.not_judged, Some(NotJudged::Sensor(dead)));
}

/// Two phases of a running motor are exchanged: the shaft turns on against the field, at a slip of nearly two.
#[test]
fn plugging_is_not_judged_and_never_a_fault() {
    use super::drive::{AMPLITUDE, OMEGA_SYNC, PARAMS, phases};
    use motor::steady_state::SteadyState;
    use num_complex::Complex64;
    let supply = Complex64::new(AMPLITUDE, 0.0);
    let steady = SteadyState::new(&PARAMS, 2.0, supply, OMEGA_SYNC);
    for slip in [1.2, 1.6, 1.97] {
        let point = steady.at_slip_speed(slip * OMEGA_SYNC);
        let plugged = Drive {
            u: phases(point.u_s),
            i: phases(point.i_s),
            omega_mech: point.omega_mech,
        };
        assert!(plugged.omega_mech < 0.0);
        for config in [config(), calibrated()] {
            let mut bench = Bench::new(config);
            bench.run(0.5, |t| mirrored(Drive::healthy().sample(t)));
            let reports = bench.run(1.0, |t| plugged.sample(t));
            assert!(reports.iter().all(|report| report.lamps.fault == Lamp::Off));
            let report = reports.last().expect("reports");
            assert_eq!(report.not_judged, Some(NotJudged::Reversing), "slip {slip}");
            let seen = reports
                .iter()
                .find_map(|report| Some(report.window?.reverses));
            assert!(seen.is_some());
        }
    }
}
