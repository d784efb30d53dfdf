use super::*;
use crate::data::case::Case;
use crate::specimen::{self, SIGMA, T_SAMPLE, changed};
use recording::{LoadTorque, Metadata};
use signal::estimated_sigma;

fn rated() -> Rated<f64> {
    specimen::prior("").plant.rated
}

fn case_of(rec: &Recording) -> Waveform {
    Waveform::new(rec, &rated()).expect("judged")
}

fn reason(rec: &Recording) -> String {
    Waveform::new(rec, &rated()).expect_err("refused").reason
}

#[test]
fn numbers_that_no_motor_has_are_refused_with_their_channel() {
    let rec = specimen::recording(0.5, |_| 1.0);
    let rec = changed(&rec, |channel, mut x| {
        if channel == Channel::SPEED {
            x[100] = 1e300;
        }
        Some(x)
    });
    assert_eq!(reason(&rec), "speed reaches 1e300, which no motor does");
}

#[test]
fn rows_hold_every_second_sample_and_weigh_it_by_its_noise() {
    let rec = specimen::recording(1.0, |_| 1.0);
    let case = case_of(&rec);
    assert_eq!((case.between, case.decimation), (Between::Smooth, 1));
    assert!((case.t_row() - 2.0 * T_SAMPLE).abs() < 1e-12);
    assert_eq!(case.measured.len(), 2500);
    let [volt, ampere, speed, _] = SIGMA;
    let (i, omega) = (rec.currents().expect("three"), rec.speed().expect("one"));
    for row in [0, 1, 777, 2499] {
        let k = 2 * row;
        for (p, phase) in i.iter().enumerate() {
            assert_eq!(case.measured[row][p], phase[k]);
            let sigma = (ampere * ampere + (0.005 * phase[k]).powi(2)).sqrt();
            assert!((case.weight[row][p] * sigma - 1.0).abs() < 1e-12);
        }
        assert_eq!(case.measured[row][3], omega[k]);
        assert!((case.weight[row][3] * speed - 1.0).abs() < 1e-12);
        // The mean of three phases has a third of the variance of one.
        assert!(case.measured[row][4].abs() < 1e-9);
        assert!((case.weight[row][4] * volt / 3f64.sqrt() - 1.0).abs() < 1e-12);
    }
    assert_eq!(Case::from(case.clone()).judged(), 5.0 * 2500.0);
    assert!((case.input_noise.voltage - (2.0f64 / 3.0).sqrt() * volt).abs() < 1e-12);
    assert!((case.input_noise.torque - SIGMA[3]).abs() < 1e-12);
    assert!(!case.inverter && case.open.is_empty() && !case.speed_is_input);
}

#[test]
fn blocks_of_forty_milliseconds_cover_every_row_once() {
    let case = case_of(&specimen::recording(1.03, |_| 1.0));
    let blocks = case.blocks();
    assert_eq!(blocks[0].start, 0);
    assert!(blocks.windows(2).all(|w| w[0].end == w[1].start));
    assert_eq!(blocks.last().map(|b| b.end), Some(case.measured.len()));
    for block in &blocks[..blocks.len() - 1] {
        let seconds = block.len() as f64 * case.t_row();
        assert!((seconds - BLOCK).abs() < 1.01 * case.t_row(), "{seconds}");
    }
    let last = blocks[blocks.len() - 1].len();
    assert!(
        last >= blocks[0].len() && last < 2 * blocks[0].len(),
        "the rest joins the last"
    );
}

#[test]
fn fast_samples_are_thinned_out() {
    let mut rec = specimen::recording(1.0, |_| 1.0);
    // The same columns read as a clock of 20 kHz.
    let t = (0..rec.len()).map(|k| 5e-5 * k as f64).collect();
    let fast = Recording::new("fast", t, rec.metadata.clone()).expect("a clock");
    rec = rec.channels().fold(fast, |to, (c, x)| {
        to.with_channel(c, x.to_vec()).expect("as long")
    });
    let case = case_of(&rec);
    // 10 kHz of double steps to about 5.5 kHz.
    assert_eq!(case.decimation, 2);
    assert!((case.t_row() - 2e-4).abs() < 1e-12);
    assert_eq!(case.measured.len(), 1250);
}

