//! Describes what is left: where, in which channel, with what it grows.

use crate::report::types::{DifferenceReport, Unexplained};
use estimation::data::case::Case;
use estimation::data::channels::N_CHANNELS;
use estimation::data::study::{Study, Trial};

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
    let at = worst_place(study, trial);
    let lead = best_lead.as_ref().map_or_else(String::new, |name| {
        format!(
            " The best lead, {name}, explains {:.0} % of it.",
            share.min(100.0)
        )
    });
    Unexplained {
        description: format!(
            "The worst channel is {channel} ({error:.2} of its noise), {at}.{lead}"
        ),
        correlates_with: correlated
            .iter()
            .map(|(_, name)| (*name).to_owned())
            .collect(),
        best_lead,
        best_lead_explains_percent: share,
        each_alone: None,
    }
}

/// What is said of two recordings of which each alone is explained.
pub(crate) fn apart(differences: Vec<DifferenceReport>) -> Unexplained {
    let told: Vec<String> = differences
        .iter()
        .map(|d| format!("{} {:+.1} %", d.name, d.change_percent))
        .collect();
    let told = match told.is_empty() {
        true => String::new(),
        false => format!(" ({} from the first to the second)", told.join(", ")),
    };
    Unexplained {
        description: format!(
            "The model explains each recording alone, but not both with the same parameters{told}. A motor looks so that was changed between \
             them, or what it drives."
        ),
        correlates_with: Vec::new(),
        best_lead: None,
        best_lead_explains_percent: 0.0,
        each_alone: Some(differences),
    }
}

