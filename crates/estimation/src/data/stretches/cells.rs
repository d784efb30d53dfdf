//! What every second or two of a recording are like, learnt as its pieces come: of no sample more is kept than that.

use motor::dynamic::clarke;
use num_complex::Complex64;
use recording::Recording;

use super::choice::MEAN;

/// Deviation of a sampling time from the others that ends a run of samples.
const UNEVEN: f64 = 0.01;

/// What is looked at: amplitudes of voltage (V) and current (A), turn of the voltage per sample (rad), speed (rad/s), torque (N m).
pub const QUANTITIES: usize = 5;
/// The amplitude of the voltage.
pub const VOLTAGE: usize = 0;
/// The amplitude of the current.
pub const CURRENT: usize = 2;
/// The speed of the shaft.
pub const SPEED: usize = 3;
/// The torque at the shaft.
pub const TORQUE: usize = 4;

/// Samples that follow one another, as many as a stretch has.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Number of its first sample in the recording.
    pub first: usize,
    /// When that was, s.
    pub at_s: f64,
    /// The run of evenly sampled rows that it belongs to.
    pub run: usize,
    /// Shaft angle there, rad, from the measured speed.
    pub theta_mech: f64,
    /// Whether the audit lets it be judged.
    pub is_usable: bool,
    /// Least and greatest mean over two periods of each quantity; 0 where it was not recorded.
    pub bounds: [[f64; 2]; QUANTITIES],
}

/// Rows without a gap: numbers of the first one and of the one after the last.
pub type Run = std::ops::Range<usize>;

/// The cells of the pieces so far.
#[derive(Clone, Debug)]
pub struct Cells {
    /// Those that are full.
    pub all: Vec<Cell>,
    /// The runs, of which the last one goes on.
    pub runs: Vec<Run>,
    /// Samples of a cell.
    pub length: usize,
    /// When the first sample was, s.
    pub begin_s: f64,
    /// Time between samples, s, as the first piece has it.
    pub t_sample: f64,
    stretch_s: f64,
    bin: usize,
    open: Option<Open>,
    before: Option<Sample>,
    theta_mech: f64,
    rows: usize,
}

/// A cell that is not full yet.
#[derive(Clone, Debug)]
struct Open {
    cell: Cell,
    samples: usize,
    in_bin: usize,
    sums: [f64; QUANTITIES],
    turn: Complex64,
}

/// One row.
#[derive(Clone, Copy, Debug)]
struct Sample {
    t: f64,
    u: Complex64,
    current: f64,
    speed: f64,
    torque: f64,
}

impl Cells {
    /// Before the first piece; cells are `stretch_s` long, s.
    pub fn new(stretch_s: f64) -> Self {
        Self {
            all: Vec::new(),
            runs: Vec::new(),
            length: 0,
            begin_s: 0.0,
            t_sample: 0.0,
            stretch_s,
            bin: 0,
            open: None,
            before: None,
            theta_mech: 0.0,
            rows: 0,
        }
    }

    /// Takes the next piece; `is_usable`: as its audit says.
    pub fn take(&mut self, piece: &Recording, is_usable: bool) {
        if self.length == 0 {
            (self.begin_s, self.t_sample) = (piece.t()[0], piece.t_sample());
            let samples = |seconds: f64| (seconds / self.t_sample).round() as usize;
            self.length = samples(self.stretch_s).max(1);
            self.bin = samples(MEAN).clamp(1, self.length);
        }
        if let Some(open) = &mut self.open {
            open.cell.is_usable &= is_usable;
        }
        let of = |x: Option<&[f64]>, k: usize| x.map_or(0.0, |x| x[k]);
        let vector = |abc: Option<[&[f64]; 3]>, k: usize| {
            abc.map_or(Complex64::ZERO, |abc| clarke(abc.map(|x| x[k])))
        };
        let (u, i) = (piece.voltages(), piece.currents());
        let (speed, torque) = (piece.speed(), piece.torque());
        for (k, t) in piece.t().iter().enumerate() {
            let sample = Sample {
                t: *t,
                u: vector(u, k),
                current: vector(i, k).norm(),
                speed: of(speed, k),
                torque: of(torque, k),
            };
            self.add(sample, is_usable);
        }
    }

    fn add(&mut self, sample: Sample, is_usable: bool) {
        let follows =
            |before: &Sample| (sample.t - before.t - self.t_sample).abs() <= UNEVEN * self.t_sample;
        let before = self.before.filter(follows);
        match (before, self.runs.last_mut()) {
            (Some(before), Some(run)) => {
                self.theta_mech += 0.5 * (before.speed + sample.speed) * self.t_sample;
                run.end = self.rows + 1;
            }
            _ => {
                self.open = None;
                self.runs.push(self.rows..self.rows + 1);
            }
        }
        let open = self.open.get_or_insert_with(|| Open {
            cell: Cell {
                first: self.rows,
                at_s: sample.t,
                run: self.runs.len() - 1,
                theta_mech: self.theta_mech,
                is_usable,
                bounds: [[f64::INFINITY, f64::NEG_INFINITY]; QUANTITIES],
            },
            samples: 0,
            in_bin: 0,
            sums: [0.0; QUANTITIES],
            turn: Complex64::ZERO,
        });
        open.add(&sample, before.as_ref(), self.bin);
        if open.samples == self.length {
            self.all.extend(self.open.take().map(|open| open.cell));
        }
        self.before = Some(sample);
        self.rows += 1;
    }

    /// Samples of a time, s.
    pub fn samples(&self, seconds: f64) -> usize {
        (seconds / self.t_sample).round() as usize
    }

    /// Rows so far.
    pub fn rows(&self) -> usize {
        self.rows
    }
}

impl Open {
    fn add(&mut self, sample: &Sample, before: Option<&Sample>, bin: usize) {
        let values = [
            sample.u.norm(),
            0.0,
            sample.current,
            sample.speed,
            sample.torque,
        ];
        for (sum, x) in self.sums.iter_mut().zip(values) {
            *sum += x;
        }
        self.turn += before.map_or(Complex64::ZERO, |before| sample.u * before.u.conj());
        self.samples += 1;
        self.in_bin += 1;
        if self.in_bin == bin {
            self.end_bin(bin);
        }
    }

    fn end_bin(&mut self, bin: usize) {
        let mut means = self.sums.map(|sum| sum / bin as f64);
        means[1] = match self.turn == Complex64::ZERO {
            true => 0.0,
            false => self.turn.arg(),
        };
        for (bounds, mean) in self.cell.bounds.iter_mut().zip(means) {
            *bounds = [bounds[0].min(mean), bounds[1].max(mean)];
        }
        (self.in_bin, self.sums, self.turn) = (0, [0.0; QUANTITIES], Complex64::ZERO);
    }
}

impl Cell {
    /// The middle of a quantity's means.
    pub fn middle(&self, quantity: usize) -> f64 {
        let [least, greatest] = self.bounds[quantity];
        0.5 * (least + greatest)
    }

    /// How far they are apart.
    pub fn range(&self, quantity: usize) -> f64 {
        let [least, greatest] = self.bounds[quantity];
        greatest - least
    }
}
