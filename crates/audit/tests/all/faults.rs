//! Every code of the audit: one healthy recording, one thing wrong with it, exactly the finding that
//! belongs to it and no other.

use crate::synthetic::{
    Noise, SAMPLES, Signals, assert_codes, assert_one, audited, each, expectation,
};
use audit::{Code, Finding, audit};
use recording::Recording;
use std::f64::consts::TAU;

#[test]
fn a_healthy_motor_has_no_finding() {
    for seed in 0..20 {
        let audit = audit(&Signals::healthy(seed).recording(), &expectation());
        assert_codes(&audit, &[]);
        assert!(audit.supported && audit.unusable.is_empty());
    }
}

#[test]
fn without_a_nameplate_a_healthy_motor_has_no_finding_either() {
    let audit = audit(
        &Signals::healthy(1).recording(),
        &audit::Expectation::default(),
    );
    assert_codes(&audit, &[]);
}

#[test]
fn clipping_at_a_declared_full_scale() {
    let audit = audited(|s| {
        s.metadata.sensors.current_full_scale_amp = Some(6.0);
        each(&mut s.i, |x| x.clamp(-6.0, 6.0));
    });
    assert_codes(&audit, &[Code::Clipping; 3]);
    assert!(audit.supported);
    assert!(audit.findings.iter().all(|finding| finding.value == 6.0));
}

#[test]
fn clipping_below_an_unknown_full_scale() {
    let audit = audited(|s| {
        s.metadata.sensors = recording::Sensors::default();
        s.i[1].iter_mut().for_each(|x| *x = x.clamp(-5.0, 5.0));
    });
    assert_one(&audit, Code::Clipping, "ib", 5.0, 0.01, "larger range");
}

/// A sidecar from a recording of a start, beside one of a motor that runs already.
#[test]
fn a_standstill_that_the_speed_denies() {
    let declared = |s: &mut Signals| s.metadata.starts_from = recording::StartsFrom::Standstill;
    let audit = audited(declared);
    let speed = Signals::healthy(1).speed[0];
    // One sample against the mean of some: the noise is 0.2 % of full scale.
    assert_one(
        &audit,
        Code::StartsFrom,
        "speed",
        speed,
        0.02 * speed,
        "starts_from",
    );
    assert!(audit.supported);
    let stands = audited(|s| {
        declared(s);
        // The first 10 ms of a start.
        s.speed[..50].fill(0.0);
    });
    assert!(stands.findings.iter().all(|f| f.code != Code::StartsFrom));
}

/// Twelve bits over 60 A leave steps of 0.03 A on peaks of 4 A; eight bits steps of 0.5 A.
#[test]
fn coarse_steps_on_smooth_peaks_are_not_clipping() {
    for step in [0.03, 0.1, 0.5] {
        for declared in [true, false] {
            let audit = audited(|s| {
                if !declared {
                    s.metadata.sensors = recording::Sensors::default();
                }
                each(&mut s.i, |x| step * (x / step).round());
            });
            assert_codes(&audit, &[]);
        }
    }
}

#[test]
fn a_gap_in_time() {
    let audit = audited(|s| {
        s.t[5000..].iter_mut().for_each(|t| *t += 0.0123);
    });
    // The grid went on, so that the phase jumps as well: nothing else may come of it.
    assert_one(&audit, Code::Gap, "t", 0.0124, 1e-9, "lost packets");
}

/// Three rows in a hundred are missing and the times say so: nothing else is wrong.
#[test]
fn many_gaps_make_no_other_finding() {
    let mut noise = Noise::new(21);
    let keeps: Vec<bool> = (0..SAMPLES).map(|_| noise.uniform() > 0.03).collect();
    let audit = audited(|s| {
        let kept = |x: &mut Vec<f64>| {
            let mut keeps = keeps.iter();
            x.retain(|_| keeps.next().is_some_and(|kept| *kept));
        };
        s.v.iter_mut().chain(&mut s.i).for_each(kept);
        kept(&mut s.t);
        kept(&mut s.speed);
    });
    assert_codes(&audit, &[Code::Gap]);
}