/// Quantities with which an error may grow, one value per block.
fn drivers(study: &Study) -> Vec<(&'static str, Vec<f64>)> {
    let case = &study.fitted.case;
    let blocks = case.blocks();
    let mean = |f: &dyn Fn(usize) -> f64| -> Vec<f64> {
        let one = |r: &std::ops::Range<usize>| r.clone().map(f).sum::<f64>() / r.len() as f64;
        blocks.iter().map(one).collect()
    };
    let n_p = study.prior.plant.mechanics.n_p;
    let measured = case.measured();
    let current = ("current", mean(&|row| measured[row][0].abs()));
    let Some(waveform) = case.waveform() else {
        return vec![current];
    };
    let stride = waveform.samples_per_row();
    let (inputs, sync) = (&waveform.inputs, &waveform.timeline.omega_sync);
    let mut all = vec![("time", mean(&|row| waveform.time_of(row))), current];
    all.push(("voltage", mean(&|row| inputs.u_s[row * stride].norm())));
    all.push(("load", mean(&|row| inputs.tau_load[row * stride])));
    all.push(("frequency", mean(&|row| sync[row * stride])));
    all.push((
        "slip",
        mean(&|row| sync[row * stride] - n_p * measured[row][3]),
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
        let judged = case.weight().iter().filter(|w| w[k] > 0.0).count();
        (values.sum::<f64>() / (judged.max(1) as f64)).sqrt()
    };
    let worst = (0..N_CHANNELS).max_by(|&a, &b| error(a).total_cmp(&error(b)));
    let worst = worst.unwrap_or(0);
    (case.channels()[worst].0, error(worst))
}

/// Where the error is largest: a time of a recording, a point of a table.
fn worst_place(study: &Study, trial: &Trial) -> String {
    let case = &study.fitted.case;
    let blocks = trial.fit.blocks.iter().enumerate();
    let worst = blocks.max_by(|a, b| a.1.sse.total_cmp(&b.1.sse));
    let block = worst.map_or(0, |(k, _)| k);
    match case {
        Case::LoadTable(_) => format!("the worst point number {}", block + 1),
        Case::Waveform(one) => format!("the worst time {:.2} s", one.time_of(block * one.block)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimation::specimen;

    #[test]
    fn correlation_is_one_for_a_line_and_zero_for_what_goes_its_own_way() {
        let x = [1.0, 2.0, 3.0, 4.0];
        assert!((correlation(&x, &[10.0, 12.0, 14.0, 16.0]) - 1.0).abs() < 1e-12);
        assert!((correlation(&x, &[3.0, 2.0, 1.0, 0.0]) + 1.0).abs() < 1e-12);
        assert!(correlation(&x, &[1.0, -1.0, -1.0, 1.0]).abs() < 1e-12);
        assert_eq!(correlation(&x, &[5.0; 4]), 0.0);
        // (-1 0 1) against (-2 1 1): 3 over the root of 2 x 6.
        let got = correlation(&[0.0, 1.0, 2.0], &[0.0, 3.0, 3.0]);
        assert!((got - 3.0 / 12f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn the_worst_channel_is_the_one_with_the_largest_mean_square() {
        let rated = specimen::prior("").plant.rated;
        let case = Case::new(&specimen::recording(0.5, |_| 1.0), &rated).expect("judged");
        let mut residual = vec![0.5; case.measured().len() * N_CHANNELS];
        for row in residual.chunks_exact_mut(N_CHANNELS) {
            row[3] = 3.0;
        }
        assert_eq!(worst_channel(&case, &residual), ("speed", 3.0));
    }

    /// An error in a hundredth of the blocks is named with its time, and with the quantity that is large there.
    #[test]
    fn what_is_left_is_described_by_time_and_driver() {
        let study = specimen::study(2.0, |t| if t < 1.2 { 0.3 } else { 1.5 });
        let mut trial = specimen::trial(&study);
        let blocks = study.fitted.case.blocks();
        let t_row = study.fitted.case.waveform().expect("samples").t_row();
        for (block, rows) in trial.fit.blocks.iter_mut().zip(&blocks) {
            let t = rows.start as f64 * t_row;
            block.sse = if t > 1.6 && t < 1.645 {
                9e3
            } else if t < 1.2 {
                1.0
            } else {
                50.0
            };
        }
        let told = describe(&study, &trial, Some("windage".to_owned()), 12.4);
        assert_eq!(told.best_lead.as_deref(), Some("windage"));
        assert_eq!(told.best_lead_explains_percent, 12.4);
        let time = told
            .description
            .split("worst time ")
            .nth(1)
            .and_then(|s| s.split(' ').next());
        let time: f64 = time.and_then(|s| s.parse().ok()).expect("a time");
        assert!((1.6..1.65).contains(&time), "{}", told.description);
        assert!(
            told.description.contains("windage, explains 12 % of it"),
            "{}",
            told.description
        );
        let first: Vec<_> = told
            .correlates_with
            .iter()
            .take(3)
            .map(String::as_str)
            .collect();
        for driver in ["load", "slip"] {
            assert!(first.contains(&driver), "{:?}", told.correlates_with);
        }
        assert!(
            !told.correlates_with.iter().any(|x| x == "voltage"),
            "it is constant"
        );
    }

    /// Rows are every second sample: what counts samples from zero is twice what counts rows.
    #[test]
    fn drivers_are_taken_where_the_rows_are() {
        let mut study = specimen::study(0.5, |_| 1.0);
        let case = study.fitted.case.waveform_mut().expect("samples");
        let t_row = case.t_row();
        let count = |n: usize| (0..n).map(|k| k as f64);
        let n = case.inputs.u_s.len();
        case.inputs.u_s = count(n).map(|k| (-k).into()).collect();
        case.inputs.tau_load = count(n).collect();
        let mut timeline = (*case.timeline).clone();
        timeline.omega_sync = count(n).collect();
        case.timeline = timeline.into();
        case.measured.iter_mut().for_each(|row| row[3] = 7.0);
        let all = drivers(&study);
        let of = |name: &str| &all.iter().find(|(n, _)| *n == name).expect("listed").1;
        let close = |name: &str, block: usize, expected: f64| {
            let got = of(name)[block];
            assert!((got - expected).abs() < 1e-9, "{name} {block}: {got}");
        };
        for block in [0, 5, 11] {
            let rows = study.fitted.case.blocks()[block].clone();
            let middle = 0.5 * (rows.start + rows.end - 1) as f64;
            close("time", block, middle * t_row);
            for name in ["voltage", "load", "frequency"] {
                close(name, block, 2.0 * middle);
            }
            // Two pole pairs.
            close("slip", block, 2.0 * middle - 14.0);
        }
        let table = drivers(&specimen::table_study(|_| ()));
        let names: Vec<&str> = table.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["current"]);
    }

    /// One number per block for each quantity, in its unit.
    #[test]
    fn drivers_are_means_over_blocks() {
        let study = specimen::study(1.0, |_| 1.0);
        let point = specimen::point(1.0);
        let all = drivers(&study);
        let of = |name: &str| {
            let found = all.iter().find(|(n, _)| *n == name).expect("listed");
            assert_eq!(found.1.len(), study.fitted.case.blocks().len());
            found.1[10]
        };
        assert!((of("voltage") / point.u_s.norm() - 1.0).abs() < 1e-3);
        assert!((of("load") - 1.0).abs() < 1e-9);
        assert!((of("frequency") / point.omega_sync - 1.0).abs() < 1e-4);
        assert!((of("slip") / point.omega_slip - 1.0).abs() < 2e-2);
        // The mean of a rectified sine is 2/pi of its amplitude; 40 ms are 2.4 periods.
        let expected = point.i_s.norm() * 2.0 / std::f64::consts::PI;
        assert!((of("current") / expected - 1.0).abs() < 0.1);
        // Rows 1000 to 1099 or so, every 0.4 ms.
        assert!((of("time") - 0.42).abs() < 0.005, "{}", of("time"));
    }
}
