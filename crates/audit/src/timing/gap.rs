//! Time without samples.

use crate::context::Context;
use crate::finding::{Code, Finding, count};
use crate::timing::clock::GAP;

pub(crate) fn check(context: &Context<'_>) -> Vec<Finding> {
    let (t, usual) = (context.recording.t(), context.recording.t_sample());
    let gaps: Vec<(f64, f64)> = t
        .windows(2)
        .filter(|pair| pair[1] - pair[0] >= GAP * usual)
        .map(|pair| (pair[0], pair[1] - pair[0]))
        .collect();
    if gaps.is_empty() {
        return Vec::new();
    }
    vec![finding(&gaps, usual)]
}

/// Of gaps, each with its begin and length, s, among samples that are usually `usual` s apart.
pub(crate) fn finding(gaps: &[(f64, f64)], usual: f64) -> Finding {
    let longest = gaps.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
    let longest = longest.unwrap_or_default();
    let detail = format!(
        "{} in time; the longest, {:.6} s, begins at {:.6} s, where samples are {usual:.3e} s apart. \
         Nothing is judged across a gap; look for lost packets or a paused recorder.",
        count(gaps.len(), "gap"),
        longest.1,
        longest.0
    );
    Finding::new(Code::Gap, "t", longest.1, "s")
        .detail(detail)
        .within(longest.0, longest.0 + longest.1)
}
