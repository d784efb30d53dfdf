//! Boards drawn within the tolerances of their parts.

use rand::Rng;
use rand_pcg::Pcg64;
use scenario::{CHANNELS, ChannelChain, SEQUENCE, SignalChain};

/// A front end and what is known of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// The divider with 1 kohm and 100 nF, without a buffer.
    OldDivider,
    /// The stage of docs/wiring.md, nothing corrected.
    Stage,
    /// The stage, nominal delays known.
    StageDelays,
    /// The stage, gains calibrated, delays not known.
    StageGains,
    /// The stage, gains calibrated and nominal delays known.
    StageBoth,
    /// The same with capacitors of 10 %.
    X7r,
}

impl Variant {
    pub const ALL: [Variant; 6] = [
        Variant::OldDivider,
        Variant::Stage,
        Variant::StageDelays,
        Variant::StageGains,
        Variant::StageBoth,
        Variant::X7r,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Variant::OldDivider => "old divider, 1 kohm and 100 nF",
            Variant::Stage => "stage, nothing corrected",
            Variant::StageDelays => "stage, nominal delays known",
            Variant::StageGains => "stage, gains calibrated to 0.1 %",
            Variant::StageBoth => "stage, gains calibrated, nominal delays known",
            Variant::X7r => "the same with X7R 10 % capacitors",
        }
    }

    fn gains_are_calibrated(self) -> bool {
        matches!(
            self,
            Variant::StageGains | Variant::StageBoth | Variant::X7r
        )
    }

    fn delays_are_known(self) -> bool {
        matches!(
            self,
            Variant::StageDelays | Variant::StageBoth | Variant::X7r
        )
    }
}

/// A board: its signal chains, and what the user was told of them.
pub struct Board {
    pub chain: SignalChain,
    /// The nominal chain, where the board is told of it.
    pub known: Option<Known>,
    /// V.
    pub voltage_full_scale: f64,
    /// Full scale of the currents over the rated amplitude.
    pub current_headroom: f64,
    /// Of the noise.
    pub seed: u64,
}

/// What a motor file says of a chain.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// Voltages a, b, c, then currents a, b, c.
    pub delays_s: [f64; CHANNELS],
    pub roll_off_s: f64,
}

impl Known {
    pub const NOTHING: Known = Known {
        delays_s: [0.0; CHANNELS],
        roll_off_s: 0.0,
    };

    fn of(nominal: &[ChannelChain; CHANNELS]) -> Known {
        let [voltage, ..] = nominal;
        let filter = voltage.time_constants_s.iter().map(|t| t * t);
        let squares = filter.chain([MEAN_ROLL_OFF_S * MEAN_ROLL_OFF_S]);
        Known {
            delays_s: nominal.map(|channel| whole_delay(channel) + MEAN_DELAY_S),
            roll_off_s: squares.sum::<f64>().sqrt(),
        }
    }
}

/// What is left of a gain after calibration.
const CALIBRATED: f64 = 0.001;
/// From one conversion to the next: 25 cycles of 40 MHz.
const RANK_S: f64 = 25.0 / 40e6;
/// Conversions of a channel in a sample, 6.25 us apart, the last one at its time: half of their span, and `sqrt((16^2 - 1)/12)`.
const CONVERSIONS: u32 = 16;
const MEAN_DELAY_S: f64 = 7.5 * 6.25e-6;
const MEAN_ROLL_OFF_S: f64 = 4.609_772 * 6.25e-6;

impl Board {
    pub fn draw(variant: Variant, random: &mut Pcg64) -> Board {
        let mut channels: [ChannelChain; CHANNELS] =
            std::array::from_fn(|k| channel(variant, k < 3, &mut Parts::Drawn(random)));
        let mut nominal: [ChannelChain; CHANNELS] =
            std::array::from_fn(|k| channel(variant, k < 3, &mut Parts::Nominal));
        for (rank, k) in SEQUENCE.into_iter().rev().enumerate() {
            channels[k].delay_s += rank as f64 * RANK_S;
            nominal[k].delay_s += rank as f64 * RANK_S;
        }
        if variant.gains_are_calibrated() {
            for channel in &mut channels {
                channel.gain_error = CALIBRATED * random.random_range(-1.0..1.0);
            }
        }
        let old = variant == Variant::OldDivider;
        Board {
            chain: SignalChain {
                channels,
                conversions: CONVERSIONS,
                ..SignalChain::default()
            },
            known: variant.delays_are_known().then(|| Known::of(&nominal)),
            voltage_full_scale: if old { 395.8 } else { 630.8 },
            current_headroom: if old { 10.0 } else { 2.0 },
            seed: random.random(),
        }
    }
}