/// Three phases that share 3 V have a zero sequence of 3 V.
#[test]
fn the_zero_sequence_is_the_mean_of_the_phases() {
    let rec = changed(&specimen::recording(0.3, |_| 1.0), |c, x| {
        let shift = if Channel::VOLTAGES.contains(&c) {
            3.0
        } else {
            0.0
        };
        Some(x.iter().map(|x| x + shift).collect())
    });
    let case = case_of(&rec);
    assert!(case.measured.iter().all(|row| (row[4] - 3.0).abs() < 1e-9));
}

#[test]
fn what_cannot_be_judged_is_told_with_a_remedy() {
    let rec = specimen::recording(1.0, |_| 1.0);
    let without = |channel| changed(&rec, |c, x| (c != channel).then_some(x));
    assert!(reason(&without(Channel::VOLTAGES[1])).contains("voltages"));
    assert!(reason(&without(Channel::CURRENTS[0])).contains("currents"));
    assert!(reason(&specimen::recording(0.19, |_| 1.0)).contains("shorter"));
    assert!(Waveform::new(&specimen::recording(0.21, |_| 1.0), &rated()).is_ok());
    let mut t = rec.t().to_vec();
    t[100..].iter_mut().for_each(|t| *t += 0.02 * T_SAMPLE);
    let torn = Recording::new("torn", t, rec.metadata.clone()).expect("rising");
    assert!(
        check_clock(&torn)
            .expect_err("uneven")
            .reason
            .contains("t = 0.0198")
    );
    assert_eq!(check_clock(&rec), Ok(()));
}

/// Declared noise; without a declaration what the samples show; never nothing.
#[test]
fn noise_is_declared_or_estimated_and_never_zero() {
    let rec = specimen::recording(0.3, |_| 1.0);
    let current = rec.currents().expect("three")[0];
    assert_eq!(sigma(&rec, Channel::CURRENTS[0], current), 0.005);
    let bare = Recording::new("bare", rec.t().to_vec(), Metadata::default()).expect("a clock");
    let noisy: Vec<f64> = (0..1000).map(|k| f64::from(k * k % 1009)).collect();
    assert_eq!(
        sigma(&bare, Channel::SPEED, &noisy),
        estimated_sigma(&noisy)
    );
    assert_eq!(sigma(&bare, Channel::SPEED, &[3.0; 100]), 3e-6);
    // Whose resolution alone is declared is at least as noisy as its rounding.
    let mut converted = bare.clone();
    converted.metadata.sensors.speed_full_scale_rad_s = Some(2048.0);
    converted.metadata.sensors.adc_bits = Some(12);
    let of_speed = |x: &[f64]| sigma(&converted, Channel::SPEED, x);
    assert_eq!(of_speed(&noisy), estimated_sigma(&noisy));
    assert_eq!(of_speed(&[3.0; 100]), 1.0 / 12f64.sqrt());
    assert_eq!(sigma(&bare, Channel::SPEED, &[0.0; 100]), 1e-9);
}

#[test]
fn a_current_at_its_full_scale_is_not_judged() {
    const LIMIT: f64 = 0.999 * 5.0;
    let rec = specimen::recording(0.3, |_| 1.0);
    let clipped = changed(&rec, |c, x| {
        Some(if c == Channel::CURRENTS[1] {
            // A thousandth below the end of the scale counts as the end.
            x.iter()
                .map(|x| if *x > 1.0 { LIMIT } else { *x })
                .collect()
        } else {
            x
        })
    });
    let case = case_of(&clipped);
    for (measured, weight) in case.measured.iter().zip(&case.weight) {
        assert_eq!(weight[1] == 0.0, measured[1] == LIMIT);
        assert!(weight[0] > 0.0);
    }
}

