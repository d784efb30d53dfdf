//! What an alarm is likely caused by: the one place where findings about sensors, sidebands of the rotor, the direction
//! of the evidence, the rows of Table 1 and what is known of the instrument beforehand become probabilities.

use crate::beside::moving::{MovingCause, MovingFault};
use crate::checks::sensors::{Phase, SensorFinding};
use crate::isolation::{ALL_CAUSES, CAUSES, Cause, Isolation};
use crate::lamps::lamp::Lamp;
use crate::lamps::signature::{Candidates, TABLE_1};
use crate::report::Report;
use motor::FaultId;

/// Causes whose probability is at least the likeliest one's divided by this are tied with it: half a decade is not worth
/// more than a bare mention (Jeffreys, Theory of Probability, appendix B).
pub const TIE_RATIO: f32 = 3.162_277_7;

/// What may be wrong, whichever way it was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Suspect {
    /// A row of Table 1.
    Row(FaultId),
    /// A cause that the direction of the evidence names.
    Cause(Cause),
    /// A channel that was found wrong.
    Channel(Channel),
    /// Broken rotor bars.
    Bars,
    /// None of them.
    Unknown,
}

/// A quantity that is measured wrongly: a sensor row of Table 1 and, where it is known, the phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    /// `CurrentSensor`, `VoltageSensor` or `SpeedSensor`.
    pub row: FaultId,
    /// The phase.
    pub phase: Option<Phase>,
}

/// One suspect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suspicion {
    /// What may be wrong.
    pub suspect: Suspect,
    /// How probable that is, 0..=1.
    pub probability: f32,
    /// Change that explains the windows best, as a share of the healthy value; only along the direction of the evidence.
    pub size: Option<f32>,
}

/// What the windows say in which no sensor was found to be dead or to contradict the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Witness {
    /// Nothing.
    None,
    /// The sidebands of the current say that bars are broken: they shake every window, so nothing else is asked.
    Bars,
    /// The currents are unbalanced further than the supply makes them: a resistance in one phase, shorted turns or a current
    /// sensor, which nothing tells apart without a calibration.
    Unbalance,
    /// The pattern of r1..r4.
    Table(Candidates),
    /// The direction of the evidence of a calibrated motor.
    Directions {
        /// Probabilities in the order of [`ALL_CAUSES`].
        probabilities: [f32; CAUSES],
        /// Of something else.
        unknown: f32,
        /// Sizes in the same order.
        sizes: [f32; CAUSES],
    },
}

/// What unbalances the currents of a motor on a sound supply.
const BEHIND_UNBALANCE: [FaultId; 4] = [
    FaultId::StatorResistance,
    FaultId::Turns,
    FaultId::CurrentSensor,
    FaultId::VoltageSensor,
];

/// Everything that is known about an alarm: of one window, or summed up over many.
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    /// Channels that windows found wrong, with the share of the windows that did, 0..=1; the shares add up to at most 1.
    pub found: &'a [(Channel, f32)],
    /// What the other windows say.
    pub witness: Witness,
    /// Channels that are known to be wrong beforehand, from the audit of a recording.
    pub wrong: &'a [Channel],
}

/// What a window's report says while FAULT is lit.
pub fn likely(report: &Report, wrong: &[Channel], tell: &mut dyn FnMut(Suspicion)) {
    // What the windows at rest say is surer, where they say anything.
    if let (Some(fault), false) = (fault_in_motion(report), report.lamps.fault == Lamp::On) {
        tell(Suspicion {
            suspect: Suspect::of_motion(fault.cause),
            probability: fault.probability,
            size: None,
        });
        return;
    }
    let found = report.sensor.map(|finding| (Channel::of(finding), 1.0));
    let known = Known {
        found: found.as_slice(),
        witness: Witness::of(report),
        wrong,
    };
    known.weigh(tell);
}

fn fault_in_motion(report: &Report) -> Option<MovingFault> {
    report.moving.and_then(|moving| moving.fault)
}

