//! Voltages and currents by two clocks: the phase between them walks with time, while everything else stays.

use crate::context::Context;
use crate::finding::{Code, Finding};
use crate::measure::blocks::Block;
use crate::measure::statistics::median;
use recording::Channel;
use std::f64::consts::{PI, TAU};

/// Blocks at one operating point that a walk is told from.
const FEWEST_BLOCKS: usize = 8;
/// Differences from the usual current and slip within which blocks are of one operating point.
const SAME_CURRENT: f64 = 0.02;
const SAME_SLIP: f64 = 0.002;
/// Smallest walk from the first to the last block, rad: half a degree.
const SMALLEST_WALK: f64 = 0.0087;
/// Slowest walk, as a share of the supply's own turning: a winding that warms stays below a tenth of it.
const SLOWEST: f64 = 2e-6;
/// Standard errors that the walk must exceed; and share of it that may be left.
const SIGNIFICANT: f64 = 8.0;
const LEFT: f64 = 0.1;
/// Radians that the lag turns for each unit of slip, doubled: 45 degrees within half of a rated slip of 1 %.
const TURN_PER_SLIP: f64 = 300.0;
/// Regressors: 1, time, slip, current, voltage.
const N: usize = 5;

pub(crate) fn check(context: &mut Context<'_>) -> Option<Finding> {
    let walk = walk(context)?;
    context.unsound.extend(Channel::CURRENTS);
    let ppm = -1e6 * walk.share;
    let detail = format!(
        "The phase between voltages and currents walks by {:.1} degrees in {:.1} s while amplitudes, speed and slip stay: two \
         clocks took them, that of the currents {ppm:+.0} ppm against the other. No phase of this recording can be trusted. \
         Record both with one clock, or cut out a short piece right behind the instant at which the two were set alike.",
        walk.radian.to_degrees(),
        walk.seconds
    );
    Some(
        Finding::new(Code::ClockDrift, "ia ib ic", ppm, "ppm")
            .detail(detail)
            .refusing(),
    )
}

struct Walk {
    /// From the first to the last block, rad.
    radian: f64,
    seconds: f64,
    /// Over the supply's own turning in that time.
    share: f64,
}

/// One block: time, lag of the current, slip, logarithms of both amplitudes.
type Point = [f64; 5];

fn walk(context: &Context<'_>) -> Option<Walk> {
    let points = unwrapped(one_operating_point(points(context))?);
    let (first, last) = (points.first()?[0], points.last()?[0]);
    let seconds = last - first;
    let rows: Vec<[f64; N]> = centred(&points, seconds);
    let lags: Vec<f64> = points.iter().map(|point| point[1]).collect();
    let (slope, error, left) = slope(&rows, &lags)?;
    let by_slip = TURN_PER_SLIP * slip_walk(&rows);
    let share = slope / (seconds * context.omega()?);
    let sure = slope.abs() > (SIGNIFICANT * error).max(by_slip) && left < LEFT * slope.abs();
    (sure && slope.abs() > SMALLEST_WALK && share.abs() > SLOWEST).then_some(Walk {
        radian: slope,
        seconds,
        share,
    })
}

/// Steady blocks with everything that a lag depends on; without a speed nothing can be told.
fn points(context: &Context<'_>) -> Vec<Point> {
    let pole_pairs = context.expectation.pole_pairs.map_or(1.0, f64::from);
    let t = context.recording.t();
    let settled = context.settled(Channel::CURRENTS);
    let point = |block: &Block| {
        let (power, speed) = (block.power()?, block.speed?);
        let volt = block.voltages.as_ref()?.amplitude();
        let amp = block.currents.as_ref()?.amplitude();
        let slip = 1.0 - speed.abs() * pole_pairs / block.omega;
        Some([t[block.range.start], power.arg(), slip, amp.ln(), volt.ln()])
    };
    let steady = settled.iter().filter(|(block, _)| block.steady);
    steady.filter_map(|(block, _)| point(block)).collect()
}

fn one_operating_point(points: Vec<Point>) -> Option<Vec<Point>> {
    let slip = median(points.iter().map(|point| point[2]))?;
    let current = median(points.iter().map(|point| point[3]))?;
    let same = |point: &Point| {
        (point[2] - slip).abs() < SAME_SLIP && (point[3] - current).abs() < SAME_CURRENT
    };
    let kept: Vec<Point> = points.into_iter().filter(same).collect();
    (kept.len() >= FEWEST_BLOCKS).then_some(kept)
}

/// Angles that go on where they would jump by a turn.
fn unwrapped(mut points: Vec<Point>) -> Vec<Point> {
    for k in 1..points.len() {
        let step = points[k][1] - points[k - 1][1];
        points[k][1] -= TAU * ((step + PI) / TAU).floor();
    }
    points
}

/// Regressors about their means; time runs from -1/2 to 1/2.
fn centred(points: &[Point], seconds: f64) -> Vec<[f64; N]> {
    let mean = |k: usize| points.iter().map(|point| point[k]).sum::<f64>() / points.len() as f64;
    let means = [mean(0), mean(2), mean(3), mean(4)];
    let row = |point: &Point| {
        [
            1.0,
            (point[0] - means[0]) / seconds,
            point[2] - means[1],
            point[3] - means[2],
            point[4] - means[3],
        ]
    };
    points.iter().map(row).collect()
}

/// How far the slip may have walked from the first to the last block: what it did, and two standard errors.
fn slip_walk(rows: &[[f64; N]]) -> f64 {
    let time: Vec<f64> = rows.iter().map(|row| row[1]).collect();
    let slip: Vec<f64> = rows.iter().map(|row| row[2]).collect();
    let weight = dot(&time, &time);
    let walk = dot(&time, &slip) / weight;
    let rest: f64 = time
        .iter()
        .zip(&slip)
        .map(|(t, s)| (s - walk * t).powi(2))
        .sum();
    walk.abs() + 2.0 * (rest / rows.len() as f64 / weight).sqrt()
}

/// Coefficient of the time, its standard error, and the standard deviation of what is left: least squares by taking each
/// regressor free of the others out of the time and the lag (Frisch, Waugh and Lovell).
fn slope(rows: &[[f64; N]], lags: &[f64]) -> Option<(f64, f64, f64)> {
    let column = |k: usize| rows.iter().map(|row| row[k]).collect::<Vec<f64>>();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for k in [0, 2, 3, 4] {
        let mut next = column(k);
        let size = dot(&next, &next);
        basis.iter().for_each(|other| remove(&mut next, other));
        // A quantity that does not change beyond rounding explains nothing.
        if dot(&next, &next) > 1e-12 * size.max(f64::MIN_POSITIVE) {
            basis.push(next);
        }
    }
    let (mut time, mut lag) = (column(1), lags.to_vec());
    for other in &basis {
        remove(&mut time, other);
        remove(&mut lag, other);
    }
    let weight = dot(&time, &time);
    let freedom = rows.len().checked_sub(N + 1)? as f64 + 1.0;
    if weight < 1e-6 * rows.len() as f64 {
        return None;
    }
    let slope = dot(&time, &lag) / weight;
    let rest: f64 = time
        .iter()
        .zip(&lag)
        .map(|(t, y)| (y - slope * t).powi(2))
        .sum();
    let variance = rest / freedom;
    Some((slope, (variance / weight).sqrt(), variance.sqrt()))
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// Takes out of `x` what points along `other`, which is not zero.
fn remove(x: &mut [f64], other: &[f64]) {
    let share = dot(x, other) / dot(other, other);
    x.iter_mut()
        .zip(other)
        .for_each(|(x, other)| *x -= share * other);
}
