//! One audit of a recording that was audited piece by piece.
//!
//! A finding that several pieces share is told once: as it is in the piece where it is largest, with the share of the pieces
//! that have it and its first place. A piece that the audit refuses is not judged; the recording is refused as a whole where
//! most of what the motor was supplied is.

use crate::finding::{Audit, Code, Finding};
use crate::timing::clock::GAP;
use crate::timing::gap;
use recording::Recording;

/// Sampling times of pieces that differ by more are two clocks, percent.
const OTHER_CLOCK_PERCENT: f64 = 1.0;

/// Shares of the largest current or voltage of any piece below which a motor stood idle: what is said of its channels then is
/// said of noise.
const IDLE: f64 = 0.05;
/// Shortest piece that a supply must be found in, s: a file may end in a short one.
const SHORTEST_S: f64 = 0.2;
/// A sample in so many tells the size of a signal.
const STRIDE: usize = 7;

/// The audits of the pieces so far, in the order of time.
#[derive(Clone, Debug, Default)]
pub struct Merger {
    pieces: Vec<Piece>,
    first: Option<Audit>,
    latest: Option<Audit>,
    /// Largest root mean square of the voltages, V, and the currents, A, of a piece.
    largest: [f64; 2],
}

/// What is kept of a piece.
#[derive(Clone, Debug)]
struct Piece {
    span: [f64; 2],
    t_sample: f64,
    rms: [f64; 2],
    findings: Vec<Finding>,
}

/// A finding and the pieces that have it.
#[derive(Clone, Debug)]
struct Found {
    largest: Finding,
    is_refusing: bool,
    is_same: bool,
    pieces: u64,
    /// The latest of them, counted from 1.
    latest: u64,
    from_s: f64,
    to_s: f64,
    /// Whether the first says itself where it begins, and the latest where it ends.
    says: [bool; 2],
}

impl Merger {
    /// Takes the next piece with its audit; `true` where it may be judged with the others. A motor that is switched off or
    /// idle for a while is no fault of the recording.
    pub fn add(&mut self, piece: &Recording, audit: &Audit) -> bool {
        let rms = [piece.voltages(), piece.currents()].map(rms);
        for (largest, rms) in self.largest.iter_mut().zip(rms) {
            *largest = rms.max(*largest);
        }
        let mut piece = Piece {
            span: [piece.t()[0], piece.t()[piece.len() - 1]],
            t_sample: piece.t_sample(),
            rms,
            findings: audit.findings.clone(),
        };
        if let Some(before) = self.pieces.last() {
            let first_t_sample = self
                .pieces
                .first()
                .map_or(before.t_sample, |first| first.t_sample);
            piece.add_border(before, first_t_sample);
        }
        let is_usable = !piece.is_refused(self.largest);
        self.pieces.push(piece);
        self.first.get_or_insert_with(|| audit.clone());
        self.latest = Some(audit.clone());
        is_usable
    }

    /// What the pieces come to; of a single one its own audit.
    pub fn finish(self) -> Audit {
        let (Some(first), Some(latest)) = (self.first, self.latest) else {
            return Audit {
                supported: false,
                findings: Vec::new(),
                assumptions: Vec::new(),
                unusable: Vec::new(),
            };
        };
        if self.pieces.len() < 2 {
            return first;
        }
        let begin_s = self.pieces.first().map_or(0.0, |piece| piece.span[0]);
        let end_s = self.pieces.last().map_or(0.0, |piece| piece.span[1]);
        let supplied = self
            .pieces
            .iter()
            .filter(|piece| piece.is_supplied(self.largest));
        let refused = supplied
            .clone()
            .filter(|piece| piece.is_refused(self.largest));
        let (supplied, refused) = (supplied.count(), refused.count());
        let whole = Whole {
            pieces: self.pieces.len() as u64,
            is_supported: supplied > 0 && 2 * refused <= supplied,
            piece_s: (end_s - begin_s) / self.pieces.len() as f64,
        };
        let mut found = Vec::new();
        for (k, piece) in self.pieces.iter().enumerate() {
            let said = piece
                .findings
                .iter()
                .filter(|one| piece.means(one, self.largest));
            said.for_each(|finding| note(&mut found, finding, piece.span, k as u64 + 1));
        }
        let in_both = |channel: &String| latest.unusable.contains(channel);
        Audit {
            supported: whole.is_supported,
            findings: found.into_iter().map(|one| whole.told(one)).collect(),
            // How a file was read is known when it was read to its end.
            assumptions: latest.assumptions.clone(),
            unusable: first.unusable.into_iter().filter(in_both).collect(),
        }
    }
}

