//! The learner on made-up reports whose statistics are computed a second time, in double precision and in two passes.

use monitor::{Residuals, SensorFinding, SupplyFinding, Window};
use motor::motor_file::MotorFile;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

use super::*;

fn present() -> MonitorConfig {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../motors/assumed-300w.toml"
    );
    let file = MotorFile::read(path).expect("a shipped motor file");
    MonitorConfig::from_motor_file(&file, 1e-4).expect("no effects")
}

fn judged(r: [f32; 4], offsets: [f32; CHANNELS]) -> Report {
    let mut window = Window::default();
    for (channel, offset) in window.channels.iter_mut().zip(offsets) {
        channel.offset = offset;
    }
    Report {
        window: Some(window),
        residuals: Some(Residuals {
            r,
            e_d: 0.0,
            e_q: 0.0,
        }),
        normalised: Some(r),
        ..Report::default()
    }
}

/// Residuals of which the second follows the first, with the means and deviations of a sound motor.
fn healthy() -> Vec<[f32; 4]> {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let normal = Normal::new(0.0, 1.0).expect("a valid deviation");
    let mut draw = || normal.sample(&mut random) as f32;
    let row = |_| {
        let common = draw();
        [
            0.001 + 0.000_5 * common,
            -0.004 + 0.004 * common + 0.001 * draw(),
            0.003 * draw(),
            0.000_2 * draw(),
        ]
    };
    (0..LEARN_WINDOWS).map(row).collect()
}

/// What the learner says at last.
fn learn(reports: impl IntoIterator<Item = Report>) -> Progress {
    let config = present();
    let mut learner = Learner::new(77);
    let mut last = Progress::Learning;
    for report in reports {
        assert_eq!(last, Progress::Learning, "it goes on after its end");
        last = learner.observe(&report, &config, &config.thresholds);
    }
    last
}

fn learnt(rows: &[[f32; 4]], offsets: [f32; CHANNELS]) -> Calibration {
    match learn(rows.iter().map(|r| judged(*r, offsets))) {
        Progress::Learnt(calibration) => calibration,
        other => panic!("{other:?}"),
    }
}

#[test]
fn statistics_are_those_of_a_second_computation() {
    let rows = healthy();
    let healthy = learnt(&rows, [0.0; CHANNELS]).healthy;
    let count = rows.len() as f64;
    let mean = |k: usize| rows.iter().map(|r| f64::from(r[k])).sum::<f64>() / count;
    let mut expected = Vec::new();
    for j in 0..4 {
        // A running mean in f32 loses at most some hundred roundings of 6e-8 of the largest value.
        assert!(
            (f64::from(healthy.mean[j]) - mean(j)).abs() < 1e-7,
            "mean of r{}",
            j + 1
        );
        for k in j..4 {
            let product = |r: &[f32; 4]| (f64::from(r[j]) - mean(j)) * (f64::from(r[k]) - mean(k));
            expected.push(rows.iter().map(product).sum::<f64>() / (count - 1.0));
        }
    }
    let scale = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (found, expected) in healthy.covariance.iter().zip(expected) {
        // Single precision keeps six digits of the largest.
        assert!(
            (f64::from(*found) - expected).abs() < 1e-5 * scale,
            "{found} {expected}"
        );
    }
    assert_eq!(healthy.windows, LEARN_WINDOWS);
}

#[test]
fn thresholds_lie_beyond_what_was_seen_and_within_bounds() {
    let rows = healthy();
    let factory = present().thresholds;
    let thresholds = learnt(&rows, [0.0; CHANNELS]).thresholds;
    for (k, threshold) in thresholds.iter().enumerate() {
        let most = rows.iter().fold(0.0_f32, |most, r| most.max(r[k].abs()));
        assert!(*threshold > most, "r{} would light on its own data", k + 1);
        assert!(
            (0.5 * factory[k]..=4.0 * factory[k]).contains(threshold),
            "r{}",
            k + 1
        );
    }
    // r4 scatters by 0.02 %: half of the motor file's 0.3 % is the floor.
    assert_eq!(thresholds[3], 0.5 * factory[3]);
    // r1: mean 0.1 % and six times 0.05 %; the sample's own statistics differ by some per cent.
    assert!((thresholds[0] - 0.004).abs() < 0.000_3, "{}", thresholds[0]);
}

