use super::*;
use proptest::prelude::*;

const T_SAMPLE: f32 = 1e-4;

fn balanced(positive: Complex32) -> [Complex32; 3] {
    let turn = Complex32::from_polar(1.0, TAU / 3.0);
    [positive, positive * turn.conj(), positive * turn]
}

/// A cycle of balanced voltages and currents, `samples` long, with a measured speed.
fn cycle(u: Complex32, i: Complex32, samples: f32, omega_mech: f32) -> Cycle {
    let mut cycle = Cycle::default();
    let phasors = balanced(u).into_iter().chain(balanced(i));
    for (channel, phasor) in cycle.phasors.channels.iter_mut().zip(phasors) {
        channel.phasor = phasor;
    }
    cycle.phasors.samples = samples;
    cycle.speed.omega_mech = Some(omega_mech);
    cycle
}

/// Five cycles of a supply whose oscillator stands still while it speeds up: its angle grows as a parabola.
#[test]
fn a_supply_that_speeds_up_has_its_rate() {
    for length in [2_usize, 3, 5, 10] {
        let mut state = WindowState::default();
        for k in 0..length {
            let angle = 0.5 * 30.0 * (k as f32 * 0.02).powi(2);
            let u = Complex32::from_polar(300.0, angle);
            state.push(cycle(u, u * 0.01, 200.0, 150.0), length);
        }
        let supply = state.measure(length, T_SAMPLE).expect("full").rates.supply;
        let expected = if length > 2 { 30.0 } else { 0.0 };
        // Single precision of an angle, 1e-7 of a turn, twice differentiated over 0.02 s.
        assert!((supply - expected).abs() < 0.02, "{length}: {supply}");
    }
}

fn plain(i: Complex32) -> Cycle {
    cycle(Complex32::new(300.0, 0.0), i, 200.0, 150.0)
}

fn window_of(cycles: &[Cycle]) -> Window {
    let mut state = WindowState::default();
    for cycle in cycles {
        state.push(*cycle, cycles.len());
    }
    state.measure(cycles.len(), T_SAMPLE).expect("full")
}

#[test]
fn a_window_takes_the_latest_cycles_and_no_fewer() {
    let mut state = WindowState::default();
    for k in 0..50_u16 {
        let mut cycle = plain(Complex32::ONE);
        cycle.speed.omega_mech = Some(f32::from(k));
        state.push(cycle, 3);
        let window = state.measure(3, T_SAMPLE);
        assert_eq!(window.is_some(), k >= 2, "after {k}");
        if let Some(window) = window {
            assert_eq!(window.omega_mech, Some(f32::from(k - 1)), "mean of three");
            assert!(
                (window.rates.speed * 0.02 - 1.0).abs() < 1e-5,
                "one more a cycle"
            );
        }
    }
    // Three were to be kept: more cannot be had.
    assert!(state.measure(4, T_SAMPLE).is_none());
    state.clear();
    assert!(state.measure(2, T_SAMPLE).is_none());
}

/// The ring holds what it is long, whatever is asked of it.
#[test]
fn lengths_are_kept_between_two_and_the_longest() {
    let mut state = WindowState::default();
    for _ in 0..MAX_WINDOW_CYCLES {
        state.push(plain(Complex32::ONE), 1000);
    }
    assert!(state.measure(1000, T_SAMPLE).is_some());
    let shortest = state.measure(0, T_SAMPLE).expect("two cycles");
    // From the middle of one cycle of 20 ms to the middle of the next.
    assert!((shortest.span - 0.02).abs() < 1e-7);
}

