//! Windows at the edges: nothing becomes NaN, probabilities stay probabilities.

use num_complex::Complex32;
use proptest::prelude::*;

use super::plant::{monitor, statistics};
use crate::isolation::{CAUSES, Heating, Isolation, probabilities};
use crate::window::Window;
use frames::Sequence;

/// Nothing, hardly anything, and more than any motor has.
fn amplitude() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0), Just(1e-3), Just(1.0), 0.0..1e4_f32]
}

fn phasor() -> impl Strategy<Value = Complex32> {
    (amplitude(), -3.2..3.2_f32).prop_map(|(r, angle)| Complex32::from_polar(r, angle))
}

fn sequence() -> impl Strategy<Value = Sequence> {
    (phasor(), phasor(), phasor()).prop_map(|(positive, negative, zero)| Sequence {
        positive,
        negative,
        zero,
    })
}

/// Supplies that lock; shafts at standstill, in step with the supply and backwards.
fn windows() -> impl Strategy<Value = Window> {
    let speed = prop_oneof![Just(0.0), Just(1.0), Just(-1.0), -2.0..2.0_f32];
    let changes = (0.0..100.0_f32, -100.0..100.0_f32);
    (sequence(), sequence(), 28.0..690.0_f32, speed, changes).prop_map(
        |(u_s, i_s, omega_sync, speed, (current_change, speed_change))| Window {
            u_s,
            i_s,
            omega_sync,
            omega_mech: Some(0.5 * speed * omega_sync),
            current_bend: current_change,
            rates: crate::Rates {
                voltage: 10.0 * current_change,
                current: num_complex::Complex32::new(current_change, -current_change),
                speed: speed_change,
                supply: -speed_change,
            },
            span: 0.08,
            ..Window::default()
        },
    )
}

fn is_distribution((shares, unknown): ([f32; CAUSES], f32)) -> bool {
    let sum = shares.iter().sum::<f32>() + unknown;
    let all = shares.iter().chain([&unknown]);
    // 21 roundings of single precision.
    all.copied().all(|p| (0.0..=1.0).contains(&p)) && (sum - 1.0).abs() < 1e-5
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_window_leads_to_nan(window in windows()) {
        let healthy = statistics();
        if let Some(evidence) = monitor().evidence(&healthy, &window) {
            prop_assert!(evidence.departure.iter().all(|x| x.is_finite()), "{evidence:?}");
            let isolation = Isolation::of(&evidence, &healthy, Heating::any(&healthy));
            let numbers = isolation.scores.iter().chain(&isolation.sizes);
            prop_assert!(numbers.copied().all(f32::is_finite), "{isolation:?}");
            prop_assert!(isolation.significance.is_finite() && isolation.at_any_temperature.is_finite() && isolation.heating.rise.is_finite() && isolation.heating.deviation.is_finite());
            prop_assert!(is_distribution(isolation.probabilities()), "{isolation:?}");
        }
    }

    #[test]
    fn probabilities_add_up_to_one(
        scores in prop::array::uniform20(-1e3..1e6_f32),
        unknown in -100.0..1e6_f32,
    ) {
        prop_assert!(is_distribution(probabilities(&scores, unknown)));
    }
}
