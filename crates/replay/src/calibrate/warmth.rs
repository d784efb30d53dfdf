//! How warm winding and cage were in each recording of a calibration.
//!
//! A loaded motor is warmer than an idle one. One resistance for all loads would put that down to leakage and magnetizing inductance,
//! and be wrong where the load drives the motor: the same current then raises the flux that it lowered before.

use motor::TParams;

use super::windows::Observed;

/// Standard deviation of a recording's rise of the resistances against the reference: 25 K.
const RISE: f64 = 0.1;
/// Standard deviation of how much more the cage's resistance has risen than the winding's: half of what the monitor lets them part.
const APART: f64 = 0.05;

/// The recordings of a calibration, one of which is the reference: its temperatures are those of the motor file.
#[derive(Clone, Debug)]
pub struct Warmths {
    recordings: usize,
    reference: usize,
}

/// Logarithms of what a recording's resistances are to those of the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Warmth {
    rise: f64,
    apart: f64,
}

impl Warmths {
    /// The reference is the recording of the largest current.
    pub fn of(observed: &[Observed]) -> Self {
        let current = |o: &Observed| o.window.i_s.positive.norm_sqr();
        let largest = observed
            .iter()
            .max_by(|a, b| current(a).total_cmp(&current(b)));
        Warmths {
            recordings: observed.iter().map(|o| o.recording + 1).max().unwrap_or(0),
            reference: largest.map_or(0, |o| o.recording),
        }
    }

    /// Standard deviations of the coordinates' priors: two of each recording but the reference.
    pub fn priors(&self) -> impl Iterator<Item = f64> {
        let others = self.recordings.saturating_sub(1);
        (0..others).flat_map(|_| [RISE, APART])
    }

    /// The warmth of a recording by the coordinates, which are none where nothing was fitted.
    pub fn read(&self, z: &[f64], recording: usize) -> Warmth {
        let own = self.place(recording).and_then(|place| z.get(2 * place..));
        match own {
            Some([rise, apart, ..]) => Warmth {
                rise: *rise,
                apart: *apart,
            },
            _ => Warmth::default(),
        }
    }

    /// By how much a row moves per coordinate; `resistances`: per logarithm of the resistances of stator and rotor.
    pub fn directions(
        &self,
        [stator, rotor]: [f64; 2],
        recording: usize,
    ) -> impl Iterator<Item = f64> {
        let own = self.place(recording);
        let others = self.recordings.saturating_sub(1);
        (0..others).flat_map(move |place| match own == Some(place) {
            true => [stator + rotor, rotor],
            false => [0.0; 2],
        })
    }

    /// The number of a recording among those that are not the reference.
    fn place(&self, recording: usize) -> Option<usize> {
        let before = usize::from(recording > self.reference);
        (recording != self.reference).then(|| recording - before)
    }
}

impl Warmth {
    /// Makes the resistances of the reference those of the recording.
    pub fn applied(&self, parameters: &mut TParams<f64>) {
        parameters.r_s *= self.rise.exp();
        parameters.r_r *= (self.rise + self.apart).exp();
    }
}
