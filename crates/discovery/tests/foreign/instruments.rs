//! Sensors, noise and converters: from what happens to what is recorded.

use super::course::Course;
use super::laws::Law;
use super::plant::{Instant, T_SAMPLE, phases, truth};
use super::{Hidden, Machine, OMEGA, U};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use recording::{
    Channel, LoadTorque, Metadata, Recording, Sensors, StartsFrom, Supply, VoltageKind,
};

/// Noise of every channel, share of full scale.
const NOISE: f64 = 0.002;

/// One channel's instrument: noise of 0.2 % of full scale, twelve bits.
fn instrument(x: f64, full: f64, rng: &mut Pcg64) -> f64 {
    let noise = Normal::new(0.0, NOISE * full).unwrap().sample(rng);
    let step = 2.0 * full / 4096.0;
    ((x + noise) / step).round() * step
}

/// Full scales of voltage, current, speed and torque.
fn full_scales(m: &Machine) -> [f64; 4] {
    let locked = (m.r_s + m.r_r).hypot(2.0 * OMEGA * m.l_l);
    // A start reaches twice the locked current at most.
    [600.0, 2.3 * U / locked, 1.3 * m.speed(), 2.7 * m.torque]
}

/// A recording of the machine with what is hidden in it.
pub fn record(machine: &Machine, hidden: &Hidden, course: &Course, seed: u64) -> Recording {
    let rows = truth(machine, hidden, course);
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut columns: [Vec<f64>; 8] = Default::default();
    let full = full_scales(machine);
    for k in (course.from / T_SAMPLE) as usize..rows.len() {
        let seen = sensed(machine, hidden, &rows, k);
        let scale = |c: usize| full[[0, 0, 0, 1, 1, 1, 2, 3][c]];
        for (c, x) in seen.into_iter().enumerate() {
            columns[c].push(instrument(x, scale(c), &mut rng));
        }
    }
    assemble(columns, full, course)
}

/// A quantity `delay` seconds ago, between samples on a straight line.
fn ago(rows: &[Instant], k: usize, delay: f64, of: impl Fn(&Instant) -> f64) -> f64 {
    let at = (k as f64 - delay / T_SAMPLE).max(0.0);
    let (j, share) = (at as usize, at.fract());
    of(&rows[j]) * (1.0 - share) + of(&rows[(j + 1).min(rows.len() - 1)]) * share
}

/// What the sensors make of sample `k`: three voltages, three currents, speed, torque.
fn sensed(m: &Machine, h: &Hidden, rows: &[Instant], k: usize) -> [f64; 8] {
    let [ua, ub, uc] = phases(rows[k].u);
    let law = h.law.unwrap_or(Law::Ripple);
    let i = |p: usize| {
        let i = ago(rows, k, h.delay, |r| phases(r.i)[p]);
        let law = if p == 0 { law.channel_a(m, i) } else { 1.0 };
        (1.0 + h.gain_i) * i * law
    };
    let ripple = h.speed_ripple * m.speed() * (rows[k].theta + 1.1).sin();
    let speed = ago(rows, k, h.speed_delay, |r| r.speed);
    let load = ago(rows, k, h.load_delay, |r| r.load);
    [
        ua,
        ub,
        uc * (1.0 + h.gain_vc),
        i(0) * (1.0 + h.gain_ia),
        i(1) + h.offset_ib * m.current,
        i(2),
        speed * (1.0 + h.speed_scale) * law.speed(rows[k].theta) + ripple,
        load * (1.0 + h.gain_torque),
    ]
}

fn assemble(columns: [Vec<f64>; 8], full: [f64; 4], course: &Course) -> Recording {
    let running = course.from > 0.0;
    let driven = course.ramp > 0.0;
    let metadata = Metadata {
        load_torque: LoadTorque::Measured,
        starts_from: if running {
            StartsFrom::Running
        } else {
            StartsFrom::Standstill
        },
        supply: if driven {
            Supply::Inverter
        } else {
            Supply::Grid
        },
        voltage: if driven {
            VoltageKind::Hold
        } else {
            VoltageKind::Instantaneous
        },
        sensors: Sensors {
            voltage_full_scale_volt: Some(full[0]),
            current_full_scale_amp: Some(full[1]),
            speed_full_scale_rad_s: Some(full[2]),
            torque_full_scale_nm: Some(full[3]),
            noise_sigma_fraction_of_full_scale: Some(NOISE),
            adc_bits: Some(12),
            ..Sensors::default()
        },
        ..Metadata::default()
    };
    let t = (0..columns[0].len()).map(|k| k as f64 * T_SAMPLE).collect();
    let mut recording = Recording::new("foreign", t, metadata).unwrap();
    let channels = Channel::VOLTAGES
        .into_iter()
        .chain(Channel::CURRENTS)
        .chain([Channel::SPEED, Channel::TORQUE]);
    for (channel, values) in channels.zip(columns) {
        recording = recording.with_channel(channel, values).unwrap();
    }
    recording
}
