//! From windows to seconds: means of what the registers show.

use super::entry::Field;
use super::map::Image;
use crate::door::display::LAMPS;
use crate::seconds::Second;

const RESIDUALS: [Field; 4] = [
    Field::Residual1,
    Field::Residual2,
    Field::Residual3,
    Field::Residual4,
];
const MEASURED: [Field; 4] = [
    Field::Voltage,
    Field::Current,
    Field::SupplyFrequency,
    Field::Speed,
];

/// A mean of those values that are numbers.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    sum: f32,
    count: f32,
}

impl Mean {
    fn add(&mut self, value: f32) {
        if value.is_finite() {
            self.sum += value;
            self.count += 1.0;
        }
    }

    /// NaN of nothing.
    fn value(&self) -> f32 {
        self.sum / self.count
    }
}

/// The second that is under way.
#[derive(Clone, Copy, Debug, Default)]
struct UnderWay {
    windows: u8,
    judged: u8,
    not_judged: u8,
    lamps: u32,
    residuals: [Mean; 4],
    measured: [Mean; 4],
}

/// Collects windows and closes seconds.
#[derive(Clone, Copy, Debug)]
pub struct SecondCollector {
    start: u32,
    number: u32,
    now: UnderWay,
}

impl SecondCollector {
    /// In a run of the program whose first event gets the number `start`.
    pub fn new(start: u32) -> Self {
        SecondCollector {
            start,
            number: 0,
            now: UnderWay::default(),
        }
    }

    /// Number of this run of the program.
    pub fn start(&self) -> u32 {
        self.start
    }

    /// Number of the newest whole second; 0 before the first.
    pub fn newest(&self) -> u32 {
        self.number
    }

    /// Takes the registers as a window has left them.
    #[inline(never)]
    pub fn take(&mut self, registers: &Image) {
        let now = &mut self.now;
        now.windows = now.windows.saturating_add(1);
        match registers.word(Field::NotJudged) as u8 {
            0 => now.judged = now.judged.saturating_add(1),
            why => now.not_judged = why,
        }
        now.lamps = brightest(now.lamps, registers.long(Field::Lamps));
        for (mean, field) in now.residuals.iter_mut().zip(RESIDUALS) {
            mean.add(registers.float(field));
        }
        for (mean, field) in now.measured.iter_mut().zip(MEASURED) {
            mean.add(registers.float(field));
        }
    }

    /// Ends the second; lamps and fault as the registers show them now count, too.
    #[inline(never)]
    pub fn close(&mut self, registers: &Image) -> Second {
        self.number = self.number.wrapping_add(1);
        let now = core::mem::take(&mut self.now);
        let [voltage_volt, current_amp, supply_hz, speed_rpm] = now.measured.map(|m| m.value());
        let residuals = now.residuals.map(|mean| mean.value());
        Second {
            start: self.start,
            number: self.number,
            lamps: brightest(now.lamps, registers.long(Field::Lamps)),
            windows: now.windows,
            judged: now.judged,
            not_judged: match now.windows {
                0 => registers.word(Field::NotJudged) as u8,
                _ => now.not_judged,
            },
            fault: registers.word(Field::LikelyFault) as u8,
            residuals: (!residuals.iter().any(|r| r.is_nan())).then_some(residuals),
            voltage_volt,
            current_amp,
            supply_hz,
            speed_rpm,
        }
    }
}

/// Of each lamp the brighter of two: on, then blinking, then off.
fn brightest(a: u32, b: u32) -> u32 {
    (0..LAMPS).fold(0, |lamps, k| {
        let [one, other] = [a, b].map(|all| all >> (2 * k) & 3);
        let lamp = match (one, other) {
            (1, _) | (_, 1) => 1,
            _ => one.max(other),
        };
        lamps | lamp << (2 * k)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn registers(speed_rpm: f32, not_judged: u16, lamps: u32) -> Image {
        let mut image = Image::default();
        image.set_float(Field::Speed, speed_rpm);
        image.set_float(Field::Current, f32::NAN);
        image.set_word(Field::NotJudged, not_judged);
        image.set_long(Field::Lamps, lamps);
        for (k, field) in RESIDUALS.into_iter().enumerate() {
            let residual = if not_judged == 0 { k as f32 } else { f32::NAN };
            image.set_float(field, residual);
        }
        image
    }

    #[test]
    fn a_second_is_the_mean_of_its_windows_and_of_each_lamp_the_brightest() {
        let mut collector = SecondCollector::new(9);
        collector.take(&registers(1_400.0, 0, 0b01_00_10));
        collector.take(&registers(1_402.0, 10, 0b10_10_01));
        let last = registers(1_402.0, 0, 0);
        let second = collector.close(&last);
        assert_eq!((second.start, second.number), (9, 1));
        assert_eq!(
            (second.windows, second.judged, second.not_judged),
            (2, 1, 10)
        );
        assert_eq!(second.lamps, 0b01_10_01);
        assert_eq!(second.speed_rpm, 1_401.0);
        assert!(second.current_amp.is_nan(), "{second:?}");
        assert_eq!(second.residuals, Some([0.0, 1.0, 2.0, 3.0]));
        assert_eq!(collector.newest(), 1);
    }

    #[test]
    fn a_second_without_a_window_says_why() {
        let mut collector = SecondCollector::new(9);
        let second = collector.close(&registers(0.0, 1, 0b10));
        assert_eq!(
            (second.windows, second.not_judged, second.lamps),
            (0, 1, 0b10)
        );
        assert_eq!(second.residuals, None);
        assert!(second.speed_rpm.is_nan());
    }
}
