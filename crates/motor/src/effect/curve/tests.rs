//! Curves whose answer is known: those that are an effect of the library or another parameter, written as a curve.

use super::{Action, Coordinate, Place, SteadyCurve, curve, from_entry, to_entry};
use crate::effect::{
    Between, EffectConfig, Inputs, Outputs, Plant, Rated, Run, SpeedSource, SteadyPoint, Timeline,
    simulate,
};
use crate::effects::find;
use crate::motor_file::MotorFile;
use crate::{Mechanics, TParams};
use num_complex::{Complex, Complex64};
use std::sync::Arc;

const MOTOR: TParams<f64> = TParams {
    r_s: 3.7,
    r_r: 2.3,
    l_ls: 0.0107,
    l_lr: 0.0107,
    l_m: 0.234,
};
const RATED: Rated<f64> = Rated {
    voltage: 326.6,
    current: 7.07,
    omega_sync: 314.159,
    n_p: 2.0,
    torque: 14.6,
};

fn plant(effects: Vec<EffectConfig>) -> Plant {
    Plant {
        motor: MOTOR,
        mechanics: Mechanics {
            n_p: 2.0,
            inertia: 0.016,
            friction: 0.002,
            load_friction: 0.0,
        },
        rated: RATED,
        effects,
    }
}

/// A start and a load, 0.5 s.
fn run(plant: &Plant) -> Outputs {
    let n = 5000;
    let t = |k: usize| k as f64 * 1e-4;
    let inputs = Inputs {
        t_sample: 1e-4,
        u_s: (0..n)
            .map(|k| Complex64::from_polar(RATED.voltage, RATED.omega_sync * t(k)))
            .collect(),
        tau_load: (0..n)
            .map(|k| if t(k) > 0.3 { 12.0 } else { 0.0 })
            .collect(),
    };
    simulate(
        plant,
        &Run {
            inputs: &inputs,
            between: Between::Held,
            speed: SpeedSource::Free,
            timeline: &Arc::new(Timeline::constant(RATED.omega_sync)),
            running_at: None,
            running_at_cuts: &[],
            offsets: &[],
            open: &[],
        },
    )
}

fn law(
    place: Place,
    coordinate: Coordinate,
    range: [f64; 2],
    y: impl Fn(f64) -> f64,
) -> EffectConfig {
    let [low, high] = range;
    let x: Vec<f64> = (0..18)
        .map(|k| low + (high - low) * f64::from(k) / 17.0)
        .collect();
    let y: Vec<f64> = x.iter().map(|x| y(*x)).collect();
    curve(Action { place, coordinate }, &x, &y).expect("a curve")
}

/// Largest difference of currents and speeds, shares of rated current and synchronous speed.
fn difference(a: &Outputs, b: &Outputs) -> f64 {
    let currents = a.i_s_abc.iter().zip(&b.i_s_abc);
    let current = currents
        .flat_map(|(a, b)| (0..3).map(move |p| (a[p] - b[p]).abs() / RATED.current))
        .fold(0.0, f64::max);
    let speeds = a.omega_mech.iter().zip(&b.omega_mech);
    speeds
        .map(|(a, b)| (a - b).abs() / RATED.speed())
        .fold(current, f64::max)
}

/// A table of 512 intervals errs by 1/8 of the squared step times the second derivative: 1e-6 of the torque here.
const OF_TABLE: f64 = 1e-5;

#[test]
fn a_parabola_over_the_speed_is_windage() {
    let mut windage = EffectConfig::absent(find("windage", "").expect("in the library"), &RATED);
    windage.values[0] = 1e-4;
    let curve = law(Place::Torque, Coordinate::Speed, [-20.0, 170.0], |w| {
        1e-4 * w * w.abs()
    });
    // Negative speeds are not visited: the kink at zero is.
    let positive = law(Place::Torque, Coordinate::Speed, [0.0, 170.0], |w| {
        1e-4 * w * w
    });
    let library = run(&plant(vec![windage]));
    assert!(difference(&run(&plant(vec![positive])), &library) < OF_TABLE);
    assert!(difference(&run(&plant(vec![curve])), &library) < 20.0 * OF_TABLE);
    assert!(
        difference(&run(&plant(Vec::new())), &library) > 1e-3,
        "windage shows"
    );
}

