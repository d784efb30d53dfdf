//! A sample is the mean of sixteen conversions over 100 us, each at the time at which trigger, sequence and sampling time put
//! it: against closed forms, and against an inverter's ripple, which single conversions fold onto the supply.

mod common;

use std::f64::consts::{PI, TAU};

use board::modbus::Field;
use board::{Frame, Message};
use common::master::{Master, UNIT};
use common::{INHIBITED, LAMP_TEST_S, Sensors, board as board_of, firmware, motor, scenario};
use monitor::{Lamp, Monitor, MonitorConfig, MonitorState, NotJudged, RawSample, Report};
use num_complex::Complex64;
use virtual_board::{Inputs, VirtualBoard};

const SENSOR: usize = 5;
const HEALTHY: [bool; 9] = [true, false, false, false, false, false, false, false, false];
const SUPPLY_HZ: f64 = 60.0;
/// From one trigger to the next, s.
const TRIGGER_S: f64 = 6.25e-6;
/// From the trigger to the end of the first channel's sampling (12.5 cycles of 40 MHz), and from channel to channel (25).
const SAMPLING_S: f64 = 12.5 / 40e6;
const RANK_S: f64 = 25.0 / 40e6;
/// Place of each channel (voltages a, b, c, then currents a, b, c) in the sequence.
const RANKS: [usize; 6] = [0, 2, 4, 1, 3, 5];
/// Six cycles of the supply, in samples.
const SAMPLES: usize = 1_000;

/// Cosines at the pins of all channels: amplitude in codes, Hz.
#[derive(Clone)]
struct Pins(Vec<(f64, f64)>);

impl Pins {
    fn at(&self, t: f64) -> f64 {
        self.0
            .iter()
            .map(|(a, hertz)| a * (TAU * hertz * t).cos())
            .sum()
    }

    /// The mean of sixteen values `TRIGGER_S` apart, the last at `t`: each cosine shrunk by `sin(8 w h) / (16 sin(w h / 2))`
    /// and as late as the middle of the sixteen.
    fn mean(&self, t: f64) -> f64 {
        let middle = t - 7.5 * TRIGGER_S;
        let one = |(a, hertz): &(f64, f64)| {
            let half = PI * hertz * TRIGGER_S;
            let kept = if half.sin().abs() < 1e-12 {
                1.0
            } else {
                (16.0 * half).sin() / (16.0 * half.sin())
            };
            a * kept * (TAU * hertz * middle).cos()
        };
        self.0.iter().map(one).sum()
    }
}

impl Inputs for Pins {
    fn at(&mut self, _: u64) -> RawSample {
        RawSample {
            voltage_codes: [2_048; 3],
            current_codes: [2_048; 3],
            ..RawSample::default()
        }
    }

    fn ripple(&mut self, _: usize, t: f64) -> f64 {
        Pins::at(self, t)
    }
}

/// Time of the last trigger of a sample, s after the first trigger.
fn trigger(sample: usize) -> f64 {
    (16 * sample + 15) as f64 * TRIGGER_S
}

/// Phasor at the supply's frequency of a value for each sample. The first one holds the converter's wrong result after its pause.
fn phasor(value: impl Fn(usize) -> f64) -> Complex64 {
    let sum: Complex64 = (1..=SAMPLES)
        .map(|k| value(k) * Complex64::from_polar(1.0, -TAU * SUPPLY_HZ * trigger(k)))
        .sum();
    2.0 * sum / SAMPLES as f64
}

/// What the converter made of pins in each channel, in codes of a single conversion.
fn taken(pins: &Pins) -> [Complex64; 6] {
    let mut board =
        VirtualBoard::new(&firmware(), Box::new(pins.clone())).expect("a firmware that loads");
    board.run(LAMP_TEST_S + 0.15).expect("a run");
    let taken = board.taken();
    assert!(taken.len() > SAMPLES, "{}", taken.len());
    std::array::from_fn(|channel| {
        phasor(|k| {
            let raw = &taken[k];
            let codes = [raw.voltage_codes, raw.current_codes].concat();
            f64::from(codes[channel]) / 16.0 - 2_048.0
        })
    })
}