/// Without a declared full scale a top that stands still is a clipped one.
#[test]
fn a_flat_top_is_the_end_of_the_scale() {
    let bare = Recording::new("bare", vec![0.0, 1.0], Metadata::default()).expect("a clock");
    let wave = |limit: f64| -> Vec<f64> {
        (0..1000)
            .map(|k| (0.05 * f64::from(k)).sin().clamp(-limit, limit))
            .collect()
    };
    assert_eq!(clip_limit(&bare, 0, &wave(2.0)), f64::INFINITY);
    assert!((clip_limit(&bare, 0, &wave(0.8)) - 0.99 * 0.8).abs() < 1e-12);
    // Three samples in a row that stand still, three times, are enough; fewer may be chance.
    let plateau = |n: usize| {
        let mut x = wave(2.0);
        x[500..500 + n].fill(1.5);
        x
    };
    assert_eq!(clip_limit(&bare, 0, &plateau(4)), f64::INFINITY);
    assert!((clip_limit(&bare, 0, &plateau(5)) - 0.99 * 1.5).abs() < 1e-12);
    // A level that is held below the top is no clipping.
    let mut held = wave(2.0);
    held[300..320].fill(0.5);
    assert_eq!(clip_limit(&bare, 0, &held), f64::INFINITY);
}

/// A motor that is switched off at 0.5 s and on again at 0.8 s.
#[test]
fn an_open_switch_is_found_and_its_moments_are_not_judged() {
    let rec = specimen::recording(1.2, |_| 1.0);
    let off = |k: usize| (2500..4000).contains(&k);
    let noise = |k: usize| 0.005 * ((k * 7_919 % 1000) as f64 / 500.0 - 1.0);
    let rec = changed(&rec, |c, x| {
        let current = Channel::CURRENTS.contains(&c);
        let at = |(k, x): (usize, &f64)| if current && off(k) { noise(k) } else { *x };
        Some(x.iter().enumerate().map(at).collect())
    });
    let case = case_of(&rec);
    assert_eq!(case.open.len(), 1, "{:?}", case.open);
    let open = case.open[0].clone();
    assert!(
        open.start.abs_diff(2500) <= 2 && open.end.abs_diff(4000) <= 4,
        "{open:?}"
    );
    let judged = |k: usize| case.weight[k / 2][0] > 0.0;
    // Two milliseconds before the switch opens, and until 30 ms after, nothing can be said about the current. Rows are
    // even samples, and so is the first that is open.
    assert_eq!(open.start % 2, 0);
    assert!(judged(open.start - 12) && !judged(open.start - 10));
    assert!(!judged(open.start + 150) && judged(open.start + 152));
    // Speed and voltage are judged all the time.
    assert!(case.weight.iter().all(|w| w[3] > 0.0 && w[4] > 0.0));
}

#[test]
fn held_or_slow_voltages_are_not_interpolated() {
    let mut rec = specimen::recording(0.3, |_| 1.0);
    assert_eq!(between(&rec, 2.6e-4), Between::Smooth);
    assert_eq!(between(&rec, 2.7e-4), Between::Held);
    rec.metadata.voltage = VoltageKind::Hold;
    assert_eq!(between(&rec, 1e-4), Between::Held);
}

#[test]
fn the_load_is_what_is_declared_or_measured() {
    let rec = specimen::recording(0.3, |_| 1.0);
    let load = Load::new(&rec).expect("known");
    assert!(!load.unknown && load.torque.value.iter().all(|x| (x - 1.0).abs() < 1e-9));
    assert!((load.torque.noise - SIGMA[3]).abs() < 1e-12);
    let mut friction = rec.clone();
    friction.metadata.load_torque = LoadTorque::Friction;
    let load = Load::new(&friction).expect("known");
    assert!(
        !load.unknown && load.torque.noise == 0.0 && load.torque.value.iter().all(|x| *x == 0.0)
    );
    let free = changed(&rec, |c, x| (c != Channel::TORQUE).then_some(x));
    assert!(
        Load::new(&free).expect("a speed").unknown,
        "the measured speed takes the place of the load"
    );
    let nothing = changed(&free, |c, x| (c != Channel::SPEED).then_some(x));
    let refused = Load::new(&nothing)
        .err()
        .expect("nothing says what the load is");
    assert!(refused.remedy.contains("`speed`") && refused.remedy.contains("`torque`"));
}

