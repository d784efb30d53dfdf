//! Blocks of whole cycles and their spectra.

use fourier::Transform;
use motor::MotorFile;
use num_complex::Complex64;

use super::angle::Turned;
use super::spectrum::{PADDING, Spectrum, hann, is_harmonic};

/// Most blocks that are looked at, spread over the recording.
const MOST: usize = 32;
/// Shortest block, cycles: below it harmonics cover half of all orders.
const SHORTEST: usize = 20;
/// Bins by which a line may drift in a block before it is smeared.
const DRIFT_BINS: f64 = 0.5;
/// Slot harmonics lie around this order.
const USUAL_ORDER: f64 = 16.0;
/// A voltage explains a line of the current from this share of it on: its power.
const EXPLAINS: f64 = 0.25;
/// A line of the voltage is one from so many times its noise on.
const VOLTAGE_LINE: f64 = 10.0;

/// Bins in which a line stands out.
const LINE_BINS: f64 = 3.0;
/// Bins from one line to the next, at least.
const APART: usize = 8;

/// One block.
pub(super) struct Block {
    /// First step of the supply's angle.
    pub start: usize,
    /// Mean slip by the circuit.
    pub slip: f64,
    /// Largest change of the circuit's slip in it.
    drift: f64,
    /// Spectrum of the currents.
    pub current: Spectrum,
    /// Spectra with the drift of lines at plus and minus the rotor's bars taken out; absent where nothing drifts.
    straightened: Option<[Spectrum; 2]>,
}

/// All blocks.
pub(super) struct Blocks {
    /// In the order of time.
    pub blocks: Vec<Block>,
    /// Length, cycles.
    pub cycles: usize,
    /// Highest order that the sampling resolves.
    pub highest_order: f64,
    /// Points of the spectra that cannot show a line: harmonics of the supply, and what the voltage explains.
    blind: Vec<bool>,
}

struct Maker<'t> {
    turned: &'t Turned,
    window: Vec<f64>,
    cycles: usize,
    energy: f64,
    transform: Transform,
}

impl Maker<'_> {
    fn spectrum(&self, windowed: &[Complex64]) -> Spectrum {
        Spectrum::of(windowed, self.cycles, self.energy, &self.transform)
    }

    fn windowed(&self, signal: &[Complex64], start: usize) -> Vec<Complex64> {
        let part = &signal[start..start + self.window.len()];
        part.iter().zip(&self.window).map(|(x, w)| x * w).collect()
    }

    /// `lines` at that many times the shaft's frequency stand still in the block.
    fn straightened(&self, windowed: &[Complex64], start: usize, lines: f64) -> Spectrum {
        let slip = &self.turned.slip[start..start + windowed.len()];
        self.spectrum(&straight(windowed, slip, lines, self.turned.per_cycle))
    }
}

/// Takes the changes of the slip out of lines at `lines` times the electrical frequency of the shaft.
pub(super) fn straight(
    windowed: &[Complex64],
    slip: &[f64],
    lines: f64,
    per_cycle: usize,
) -> Vec<Complex64> {
    let mean = slip.iter().sum::<f64>() / slip.len() as f64;
    let mut angle = 0.0;
    let each = windowed.iter().zip(slip).map(|(x, s)| {
        angle += std::f64::consts::TAU * lines * (s - mean) / per_cycle as f64;
        x * Complex64::from_polar(1.0, angle)
    });
    each.collect()
}

impl Blocks {
    /// Blocks of that many cycles, or what there is; `None` where that is too little.
    pub fn of(turned: &Turned, cycles: usize, motor: &MotorFile) -> Option<Blocks> {
        let per_cycle = turned.per_cycle;
        let available = turned.i.len() / per_cycle;
        let wanted = cycles.min(available);
        // Long blocks must be long, or they say the same again.
        if wanted < SHORTEST || 2 * wanted < cycles && cycles > 100 {
            return None;
        }
        let length = wanted * per_cycle;
        let window = hann(length);
        let maker = Maker {
            turned,
            cycles: wanted,
            energy: window.iter().map(|w| w * w).sum(),
            window,
            transform: Transform::of(PADDING * length),
        };
        let starts = starts(turned.i.len(), length);
        let bars_per_pair = motor
            .nameplate
            .rotor_bars
            .map(|bars| f64::from(bars) / f64::from(motor.nameplate.pole_pairs));
        let blocks: Vec<Block> = starts
            .iter()
            .map(|&start| maker.block(start, bars_per_pair))
            .collect();
        let voltage: Vec<Vec<f32>> = starts
            .iter()
            .map(|&start| {
                let voltage = maker.spectrum(&maker.windowed(&turned.u, start));
                voltage_lines(&voltage)
            })
            .collect();
        let reactance = turned.omega * (motor.parameters.l_ls + motor.parameters.l_lr);
        Some(Blocks {
            blind: blind(&blocks, &voltage, wanted, reactance),
            blocks,
            cycles: wanted,
            highest_order: 0.45 * per_cycle as f64,
        })
    }

