//! From the decision's statistics to an alarm with its cause.

use monitor::{MovingCause, MovingFault, SensorFinding};

use super::{Outcome, Scores};
use crate::departures::{ALL, Hypothesis};
use crate::{Motion, MotionState};

/// An alarm in motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionAlarm {
    /// Sample at which the statistic left the noise: about when the fault showed first.
    pub onset_sample: u64,
    /// Sample of the alarm.
    pub raised_sample: u64,
    /// `T` of the likeliest cause.
    pub statistic: f32,
    /// What it was named, twenty judged cycles after the alarm; `None` before.
    pub named: Option<Named>,
}

/// What an alarm in motion is put down to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Named {
    /// A fault.
    Fault(MovingFault),
    /// None of the causes explains it with a size that occurs.
    Untold,
}

/// Share of the limit at which the statistic has left the noise.
const RESTLESS: f32 = 0.5;
/// A cause larger than so many times its typical size does not occur.
const MOST_TYPICAL: f32 = 2.5;
/// The cause that is named explains at least this share of what the strongest would.
const LEAST_SHARE: f32 = 0.7;

impl Motion {
    /// Follows the statistic out of the noise; an alarm where this cycle raised or named one.
    pub(crate) fn note_alarm(
        &self,
        state: &mut MotionState,
        outcome: &Outcome,
        dead: Option<SensorFinding>,
    ) -> Option<MotionAlarm> {
        let restless = outcome.best.statistic.abs() > RESTLESS * self.limits.statistic
            || outcome.square > RESTLESS * self.limits.square;
        let began = state.count.saturating_sub(self.samples as u64);
        state.restless_since = restless.then(|| state.restless_since.unwrap_or(began));
        if outcome.raised {
            state.raised = Some((state.restless_since.unwrap_or(began), state.count));
        }
        let (onset_sample, raised_sample) = state.raised?;
        let named = outcome.named.as_ref();
        let best = named.map_or(outcome.best, |scores| scores.best_of(|_, _| true));
        (outcome.raised || named.is_some()).then(|| MotionAlarm {
            onset_sample,
            raised_sample,
            statistic: best.statistic.abs(),
            named: named.map(|scores| self.cause(scores, dead)),
        })
    }

    fn cause(&self, scores: &Scores, dead: Option<SensorFinding>) -> Named {
        if let Some(finding) = dead {
            return Named::Fault(MovingFault {
                cause: MovingCause::Dead(finding),
                probability: 1.0,
            });
        }
        let best = scores.best_of(|_, _| true);
        let occurs = |hypothesis: &Hypothesis, size: f32| {
            let prior = self.priors.0.get(hypothesis.first).unwrap_or(&1.0);
            (size * prior).abs() < MOST_TYPICAL * hypothesis.cause.typical_size()
        };
        let told = scores.best_of(occurs);
        let hypothesis = ALL.get(told.hypothesis);
        // An alarm by the rows' length alone has no cause yet.
        let least = self
            .limits
            .statistic
            .max(LEAST_SHARE * best.statistic.abs());
        match hypothesis.filter(|_| told.statistic.abs() > least) {
            Some(hypothesis) => Named::Fault(MovingFault {
                cause: MovingCause::Departure(hypothesis.cause),
                probability: scores.probability(&told, occurs),
            }),
            None => Named::Untold,
        }
    }
}
