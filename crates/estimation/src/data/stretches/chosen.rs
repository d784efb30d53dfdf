//! Which cells of a recording that was seen once are taken: those that differ most are fitted, others like them prove.

use serde::Serialize;
use std::ops::Range;

use super::cells::{CURRENT, Cell, Cells, QUANTITIES, SPEED, TORQUE, VOLTAGE};
use super::choice::{COUNT, LENGTH, SETTLES, least_alike_within, usual};
use schemars::JsonSchema;

/// Time on either side of a stretch with which its signals are smoothed, s: without it a window would end where the stretch does.
const AROUND: f64 = 0.5;
/// Share of what is usual in the recording by which a quantity changes within a step ...
const STEP: f64 = 0.1;
/// ... and the speed within a start.
const START: f64 = 0.3;

/// Share of the highest voltage below which a motor is off its supply: nothing drives a model there.
const OFF: f64 = 0.05;

/// What a stretch is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Parameters and effects are fitted to it; `compare` compares it.
    Fitted,
    /// It was not fitted: errors there prove.
    Proves,
}

/// A stretch of a long recording that was taken, and why.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StretchReport {
    /// Begin, s since the first sample.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// What it was taken for.
    pub role: Role,
    /// What is in it that others have not.
    pub why: String,
}

/// Samples to be read again.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    /// With what is around the stretch.
    pub rows: Range<usize>,
    /// The stretch among them, what comes before it and is not judged included.
    pub stretch: Range<usize>,
    /// How many of its first samples are not judged.
    pub settles: usize,
    /// Shaft angle at the first sample of `stretch` that is judged, rad.
    pub theta_mech: f64,
    /// The stretch in words.
    pub told: StretchReport,
}

/// How much of a long recording is taken: what a question holds in memory grows with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Length of a stretch, s.
    pub stretch_s: f64,
    /// Stretches that are fitted, or compared, where each stands alone. One that goes on where another ends needs no time to
    /// settle: more of those take as long.
    pub fitted: usize,
    /// Stretches that are not fitted and prove.
    pub proving: usize,
}

impl Budget {
    /// For a comparison, which fits nothing and proves nothing.
    pub const fn compared(_alone: bool) -> Self {
        Self {
            stretch_s: LENGTH,
            fitted: COUNT,
            proving: 0,
        }
    }

    /// For one fit; `alone`: no other recording proves.
    pub const fn fitted(alone: bool) -> Self {
        Self {
            proving: if alone { COUNT / 2 } else { 0 },
            ..Self::compared(alone)
        }
    }

    /// For fits of hundreds of hypotheses, each kept with its derivatives; `alone`: no other recording proves.
    pub const fn searched(alone: bool) -> Self {
        Self {
            stretch_s: 1.0,
            fitted: 10,
            proving: if alone { 10 } else { 0 },
        }
    }
}

/// The stretches that are taken, in the order of time.
pub(super) fn chosen(cells: &Cells, budget: Budget) -> Vec<Wanted> {
    let greatest = |cell: &Cell| cell.bounds[VOLTAGE][1];
    let highest = cells.all.iter().map(greatest).fold(0.0, f64::max);
    let is_on = |cell: &Cell| greatest(cell) >= OFF * highest;
    let usable = cells
        .all
        .iter()
        .filter(|cell| cell.is_usable && is_on(cell));
    let usable: Vec<&Cell> = usable.collect();
    if usable.is_empty() {
        return Vec::new();
    }
    let scales = scales(&usable);
    let features = features(&usable, &scales, cells.rows());
    let wanted = |all: &[(usize, Role)]| {
        let one = |&(k, role): &(usize, Role)| Wanted::of(usable[k], role, cells, &scales);
        merged(all.iter().map(one))
    };
    let fitted_alone =
        |taken: &[usize]| -> Vec<_> { taken.iter().map(|k| (*k, Role::Fitted)).collect() };
    let simulated = |taken: &[usize]| {
        let stretches = wanted(&fitted_alone(taken));
        stretches.iter().map(|one| one.stretch.len()).sum()
    };
    let longest = budget.fitted * (cells.length + cells.samples(SETTLES));
    let fitted = least_alike_within(&features, budget.fitted, longest, simulated);
    let proving = like(&features, &fitted, budget.proving);
    let mut all = fitted_alone(&fitted);
    all.extend(proving.iter().map(|k| (*k, Role::Proves)));
    all.sort_unstable_by_key(|(k, _)| *k);
    wanted(&all)
}

/// Neighbours of the same role become one.
fn merged(each: impl Iterator<Item = Wanted>) -> Vec<Wanted> {
    let mut all: Vec<Wanted> = Vec::new();
    for one in each {
        match all.last_mut() {
            Some(last) if last.goes_on_as(&one) => last.extend(one),
            _ => all.push(one),
        }
    }
    all
}