/// Speed and torque are means over time; a longer cycle counts for more.
#[test]
fn speed_and_torque_are_weighted_by_time() {
    let u = Complex32::new(300.0, 0.0);
    let mut cycles = [100.0, 300.0].map(|samples| cycle(u, Complex32::ONE, samples, samples));
    for (cycle, tau) in cycles.iter_mut().zip([2.0, 6.0]) {
        cycle.torque.mean = Some(tau);
    }
    let window = window_of(&cycles);
    assert_eq!(
        window.omega_mech,
        Some((100.0 * 100.0 + 300.0 * 300.0) / 400.0)
    );
    assert_eq!(window.tau_load, Some((100.0 * 2.0 + 300.0 * 6.0) / 400.0));
    assert!(
        (window.span - 200.0 * T_SAMPLE).abs() < 1e-7,
        "middle to middle"
    );
    cycles[0].torque.mean = None;
    assert_eq!(window_of(&cycles).tau_load, None);
}

#[test]
fn cycles_without_length_have_no_mean() {
    let mut empty = plain(Complex32::ONE);
    empty.phasors.samples = 0.0;
    assert_eq!(window_of(&[empty; 2]).omega_mech, None);
}

#[test]
fn phasors_offsets_and_squares_are_means() {
    let mut cycles = [
        plain(Complex32::new(2.0, 0.0)),
        plain(Complex32::new(0.0, 4.0)),
    ];
    for (cycle, x) in cycles.iter_mut().zip([1.0, 3.0]) {
        for channel in &mut cycle.phasors.channels {
            channel.offset = x;
            channel.mean_square = x * x;
        }
    }
    let window = window_of(&cycles);
    let channel = window.channels[3];
    assert_eq!(channel.phasor, Complex32::new(1.0, 2.0));
    assert_eq!((channel.offset, channel.mean_square), (2.0, 5.0));
    assert!((window.i_s.positive - Complex32::new(1.0, 2.0)).norm() < 1e-6);
    assert!((window.u_s.positive - Complex32::new(300.0, 0.0)).norm() < 1e-4);
}

#[test]
fn what_happened_in_any_cycle_happened_in_the_window() {
    let mut cycles = [plain(Complex32::ONE); 3];
    cycles[0].clipped.mark_current(1);
    cycles[2].clipped.mark_voltage(2);
    for (cycle, n) in cycles.iter_mut().zip([1, 10, 100]) {
        cycle.invalid_samples = n;
        cycle.speed.glitches = 2 * n;
        cycle.speed.silent = true;
    }
    let window = window_of(&cycles);
    assert!(window.clipped.current(1) && window.clipped.voltage(2));
    assert_eq!((window.invalid_samples, window.glitches), (111, 222));
    assert!(window.encoder_silent);
    cycles[1].speed.silent = false;
    assert!(!window_of(&cycles).encoder_silent, "an edge came");
}

proptest! {
    /// The supply turns beyond the oscillator by the angle between the first and the last phasor. Four cycles of 20 ms
    /// between the middles: 0.5 rad are 6 rad/s, where the arcsine's series errs by some 1e-3.
    #[test]
    fn the_supply_is_faster_than_the_oscillator_by_its_phase_advance(ahead in -0.5f32..0.5, start in -3.0f32..3.0) {
        let volt = |k: f32| Complex32::from_polar(300.0, start + ahead * k / 4.0);
        let current = Complex32::from_polar(5.0, 1.0);
        for seen in [Complex32::new(1.0, 0.0), Complex32::ZERO] {
            // Without voltages the current is what turns.
            let turning = |k: f32| if seen == Complex32::ZERO { volt(k) } else { current };
            let cycles = [0.0, 1.0, 2.0, 3.0, 4.0].map(|k| cycle(volt(k) * seen, turning(k), 200.0, 150.0));
            let expected = (4.0 * TAU + ahead) / 0.08;
            prop_assert!((window_of(&cycles).omega_sync - expected).abs() < 0.02);
        }
    }
}

