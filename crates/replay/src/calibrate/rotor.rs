//! The healthy cage: what its sidebands are at the loads of the recordings.

use monitor::Sidebands;
use motor::MotorFile;
use motor::motor_file::HealthyRotor;

use super::windows::Healthily;
use super::{Refusal, configured};
use crate::timeline::Thinned;

/// Fewest blocks of sidebands: their scatter has to be seen.
const FEWEST: usize = 6;
/// Fewest blocks at each of two loads.
const FEWEST_EACH: usize = 3;
/// Active currents apart by less than this, percent of the rated current, are one load.
const ONE_LOAD_PERCENT: f64 = 10.0;
/// Standard deviation of a normal distribution over its median absolute deviation.
const PER_MEDIAN_DEVIATION: f64 = 1.4826;

/// One block of whole turns: active current, percent of the rated one, and lower sideband, percent of the active one.
type Block = [f64; 2];

/// Sidebands of the healthy cage; `None` where the recordings show too few: idle, too short, or without a speed.
///
/// # Errors
/// Values that the core does not take.
pub fn healthy(
    motor: &MotorFile,
    sources: &[Healthily<'_>],
) -> Result<Option<HealthyRotor>, Refusal> {
    let mut all = Vec::new();
    for source in sources {
        let mut blocks = Thinned::default();
        let config = configured(motor, source.head())?;
        let rated = f64::from(config.rated_current);
        source.monitored(config, &mut |_, report| {
            let (Some(sidebands), Some(limits)) = (&report.rotor.sidebands, &report.rotor.limits)
            else {
                return Ok(());
            };
            if !limits.normalised(sidebands).is_nan() && !limits.is_hidden(sidebands) {
                blocks.push(block(sidebands, rated));
            }
            Ok(())
        })?;
        all.extend_from_slice(&blocks);
    }
    Ok(of_blocks(&mut all))
}

fn block(sidebands: &Sidebands, rated_current: f64) -> Block {
    let active = f64::from(sidebands.active.abs());
    [
        100.0 * active / rated_current,
        100.0 * f64::from(sidebands.lower),
    ]
}

fn of_blocks(blocks: &mut [Block]) -> Option<HealthyRotor> {
    if blocks.len() < FEWEST {
        return None;
    }
    blocks.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let [light, heavy] = loads(blocks);
    let [of_light, of_heavy] = [light, heavy].map(|blocks| [0, 1].map(|k| middle(blocks, k)));
    // From the line's own ends, so that loads between them are no scatter.
    let departure = |blocks: &[Block], [_, lower]: Block| -> Vec<f64> {
        blocks
            .iter()
            .map(|block| (block[1] - lower).abs())
            .collect()
    };
    let mut departures = departure(light, of_light);
    if light != heavy {
        departures.extend(departure(heavy, of_heavy));
    }
    Some(HealthyRotor {
        active_percent: [of_light[0], of_heavy[0]],
        sideband_percent: [of_light[1], of_heavy[1]],
        scatter_percent: PER_MEDIAN_DEVIATION * median(&mut departures),
    })
}

/// Two loads where there are two, parted where the active current changes most; twice the same blocks otherwise.
fn loads(blocks: &[Block]) -> [&[Block]; 2] {
    let inner = FEWEST_EACH..=blocks.len() - FEWEST_EACH;
    let gap = |k: &usize| blocks[*k][0] - blocks[*k - 1][0];
    let widest = inner.max_by(|a, b| gap(a).total_cmp(&gap(b)));
    let [light, heavy] = widest.map_or([blocks; 2], |k| [&blocks[..k], &blocks[k..]]);
    if middle(heavy, 0) - middle(light, 0) < ONE_LOAD_PERCENT {
        return [blocks; 2];
    }
    [light, heavy]
}

fn middle(blocks: &[Block], k: usize) -> f64 {
    median(&mut blocks.iter().map(|block| block[k]).collect::<Vec<_>>())
}

/// The middle of the sorted values; a block that a load step shook does not move it.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    match values.len() {
        0 => 0.0,
        n if n % 2 == 1 => values[half],
        _ => 0.5 * (values[half - 1] + values[half]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(active: f64, lower: f64) -> Vec<Block> {
        [-2.0, -1.0, 0.0, 1.0, 2.0]
            .map(|x| [active + 0.3 * x, lower + 0.01 * x])
            .to_vec()
    }

    #[test]
    fn two_loads_are_told_apart_and_a_shaken_block_moves_nothing() {
        let mut blocks = around(90.0, 0.57);
        blocks.extend(around(60.0, 0.37));
        blocks.push([90.0, 1.1]);
        let rotor = of_blocks(&mut blocks).expect("enough");
        let close = |a: f64, b: f64| assert!((a - b).abs() < 0.011, "{a} {b}");
        close(rotor.sideband_percent[0], 0.37);
        close(rotor.sideband_percent[1], 0.57);
        assert!((rotor.active_percent[0] - 60.0).abs() < 0.5);
        assert!((rotor.active_percent[1] - 90.0).abs() < 0.5);
        assert!((0.01..0.03).contains(&rotor.scatter_percent), "{rotor:?}");
    }

    #[test]
    fn one_load_is_one_and_too_few_blocks_are_none() {
        let mut blocks = [around(90.0, 0.5), around(93.0, 0.5)].concat();
        let rotor = of_blocks(&mut blocks).expect("enough");
        assert_eq!(rotor.active_percent[0], rotor.active_percent[1]);
        assert_eq!(rotor.sideband_percent[0], rotor.sideband_percent[1]);
        assert_eq!(of_blocks(&mut around(90.0, 0.5)), None);
    }
}