#[test]
fn a_frozen_and_a_dead_channel() {
    let frozen = audited(|s| s.v[0][8000..9000].fill(100.0));
    assert_one(&frozen, Code::Stuck, "va", 0.0999, 1e-6, "froze");
    let mut noise = Noise::new(3);
    let dead = audited(|s| s.i[2].iter_mut().for_each(|x| *x = 0.12 * noise.draw()));
    assert_one(&dead, Code::Stuck, "ic", 0.0, 0.5, "dead");
    assert_eq!(dead.unusable, ["ic"]);
    assert!(frozen.unusable.is_empty());
    let dying = audited(|s| {
        s.i[0][13_000..]
            .iter_mut()
            .for_each(|x| *x = 0.12 * noise.draw())
    });
    assert_one(&dying, Code::Stuck, "ia", 0.0, 0.5, "dead");
    assert!(dying.unusable.is_empty() && (1.2..1.4).contains(&dying.findings[0].from_s.unwrap()));
    let speed = audited(|s| s.speed.fill(150.0));
    assert_one(&speed, Code::Stuck, "speed", 150.0, 0.0, "encoder");
}

#[test]
fn an_open_phase_is_told_from_a_dead_sensor() {
    let audit = audited(|s| {
        s.i[2].fill(0.0);
        s.i[1] = s.i[0].iter().map(|x| -x).collect();
    });
    assert_codes(&audit, &[Code::Stuck]);
    assert!(audit.findings[0].detail.contains("the phase is open"));
}

/// Leg b of an inverter is off: phases a and c in series between two lines, and a voltage in phase b that the rotor
/// barely induces. The negative sequence may then be the greater one by some per cent; no two phases are exchanged.
#[test]
fn an_open_phase_has_no_phase_order() {
    for counter in [0.98, 1.04] {
        let audit = audited(|s| {
            let mut noise = Noise::new(5);
            s.i[2] = s.i[0].iter().map(|x| -x).collect();
            s.i[1].iter_mut().for_each(|x| *x = 0.12 * noise.draw());
            let [a, b, c] = s.v.clone();
            // Half a positive sequence and as much of a negative one, as phase a sees it.
            let mixed = |forth: &[f64], back: &[f64]| {
                let pairs = forth.iter().zip(back);
                pairs
                    .map(|(x, y)| 0.5 * (x + counter * y))
                    .collect::<Vec<f64>>()
            };
            s.v = [mixed(&a, &a), mixed(&b, &c), mixed(&c, &b)];
        });
        assert!(audit.supported, "{:#?}", audit.findings);
        let open = |finding: &&Finding| finding.detail.contains("the phase is open");
        let named: Vec<&str> = audit
            .findings
            .iter()
            .filter(open)
            .map(|f| f.channel.as_str())
            .collect();
        assert_eq!(named, ["ib"], "{:#?}", audit.findings);
    }
}

#[test]
fn offsets() {
    let audit = audited(|s| s.i[0].iter_mut().for_each(|x| *x += 0.1));
    assert_one(&audit, Code::Offset, "ia", 0.1, 0.005, "--offset ia=0.");
    let audit = audited(|s| s.v[1].iter_mut().for_each(|x| *x -= 4.0));
    assert_one(&audit, Code::Offset, "vb", -4.0, 0.1, "--offset vb=-");
}

#[test]
fn a_current_sensor_of_wrong_gain() {
    let audit = audited(|s| s.i[2].iter_mut().for_each(|x| *x *= 1.05));
    // A third of the gain error, over a positive sequence that grew by as much.
    assert_one(
        &audit,
        Code::ZeroSequence,
        "ia ib ic",
        5.0 / 3.0 / (1.0 + 0.05 / 3.0),
        0.05,
        "in ic",
    );
}

#[test]
fn a_voltage_sensor_of_wrong_gain_is_no_unbalance() {
    let audit = audited(|s| s.v[1].iter_mut().for_each(|x| *x *= 0.97));
    assert_one(
        &audit,
        Code::ZeroSequence,
        "va vb vc",
        1.0 / 0.99,
        0.03,
        "in vb",
    );
}

/// Far from 1 a gain moves the positive sequence as well: it is told all the same.
#[test]
fn a_current_sensor_of_half_its_gain() {
    for gain in [0.5, 1.5, 2.5] {
        let audit = audited(|s| {
            s.metadata.sensors = recording::Sensors::default();
            s.i[1].iter_mut().for_each(|x| *x *= gain);
        });
        let found = audit.findings.iter().find(|f| f.code == Code::ZeroSequence);
        let found = found.expect("a zero sequence");
        assert_eq!(found.suspect.as_deref(), Some("ib"));
        let told = found.detail.split("A gain error of ").nth(1);
        let told = told.and_then(|rest| rest.split(' ').next()?.parse::<f64>().ok());
        let off = told.expect("a percentage") - 100.0 * (gain - 1.0);
        assert!(off.abs() < 0.3, "{}", found.detail);
    }
}