impl Channel {
    /// The channel that a finding is about.
    pub const fn of(finding: SensorFinding) -> Channel {
        let (row, phase) = match finding {
            SensorFinding::DeadVoltage(phase) => (FaultId::VoltageSensor, Some(phase)),
            SensorFinding::VoltagesMissing => (FaultId::VoltageSensor, None),
            SensorFinding::DeadCurrent(phase) => (FaultId::CurrentSensor, Some(phase)),
            SensorFinding::CurrentSum => (FaultId::CurrentSensor, None),
            SensorFinding::SpeedImplausible => (FaultId::SpeedSensor, None),
        };
        Channel { row, phase }
    }
}

impl Suspect {
    const fn of_motion(cause: MovingCause) -> Suspect {
        match cause {
            MovingCause::Departure(cause) => Suspect::Cause(cause),
            MovingCause::Dead(finding) => Suspect::Channel(Channel::of(finding)),
        }
    }

    /// The fault of the catalogue that it is.
    pub const fn fault(self) -> FaultId {
        match self {
            Suspect::Row(fault) => fault,
            Suspect::Cause(cause) => cause.fault(),
            Suspect::Channel(channel) => channel.row,
            Suspect::Bars => FaultId::Bars,
            Suspect::Unknown => FaultId::Unknown,
        }
    }

    /// The phase, where it is known.
    pub const fn phase(self) -> Option<Phase> {
        match self {
            Suspect::Cause(cause) => cause.phase(),
            Suspect::Channel(channel) => channel.phase,
            Suspect::Row(_) | Suspect::Bars | Suspect::Unknown => None,
        }
    }

    /// Whether both name the same thing in the same place.
    fn is(self, channel: Channel) -> bool {
        let same_fault = match self {
            Suspect::Row(_) | Suspect::Cause(_) => self.fault() == channel.row,
            Suspect::Channel(_) | Suspect::Bars | Suspect::Unknown => false,
        };
        // A row of the table knows no phase: it is the same channel, said less exactly.
        same_fault && (matches!(self, Suspect::Row(_)) || self.phase() == channel.phase)
    }
}

impl Witness {
    /// What one window says.
    pub fn of(report: &Report) -> Witness {
        match (&report.isolation, &report.candidates) {
            _ if report.rotor.is_broken => Witness::Bars,
            (Some(isolation), _) => Witness::directions(isolation),
            (None, Some(candidates)) => Witness::Table(*candidates),
            (None, None) if report.is_unbalanced => Witness::Unbalance,
            (None, None) => Witness::None,
        }
    }

    fn directions(isolation: &Isolation) -> Witness {
        let (probabilities, unknown) = isolation.probabilities();
        Witness::Directions {
            probabilities,
            unknown,
            sizes: isolation.sizes,
        }
    }

    /// Each suspect with its probability; together 1, or nothing.
    fn suspects(&self, tell: &mut dyn FnMut(Suspicion)) {
        let mut plain = |suspect, probability| {
            tell(Suspicion {
                suspect,
                probability,
                size: None,
            });
        };
        match self {
            Witness::None => {}
            Witness::Bars => plain(Suspect::Bars, 1.0),
            Witness::Unbalance => {
                let share = 1.0 / BEHIND_UNBALANCE.len() as f32;
                BEHIND_UNBALANCE
                    .into_iter()
                    .for_each(|fault| plain(Suspect::Row(fault), share));
            }
            Witness::Table(candidates) => {
                let rows = TABLE_1.iter().zip(candidates.faults);
                rows.for_each(|((fault, _), p)| plain(Suspect::Row(*fault), p));
                plain(Suspect::Unknown, candidates.unknown);
            }
            Witness::Directions {
                probabilities,
                unknown,
                sizes,
            } => {
                plain(Suspect::Unknown, *unknown);
                let causes = ALL_CAUSES.into_iter().zip(probabilities).zip(sizes);
                causes.for_each(|((cause, &probability), &size)| {
                    tell(Suspicion {
                        suspect: Suspect::Cause(cause),
                        probability,
                        size: Some(size),
                    });
                });
            }
        }
    }
}

