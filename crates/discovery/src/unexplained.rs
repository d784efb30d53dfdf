//! Describes what is left: where, in which channel, with what it grows.

use crate::case::{CHANNELS, Case, N_CHANNELS};
use crate::report::Unexplained;
use crate::study::{Study, Trial};

/// Correlation below which nothing is said.
const WORTH_SAYING: f64 = 0.3;

/// A colleague's description of the residual of a trial.
pub(crate) fn describe(
    study: &Study,
    trial: &Trial,
    best_lead: Option<String>,
    share: f64,
) -> Unexplained {
    let case = &study.fitted.case;
    let blocks: Vec<f64> = trial.fit.blocks.iter().map(|b| b.sse.ln_1p()).collect();
    let mut correlated: Vec<(f64, &str)> = drivers(study)
        .into_iter()
        .map(|(name, x)| (correlation(&blocks, &x), name))
        .filter(|(c, _)| c.abs() > WORTH_SAYING)
        .collect();
    correlated.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let (channel, error) = worst_channel(case, &trial.fit.residual);
    let at = worst_time(study, trial);
    let lead = best_lead.as_ref().map_or_else(String::new, |name| {
        format!(" The best lead, {name}, explains {share:.0} % of it.")
    });
    Unexplained {
        description: format!(
            "The worst channel is {channel} ({error:.2} of its noise), the worst time {at:.2} s.{lead}"
        ),
        correlates_with: correlated
            .iter()
            .map(|(_, name)| (*name).to_owned())
            .collect(),
        best_lead,
        best_lead_explains_percent: share,
    }
}

/// Quantities with which an error may grow, one value per block.
fn drivers(study: &Study) -> Vec<(&'static str, Vec<f64>)> {
    let case = &study.fitted.case;
    let blocks = case.blocks();
    let stride = case.between.stride() * case.decimation;
    let mean = |f: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let one = |r: &std::ops::Range<usize>| r.clone().map(f).sum::<f64>() / r.len() as f64;
        blocks.iter().map(one).collect()
    };
    let n_p = study.belief.plant.mechanics.n_p;
    let inputs = &case.inputs;
    let mut all = vec![("time", mean(&|row| row as f64))];
    all.push(("current", mean(&|row| case.measured[row][0].abs())));
    if inputs.u_s.is_empty() {
        return all;
    }
    let sync = &case.timeline.omega_sync;
    all.push(("voltage", mean(&|row| inputs.u_s[row * stride].norm())));
    all.push(("load", mean(&|row| inputs.tau_load[row * stride])));
    all.push(("frequency", mean(&|row| sync[row * stride])));
    all.push((
        "slip",
        mean(&|row| sync[row * stride] - n_p * case.measured[row][3]),
    ));
    all
}

fn correlation(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (a, b) in x.iter().zip(y) {
        xy += (a - mx) * (b - my);
        xx += (a - mx) * (a - mx);
        yy += (b - my) * (b - my);
    }
    xy / (xx * yy).sqrt().max(f64::MIN_POSITIVE)
}

fn worst_channel(case: &Case, residual: &[f64]) -> (&'static str, f64) {
    let error = |k: usize| {
        let values = residual.chunks_exact(N_CHANNELS).map(|row| row[k] * row[k]);
        let judged = case.weight.iter().filter(|w| w[k] > 0.0).count();
        (values.sum::<f64>() / (judged.max(1) as f64)).sqrt()
    };
    let worst = (0..N_CHANNELS).max_by(|&a, &b| error(a).total_cmp(&error(b)));
    let worst = worst.unwrap_or(0);
    (CHANNELS[worst], error(worst))
}

fn worst_time(study: &Study, trial: &Trial) -> f64 {
    let blocks = trial.fit.blocks.iter().enumerate();
    let worst = blocks.max_by(|a, b| a.1.sse.total_cmp(&b.1.sse));
    let start = worst.map_or(0, |(k, _)| k * study.fitted.case.block);
    start as f64 * study.fitted.case.t_row()
}