#[test]
fn a_constant_curve_is_another_parameter() {
    let range = [0.0, 100.0];
    for (place, coordinate, y, change) in [
        (
            Place::Stator,
            Coordinate::Current,
            0.2,
            [1.2, 1.0, 1.0, 1.0],
        ),
        (
            Place::Stator,
            Coordinate::Frequency,
            0.1,
            [1.1, 1.0, 1.0, 1.0],
        ),
        (Place::Rotor, Coordinate::Slip, -0.2, [1.0, 0.8, 1.0, 1.0]),
        (
            Place::Leakage,
            Coordinate::Current,
            0.15,
            [1.0, 1.0, 1.15, 1.0],
        ),
        (
            Place::Magnetizing,
            Coordinate::Flux,
            0.25,
            [1.0, 1.0, 1.0, 0.8],
        ),
        (
            Place::Magnetizing,
            Coordinate::Time,
            0.25,
            [1.0, 1.0, 1.0, 0.8],
        ),
    ] {
        let curve = run(&plant(vec![law(place, coordinate, range, |_| y)]));
        let mut other = plant(Vec::new());
        let [r_s, r_r, l, l_m] = change;
        other.motor.r_s *= r_s;
        other.motor.r_r *= r_r;
        (other.motor.l_ls, other.motor.l_lr) = (MOTOR.l_ls * l, MOTOR.l_lr * l);
        other.motor.l_m *= l_m;
        let error = difference(&curve, &run(&other));
        assert!(error < OF_TABLE, "{place:?} {coordinate:?}: {error:e}");
    }
}

#[test]
fn a_drop_that_grows_with_the_current_is_a_resistance() {
    let drop = |place| law(place, Coordinate::PhaseCurrent, [-90.0, 90.0], |i| 0.4 * i);
    let mut other = plant(Vec::new());
    other.motor.r_s += 0.4;
    assert!(difference(&run(&plant(vec![drop(Place::Stator)])), &run(&other)) < OF_TABLE);
    let phases = [
        Place::StatorPhaseA,
        Place::StatorPhaseB,
        Place::StatorPhaseC,
    ];
    assert!(difference(&run(&plant(phases.map(drop).into())), &run(&other)) < OF_TABLE);
}

#[test]
fn a_curve_of_a_sensor_is_its_gain() {
    let speed = law(Place::SensorSpeed, Coordinate::Speed, [0.0, 170.0], |_| {
        0.01
    });
    let current = law(
        Place::SensorIb,
        Coordinate::PhaseCurrent,
        [-90.0, 90.0],
        |_| -0.02,
    );
    let (bare, shown) = (run(&plant(Vec::new())), run(&plant(vec![speed, current])));
    for k in (0..bare.omega_mech.len()).step_by(97) {
        assert!((shown.omega_mech[k] - 1.01 * bare.omega_mech[k]).abs() < 1e-9);
        assert!((shown.i_s_abc[k][1] - 0.98 * bare.i_s_abc[k][1]).abs() < 1e-9);
        assert_eq!(shown.i_s_abc[k][0], bare.i_s_abc[k][0]);
    }
}

fn point() -> SteadyPoint<f32> {
    let motor = TParams {
        r_s: 3.7,
        r_r: 2.3,
        l_ls: 0.0107,
        l_lr: 0.0107,
        l_m: 0.234,
    };
    SteadyPoint {
        rated: Rated {
            voltage: 326.6,
            current: 7.07,
            omega_sync: 314.159,
            n_p: 2.0,
            torque: 14.6,
        },
        omega_sync: 314.159,
        omega_mech: 150.0,
        u_s: Complex::new(326.6, 0.0),
        i_s: Complex::new(5.0, -3.0),
        motor,
        tau_extra: 0.0,
    }
}

fn corrected(config: &EffectConfig) -> SteadyPoint<f32> {
    let (action, x, y) = super::knots_and_values(config).expect("a curve");
    let mut point = point();
    let law = SteadyCurve::<f32>::new(action, x, y).expect("room for it");
    law.correct(&mut point);
    // The same from the words of an image.
    let (knots, mean, words) = law.words();
    assert_eq!(SteadyCurve::of_words(action, knots, mean, words), law);
    point
}