impl Known<'_> {
    /// Hands over every suspect with its probability, in no order; together they are 1, or there is none.
    ///
    /// A channel that windows found wrong has these windows' share. Of the rest, a channel that is known to be wrong
    /// beforehand has one half where the rows of Table 1 speak: whether it explains the alarm too, or a fault stands beside
    /// it, they cannot tell. The evidence of a calibrated motor holds the sequences of its channels already, as they were
    /// when it was healthy, and sidebands of broken bars come from no channel.
    pub fn weigh(&self, tell: &mut dyn FnMut(Suspicion)) {
        let shares = self.shares();
        for (k, (channel, _)) in self.found.iter().enumerate() {
            if !self.found[..k].iter().any(|(known, _)| known == channel) {
                tell(self.suspicion(*channel, &shares));
            }
        }
        for (k, channel) in self.wrong.iter().enumerate() {
            let told = self.found.iter().any(|(known, _)| known == channel);
            if !told && !self.wrong[..k].contains(channel) {
                tell(self.suspicion(*channel, &shares));
            }
        }
        self.witness.suspects(&mut |suspicion| {
            if self.owner(suspicion.suspect).is_none() {
                let probability = shares.witness * suspicion.probability;
                tell(Suspicion {
                    probability,
                    ..suspicion
                });
            }
        });
    }

    fn shares(&self) -> Shares {
        let found: f32 = self.found.iter().map(|(_, share)| share).sum();
        let beforehand = match self.witness {
            _ if self.wrong.is_empty() => 0.0,
            Witness::Bars | Witness::Directions { .. } => 0.0,
            Witness::None => 1.0,
            Witness::Table(_) | Witness::Unbalance => 0.5,
        };
        let silent = self.witness == Witness::None && self.wrong.is_empty();
        // Where nothing else speaks, the findings are all there is.
        let scale = if silent || found > 1.0 {
            found.max(f32::MIN_POSITIVE)
        } else {
            1.0
        };
        let rest = if silent {
            0.0
        } else {
            (1.0 - found / scale).max(0.0)
        };
        Shares {
            scale,
            each_wrong: rest * beforehand / self.wrong.len().max(1) as f32,
            witness: rest * (1.0 - beforehand),
        }
    }

    /// The channel with everything that is said of it, by whatever name.
    fn suspicion(&self, channel: Channel, shares: &Shares) -> Suspicion {
        let found = self.found.iter().filter(|(known, _)| *known == channel);
        let wrong = self.wrong.iter().filter(|known| **known == channel);
        let mut probability = found.map(|(_, share)| share / shares.scale).sum::<f32>()
            + shares.each_wrong * wrong.count() as f32;
        let mut size = None;
        self.witness.suspects(&mut |suspicion| {
            if self.owner(suspicion.suspect) == Some(channel) {
                probability += shares.witness * suspicion.probability;
                size = suspicion.size.or(size);
            }
        });
        Suspicion {
            suspect: Suspect::Channel(channel),
            probability,
            size,
        }
    }

    /// The channel under which a suspect is told.
    fn owner(&self, suspect: Suspect) -> Option<Channel> {
        let found = self.found.iter().map(|(channel, _)| *channel);
        let mut told = found.chain(self.wrong.iter().copied());
        told.find(|channel| suspect.is(*channel))
    }
}

/// How the probability is dealt out.
struct Shares {
    /// What the shares of the findings are divided by.
    scale: f32,
    /// For each channel that is known to be wrong beforehand.
    each_wrong: f32,
    /// For all that the witness says.
    witness: f32,
}

#[cfg(test)]
mod tests {

    use super::*;
    use std::vec::Vec;

    const CURRENT_A: Channel = Channel {
        row: FaultId::CurrentSensor,
        phase: Some(Phase::A),
    };
    /// The pattern of a rotor inductance: all four residuals.
    const ALL_FOUR: [f32; 4] = [3.0, 3.0, 3.0, 3.0];

