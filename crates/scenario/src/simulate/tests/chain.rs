//! Signal chains against closed forms: a sinusoid behind filters, delays and a converter that is not straight.

use super::{ideal, rms, run};
use crate::simulate::{SimSample, record};
use crate::tests::parse;
use crate::{PlantKind, Scenario, SignalChain};
use num_complex::Complex64;
use recording::Channel;
use std::f64::consts::TAU;

/// The assumed motor, running on 60 Hz, behind a chain; noise and steps of the converter are left out.
fn behind(chain: &str, duration_s: f64) -> Scenario {
    let text = format!(
        "start = \"running\"\nduration_s = {duration_s}\n[sensors]\nquantise = false\nnoise_sigma_fraction_of_full_scale = 0\n\
         [sensors.chain]\n{chain}"
    );
    parse(&text)
}

const SETTLED: usize = 1000;
/// Six cycles of 60 Hz.
const ROWS: usize = 1000;

/// Phasor of a signal at a frequency, over whole cycles behind the settling time.
fn phasor(samples: &[SimSample], hertz: f64, value: impl Fn(&SimSample) -> f64) -> Complex64 {
    let rows = &samples[SETTLED..SETTLED + ROWS];
    let sum: Complex64 = rows
        .iter()
        .map(|s| value(s) * Complex64::from_polar(1.0, -TAU * hertz * s.t))
        .sum();
    2.0 * sum / ROWS as f64
}

/// Measured over true phasor of voltage a and current b at a frequency.
fn ratios(samples: &[SimSample], hertz: f64) -> [Complex64; 2] {
    let of = |f: fn(&SimSample) -> f64| phasor(samples, hertz, f);
    [
        of(|s| s.measured.u_s_abc[0]) / of(|s| s.truth.u_s_abc[0]),
        of(|s| s.measured.i_s_abc[1]) / of(|s| s.truth.i_s_abc[1]),
    ]
}

fn closed_form(time_constants_us: &[f64], delay_us: f64, hertz: f64) -> Complex64 {
    let omega = TAU * hertz * 1e-6;
    let poles = time_constants_us.iter();
    poles
        .map(|tau| Complex64::new(1.0, omega * tau).inv())
        .product::<Complex64>()
        * Complex64::from_polar(1.0, -omega * delay_us)
}

/// What straight lines between steps of 10 us leave at 60 Hz is 2e-6.
const EXACT: f64 = 5e-6;

#[test]
fn filter_and_delay_turn_and_shrink_a_sinusoid_as_their_transfer_function_says() {
    let chain = "voltage_filter_us = [81.9, 7.05]\nvoltage_delay_us = 23.4\ncurrent_filter_hz = 1592\ncurrent_delay_us = [1, 3.7, 2]";
    for plant in [PlantKind::Full, PlantKind::Linear] {
        let scenario = Scenario {
            plant,
            ..behind(chain, 0.21)
        };
        let [u, i] = ratios(&run(&scenario), 60.0);
        let expected = closed_form(&[81.9, 7.05], 23.4, 60.0);
        assert!((u - expected).norm() < EXACT, "{plant:?} {u} {expected}");
        let expected = closed_form(&[1e6 / (TAU * 1592.0)], 3.7, 60.0);
        assert!((i - expected).norm() < EXACT, "{plant:?} {i} {expected}");
        // What is checked is not small: 2.3 degrees.
        assert!(u.arg().to_degrees() < -2.2);
    }
}

#[test]
fn a_harmonic_is_filtered_as_a_harmonic() {
    let chain = "voltage_filter_us = [159]\n[[supply.harmonics]]\norder = 7\npercent = 5";
    let [u, _] = ratios(&run(&behind(chain, 0.21)), 420.0);
    let expected = closed_form(&[159.0], 0.0, 420.0);
    // Straight lines between steps cost the square of the frequency: 49 times as much.
    assert!((u - expected).norm() < 49.0 * EXACT, "{u} {expected}");
}

#[test]
fn gains_offsets_and_a_wrong_reference_scale_what_is_read() {
    let chain = "voltage_gain_error_percent = [2, 0, 0]\nvoltage_offset_volt = [1.5, 0, 0]\nreference_error_percent = -1\n\
                 current_gain_error_percent = 1\ncurrent_reference = \"ratiometric\"";
    for sample in run(&behind(chain, 0.02)) {
        let (shown, truth) = (sample.measured, sample.truth);
        let expected = (1.02 * truth.u_s_abc[0] + 1.5) / 0.99;
        assert!((shown.u_s_abc[0] - expected).abs() < 1e-9);
        assert!((shown.u_s_abc[2] - truth.u_s_abc[2] / 0.99).abs() < 1e-9);
        assert!((shown.i_s_abc[1] - 1.01 * truth.i_s_abc[1]).abs() < 1e-9);
    }
}

