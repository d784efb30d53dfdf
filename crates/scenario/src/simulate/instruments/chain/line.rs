//! Filter and delay of one channel.

use crate::chain::ChannelChain;
use std::collections::VecDeque;

#[derive(Clone, Debug)]
pub(super) struct Line {
    poles: [Pole; 2],
    delay_s: f64,
    /// How long before the last quantity a value may be asked for, s.
    span_s: f64,
    /// No older than delay and span need.
    past: VecDeque<Point>,
    /// The last of them before the time asked for last, or the first: the next one asked for is near.
    before: usize,
}

/// A filtered value, and how it goes on to the next one; flat while there is none.
#[derive(Clone, Copy, Debug)]
struct Point {
    t: f64,
    value: f64,
    slope: f64,
}

impl Line {
    pub(super) fn new(channel: ChannelChain, span_s: f64) -> Line {
        Line {
            poles: channel.time_constants_s.map(Pole::new),
            delay_s: channel.delay_s,
            span_s,
            past: VecDeque::new(),
            before: 0,
        }
    }

    /// Takes the quantity at `t`, `step` after the last one, s; `rate` is its inverse, the same for all channels.
    pub(super) fn observe(&mut self, t: f64, step: f64, rate: f64, x: f64) {
        let value = self.poles.iter_mut().fold(x, |x, pole| pole.next(step, x));
        if let Some(last) = self.past.back_mut() {
            last.slope = (value - last.value) * rate;
        }
        self.past.push_back(Point {
            t,
            value,
            slope: 0.0,
        });
        let wanted = t - self.span_s - self.delay_s;
        while self.past.get(1).is_some_and(|point| point.t <= wanted) {
            self.past.pop_front();
            self.before = self.before.saturating_sub(1);
        }
    }

    /// The value at `t`, at most the span before the last quantity, s; the first value before there was one.
    pub(super) fn at(&mut self, t: f64) -> f64 {
        let wanted = t - self.delay_s;
        self.seek(wanted);
        self.past.get(self.before).map_or(0.0, |point| {
            point.value + point.slope * (wanted - point.t).max(0.0)
        })
    }

    fn seek(&mut self, wanted: f64) {
        let is_before = |point: &Point| point.t < wanted;
        while self.past.get(self.before + 1).is_some_and(is_before) {
            self.before += 1;
        }
        while self.before > 0 && !self.past.get(self.before).is_some_and(is_before) {
            self.before -= 1;
        }
    }
}

/// Steps that differ by this share are the same one: after a day (8.6e4 s) times of 64 bits are told apart by 1.5e-11 s, which is
/// 1.5e-6 of 10 us.
const SAME_STEP: f64 = 2e-6;

/// A first-order low-pass whose input runs straight from one value to the next: exact for such an input.
#[derive(Clone, Debug)]
struct Pole {
    time_constant_s: f64,
    /// Last input and output.
    last: Option<(f64, f64)>,
    /// Steps are mostly alike, and the exponential takes the longest.
    weights: Weights,
}

/// Shares of the old output's distance and of the input's change in the new output, after a step.
#[derive(Clone, Copy, Debug, Default)]
struct Weights {
    step: f64,
    decayed: f64,
    ramp: f64,
}

impl Weights {
    fn new(step: f64, time_constant_s: f64) -> Weights {
        let rate = step / time_constant_s;
        let decayed = -(-rate).exp_m1();
        Weights {
            step,
            decayed,
            ramp: 1.0 - decayed / rate,
        }
    }
}

impl Pole {
    fn new(time_constant_s: f64) -> Pole {
        Pole {
            time_constant_s,
            last: None,
            weights: Weights::default(),
        }
    }

    /// A filter that was not used before has settled on its first value.
    fn next(&mut self, step: f64, x: f64) -> f64 {
        let y = match self.last {
            Some((before, y)) if self.time_constant_s > 0.0 && step > 0.0 => {
                if (step - self.weights.step).abs() > SAME_STEP * step {
                    self.weights = Weights::new(step, self.time_constant_s);
                }
                let Weights { decayed, ramp, .. } = self.weights;
                y + (before - y) * decayed + (x - before) * ramp
            }
            _ => x,
        };
        self.last = Some((x, y));
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(time_constants_s: [f64; 2], delay_s: f64) -> Line {
        spanning(time_constants_s, delay_s, 0.0)
    }

    fn spanning(time_constants_s: [f64; 2], delay_s: f64, span_s: f64) -> Line {
        let channel = ChannelChain {
            time_constants_s,
            delay_s,
            ..ChannelChain::default()
        };
        Line::new(channel, span_s)
    }

    /// Output of a line at `t_end` for an input of time, in steps of `h`.
    fn output(mut line: Line, h: f64, t_end: f64, input: impl Fn(f64) -> f64) -> f64 {
        let steps = (t_end / h).round() as u32;
        for k in 0..=steps {
            line.observe(f64::from(k) * h, h, h.recip(), input(f64::from(k) * h));
        }
        line.at(f64::from(steps) * h)
    }

    /// `y = t - tau (1 - e^(-t/tau))` for a ramp: straight pieces are exact, whatever the step.
    #[test]
    fn a_ramp_through_one_pole_is_exact_in_any_step() {
        let tau = 78e-6;
        let expected = 3e-4 - tau * (1.0 - (-3e-4_f64 / tau).exp());
        for h in [1e-4, 1e-5, 3e-6] {
            let y = output(line([tau, 0.0], 0.0), h, 3e-4, |t| t);
            assert!((y - expected).abs() < 1e-15, "{h}: {y} {expected}");
        }
    }

    #[test]
    fn a_ramp_behind_two_poles_and_a_delay_is_late_by_their_sum() {
        let (taus, delay) = ([78e-6, 7e-6], 23.5e-6);
        let y = output(line(taus, delay), 1e-5, 5e-3, |t| t);
        let late = 5e-3 - y;
        assert!((late - 108.5e-6).abs() < 1e-12, "{late}");
    }

    #[test]
    fn values_of_the_whole_span_can_be_asked_for() {
        let mut line = spanning([0.0; 2], 23.5e-6, 93.75e-6);
        (0..=50).for_each(|k| line.observe(f64::from(k) * 1e-5, 1e-5, 1e5, f64::from(k) * 1e-5));
        for k in 0..16 {
            let t = 5e-4 - f64::from(k) * 6.25e-6;
            assert!((line.at(t) - (t - 23.5e-6)).abs() < 1e-12, "{k}");
        }
    }

    #[test]
    fn a_line_without_filter_and_delay_is_a_wire() {
        assert_eq!(
            output(line([0.0; 2], 0.0), 1e-5, 1e-3, f64::sin),
            1e-3_f64.sin()
        );
    }
}
