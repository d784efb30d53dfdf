//! One likelihood over slip and number of bars, from all lines of all blocks.

use motor::MotorFile;

use super::blocks::{Block, Blocks};
use super::circuit::CircuitSlip;
use super::lines::{
    ECCENTRIC, HARMONICS, Harmonic, evidence, log_mean_exp, log_ratio, plausible_bars,
};

/// Steps of the search, bins of the highest line.
const STEP_BINS: f64 = 0.2;
/// Probability from which on the lines are those of slots.
const SURE: f64 = 0.999;
/// Share of it that must lie around one slip.
const ONE_SLIP: f64 = 0.99;
/// Around one slip: so far to both sides, and so many bins of the strongest lines.
const SAME_SLIP: f64 = 0.0005;
const SAME_BINS: f64 = 0.5;
/// Numbers of bars below this share of the likeliest are not told.
const TOLD: f64 = 0.05;
/// Lines that more numbers than these explain are no lines of slots: steps of a converter without noise fit any cage (thirty numbers and more).
/// Slots of 48 random machines left one to six where any were told.
const MOST_TOLD: usize = 8;
/// Circuits are off by this share of the rated slip without load: losses and phase errors that no interval holds.
const OFFSET: f64 = 0.05;
/// Blocks that must see a place.
const SEEN: f64 = 0.5;
/// A line counts as present where its evidence is above 1 by this.
const PRESENT: f64 = 2.0;
/// Bins around a place in which the top of its line may be.
const LOBES_BINS: f64 = 8.0;
/// Orders beside a harmonic in which a line may be the flank, or the sideband by a swinging load, of one that the harmonic covers.
const GUARD_ORDERS: f64 = 0.06;
/// Power over noise up to which a line is weak.
const WEAK: f64 = 20.0;
/// Lines of slots are not looked for around the fundamental.
const LOWEST_ORDER: f64 = 2.5;

/// A line that is seen: harmonic of the supply, and the way it turns.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenLine {
    /// Order of the harmonic that the slots modulate.
    pub harmonic: i32,
    /// 1.0 or -1.0.
    pub turns: f64,
}

/// The one slip that explains the lines.
#[derive(Debug)]
pub(super) struct Unique {
    /// Bars of the cage for each pole pair.
    pub per_pair: f64,
    /// What the circuit's mean slip lacks.
    pub offset: Offset,
    /// Standard deviation of the slip between numbers of bars that fit as well.
    pub spread: f64,
    /// Lines that are seen.
    pub lines: Vec<SeenLine>,
}

/// The circuit's slip lacks more at more load.
#[derive(Clone, Copy, Debug)]
pub(super) struct Offset {
    /// At the mean slip.
    pub at_mean: f64,
    mean: f64,
    idle: f64,
}

impl Offset {
    /// Where the circuit finds `slip`.
    pub fn at(&self, slip: f64) -> f64 {
        self.at_mean * (slip.abs() + self.idle) / (self.mean.abs() + self.idle)
    }
}

/// What the search found.
#[derive(Default)]
pub(super) struct Found {
    /// The slip, where only one explains the lines.
    pub unique: Option<Unique>,
    /// Numbers of bars that explain the lines, the likeliest first.
    pub rotor_bars: Vec<u32>,
}

/// The slips that are tried.
struct Grid {
    offsets: Vec<Offset>,
    /// Logarithms of the prior probabilities.
    prior: Vec<f64>,
    step: f64,
}

impl Grid {
    fn of(circuit: &CircuitSlip, motor: &MotorFile, blocks: &Blocks, most_bars: u32) -> Grid {
        let rated = motor.nameplate.rated_slip().max(0.002);
        let mean = circuit.mean();
        let deviation = (circuit.half_width / 1.96).max(OFFSET * rated);
        let reach = (4.0 * deviation).max(0.6 * mean.abs());
        let pairs = f64::from(motor.nameplate.pole_pairs);
        let step = STEP_BINS * pairs / (f64::from(most_bars) * blocks.cycles as f64);
        let count = (reach / step).ceil() as i32;
        let at = (-count..=count).map(|k| f64::from(k) * step);
        // Student's with three degrees: a hot cage or a poor file is unlikely, not impossible.
        let prior: Vec<f64> = at
            .clone()
            .map(|x| -2.0 * ((x / deviation).powi(2) / 3.0).ln_1p())
            .collect();
        let total = log_mean_exp(prior.iter().copied()) + (prior.len() as f64).ln();
        Grid {
            step,
            offsets: at
                .map(|at_mean| Offset {
                    at_mean,
                    mean,
                    idle: OFFSET * rated,
                })
                .collect(),
            prior: prior.iter().map(|p| p - total).collect(),
        }
    }
}

