//! The slip of the greatest torque.

use super::{Circuit, Rating, Winding};

/// Slips tried between rated slip and standstill, evenly in their logarithm.
const GRID: usize = 21;
/// Steps of the refinement; each parabola squares the error.
const REFINEMENTS: usize = 8;
/// Step in the logarithm of the slip that ends the refinement: torque is flat there, its error is the square.
const FINE: f64 = 1e-4;

/// Slip at which the cold motor's torque is greatest between rated slip and standstill.
pub fn breakdown_slip(circuit: &Circuit, rating: &Rating) -> f64 {
    let torque = |log_slip: f64| {
        circuit
            .at_slip(rating, log_slip.exp(), Winding::Cold)
            .torque
    };
    let lowest = rating.slip.clamp(1e-3, 0.9).ln();
    let step = -lowest / (GRID - 1) as f64;
    let values: [f64; GRID] = core::array::from_fn(|k| torque(lowest + step * k as f64));
    let best = (0..GRID)
        .max_by(|&a, &b| values[a].total_cmp(&values[b]))
        .unwrap_or(0);
    let (mut middle, mut half) = (lowest + step * best as f64, step);
    let mut at_middle = values[best];
    for _ in 0..REFINEMENTS {
        let (left, right) = (middle - half, (middle + half).min(0.0));
        let (at_left, at_right) = (torque(left), torque(right));
        let candidates = [
            (left, at_left),
            (right, at_right),
            vertex((left, at_left), (middle, at_middle), (right, at_right))
                .map_or((middle, at_middle), |x| (x, torque(x))),
        ];
        let old = middle;
        for (place, value) in candidates {
            if value > at_middle {
                (middle, at_middle) = (place, value);
            }
        }
        let moved = (middle - old).abs();
        half = (0.25 * half).max(moved.min(half));
        if moved < FINE && half < 10.0 * FINE {
            break;
        }
    }
    middle.exp()
}

/// Abscissa of the top of the parabola through three points, inside them.
fn vertex(left: (f64, f64), middle: (f64, f64), right: (f64, f64)) -> Option<f64> {
    let (before, after) = (middle.0 - left.0, right.0 - middle.0);
    if after < 1e-9 {
        return None;
    }
    let rise = (middle.1 - left.1) / before;
    let fall = (right.1 - middle.1) / after;
    let curvature = (fall - rise) / (before + after);
    let slope = fall - curvature * after;
    (curvature < 0.0).then(|| (middle.0 - slope / (2.0 * curvature)).clamp(left.0, right.0))
}
