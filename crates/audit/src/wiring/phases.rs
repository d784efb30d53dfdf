//! Polarity, phase order, and channels of one phase taken for another.

use crate::context::Context;
use crate::finding::{Code, Finding, names};
use crate::measure::blocks::{Block, Three};
use crate::measure::sequence::Sequence;
use crate::measure::statistics::median;
use num_complex::Complex64;
use recording::Channel;
use std::ops::RangeInclusive;

/// A set is suspected when what a balanced set lacks exceeds this share of what it has...
const UNBALANCED: f64 = 0.5;
/// ...and a channel is inverted when inverting it brings the share below this.
const BALANCED: f64 = 0.25;
/// Angle of the current behind the voltage: a motor draws reactive power and, unless it is driven,
/// active power. 10 degrees each way for sensor delays.
const MOTOR_DEGREES: RangeInclusive<f64> = -10.0..=100.0;
/// A motor that is driven gives active power back and still draws reactive power.
const DRIVEN_DEGREES: RangeInclusive<f64> = -10.0..=190.0;
/// Share of the blocks whose angle must be a motor's.
const MOST: f64 = 0.5;

pub(crate) fn check(context: &mut Context<'_>) -> Vec<Finding> {
    let mut findings = Vec::new();
    for three in [Channel::VOLTAGES, Channel::CURRENTS] {
        findings.extend(inverted_channel(context, three));
    }
    if findings.is_empty() {
        findings.extend(order(context));
    }
    if findings.is_empty() {
        findings.extend(inverted_torque(context));
    }
    findings
}

/// Active over apparent power from which on a motor certainly drives its load.
const MOTORING_POWER: f64 = 0.3;

/// Share of that power which a torque must carry at the shaft to be the load's: less is the zero of a transducer, and the motor drives what
/// that does not see.
const CARRIED: f64 = 0.2;

/// A torque that would drive the shaft while the motor takes the power of a load: most steady blocks say so.
fn inverted_torque(context: &Context<'_>) -> Option<Finding> {
    let sound = [Channel::VOLTAGES, Channel::CURRENTS].map(|three| context.sound(three));
    let torque = context.recording.torque().filter(|_| sound == [true; 2])?;
    let drives = |block: &Block| {
        let power = block.power()?;
        let torque = crate::measure::blocks::mean(&torque[block.range.clone()]);
        let shaft = torque * block.speed?;
        let loaded = power.re > MOTORING_POWER * power.norm();
        (loaded && shaft.abs() > CARRIED * power.re).then_some(shaft < 0.0)
    };
    let settled = context.settled(Channel::CURRENTS);
    let votes: Vec<bool> = settled
        .iter()
        .filter_map(|(block, _)| drives(block))
        .collect();
    most(&votes).then(|| {
        Finding::new(Code::Polarity, Channel::TORQUE, 180.0, "degrees")
            .detail(
                "torque has the other sign than speed while the motor takes active power: a load's torque has the sign of the \
                 speed that it brakes. Add --scale torque=-1.",
            )
            .refusing()
    })
}

/// One of three channels inverted: inverting it back balances the set.
fn inverted_channel(context: &mut Context<'_>, three: [Channel; 3]) -> Option<Finding> {
    if !context.sound(three) {
        return None;
    }
    let derived = three
        .iter()
        .position(|channel| context.recording.is_derived(*channel));
    let alive = context.alive(three);
    let phasors: Vec<[Complex64; 3]> = alive.iter().map(|(_, three)| three.phasors()).collect();
    let imbalance = |flip: Option<usize>| {
        median(
            phasors
                .iter()
                .map(|phasors| Sequence::of(flipped(*phasors, flip, derived)).imbalance()),
        )
    };
    let as_is = imbalance(None)?;
    if as_is < UNBALANCED {
        return None;
    }
    let mut flips = (0..3).filter(|k| Some(*k) != derived);
    let k = flips.find(|k| imbalance(Some(*k)).is_some_and(|rest| rest < BALANCED))?;
    let channel = three[k];
    context.unsound.extend(three);
    let detail = format!(
        "{channel} is inverted against the other two: with its sign changed the three are balanced. Turn \
         the probe around, or add --scale {channel}=-1."
    );
    Some(
        Finding::new(Code::Polarity, channel, 180.0, "degrees")
            .detail(detail)
            .refusing(),
    )
}

fn flipped(mut x: [Complex64; 3], flip: Option<usize>, derived: Option<usize>) -> [Complex64; 3] {
    if let Some(k) = flip {
        x[k] = -x[k];
    }
    if let Some(d) = derived {
        x[d] = -(x[(d + 1) % 3] + x[(d + 2) % 3]);
    }
    x
}