/// Root mean square of three channels; 0 where they were not recorded.
fn rms(three: Option<[&[f64]; 3]>) -> f64 {
    let Some(three) = three else {
        return 0.0;
    };
    let samples = || three.iter().flat_map(|x| x.iter().step_by(STRIDE));
    let square: f64 = samples().map(|x| x * x).sum();
    (square / samples().count().max(1) as f64).sqrt()
}

/// Whether a finding says that there is no supply, or none at the clock as it was read.
fn is_about_supply(finding: &Finding) -> bool {
    let by_clock = finding.code == Code::Unit && finding.channel == "t";
    finding.refuses && (finding.code == Code::NotLocked || by_clock)
}

impl Audit {
    /// Whether a supply was found.
    pub fn has_supply(&self) -> bool {
        !self.findings.iter().any(is_about_supply)
    }
}

impl Piece {
    fn is_idle(&self, largest: [f64; 2]) -> bool {
        let mut each = self.rms.iter().zip(largest);
        each.any(|(rms, largest)| *rms < IDLE * largest)
    }

    /// Whether a finding is about more than the noise of an idle motor.
    fn means(&self, finding: &Finding, largest: [f64; 2]) -> bool {
        use Code::{ChannelMissing, Clipping, Clock, Frozen, Gap, NotLocked, ScaleUnknown, Spikes};
        let anyway = [
            ChannelMissing,
            Clipping,
            Clock,
            Frozen,
            Gap,
            NotLocked,
            ScaleUnknown,
            Spikes,
        ];
        let is_short = self.span[1] - self.span[0] < SHORTEST_S;
        let is_said = !self.is_idle(largest) || anyway.contains(&finding.code);
        is_said && !(is_short && is_about_supply(finding))
    }

    fn is_supplied(&self, largest: [f64; 2]) -> bool {
        !self.is_idle(largest) && !self.findings.iter().any(is_about_supply)
    }

    fn is_refused(&self, largest: [f64; 2]) -> bool {
        let refuses = |finding: &&Finding| finding.refuses && !is_about_supply(finding);
        let mut refusing = self.findings.iter().filter(refuses);
        refusing.any(|finding| self.means(finding, largest))
    }

    /// Adds what shows where the piece meets the one before: a gap, another clock.
    fn add_border(&mut self, before: &Piece, first_t_sample: f64) {
        let step = self.span[0] - before.span[1];
        if step >= GAP * first_t_sample {
            let between = gap::finding(&[(before.span[1], step)], first_t_sample);
            let inside = self.findings.iter_mut().find(|one| one.code == Code::Gap);
            match inside {
                Some(inside) if inside.value >= step => {}
                Some(inside) => *inside = between,
                None => self.findings.push(between),
            }
        }
        let percent = 100.0 * self.t_sample / first_t_sample;
        if (percent - 100.0).abs() > OTHER_CLOCK_PERCENT {
            self.findings
                .push(other_clock(self, first_t_sample, percent));
        }
    }
}