/// Share of the fundamental that steps of a code may be off by: 0.3 LSB over the root of 16 000 conversions of 900 LSB is 4e-6.
const STEPS: f64 = 3e-5;

#[test]
fn each_channel_is_late_by_the_mean_and_early_by_its_place_in_the_sequence() {
    let pins = Pins(vec![(900.0, SUPPLY_HZ)]);
    let shown = taken(&pins);
    for (channel, shown) in shown.into_iter().enumerate() {
        let late = 7.5 * TRIGGER_S - SAMPLING_S - RANKS[channel] as f64 * RANK_S;
        let half = PI * SUPPLY_HZ * TRIGGER_S;
        let kept = (16.0 * half).sin() / (16.0 * half.sin());
        let expected = Complex64::from_polar(900.0 * kept, -TAU * SUPPLY_HZ * late);
        let off = (shown - expected).norm() / 900.0;
        assert!(
            off < STEPS,
            "channel {channel}: {shown} instead of {expected}"
        );
    }
    // The order of conversion is seen: 0.625 us are 2.4e-4 of a turn's radian.
    let skew = (shown[3] / shown[0]).arg() / (TAU * SUPPLY_HZ);
    assert!((skew - RANK_S).abs() < 0.1e-6, "{skew}");
}

/// Bessel functions J1(pi/2) and J2(pi/4) of the sidebands of a two-level inverter at half its modulation.
const J1: f64 = 0.566_824_1;
const J2: f64 = 0.072_940_4;

/// Fundamental and sidebands of a sine-triangle inverter of a modulation of 0.5 behind the front end of docs/wiring.md:
/// `4/pi J_n(m M pi/2) / m` at `m fc + n f`, of half the direct voltage; the fundamental is M of it.
fn inverter(carrier_hz: f64) -> Pins {
    let behind = |share: f64, hertz: f64| {
        let poles = [78.1e-6, 7.05e-6].map(|tau| (TAU * hertz * tau).hypot(1.0).recip());
        (900.0 * share * poles[0] * poles[1], hertz)
    };
    let sidebands = [
        (1.0, 2.0, J2),
        (1.0, -2.0, J2),
        (2.0, 1.0, J1),
        (2.0, -1.0, J1),
    ];
    let mut pins = vec![(900.0, SUPPLY_HZ)];
    pins.extend(
        sidebands.map(|(m, n, bessel)| {
            behind(4.0 / PI * bessel / m / 0.5, m * carrier_hz + n * SUPPLY_HZ)
        }),
    );
    Pins(pins)
}

/// Share by which the fundamental is off what it would be without the carrier.
fn error(pins: &Pins, shown: Complex64, value: impl Fn(&Pins, f64) -> f64) -> f64 {
    let alone = Pins(pins.0[..1].to_vec());
    let t = |k: usize| trigger(k) + SAMPLING_S;
    let clean = phasor(|k| value(&alone, t(k)));
    (shown - clean).norm() / clean.norm()
}

/// Twice a carrier of 5 or 10 kHz is a multiple of the sampling rate: its sidebands fold onto the supply's frequency, where one
/// conversion a sample takes them for voltage. The mean over exactly a sampling time does not.
#[test]
fn sidebands_of_an_inverter_err_in_single_conversions_and_not_in_means() {
    for carrier_khz in [2.0, 4.0, 5.0, 8.0, 10.0, 16.0] {
        let pins = inverter(1e3 * carrier_khz);
        let t = |k: usize| trigger(k) + SAMPLING_S;
        let [measured, ..] = taken(&pins);
        let expected = phasor(|k| pins.mean(t(k)));
        assert!(
            (measured - expected).norm() / 900.0 < STEPS,
            "{carrier_khz} kHz: {measured} instead of {expected}"
        );
        let mean = error(&pins, measured, Pins::mean);
        let single = error(&pins, phasor(|k| pins.at(t(k))), Pins::at);
        println!(
            "{carrier_khz} kHz: single {:.2} %, mean {:.3} %",
            100.0 * single,
            100.0 * mean
        );
        assert!(mean < 0.002, "{carrier_khz} kHz: {mean}");
        let folds = [5.0, 10.0].contains(&carrier_khz);
        assert_eq!(single > 0.05, folds, "{carrier_khz} kHz: {single}");
    }
}