    /// Blocks in which a line does not smear where the number of bars is unknown.
    pub fn steady(&self) -> Vec<usize> {
        let smear = |block: &Block| block.drift * USUAL_ORDER * self.cycles as f64;
        (0..self.blocks.len())
            .filter(|&k| smear(&self.blocks[k]) < DRIFT_BINS)
            .collect()
    }

    /// Power over noise of one block at an order, for a line that follows the slots; `None` where it could not be seen.
    pub fn slot(&self, block: &Block, order: f64) -> Option<f64> {
        let spectrum = match &block.straightened {
            Some([plus, _]) if order > 0.0 => plus,
            Some([_, minus]) => minus,
            None => &block.current,
        };
        (!self.blind[spectrum.point(order)]).then(|| spectrum.white(order))
    }

    /// The same for a line at the frequency of the shaft.
    pub fn shaft(&self, block: &Block, order: f64) -> Option<f64> {
        let spectrum = &block.current;
        (!self.blind[spectrum.point(order)]).then(|| spectrum.white(order))
    }

    /// Share of the bins that lines of whatever origin cover, were each as wide as a clean one.
    pub fn outliers(&self, which: &[usize]) -> f64 {
        let count = which.len() as f64;
        // Wilson and Hilferty: one of 100 000 sums of so many exponential powers is larger.
        let limit = count * (1.0 - 1.0 / (9.0 * count) + 4.265 / (3.0 * count.sqrt())).powi(3);
        let (mut bins, mut lines, mut last) = (0.0, 1.0, None);
        let points = (0..self.blind.len()).step_by(PADDING);
        for k in points.filter(|&k| !self.blind[k] && self.resolved(k)) {
            let order = k as f64 / (PADDING * self.cycles) as f64;
            let sum: f64 = which
                .iter()
                .map(|&b| self.blocks[b].current.white(order))
                .sum();
            bins += 1.0;
            if sum > limit {
                // Sidebands and skirts of a strong line are no further ones.
                lines += f64::from(u8::from(last.is_none_or(|last| k > last + APART * PADDING)));
                last = Some(k);
            }
        }
        (LINE_BINS * lines / f64::max(bins, 1.0)).min(0.5)
    }

    fn resolved(&self, point: usize) -> bool {
        let folded = point.min(self.blind.len() - point);
        (folded as f64) < self.highest_order * (PADDING * self.cycles) as f64
    }
}

impl Maker<'_> {
    fn block(&self, start: usize, bars_per_pair: Option<f64>) -> Block {
        let windowed = self.windowed(&self.turned.i, start);
        let slip = &self.turned.slip[start..start + windowed.len()];
        let (low, high) = slip
            .iter()
            .fold((f64::MAX, f64::MIN), |(a, b), s| (a.min(*s), b.max(*s)));
        let moves = |lines: f64| (high - low) * lines * self.cycles as f64 > 0.1;
        let straightened = bars_per_pair
            .filter(|lines| moves(*lines))
            .map(|lines| [lines, -lines].map(|lines| self.straightened(&windowed, start, lines)));
        Block {
            start,
            slip: slip.iter().sum::<f64>() / slip.len() as f64,
            drift: high - low,
            current: self.spectrum(&windowed),
            straightened,
        }
    }
}

/// Half overlapping, at most [`MOST`].
fn starts(available: usize, length: usize) -> Vec<usize> {
    let last = available - length;
    let count = (2 * last).div_ceil(length) + 1;
    let count = count.min(MOST);
    (0..count).map(|k| last * k / (count - 1).max(1)).collect()
}

/// Power where the voltage has a line, 0 elsewhere.
fn voltage_lines(voltage: &Spectrum) -> Vec<f32> {
    let lines = voltage.white_points();
    let each = lines.zip(&voltage.power);
    each.map(|(white, power)| if white > VOLTAGE_LINE { *power } else { 0.0 })
        .collect()
}

/// Points under a harmonic of the supply, and lines that the voltage drives through the leakages.
fn blind(blocks: &[Block], voltage: &[Vec<f32>], cycles: usize, reactance: f64) -> Vec<bool> {
    let points = blocks.first().map_or(0, |block| block.current.power.len());
    let per_order = (PADDING * cycles) as f64;
    let one = |k: usize| {
        let order = if 2 * k > points {
            k as f64 - points as f64
        } else {
            k as f64
        } / per_order;
        let current: f64 = blocks.iter().map(|b| f64::from(b.current.power[k])).sum();
        let driving: f64 = voltage.iter().map(|v| f64::from(v[k])).sum();
        is_harmonic(order, cycles) || driving > EXPLAINS * (order * reactance).powi(2) * current
    };
    (0..points).map(one).collect()
}
