//! What is said in motion beside the windows at rest, and what it does to the lamps.

use motor::FaultId;

use crate::checks::sensors::SensorFinding;
use crate::isolation::Cause;
use crate::lamps::lamp::{Lamp, Lamps};

/// What is said in motion when a window ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moving {
    /// The window was not at rest, and was judged in motion.
    pub is_judged: bool,
    /// A fault that came while something was changing, as long as its alarm is on.
    pub fault: Option<MovingFault>,
    /// Something came in motion that is not called a fault: none of a size that occurs explains it, or the motor in good order
    /// was never seen in motion.
    pub is_unexplained: bool,
}

/// A fault that came in motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingFault {
    /// What it is.
    pub cause: MovingCause,
    /// How probable that is among the causes that can be told in motion, 0..=1.
    pub probability: f32,
}

/// What a fault that came in motion is put down to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MovingCause {
    /// A departure of motor, load or instrument.
    Departure(Cause),
    /// A channel that shows nothing.
    Dead(SensorFinding),
}

/// How a window stands in motion, by the number that stands in frames and registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum MotionWord {
    /// The window was at rest, or nothing is judged in motion.
    AtRest = 0,
    /// It was judged in motion, and all of it fits.
    Judged = 1,
    /// It was left to motion and could not be judged there either.
    NotJudged = 2,
    /// A fault came in motion.
    Fault = 3,
    /// Something came in motion that is called no fault.
    Unexplained = 4,
}

impl MotionWord {
    /// Every word, in the order of its number.
    pub const ALL: [MotionWord; 5] = [
        MotionWord::AtRest,
        MotionWord::Judged,
        MotionWord::NotJudged,
        MotionWord::Fault,
        MotionWord::Unexplained,
    ];

    /// The word of a number; `None` for one that this version does not know.
    pub fn from_number(number: u8) -> Option<MotionWord> {
        let mut all = MotionWord::ALL.into_iter();
        all.find(|word| *word as u8 == number)
    }

    /// In a few words, for the register map.
    pub const fn label(self) -> &'static str {
        match self {
            MotionWord::AtRest => "at rest, or nothing is judged in motion",
            MotionWord::Judged => "judged in motion",
            MotionWord::NotJudged => "not judged in motion either",
            MotionWord::Fault => "a fault came in motion",
            MotionWord::Unexplained => "something came in motion that is called no fault",
        }
    }
}

impl Moving {
    /// How the window stands; `is_motion`: it was left to motion.
    pub(crate) fn word(&self, is_motion: bool) -> MotionWord {
        match self {
            Moving { fault: Some(_), .. } => MotionWord::Fault,
            Moving {
                is_unexplained: true,
                ..
            } => MotionWord::Unexplained,
            Moving {
                is_judged: true, ..
            } => MotionWord::Judged,
            _ if is_motion => MotionWord::NotJudged,
            _ => MotionWord::AtRest,
        }
    }

    /// The lamps of the windows at rest with what is said in motion over them.
    pub(crate) fn over(&self, at_rest: &Lamps) -> Lamps {
        let mut lamps = *at_rest;
        if self.is_judged {
            lamps.run = Lamp::On;
        }
        if self.is_unexplained {
            lamps.run = Lamp::Blink;
        }
        if let Some(fault) = &self.fault {
            lamps.fault = Lamp::On;
            if fault.cause.is_of_instrument() {
                lamps.sensor = Lamp::On;
            }
        }
        lamps
    }
}

impl MovingCause {
    /// Whether it lies in a sensor.
    pub fn is_of_instrument(self) -> bool {
        match self {
            MovingCause::Dead(_) => true,
            MovingCause::Departure(cause) => matches!(
                cause.fault(),
                FaultId::CurrentSensor | FaultId::VoltageSensor | FaultId::SpeedSensor
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::sensors::Phase;
    use crate::report::{NotJudged, Report};

    fn changing(moving: Moving) -> Lamps {
        let report = Report {
            not_judged: Some(NotJudged::Transient),
            lamps: Lamps {
                run: Lamp::Blink,
                load: Lamp::Blink,
                ..Lamps::default()
            },
            moving: Some(moving),
            ..Report::default()
        };
        report.shown_lamps()
    }

    #[test]
    fn a_window_judged_in_motion_has_run_on_and_load_says_that_it_changes() {
        let lamps = changing(Moving {
            is_judged: true,
            ..Moving::default()
        });
        assert_eq!((lamps.run, lamps.load), (Lamp::On, Lamp::Blink));
        assert!(lamps.is_quiet());
        let blind = changing(Moving::default());
        assert_eq!((blind.run, blind.load), (Lamp::Blink, Lamp::Blink));
    }

    #[test]
    fn a_fault_in_motion_lights_fault_and_sensor_where_it_is_one() {
        let lit = |cause| {
            let fault = MovingFault {
                cause,
                probability: 0.9,
            };
            let lamps = changing(Moving {
                is_judged: true,
                fault: Some(fault),
                is_unexplained: false,
            });
            (lamps.fault, lamps.sensor)
        };
        let of_motor = lit(MovingCause::Departure(Cause::RotorResistance));
        assert_eq!(of_motor, (Lamp::On, Lamp::Off));
        let gain = lit(MovingCause::Departure(Cause::CurrentChannel(Phase::B)));
        assert_eq!(gain, (Lamp::On, Lamp::On));
        let dead = lit(MovingCause::Dead(SensorFinding::SpeedImplausible));
        assert_eq!(dead, (Lamp::On, Lamp::On));
    }

    #[test]
    fn what_no_fault_explains_lights_nothing_and_run_blinks() {
        let lamps = changing(Moving {
            is_judged: true,
            fault: None,
            is_unexplained: true,
        });
        assert!(lamps.is_quiet());
        assert_eq!(lamps.run, Lamp::Blink);
    }
}