/// Adds the finding of piece number `k`, counted from 1, to what was found before.
fn note(all: &mut Vec<Found>, finding: &Finding, span: [f64; 2], k: u64) {
    let same = |found: &&mut Found| {
        let known = &found.largest;
        (known.code, &known.channel, &known.unit) == (finding.code, &finding.channel, &finding.unit)
    };
    let to_s = finding.to_s.unwrap_or(span[1]);
    match all.iter_mut().find(same) {
        Some(found) => {
            found.pieces += 1;
            found.latest = k;
            found.to_s = to_s;
            found.says[1] = finding.to_s.is_some();
            found.is_refusing |= finding.refuses;
            found.is_same &= found.largest.detail == finding.detail;
            if finding.value.abs() > found.largest.value.abs() {
                found.largest = finding.clone();
            }
        }
        None => all.push(Found {
            is_refusing: finding.refuses,
            is_same: true,
            pieces: 1,
            latest: k,
            from_s: finding.from_s.unwrap_or(span[0]),
            to_s,
            says: [finding.from_s.is_some(), finding.to_s.is_some()],
            largest: finding.clone(),
        }),
    }
}

/// What is known when the last piece was audited.
struct Whole {
    pieces: u64,
    is_supported: bool,
    /// Mean length of a piece, s.
    piece_s: f64,
}

impl Whole {
    fn told(&self, found: Found) -> Finding {
        let everywhere = found.pieces == self.pieces;
        let to_the_end = found.latest == self.pieces && !found.says[1];
        let from_s = (!everywhere || found.says[0]).then_some(found.from_s);
        Finding {
            detail: self.detail(&found),
            refuses: found.is_refusing && !self.is_supported,
            share: Some(found.pieces as f64 / self.pieces as f64),
            from_s,
            to_s: (!to_the_end).then_some(found.to_s),
            ..found.largest
        }
    }

    fn detail(&self, found: &Found) -> String {
        let mut detail = found.largest.detail.clone();
        if found.pieces == self.pieces && found.is_same {
            return detail;
        }
        let largest = match found.is_same {
            true => "",
            false => "; the largest is told",
        };
        detail += &format!(
            " Found in {} of {} pieces of {:.0} s, first in the one from {:.3} s on{largest}.",
            found.pieces, self.pieces, self.piece_s, found.from_s
        );
        if found.is_refusing && self.is_supported {
            detail += " They are not judged.";
        }
        detail
    }
}