/// A motor's sensors with something on top of the voltages.
struct Rippled<F>(Sensors, F);

impl<F: FnMut(usize, f64) -> f64> Inputs for Rippled<F> {
    fn at(&mut self, index: u64) -> RawSample {
        self.0.at(index)
    }

    fn ripple(&mut self, channel: usize, t: f64) -> f64 {
        (self.1)(channel, t)
    }
}

fn rippled(ripple: impl FnMut(usize, f64) -> f64 + 'static) -> VirtualBoard {
    let inputs = Rippled(Sensors::new(&scenario(60.0)), ripple);
    VirtualBoard::new(&firmware(), Box::new(inputs)).expect("a firmware that loads")
}

/// Sidebands of a carrier of 5 kHz behind the front end in the phase voltages, in codes, by channel and time.
fn sidebands() -> impl Fn(usize, f64) -> f64 {
    let motor = motor();
    let fundamental = motor.nameplate.phase_voltage_amplitude() / motor.sensors.volt_per_code();
    let pins = inverter(5e3);
    let pair = [(3, 1.0), (4, -1.0)].map(|(k, n)| {
        let (share, hertz) = pins.0[k];
        (fundamental * share / 900.0, TAU * hertz, n * TAU / 3.0)
    });
    move |channel, t| {
        let one =
            |(a, omega, third): &(f64, f64, f64)| a * (omega * t - third * channel as f64).cos();
        if channel < 3 {
            pair.iter().map(one).sum()
        } else {
            0.0
        }
    }
}

/// Reports of the host's core on single conversions, one each 100 us, as the board took them before it took means.
fn single_conversions(seconds: f64) -> Vec<Report> {
    let config = MonitorConfig::from_motor_file(&motor(), 1e-4).expect("shipped");
    let monitor = Monitor::new(config).expect("valid");
    let mut state = MonitorState::default();
    let mut sensors = Sensors::new(&scenario(60.0));
    let sidebands = sidebands();
    let instants = 0..(seconds * 1e4) as u64;
    instants
        .filter_map(|k| {
            let mut raw = sensors.at(k);
            for (phase, code) in raw.voltage_codes.iter_mut().enumerate() {
                *code = (f64::from(*code) + sidebands(phase, k as f64 * 1e-4)).round() as u16;
            }
            monitor.update_raw(&mut state, &raw)
        })
        .collect()
}

#[test]
fn a_healthy_motor_on_an_inverter_lights_nothing() {
    let single = single_conversions(1.0);
    let last = single.last().expect("reports").lamps;
    assert_eq!(last.fault, Lamp::On, "single conversions: {last:?}");
    let mut board = rippled(sidebands());
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    for _ in 0..20 {
        board.run(0.02).expect("a run");
        assert_eq!(board.lamps(), HEALTHY);
    }
}