#[test]
fn a_free_load_makes_the_speed_an_input() {
    let rec = specimen::recording(0.5, |_| 1.0);
    let free = changed(&rec, |c, x| (c != Channel::TORQUE).then_some(x));
    let case = case_of(&free);
    assert!(case.speed_is_input);
    assert!(
        case.weight.iter().all(|w| w[3] == 0.0),
        "an input is not judged"
    );
}

#[test]
fn angle_and_smoothed_speed_follow_the_measured_speed() {
    let rec = specimen::recording(0.5, |_| 1.0);
    let ramp: Vec<f64> = rec.t().iter().map(|t| 100.0 + 40.0 * t).collect();
    let rec = changed(&rec, |c, x| {
        Some(if c == Channel::SPEED { ramp.clone() } else { x })
    });
    let theta = measured_angle(&rec);
    let speed = measured_speed(&rec, T_SAMPLE).value;
    for (k, t) in rec.t().iter().enumerate() {
        // Trapezoids of a straight line are exact.
        assert!((theta[k] - (100.0 * t + 20.0 * t * t)).abs() < 1e-9);
        assert!((speed[k] - (100.0 + 40.0 * t)).abs() < 1e-9);
    }
    let without = changed(&rec, |c, x| (c != Channel::SPEED).then_some(x));
    assert!(
        measured_angle(&without).is_empty() && measured_speed(&without, T_SAMPLE).value.is_empty()
    );
}

#[test]
fn a_motor_runs_at_the_start_if_it_is_declared_or_seen() {
    let rated = rated();
    let omega = specimen::point(1.0).omega_mech;
    let at = |starts_from, scale: f64, speed: bool| {
        let mut rec = changed(&specimen::recording(0.3, |_| 1.0), |c, x| {
            let gain = if c == Channel::TORQUE { 1.0 } else { scale };
            (speed || c != Channel::SPEED).then(|| x.iter().map(|x| gain * x).collect())
        });
        rec.metadata.starts_from = starts_from;
        running_at(&rec, &rated)
    };
    assert_eq!(at(StartsFrom::Standstill, 1.0, false), None);
    // An offset of the sensor.
    assert_eq!(at(StartsFrom::Standstill, 0.15, true), None);
    let close = |got: Option<f64>, expected: f64| {
        assert!(
            (got.expect("running") - expected).abs() < 1e-9,
            "{got:?} {expected}"
        );
    };
    close(at(StartsFrom::Running, 1.0, true), omega);
    // What the speed denies.
    close(at(StartsFrom::Standstill, 1.0, true), omega);
    close(at(StartsFrom::Unknown, 1.0, true), omega);
    assert_eq!(
        at(StartsFrom::Unknown, 0.01, true),
        None,
        "neither current nor speed"
    );
    close(at(StartsFrom::Running, 1.0, false), rated.speed());
}

/// A jitter from sample to sample goes, over 10 ms; what is left of it is its share of some fifty samples.
#[test]
fn a_smoothed_speed_has_lost_its_jitter() {
    let rec = changed(&specimen::recording(0.3, |_| 1.0), |c, x| {
        let jitter = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let speed = (0..x.len()).map(|k| 100.0 + jitter(k)).collect();
        Some(if c == Channel::SPEED { speed } else { x })
    });
    let smoothed = measured_speed(&rec, T_SAMPLE).value;
    assert!(smoothed[100..1400].iter().all(|w| (w - 100.0).abs() < 0.1));
}

