//! Parameters that were not measured: what they alone explain lights nothing, what they do not explain does.

use super::drive::{Drive, config, last};
use crate::{Lamp, MonitorConfig, ParameterDoubt, Report};

/// Stator resistance, rotor resistance, stator leakage, rotor leakage, magnetizing inductance.
const PLACES: usize = 5;

/// A monitor that believes one parameter to be `factor` times the true one, and doubts each by `sigma`.
fn believing(place: usize, factor: f32, sigma: f32) -> MonitorConfig {
    let mut believed = config();
    let p = &mut believed.params;
    *[&mut p.r_s, &mut p.r_r, &mut p.l_ls, &mut p.l_lr, &mut p.l_m][place] *= factor;
    believed.doubt = ParameterDoubt {
        circuit: [sigma; PLACES],
        ..ParameterDoubt::default()
    };
    believed
}

fn healthy(config: MonitorConfig) -> Report {
    last(config, |t| Drive::healthy().sample(t))
}

#[test]
fn a_motor_without_doubt_is_judged_by_its_thresholds() {
    let plain = healthy(config()).visible;
    let known = MonitorConfig {
        doubt: ParameterDoubt::default(),
        ..config()
    };
    assert_eq!(healthy(known).visible, plain);
    let doubted = healthy(believing(0, 1.0, 0.1)).visible.expect("evaluated");
    for (doubted, plain) in doubted.iter().zip(plain.expect("evaluated")) {
        assert!(*doubted > plain);
    }
}

/// Each parameter 40 % off lights FAULT on a motor that is believed to be known, and nothing on one whose plate leaves 15 %
/// (one standard deviation of the logarithm) open.
#[test]
fn what_the_doubt_explains_stays_dark() {
    for place in 0..PLACES {
        for factor in [1.4, 1.0 / 1.4] {
            let certain = healthy(believing(place, factor, 0.0));
            let doubtful = healthy(believing(place, factor, 0.15));
            assert_eq!(doubtful.lamps.fault, Lamp::Off, "{place} {factor}");
            assert_eq!(doubtful.sensor, None, "{place} {factor}");
            let excess = |report: &Report| {
                let normalised = report.normalised.expect("evaluated");
                normalised.iter().fold(0.0, |a: f32, b| a.max(b.abs()))
            };
            assert!(
                excess(&certain) > 2.0 * excess(&doubtful),
                "{place} {factor}"
            );
        }
    }
}

/// Twelve standard deviations are no matter of the plate.
#[test]
fn what_the_doubt_does_not_explain_lights_fault() {
    let report = healthy(believing(4, 1.8, 0.05));
    assert_eq!(report.lamps.fault, Lamp::On, "{:?}", report.normalised);
}