    fn weighed(known: &Known<'_>) -> Vec<(&'static str, Option<Phase>, f32)> {
        let mut all = Vec::new();
        known
            .weigh(&mut |s| all.push((s.suspect.fault().name(), s.suspect.phase(), s.probability)));
        all.sort_by(|a, b| b.2.total_cmp(&a.2));
        let sum: f32 = all.iter().map(|(.., p)| p).sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum}: {all:?}");
        all
    }

    fn table(normalised: [f32; 4]) -> Witness {
        Witness::Table(Candidates::from_normalised(&normalised))
    }

    #[test]
    fn a_channel_that_the_audit_found_wrong_ties_with_what_the_residuals_name() {
        let alone = weighed(&Known {
            found: &[],
            witness: table(ALL_FOUR),
            wrong: &[],
        });
        assert_eq!(alone[0].0, "Lr");
        let warned = weighed(&Known {
            found: &[],
            witness: table(ALL_FOUR),
            wrong: &[CURRENT_A],
        });
        assert_eq!((warned[0].0, warned[0].1), ("Iq", Some(Phase::A)));
        assert!(warned[0].2 >= 0.5 && warned[1].0 == "Lr");
        assert!(
            warned[1].2 > warned[0].2 / TIE_RATIO,
            "not told apart: {warned:?}"
        );
        assert_eq!(warned.iter().filter(|(name, ..)| *name == "Iq").count(), 1);
    }

    #[test]
    fn dead_windows_have_their_share_and_the_rest_is_dealt_out_once() {
        let found = [(CURRENT_A, 0.25)];
        let all = weighed(&Known {
            found: &found,
            witness: table([3.0, 0.0, 0.1, 3.0]),
            wrong: &[],
        });
        let of = |name| {
            all.iter()
                .find(|(known, ..)| *known == name)
                .map_or(0.0, |x| x.2)
        };
        assert!((of("Rs") - of("Rr")).abs() < 1e-6 && of("Rs") > 0.3);
        assert!((0.25..0.27).contains(&of("Iq")), "{all:?}");
    }

    /// Where r1..r4 name a row, an unbalance beside it does not blur it; where they are dark it is all there is.
    #[test]
    fn an_unbalance_speaks_where_the_residuals_are_dark() {
        let mut unbalanced = Report {
            is_unbalanced: true,
            ..Report::default()
        };
        assert_eq!(Witness::of(&unbalanced), Witness::Unbalance);
        let rows = weighed(&Known {
            found: &[],
            witness: Witness::Unbalance,
            wrong: &[],
        });
        assert_eq!(rows.len(), BEHIND_UNBALANCE.len());
        assert!(rows.iter().all(|(_, _, p)| (p - 0.25).abs() < 1e-6)); // f32
        let candidates = Candidates::from_normalised(&[3.0, 3.0, 3.0, 0.0]);
        unbalanced.candidates = Some(candidates);
        assert_eq!(Witness::of(&unbalanced), Witness::Table(candidates));
    }

    #[test]
    fn a_dead_sensor_alone_is_certain_and_bars_do_not_come_from_a_channel() {
        let dead = Report {
            sensor: Some(SensorFinding::DeadCurrent(Phase::A)),
            ..Report::default()
        };
        let mut told = Vec::new();
        likely(&dead, &[], &mut |s| told.push((s.suspect, s.probability)));
        assert_eq!(told, [(Suspect::Channel(CURRENT_A), 1.0)]);
        let bars = weighed(&Known {
            found: &[],
            witness: Witness::Bars,
            wrong: &[CURRENT_A],
        });
        assert_eq!((bars[0].0, bars[0].2), ("bars", 1.0));
    }

    #[test]
    fn one_channel_by_two_names_is_one_suspect() {
        let mut probabilities = [0.0; CAUSES];
        let k = ALL_CAUSES
            .iter()
            .position(|cause| *cause == Cause::CurrentChannel(Phase::A));
        probabilities[k.unwrap_or(0)] = 0.9;
        let witness = Witness::Directions {
            probabilities,
            unknown: 0.1,
            sizes: [0.1; CAUSES],
        };
        let all = weighed(&Known {
            found: &[],
            witness,
            wrong: &[CURRENT_A],
        });
        assert_eq!((all[0].0, all[0].1), ("Iq", Some(Phase::A)));
        // What the calibration knows of its channels is no news.
        assert!((all[0].2 - 0.9).abs() < 1e-6);
        let named = all.iter().filter(|x| (x.0, x.1) == ("Iq", Some(Phase::A)));
        assert_eq!(named.count(), 1);
    }

    #[test]
    fn nothing_known_names_nothing() {
        let mut told = 0;
        likely(&Report::default(), &[], &mut |_| told += 1);
        assert_eq!(told, 0);
    }
}
