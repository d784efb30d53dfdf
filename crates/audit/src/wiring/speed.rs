//! Speeds that cannot be this motor's.

use crate::context::Context;
use crate::finding::{Code, Finding, count};
use crate::levels::unit::relative_speed;
use crate::measure::blocks::Block;
use crate::measure::statistics::median;
use recording::Channel;

/// Slip of a motor that runs without the current of a blocked rotor.
const LARGEST_SLIP: f64 = 0.25;
/// Slip of a motor that its load drives.
const SMALLEST_SLIP: f64 = -0.15;
/// Slip below which a motor that takes active power cannot be: what a speed scale of 0.3 % explains.
const MOTORING_SLIP: f64 = -0.003;
/// Active over apparent power from which on a motor certainly drives its load.
const MOTORING_POWER: f64 = 0.3;
/// Share of the rated power that a motor's iron may take beside what crosses its air gap. Half of what the slip asks for
/// leaves room for a rotor that is hotter than its file says.
const IRON: f64 = 0.05;

pub(crate) fn check(context: &mut Context<'_>) -> Vec<Finding> {
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
            "It would fit a motor of {} instead of {pole_pairs}, or a speed given in electrical \
             rad/s; correct pole_pairs, or the scale with --scale speed=FACTOR (speed=unknown if it is unknown).",
            count(meant.round() as usize, "pole pair")
        )
    } else {
        "Scale and offset of the channel are wrong: correct them with --scale speed=FACTOR and --offset \
         speed=RAW_AT_REST; if they are unknown, --scale speed=unknown makes compare, explain and adopt fit them."
            .to_owned()
    };
    Some(Finding::new(Code::SpeedImplausible, Channel::SPEED, 100.0 * slip, "%").detail(format!(
        "speed is {ratio:.3} times the synchronous speed while the motor runs without overload. {hint}"
    )))
}

/// Above synchronous speed while taking active power.
fn too_fast(context: &Context<'_>) -> Option<Finding> {
    let pole_pairs = f64::from(context.expectation.pole_pairs?);
    let slip = |block: &Block| Some(1.0 - block.speed?.abs() * pole_pairs / block.omega);
    let settled = context.settled(Channel::CURRENTS);
    let steady: Vec<(&Block, f64)> = settled
        .into_iter()
        .filter(|(block, _)| block.steady)
        .filter_map(|(block, _)| Some((block, slip(block)?)))
        .collect();
    let (motors, slips) = contradictions(context, &steady);
    if 2 * slips.len() <= motors {
        return None;
    }
    let slip = median(slips)?;
    Some(Finding::new(Code::SpeedImplausible, Channel::SPEED, 100.0 * slip, "%").detail(format!(
        "speed lies {:.2} % above the synchronous speed while the motor takes active power, which a motor above it gives \
         back: the scale of the speed is too large. Correct it with --scale speed=FACTOR, at no load the slip is nearly 0; \
         or leave it open with --scale speed=unknown.",
        -100.0 * slip
    )))
}

/// How many blocks certainly drive their load, and the slips of those among them that say the contrary.
fn contradictions(context: &Context<'_>, steady: &[(&Block, f64)]) -> (usize, Vec<f64>) {
    let (mut motors, mut slips) = (0, Vec::new());
    for (block, slip) in steady {
        let too_fast = *slip < MOTORING_SLIP;
        let power = block.power().unwrap_or_default();
        let drives = power.re > MOTORING_POWER * power.norm()
            || too_fast
                && crosses_the_air_gap(context, block, power.re).is_some_and(
                    |(found, per_slip, rated)| found > 0.5 * per_slip * slip + IRON * rated,
                );
        motors += usize::from(drives);
        if drives && too_fast {
            slips.push(*slip);
        }
    }
    (motors, slips)
}

/// Power behind the stator's copper, power per slip, and rated power, W, by the motor file's circuit.
fn crosses_the_air_gap(
    context: &Context<'_>,
    block: &Block,
    power: f64,
) -> Option<(f64, f64, f64)> {
    let (expectation, circuit) = (context.expectation, context.expectation.circuit?);
    let squares: f64 = block
        .currents
        .as_ref()?
        .phasors()
        .iter()
        .map(|i| i.norm_sqr())
        .sum();
    let rated = expectation.torque_nm? * expectation.omega()? / f64::from(expectation.pole_pairs?);
    let volt = block.voltages.as_ref()?.amplitude();
    let copper = 0.5 * circuit.stator_ohm * squares;
    Some((
        power - copper,
        circuit.slip_watt_per_volt2 * volt * volt,
        rated,
    ))
}