/// Of a motor known by its plate the monitor leaves open what the plate leaves open; learning neither refuses that nor counts it twice.
#[test]
fn what_a_plate_leaves_open_is_no_fault_while_learning() {
    let mut config = present();
    let factory = config.thresholds;
    // A residual of six times its threshold, of which five and a half are in doubt.
    let shown = factory.map(|threshold| 6.0 * threshold);
    let visible = factory.map(|threshold| 6.5 * threshold);
    let report = Report {
        visible: Some(visible),
        ..judged(shown, [0.0; CHANNELS])
    };
    let learn = |config: &MonitorConfig| {
        let mut learner = Learner::new(77);
        let all = (0..LEARN_WINDOWS).map(|_| learner.observe(&report, config, &factory));
        all.last()
    };
    let refused = Some(Progress::Refused(Refusal::TooLarge));
    assert_eq!(learn(&config), refused, "nothing is in doubt");
    config.doubt.circuit[0] = 0.2;
    let Some(Progress::Learnt(calibration)) = learn(&config) else {
        panic!("a healthy motor was refused");
    };
    for (learnt, factory) in calibration.thresholds.iter().zip(factory) {
        // Six less five and a half is the floor too; a mean of 600 equal numbers rounds some of the last bits.
        assert!((learnt - 0.5 * factory).abs() < 1e-4 * factory, "{learnt}");
    }
}

#[test]
fn offsets_are_added_to_those_that_hold() {
    let shown = [1.5, -2.0, 0.0, 0.05, -0.1, 0.2];
    let calibration = learnt(&healthy(), shown);
    let found = [calibration.voltage.offset, calibration.current.offset].concat();
    for (found, shown) in found.iter().zip(shown) {
        assert!((found - shown).abs() < 1e-5, "{found} {shown}");
    }
    let mut config = present();
    calibration.apply(&mut config);
    assert_eq!(
        config.converter.voltage.offset.a,
        calibration.voltage.offset[0]
    );
    assert_eq!(config.thresholds, calibration.thresholds);
}

#[test]
fn an_offset_that_no_resistor_explains_is_refused() {
    // 3 % of 400 V are 12 V.
    let progress = learn(
        healthy()
            .into_iter()
            .map(|r| judged(r, [0.0, 13.0, 0.0, 0.0, 0.0, 0.0])),
    );
    assert_eq!(progress, Progress::Refused(Refusal::Offset));
}

#[test]
fn a_lit_sensor_or_line_is_refused_at_once() {
    let mut sensor = judged([0.0; 4], [0.0; CHANNELS]);
    sensor.sensor = Some(SensorFinding::CurrentSum);
    assert_eq!(
        learn([sensor]),
        Progress::Learning,
        "before the lamp's persistence"
    );
    sensor.lamps.sensor = Lamp::On;
    assert_eq!(learn([sensor]), Progress::Refused(Refusal::Sensor));
    let mut line = judged([0.0; 4], [0.0; CHANNELS]);
    line.supply = Some(SupplyFinding::Unbalance);
    line.lamps.line = Lamp::On;
    assert_eq!(learn([line]), Progress::Refused(Refusal::Line));
    let mut unbalanced = judged([0.0; 4], [0.0; CHANNELS]);
    unbalanced.is_unbalanced = true;
    assert_eq!(
        learn([unbalanced]),
        Progress::Refused(Refusal::Unbalanced),
        "a fault would be learnt"
    );
}

#[test]
fn a_moving_motor_is_refused_and_so_is_one_that_is_hardly_judged() {
    let reports = |reason| {
        (0..MOST_WINDOWS).map(move |k| Report {
            not_judged: (k % 3 != 0).then_some(reason),
            ..judged([0.0; 4], [0.0; CHANNELS])
        })
    };
    let moving = learn(reports(NotJudged::Transient));
    assert_eq!(moving, Progress::Refused(Refusal::Unsteady));
    let clipping = learn(reports(NotJudged::Clipped));
    assert_eq!(clipping, Progress::Refused(Refusal::TooFew));
}

#[test]
fn a_drifting_residual_is_refused() {
    let drifting =
        (0..LEARN_WINDOWS).map(|k| judged([1e-5 * k as f32, 0.0, 0.0, 0.0], [0.0; CHANNELS]));
    assert_eq!(learn(drifting), Progress::Refused(Refusal::Unsteady));
}

#[test]
fn a_faulty_motor_is_refused_and_numbers_that_are_none_too() {
    for r1 in [0.05, f32::NAN] {
        let faulty = (0..LEARN_WINDOWS).map(|_| judged([r1, 0.0, 0.0, 0.0], [0.0; CHANNELS]));
        let with_normalised = faulty.map(|report| Report {
            normalised: Some([1.0; 4]),
            ..report
        });
        assert_eq!(
            learn(with_normalised),
            Progress::Refused(Refusal::TooLarge),
            "{r1}"
        );
    }
}

#[test]
fn what_a_free_load_leaves_uncompared_keeps_the_files_threshold() {
    let reports = healthy().into_iter().map(|r| Report {
        normalised: Some([0.1, f32::NAN, f32::NAN, f32::NAN]),
        ..judged([r[0], -1.0 + r[1] * 50.0, r[2], r[3]], [0.0; CHANNELS])
    });
    match learn(reports) {
        Progress::Learnt(calibration) => {
            assert_eq!(calibration.thresholds[1..], present().thresholds[1..]);
        }
        other => panic!("{other:?}"),
    }
}