#[test]
fn a_drifting_reference_drifts_by_its_rate() {
    let samples = run(&behind("reference_drift_percent_per_s = 5", 0.2));
    let last = samples.last().expect("samples");
    let expected = last.truth.u_s_abc[1] / (1.0 + 0.05 * last.t);
    assert!((last.measured.u_s_abc[1] - expected).abs() < 1e-9);
}

#[test]
fn carrier_ripple_passes_the_filter() {
    let chain = "carrier_hz = 4000\ncarrier_ripple_volt = 100\ncarrier_ripple_amp = 0.5\nvoltage_filter_hz = 1592\ncurrent_filter_hz = 1592";
    let with = run(&behind(chain, 0.21));
    let without = run(&behind(
        "voltage_filter_hz = 1592\ncurrent_filter_hz = 1592",
        0.21,
    ));
    let ripple = |value: fn(&SimSample) -> f64| {
        let pairs = with.iter().zip(&without);
        rms(pairs.map(|(a, b)| value(a) - value(b))) * 2.0_f64.sqrt()
    };
    let passed = closed_form(&[1e6 / (TAU * 1592.0)], 0.0, 4000.0).norm();
    let in_voltage = ripple(|s| s.measured.u_s_abc[0]);
    assert!((in_voltage - 100.0 * passed).abs() < 1e-3 * 100.0 * passed);
    let in_current = ripple(|s| s.measured.i_s_abc[2]);
    assert!((in_current - 0.5 * passed).abs() < 1e-3 * 0.5 * passed);
}

/// A bow of `b` LSB turns a sinusoid of the share `s` of full scale into a second harmonic of `b s^2 / 2` LSB.
#[test]
fn a_bowed_converter_makes_a_second_harmonic() {
    let scenario = behind("inl_lsb = 8\ninl_shape = \"bow\"", 0.21);
    let own = scenario.sensors.instrument;
    let samples = run(&scenario);
    let first = phasor(&samples, 60.0, |s| s.truth.u_s_abc[0]).norm();
    let second = phasor(&samples, 120.0, |s| s.measured.u_s_abc[0]).norm();
    let lsb = 2.0 * own.voltage_full_scale_volt / f64::from(1_u32 << own.adc_bits);
    let expected = 4.0 * lsb * (first / own.voltage_full_scale_volt).powi(2);
    assert!(
        (second - expected).abs() < 1e-3 * expected,
        "{second} {expected}"
    );
}

/// The channel before voltage a is current c of the instant before.
#[test]
fn crosstalk_brings_a_share_of_the_channel_before() {
    let scenario = behind("crosstalk_percent = 0.5", 0.02);
    let own = scenario.sensors.instrument;
    let (volt, amp) = (own.voltage_full_scale_volt, own.current_full_scale_amp);
    let samples = run(&scenario);
    for pair in samples.windows(2) {
        let (before, now) = (pair[0].truth, pair[1].truth);
        let current = |neighbour: f64, own: f64| 0.995 * own + 0.005 * neighbour;
        let u_a = current(before.i_s_abc[2] / amp, now.u_s_abc[0] / volt) * volt;
        let i_b = current(now.u_s_abc[1] / volt, now.i_s_abc[1] / amp) * amp;
        assert!((pair[1].measured.u_s_abc[0] - u_a).abs() < 1e-9);
        assert!((pair[1].measured.i_s_abc[1] - i_b).abs() < 1e-9);
    }
}

#[test]
fn a_chain_that_changes_nothing_shows_the_truth() {
    let mut scenario = ideal(0.05);
    scenario.sensors.chain = Some(SignalChain::default());
    for sample in run(&scenario) {
        for k in 0..3 {
            // A factor and a division by the full scale leave rounding.
            assert!((sample.measured.u_s_abc[k] - sample.truth.u_s_abc[k]).abs() < 1e-10);
            assert!((sample.measured.i_s_abc[k] - sample.truth.i_s_abc[k]).abs() < 1e-10);
        }
    }
}

/// A sensor fault lies ahead of the filter: a dead voltage dies away with the time constant.
#[test]
fn a_fault_of_a_sensor_passes_the_filter() {
    let fault =
        "voltage_filter_us = [1000]\n[[faults]]\nfault = \"va\"\noffset = 100\nfrom_s = 0.1";
    let with = run(&behind(fault, 0.12));
    let without = run(&behind("voltage_filter_us = [1000]", 0.12));
    for k in 1000..1100 {
        let shown = with[k].measured.u_s_abc[0] - without[k].measured.u_s_abc[0];
        // The step runs over one step of 10 us ahead of the fault's time, as a straight line.
        let passed = (k - 1000) as f64 * 1e-4 + 5e-6;
        let expected = 100.0 * (1.0 - (-passed / 1e-3).exp());
        assert!((shown - expected).abs() < 0.01, "{k}: {shown} {expected}");
    }
}

