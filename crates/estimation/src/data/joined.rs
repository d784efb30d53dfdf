//! Several recordings as one case that is fitted: each begins anew.

use crate::data::case::{Case, Waveform};
use motor::effect::Cut;
use signal::append;
use std::ops::Range;
use std::sync::Arc;

/// Of several recordings those that are fitted together, and those that prove: every second one proves.
pub fn shared(cases: Vec<Case>) -> Option<(Case, Vec<Case>)> {
    let mut cases = cases.into_iter();
    let mut fitted = cases.next()?;
    let mut proofs = Vec::new();
    for (k, case) in cases.enumerate() {
        if k % 2 == 0 {
            proofs.push(case);
            continue;
        }
        fitted = match fitted.joined(case) {
            Ok(both) => both,
            Err(apart) => {
                let (fitted, case) = *apart;
                proofs.push(case);
                fitted
            }
        };
    }
    Some((fitted, proofs))
}

/// The first recording alone, which is fitted, and all others, which prove.
pub fn first_alone(cases: Vec<Case>) -> Option<(Case, Vec<Case>)> {
    let mut cases = cases.into_iter();
    Some((cases.next()?, cases.collect()))
}

/// All recordings as one case that is fitted; `None` where they do not suit.
pub fn together(cases: impl IntoIterator<Item = Case>) -> Option<Case> {
    let mut cases = cases.into_iter();
    let first = cases.next()?;
    cases.try_fold(first, |fitted, case| fitted.joined(case).ok())
}

impl Case {
    /// This recording and another one behind it; as they are where they do not suit, or where one is a load table.
    fn joined(self, other: Case) -> Result<Case, Box<(Case, Case)>> {
        match (self, other) {
            (Case::Waveform(one), Case::Waveform(other)) => match one.joined(*other) {
                Ok(both) => Ok(both.into()),
                Err(apart) => Err(Box::new((apart.0.into(), apart.1.into()))),
            },
            apart => Err(Box::new(apart)),
        }
    }
}

impl Waveform {
    /// Whether two recordings can be fitted together: sampled, sampled again and judged alike.
    fn suits(&self, other: &Waveform) -> bool {
        let key = |c: &Waveform| {
            (
                c.between,
                c.decimation,
                c.block,
                c.finer,
                c.speed_is_input,
                c.inverter,
            )
        };
        let alike = |a: bool, b: bool| a == b;
        key(self) == key(other)
            && (self.inputs.t_sample / other.inputs.t_sample - 1.0).abs() < 1e-6
            && alike(self.speed.is_empty(), other.speed.is_empty())
            && alike(self.coarse.is_some(), other.coarse.is_some())
            && alike(self.supply.denoised, other.supply.denoised)
    }

    /// This recording and another one behind it, each in whole blocks; the recordings as they are where they do not suit.
    ///
    /// # Errors
    /// The other recording, if it cannot be fitted together with this one.
    pub fn joined(self, other: Waveform) -> Result<Waveform, Box<(Waveform, Waveform)>> {
        let begins = Cut {
            sample: 0,
            t: 0.0,
            is_new: true,
        };
        self.joined_at(other, begins)
    }

    /// A stretch that begins at `at` in its recording.
    #[must_use]
    pub(super) fn beginning(mut self, at: Cut) -> Waveform {
        if at.t > 0.0 {
            let timeline = Arc::make_mut(&mut self.timeline);
            timeline.cuts.insert(0, at);
            self.running_at_cuts.insert(0, self.running_at);
        }
        self
    }