/// Looks for the lines.
pub(super) fn search(blocks: &Blocks, circuit: &CircuitSlip, motor: &MotorFile) -> Found {
    let given = motor.nameplate.rotor_bars;
    let which = match given {
        Some(_) => (0..blocks.blocks.len()).collect(),
        None => blocks.steady(),
    };
    if which.is_empty() {
        return Found::default();
    }
    let candidates: Vec<u32> = match given {
        Some(bars) => vec![bars],
        None => plausible_bars(motor.nameplate.pole_pairs).collect(),
    };
    let most = candidates.iter().copied().max().unwrap_or(1);
    let grid = Grid::of(circuit, motor, blocks, most);
    let view = View {
        blocks,
        outliers: blocks.outliers(&which),
        which,
        given: given.is_some(),
        pairs: f64::from(motor.nameplate.pole_pairs),
    };
    let share = (candidates.len() as f64).ln();
    let shaft = view.eccentricity(&grid);
    let posterior: Vec<Vec<f64>> = candidates
        .iter()
        .map(|&bars| {
            let slots = view.slots(bars, &grid);
            let cells = slots.iter().zip(&shaft).zip(&grid.prior);
            cells
                .map(|((slots, shaft), prior)| (prior - share + shaft + slots).exp())
                .collect()
        })
        .collect();
    decide(&view, &grid, &candidates, &posterior)
}

/// Without lines the evidence of all cells together is that of a motor without slot harmonics: weight one.
fn decide(view: &View<'_>, grid: &Grid, candidates: &[u32], posterior: &[Vec<f64>]) -> Found {
    let masses: Vec<f64> = posterior.iter().map(|cells| cells.iter().sum()).collect();
    let total = 1.0 + masses.iter().sum::<f64>();
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by(|a, b| masses[*b].total_cmp(&masses[*a]));
    let Some(&best) = order.first() else {
        return Found::default();
    };
    if masses.iter().sum::<f64>() < SURE * total || masses[best].is_nan() {
        return Found::default();
    }
    let top = (0..grid.offsets.len())
        .max_by(|a, b| posterior[best][*a].total_cmp(&posterior[best][*b]))
        .unwrap_or(0);
    let centre = grid.offsets[top].at_mean;
    let bin = view.pairs / f64::from(candidates[best]) / view.blocks.cycles as f64;
    let near = SAME_SLIP.max(SAME_BINS * bin);
    let (mut mass, mut square) = (0.0, 0.0);
    for cells in posterior {
        for (cell, offset) in cells.iter().zip(&grid.offsets) {
            let off = offset.at_mean - centre;
            if off.abs() <= near {
                mass += cell;
                square += cell * off * off;
            }
        }
    }
    let told: Vec<u32> = order
        .iter()
        .filter(|k| masses[**k] > TOLD * masses[best])
        .map(|k| candidates[*k])
        .collect();
    if told.len() > MOST_TOLD {
        return Found::default();
    }
    let unique = Unique {
        per_pair: f64::from(candidates[best]) / view.pairs,
        offset: grid.offsets[top],
        spread: match masses[best] > SURE * (total - 1.0) {
            true => 0.0,
            false => (square / mass).sqrt(),
        },
        lines: view.seen(candidates[best], grid, top),
    };
    Found {
        rotor_bars: told,
        unique: (mass > ONE_SLIP * total && !unique.lines.is_empty()).then_some(unique),
    }
}

/// The blocks as the search sees them.
struct View<'b> {
    blocks: &'b Blocks,
    given: bool,
    which: Vec<usize>,
    outliers: f64,
    pairs: f64,
}

/// Evidence of one line at every slip of the grid.
type Evidence = Vec<f64>;