#[test]
fn effects_on_the_instruments_come_ahead_of_the_chain() {
    let effect = "[[effects]]\nname = \"current-gain\"\ncurrent_gain = 1.02";
    let text = format!("current_gain_error_percent = 1\n{effect}");
    let shown = record(&behind(&text, 0.05), |_| ()).expect("recorded");
    let plain = record(&behind("", 0.05), |_| ()).expect("recorded");
    let [ia, ..] = Channel::CURRENTS;
    let (x, y) = (plain.channel(ia), shown.channel(ia));
    let pairs = x.expect("there").iter().zip(y.expect("there"));
    for (x, y) in pairs {
        assert!((1.02 * 1.01 * x - y).abs() < 1e-9);
    }
}

/// Sixteen conversions of a sinusoid, the last at the time of the sample: late by half of what lies between the first and the
/// last, and shrunk by `sin(8 w h) / (16 sin(w h / 2))`.
#[test]
fn the_mean_of_sixteen_conversions_is_late_and_small_as_its_transfer_function_says() {
    let scenario = behind(
        "voltage_filter_us = [78.1, 7.05]\nvoltage_delay_us = 3.1\nconversions_per_sample = 16",
        0.21,
    );
    let [u, i] = ratios(&run(&scenario), 60.0);
    let half = TAU * 60.0 * 6.25e-6 / 2.0;
    let kept = (16.0 * half).sin() / (16.0 * half.sin());
    let mean = kept * closed_form(&[], 46.875, 60.0);
    let expected = closed_form(&[78.1, 7.05], 3.1, 60.0) * mean;
    assert!((u - expected).norm() < EXACT, "{u} {expected}");
    assert!((i - mean).norm() < EXACT, "{i} {mean}");
}

/// A ripple at the sampling rate is a constant in single conversions and nothing in their mean over a sampling time.
#[test]
fn the_mean_over_a_sampling_time_is_blind_to_ripple_at_the_sampling_rate() {
    let ripple = "carrier_hz = 10000\ncarrier_ripple_volt = 100";
    let of = |more: &str| run(&behind(more, 0.01));
    let off = |more: &str| {
        let (with, without) = (of(&format!("{more}\n{ripple}")), of(more));
        let pairs = with.iter().zip(&without);
        rms(pairs.map(|(a, b)| a.measured.u_s_abc[0] - b.measured.u_s_abc[0]))
    };
    assert!((off("") - 100.0).abs() < 1e-6, "{}", off(""));
    let mean = off("conversions_per_sample = 16");
    assert!(mean < 1e-9, "{mean}");
}

/// Codes are sums: with as many conversions they are sixteen times those of one, and a step of one code is a sixteenth.
#[test]
fn codes_are_sums_of_conversions() {
    let text = |more: &str| {
        parse(&format!(
            "start = \"running\"\nduration_s = 0.05\n[sensors.chain]\n{more}"
        ))
    };
    let (one, sixteen) = (text(""), text("conversions_per_sample = 16"));
    let told = sixteen.sensors.told(&sixteen.motor).sensors;
    assert_eq!(told.conversions, 16);
    let full_scale = told.voltage_full_scale_volt;
    for (single, summed) in run(&one).iter().zip(&run(&sixteen)).skip(1) {
        for k in 0..3 {
            let volt =
                |code: u16, number: f64| (f64::from(code) / number / 2048.0 - 1.0) * full_scale;
            let shown = volt(summed.measured.voltage_codes[k], 16.0);
            assert!((shown - summed.measured.u_s_abc[k]).abs() < 1e-9);
            // The mean is 46.9 us older: 1.8 % of the amplitude; noise and steps beside it.
            let single = volt(single.measured.voltage_codes[k], 1.0);
            assert!(
                (shown - single).abs() < 0.05 * full_scale,
                "{shown} {single}"
            );
        }
    }
}

/// The noise of sixteen conversions is a quarter of that of one.
#[test]
fn the_mean_has_a_quarter_of_the_noise() {
    let noise = |more: &str| {
        let with = |sigma: f64| {
            let text = format!(
                "start = \"running\"\nduration_s = 0.3\n[sensors]\nquantise = false\n\
                 noise_sigma_fraction_of_full_scale = {sigma}\n[sensors.chain]\n{more}"
            );
            run(&parse(&text))
        };
        let (noisy, clean) = (with(0.01), with(0.0));
        let pairs = noisy.iter().zip(&clean);
        rms(pairs.map(|(a, b)| a.measured.u_s_abc[1] - b.measured.u_s_abc[1]))
    };
    let ratio = noise("conversions_per_sample = 16") / noise("");
    // 3000 samples each: the ratio of two such estimates scatters by 1.8 %.
    assert!((ratio - 0.25).abs() < 0.02, "{ratio}");
}
