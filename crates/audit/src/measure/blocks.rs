//! What each block of a recording shows: phasors, means, and whether it was steady.

use crate::measure::fit::Fit;
use crate::measure::sequence::Sequence;
use crate::measure::track::{Found, Tracked};
use num_complex::Complex64;
use recording::{Channel, Recording};
use std::ops::Range;

/// Three channels over one block.
#[derive(Clone, Debug)]
pub(crate) struct Three {
    pub fits: [Fit; 3],
}

impl Three {
    pub fn phasors(&self) -> [Complex64; 3] {
        self.fits.map(|fit| fit.phasor)
    }

    pub fn sequence(&self) -> Sequence {
        Sequence::of(self.phasors())
    }

    /// Mean amplitude of the three phases.
    pub fn amplitude(&self) -> f64 {
        self.fits.iter().map(|fit| fit.phasor.norm()).sum::<f64>() / 3.0
    }

    /// Relative change of the amplitudes from begin to end of the block.
    fn change(&self) -> f64 {
        let power: f64 = self.fits.iter().map(|fit| fit.phasor.norm_sqr()).sum();
        let growth: f64 = self
            .fits
            .iter()
            .map(|fit| (fit.slope * fit.phasor.conj()).re)
            .sum();
        (2.0 * growth / power).abs()
    }
}

/// One block in which the fundamental was found.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub range: Range<usize>,
    /// Angular frequency of the fundamental, rad/s, positive.
    pub omega: f64,
    pub voltages: Option<Three>,
    pub currents: Option<Three>,
    /// Mean speed, rad/s mechanical; absent where its scale is unknown.
    pub speed: Option<f64>,
    /// Whether frequency, amplitudes and speed stand still.
    pub steady: bool,
}

impl Block {
    /// Voltages or currents.
    pub fn three(&self, channels: [Channel; 3]) -> Option<&Three> {
        if channels == Channel::VOLTAGES {
            self.voltages.as_ref()
        } else {
            self.currents.as_ref()
        }
    }

    /// Complex power, VA, of amplitudes: `3/2 (P + jQ)` of the three phases; needs both.
    pub fn power(&self) -> Option<Complex64> {
        let (v, i) = (
            self.voltages.as_ref()?.phasors(),
            self.currents.as_ref()?.phasors(),
        );
        Some(v.iter().zip(&i).map(|(v, i)| 0.5 * v * i.conj()).sum())
    }
}

/// Change of a voltage amplitude over a block that still counts as steady.
const STEADY_VOLTAGE: f64 = 0.01;
/// Change of a current amplitude over a block that still counts as steady.
const STEADY_CURRENT: f64 = 0.05;
/// Change of the frequency between neighbours that still counts as steady.
const STEADY_FREQUENCY: f64 = 0.005;
/// Change of the speed over a block, relative to a turn per supply period, that counts as steady.
const STEADY_SPEED: f64 = 0.01;

/// The blocks of a recording: of its voltages, or of the currents where the voltages are absent or carry no fundamental.
pub(crate) fn blocks(recording: &Recording) -> Vec<Block> {
    let mut blocks = followed(recording);
    let jumps: Vec<bool> = (0..blocks.len()).map(|k| jumps(&blocks, k)).collect();
    for (block, jumps) in blocks.iter_mut().zip(jumps) {
        block.steady &= !jumps;
    }
    blocks
}

fn followed(recording: &Recording) -> Vec<Block> {
    let covered = |blocks: &[Block]| blocks.iter().map(|block| block.range.len()).sum::<usize>();
    let by_voltage = of(recording, Channel::VOLTAGES);
    if 2 * covered(&by_voltage) > recording.len() {
        return by_voltage;
    }
    let by_current = of(recording, Channel::CURRENTS);
    if covered(&by_current) > covered(&by_voltage) {
        by_current
    } else {
        by_voltage
    }
}

/// The blocks over which three channels carry a fundamental.
fn of(recording: &Recording, three: [Channel; 3]) -> Vec<Block> {
    let mut blocks = Vec::new();
    let channels = three.map(|channel| recording.channel(channel));
    if let [Some(a), Some(b), Some(c)] = channels {
        let tracked = tracked(recording, &[a, b, c]);
        tracked.for_each(&mut |found| blocks.push(block(recording, found, three)));
    }
    blocks
}

/// A tracker over some channels of a recording.
pub(crate) fn tracked<'r>(recording: &'r Recording, channels: &[&'r [f64]]) -> Tracked<'r> {
    Tracked {
        t: recording.t(),
        t_sample: recording.t_sample(),
        channels: channels.to_vec(),
    }
}

/// `followed`: the channels of which `found` has the fits.
fn block(recording: &Recording, found: &Found, followed: [Channel; 3]) -> Block {
    let Found { span, basis, fits } = found;
    let range = span.range.clone();
    let three = |three: [Channel; 3], channels: Option<[&[f64]; 3]>| {
        let fits = match fits[..] {
            [a, b, c] if three == followed => [a, b, c],
            _ => basis.fit_each(channels?.map(|x| &x[range.clone()])),
        };
        Some(Three { fits })
    };
    let voltages = three(Channel::VOLTAGES, recording.voltages());
    let currents = three(Channel::CURRENTS, recording.currents());
    let known = recording.unknown_speed_scale.is_none();
    let speed = recording.speed().filter(|_| known);
    let speed = speed.map(|speed| &speed[range.clone()]);
    let steady = voltages
        .as_ref()
        .is_none_or(|v| v.change() < STEADY_VOLTAGE)
        && currents
            .as_ref()
            .is_none_or(|i| i.change() < STEADY_CURRENT)
        && speed.is_none_or(|speed| change(speed) < STEADY_SPEED * span.omega);
    Block {
        omega: span.omega,
        voltages,
        currents,
        speed: speed.map(mean),
        steady,
        range,
    }
}

pub(crate) fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

/// Difference of the means of the last and the first third.
fn change(x: &[f64]) -> f64 {
    let third = (x.len() / 3).max(1);
    (mean(&x[x.len() - third..]) - mean(&x[..third])).abs()
}

fn jumps(blocks: &[Block], k: usize) -> bool {
    let differs = |other: Option<&Block>| {
        other.is_some_and(|other| (other.omega / blocks[k].omega - 1.0).abs() > STEADY_FREQUENCY)
    };
    differs(k.checked_sub(1).and_then(|before| blocks.get(before))) || differs(blocks.get(k + 1))
}