impl View<'_> {
    /// Evidence of a line of the slots, for each way to turn; 0 where it could not be seen.
    fn line(&self, bars: u32, harmonic: &Harmonic, grid: &Grid) -> [Evidence; 2] {
        let per_pair = f64::from(bars) / self.pairs;
        [1.0, -1.0].map(|turns| {
            let powers: Vec<Option<Sum>> = grid
                .offsets
                .iter()
                .map(|offset| {
                    self.summed(|block| {
                        let slip = block.slip + offset.at(block.slip);
                        let order = per_pair * (1.0 - slip) + f64::from(harmonic.order);
                        let inside = (LOWEST_ORDER..self.blocks.highest_order).contains(&order);
                        inside.then(|| self.blocks.slot(block, turns * order))?
                    })
                })
                .collect();
            self.evidence(&powers, harmonic.usual, self.cells(grid, per_pair))
        })
    }

    fn slots(&self, bars: u32, grid: &Grid) -> Evidence {
        let mut total = vec![0.0; grid.offsets.len()];
        // Where the strongest lines are not resolved, their images below half the sampling rate may look like those of other bars.
        if !self.given && f64::from(bars) / self.pairs + 1.0 > self.blocks.highest_order {
            return total;
        }
        for harmonic in &HARMONICS {
            let [forwards, backwards] = self.line(bars, harmonic, grid);
            add(&mut total, &forwards, &backwards);
        }
        total
    }

    /// Both sidebands are one piece of evidence: a load that swings makes both.
    fn eccentricity(&self, grid: &Grid) -> Evidence {
        let sides = [1.0, -1.0].map(|side| {
            let powers: Vec<Option<Sum>> = grid
                .offsets
                .iter()
                .map(|offset| {
                    self.summed(|block| {
                        let slip = block.slip + offset.at(block.slip);
                        self.blocks
                            .shaft(block, 1.0 + side * (1.0 - slip) / self.pairs)
                    })
                })
                .collect();
            self.evidence(&powers, ECCENTRIC, self.cells(grid, 1.0 / self.pairs))
        });
        let mut total = vec![0.0; grid.offsets.len()];
        add(&mut total, &sides[0], &sides[1]);
        total
    }

    /// A strong line stands out far beside its place: there it speaks for the place of its top alone.
    fn evidence(&self, powers: &[Option<Sum>], usual: f64, [lobes, guard]: [usize; 2]) -> Evidence {
        let one = |(k, power): (usize, &Option<Sum>)| {
            let Some(Sum { power, count }) = power else {
                return 0.0;
            };
            let beside = &powers[k.saturating_sub(guard)..(k + guard + 1).min(powers.len())];
            if beside.iter().any(Option::is_none) {
                // What stands here may belong to a line under a harmonic.
                return 0.0;
            }
            let near = &powers[k.saturating_sub(lobes)..(k + lobes + 1).min(powers.len())];
            let top = near
                .iter()
                .flatten()
                .map(|sum| sum.power)
                .fold(*power, f64::max);
            let strong = (top - count - WEAK).clamp(0.0, WEAK);
            let here = evidence(log_ratio(*power, *count), usual, self.outliers);
            (here - strong * (1.0 - power / top)).max((1.0 - usual).ln())
        };
        powers.iter().enumerate().map(one).collect()
    }

    /// Cells of the grid in the lobes of a line and beside a harmonic, for lines that move by `per_slip` orders with the slip.
    fn cells(&self, grid: &Grid, per_slip: f64) -> [usize; 2] {
        let orders = [LOBES_BINS / self.blocks.cycles as f64, GUARD_ORDERS];
        orders.map(|orders| (orders / per_slip / grid.step) as usize)
    }

    fn summed(&self, white: impl Fn(&Block) -> Option<f64>) -> Option<Sum> {
        let mut sum = Sum {
            power: 0.0,
            count: 0.0,
        };
        let seen = self
            .which
            .iter()
            .filter_map(|&k| white(&self.blocks.blocks[k]));
        for power in seen {
            sum.power += power;
            sum.count += 1.0;
        }
        (sum.count >= SEEN * self.which.len() as f64 && sum.count > 0.0).then_some(sum)
    }

    fn seen(&self, bars: u32, grid: &Grid, cell: usize) -> Vec<SeenLine> {
        let each = HARMONICS.iter().filter_map(|harmonic| {
            let [forwards, backwards] = self.line(bars, harmonic, grid).map(|each| each[cell]);
            // Of a line that is not there `1 - usual` is left.
            let present = forwards.max(backwards).exp() > 1.0 + PRESENT;
            present.then_some(SeenLine {
                harmonic: harmonic.order,
                turns: if forwards >= backwards { 1.0 } else { -1.0 },
            })
        });
        each.collect()
    }
}

/// Powers over noise of the blocks that see a place.
#[derive(Clone, Copy)]
struct Sum {
    power: f64,
    count: f64,
}

/// Either of two.
fn add(total: &mut [f64], a: &[f64], b: &[f64]) {
    for (total, (a, b)) in total.iter_mut().zip(a.iter().zip(b)) {
        *total += log_mean_exp([*a, *b].into_iter());
    }
}
