//! What the front end promises; docs/wiring.md prints the same figures.

/// A channel at one frequency.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub hertz: f64,
    /// Over nominal.
    pub gain: f64,
    pub delay_us: f64,
}

/// Voltage against current of one board.
#[derive(Clone, Copy, Debug)]
pub struct Board {
    pub hertz: f64,
    pub gain_percent: f64,
    pub delay_us: f64,
}

/// Delay of the voltage and of the current channel at 60 Hz.
const DELAY_US: [f64; 2] = [88.94, 85.73];
/// Of the voltage against the current.
const AGAINST_US: f64 = 3.21;
/// From one circuit simulator to another, and the amplifier that is fitted.
const DELAY_WITHIN_US: f64 = 0.15;
/// 5 to 100 Hz.
const FLAT_WITHIN_US: f64 = 0.1;
const GAIN_WITHIN: f64 = 0.0005;
/// At 10 and at 160 kHz, dB.
const ATTENUATION_DB: [(f64, f64); 2] = [(10e3, 14.0), (160e3, 55.0)];
const SPREAD_GAIN_PERCENT: f64 = 1.4;
const SPREAD_DELAY_US: f64 = 2.2;
/// Percent of the difference to the neighbour.
const CROSSTALK_PERCENT: f64 = 0.02;

pub fn nominal_problems(voltage: &[Point], current: &[Point]) -> Vec<String> {
    let mut problems = Vec::new();
    for (name, points, delay_us) in [("V", voltage, DELAY_US[0]), ("I", current, DELAY_US[1])] {
        for hertz in [50.0, 60.0] {
            let point = at(points, hertz);
            if (point.gain - 1.0).abs() > GAIN_WITHIN {
                problems.push(format!("{name}: gain at {hertz} Hz is {:.5}", point.gain));
            }
            if (point.delay_us - delay_us).abs() > DELAY_WITHIN_US {
                problems.push(format!(
                    "{name}: delay at {hertz} Hz is {:.2} us",
                    point.delay_us
                ));
            }
        }
        let flat = at(points, 5.0).delay_us - at(points, 100.0).delay_us;
        if flat.abs() > FLAT_WITHIN_US {
            problems.push(format!("{name}: delay is not flat by {flat:.2} us"));
        }
        for (hertz, least) in ATTENUATION_DB {
            let db = -20.0 * at(points, hertz).gain.log10();
            if db < least {
                problems.push(format!("{name}: {db:.1} dB at {hertz} Hz"));
            }
        }
    }
    let against = at(voltage, 60.0).delay_us - at(current, 60.0).delay_us;
    if (against - AGAINST_US).abs() > DELAY_WITHIN_US {
        problems.push(format!("V against I: {against:.2} us"));
    }
    problems
}

pub fn spread_problems(boards: &[Board]) -> Vec<String> {
    let mut problems = Vec::new();
    for hertz in [50.0, 60.0] {
        let of: Vec<&Board> = boards.iter().filter(|board| board.hertz == hertz).collect();
        let mean = of.iter().map(|board| board.delay_us).sum::<f64>() / of.len() as f64;
        if (mean - AGAINST_US).abs() > DELAY_WITHIN_US {
            problems.push(format!("mean delay at {hertz} Hz is {mean:.2} us"));
        }
        let widest =
            |value: fn(&Board) -> f64| of.iter().map(|b| value(b).abs()).fold(0.0, f64::max);
        let gain = widest(|board| board.gain_percent);
        if gain > SPREAD_GAIN_PERCENT {
            problems.push(format!("gain at {hertz} Hz is off by {gain:.2} %"));
        }
        let delay = widest(|board| board.delay_us - AGAINST_US);
        if delay > SPREAD_DELAY_US {
            problems.push(format!("delay at {hertz} Hz is off by {delay:.2} us"));
        }
    }
    problems
}

pub fn crosstalk_problems(percent: f64) -> Vec<String> {
    match percent.abs() > CROSSTALK_PERCENT {
        true => vec![format!("cross-talk {percent:.4} %")],
        false => Vec::new(),
    }
}

fn at(points: &[Point], hertz: f64) -> Point {
    let found = points.iter().find(|point| point.hertz == hertz);
    *found.unwrap_or_else(|| panic!("{hertz} Hz was not simulated"))
}
