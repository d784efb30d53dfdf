//! Speeds that cannot be this motor's.

use super::context::Context;
use super::finding::{Code, Finding};
use super::statistics::median;
use super::unit::relative_speed;
use crate::channel::Channel;

/// Slip of a motor that runs without the current of a blocked rotor.
const LARGEST_SLIP: f64 = 0.25;
/// Slip of a motor that its load drives.
const SMALLEST_SLIP: f64 = -0.15;
/// Slip below which a motor that takes active power cannot be: what a speed scale of 0.3 % explains.
const MOTORING_SLIP: f64 = -0.003;
/// Active over apparent power from which on a motor certainly drives its load.
const MOTORING_POWER: f64 = 0.3;

pub(super) fn check(context: &mut Context<'_>) -> Vec<Finding> {
    if context.unsound.contains(&Channel::SPEED) {
        return Vec::new();
    }
    let gross = gross(context);
    if gross.is_some() {
        context.unsound.insert(Channel::SPEED);
    }
    gross.or_else(|| too_fast(context)).into_iter().collect()
}

fn gross(context: &Context<'_>) -> Option<Finding> {
    let ratio = relative_speed(context)?;
    let slip = 1.0 - ratio;
    if (SMALLEST_SLIP..LARGEST_SLIP).contains(&slip) {
        return None;
    }
    let pole_pairs = context.expectation.pole_pairs?;
    let meant = f64::from(pole_pairs) / ratio;
    let hint = if (meant - meant.round()).abs() < 0.06 * meant
        && (1.0..=12.0).contains(&meant.round())
    {
        format!(
            "It would fit a motor of {:.0} pole pairs instead of {pole_pairs}, or a speed given in electrical \
             rad/s; correct pole_pairs, or the scale with --scale speed=FACTOR (speed=unknown if nobody knows it).",
            meant.round()
        )
    } else {
        "Scale and offset of the channel are wrong: correct them with --scale speed=FACTOR and --offset \
         speed=RAW_AT_REST; if nobody knows them, --scale speed=unknown makes compare, explain and adopt fit them."
            .to_owned()
    };
    Some(Finding::new(Code::SpeedImplausible, Channel::SPEED, 100.0 * slip, "%").detail(format!(
        "speed is {ratio:.3} times the synchronous speed while the motor runs without overload. {hint}"
    )))
}

/// Above synchronous speed while taking active power.
fn too_fast(context: &Context<'_>) -> Option<Finding> {
    let pole_pairs = f64::from(context.expectation.pole_pairs?);
    let motoring = context
        .settled(Channel::CURRENTS)
        .into_iter()
        .filter(|(block, _)| {
            block.steady
                && block
                    .power()
                    .is_some_and(|power| power.re > MOTORING_POWER * power.norm())
        });
    let slips =
        motoring.filter_map(|(block, _)| Some(1.0 - block.speed?.abs() * pole_pairs / block.omega));
    let slip = median(slips)?;
    (slip < MOTORING_SLIP).then(|| {
        Finding::new(Code::SpeedImplausible, Channel::SPEED, 100.0 * slip, "%").detail(format!(
            "speed lies {:.2} % above the synchronous speed while the motor takes active power: its scale is \
             too large. Correct it with --scale speed=FACTOR, at no load the slip is nearly 0; or leave it open \
             with --scale speed=unknown.",
            -100.0 * slip
        ))
    })
}
