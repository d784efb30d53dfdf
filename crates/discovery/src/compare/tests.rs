use super::*;
use estimation::specimen;
use recording::Source;

/// A model that is exactly right, but for what `error` adds to a channel in units of its noise.
fn residual_of(study: &Study, error: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let rows = 0..study.fitted.case.measured().len();
    rows.flat_map(|row| (0..N_CHANNELS).map(move |k| (row, k)))
        .map(|(row, k)| error(row, k))
        .collect()
}

fn state_of(study: &Study, rows: &Range<usize>) -> String {
    state(study, specimen::waveform_of(study), rows)
}

#[test]
fn load_voltage_slip_and_frequency_are_percent_of_rated() {
    let study = specimen::study(0.5, |_| 1.0);
    let point = specimen::point(1.0);
    let [load, voltage, slip, frequency] =
        percents(&study, specimen::waveform_of(&study), &(500..600));
    assert!((load - 100.0 / 1.7).abs() < 1e-6, "{load}");
    assert!((voltage - 100.0).abs() < 0.1, "{voltage}");
    let expected = 100.0 * point.omega_slip / point.omega_sync;
    assert!((slip - expected).abs() < 0.02, "{slip} {expected}");
    assert!((frequency - 100.0).abs() < 0.02, "{frequency}");
}

/// Steady at 0.6 and at 1.3 N m: 35 and 75 per cent of 1.7 N m to the nearest five; between them a step.
#[test]
fn regions_follow_what_the_machine_does() {
    let study = specimen::study(1.0, |t| if t < 0.5 { 0.6 } else { 1.3 });
    let r = residual_of(&study, |_, _| 2.0);
    let regions = regions(&study, &r);
    let names: Vec<&str> = regions.iter().map(|r| r.name.as_str()).collect();
    let expected = [
        "load 35 %, voltage 100 %",
        "step",
        "load 75 %, voltage 100 %",
    ];
    assert_eq!(names, expected);
    assert_eq!(regions[0].from_s, 0.0);
    assert!(
        (regions[1].from_s..regions[1].to_s).contains(&0.5),
        "{regions:?}"
    );
    assert!(regions.windows(2).all(|w| w[0].to_s == w[1].from_s));
    assert!((regions[2].to_s - 1.0).abs() < 1e-9);
    for region in &regions {
        // Twice the sensors' noise over a floor that holds a little of the inputs' noise as well.
        let floor = study.fitted.floor.mean.sqrt();
        assert!(
            (region.error_over_noise * floor / 2.0 - 1.0).abs() < 0.05,
            "{region:?}"
        );
    }
}

#[test]
fn a_machine_that_is_off_or_starts_is_no_load() {
    let mut study = specimen::study(0.5, |_| 1.0);
    specimen::waveform_mut_of(&mut study)
        .speed
        .iter_mut()
        .for_each(|w| *w *= 0.7);
    assert_eq!(state_of(&study, &(500..600)), "start-up");
    let inputs = &mut specimen::waveform_mut_of(&mut study).inputs;
    inputs.u_s.iter_mut().for_each(|u| *u *= 0.01);
    assert_eq!(state_of(&study, &(500..600)), "off");
}

#[test]
fn a_step_of_the_voltage_is_a_step() {
    let mut study = specimen::study(0.5, |_| 1.0);
    assert_eq!(state_of(&study, &(500..600)), "load 60 %, voltage 100 %");
    specimen::waveform_mut_of(&mut study).supply.segments = vec![0..1050, 1050..2500];
    assert_eq!(state_of(&study, &(500..600)), "step");
    assert_eq!(state_of(&study, &(600..700)), "load 60 %, voltage 100 %");
    assert_eq!(
        state_of(&study, &(0..100)),
        "load 60 %, voltage 100 %",
        "the beginning is no step"
    );
}

/// Each block lies in one band of each quantity.
#[test]
fn bands_hold_the_blocks_of_their_range() {
    let study = specimen::study(1.0, |t| if t < 0.5 { 0.6 } else { 1.3 });
    let half = study.fitted.case.measured().len() / 2;
    let r = residual_of(&study, |row, _| if row < half { 1.0 } else { 3.0 });
    let bands = bands(&study, &r);
    let of = |quantity: &str| -> Vec<(f64, f64, f64)> {
        let mine = bands.iter().filter(|b| b.quantity == quantity);
        mine.map(|b| (b.from_percent, b.to_percent, b.error_over_noise))
            .collect()
    };
    let load = of("load");
    assert_eq!(load.len(), 3, "{load:?}");
    assert_eq!((load[0].0, load[0].1), (25.0, 50.0));
    assert_eq!((load[1].0, load[1].1), (50.0, 75.0));
    assert_eq!((load[2].0, load[2].1), (75.0, 95.0));
    // The floor holds a little of the inputs' noise beside the sensors'.
    assert!((0.85..1.0).contains(&load[0].2), "{load:?}");
    assert!((load[2].2 / load[0].2 / 3.0 - 1.0).abs() < 0.05, "{load:?}");
    assert_eq!(of("voltage").len(), 1);
    assert_eq!((of("frequency")[0].0, of("frequency")[0].1), (95.0, 105.0));
    assert_eq!((of("slip")[0].0, of("slip")[0].1), (0.0, 5.0));
}