/// One conversion of sixteen at a rail: the sum is far from it, and the window must not be judged all the same.
#[test]
fn a_single_conversion_at_a_rail_counts() {
    // In every cycle of the supply, from 1.3 s on, for less than the time from one conversion of a channel to the next.
    let spike = |t: f64| t > 1.3 && t % 0.015 < 0.9 * TRIGGER_S;
    for (channel, to) in [(0, 1e4), (4, 1e4), (2, -1e4), (3, -1e4)] {
        let mut board = rippled(move |k, t| if k == channel && spike(t) { to } else { 0.0 });
        board.run(LAMP_TEST_S + 0.9).expect("a run");
        let before = Master::new(UNIT).word(&mut board, Field::NotJudged);
        assert_eq!((before, board.lamps()), (0, HEALTHY), "channel {channel}");
        board.run(0.9).expect("a run");
        let not_judged = Master::new(UNIT).word(&mut board, Field::NotJudged);
        assert_eq!(
            not_judged,
            NotJudged::Clipped.reason().number() as u16,
            "channel {channel}"
        );
        let host = common::host_lamps(board.taken());
        let levels = board.lamps();
        assert!(
            common::shows(levels, host.last().expect("samples")),
            "{levels:?}"
        );
        // Sums alone show nothing.
        let mut unmarked = board.taken().to_vec();
        let marked = unmarked.iter().filter(|raw| raw.clipped.any()).count();
        assert!((30..70).contains(&marked), "{marked}");
        unmarked
            .iter_mut()
            .for_each(|raw| raw.clipped = Default::default());
        let config = MonitorConfig::of_board(&motor()).expect("shipped");
        let monitor = Monitor::new(config).expect("valid");
        let mut state = MonitorState::default();
        let reports = unmarked[INHIBITED..].iter();
        let clipped = reports
            .filter_map(|raw| monitor.update_raw(&mut state, raw))
            .filter(|report| report.not_judged == Some(NotJudged::Clipped));
        assert_eq!(clipped.count(), 0, "channel {channel}");
    }
}

/// The emulated converters halve the first result after a pause of a millisecond, and after a calibration.
#[test]
fn the_first_result_after_a_pause_is_not_used() {
    let mut board = board_of(&scenario(60.0));
    board.run(LAMP_TEST_S + 2.5).expect("a run");
    assert!(!board.lamps()[SENSOR]);
    let master = Master::new(UNIT);
    let millivolt = master.word(&mut board, Field::ConverterSupply);
    assert!(millivolt.abs_diff(3_300) < 10, "{millivolt} mV");
}

/// Mean amplitude of voltage and current over the last frames, V and A, on a converter supply of so many mV.
fn amplitudes_on(millivolt: u32) -> [f32; 2] {
    let mut board = board_of(&scenario(60.0));
    board.set_vdda(millivolt);
    board.run(LAMP_TEST_S + 1.0).expect("a run");
    board.frames();
    // What a debugger does not read in time is dropped.
    let mut bytes = Vec::new();
    for _ in 0..5 {
        board.run(0.1).expect("a run");
        bytes.extend(board.frames());
    }
    assert_eq!(board.lamps(), HEALTHY, "{millivolt} mV");
    let frames: Vec<Frame> = bytes
        .split_inclusive(|byte| *byte == 0)
        .filter_map(|bytes| match Message::decode(bytes) {
            Ok(Message::Window(frame)) => Some(frame),
            _ => None,
        })
        .collect();
    assert!(frames.len() > 20, "{}", frames.len());
    let mean = |of: fn(&Frame) -> f32| frames.iter().map(of).sum::<f32>() / frames.len() as f32;
    [mean(|frame| frame.u_s_volt), mean(|frame| frame.i_s_amp)]
}

/// Sensors are absolute: a supply that is 2 % high makes codes 2 % small, which the reference of the chip tells.
#[test]
fn a_converter_supply_that_is_off_is_corrected() {
    let nominal = amplitudes_on(3_300);
    for millivolt in [3_234, 3_366] {
        let shown = amplitudes_on(millivolt);
        for (shown, nominal) in shown.iter().zip(nominal) {
            // One code of the reference is 0.07 %, and its emulation has no noise that would average.
            let off = shown / nominal - 1.0;
            assert!(
                off.abs() < 1e-3,
                "{millivolt} mV: {shown} instead of {nominal}"
            );
        }
    }
}