fn order(context: &mut Context<'_>) -> Vec<Finding> {
    if context.sound(Channel::VOLTAGES) && context.sound(Channel::CURRENTS) {
        if opposed(context) {
            return vec![swapped(context)];
        }
        if let Some(finding) = angle(context) {
            return vec![finding];
        }
    }
    rotation(context).into_iter().collect()
}

/// Whether voltages and currents follow each other in opposite orders in most blocks.
fn opposed(context: &Context<'_>) -> bool {
    let alive = context.alive(Channel::CURRENTS);
    let differ = alive.iter().filter_map(|(block, currents)| {
        let voltages = block.voltages.as_ref()?.sequence().clear_order()?;
        Some(voltages != currents.sequence().clear_order()?)
    });
    most(&differ.collect::<Vec<bool>>())
}

fn most(votes: &[bool]) -> bool {
    2 * votes.iter().filter(|vote| **vote).count() > votes.len()
}

/// Currents exchanged against voltages: the pair follows from the angle that a motor must have.
fn swapped(context: &mut Context<'_>) -> Finding {
    let exchanges = [(0, 1), (1, 2), (0, 2)];
    let exchange = |x: [Complex64; 3], (a, b): (usize, usize)| {
        let mut y = x;
        y.swap(a, b);
        y
    };
    let fits = exchanges
        .iter()
        .filter(|pair| motor_share(context, |i| exchange(i, **pair)) > MOST);
    let pairs: Vec<[Channel; 2]> = fits
        .map(|(a, b)| [Channel::CURRENTS[*a], Channel::CURRENTS[*b]])
        .collect();
    context
        .unsound
        .extend(Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS));
    Finding::new(
        Code::SwappedPhases,
        names(&Channel::CURRENTS),
        pairs.len() as f64,
        "candidates",
    )
    .detail(format!(
        "Voltages and currents follow each other in opposite orders: exchange {} (or the voltages \
             of the same phases), for example {}.",
        either(&pairs),
        exchange_flags(&pairs)
    ))
    .refusing()
}

/// The pairs in words; without one any two may be meant.
fn either(pairs: &[[Channel; 2]]) -> String {
    let named: Vec<String> = pairs.iter().map(|[a, b]| format!("{a} and {b}")).collect();
    match named.is_empty() {
        true => "two of them".to_owned(),
        false => named.join(", or "),
    }
}

/// The flags that exchange the first of the pairs.
fn exchange_flags(pairs: &[[Channel; 2]]) -> String {
    let any = [Channel::CURRENTS[1], Channel::CURRENTS[2]];
    let [a, b] = pairs.first().unwrap_or(&any);
    format!("--column {a}={b} --column {b}={a}")
}

/// The share of settled blocks whose current, rearranged, lags the voltage like a motor's.
fn motor_share(context: &Context<'_>, arrange: impl Fn([Complex64; 3]) -> [Complex64; 3]) -> f64 {
    let settled = context.settled(Channel::CURRENTS);
    let votes = settled.iter().filter_map(|(block, three)| {
        let lag = lag(block.voltages.as_ref()?, arrange(three.phasors()))?;
        Some(if is_driven(context, block) {
            DRIVEN_DEGREES.contains(&lag) || DRIVEN_DEGREES.contains(&(lag + 360.0))
        } else {
            MOTOR_DEGREES.contains(&lag)
        })
    });
    let votes: Vec<bool> = votes.collect();
    let inside = votes.iter().filter(|inside| **inside).count();
    if votes.is_empty() {
        1.0
    } else {
        inside as f64 / votes.len() as f64
    }
}

/// Angle of the main sequence of currents behind that of the voltages, degrees, in their direction.
fn lag(voltages: &Three, currents: [Complex64; 3]) -> Option<f64> {
    let power: Complex64 = voltages
        .phasors()
        .iter()
        .zip(&currents)
        .map(|(v, i)| v * i.conj())
        .sum();
    (power.norm() > 0.0).then(|| power.arg().to_degrees())
}

/// Faster than its field: a load that drives the motor turns the angle beyond 90 degrees.
fn is_driven(context: &Context<'_>, block: &Block) -> bool {
    let pole_pairs = context.expectation.pole_pairs.map_or(1.0, f64::from);
    block
        .speed
        .is_some_and(|speed| speed.abs() * pole_pairs > block.omega)
}

/// A way in which currents may have been taken for those of other phases.
struct Mistake {
    sign: f64,
    shift: usize,
    code: Code,
    remedy: &'static str,
}