/// The mean of the first 20 ms: a hundred samples of a ramp.
#[test]
fn the_speed_at_the_start_is_a_mean_over_a_period() {
    let mut rec = changed(&specimen::recording(0.3, |_| 1.0), |c, x| {
        let ramp = (0..x.len()).map(|k| 100.0 + k as f64).collect();
        Some(if c == Channel::SPEED { ramp } else { x })
    });
    rec.metadata.starts_from = StartsFrom::Running;
    let start = running_at(&rec, &rated());
    // One sample more or less is rounding.
    assert!(
        (start.expect("running") - (100.0 + 49.5)).abs() < 0.6,
        "{start:?}"
    );
}

/// Switched on with the first sample: no current yet, and a rotor that has not moved.
#[test]
fn a_start_that_begins_with_the_recording_is_a_start() {
    let rated = rated();
    let rec = changed(&specimen::recording(0.3, |_| 1.0), |c, x| {
        let from_zero = |per_s: f64| (0..x.len()).map(|k| per_s * k as f64 * T_SAMPLE).collect();
        Some(match c {
            Channel::SPEED => from_zero(10.0 * rated.speed()),
            c if Channel::CURRENTS.contains(&c) => from_zero(200.0 * rated.current),
            _ => x,
        })
    });
    let mut rec = rec;
    rec.metadata.starts_from = StartsFrom::Unknown;
    assert_eq!(running_at(&rec, &rated), None);
}

/// A tenth of the rated current, a twentieth of the rated speed: below both it stands, above one it runs.
#[test]
fn an_undeclared_start_runs_with_current_or_speed() {
    let rated = rated();
    let runs = |currents: [f64; 2], speed: f64| {
        let rec = changed(&specimen::recording(0.3, |_| 1.0), |c, x| {
            let value = match Channel::CURRENTS.iter().position(|i| *i == c) {
                Some(phase) => [currents[0], currents[1], 9.0][phase] * rated.current,
                None if c == Channel::SPEED => speed * rated.speed(),
                None => return Some(x),
            };
            Some(vec![value; x.len()])
        });
        let mut rec = rec;
        rec.metadata.starts_from = StartsFrom::Unknown;
        running_at(&rec, &rated).is_some()
    };
    assert!(!runs([0.09, -0.09], 0.04) && !runs([-0.09, 0.0], -0.04));
    assert!(runs([0.11, 0.0], 0.0) && runs([0.0, -0.11], 0.0));
    assert!(runs([0.0, 0.0], 0.06) && runs([0.0, 0.0], -0.06));
}

/// A sensor that shows a quarter too much: what the simulation is given is what the shaft does.
#[test]
fn a_free_scale_is_taken_out_of_everything_that_holds_the_speed() {
    let rec = specimen::recording(0.5, |_| 1.0);
    let mut case = case_of(&rec);
    let mut plant = specimen::prior("").plant;
    let mut scale = specimen::effect("speed-scale", 1.0);
    scale.values[0] = 0.25;
    plant.effects.push(scale);
    let same = case.as_seen_by(&plant);
    assert_eq!(
        (&same.speed, &same.measured),
        (&case.speed, &case.measured),
        "it is known"
    );
    assert_eq!(same.timeline.theta_mech, case.timeline.theta_mech);

    case.speed_scale_is_free = true;
    let seen = case.as_seen_by(&plant);
    let running_at = case.running_at.expect("it runs");
    assert_eq!(seen.running_at, Some(running_at / 1.25));
    let timeline = (&seen.timeline, &case.timeline);
    assert_eq!(timeline.0.t_sample, timeline.1.t_sample);
    assert_eq!(timeline.0.omega_sync, timeline.1.omega_sync);
    for k in [0, 1, 999, 2499] {
        assert_eq!(seen.speed[k], case.speed[k] / 1.25);
        assert_eq!(timeline.0.theta_mech[k], timeline.1.theta_mech[k] / 1.25);
    }
    for row in [0, 1, 777] {
        for k in 0..N_CHANNELS {
            let gain = if k == SPEED { 1.25 } else { 1.0 };
            assert_eq!(seen.measured[row][k], case.measured[row][k] / gain);
            assert_eq!(seen.weight[row][k], case.weight[row][k] * gain);
        }
    }
    plant.effects.clear();
    assert_eq!(case.as_seen_by(&plant).speed, case.speed);
}