/// Half a radian is the most that the series is used for.
#[test]
fn a_large_phase_advance_is_held_at_half_a_radian() {
    let volt = |angle| Complex32::from_polar(300.0, angle);
    let advance = |angle| phase_advance(volt(0.0), volt(angle));
    let most = core::f32::consts::FRAC_PI_6; // arcsine of one half
    assert!((advance(1.5) - most).abs() < 1e-3);
    assert!((advance(-1.5) + most).abs() < 1e-3);
    // Exact to rounding where windows are steady.
    assert!((advance(0.1) - 0.1).abs() < 1e-6);
    assert!((advance(0.3) - 0.3).abs() < 3e-5);
    assert_eq!(phase_advance(Complex32::ZERO, volt(0.3)), 0.0);
}

/// A current that turns with the voltage does not change; one that ends elsewhere has changed by the way there.
#[test]
fn current_changes_as_the_voltage_sees_it() {
    let turned = |angle: f32, i: Complex32| {
        let axis = Complex32::from_polar(1.0, angle);
        cycle(axis * 300.0, axis * i, 200.0, 150.0)
    };
    let i = Complex32::new(3.0, -4.0);
    let steady = window_of(&[0.0, 0.2, 0.4].map(|angle| turned(angle, i)));
    assert!(steady.rates.current.norm() < 1e-3 && steady.current_bend < 1e-5);
    let step = Complex32::new(0.3, 0.4);
    let moving = [
        turned(0.0, i),
        turned(0.1, i + step),
        turned(0.2, i + step * 2.0),
    ];
    let moving = window_of(&moving);
    // The voltage's own turning shortens the cycles by half a per cent.
    assert!(
        (moving.rates.current * 0.02 - step).norm() < 0.01,
        "{moving:?}"
    );
    assert!(moving.current_bend < 1e-5);
    // There and back: no slope, two thirds of the way off the mean.
    let excursion = window_of(&[
        turned(0.0, i),
        turned(0.1, i + Complex32::new(0.6, 0.0)),
        turned(0.2, i),
    ]);
    assert!(excursion.rates.current.norm() < 1e-3);
    assert!((excursion.current_bend - 0.4).abs() < 1e-5);
}

#[test]
fn without_voltages_only_the_size_of_a_current_tells_its_change() {
    let current = |r, angle| {
        cycle(
            Complex32::ZERO,
            Complex32::from_polar(r, angle),
            200.0,
            150.0,
        )
    };
    let rate = |cycles: [Cycle; 2]| window_of(&cycles).rates.current.norm() * 0.02;
    assert!(rate([current(5.0, 0.0), current(5.0, 0.4)]) < 1e-5);
    assert!((rate([current(5.0, 0.0), current(4.0, 0.4)]) - 1.0).abs() < 1e-5);
}

#[test]
fn a_growing_voltage_has_its_rate() {
    let cycles =
        [300.0, 303.0, 306.0].map(|u| cycle(Complex32::new(u, 0.0), Complex32::ONE, 200.0, 150.0));
    assert!((window_of(&cycles).rates.voltage - 150.0).abs() < 0.01);
}

/// A gain acts on amplitude and offset once and on the mean square twice.
#[test]
fn a_channel_gain_corrects_all_that_the_channel_says() {
    let mut cycle = plain(Complex32::ONE);
    cycle.phasors.channels[4].offset = 3.0;
    cycle.phasors.channels[4].mean_square = 5.0;
    let before = cycle.phasors.channels;
    let after = cycle
        .corrected(&[1.0, 1.0, 1.0, 1.0, 3.0, 1.0])
        .phasors
        .channels;
    assert_eq!(after[4].phasor, before[4].phasor * 3.0);
    assert_eq!((after[4].offset, after[4].mean_square), (9.0, 45.0));
    assert_eq!((after[3], after[5]), (before[3], before[5]));
}

