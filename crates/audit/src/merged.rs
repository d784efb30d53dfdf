//! One audit of a recording that was audited piece by piece.
//!
//! A finding that several pieces share is told once: as it is in the piece where it is largest, with the share of the pieces
//! that have it and its first place. A piece that the audit refuses is not judged; the recording is refused as a whole where
//! most of it is.

use crate::finding::{Audit, Code, Finding};
use crate::timing::clock::GAP;
use crate::timing::gap;
use recording::Recording;

/// Sampling times of pieces that differ by more are two clocks, percent.
const OTHER_CLOCK_PERCENT: f64 = 1.0;

/// The audits of the pieces so far, in the order of time.
#[derive(Clone, Debug, Default)]
pub struct Merger {
    found: Vec<Found>,
    pieces: u64,
    /// Pieces with a supply, and those of them that were refused.
    supplied: u64,
    refused: u64,
    first: Option<Audit>,
    latest: Option<Audit>,
    clock: Option<Clock>,
}

/// The clock of the pieces so far.
#[derive(Clone, Copy, Debug)]
struct Clock {
    begin_s: f64,
    end_s: f64,
    /// Sampling time of the first piece, s.
    t_sample: f64,
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
    /// Whether a piece says itself where it begins, and the latest where it ends.
    says: [bool; 2],
}

impl Audit {
    /// Whether a piece with this audit may be judged with the others: a motor that is switched off for a while is no fault of the
    /// recording.
    pub fn is_usable_piece(&self) -> bool {
        let refused = |finding: &Finding| finding.refuses && !is_about_supply(finding);
        !self.findings.iter().any(refused)
    }

    /// Whether a supply was found.
    pub fn has_supply(&self) -> bool {
        !self.findings.iter().any(is_about_supply)
    }
}

/// Whether a finding says that there is no supply, or none at the clock as it was read.
fn is_about_supply(finding: &Finding) -> bool {
    let by_clock = finding.code == Code::Unit && finding.channel == "t";
    finding.refuses && (finding.code == Code::NotLocked || by_clock)
}

impl Merger {
    /// Takes the next piece with its audit.
    pub fn add(&mut self, piece: &Recording, audit: &Audit) {
        self.pieces += 1;
        if audit.has_supply() {
            self.supplied += 1;
            self.refused += u64::from(!audit.is_usable_piece());
        }
        let span = [piece.t()[0], piece.t()[piece.len() - 1]];
        for finding in self.at_the_border(piece, &audit.findings) {
            self.note(finding, span);
        }
        let clock = self.clock.get_or_insert(Clock {
            begin_s: span[0],
            end_s: span[1],
            t_sample: piece.t_sample(),
        });
        clock.end_s = span[1];
        self.first.get_or_insert_with(|| audit.clone());
        self.latest = Some(audit.clone());
    }

    /// The findings of a piece with what shows where it meets the one before: a gap, another clock.
    fn at_the_border(&self, piece: &Recording, findings: &[Finding]) -> Vec<Finding> {
        let mut all = findings.to_vec();
        let Some(clock) = self.clock else {
            return all;
        };
        let step = piece.t()[0] - clock.end_s;
        if step >= GAP * clock.t_sample {
            let between = gap::finding(&[(clock.end_s, step)], clock.t_sample);
            match all.iter_mut().find(|finding| finding.code == Code::Gap) {
                Some(inside) if inside.value >= step => {}
                Some(inside) => *inside = between,
                None => all.push(between),
            }
        }
        let percent = 100.0 * piece.t_sample() / clock.t_sample;
        if (percent - 100.0).abs() > OTHER_CLOCK_PERCENT {
            all.push(other_clock(piece, clock, percent));
        }
        all
    }

    fn note(&mut self, finding: Finding, span: [f64; 2]) {
        let same = |found: &&mut Found| {
            let known = &found.largest;
            (known.code, &known.channel, &known.unit)
                == (finding.code, &finding.channel, &finding.unit)
        };
        let to_s = finding.to_s.unwrap_or(span[1]);
        match self.found.iter_mut().find(same) {
            Some(found) => {
                found.pieces += 1;
                found.latest = self.pieces;
                found.to_s = to_s;
                found.says[1] = finding.to_s.is_some();
                found.is_refusing |= finding.refuses;
                found.is_same &= found.largest.detail == finding.detail;
                if finding.value.abs() > found.largest.value.abs() {
                    found.largest = finding;
                }
            }
            None => self.found.push(Found {
                is_refusing: finding.refuses,
                is_same: true,
                pieces: 1,
                latest: self.pieces,
                from_s: finding.from_s.unwrap_or(span[0]),
                to_s,
                says: [finding.from_s.is_some(), finding.to_s.is_some()],
                largest: finding,
            }),
        }
    }

    /// What the pieces come to; of a single one its own audit.
    pub fn finish(self) -> Audit {
        let whole = Whole {
            pieces: self.pieces,
            is_supported: self.supplied > 0 && 2 * self.refused <= self.supplied,
            piece_s: self.clock.map_or(0.0, |clock| {
                (clock.end_s - clock.begin_s) / self.pieces.max(1) as f64
            }),
        };
        let Some(first) = self.first.filter(|_| self.pieces > 1) else {
            return self.latest.unwrap_or(Audit {
                supported: false,
                findings: Vec::new(),
                assumptions: Vec::new(),
                unusable: Vec::new(),
            });
        };
        let latest = self.latest.unwrap_or_else(|| first.clone());
        let in_both = |channel: &String| latest.unusable.contains(channel);
        Audit {
            supported: whole.is_supported,
            findings: self.found.into_iter().map(|one| whole.told(one)).collect(),
            // How a file was read is known when it was read to its end.
            assumptions: latest.assumptions.clone(),
            unusable: first.unusable.into_iter().filter(in_both).collect(),
        }
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

fn other_clock(piece: &Recording, clock: Clock, percent: f64) -> Finding {
    let (t_sample, begin_s) = (piece.t_sample(), piece.t()[0]);
    Finding::new(Code::Clock, "t", percent, "% of the first sampling time").detail(format!(
        "From about {begin_s:.3} s on samples are {t_sample:.3e} s apart, at the beginning {:.3e} s: the core takes them all at \
         the first. Judge the two parts as two recordings.",
        clock.t_sample
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use recording::Metadata;

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