impl Wanted {
    fn of(cell: &Cell, role: Role, cells: &Cells, scales: &[f64; QUANTITIES]) -> Self {
        let run = &cells.runs[cell.run];
        let around = cells.samples(AROUND);
        let settles = cells.samples(SETTLES).min(cell.first - run.start);
        let begin = cell.first - settles;
        let end = cell.first + cells.length;
        let rows = begin.saturating_sub(around).max(run.start)..(end + around).min(run.end);
        Wanted {
            stretch: begin - rows.start..end - rows.start,
            rows,
            settles,
            theta_mech: cell.theta_mech,
            told: StretchReport {
                from_s: cell.at_s - cells.begin_s,
                to_s: cell.at_s - cells.begin_s + cells.length as f64 * cells.t_sample,
                role,
                why: why(cell, scales),
            },
        }
    }

    /// Number of the first row after the stretch.
    fn end(&self) -> usize {
        self.rows.start + self.stretch.end
    }

    fn goes_on_as(&self, next: &Wanted) -> bool {
        let begin = next.rows.start + next.stretch.start + next.settles;
        self.told.role == next.told.role && self.end() == begin
    }

    fn extend(&mut self, next: Wanted) {
        self.stretch.end = next.end() - self.rows.start;
        self.rows.end = next.rows.end;
        self.told.to_s = next.told.to_s;
        if self.told.why != next.told.why {
            self.told.why += &format!("; then {}", next.told.why);
        }
    }
}

/// What is usual of each quantity; the recording's own, so that a small motor's step is one too.
fn scales(cells: &[&Cell]) -> [f64; QUANTITIES] {
    core::array::from_fn(|quantity| usual(cells.iter().map(|cell| cell.middle(quantity))))
}

/// What each cell is like: time, and middle and range of every quantity, in parts of what is usual.
fn features(cells: &[&Cell], scales: &[f64; QUANTITIES], rows: usize) -> Vec<Vec<f64>> {
    let of = |cell: &&Cell| {
        let of_quantity = |k: usize| [cell.middle(k) / scales[k], cell.range(k) / scales[k]];
        let time = cell.first as f64 / rows.max(1) as f64;
        let all = (0..QUANTITIES).flat_map(of_quantity);
        std::iter::once(time).chain(all).collect()
    };
    cells.iter().map(of).collect()
}

/// For each cell that is fitted the one most like it that is not taken yet, whenever that was.
fn like(features: &[Vec<f64>], fitted: &[usize], count: usize) -> Vec<usize> {
    let mut taken = fitted.to_vec();
    let mut like = Vec::new();
    for mine in fitted.iter().take(count) {
        let distance = |k: &usize| -> f64 {
            let pairs = features[*k].iter().zip(&features[*mine]).skip(1);
            pairs.map(|(a, b)| (a - b).powi(2)).sum()
        };
        let free = (0..features.len()).filter(|k| !taken.contains(k));
        let nearest = free.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        taken.extend(nearest);
        like.extend(nearest);
    }
    like
}

/// What is in a cell, in words.
fn why(cell: &Cell, scales: &[f64; QUANTITIES]) -> String {
    let changes = |k: usize, share: f64| cell.range(k) > share * scales[k];
    let [slowest, fastest] = cell.bounds[SPEED];
    let rms = |amplitude: f64| amplitude / 2f64.sqrt();
    let between = |k: usize| cell.bounds[k].map(rms);
    let mut said = Vec::new();
    if changes(SPEED, START) {
        said.push(format!("speed {slowest:.0} to {fastest:.0} rad/s"));
    }
    if changes(VOLTAGE, STEP) {
        let [least, greatest] = between(VOLTAGE);
        said.push(format!("voltage {least:.0} to {greatest:.0} V"));
    }
    if changes(TORQUE, STEP) {
        let [least, greatest] = cell.bounds[TORQUE];
        said.push(format!("torque {least:.2} to {greatest:.2} N m"));
    } else if changes(CURRENT, STEP) {
        let [least, greatest] = between(CURRENT);
        said.push(format!("current {least:.2} to {greatest:.2} A"));
    }
    match said.is_empty() {
        false => format!("changes: {}", said.join(", ")),
        true => {
            let [voltage, current] = [VOLTAGE, CURRENT].map(|k| rms(cell.middle(k)));
            let speed = cell.middle(SPEED);
            let turns = if speed == 0.0 {
                String::new()
            } else {
                format!(", {speed:.1} rad/s")
            };
            format!("steady: {voltage:.0} V, {current:.2} A{turns}")
        }
    }
}