/// What an oscillator of 200 samples a turn makes of phases whose supply turns by `1 + error` meanwhile, by plain sums:
/// a balanced fundamental of 300 V and 4 A and a harmonic of an order whose sign is its sequence, a share of it.
fn cycles_of_a_faster_supply(error: f64, cycles: usize, [order, share]: [f64; 2]) -> Vec<Cycle> {
    let turn = |k: usize| core::f64::consts::TAU * k as f64 / 200.0;
    let wave = |k: usize, phase: f64| {
        let theta = (1.0 + error) * turn(k) - phase;
        let harmonic = order.abs() * (1.0 + error) * turn(k) - order.signum() * phase;
        theta.cos() + share * harmonic.cos()
    };
    let of = |cycle: usize, amplitude: f64, phase: f64| {
        let mut channel = ChannelCycle::default();
        for k in 200 * cycle..200 * (cycle + 1) {
            let x = amplitude * wave(k, phase);
            let axis = Complex32::new(turn(k).cos() as f32, -turn(k).sin() as f32);
            channel.phasor += axis * (x / 100.0) as f32;
            channel.mean_square += (x * x / 200.0) as f32;
        }
        channel
    };
    let mut all = Vec::new();
    for k in 0..cycles {
        let mut cycle = cycle(Complex32::ZERO, Complex32::ZERO, 200.0, 150.0);
        for (n, channel) in cycle.phasors.channels.iter_mut().enumerate() {
            let phase = (n % 3) as f64 * core::f64::consts::TAU / 3.0;
            *channel = of(k, [300.0, 4.0][n / 3], phase + (n / 3) as f64 * 0.5);
        }
        all.push(cycle);
    }
    all
}

/// The space vector of a harmonic of order `h` leaves `h/(h - 1) e` of itself in the positive and `h/(h + 1) e` in the negative
/// sequence: 0.8 to 1.3 times the share of the cycle's error, and the noise that it counts as is that share over sqrt(2).
#[test]
fn harmonics_leak_by_no_more_than_twice_the_noise_that_they_count_as() {
    let error = 0.005;
    for order in [-5.0, 7.0, -11.0, 13.0] {
        let clean = window_of(&cycles_of_a_faster_supply(error, 5, [order, 0.0]));
        let window = window_of(&cycles_of_a_faster_supply(error, 5, [order, 0.05]));
        let counted = window.leakage(T_SAMPLE) * window.cycle_noise(T_SAMPLE).voltage;
        for leaked in [
            window.u_s.positive - clean.u_s.positive,
            window.u_s.negative - clean.u_s.negative,
        ] {
            let ratio = magnitude(leaked) / counted;
            assert!((0.8..2.0).contains(&ratio), "{order}: {ratio}");
        }
    }
}

/// A frequency that has just changed by one per cent: without a correction an unbalance of half a per cent that the motor does
/// not answer as one, and a voltage that is 0.4 % too low.
#[test]
fn a_supply_that_has_outrun_the_oscillator_is_balanced_and_as_high_as_before() {
    for error in [-0.01_f64, -0.003, 0.001, 0.01] {
        let cycles = cycles_of_a_faster_supply(error, 5, [5.0, 0.0]);
        let of_one = Sequence::from_phases(phases_of(&cycles[0].phasors.channels)[0]);
        let uncorrected = f64::from(magnitude(of_one.unbalance()));
        assert!(
            (uncorrected / (0.5 * error.abs()) - 1.0).abs() < 0.02,
            "{uncorrected}"
        );
        let window = window_of(&cycles);
        assert!((f64::from(window.turn_error) - error).abs() < 0.02 * error.abs());
        // Sums begin at a sample, half a step before what an integral would: 2 pi/200 of the image, which is half of the error.
        // The rest is of second order.
        let left = 0.016 * error.abs() + 2.0 * error * error + 1e-6;
        for (sequence, amplitude) in [(&window.u_s, 300.0), (&window.i_s, 4.0)] {
            let length = f64::from(magnitude(sequence.positive)) / amplitude;
            assert!((length - 1.0).abs() < left, "{error}: {length}");
            assert!(
                f64::from(magnitude(sequence.unbalance())) < left,
                "{sequence:?}"
            );
        }
        let phase_a = f64::from(magnitude(window.channels[0].phasor));
        assert!((phase_a / 300.0 - 1.0).abs() < left, "{error}: {phase_a}");
    }
}
