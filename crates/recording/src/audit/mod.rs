//! The audit: what is wrong with a recording, before anything is concluded from it.
//!
//! Every check is a file. A check that finds channels whose phasors mean nothing says so in the
//! [`Context`], and later checks leave them alone: one mistake gives one finding.

mod blocks;
mod clipping;
mod clock;
mod context;
mod dead;
mod expectation;
mod finding;
mod fit;
mod gap;
mod missing;
mod not_locked;
mod offset;
mod probes;
mod rms_values;
mod scale;
mod sequence;
mod speed;
mod statistics;
mod stuck;
mod supply;
mod track;
mod unit;
mod wiring;
mod zero_sequence;

pub use expectation::Expectation;
pub use finding::{Audit, Code, Finding};
pub use probes::with_sound_probes;

use crate::recording::Recording;
use context::Context;

/// Audits a recording against what the nameplate lets one expect.
///
/// Start-ups, load steps, supply steps and frequency ramps are not findings: what is compared with a
/// limit is taken from steady blocks of three periods.
pub fn audit(recording: &Recording, expectation: &Expectation) -> Audit {
    let mut context = Context::new(recording, expectation);
    let mut findings = clock::check(&context);
    findings.extend(gap::check(&context));
    findings.extend(clipping::check(&context));
    findings.extend(rms_values::check(&mut context));
    if findings
        .iter()
        .all(|finding| finding.code != Code::RmsValues)
    {
        findings.extend(not_locked::check(&context));
    }
    findings.extend(stuck::check(&mut context));
    findings.extend(scale::check(&mut context));
    findings.extend(wiring::check(&mut context));
    findings.extend(unit::check(&mut context));
    findings.extend(offset::check(&context));
    findings.extend(zero_sequence::check(&context));
    findings.extend(supply::check(&context));
    if findings.iter().all(|finding| finding.code != Code::Unit) {
        findings.extend(speed::check(&mut context));
    }
    findings.extend(missing::check(&context));
    Audit {
        supported: findings.iter().all(|finding| !finding.refuses),
        findings,
        unusable: context.unsound.iter().map(ToString::to_string).collect(),
    }
}