/// A motor that runs backwards has its phases the other way round, and its channels where they are.
#[test]
fn a_wrong_gain_is_named_backwards_as_well() {
    for (k, channel) in [(0, "va"), (1, "vb"), (2, "vc")] {
        let audit = audited(|s| {
            s.v.swap(1, 2);
            s.i.swap(1, 2);
            s.speed.iter_mut().for_each(|x| *x = -*x);
            s.v[k].iter_mut().for_each(|x| *x *= 0.97);
        });
        assert_codes(&audit, &[Code::ZeroSequence]);
        assert_eq!(audit.findings[0].suspect.as_deref(), Some(channel));
    }
}

/// The flags exchange the pair that is named, whichever it is.
#[test]
fn the_flags_exchange_the_pair_that_is_named() {
    for (a, b) in [(0, 1), (1, 2), (0, 2)] {
        let audit = audited(|s| s.i.swap(a, b));
        assert_codes(&audit, &[Code::SwappedPhases]);
        let [a, b] = [a, b].map(|k| ["ia", "ib", "ic"][k]);
        let detail = &audit.findings[0].detail;
        let words = format!("exchange {a} and {b} (or");
        let flags = format!("for example --column {a}={b} --column {b}={a}.");
        assert!(
            detail.contains(&words) && detail.contains(&flags),
            "{detail}"
        );
    }
}

#[test]
fn a_jittering_clock() {
    let mut noise = Noise::new(9);
    let audit = audited(|s| {
        s.t.iter_mut()
            .for_each(|t| *t += 5e-6 * noise.draw().clamp(-3.0, 3.0))
    });
    // The signals are at the even instants, the clock is not: sqrt(2) times 5 % of 100 us.
    assert_one(
        &audit,
        Code::Clock,
        "t",
        5.0 * 2f64.sqrt(),
        0.3,
        "--sample-rate",
    );
}

#[test]
fn a_clock_that_is_too_slow() {
    let every = |x: &Vec<f64>, n| x.iter().copied().step_by(n).collect::<Vec<f64>>();
    let thinned = |n| {
        audited(|s| {
            s.t = every(&s.t, n);
            s.v = [0, 1, 2].map(|k| every(&s.v[k], n));
            s.i = [0, 1, 2].map(|k| every(&s.i[k], n));
            s.speed = every(&s.speed, n);
        })
    };
    assert_one(
        &thinned(25),
        Code::Clock,
        "t",
        8.0,
        0.1,
        "record at least 10",
    );
    assert_codes(&thinned(10), &[]);
}

/// 10 kHz read as 8 and as 5 kHz: the clock is named, not the speed or the pole pairs.
#[test]
fn a_wrong_sampling_rate() {
    for (factor, hz) in [(1.25, 40.0), (2.0, 25.0)] {
        let audit = audited(|s| s.t.iter_mut().for_each(|t| *t *= factor));
        assert_one(
            &audit,
            Code::SupplyFrequency,
            "t",
            hz,
            0.01,
            "--sample-rate 10000 the supply has 50 Hz",
        );
        assert_eq!(audit.unusable, ["speed"]);
    }
}

/// An inverter that nobody told of: it keeps the flux, or weakens it above the rated frequency.
#[test]
fn an_inverter_is_no_wrong_sampling_rate() {
    let kept = audited(|s| {
        s.t.iter_mut().for_each(|t| *t *= 1.25);
        each(&mut s.v, |x| 0.8 * x);
        s.speed.iter_mut().for_each(|x| *x *= 0.8);
    });
    assert_codes(&kept, &[]);
    let weakened = audited(|s| {
        s.t.iter_mut().for_each(|t| *t *= 0.7);
        s.speed.iter_mut().for_each(|x| *x /= 0.7);
    });
    assert_one(
        &weakened,
        Code::SupplyFrequency,
        "va vb vc",
        50.0 / 0.7,
        0.01,
        "an inverter",
    );
}