/// Delay of a slow signal.
fn whole_delay(channel: ChannelChain) -> f64 {
    channel.delay_s + channel.time_constants_s.iter().sum::<f64>()
}

/// Where a part's value comes from.
enum Parts<'r> {
    Nominal,
    /// Anywhere within its tolerance.
    Drawn(&'r mut Pcg64),
}

impl Parts<'_> {
    fn value(&mut self, nominal: f64, tolerance: f64) -> f64 {
        match self {
            Parts::Nominal => nominal,
            Parts::Drawn(random) => nominal * (1.0 + tolerance * random.random_range(-1.0..1.0)),
        }
    }
}

fn channel(variant: Variant, voltage: bool, parts: &mut Parts<'_>) -> ChannelChain {
    match (variant, voltage) {
        (Variant::OldDivider, true) => old_voltage(parts),
        (Variant::OldDivider, false) => old_current(parts),
        (_, true) => voltage_channel(parts, &Capacitors::of(variant)),
        (_, false) => current_channel(parts, &Capacitors::of(variant)),
    }
}

/// Tolerances of the capacitors of the stage and at the pin.
struct Capacitors {
    stage: f64,
    pin: f64,
}

impl Capacitors {
    fn of(variant: Variant) -> Capacitors {
        match variant {
            Variant::X7r => Capacitors {
                stage: 0.1,
                pin: 0.1,
            },
            _ => Capacitors {
                stage: 0.01,
                pin: 0.05,
            },
        }
    }
}

/// 1 % resistors and 100 nF of 10 %: the divider's source resistance is part of the filter.
fn old_voltage(parts: &mut Parts<'_>) -> ChannelChain {
    let high: f64 = (0..4).map(|_| parts.value(470e3, 0.01)).sum();
    let low = parts.value(7.87e3, 0.01);
    let source = high * low / (high + low) + parts.value(1e3, 0.01);
    ChannelChain {
        time_constants_s: [source * parts.value(100e-9, 0.1), 0.0],
        gain_error: low / (high + low) / (7.87e3 / (1.88e6 + 7.87e3)) - 1.0,
        ..ChannelChain::default()
    }
}

/// A transducer of 1 % behind the same filter.
fn old_current(parts: &mut Parts<'_>) -> ChannelChain {
    ChannelChain {
        time_constants_s: [parts.value(1e3, 0.01) * parts.value(100e-9, 0.1), 0.0],
        gain_error: parts.value(1.0, 0.01) - 1.0,
        ..ChannelChain::default()
    }
}

/// The stage behind the barrier: gain over nominal, and its two time constants.
fn stage(parts: &mut Parts<'_>, capacitors: &Capacitors) -> (f64, [f64; 2]) {
    let mut half = || {
        let (input, feedback) = (parts.value(12.1e3, 0.001), parts.value(9.53e3, 0.001));
        (
            feedback / input,
            feedback * parts.value(8.2e-9, capacitors.stage),
        )
    };
    let (first, second) = (half(), half());
    let pin = parts.value(150.0, 0.01) * parts.value(47e-9, capacitors.pin);
    let gain = 0.5 * (first.0 + second.0) / (9.53 / 12.1);
    (gain, [0.5 * (first.1 + second.1), pin])
}

fn voltage_channel(parts: &mut Parts<'_>, capacitors: &Capacitors) -> ChannelChain {
    let high: f64 = (0..4).map(|_| parts.value(499e3, 0.001)).sum();
    let low = parts.value(3.32e3, 0.001);
    let divider = low / (high + low) / (3.32e3 / (1.996e6 + 3.32e3));
    let amplifier = parts.value(1.0, 0.002);
    let input = low * parts.value(1e-9, 0.05);
    // The pole of the amplifier's bandwidth, and what its barrier takes.
    let own = parts.value(0.424e-6, 0.15) + parts.value(1.6e-6, 0.19);
    let (gain, time_constants_s) = stage(parts, capacitors);
    ChannelChain {
        time_constants_s,
        delay_s: input + own,
        gain_error: gain * divider * amplifier - 1.0,
        ..ChannelChain::default()
    }
}

fn current_channel(parts: &mut Parts<'_>, capacitors: &Capacitors) -> ChannelChain {
    let transducer = parts.value(1.0, 0.008);
    let (gain, time_constants_s) = stage(parts, capacitors);
    ChannelChain {
        time_constants_s,
        delay_s: 0.53e-6,
        gain_error: gain * transducer - 1.0,
        ..ChannelChain::default()
    }
}