/// Root mean squares in the channel's unit: an error of three noises in one channel.
#[test]
fn signals_are_compared_in_their_units() {
    let study = specimen::study(0.5, |_| 1.0);
    let case = &study.fitted.case;
    let r = residual_of(&study, |_, k| if k == 3 { 3.0 } else { 0.0 });
    let all = signals(case, &r);
    let names: Vec<_> = all
        .iter()
        .map(|s| (s.name.as_str(), s.unit.as_str()))
        .collect();
    let expected = [
        ("ia", "A"),
        ("ib", "A"),
        ("ic", "A"),
        ("speed", "rad/s"),
        ("v0", "V"),
    ];
    assert_eq!(names, expected);
    let speed = &all[3];
    assert!((speed.error_over_noise - 3.0).abs() < 1e-9);
    assert!((speed.noise_floor - 0.2).abs() < 1e-9 && (speed.error_rms - 0.6).abs() < 1e-9);
    assert!((speed.rms - specimen::point(1.0).omega_mech).abs() < 1e-6);
    let current = &all[0];
    assert_eq!((current.error_rms, current.error_over_noise), (0.0, 0.0));
    let amplitude = specimen::point(1.0).i_s.norm();
    assert!((current.rms / (amplitude / 2f64.sqrt()) - 1.0).abs() < 1e-3);
    let mut blind = case.clone();
    specimen::weight_of(&mut blind)
        .iter_mut()
        .for_each(|w| w[3] = 0.0);
    assert!(signals(&blind, &r).iter().all(|s| s.name != "speed"));
}

/// An error of the currents that turns backwards at 0.1 A is the order -1.
#[test]
fn a_rotating_error_is_found_at_its_order() {
    let study = specimen::study(0.5, |_| 1.0);
    let case = &study.fitted.case;
    let error = |row: usize, k: usize| {
        if k > 2 {
            return 0.0;
        }
        let theta = -specimen::waveform_of(&study).supply.theta[2 * row] + 0.6;
        let shift = [0.0, -1.0, 1.0][k] * std::f64::consts::TAU / 3.0;
        0.1 * (theta + shift).cos() * case.weight()[row][k]
    };
    let found = orders(case, &residual_of(&study, error));
    let at = |order: f64| {
        found
            .iter()
            .find(|o| o.order == order)
            .expect("listed")
            .amplitude_amp
    };
    assert!((at(-1.0) - 0.1).abs() < 1e-3, "{found:?}");
    for order in [0.0, 1.0, -5.0, 7.0, -11.0, 13.0] {
        assert!(at(order) < 2e-3, "{found:?}");
    }
}

#[test]
fn a_table_has_signals_of_its_own_and_no_time() {
    let study = specimen::table_study(|_| ());
    let r = residual_of(&study, |_, _| 0.0);
    assert!(regions(&study, &r).is_empty() && bands(&study, &r).is_empty());
    assert!(orders(&study.fitted.case, &r).is_empty());
    let names: Vec<_> = signals(&study.fitted.case, &r)
        .into_iter()
        .map(|s| s.name)
        .collect();
    assert_eq!(names, ["current", "speed", "power_factor", "efficiency"]);
}

/// The whole question on a recording of the believed machine without noise, and with a speed that is off by three
/// of its noise: 9 in one of five channels.
#[test]
fn a_comparison_holds_signals_regions_bands_and_orders() {
    let exact = specimen::recording(1.0, |_| 1.0);
    let off = exact
        .speed()
        .expect("measured")
        .iter()
        .map(|w| w + 3.0 * specimen::SIGMA[2]);
    let off = exact
        .clone()
        .with_channel(recording::Channel::SPEED, off.collect())
        .expect("as long");
    let mut told = Vec::new();
    let mut error = |rec: &recording::Recording| {
        let mut progress = |what: &str, share: f64| told.push((what.to_owned(), share));
        let source = Source::Recording(rec.clone());
        let report = compare(
            &[source.clone(), source],
            &specimen::motor(""),
            &mut progress,
        )
        .expect("judged");
        assert!(report.audit.supported);
        assert_eq!(
            (report.signals.len(), report.orders.len()),
            (5, ORDERS.len())
        );
        assert!(!report.regions.is_empty() && !report.bands.is_empty());
        report.overall.expect("judged").error_over_noise
    };
    let (exact, off) = (error(&exact), error(&off));
    assert!(exact < 0.5, "{exact}");
    assert!((1.0..1.5).contains(&off), "{off}");
    assert!(told.windows(2).take(2).all(|w| w[0].1 <= w[1].1));
    assert_eq!(told.last().map(|t| t.1), Some(1.0));
    assert!(compare(&[], &specimen::motor(""), &mut |_, _| {}).is_err());
}
