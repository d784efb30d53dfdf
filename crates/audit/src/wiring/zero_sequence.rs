//! Three channels that do not add up to zero, and the one channel whose gain would explain it.

use crate::context::Context;
use crate::finding::{Code, Finding, names};
use crate::measure::sequence::a;
use crate::measure::statistics::median_phasor;
use num_complex::Complex64;
use recording::{Channel, Quantity};

/// Smallest zero sequence worth a word, percent of the positive one: a gain error of 1.5 % in one
/// channel.
const NOTABLE_PERCENT: f64 = 0.5;
/// A single channel is named when the angle agrees within this.
const SAME_DEGREES: f64 = 20.0;

pub(crate) fn check(context: &Context<'_>) -> Vec<Finding> {
    [Channel::VOLTAGES, Channel::CURRENTS]
        .into_iter()
        .filter_map(|three| zero(context, three))
        .collect()
}

fn zero(context: &Context<'_>, three: [Channel; 3]) -> Option<Finding> {
    let derived = three
        .iter()
        .any(|channel| context.recording.is_derived(*channel));
    if derived || !context.sound(three) {
        return None;
    }
    let ratios: Vec<Complex64> = context
        .ratios(three)
        .into_iter()
        .map(|(zero, _)| zero)
        .collect();
    let ratio = median_phasor(&ratios)?;
    let percent = 100.0 * ratio.norm();
    (percent > NOTABLE_PERCENT).then(|| {
        let impossible = match three[0].quantity() {
            Quantity::Current => {
                "Three wires cannot carry it: a sensor's gain is wrong, or a neutral is connected."
            }
            _ => "The supply's neutral is displaced, or a sensor's gain is wrong.",
        };
        let suspect = gain_error(ratio).map(|(k, along)| (three[k], gain_percent(along)));
        Finding::new(Code::ZeroSequence, names(&three), percent, "%")
            .suspecting(suspect.map(|(channel, _)| channel))
            .detail(format!(
                "{} do not add up to zero: {percent:.2} % of the positive sequence. {impossible}{}",
                names(&three),
                in_words(suspect)
            ))
    })
}

fn in_words(suspect: Option<(Channel, f64)>) -> String {
    match suspect {
        Some((channel, percent)) => format!(
            " A gain error of {percent:+.1} % in {channel} would show this angle; compare the sensors on one wire.",
        ),
        None => " The angle names no single channel; compare the sensors on one wire.".to_owned(),
    }
}

/// The channel whose gain alone explains a zero sequence over positive sequence, and that ratio along the channel's direction.
///
/// With a gain `1 + g` in phase a the zero sequence is `g/3` and the positive one `1 + g/3`, so that the ratio is
/// `r = g/(3 + g)`; in phase b it is turned by `a^2`, in phase c by `a`. A dead channel shows -1/2, no gain reaches 1.
pub(crate) fn gain_error(ratio: Complex64) -> Option<(usize, f64)> {
    let directions = [Complex64::new(1.0, 0.0), a().conj(), a()];
    directions.iter().enumerate().find_map(|(k, direction)| {
        let turned = ratio * direction.conj();
        let off = turned.im.abs().atan2(turned.re.abs()).to_degrees();
        (off < SAME_DEGREES && turned.re < 1.0).then_some((k, turned.re))
    })
}

/// The gain error, percent, that a ratio below 1 along a channel's direction stands for.
fn gain_percent(ratio: f64) -> f64 {
    300.0 * ratio / (1.0 - ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::sequence::Sequence;

    #[test]
    fn a_gain_error_is_traced_to_its_channel() {
        let small = [(0, 0.02), (1, -0.03), (2, 0.05)];
        for (k, gain) in small.into_iter().chain([(0, -0.9), (1, -0.5), (2, 2.0)]) {
            let mut x = [Complex64::new(1.0, 0.0), a().conj(), a()];
            x[k] *= 1.0 + gain;
            let sequence = Sequence::of(x);
            let (channel, along) = gain_error(sequence.zero / sequence.positive).unwrap();
            let percent = gain_percent(along);
            assert_eq!(channel, k);
            assert!((percent - 100.0 * gain).abs() < 1e-9, "{percent}");
        }
        assert_eq!(gain_error(Complex64::from_polar(0.01, 0.5)), None);
    }
}