fn other_clock(piece: &Piece, first_t_sample: f64, percent: f64) -> Finding {
    let (t_sample, begin_s) = (piece.t_sample, piece.span[0]);
    Finding::new(Code::Clock, "t", percent, "% of the first sampling time").detail(format!(
        "From about {begin_s:.3} s on samples are {t_sample:.3e} s apart, at the beginning {first_t_sample:.3e} s: the core takes \
         them all at the first. Judge the two parts as two recordings."
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use recording::{Channel, Metadata};

    fn piece(begin_s: f64, step_s: f64) -> Recording {
        let t = (0..100).map(|k| begin_s + step_s * f64::from(k)).collect();
        Recording::new("x", t, Metadata::default()).expect("a clock")
    }

    fn audit(findings: Vec<Finding>) -> Audit {
        Audit {
            supported: findings.iter().all(|finding| !finding.refuses),
            findings,
            assumptions: Vec::new(),
            unusable: Vec::new(),
        }
    }

    fn unbalance(percent: f64) -> Finding {
        let detail = format!("{percent} %.");
        Finding::new(Code::SupplyUnbalance, "va vb vc", percent, "%").detail(detail)
    }

    fn merged(pieces: Vec<(Recording, Vec<Finding>)>) -> Audit {
        let mut merger = Merger::default();
        for (piece, findings) in pieces {
            merger.add(&piece, &audit(findings));
        }
        merger.finish()
    }

    #[test]
    fn a_single_piece_keeps_its_audit() {
        let own = vec![unbalance(2.0)];
        assert_eq!(merged(vec![(piece(0.0, 0.01), own.clone())]), audit(own));
    }

    #[test]
    fn one_finding_of_many_pieces_is_told_once_with_its_share_and_first_place() {
        let all = merged(vec![
            (piece(0.0, 0.01), vec![]),
            (piece(1.0, 0.01), vec![unbalance(2.0)]),
            (piece(2.0, 0.01), vec![unbalance(3.0)]),
            (piece(3.0, 0.01), vec![unbalance(1.0)]),
        ]);
        let [finding] = &all.findings[..] else {
            panic!("{all:?}");
        };
        assert_eq!((finding.value, finding.share), (3.0, Some(0.75)));
        assert_eq!((finding.from_s, finding.to_s), (Some(1.0), None));
        assert!(finding.detail.contains("3 of 4 pieces"), "{finding:?}");
        assert!(all.supported);
    }

    #[test]
    fn a_motor_at_rest_refuses_nothing_and_a_faulty_recorder_what_it_spoils() {
        let off = || Finding::new(Code::NotLocked, "va", 0.0, "Hz").refusing();
        let frozen = || Finding::new(Code::Frozen, "va", 1.0, "s").refusing();
        let at = |k: usize, finding: Vec<Finding>| (piece(k as f64, 0.01), finding);
        let one_off = merged(vec![at(0, vec![]), at(1, vec![off()])]);
        assert!(one_off.supported && !one_off.findings[0].refuses);
        assert!(!merged(vec![at(0, vec![off()]), at(1, vec![off()])]).supported);
        let one_frozen = merged(vec![at(0, vec![]), at(1, vec![frozen()])]);
        assert!(one_frozen.supported && one_frozen.findings[0].detail.contains("not judged"));
        let most = merged(vec![
            at(0, vec![]),
            at(1, vec![frozen()]),
            at(2, vec![frozen()]),
        ]);
        assert!(!most.supported && most.findings[0].refuses);
    }

    /// What an idle motor's currents look like is said of noise, before it first runs and after.
    #[test]
    fn the_noise_of_an_idle_motor_refuses_nothing() {
        let of = |k: usize, amp: f64| {
            let mut piece = piece(k as f64, 0.01);
            for (phase, channel) in Channel::CURRENTS.into_iter().enumerate() {
                let wave = |t: f64| amp * (314.0 * t - 2.094 * phase as f64).cos();
                let values = piece.t().iter().map(|t| wave(*t)).collect();
                piece.set(channel, values).expect("a channel");
            }
            piece
        };
        let unit = || Finding::new(Code::Unit, "ia ib ic", 1e-3, "x").refusing();
        let mut merger = Merger::default();
        let usable: Vec<bool> = [(0.01, true), (5.0, false), (0.01, true), (0.01, true)]
            .into_iter()
            .enumerate()
            .map(|(k, (amp, is_far))| {
                let findings = is_far.then(unit).into_iter().collect();
                merger.add(&of(k, amp), &audit(findings))
            })
            .collect();
        // Before the motor ran nothing told the idle current from one in another unit.
        assert_eq!(usable, [false, true, true, true]);
        let all = merger.finish();
        assert!(all.supported && all.findings.is_empty(), "{all:?}");
        let everywhere = merged(vec![(of(0, 5.0), vec![unit()]), (of(1, 5.0), vec![unit()])]);
        assert!(!everywhere.supported && everywhere.findings[0].refuses);
    }

    #[test]
    fn a_gap_and_another_clock_between_pieces_are_found() {
        let all = merged(vec![(piece(0.0, 0.01), vec![]), (piece(5.0, 0.02), vec![])]);
        let codes: Vec<Code> = all.findings.iter().map(|finding| finding.code).collect();
        assert_eq!(codes, [Code::Gap, Code::Clock]);
        assert!((all.findings[0].value - 4.01).abs() < 1e-9);
        let none = merged(vec![(piece(0.0, 0.01), vec![]), (piece(1.0, 0.01), vec![])]);
        assert_eq!(none.findings, []);
    }
}
