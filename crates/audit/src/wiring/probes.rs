//! Second probes in the place of first ones that clip.

use crate::Audit;
use crate::finding::Code;
use recording::{Channel, Recording};

/// The recording with every channel that clips replaced by its second probe, where there is one that does not clip.
/// What was replaced is said in the recording's assumptions; the audit stays that of the file.
pub fn with_sound_probes(recording: &Recording, audit: &Audit) -> Recording {
    let mut sound = recording.clone();
    let clips = |channel: Channel| {
        let name = channel.to_string();
        let mut clipping = audit.findings.iter().filter(|f| f.code == Code::Clipping);
        clipping.any(|finding| finding.channel == name)
    };
    for channel in Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS) {
        let second = Channel::second(channel.signal);
        let Some(values) = recording.channel(second) else {
            continue;
        };
        if clips(channel) && !clips(second) && sound.set(channel, values.to_vec()).is_ok() {
            let said = format!("{channel} clips and is read from its second probe {second}");
            sound.assumptions.push(said);
        }
    }
    sound
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Expectation;
    use crate::audit;
    use recording::{Metadata, Signal};
    use std::f64::consts::TAU;

    /// A second at 5 kHz; currents of 10 A for half of it, of 3 A after.
    fn recording(limit: f64, second_limit: f64) -> Recording {
        let t: Vec<f64> = (0..5000).map(|k| f64::from(k) / 5000.0).collect();
        let wave = |amplitude: f64, phase: f64, limit: f64| -> Vec<f64> {
            let at = |t: &f64| {
                let size = if amplitude < 100.0 && *t > 0.5 {
                    0.3
                } else {
                    1.0
                };
                let x = size * amplitude * (TAU * (50.0 * t - phase / 3.0)).sin();
                x.max(-limit).min(limit)
            };
            t.iter().map(at).collect()
        };
        let mut recording = Recording::new("x", t.clone(), Metadata::default()).expect("a clock");
        for (k, channel) in Channel::VOLTAGES.into_iter().enumerate() {
            let values = wave(325.0, k as f64, 1e9);
            recording.set(channel, values).expect("as long");
        }
        for (k, channel) in Channel::CURRENTS.into_iter().enumerate() {
            let own = if channel.signal == Signal::Ic {
                limit
            } else {
                1e9
            };
            let values = wave(10.0, k as f64 + 0.4, own);
            recording.set(channel, values).expect("as long");
        }
        let second = Channel::second(Signal::Ic);
        let values = wave(10.0, 2.4, second_limit);
        recording.set(second, values).expect("as long");
        recording
    }

    fn replaced(limit: f64, second_limit: f64) -> (bool, Vec<String>) {
        let recording = recording(limit, second_limit);
        let audit = audit(&recording, &Expectation::default());
        let sound = with_sound_probes(&recording, &audit);
        let ic = Channel::first(Signal::Ic);
        let is_second = sound.channel(ic) == recording.channel(Channel::second(Signal::Ic));
        (is_second, sound.assumptions)
    }

    #[test]
    fn a_probe_that_clips_gives_way_to_one_that_does_not() {
        let (is_second, assumptions) = replaced(6.0, 1e9);
        assert!(is_second);
        assert_eq!(
            assumptions,
            ["ic clips and is read from its second probe ic2"]
        );
    }

    #[test]
    fn sound_probes_stay_and_so_do_two_that_clip() {
        assert!(replaced(1e9, 9.0).1.is_empty());
        assert!(replaced(6.0, 6.0).1.is_empty());
    }
}
