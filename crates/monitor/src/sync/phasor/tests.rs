use super::*;
use core::f64::consts::TAU;
use proptest::prelude::*;

/// Feeds an ideal oscillator at `hertz` and 10 kHz; the second complete cycle of the signal comes back.
fn second_cycle(hertz: f64, signal: impl Fn(f64) -> f64) -> CyclePhasors {
    let mut state = PhasorState::default();
    let mut finished = 0;
    for k in 0..20_000 {
        let turn = hertz * f64::from(k) * 1e-4;
        let (now, next) = (turn.floor(), (turn + hertz * 1e-4).floor());
        let tick = SyncTick {
            axis: Complex32::new((TAU * turn).cos() as f32, (TAU * turn).sin() as f32),
            omega: (TAU * hertz) as f32,
            turn_ends: (next > now).then(|| ((next - turn) / (hertz * 1e-4)) as f32),
            restarted: false,
        };
        let x = signal(TAU * turn) as f32;
        if let Some(cycle) = state.update(
            &tick,
            &[x, x, x, 2.0 * x, 2.0 * x, 2.0 * x],
            &[Unit::SI; CHANNELS],
        ) {
            finished += 1;
            if finished == 2 {
                return cycle;
            }
        }
    }
    unreachable!("the loop ends with the second cycle")
}

proptest! {
    #[test]
    fn offset_and_fundamental_are_separated_at_any_frequency(
        hertz in 5.0f64..100.0, amplitude in 1.0f64..500.0, angle in -3.0f64..3.0, offset in -20.0f64..20.0,
    ) {
        let cycle = second_cycle(hertz, |x| offset + amplitude * (x + angle).cos());
        let truth = Complex32::from_polar(amplitude as f32, angle as f32);
        // 2000 f32 additions at 5 Hz: 2000 half-ulps at worst, 45 as a random walk; a factor 4 in between.
        let tolerance = (amplitude + offset.abs()) as f32 * 1e-5;
        prop_assert!((cycle.channels[0].phasor - truth).norm() < tolerance);
        prop_assert!((cycle.channels[3].phasor - truth * 2.0).norm() < 2.0 * tolerance);
        prop_assert!((f64::from(cycle.channels[0].offset) - offset).abs() < f64::from(tolerance));
    }

    /// The shared sample leaves a leakage of a harmonic of order (h * dtheta)^2 / 12 of one sample's weight.
    #[test]
    fn harmonics_stay_out(hertz in 40.0f64..65.0, angle in -3.0f64..3.0) {
        let cycle = second_cycle(hertz, |x| x.cos() + 0.08 * (5.0 * x + angle).cos());
        prop_assert!((cycle.channels[0].phasor - Complex32::ONE).norm() < 1e-3);
    }
}

#[test]
fn the_mean_square_is_that_of_the_signal() {
    let cycle = second_cycle(50.0, |x| 3.0 * x.cos() + 1.0);
    assert!((cycle.channels[0].mean_square - (4.5 + 1.0)).abs() < 1e-3);
    assert!((cycle.samples - 200.0).abs() < 0.01);
}

#[test]
fn too_few_samples_give_no_phasor() {
    let mut state = PhasorState::default();
    let tick = SyncTick {
        axis: Complex32::ONE,
        omega: 314.0,
        turn_ends: Some(0.5),
        restarted: false,
    };
    assert_eq!(
        state.update(&tick, &[1.0; CHANNELS], &[Unit::SI; CHANNELS]),
        None
    );
}

const RANGE: CodeRange = CodeRange {
    zero: [2048.0, 1000.0],
    lowest: 2,
    highest: 4093,
};

/// Codes of whole numbers near the middle: single precision sums them without rounding.
fn instants() -> ([[u16; CHANNELS]; 8], [Complex32; 8]) {
    let codes =
        core::array::from_fn(|k| core::array::from_fn(|n| (2000 + 100 * n + 37 * k % 91) as u16));
    let axes = core::array::from_fn(|k| Complex32::from_polar(1.0, k as f32 * 0.7));
    (codes, axes)
}

/// In bulk as one by one, to the last bit: the order of voltages and currents is that of the converter.
#[test]
fn codes_in_bulk_are_summed_up_like_instants() {
    let (codes, axes) = instants();
    let mut bulk = PhasorState::default();
    assert!(bulk.add_codes::<true>(&codes, &axes, &RANGE));
    let mut single = PhasorState::default();
    for ([v_a, i_a, v_b, i_b, v_c, i_c], axis) in codes.into_iter().zip(axes) {
        let tick = SyncTick {
            axis,
            omega: 314.0,
            turn_ends: None,
            restarted: false,
        };
        let volt = [v_a, v_b, v_c].map(|code| f32::from(code) - 2048.0);
        let ampere = [i_a, i_b, i_c].map(|code| f32::from(code) - 1000.0);
        let x = [volt[0], volt[1], volt[2], ampere[0], ampere[1], ampere[2]];
        assert_eq!(single.update(&tick, &x, &[Unit::SI; CHANNELS]), None);
    }
    assert_eq!(bulk, single);
}

