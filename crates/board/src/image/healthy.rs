//! What a calibration has learnt, as words.

use monitor::{CalibratedRange, Healthy, InMotion, ROWS, Uncertainty};

use super::{Reader, Writer};

/// Words of the healthy motor's statistics.
pub(super) const HEALTHY_WORDS: usize = 10 + 2 * ROWS + 12 + RANGE_WORDS;

/// Words of where the calibration saw the motor: current, voltage over frequency, frequency, active current.
const RANGE_WORDS: usize = 6;

/// A significance is positive, so 0 stands for a motor that was not calibrated.
pub(super) fn write_healthy(w: &mut Writer, healthy: Option<&Healthy>) {
    let Some(h) = healthy else {
        w.numbers(&[0.0; HEALTHY_WORDS]);
        return;
    };
    let u = &h.uncertainty;
    w.number(h.significance);
    w.numbers(&h.mean);
    w.numbers(&h.scatter);
    w.numbers(&h.current_unbalance);
    w.numbers(&h.negative_drop);
    w.numbers(&[h.current_unbalance_scatter, h.current_unbalance_at]);
    w.numbers(&h.turns_axis);
    w.numbers(&[u.stator_resistance, u.rotor_resistance, u.heating]);
    w.numbers(&[u.magnetizing_inductance, u.leakage, u.friction]);
    w.numbers(&[u.current_gain, u.voltage_gain, u.speed]);
    w.numbers(&[u.iron_loss, u.supply_unbalance, u.negative_impedance]);
    write_range(w, h.range.as_ref());
    w.word(match h.in_motion {
        InMotion::Unseen => 0,
        InMotion::Fits => 1,
        InMotion::Differs => 2,
    });
}

pub(super) fn read_healthy(r: &mut Reader<'_>) -> Option<Healthy> {
    let significance = r.number();
    let healthy = Healthy {
        mean: r.numbers(),
        scatter: r.numbers(),
        current_unbalance: r.numbers(),
        negative_drop: r.numbers(),
        current_unbalance_scatter: r.number(),
        current_unbalance_at: r.number(),
        turns_axis: r.numbers(),
        uncertainty: Uncertainty {
            stator_resistance: r.number(),
            rotor_resistance: r.number(),
            heating: r.number(),
            magnetizing_inductance: r.number(),
            leakage: r.number(),
            friction: r.number(),
            current_gain: r.number(),
            voltage_gain: r.number(),
            speed: r.number(),
            iron_loss: r.number(),
            supply_unbalance: r.number(),
            negative_impedance: r.number(),
        },
        range: read_range(r),
        significance,
        in_motion: match r.word() {
            1 => InMotion::Fits,
            2 => InMotion::Differs,
            // A motor that was not calibrated, or was not seen in motion.
            _ => InMotion::Unseen,
        },
    };
    (significance > 0.0).then_some(healthy)
}

/// A motor runs at a frequency above 0, so 0 stands for a calibration that does not say what it saw.
fn write_range(w: &mut Writer, range: Option<&CalibratedRange>) {
    let Some(range) = range else {
        w.numbers(&[0.0; RANGE_WORDS]);
        return;
    };
    w.number(range.current);
    w.numbers(&range.volt_per_hertz);
    w.numbers(&range.frequency);
    w.number(range.active);
}

fn read_range(r: &mut Reader<'_>) -> Option<CalibratedRange> {
    let range = CalibratedRange {
        current: r.number(),
        volt_per_hertz: r.numbers(),
        frequency: r.numbers(),
        active: r.number(),
    };
    let [_, highest] = range.frequency;
    (highest > 0.0).then_some(range)
}
