//! What can be said of a configuration before anything is connected.

use std::time::Duration;

use super::{Config, LinkConfig, LinkKind};

/// Bits of a character on the line, start, parity and stop included.
const CHARACTER_BITS: f64 = 11.0;
/// Characters of silence around question and answer (Modbus over serial line V1.02, 2.5.1.1: 3.5 each).
const SILENCE_CHARACTERS: f64 = 7.0;
/// Question and answer for the newest numbers: 8, and 5 with 34 bytes of values.
const HEAD_CHARACTERS: f64 = 8.0 + 39.0;
/// Question and answer for seconds, without the seconds themselves.
const FILE_CHARACTERS: f64 = 12.0 + 7.0;
/// A second.
const SECOND_CHARACTERS: f64 = 40.0;
/// Seconds of one answer.
const SECONDS_AN_ANSWER: f64 = 6.0;
/// What board, adapter and operating system take for one answer beside the line, s: an assumption; the usual USB adapter
/// waits for 16 ms before it hands bytes on.
const REACTION_S: f64 = 0.02;
/// Share of the time above which nothing is left for catching up.
const BUSY: f64 = 0.7;

/// What can be said of one link.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// Share of the time for which a serial line is busy; `None` of any other link.
    pub busy: Option<f64>,
    /// What should be changed, and how.
    pub warnings: Vec<String>,
}

/// Looks at a link of a configuration.
pub fn advice(config: &Config, link: usize) -> Option<Advice> {
    let to = config.links.get(link)?;
    let motors = config.motors_of(link).count();
    let busy = busy(to, motors);
    let mut warnings = Vec::new();
    if motors == 0 {
        warnings.push("no motor names it: remove it, or add its motors".to_owned());
    }
    if let Some(busy) = busy.filter(|busy| *busy > BUSY) {
        let shares = (motors as f64 * BUSY / busy).floor();
        warnings.push(format!(
            "{motors} motors every {} s keep the line busy for {:.0} % of the time: raise poll_s (up to 110) or baud, or leave {shares} motors on it",
            to.poll.as_secs_f64(), 100.0 * busy
        ));
    }
    let slowest = to.timeout * 3;
    if to.kind.is_asked() && slowest > config.patience.lost_after {
        warnings.push(format!(
            "three answers that do not come take {} s, longer than lost_after_s: lower timeout_s or raise lost_after_s",
            slowest.as_secs_f64()
        ));
    }
    Some(Advice { busy, warnings })
}

/// Share of the time that a serial line is busy.
fn busy(link: &LinkConfig, motors: usize) -> Option<f64> {
    let LinkKind::ModbusRtu { baud, .. } = link.kind else {
        return None;
    };
    Some(motors as f64 * visit_s(baud, link.poll) / link.poll.as_secs_f64())
}

/// How long a visit takes that fetches the seconds since the last one, s.
fn visit_s(baud: u32, poll: Duration) -> f64 {
    let seconds = poll.as_secs_f64().max(1.0);
    let answers = (seconds / SECONDS_AN_ANSWER).ceil();
    let characters = HEAD_CHARACTERS
        + answers * FILE_CHARACTERS
        + seconds * SECOND_CHARACTERS
        + (1.0 + answers) * SILENCE_CHARACTERS;
    characters * CHARACTER_BITS / f64::from(baud) + (1.0 + answers) * REACTION_S
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 47 + 2 * 19 + 10 * 40 + 3 * 7 = 506 characters of 11 bits at 19 200 bit/s are 0.2899 s, three answers 0.06 s.
    #[test]
    fn a_visit_is_counted_in_characters() {
        let visit = visit_s(19_200, Duration::from_secs(10));
        assert!((visit - 0.349_9).abs() < 1e-4, "{visit}");
    }
}