#[test]
fn nothing_periodic() {
    let mut noise = Noise::new(11);
    let audit = audited(|s| {
        s.v.iter_mut().flatten().for_each(|x| *x = noise.draw());
        s.i.iter_mut().flatten().for_each(|x| *x = noise.draw());
    });
    assert_codes(&audit, &[Code::NotLocked]);
    assert!(!audit.supported);
}

#[test]
fn an_unbalanced_supply() {
    for percent in [0.8, 2.0, 5.0] {
        let audit = audited(|s| {
            for k in 0..3 {
                let turn = k as f64 * TAU / 3.0 + 0.5;
                let counter = |t: f64| 3.266 * percent * (TAU * 50.0 * t + turn).cos();
                s.v[k]
                    .iter_mut()
                    .zip(&s.t)
                    .for_each(|(x, t)| *x += counter(*t));
            }
        });
        assert_one(
            &audit,
            Code::SupplyUnbalance,
            "va vb vc",
            percent,
            0.02,
            "no fault of the motor",
        );
    }
}

#[test]
fn a_distorted_supply() {
    let audit = audited(|s| {
        for k in 0..3 {
            let angle = |t: f64| TAU * 50.0 * t - k as f64 * TAU / 3.0;
            let extra = |t: f64| 0.04 * 326.6 * ((5.0 * angle(t)).cos() + (7.0 * angle(t)).cos());
            s.v[k]
                .iter_mut()
                .zip(&s.t)
                .for_each(|(x, t)| *x += extra(*t));
        }
    });
    assert_one(
        &audit,
        Code::SupplyHarmonics,
        "va vb vc",
        4.0 * 2f64.sqrt(),
        0.05,
        "order",
    );
}

#[test]
fn what_is_missing_is_named_with_its_consequence() {
    let full = Signals::healthy(4).recording();
    let mut currents = Recording::new("i.csv", full.t().to_vec(), full.metadata.clone()).unwrap();
    for (channel, x) in full
        .channels()
        .filter(|(channel, _)| channel.to_string().starts_with('i'))
    {
        currents = currents.with_channel(channel, x.to_vec()).unwrap();
    }
    let audit = audit(&currents, &expectation());
    assert_codes(&audit, &[Code::ChannelMissing; 2]);
    assert_eq!(audit.findings[0].channel, "va vb vc");
    assert!(audit.findings[1].detail.contains("--column speed=NAME"));
    assert!(audit.supported);
}

/// The JSON keys and codes that others rely on.
#[test]
fn the_json_is_stable() {
    let audit = audited(|s| s.i.swap(0, 1));
    let json = serde_json::to_value(&audit).unwrap();
    assert_eq!(json["supported"], false);
    let finding = json["findings"][0].as_object().unwrap();
    assert_eq!(finding["code"], "swapped-phases");
    for key in ["code", "channel", "value", "unit", "detail"] {
        assert!(finding.contains_key(key), "{key}");
    }
    let codes = [
        (Code::Clipping, "clipping"),
        (Code::Gap, "gap"),
        (Code::Stuck, "stuck"),
        (Code::SwappedPhases, "swapped-phases"),
        (Code::PhaseOrder, "phase-order"),
        (Code::Polarity, "polarity"),
        (Code::Offset, "offset"),
        (Code::ZeroSequence, "zero-sequence"),
        (Code::LineVoltages, "line-voltages"),
        (Code::RmsValues, "rms-values"),
        (Code::Unit, "unit"),
        (Code::Clock, "clock"),
        (Code::NotLocked, "not-locked"),
        (Code::SupplyUnbalance, "supply-unbalance"),
        (Code::SupplyHarmonics, "supply-harmonics"),
        (Code::SpeedImplausible, "speed-implausible"),
        (Code::ScaleUnknown, "scale-unknown"),
        (Code::ChannelMissing, "channel-missing"),
        (Code::Spikes, "spikes"),
        (Code::Frozen, "frozen"),
        (Code::Held, "held"),
        (Code::Skew, "skew"),
        (Code::ClockDrift, "clock-drift"),
        (Code::LostSamples, "lost-samples"),
        (Code::SupplyFrequency, "supply-frequency"),
        (Code::StartsFrom, "starts-from"),
    ];
    for (code, name) in codes {
        assert_eq!(serde_json::to_value(code).unwrap(), name);
    }
}