    /// This case and another one behind it that begins at the time of `begins`.
    ///
    /// # Errors
    /// As [`Waveform::joined`].
    pub(super) fn joined_at(
        mut self,
        other: Waveform,
        begins: Cut,
    ) -> Result<Waveform, Box<(Waveform, Waveform)>> {
        if !self.suits(&other) {
            return Err(Box::new((self, other)));
        }
        self.keep_whole_blocks();
        let from = self.inputs.u_s.len();
        let rows = from / self.samples_per_row();
        debug_assert_eq!(rows, self.measured.len());
        let behind = |r: &Range<usize>| r.start + from..r.end + from;
        let timeline = Arc::make_mut(&mut self.timeline);
        timeline.cuts.push(Cut {
            sample: from,
            ..begins
        });
        let later = other.timeline.cuts.iter();
        timeline.cuts.extend(later.map(|cut| Cut {
            sample: cut.sample + from,
            ..*cut
        }));
        append(&mut timeline.omega_sync, &other.timeline.omega_sync);
        append(&mut timeline.theta_mech, &other.timeline.theta_mech);
        append(&mut self.inputs.u_s, &other.inputs.u_s);
        append(&mut self.inputs.tau_load, &other.inputs.tau_load);
        append(&mut self.speed, &other.speed);
        self.running_at_cuts.push(other.running_at);
        self.running_at_cuts.extend(other.running_at_cuts);
        self.open.extend(other.open.iter().map(behind));
        append(&mut self.measured, &other.measured);
        append(&mut self.weight, &other.weight);
        let coarse = self.coarse.take().zip(other.coarse);
        Ok(Waveform {
            coarse: coarse.map(|(a, b)| a.joined(b)),
            supply: std::mem::take(&mut self.supply).joined(other.supply),
            load_windows: std::mem::take(&mut self.load_windows).joined(&other.load_windows),
            speed_windows: std::mem::take(&mut self.speed_windows).joined(&other.speed_windows),
            ..self
        })
    }

    /// Leaves out what does not fill a block at the end.
    fn keep_whole_blocks(&mut self) {
        let rows = self.measured.len() / self.block * self.block;
        let samples = (rows * self.samples_per_row()).min(self.inputs.u_s.len());
        let all = 0..samples;
        self.measured.truncate(rows);
        self.weight.truncate(rows);
        self.inputs.u_s.truncate(samples);
        self.inputs.tau_load.truncate(samples);
        self.speed.truncate(samples);
        let timeline = Arc::make_mut(&mut self.timeline);
        timeline.omega_sync.truncate(samples);
        timeline.theta_mech.truncate(samples);
        let of_recording = 0..samples / self.finer;
        self.coarse = self
            .coarse
            .as_ref()
            .map(|x| x.taken(std::slice::from_ref(&of_recording)));
        self.supply = self.supply.taken(&[all]);
        self.load_windows = self.load_windows.taken(std::slice::from_ref(&of_recording));
        self.speed_windows = self.speed_windows.taken(&[of_recording]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::prediction::{SpeedObserver, outputs, residual};
    use crate::specimen;

    fn waveform(seconds: f64, torque: f64) -> Waveform {
        let rated = specimen::prior("").plant.rated;
        Waveform::new(&specimen::recording(seconds, |_| torque), &rated).expect("judged")
    }

    /// Simulated together or one by one: the same rows. What does not fill a block at the end of the first is left out.
    #[test]
    fn joined_recordings_are_simulated_as_each_alone() {
        let study = specimen::study(0.5, |_| 1.0);
        let h = study.at_prior();
        let run =
            |one: &Waveform| outputs(&one.clone().into(), &study.prior, &h, SpeedObserver::Off);
        let (one, other) = (waveform(0.515, 0.5), waveform(0.4, 1.5));
        let both = one.clone().joined(other.clone()).expect("alike");
        let (joined, first, second) = (run(&both), run(&one), run(&other));
        let kept = joined.len() - second.len();
        assert!(kept < first.len() && first.len() - kept < both.block * 5);
        // Times of the second are counted from the first: rounding.
        let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(same(&joined[..kept], &first));
        assert!(same(&joined[kept..], &second));
        assert_eq!(residual(&both.clone().into(), &joined).len(), joined.len());
        assert_eq!(both.time_of(kept / 5), 0.0);
    }

    #[test]
    fn every_second_recording_proves_and_what_does_not_suit_proves_too() {
        let held = || {
            let mut held = waveform(0.4, 1.0);
            held.decimation += 1;
            Case::from(held)
        };
        let all = || {
            [0.5, 1.0, 1.5]
                .map(|torque| Case::from(waveform(0.4, torque)))
                .to_vec()
        };
        let cuts = |case: &Case| case.waveform().map_or(0, |one| one.timeline.cuts.len());
        let (fitted, proofs) = shared(all()).expect("three");
        assert_eq!((cuts(&fitted), proofs.len()), (1, 1));
        let mut odd = all();
        odd[2] = held();
        let (fitted, proofs) = shared(odd).expect("three");
        assert_eq!((cuts(&fitted), proofs.len()), (0, 2));
        assert!(shared(Vec::new()).is_none());
    }
}