#[test]
fn in_steady_state_a_curve_does_what_the_simulation_does() {
    let pump = law(Place::Torque, Coordinate::Speed, [0.0, 170.0], |w| {
        1e-4 * w * w
    });
    assert!((corrected(&pump).tau_extra - 2.25).abs() < 1e-4);
    let bars = law(Place::Rotor, Coordinate::Slip, [0.0, 50.0], |hz| 0.01 * hz);
    let slip_hz = 50.0 - 300.0 / std::f32::consts::TAU;
    assert!((corrected(&bars).motor.r_r / 2.3 - 1.0 - 0.01 * slip_hz).abs() < 1e-4);
    // 0.4 ohm in each phase, and in one: a third of it for the positive sequence.
    let i = point().i_s;
    for (place, r) in [(Place::Stator, 0.4), (Place::StatorPhaseB, 0.4 / 3.0)] {
        let drop = law(place, Coordinate::PhaseCurrent, [-90.0, 90.0], |i| 0.4 * i);
        let expected = point().u_s - i * r;
        assert!((corrected(&drop).u_s - expected).norm() < 1e-3, "{place:?}");
    }
    // A contact: 2 V whatever the current, its fundamental is 4/pi of that.
    let contact = law(Place::Stator, Coordinate::PhaseCurrent, [-8.5, 8.5], |i| {
        2.0 * i.signum()
    });
    let drop = (point().u_s - corrected(&contact).u_s).norm();
    assert!((drop - 8.0 / std::f32::consts::PI).abs() < 0.1, "{drop}");
    // Half a sine each turn: its mean is 1/pi.
    let piston = curve(
        Action {
            place: Place::Torque,
            coordinate: Coordinate::Angle,
        },
        &(0..36)
            .map(|k| f64::from(k) * std::f64::consts::TAU / 36.0)
            .collect::<Vec<_>>(),
        &(0..36)
            .map(|k| (f64::from(k) * std::f64::consts::TAU / 36.0).sin().max(0.0))
            .collect::<Vec<_>>(),
    );
    let mean = corrected(&piston.expect("a curve")).tau_extra;
    assert!((mean - 1.0 / std::f32::consts::PI).abs() < 2e-3, "{mean}");
}

const FILE: &str = include_str!("../../../../../motors/peer-2k2.toml");

fn with(entry: &str) -> Result<MotorFile, String> {
    let text = format!("{FILE}\n[[effects]]\nname = \"curve\"\n{entry}");
    MotorFile::parse(&text, "m.toml").map_err(|error| error.to_string())
}

const PUMP: &str = "place = \"torque\"\ncoordinate = \"speed\"\nknots_rad_s = [0.0, 80.0, 157.0]\nvalues_nm = [0.0, 0.4, 2.6]\n";

#[test]
fn a_curve_survives_the_motor_file() {
    let file = with(PUMP).expect("a motor file");
    let again = MotorFile::parse(&file.to_toml(), "again.toml").expect("a motor file");
    assert_eq!(again.effects[0].parameters.len(), 4);
    let config = from_entry(&again.effects[0]).expect("a curve");
    assert_eq!(config.values, [0.0, 80.0, 157.0, 0.0, 0.4, 2.6]);
    assert_eq!(
        from_entry(&to_entry(&config).expect("a curve"))
            .expect("a curve")
            .values,
        config.values
    );
}

#[test]
fn a_curve_that_cannot_be_used_is_refused_with_its_key() {
    for (old, new, key, said) in [
        ("\"torque\"", "\"tork\"", "place", "is not one of"),
        ("\"speed\"", "\"sped\"", "coordinate", "is not one of"),
        (
            "\"torque\"",
            "\"leakage\"",
            "coordinate",
            "acts over one of: current, slip, time",
        ),
        ("knots_rad_s", "knots_hz", "knots_hz", "no parameter"),
        ("80.0, 157.0]", "157.0, 80.0]", "knots_rad_s", "must ascend"),
        (
            "[0.0, 80.0, 157.0]",
            "[0.0, 80.0]",
            "knots_rad_s",
            "2 knots: give 3 to 24",
        ),
        (
            "[0.0, 0.4, 2.6]",
            "[0.0, 0.4]",
            "values_nm",
            "2 values for 3 knots",
        ),
        ("[0.0, 0.4, 2.6]", "2.6", "values_nm", "a list of numbers"),
        ("place = \"torque\"\n", "", "place", "give one of: torque"),
        ("[0.0, 0.4, 2.6]", "[0.0, nan, 2.6]", "values_nm", ""),
    ] {
        let error = with(&PUMP.replacen(old, new, 1)).expect_err(new);
        let path = format!("effects.curve.{key}");
        assert!(
            (error.contains(&path) || said.is_empty()) && error.contains(said),
            "{error}"
        );
    }
    let angle = "place = \"torque\"\ncoordinate = \"angle\"\nknots_rad = [0.0, 2.0, 6.3]\nvalues_nm = [0.0, 0.4, 0.0]\n";
    assert!(
        with(angle)
            .expect_err("too wide")
            .contains("within one turn")
    );
    for (name, said) in [
        ("windage", "effects.windage.windage_nm_s2"),
        ("windige", "no effect is called `windige`"),
    ] {
        let list = format!("{FILE}\n[[effects]]\nname = \"{name}\"\nwindage_nm_s2 = [1e-4]\n");
        let error = MotorFile::parse(&list, "m.toml").expect_err("a list");
        assert!(error.to_string().contains(said), "{error}");
    }
}