const MISTAKES: [Mistake; 3] = [
    Mistake {
        sign: -1.0,
        shift: 0,
        code: Code::Polarity,
        remedy: "all currents (or all voltages) are inverted: turn the probes around, or add \
                 --scale ia=-1 --scale ib=-1 --scale ic=-1",
    },
    Mistake {
        sign: 1.0,
        shift: 1,
        code: Code::SwappedPhases,
        remedy: "the currents belong to the next phases: --column ia=ib --column ib=ic --column ic=ia",
    },
    Mistake {
        sign: 1.0,
        shift: 2,
        code: Code::SwappedPhases,
        remedy: "the currents belong to the phases before: --column ia=ic --column ib=ia --column ic=ib",
    },
];

impl Mistake {
    fn undone(&self, i: [Complex64; 3]) -> [Complex64; 3] {
        [0, 1, 2].map(|k| self.sign * i[(k + self.shift) % 3])
    }
}

/// Same order, but an angle that no motor has: inverted, or shifted by one or two phases.
fn angle(context: &mut Context<'_>) -> Option<Finding> {
    if motor_share(context, |i| i) > MOST {
        return None;
    }
    let fits = |mistake: &&Mistake| motor_share(context, |i| mistake.undone(i)) > MOST;
    let fits: Vec<&Mistake> = MISTAKES.iter().filter(fits).collect();
    let code = fits.first()?.code;
    let remedies: Vec<&str> = fits.iter().map(|mistake| mistake.remedy).collect();
    let (lag, remedies) = (usual_lag(context), remedies.join("; or "));
    let finding = Finding::new(code, names(&Channel::CURRENTS), lag, "degrees");
    // Above synchronous speed a motor gives power back, and only a speed tells that it is there.
    if context.recording.speed().is_none() && DRIVEN_DEGREES.contains(&lag) {
        return Some(finding.detail(format!(
            "The currents lag the voltages by {lag:.0} degrees: either a load drives the motor, which a recorded speed would \
             show, or {remedies}."
        )));
    }
    context
        .unsound
        .extend(Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS));
    let detail = format!(
        "The currents lag the voltages by {lag:.0} degrees, which no motor does (0 to 90): {remedies}."
    );
    Some(finding.detail(detail).refusing())
}

fn usual_lag(context: &Context<'_>) -> f64 {
    let settled = context.settled(Channel::CURRENTS);
    let lags = settled
        .iter()
        .filter_map(|(block, three)| lag(block.voltages.as_ref()?, three.phasors()));
    median(lags).unwrap_or(0.0)
}

/// Speed over the supply's angular frequency, beyond which a shaft turns for certain.
const TURNING: f64 = 0.01;

/// The order of the phases against the sense of rotation, block by block: an inverter may reverse.
fn rotation(context: &Context<'_>) -> Option<Finding> {
    let sets = [Channel::VOLTAGES, Channel::CURRENTS];
    let three = sets.into_iter().find(|three| context.sound(*three))?;
    let settled = context.settled(three);
    let ordered: Vec<(&Block, bool)> = settled
        .iter()
        .filter_map(|(block, three)| Some((*block, three.sequence().clear_order()?)))
        .collect();
    let positive: Vec<bool> = ordered.iter().map(|(_, positive)| *positive).collect();
    let against: Vec<bool> = ordered
        .iter()
        .filter_map(|(block, positive)| Some(forward(block)? != *positive))
        .collect();
    match (against.is_empty(), most(&positive)) {
        (false, true) => most(&against).then(inverted_speed),
        (false, false) => most(&against).then(|| phase_order(context, true)),
        // Without a speed, and only if it is so throughout.
        (true, _) => {
            (!positive.is_empty() && !positive.contains(&true)).then(|| phase_order(context, false))
        }
    }
}

/// Whether the shaft turns forwards; `None` at rest.
fn forward(block: &Block) -> Option<bool> {
    let turning = block.speed? / block.omega;
    (turning.abs() > TURNING).then_some(turning > 0.0)
}

fn inverted_speed() -> Finding {
    Finding::new(Code::Polarity, Channel::SPEED, 180.0, "degrees")
        .detail(
            "speed is negative while the phases follow each other as a, b, c: exchange the encoder's \
             tracks, or add --scale speed=-1; if its scale is not known at all, --scale speed=unknown.",
        )
        .refusing()
}

fn phase_order(context: &Context<'_>, contradicts: bool) -> Finding {
    let present = [Channel::VOLTAGES, Channel::CURRENTS]
        .into_iter()
        .filter(|three| context.sound(*three));
    let channels: Vec<Channel> = present.flatten().collect();
    let finding = Finding::new(Code::PhaseOrder, names(&channels), -1.0, "sequence");
    if contradicts {
        let detail = "The phases follow each other as a, c, b, but the speed is positive: exchange columns \
                      b and c of voltages and currents, or add --scale speed=-1 if the motor runs backwards.";
        return finding.detail(detail).refusing();
    }
    finding.detail(
        "The phases follow each other as a, c, b: the motor runs backwards, or two phases are exchanged \
         in all channels. Without a speed the two look the same.",
    )
}
