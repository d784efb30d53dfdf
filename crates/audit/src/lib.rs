//! The audit: what is wrong with a recording, before anything is concluded from it.
//!
//! Every check is a file. A check that finds channels whose phasors mean nothing says so in the
//! `Context`, and later checks leave them alone: one mistake gives one finding.

mod context;
mod expectation;
mod finding;
mod levels;
mod measure;
mod merged;
mod silent;
mod timing;
mod wiring;

pub use expectation::{Circuit, Expectation};
pub use finding::{Audit, Code, Finding, digits};
pub use measure::refresh::refreshed_at;
pub use merged::Merger;
pub use wiring::probes::with_sound_probes;
pub use wiring::start::turns_from_the_start;

use context::Context;
use levels::{clipping, offset, rms_values, scale, sensor, spikes, unit};
use recording::Recording;
use silent::{frozen, held, missing, stuck};
use timing::{clock, drift, gap, lost, not_locked, skew};
use wiring::{frequency, phases, speed, start, supply, zero_sequence};

/// Audits a recording against what the nameplate lets one expect.
///
/// Start-ups, load steps, supply steps and frequency ramps are not findings: what is compared with a
/// limit is taken from steady blocks of three periods.
pub fn audit(recording: &Recording, expectation: &Expectation) -> Audit {
    let mut context = Context::new(recording, expectation);
    let mut findings = of_samples(&mut context);
    // What is said of phases, sums and speed would follow from the missing samples.
    if !findings
        .iter()
        .any(|f| f.code == Code::LostSamples && f.refuses)
    {
        of_wiring(&mut context, &mut findings);
    }
    findings.extend(missing::check(&context));
    Audit {
        supported: findings.iter().all(|finding| !finding.refuses),
        findings,
        assumptions: recording.assumptions.clone(),
        unusable: context.unsound.iter().map(ToString::to_string).collect(),
    }
}

/// What is wrong with times and samples.
fn of_samples(context: &mut Context<'_>) -> Vec<Finding> {
    let mut findings = clock::check(context);
    findings.extend(gap::check(context));
    findings.extend(spikes::check(context));
    findings.extend(clipping::check(context));
    let effective = rms_values::check(context);
    if effective.is_empty() {
        findings.extend(not_locked::check(context));
        findings.extend(standing_still(context));
    }
    findings.extend(effective);
    if !findings.iter().any(repeats) {
        findings.extend(lost::check(context));
    }
    findings
}

/// Whether samples are repeated, or are none: what turns then jumps all the time.
fn repeats(finding: &Finding) -> bool {
    matches!(finding.code, Code::RmsValues | Code::Held | Code::Frozen)
        && finding.channel != "speed"
}

/// What is wrong with scales, phases, sums, supply and speed.
fn of_wiring(context: &mut Context<'_>, findings: &mut Vec<Finding>) {
    findings.extend(scale::check(context));
    findings.extend(frequency::check(context));
    let drift = drift::check(context);
    if drift.is_none() {
        findings.extend(phases::check(context));
    }
    findings.extend(drift);
    findings.extend(unit::check(context));
    propose_sensors(findings, sensor::check(context));
    findings.extend(offset::check(context));
    let skew = skew::check(context);
    if skew.is_none() {
        findings.extend(zero_sequence::check(context));
    }
    findings.extend(skew);
    findings.extend(supply::check(context));
    if findings.iter().all(|finding| finding.code != Code::Unit) {
        findings.extend(speed::check(context));
        findings.extend(start::check(context));
    }
}

/// Proposals of sensors: beside the other findings, or within that of a unit of the same channels, the likelier load first.
fn propose_sensors(findings: &mut Vec<Finding>, proposals: Vec<Finding>) {
    for proposal in proposals {
        let same = |finding: &&mut Finding| {
            finding.code == Code::Unit && finding.channel == proposal.channel
        };
        match findings.iter_mut().find(same) {
            Some(unit) => {
                let by_unit = sensor::is_usual(&unit.channel, unit::in_its_unit(unit.value));
                let [first, second] = match by_unit {
                    true => [&unit.detail, &proposal.detail],
                    false => [&proposal.detail, &unit.detail],
                };
                unit.detail = format!("{first} Or: {second}");
            }
            None => findings.push(proposal),
        }
    }
}

/// Recorders, displays and channels that keep their values: the widest cause speaks for what follows from it.
fn standing_still(context: &mut Context<'_>) -> Vec<Finding> {
    let held = held::check(context);
    if held.iter().any(|finding| finding.refuses) {
        return held;
    }
    let mut findings: Vec<Finding> = frozen::check(context).into_iter().collect();
    findings.extend(held);
    findings.extend(stuck::check(context));
    findings
}