#[test]
fn a_code_at_a_rail_is_told_whichever_channel_it_is_in() {
    let (sound, axes) = instants();
    for channel in 0..CHANNELS {
        for (code, inside) in [(1, false), (2, true), (4093, true), (4094, false)] {
            let mut codes = sound;
            codes[3][channel] = code;
            let told = PhasorState::default().add_codes::<true>(&codes, &axes, &RANGE);
            assert_eq!(told, inside, "{code} in channel {channel}");
        }
    }
}

/// What is summed up in codes comes out in V and A: `scale * x - offset` of every code.
#[test]
fn units_apply_to_phasor_offset_and_mean_square() {
    let unit = Unit {
        scale: 0.15,
        offset: 4.0,
    };
    let mut state = PhasorState::default();
    let (mut square, n) = (0.0, 200);
    let mut last = None;
    for k in 0..=n {
        let angle = TAU * f64::from(k) / f64::from(n);
        let code = (1000.0 * (angle + 0.5).cos() + 100.0) as f32;
        let tick = SyncTick {
            axis: Complex32::new(angle.cos() as f32, angle.sin() as f32),
            omega: 314.0,
            // The instant at which the turn is complete belongs to the next one.
            turn_ends: (k == n).then_some(0.0),
            restarted: false,
        };
        if k < n {
            square += f64::from(0.15 * code - 4.0).powi(2) / f64::from(n);
        }
        last = state.update(&tick, &[code; CHANNELS], &[unit; CHANNELS]);
    }
    let channel = last.expect("a complete turn").channels[5];
    assert!((channel.phasor - Complex32::from_polar(150.0, 0.5)).norm() < 1e-2);
    assert!((channel.offset - (15.0 - 4.0)).abs() < 1e-2);
    assert!((f64::from(channel.mean_square) / square - 1.0).abs() < 1e-4);
}

#[test]
fn a_restart_forgets_what_was_summed_up() {
    let mut state = PhasorState::default();
    let mut tick = SyncTick {
        axis: Complex32::ONE,
        omega: 314.0,
        turn_ends: None,
        restarted: false,
    };
    state.update(&tick, &[5.0; CHANNELS], &[Unit::SI; CHANNELS]);
    let mut fresh = PhasorState::default();
    fresh.update(&tick, &[1.0; CHANNELS], &[Unit::SI; CHANNELS]);
    tick.restarted = true;
    state.update(&tick, &[1.0; CHANNELS], &[Unit::SI; CHANNELS]);
    assert_eq!(state, fresh);
}

/// Normal equations of any instants are solved exactly: three fourths of a turn will do, a tenth will not.
#[test]
fn a_part_of_a_turn_gives_the_phasor_if_it_is_large_enough() {
    for (instants, enough) in [(150, true), (20, false)] {
        let mut state = PhasorState::default();
        let mut last = None;
        for k in 0..=instants {
            let angle = TAU * f64::from(k) / 200.0;
            let tick = SyncTick {
                axis: Complex32::new(angle.cos() as f32, angle.sin() as f32),
                omega: 314.0,
                turn_ends: (k == instants).then_some(0.5),
                restarted: false,
            };
            let x = (3.0 * (angle - 1.0).cos() + 2.0) as f32;
            last = state.update(&tick, &[x; CHANNELS], &[Unit::SI; CHANNELS]);
        }
        assert_eq!(last.is_some(), enough, "{instants} of 200 instants");
        if let Some(cycle) = last {
            assert!((cycle.samples - (instants as f32 + 0.5)).abs() < 1e-3);
            let channel = cycle.channels[2];
            assert!((channel.phasor - Complex32::from_polar(3.0, -1.0)).norm() < 1e-4);
            assert!((channel.offset - 2.0).abs() < 1e-4);
        }
    }
}

/// Three functions are told apart by four instants at least.
#[test]
fn three_instants_give_no_phasor_and_four_do() {
    for (instants, enough) in [(3, false), (4, true)] {
        let mut state = PhasorState::default();
        let mut last = None;
        for k in 0..=instants {
            let tick = SyncTick {
                axis: Complex32::from_polar(
                    1.0,
                    core::f32::consts::TAU * k as f32 / instants as f32,
                ),
                omega: 314.0,
                turn_ends: (k == instants).then_some(0.0),
                restarted: false,
            };
            last = state.update(&tick, &[tick.axis.re; CHANNELS], &[Unit::SI; CHANNELS]);
        }
        assert_eq!(last.is_some(), enough, "{instants} instants");
    }
}
