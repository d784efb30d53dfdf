//! What stands at the converter's pins at any time: straight lines between the samples of the simulated sensors.

use std::cell::RefCell;
use std::rc::Rc;

use monitor::RawSample;

use super::Inputs;
use crate::TICK_HZ;

/// Units of time between the samples of the simulated sensors.
const INSTANT: u64 = TICK_HZ / 10_000;
/// Codes of the converter.
const LARGEST: f64 = 4_095.0;
const MIDDLE: f64 = 2_048.0;
/// mV for which the simulated sensors are made.
const NOMINAL_MILLIVOLT: f64 = 3_300.0;

/// The outside world as the pins see it.
#[derive(Clone)]
pub(crate) struct Sensing {
    /// Shared by all snapshots: the outside world does not go back in time.
    inputs: Rc<RefCell<Box<dyn Inputs>>>,
    /// When the program first looked.
    first: Option<u64>,
    /// The sample before and the one behind the last time that was asked for.
    index: u64,
    around: [RawSample; 2],
}

impl Sensing {
    pub fn new(inputs: Box<dyn Inputs>) -> Self {
        Sensing {
            inputs: Rc::new(RefCell::new(inputs)),
            first: None,
            index: 0,
            around: [RawSample::default(); 2],
        }
    }

    /// Goes to the samples around `now`; the share of the way from one to the other.
    fn look(&mut self, now: u64) -> f64 {
        let fresh = self.first.is_none();
        let first = *self.first.get_or_insert(now);
        // A conversion may have sampled before anything else looked.
        let passed = now.saturating_sub(first);
        let index = passed / INSTANT;
        if fresh || index != self.index {
            let mut inputs = self.inputs.borrow_mut();
            let before = match self.around {
                [_, after] if !fresh && index == self.index + 1 => after,
                _ => inputs.at(index),
            };
            self.around = [before, inputs.at(index + 1)];
            self.index = index;
        }
        (passed % INSTANT) as f64 / INSTANT as f64
    }

    /// The encoder's count.
    pub fn count(&mut self, now: u64) -> u16 {
        let share = self.look(now);
        let [before, after] = self.around.map(|raw| raw.encoder_count);
        let moved = after.wrapping_sub(before) as i16;
        before.wrapping_add((f64::from(moved) * share).floor() as i16 as u16)
    }

    /// Code of a channel of ADC1, as wired in docs/wiring.md, sampled at `now` with converters supplied by `millivolt`. The
    /// sensors are absolute: their middle alone follows the supply.
    pub fn code(&mut self, channel: u32, now: u64, millivolt: u32) -> u16 {
        let Some(place) = [1, 6, 8, 2, 7, 9]
            .iter()
            .position(|wired| *wired == channel)
        else {
            return 0;
        };
        let share = self.look(now);
        let [before, after] = self.around.map(|raw| {
            let codes = if place < 3 {
                raw.voltage_codes
            } else {
                raw.current_codes
            };
            f64::from(codes[place % 3])
        });
        let t = now.saturating_sub(self.first.unwrap_or(now)) as f64 / TICK_HZ as f64;
        let ripple = self.inputs.borrow_mut().ripple(place, t);
        let nominal = before + (after - before) * share + ripple;
        let code = match millivolt {
            3_300 => nominal,
            _ => MIDDLE + (nominal - MIDDLE) * NOMINAL_MILLIVOLT / f64::from(millivolt),
        };
        // Within the codes of 12 bits.
        (code + 0.5).clamp(0.0, LARGEST) as u16
    }
}
