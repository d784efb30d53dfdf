//! Channels that were sampled one after the other, though they stand in one row.
//!
//! A channel `k` that is sampled `d_k` late leads by `w d_k`. Three of a balanced set, one step after the other, then do not
//! add up to zero: `X0/X1 = j/3 (a^2 + 2 a) w d`, a direction that belongs to no single gain. Voltages and currents show the
//! same ratio, which gains do not. What voltages and currents have against each other stays open: there a motor's own power
//! factor looks the same.
//!
//! Late sampling turns the zero sequence into a negative one of opposite sign, `X2 = -conj(X0)`, gains into one of the same:
//! so that gains alone, whatever they are, never pass for delays.

use crate::context::Context;
use crate::finding::{Code, Finding};
use crate::measure::sequence::{Sequence, a};
use crate::measure::statistics::{median, median_with_error};
use num_complex::Complex64;
use recording::Channel;

/// Standard errors beyond which a step is one.
const SIGNIFICANT: f64 = 6.0;
/// Share of the ratio that may point elsewhere, and by which both kinds may differ.
const AGREES: f64 = 0.2;
/// `X2 X0/|X0|^2`: -1 of delays, 1 of gains; a supply's own unbalance adds to both.
const LATE: f64 = -0.25;
/// Shortest step that is proposed, s.
const SHORTEST_S: f64 = 1e-6;

pub(crate) fn check(context: &Context<'_>) -> Option<Finding> {
    let omega = context.omega()?;
    let volt = step(context, Channel::VOLTAGES)?;
    let amp = step(context, Channel::CURRENTS)?;
    let step = 0.5 * (volt + amp) / omega;
    let agree = (volt - amp).abs() < AGREES * (omega * step).abs();
    let inside = step.abs() > SHORTEST_S && 2.0 * step.abs() < context.recording.t_sample();
    (agree && inside).then(|| {
        Finding::new(Code::Skew, "va vb vc ia ib ic", 1e6 * step, "us").detail(detail(1e6 * step))
    })
}

fn detail(step_us: f64) -> String {
    format!(
        "Voltages and currents miss a sum of zero in the way of channels that are sampled one after the other, {step_us:.2} us \
         from b to c as from a to b. Add --delay vb={step_us:.2}us --delay vc={twice:.2}us --delay ib={step_us:.2}us --delay \
         ic={twice:.2}us, and to ia ib ic what passes between va and ia, which no recording shows: the recorder's manual says \
         in which order it samples (va vb vc ia ib ic would be {three:.2} us, va ia vb ib vc ic {half:.2} us).",
        twice = 2.0 * step_us,
        three = 3.0 * step_us,
        half = 0.5 * step_us
    )
}

/// Angle from one channel to the next, rad, where a step explains the zero sequence and nothing else does.
fn step(context: &Context<'_>, three: [Channel; 3]) -> Option<f64> {
    let derived = three
        .iter()
        .any(|channel| context.recording.is_derived(*channel));
    if derived || !context.sound(three) {
        return None;
    }
    let direction = Complex64::i() / 3.0 * (a() * a() + 2.0 * a());
    let settled = context.settled(three);
    let sequences: Vec<Sequence> = settled
        .iter()
        .map(|(_, three)| three.sequence())
        .filter(Sequence::is_positive)
        .collect();
    let zero = |x: &Sequence| x.zero / x.positive;
    let sign = |x: &Sequence| (zero(x) * x.negative / x.positive).re / zero(x).norm_sqr();
    let steps: Vec<Complex64> = sequences.iter().map(|x| zero(x) / direction).collect();
    let late = median(sequences.iter().map(sign))? < LATE;
    let re: Vec<f64> = steps.iter().map(|z| z.re).collect();
    let im: Vec<f64> = steps.iter().map(|z| z.im).collect();
    let (along, error) = median_with_error(&re)?;
    let (across, _) = median_with_error(&im)?;
    let sure = along.abs() > SIGNIFICANT * error && across.abs() < AGREES * along.abs();
    (sure && late).then_some(along)
}
